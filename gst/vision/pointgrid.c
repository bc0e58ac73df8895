/* The nearest of many points in the picture.
 *
 * Points are sorted into square cells that hold about two each; a look-up visits rings of
 * cells outwards until no nearer point can come.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/pointgrid.h"

#include <math.h>

typedef struct
{
  gfloat x, y;
  gint next;                    /* in the same cell, -1 at its end */
} Point;

struct _ClothPointGrid
{
  GArray *points;               /* Point */
  GArray *cells;                /* gint, the last point added to each cell */
  gint columns, rows;
  gfloat size;
};

/**
 * cloth_point_grid_new:
 *
 * Returns: (transfer full): an empty grid; it keeps its memory when cleared.
 *
 * Since: 0.1
 */
ClothPointGrid *
cloth_point_grid_new (void)
{
  ClothPointGrid *grid = g_new0 (ClothPointGrid, 1);

  grid->points = g_array_new (FALSE, FALSE, sizeof (Point));
  grid->cells = g_array_new (FALSE, FALSE, sizeof (gint));
  return grid;
}

/**
 * cloth_point_grid_free:
 * @grid: (transfer full): the grid
 *
 * Since: 0.1
 */
void
cloth_point_grid_free (ClothPointGrid * grid)
{
  g_array_unref (grid->points);
  g_array_unref (grid->cells);
  g_free (grid);
}

/**
 * cloth_point_grid_clear:
 * @grid: the grid
 * @width: width of the picture, px
 * @height: height of the picture, px
 * @n_expected: how many points will be added, about
 *
 * Takes out all points.
 *
 * Since: 0.1
 */
void
cloth_point_grid_clear (ClothPointGrid * grid, gint width, gint height,
    guint n_expected)
{
  gfloat area = (gfloat) width * (gfloat) height;

  grid->size = MAX (4.0f, sqrtf (2.0f * area / (gfloat) MAX (n_expected, 1)));
  grid->columns = (gint) ((gfloat) width / grid->size) + 1;
  grid->rows = (gint) ((gfloat) height / grid->size) + 1;
  g_array_set_size (grid->points, 0);
  g_array_set_size (grid->cells, (guint) (grid->columns * grid->rows));
  for (guint k = 0; k < grid->cells->len; k++)
    g_array_index (grid->cells, gint, k) = -1;
}

/* What is no number comes into cell 0, so that it does no harm. */
static inline gint
cell_along (gfloat at, gint n)
{
  return at > 0 ? (gint) MIN (at, (gfloat) (n - 1)) : 0;
}

static void
cell_of (const ClothPointGrid * grid, gfloat x, gfloat y, gint * column,
    gint * row)
{
  *column = cell_along (x / grid->size, grid->columns);
  *row = cell_along (y / grid->size, grid->rows);
}

/**
 * cloth_point_grid_add:
 * @grid: the grid
 * @x: column, px; may lie outside the picture
 * @y: row, px
 *
 * Adds a point; points are numbered from 0 in the order they are added. One with a NaN
 * coordinate is counted but never found.
 *
 * Since: 0.1
 */
void
cloth_point_grid_add (ClothPointGrid * grid, gfloat x, gfloat y)
{
  gint column, row, *cell;
  Point point = { x, y, -1 };

  cell_of (grid, x, y, &column, &row);
  cell = &g_array_index (grid->cells, gint, row * grid->columns + column);
  point.next = *cell;
  *cell = (gint) grid->points->len;
  g_array_append_val (grid->points, point);
}

/**
 * cloth_point_grid_nearest:
 * @grid: the grid
 * @x: column, px
 * @y: row, px
 * @radius: largest distance, px
 * @near: (out caller-allocates) (array length=n_near): the points found, nearest first;
 *   of equally near ones the first added first
 * @n_near: room in @near
 *
 * Returns: number of points found, 0 near a place that is no number
 *
 * Since: 0.1
 */
guint
cloth_point_grid_nearest (const ClothPointGrid * grid, gfloat x, gfloat y,
    gfloat radius, ClothNear * near, guint n_near)
{
  const gint *cells = (const gint *) grid->cells->data;
  const Point *points = (const Point *) grid->points->data;
  gfloat limit = radius * radius, inside;
  gint column, row, last = MAX (grid->columns, grid->rows);
  guint n = 0;

  if (!n_near)
    return 0;
  cell_of (grid, x, y, &column, &row);
  /* How far it is to the next cell at least; less a little, for cells are found by
   * rounded division. */
  inside = MIN (MIN (x - (gfloat) column * grid->size,
          (gfloat) (column + 1) * grid->size - x),
      MIN (y - (gfloat) row * grid->size, (gfloat) (row + 1) * grid->size - y));
  inside = MAX (inside - 0.01f, 0);
  for (gint ring = 0; ring <= last; ring++) {
    gfloat reach = ring ? grid->size * (gfloat) (ring - 1) + inside : 0;

    if (reach * reach > limit)
      break;
    for (gint r = MAX (row - ring, 0); r <= MIN (row + ring, grid->rows - 1);
        r++) {
      gboolean edge = r == row - ring || r == row + ring;
      gint step = edge ? 1 : MAX (2 * ring, 1);

      for (gint c = column - ring; c <= column + ring; c += step) {
        if (c < 0 || c >= grid->columns)
          continue;
        for (gint m = cells[r * grid->columns + c]; m >= 0; m = points[m].next) {
          gfloat dx = points[m].x - x, dy = points[m].y - y;
          gfloat d2 = dx * dx + dy * dy;
          guint at;

          /* Written so that NaN is far. */
          if (!(d2 <= limit) || (n == n_near && d2 == near[n - 1].distance2
                  && m > near[n - 1].index))
            continue;
          if (n < n_near)
            n++;
          for (at = n - 1; at > 0 && (near[at - 1].distance2 > d2
                  || (near[at - 1].distance2 == d2 && near[at - 1].index > m));
              at--)
            near[at] = near[at - 1];
          near[at].distance2 = d2;
          near[at].index = m;
          if (n == n_near)
            limit = MIN (limit, near[n - 1].distance2);
        }
      }
    }
  }
  return n;
}
