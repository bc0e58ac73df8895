/* Where on the board a patch lies.
 *
 * Every way to lay the patch on the board is scored by what speaks for and against it:
 * squares that would stick out over the rim, cells just beyond the patch that show cloth
 * where the board should go on, the dots of a coded board, the tracker's memory, and, as
 * a plain checkerboard may look the same upside down, that it is more often upright.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/place.h"

#include <math.h>

/* Log-likelihood of a square, or an inner corner, seen where the board has none. */
#define OUTSIDE -6.0f
/* Squares by which a patch may stick out: clutter may have joined it. */
#define SLACK 1
/* Weight of a plain board being upright. */
#define UPRIGHT 3.0f

/* What a cell or an inner corner of the patch says, in the patch's own grid. */
typedef struct
{
  gint i, j;
  gboolean corner;              /* four squares meet at vertex (i, j) */
  gfloat on_board;              /* score if it lies on the board */
  gfloat off_board;             /* score if it doesn't */
  gfloat bit;                   /* added if the square there is coded 1, else taken off */
} Evidence;

static void
turn (gint rotation, gint i, gint j, gint * column, gint * row)
{
  static const gint c_i[4] = { 1, 0, -1, 0 }, c_j[4] = { 0, -1, 0, 1 };

  *column = c_i[rotation] * i + c_j[rotation] * j;
  *row = -c_j[rotation] * i + c_i[rotation] * j;
}

/**
 * cloth_placement_vertex:
 * @placement: a placement
 * @i: column of a vertex of the patch
 * @j: row of it
 * @column: (out): column of the same vertex on the board
 * @row: (out): row of it
 *
 * Since: 0.1
 */
void
cloth_placement_vertex (const ClothPlacement * placement, gint i, gint j,
    gint * column, gint * row)
{
  turn (placement->rotation, i, j, column, row);
  *column += placement->column;
  *row += placement->row;
}

/**
 * cloth_placement_cell:
 * @placement: a placement
 * @i: column of a cell of the patch, right of vertex @i
 * @j: row of it
 * @column: (out): column of the same cell on the board
 * @row: (out): row of it
 *
 * Since: 0.1
 */
void
cloth_placement_cell (const ClothPlacement * placement, gint i, gint j,
    gint * column, gint * row)
{
  cloth_placement_vertex (placement, i, j, column, row);
  /* The cell's first corner is another one after a turn. */
  if (placement->rotation == 1 || placement->rotation == 2)
    (*column)--;
  if (placement->rotation >= 2)
    (*row)--;
}

static void
gather (const ClothPatch * patch, GArray * evidence, gint box[4])
{
  g_array_set_size (evidence, 0);
  box[0] = box[1] = G_MAXINT;
  box[2] = box[3] = G_MININT;
  for (gint j = 0; j + 1 < patch->rows; j++)
    for (gint i = 0; i + 1 < patch->columns; i++) {
      gint at = j * patch->columns + i;
      Evidence e = { i, j, FALSE, 0, 0, 0 };

      if (patch->kind[at] == CLOTH_VERTEX_SADDLE) {
        Evidence corner = { i, j, TRUE, 0, OUTSIDE, 0 };

        g_array_append_val (evidence, corner);
      }
      if (patch->square[at]) {
        e.off_board = OUTSIDE;
        e.bit = patch->bit[at];
        box[0] = MIN (box[0], i);
        box[1] = MIN (box[1], j);
        box[2] = MAX (box[2], i);
        box[3] = MAX (box[3], j);
      } else if (patch->inside[at] != 0) {
        e.on_board = patch->inside[at];
      } else {
        continue;
      }
      g_array_append_val (evidence, e);
    }
}

/* The way the board's columns run in the picture under a rotation, as the cosine of the
 * angle to +x. */
static gfloat
uprightness (const ClothPatch * patch, gint rotation)
{
  gfloat dx = 0, dy = 0;
  gint n = patch->columns;

  for (gint j = 0; j < patch->rows; j++)
    for (gint i = 0; i + 1 < n; i++) {
      gint at = j * n + i;
      gint along = (rotation & 1) ? n : 1;

      if ((rotation & 1) && j + 1 >= patch->rows)
        continue;
      if (!patch->kind[at] || !patch->kind[at + along])
        continue;
      dx += patch->x[at + along] - patch->x[at];
      dy += patch->y[at + along] - patch->y[at];
    }
  if (dx == 0 && dy == 0)
    return 0;
  /* Rotation 1 sends the patch's -j onto the board's columns, 2 its -i, 3 its +j. */
  return (rotation == 1 || rotation == 2 ? -dx : dx) / hypotf (dx, dy);
}

static gfloat
score_placement (const ClothPattern * pattern, const Evidence * evidence,
    guint n, const ClothPlacement * placement)
{
  gfloat score = 0;

  for (guint k = 0; k < n; k++) {
    const Evidence *e = &evidence[k];
    gint column, row;

    if (e->corner) {
      cloth_placement_vertex (placement, e->i, e->j, &column, &row);
      /* Not even on the rim do four squares meet. */
      if (column < 1 || row < 1 || column >= pattern->columns
          || row >= pattern->rows)
        score += e->off_board;
      continue;
    }
    cloth_placement_cell (placement, e->i, e->j, &column, &row);
    if (column < 0 || row < 0 || column >= pattern->columns
        || row >= pattern->rows)
      score += e->off_board;
    else if (pattern->code)
      score += e->on_board
          + (pattern->code[row * pattern->columns + column] ? e->bit : -e->bit);
    else
      score += e->on_board;
  }
  return score;
}

/**
 * cloth_place_patch:
 * @pattern: the board
 * @patch: a patch of it
 * @votes: (array length=n_votes) (nullable): placements the caller believes in, weight =
 *   log-likelihood
 * @n_votes: how many
 * @scratch: memory from cloth_place_scratch_new()
 * @best: (out): the best placement; weight = its lead over the next best
 *
 * Returns: whether the patch fits the board anywhere
 *
 * Since: 0.1
 */
gboolean
cloth_place_patch (const ClothPattern * pattern, const ClothPatch * patch,
    const ClothPlacement * votes, guint n_votes, GArray * scratch,
    ClothPlacement * best)
{
  gfloat first = -G_MAXFLOAT, second = -G_MAXFLOAT;
  gint box[4];

  gather (patch, scratch, box);
  if (box[0] > box[2])
    return FALSE;
  for (gint rotation = 0; rotation < 4; rotation++) {
    ClothPlacement try = { rotation, 0, 0, 0 };
    gint c0, r0, c1, r1, shift;
    gfloat prior = pattern->code ? 0 : UPRIGHT * uprightness (patch, rotation);
    gboolean black = cloth_patch_is_black (patch, box[0], box[1]);

    cloth_placement_cell (&try, box[0], box[1], &c0, &r0);
    cloth_placement_cell (&try, box[2], box[3], &c1, &r1);
    /* The board cell that the box's first cell falls on must have its colour. */
    shift = cloth_pattern_is_black (pattern, c0 & 1, r0 & 1) == black ? 0 : 1;
    for (try.row = -SLACK - MIN (r0, r1);
        try.row <= pattern->rows - 1 + SLACK - MAX (r0, r1); try.row++)
      for (try.column = -SLACK - MIN (c0, c1);
          try.column <= pattern->columns - 1 + SLACK - MAX (c0, c1);
          try.column++) {
        gfloat score;

        if (((try.row + try.column) & 1) != shift)
          continue;
        score = prior + score_placement (pattern,
            &g_array_index (scratch, Evidence, 0), scratch->len, &try);
        for (guint k = 0; k < n_votes; k++)
          if (votes[k].rotation == rotation && votes[k].column == try.column
              && votes[k].row == try.row)
            score += votes[k].weight;
        if (score > first) {
          second = first;
          first = score;
          *best = try;
        } else if (score > second) {
          second = score;
        }
      }
  }
  if (first == -G_MAXFLOAT)
    return FALSE;
  best->weight = second == -G_MAXFLOAT ? -OUTSIDE : first - second;
  return TRUE;
}

/**
 * cloth_place_scratch_new:
 *
 * Returns: (transfer full): memory for cloth_place_patch() to work in.
 *
 * Since: 0.1
 */
GArray *
cloth_place_scratch_new (void)
{
  return g_array_new (FALSE, FALSE, sizeof (Evidence));
}
