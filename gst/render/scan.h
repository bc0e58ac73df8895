/* The pixels of a triangle, row by row, without gaps or overlaps between neighbours.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* @x, @y: its upper end, px; of two at one height that on the left
 * @slope: columns a row
 * @low, @high: the rows between which it lies
 *
 * An edge of a triangle. It is the same for both of its triangles, bit by bit, so that it crosses
 * a row at the same place for both.
 */
typedef struct {
  gdouble x, y, slope, low, high;
} ClothScanEdge;

/* Of what an int holds; plain SSE2 lacks it. */
static inline gint
cloth_scan_ceiling (gdouble value)
{
  const gint whole = (gint) value;

  return whole + (whole < value);
}

static inline void
cloth_scan_edge_init (ClothScanEdge * edge, gdouble ax, gdouble ay, gdouble bx,
    gdouble by)
{
  const gboolean turn = ay > by || (ay == by && ax > bx);

  edge->x = turn ? bx : ax;
  edge->y = turn ? by : ay;
  edge->slope = turn ? (ax - bx) / (ay - by) : (bx - ax) / (by - ay);
  edge->low = edge->y;
  edge->high = turn ? ay : by;
}

/* @edges: of a triangle
 * @y: a row
 * @width: of the picture, px
 * @from: (out): the first column of which the centre is in the triangle
 * @to: (out): the column after the last; there is none when it isn't above @from
 *
 * A centre on a border belongs to the triangle to its right or below.
 */
static inline void
cloth_scan_row (const ClothScanEdge edges[3], gint y, gint width, gint * from,
    gint * to)
{
  gdouble left = width, right = 0;

  for (guint k = 0; k < 3; k++) {
    const ClothScanEdge *e = &edges[k];

    if (e->low <= y && y < e->high) {
      const gdouble x = e->x + (y - e->y) * e->slope;

      left = MIN (left, x);
      right = MAX (right, x);
    }
  }
  *from = cloth_scan_ceiling (MAX (left, 0));
  *to = cloth_scan_ceiling (MIN (right, width));
}

G_END_DECLS
