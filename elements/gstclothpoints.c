/* The places of a grid's vertices that squares or dots in a picture tell.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothpoints.h"

#include <string.h>

void
gst_cloth_points_add_quads (const GstClothQuads * quads, guint columns,
    guint rows, ClothMerge * merge)
{
  const GstClothQuad *quad;
  guint n, i, c;

  quad = gst_cloth_quads_get_quads (quads, &n);
  for (i = 0; i < n; i++, quad++) {
    if (quad->state != GST_CLOTH_QUAD_TRACKED || quad->column < 0
        || quad->row < 0 || (guint) quad->column >= columns - 1
        || (guint) quad->row >= rows - 1) {
      continue;
    }
    for (c = 0; c < 4; c++) {
      guint column = (guint) quad->column + (c == 1 || c == 2);
      guint row = (guint) quad->row + (c >= 2);
      gdouble cov[3] = { quad->cov_xx[c], quad->cov_xy[c], quad->cov_yy[c] };

      cloth_merge_add (merge, row * columns + column, quad->x[c], quad->y[c],
          cov);
    }
  }
}

static gboolean
is_usable (const GstClothDot * dot, guint columns, guint rows)
{
  return !dot->touches && dot->column >= 0 && dot->row >= 0
      && (guint) dot->column < columns && (guint) dot->row < rows;
}

/* Where two of a dot's neighbours are not seen a fold's edge hides them, and it may hide a
 * part of the dot too: its centre of gravity is then another. */
static gboolean
is_at_fold (const GstClothDot * dot, guint columns, guint rows,
    const guint8 * seen)
{
  const guint column = (guint) dot->column, row = (guint) dot->row;
  const guint8 *at = seen + row * columns + column;
  guint missing = 0;

  missing += column > 0 && !at[-1];
  missing += column + 1 < columns && !at[1];
  missing += row > 0 && !*(at - columns);
  missing += row + 1 < rows && !at[columns];
  return missing > 1;
}

/* A dot seen from behind is the same vertex: cloth is thin. */
void
gst_cloth_points_add_dots (const GstClothDots * dots, guint columns,
    guint rows, guint8 * seen, ClothMerge * merge)
{
  const GstClothDot *list;
  guint n, i;

  list = gst_cloth_dots_get_dots (dots, &n);
  memset (seen, 0, (gsize) columns * rows);
  for (i = 0; i < n; i++) {
    if (is_usable (&list[i], columns, rows)) {
      seen[(guint) list[i].row * columns + (guint) list[i].column] = 1;
    }
  }
  for (i = 0; i < n; i++) {
    const GstClothDot *dot = &list[i];
    gdouble cov[3] = { dot->cov_xx, dot->cov_xy, dot->cov_yy };

    if (is_usable (dot, columns, rows)
        && !is_at_fold (dot, columns, rows, seen)) {
      cloth_merge_add (merge, (guint) dot->row * columns
          + (guint) dot->column, dot->x, dot->y, cov);
    }
  }
}
