/* Seams of the flat cloth: where vertices with several uv are parted, and what is sewn together.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/mesh/topology.h"

G_BEGIN_DECLS

/* Share by which the lines of a seam may differ in length on the flat cloth. */
#define CLOTH_SEAM_EASE 0.02

/* @topology: each vertex with one uv
 * @sources: of each of its vertices that of the mesh before; the first ones are themselves
 * @seams: (element-type ClothSeamLine): which were one vertex
 *
 * A mesh that is parted at its uv seams.
 */
typedef struct {
  ClothTopology *topology;
  guint32 *sources;
  GArray *seams;
} ClothSplit;

GArray *cloth_seams_new (void);
gboolean cloth_seam_fits (const ClothTopology * topology,
    const ClothSeamLine * line, gdouble lengths[2]);

ClothSplit *cloth_split_new (const ClothTopology * topology,
    const gfloat * corner_uv, GError ** error);
void cloth_split_free (ClothSplit * split);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothSplit, cloth_split_free)
G_END_DECLS
