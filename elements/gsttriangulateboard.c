/* The printed board as triangulate sees it: squares in, a grid of vertices out.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gsttriangulateboard.h"

GstClothTopology *
gst_triangulate_board_to_topology (const ClothPattern * pattern,
    GError ** error)
{
  guint columns = (guint) pattern->columns + 1;
  guint rows = (guint) pattern->rows + 1;
  g_autofree gfloat *uv = g_new (gfloat, 2 * (gsize) columns * rows);
  g_autoptr (GstClothTopology) grid = NULL;
  const guint32 *faces;
  guint n_indices, i;

  for (i = 0; i < columns * rows; i++) {
    uv[2 * i] = (gfloat) (pattern->origin_uv_m[0] +
        (i % columns) * pattern->square_m);
    uv[2 * i + 1] = (gfloat) (pattern->origin_uv_m[1] +
        (i / columns) * pattern->square_m);
  }
  /* its faces, at another place */
  grid = gst_cloth_topology_new_grid (columns, rows, 1.0f, 1.0f, error);
  if (!grid) {
    return NULL;
  }
  faces = gst_cloth_topology_get_faces (grid, &n_indices);
  return gst_cloth_topology_new (columns * rows, columns, rows, uv, faces,
      n_indices / 4, error);
}

gboolean
gst_triangulate_board_take (GstElement * self, guint index,
    const ClothPattern * pattern, GstClothQuads * quads, ClothMerge * merge)
{
  guint columns = (guint) pattern->columns;
  guint rows = (guint) pattern->rows;
  const GstClothQuad *quad;
  guint n, i, c;

  if (gst_cloth_quads_get_columns (quads) != columns
      || gst_cloth_quads_get_rows (quads) != rows) {
    GST_ELEMENT_ERROR (self, STREAM, FORMAT,
        ("The squares on sink_%u are of a board of %u×%u, but pattern has "
            "%u×%u.", index, gst_cloth_quads_get_columns (quads),
            gst_cloth_quads_get_rows (quads), columns, rows),
        ("Give the detector and this element the same pattern."));
    return FALSE;
  }
  quad = gst_cloth_quads_get_quads (quads, &n);
  for (i = 0; i < n; i++, quad++) {
    if (quad->state != GST_CLOTH_QUAD_TRACKED || quad->column < 0
        || quad->row < 0 || (guint) quad->column >= columns
        || (guint) quad->row >= rows) {
      continue;
    }
    for (c = 0; c < 4; c++) {
      guint column = (guint) quad->column + (c == 1 || c == 2);
      guint row = (guint) quad->row + (c >= 2);
      gdouble cov[3] = { quad->cov_xx[c], quad->cov_xy[c], quad->cov_yy[c] };

      cloth_merge_add (merge, row * (columns + 1) + column, quad->x[c],
          quad->y[c], cov);
    }
  }
  return TRUE;
}
