/* Triangles in a picture: their pixels, row by row, without gaps or overlaps between neighbours, and
 * what is linear over them.
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

/* Farther off than any picture: triangles with such corners can't be drawn. */
#define CLOTH_SCAN_FAR_PX 1e6

/* Of what is below %CLOTH_SCAN_FAR_PX; plain SSE2 lacks it. */
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

/* @plane: (out): value at the first corner, slopes along x and y
 * @x, @y: of a triangle's corners, px
 * @area: twice its area, signed
 * @values: at its corners
 *
 * The plane through three values over the picture.
 */
static inline void
cloth_scan_set_plane (gdouble plane[3], const gdouble x[3], const gdouble y[3],
    gdouble area, const gdouble values[3])
{
  const gdouble q = values[1] - values[0], r = values[2] - values[0];

  plane[0] = values[0];
  plane[1] = (q * (y[2] - y[0]) - r * (y[1] - y[0])) / area;
  plane[2] = (r * (x[1] - x[0]) - q * (x[2] - x[0])) / area;
}

/* @faces: (array): 4 indices a face, the last 0xffffffff for a triangle
 * @n_faces: how many
 * @triangles: (out) (array): 3 indices a triangle, room for two a face
 *
 * Returns: number of triangles; a face of four corners makes two
 */
static inline guint
cloth_scan_list_triangles (const guint32 * faces, guint n_faces,
    guint32 * triangles)
{
  guint n = 0;

  for (gsize f = 0; f < n_faces; f++) {
    const guint32 *face = faces + 4 * f;

    for (guint k = 2; k < (face[3] == G_MAXUINT32 ? 3 : 4); k++) {
      guint32 *t = triangles + 3 * (gsize) n++;

      t[0] = face[0];
      t[1] = face[k - 1];
      t[2] = face[k];
    }
  }
  return n;
}

G_END_DECLS
