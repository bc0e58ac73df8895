/* Wavefront OBJ: one mesh with its uv.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/file/output.h"
#include "gst/mesh/topology.h"

G_BEGIN_DECLS

/* @topology: faces and uv; of larger polygons, a fan of triangles
 * @positions: 3 numbers a vertex, as they stand in the file
 * @has_uv: whether the file gives uv
 * @n_seam_vertices: vertices that faces give different uv; the first one is kept
 * @corner_uv: (nullable): where there are such, 2 numbers for each of the 4 corners of each face
 * @fps: from the comment this library writes, else 0
 *
 * What an OBJ file holds. Vertices keep the file's order, which a point cache
 * relies on.
 */
typedef struct {
  ClothTopology *topology;
  gfloat *positions;
  gboolean has_uv;
  guint n_seam_vertices;
  gfloat *corner_uv;
  gdouble fps;
} ClothObj;

ClothObj *cloth_obj_parse (const gchar * text, gsize size, GError ** error);
ClothObj *cloth_obj_read (const gchar * path, GError ** error);
void cloth_obj_free (ClothObj * obj);
gboolean cloth_obj_write (ClothOutput * output, const gchar * name,
    const ClothTopology * topology, const gfloat * positions, gint fps_n,
    gint fps_d, GError ** error);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothObj, cloth_obj_free)
G_END_DECLS
