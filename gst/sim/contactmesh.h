/* A cloth's faces, edges and corners as its contact with itself needs them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/sim/body.h"

G_BEGIN_DECLS

/* A triangle. Each corner and edge of the mesh belongs to the first triangle that has it
 * (Curtis, Tamstorf and Manocha 2008), so that pairs of triangles give each pair of a
 * corner and a triangle, and each pair of edges, once. Bit k of owns: corner k; bit 3 + k:
 * the edge from corner k to the next. */
typedef struct
{
  guint32 corner[3];            /* particles */
  guint32 panel;                /* what hangs together without seams */
  gdouble uv[3][3];             /* on the flat cloth, third coordinate 0, m */
  guint owns;
} ClothContactFace;

/* Of a hierarchy that halves the faces; halves come after the whole. */
typedef struct
{
  guint32 half[2];
  guint32 face;                 /* of a leaf */
  guint32 n;                    /* faces in it; 1: a leaf */
} ClothContactNode;

typedef struct
{
  guint n_particles, n_faces, n_nodes;
  ClothContactFace *faces;
  ClothContactNode *nodes;
  gdouble *room;                /* of each particle: half the least height about it, m */
  gdouble edge;                 /* mean length, m */
  gdouble longest;              /* edge, m */
} ClothContactMesh;

ClothContactMesh *cloth_contact_mesh_new (const ClothBody * body);
void cloth_contact_mesh_free (ClothContactMesh * mesh);
gdouble cloth_contact_mesh_corner_rest (const ClothContactMesh * mesh,
    const ClothContactFace * of, guint corner, const ClothContactFace * to);
gdouble cloth_contact_mesh_edge_rest (const ClothContactMesh * mesh,
    const ClothContactFace * of, guint edge, const ClothContactFace * to,
    guint other);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothContactMesh, cloth_contact_mesh_free)
G_END_DECLS
