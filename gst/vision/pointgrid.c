/* The nearest of many points in the picture.
 *
 * Points are sorted into square cells that hold about two each; a look-up visits rings of
 * cells outwards until no nearer point can come.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/pointgrid.h"

#include <math.h>
#include <string.h>

typedef struct
{
  gfloat x, y;
  gint next;                    /* in the same cell, -1 at its end */
} Point;

struct _ClothPointGrid
{
  Point *points;
  guint n_points, n_room;
  gint *cells;                  /* the last point added to each cell */
  guint n_cells;                /* there is room for */
  gint columns, rows;
  gfloat size;
  gfloat per_px;                /* 1 / size */
};

/* Returns: (transfer full): an empty grid; it keeps its memory when cleared.
 */
ClothPointGrid *
cloth_point_grid_new (void)
{
  return g_new0 (ClothPointGrid, 1);
}

/* @grid: (transfer full): the grid
 */
void
cloth_point_grid_free (ClothPointGrid * grid)
{
  g_free (grid->points);
  g_free (grid->cells);
  g_free (grid);
}

/* @grid: the grid
 * @width: width of the picture, px
 * @height: height of the picture, px
 * @n_expected: how many points will be added, about
 *
 * Takes out all points.
 */
void
cloth_point_grid_clear (ClothPointGrid * grid, gint width, gint height,
    guint n_expected)
{
  gfloat area = (gfloat) width * (gfloat) height;
  guint n;

  grid->size = MAX (4.0f, sqrtf (2.0f * area / (gfloat) MAX (n_expected, 1)));
  grid->per_px = 1 / grid->size;
  grid->columns = (gint) ((gfloat) width / grid->size) + 1;
  grid->rows = (gint) ((gfloat) height / grid->size) + 1;
  n = (guint) grid->columns * (guint) grid->rows;
  if (n > grid->n_cells) {
    g_free (grid->cells);
    grid->cells = g_new (gint, n);
    grid->n_cells = n;
  }
  /* All bytes 0xff make -1. */
  memset (grid->cells, 0xff, n * sizeof (gint));
  grid->n_points = 0;
}

/* What is no number comes into cell 0, so that it does no harm. */
static inline gint
cell_along (gfloat at, gint n)
{
  return at > 0 ? (gint) MIN (at, (gfloat) (n - 1)) : 0;
}

static inline void
cell_of (const ClothPointGrid * grid, gfloat x, gfloat y, gint * column,
    gint * row)
{
  *column = cell_along (x * grid->per_px, grid->columns);
  *row = cell_along (y * grid->per_px, grid->rows);
}

/* @grid: the grid
 * @x: column, px; may lie outside the picture
 * @y: row, px
 *
 * Adds a point; points are numbered from 0 in the order they are added. One with a NaN
 * coordinate is counted but never found.
 */
void
cloth_point_grid_add (ClothPointGrid * grid, gfloat x, gfloat y)
{
  gint column, row, *cell;

  if (grid->n_points == grid->n_room) {
    grid->n_room = MAX (2 * grid->n_room, 256);
    grid->points = g_renew (Point, grid->points, grid->n_room);
  }
  cell_of (grid, x, y, &column, &row);
  cell = &grid->cells[row * grid->columns + column];
  grid->points[grid->n_points] = (Point) {
  x, y, *cell};
  *cell = (gint) grid->n_points++;
}

#define INLINE static inline __attribute__((always_inline))

typedef struct
{
  gfloat x, y, limit;           /* squared */
  ClothNear *near;
  guint n;
} Search;

/* Puts the points of one cell into their places among the nearest. */
INLINE void
visit (const Point * points, gint m, Search * search, guint n_near)
{
  ClothNear *near = search->near;

  for (; m >= 0; m = points[m].next) {
    gfloat dx = points[m].x - search->x, dy = points[m].y - search->y;
    gfloat d2 = dx * dx + dy * dy;
    guint at;

    /* Written so that NaN is far. */
    if (!(d2 <= search->limit) || (search->n == n_near
            && d2 == near[n_near - 1].distance2 && m > near[n_near - 1].index))
      continue;
    if (search->n < n_near)
      search->n++;
    for (at = search->n - 1; at > 0 && (near[at - 1].distance2 > d2
            || (near[at - 1].distance2 == d2 && near[at - 1].index > m)); at--)
      near[at] = near[at - 1];
    near[at].distance2 = d2;
    near[at].index = m;
    if (search->n == n_near)
      search->limit = MIN (search->limit, near[n_near - 1].distance2);
  }
}

INLINE guint
find (const ClothPointGrid * grid, gfloat x, gfloat y, gfloat radius,
    ClothNear * near, guint n_near)
{
  Search search = { x, y, radius * radius, near, 0 };
  gint column, row, last = MAX (grid->columns, grid->rows);
  gfloat inside;

  cell_of (grid, x, y, &column, &row);
  /* How far it is to the next cell at least; less a little, for cells are found by a
   * rounded product. */
  inside = MIN (MIN (x - (gfloat) column * grid->size,
          (gfloat) (column + 1) * grid->size - x),
      MIN (y - (gfloat) row * grid->size, (gfloat) (row + 1) * grid->size - y));
  inside = MAX (inside - 0.01f, 0);
  for (gint ring = 0; ring <= last; ring++) {
    gfloat reach = ring ? grid->size * (gfloat) (ring - 1) + inside : 0;
    gint left = column - ring, right = column + ring;

    if (reach * reach > search.limit)
      break;
    for (gint r = MAX (row - ring, 0); r <= MIN (row + ring, grid->rows - 1);
        r++) {
      const gint *cells = grid->cells + r * grid->columns;

      if (r == row - ring || r == row + ring) {
        for (gint c = MAX (left, 0); c <= MIN (right, grid->columns - 1); c++)
          visit (grid->points, cells[c], &search, n_near);
        continue;
      }
      if (left >= 0)
        visit (grid->points, cells[left], &search, n_near);
      if (right < grid->columns)
        visit (grid->points, cells[right], &search, n_near);
    }
  }
  return search.n;
}

/* @grid: the grid
 * @x: column, px
 * @y: row, px
 * @radius: largest distance, px
 * @near: (out caller-allocates) (array length=n_near): the points found, nearest first;
 *   of equally near ones the first added first
 * @n_near: room in @near
 *
 * Returns: number of points found, 0 near a place that is no number
 */
guint
cloth_point_grid_nearest (const ClothPointGrid * grid, gfloat x, gfloat y,
    gfloat radius, ClothNear * near, guint n_near)
{
  if (!n_near)
    return 0;
  /* Most ask for one: a copy of the code that knows it. */
  if (n_near == 1)
    return find (grid, x, y, radius, near, 1);
  return find (grid, x, y, radius, near, n_near);
}

/* @grid: the grid
 * @x: column, px
 * @y: row, px
 * @radius: largest distance, px
 * @indices: (out caller-allocates) (array length=n_indices): the points found, in no
 *   order that means anything, the same each time
 * @n_indices: room in @indices; points beyond it are left out
 *
 * Finds points for less than it takes to sort them.
 *
 * Returns: number of points found, 0 near a place that is no number
 */
guint
cloth_point_grid_within (const ClothPointGrid * grid, gfloat x, gfloat y,
    gfloat radius, gint * indices, guint n_indices)
{
  const gfloat limit = radius * radius;
  gint left, right, top, bottom;
  guint n = 0;

  cell_of (grid, x - radius, y - radius, &left, &top);
  cell_of (grid, x + radius, y + radius, &right, &bottom);
  for (gint row = top; row <= bottom; row++) {
    for (gint column = left; column <= right; column++) {
      for (gint m = grid->cells[row * grid->columns + column]; m >= 0;
          m = grid->points[m].next) {
        const gfloat dx = grid->points[m].x - x, dy = grid->points[m].y - y;

        if (n == n_indices)
          return n;
        indices[n] = m;
        n += dx * dx + dy * dy <= limit;
      }
    }
  }
  return n;
}
