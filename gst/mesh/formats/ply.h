/* PLY: one frame of a mesh with what is known of each vertex.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/mesh/topology.h"

G_BEGIN_DECLS

/* @n_vertices: number of vertices
 * @n_faces: number of faces, after larger polygons became fans of triangles
 * @positions: 3 numbers a vertex
 * @uv: 2 numbers a vertex
 * @states: a #ClothVertexState a vertex
 * @covariances: 6 numbers a vertex: xx, xy, xz, yy, yz, zz, m²
 * @faces: (element-type guint32): 4 indices a face
 * @has_uv: whether the file gives uv, else they are zero
 * @has_states: whether the file gives states
 * @has_covariances: whether the file gives covariances
 * @note: from the comment this library writes
 *
 * What a PLY file holds. One is reused over a sequence of files, so that frames of
 * one size allocate nothing.
 */
typedef struct {
  guint n_vertices;
  guint n_faces;
  gfloat *positions;
  gfloat *uv;
  guint8 *states;
  gfloat *covariances;
  GArray *faces;
  gboolean has_uv;
  gboolean has_states;
  gboolean has_covariances;
  ClothMeshNote note;
  /*< private >*/
  GByteArray *bytes;
  guint capacity;
} ClothPly;

ClothPly *cloth_ply_new (void);
gboolean cloth_ply_parse (ClothPly * ply, const gchar * bytes, gsize size,
    GError ** error);
gboolean cloth_ply_read (ClothPly * ply, const gchar * path, GError ** error);
void cloth_ply_free (ClothPly * ply);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothPly, cloth_ply_free)
G_END_DECLS
