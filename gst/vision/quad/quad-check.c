/* Quad tracker: whether the squares found can all be what they are said to be.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/vision/quad/quad-private.h"

/* Corners this near to each other are one place, in shortest edges. */
#define CLAIM_REACH 0.25f
/* Length of an edge that ends on the board's rim over that of the edge before it, and over
 * its own in the last picture; cloth that bends away shortens it, but slowly and not so far. */
#define LEAST_RIM 0.6f
#define STEADY 0.85f
#define LEAST_STEADY 0.45f

static const gint diagonal_column[4] = { -1, 1, 1, -1 };
static const gint diagonal_row[4] = { -1, -1, 1, 1 };

/* Vertex of the board at corner @k of a square. */
static inline gint
corner_number (const ClothQuadTracker * tracker, gint column, gint row, gint k)
{
  return (row + cloth_quad_corner_row[k]) * (tracker->pattern.columns + 1)
      + column + cloth_quad_corner_column[k];
}

/* Section 3.8: the most inconsistent neighbours over the number of confident ones. The
 * paper's table has 0 for no neighbour, which would drop a lone square, the one that
 * starts it all included: read here as "no test". */
gboolean
cloth_quad_is_consistent (ClothQuadTracker * tracker, gint column, gint row)
{
  static const gint most[5] = { G_MAXINT, 1, 1, 2, 2 };
  const ClothQuadParams *params = tracker->params;
  const ClothQuadCell *cell = cloth_quad_cell (tracker, column, row);
  gint n = 0, bad = 0;

  for (gint k = 0; k < 4; k++) {
    const ClothQuadCell *other = cloth_quad_cell (tracker,
        column + diagonal_column[k], row + diagonal_row[k]);
    gfloat size, dx, dy;

    if (!other || !other->found || other->confidence <= params->c_high)
      continue;
    /* Corner k of this square is the other one's opposite corner. */
    dx = cell->here_x[k] - other->here_x[(k + 2) & 3];
    dy = cell->here_y[k] - other->here_y[(k + 2) & 3];
    size = params->consistency
        * MAX (cloth_quad_longest (cell->here_x, cell->here_y),
        cloth_quad_longest (other->here_x, other->here_y));
    n++;
    bad += dx * dx + dy * dy > size * size;
  }
  return bad < most[n];
}

static inline ClothQuadClaim *
claim_at (ClothQuadTracker * tracker, gint number)
{
  return &g_array_index (tracker->claims, ClothQuadClaim, number);
}

/* Looks up what is claimed where a square has its corners: in @same the claim of the same
 * vertex, in @other that of another one, -1 for none. For how many more of them there are
 * others. */
static gint
look_up (ClothQuadTracker * tracker, gint column, gint row, gint same[4],
    gint other[4])
{
  const ClothQuadCell *cell = cloth_quad_cell (tracker, column, row);
  const gfloat reach = CLAIM_REACH * cloth_quad_shortest (cell->here_x,
      cell->here_y);
  gint against = 0;

  for (gint k = 0; k < 4; k++) {
    ClothNear near[2];
    guint n = cloth_point_grid_nearest (tracker->claimed, cell->here_x[k],
        cell->here_y[k], reach, near, 2);

    same[k] = other[k] = -1;
    while (n > 0) {
      const gint number = near[--n].index;

      if (claim_at (tracker, number)->vertex == corner_number (tracker, column,
              row, k))
        same[k] = number;
      else
        other[k] = number;
    }
    against += (other[k] >= 0) - (same[k] >= 0);
  }
  return against;
}

static void
note (ClothQuadTracker * tracker, gint column, gint row, const gint same[4],
    const gint other[4])
{
  ClothQuadCell *cell = cloth_quad_cell (tracker, column, row);

  for (gint k = 0; k < 4; k++) {
    ClothQuadClaim claim = { corner_number (tracker, column, row, k) };

    cell->claim[k] = same[k];
    if (same[k] < 0) {
      cell->claim[k] = (gint) tracker->claims->len;
      cloth_point_grid_add (tracker->claimed, cell->here_x[k], cell->here_y[k]);
      g_array_append_val (tracker->claims, claim);
    } else {
      claim_at (tracker, same[k])->agreed = TRUE;
    }
    if (other[k] >= 0)
      claim_at (tracker, other[k])->contested =
          claim_at (tracker, cell->claim[k])->contested = TRUE;
  }
}

void
cloth_quad_claim_all (ClothQuadTracker * tracker)
{
  const gint columns = tracker->pattern.columns, rows = tracker->pattern.rows;

  cloth_point_grid_clear (tracker->claimed, tracker->image->width,
      tracker->image->height, (guint) (columns * rows));
  g_array_set_size (tracker->claims, 0);
  for (gint row = 0; row < rows; row++)
    for (gint column = 0; column < columns; column++) {
      gint same[4], other[4];

      if (!cloth_quad_cell (tracker, column, row)->found)
        continue;
      look_up (tracker, column, row, same, other);
      note (tracker, column, row, same, other);
    }
}

gboolean
cloth_quad_claim (ClothQuadTracker * tracker, gint column, gint row)
{
  gint same[4], other[4];

  if (look_up (tracker, column, row, same, other) > 0)
    return FALSE;
  note (tracker, column, row, same, other);
  return TRUE;
}

/* For how many more of a square's corners others say that they are another vertex than that
 * they are the same. */
static gint
count_against (ClothQuadTracker * tracker, const ClothQuadCell * cell)
{
  gint against = 0;

  for (gint k = 0; k < 4; k++)
    against += claim_at (tracker, cell->claim[k])->contested
        - claim_at (tracker, cell->claim[k])->agreed;
  return against;
}

/* Gives up those squares that @least corners speak against, for 0 those that are not
 * consistent. */
static void
drop (ClothQuadTracker * tracker, gint least)
{
  const gint columns = tracker->pattern.columns, rows = tracker->pattern.rows;
  gboolean dropped = FALSE;

  for (gint row = 0; row < rows; row++)
    for (gint column = 0; column < columns; column++) {
      ClothQuadCell *cell = cloth_quad_cell (tracker, column, row);

      if (!cell->found
          || (least > 0 ? count_against (tracker,
                  cell) < least : cloth_quad_is_consistent (tracker, column,
                  row)))
        continue;
      cell->found = FALSE;
      dropped = TRUE;
    }
  if (dropped)
    cloth_quad_claim_all (tracker);
}

/* Where a fold joins the pieces of squares into what looks like one, others know better what
 * its corners are. It is given up first, so that nothing speaks against these. */
void
cloth_quad_check (ClothQuadTracker * tracker)
{
  drop (tracker, 2);
  drop (tracker, 1);
  drop (tracker, 0);
}

/* Where the squares found have a vertex of the board. */
static gboolean
find_vertex (ClothQuadTracker * tracker, gint column, gint row, gfloat * x,
    gfloat * y)
{
  for (gint k = 0; k < 4; k++) {
    const ClothQuadCell *cell = cloth_quad_cell (tracker,
        column - cloth_quad_corner_column[k], row - cloth_quad_corner_row[k]);

    if (!cell || !cell->found)
      continue;
    *x = cell->here_x[k];
    *y = cell->here_y[k];
    return TRUE;
  }
  return FALSE;
}

/* Length of the board's edge from one vertex to another, 0: not known. */
static gfloat
length_between (ClothQuadTracker * tracker, gint c0, gint r0, gint c1, gint r1)
{
  gfloat x[2], y[2];

  return find_vertex (tracker, c0, r0, &x[0], &y[0])
      && find_vertex (tracker, c1, r1, &x[1], &y[1])
      ? hypotf (x[1] - x[0], y[1] - y[0]) : 0;
}

/* Whether an edge of a square that leads to the board's rim ends short of it: the one from
 * corner @from to @to, which is as long as what comes before it there or, where that is not
 * seen, before the square's other edge of that direction. */
static gboolean
is_short (ClothQuadTracker * tracker, gint column, gint row, gint from, gint to)
{
  const ClothQuadCell *cell = cloth_quad_cell (tracker, column, row);
  const gint dc = cloth_quad_corner_column[to] - cloth_quad_corner_column[from];
  const gint dr = cloth_quad_corner_row[to] - cloth_quad_corner_row[from];
  /* The corner beside @from that is not @to. */
  const gint beside = (2 * from - to) & 3;
  const gfloat length = hypotf (cell->here_x[to] - cell->here_x[from],
      cell->here_y[to] - cell->here_y[from]);
  const gboolean steady = cell->age == 0
      && length >= STEADY * hypotf (cell->x[to] - cell->x[from],
      cell->y[to] - cell->y[from]);
  gfloat before = 0;

  for (gint way = 0; way < 2 && before == 0; way++) {
    const gint k = way ? beside : from;
    const gint c = column + cloth_quad_corner_column[k];
    const gint r = row + cloth_quad_corner_row[k];

    before = length_between (tracker, c, r, c - dc, r - dr);
  }
  return length < (steady ? LEAST_STEADY : LEAST_RIM) * before;
}

/* What lies before the board may cut off the squares of its rim: what is left of them looks
 * whole, for the corners there are no saddles. Those that were never seen longer may end
 * there: at the edge of a sheet of paper. */
void
cloth_quad_drop_short (ClothQuadTracker * tracker)
{
  const gint columns = tracker->pattern.columns, rows = tracker->pattern.rows;
  gint n_cut = 0;

  for (gint row = 0; row < rows; row++)
    for (gint column = 0; column < columns; column++) {
      ClothQuadCell *cell = cloth_quad_cell (tracker, column, row);
      /* whether the edge from corner k to the next lies on the rim */
      const gboolean on_rim[4] = { row == 0, column + 1 == columns,
        row + 1 == rows, column == 0
      };

      if (!cell->found)
        continue;
      cell->cut = FALSE;
      for (gint k = 0; k < 4; k++) {
        if (!on_rim[k])
          continue;
        if (is_short (tracker, column, row, (k + 3) & 3, k)
            || is_short (tracker, column, row, (k + 2) & 3, (k + 1) & 3))
          cell->cut |= cell->whole >> k & 1;
        else
          cell->whole |= 1 << k;
      }
      n_cut += cell->cut;
    }
  for (gint k = 0; n_cut && k < columns * rows; k++)
    tracker->cells[k].found &= !tracker->cells[k].cut;
}
