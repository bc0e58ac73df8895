/* Where on the board a patch of one picture lies, half hidden as it may be.
 *
 * Every way to lay the patch on the board is scored by what speaks for and against it:
 * squares that would stick out over the rim, cells just beyond the patch that show cloth
 * where the board should go on, the dots of a coded board, the tracker's memory, and, as
 * a plain checkerboard may look the same upside down, that it is more often upright.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/place-board.h"

#include <math.h>

/* Log-likelihood of a square, and of an inner corner, seen where the board has none. */
#define OUTSIDE -6.0f
#define CORNER_OUTSIDE -2.5f
/* Log-likelihood of a corner that is no saddle where the board has an inner corner, where
 * several lie on a straight rim and where one stands alone: something may cover the other
 * squares there. */
#define CUT_RIM -3.0f
#define CUT_CORNER -0.5f
/* A rim is straight when its corners are this near to a line, in squares. */
#define EVEN 0.2f
/* Squares by which a patch may stick out: clutter may have joined it. */
#define SLACK 1
/* Weight of a plain board being upright. */
#define UPRIGHT 3.0f

/* What a cell or an inner corner of the patch says, in the patch's own grid. */
typedef struct
{
  gint i, j;
  gboolean corner;              /* of vertex (i, j), not of a cell */
  gfloat on_board;              /* score if it lies on the board; inside its rim */
  gfloat off_board;             /* score if it doesn't */
  gfloat bit;                   /* added if the square there is coded 1, else taken off */
} Evidence;

struct _ClothBoardScratch
{
  GArray *evidence;             /* Evidence */
  GArray *placements;           /* ClothPlacement */
};

static const gint step_i[4] = { 1, 0, -1, 0 };
static const gint step_j[4] = { 0, 1, 0, -1 };

/* How far vertex (@i, @j) lies beyond the one before it, seen from inside the patch, over
 * the distance of that from the one before; 0 when not all three were seen. */
static gfloat
stride_out (const ClothPatch * patch, gint i, gint j, gint di, gint dj)
{
  gint n = patch->columns, at = j * n + i, step = dj * n + di;
  gfloat length;

  if (i < 0 || j < 0 || i >= n || j >= patch->rows || i - 2 * di < 0
      || j - 2 * dj < 0 || i - 2 * di >= n || j - 2 * dj >= patch->rows
      || !patch->kind[at] || !patch->kind[at - step]
      || !patch->kind[at - 2 * step])
    return 0;
  length = hypotf (patch->x[at - step] - patch->x[at - 2 * step],
      patch->y[at - step] - patch->y[at - 2 * step]);
  return hypotf (patch->x[at] - patch->x[at - step],
      patch->y[at] - patch->y[at - step]) / MAX (length, 1e-3f);
}

/* Whether a corner that is no saddle continues the grid as the one beside it does: a rim
 * is as straight as the grid, the edge of what covers the board is not. */
static gboolean
is_rim (const ClothPatch * patch, gint i, gint j)
{
  for (gint side = 0; side < 4; side++) {
    gint di = step_i[side], dj = step_j[side];
    gfloat own = stride_out (patch, i, j, di, dj);

    if (own == 0 || (i + di >= 0 && i + di < patch->columns && j + dj >= 0
            && j + dj < patch->rows
            && patch->kind[(j + dj) * patch->columns + i + di]))
      continue;
    for (gint way = -1; way <= 1; way += 2) {
      gfloat beside = stride_out (patch, i - way * dj, j + way * di, di, dj);

      if (beside > 0 && fabsf (beside - own) < EVEN * MAX (own, beside))
        return TRUE;
    }
  }
  return FALSE;
}

/* What vertex (@i, @j) says; FALSE for nothing. The edge of what hides a board cuts its
 * squares. On cloth folds do that all the time, which is why the tracker weighs otherwise. */
static gboolean
weigh_corner (const ClothPatch * patch, gint i, gint j, Evidence * corner)
{
  gint at = j * patch->columns + i;

  *corner = (Evidence) {
  i, j, TRUE, 0, 0, 0};
  if (patch->linked[at])
    corner->off_board = CORNER_OUTSIDE;
  else
    corner->on_board = is_rim (patch, i, j) ? CUT_RIM : CUT_CORNER;
  return patch->linked[at] || patch->kind[at] >= CLOTH_VERTEX_UNSURE;
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
      Evidence e = { i, j, FALSE, 0, 0, 0 }, corner;

      if (weigh_corner (patch, i, j, &corner))
        g_array_append_val (evidence, corner);
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
      score += column < 1 || row < 1 || column >= pattern->columns
          || row >= pattern->rows ? e->off_board : e->on_board;
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

/* Whether two placements differ by a turn that leaves a plain board as it looks. */
static gboolean
are_twins (const ClothPattern * pattern, const ClothPlacement * a,
    const ClothPlacement * b)
{
  gboolean square = pattern->columns == pattern->rows;
  ClothPlacement turned = *a;

  if (pattern->code)
    return FALSE;
  for (gint quarter = 1; quarter < 4; quarter++) {
    /* The board turned about its middle: (c, r) becomes (rows - r, c). */
    turned = (ClothPlacement) {
    (turned.rotation + 1) & 3, (quarter & 1 ? pattern->rows
          : pattern->columns) - turned.row, turned.column, 0};
    if ((quarter & 1) && !(square && (pattern->columns & 1)))
      continue;
    if (quarter == 2 && ((pattern->columns + pattern->rows) & 1))
      continue;
    if (turned.rotation == b->rotation && turned.column == b->column
        && turned.row == b->row)
      return TRUE;
  }
  return FALSE;
}

/* All placements that are possible by colour, and by the patch's extent, but for some
 * overhang. */
static void
list_placements (const ClothPattern * pattern, const ClothPatch * patch,
    const gint box[4], const ClothPlacement * votes, guint n_votes,
    ClothBoardScratch * scratch)
{
  gboolean black = cloth_patch_is_black (patch, box[0], box[1]);

  g_array_set_size (scratch->placements, 0);
  for (gint rotation = 0; rotation < 4; rotation++) {
    ClothPlacement try = { rotation, 0, 0, 0 };
    gint c0, r0, c1, r1, shift;

    cloth_placement_cell (&try, box[0], box[1], &c0, &r0);
    cloth_placement_cell (&try, box[2], box[3], &c1, &r1);
    /* The board cell that the box's first cell falls on must have its colour. */
    shift = cloth_pattern_is_black (pattern, c0 & 1, r0 & 1) == black ? 0 : 1;
    for (try.row = -SLACK - MIN (r0, r1);
        try.row <= pattern->rows - 1 + SLACK - MAX (r0, r1); try.row++)
      for (try.column = -SLACK - MIN (c0, c1);
          try.column <= pattern->columns - 1 + SLACK - MAX (c0, c1);
          try.column++) {
        if (((try.row + try.column) & 1) != shift)
          continue;
        try.weight = score_placement (pattern,
            (const Evidence *) scratch->evidence->data, scratch->evidence->len,
            &try);
        for (guint k = 0; k < n_votes; k++)
          if (votes[k].rotation == rotation && votes[k].column == try.column
              && votes[k].row == try.row)
            try.weight += votes[k].weight;
        g_array_append_val (scratch->placements, try);
      }
  }
}

/**
 * cloth_place_board:
 * @pattern: the board
 * @patch: a patch of it
 * @votes: (array length=n_votes) (nullable): placements the caller believes in, weight =
 *   log-likelihood
 * @n_votes: how many
 * @scratch: memory from cloth_board_scratch_new()
 * @best: (out): the best placement; weight = its lead over the next best
 *
 * That a board is more often upright only chooses between placements that a turn of the
 * whole board carries into each other; in a single picture it gives no lead over others.
 *
 * Returns: whether the patch fits the board anywhere
 *
 * Since: 0.1
 */
gboolean
cloth_place_board (const ClothPattern * pattern, const ClothPatch * patch,
    const ClothPlacement * votes, guint n_votes, ClothBoardScratch * scratch,
    ClothPlacement * best)
{
  const ClothPlacement *list;
  gfloat prior[4] = { 0 }, most = -G_MAXFLOAT;
  guint n, first = 0;
  gint box[4];

  gather (patch, scratch->evidence, box);
  if (box[0] > box[2])
    return FALSE;
  list_placements (pattern, patch, box, votes, n_votes, scratch);
  list = (const ClothPlacement *) scratch->placements->data;
  n = scratch->placements->len;
  if (!n)
    return FALSE;
  for (gint rotation = 0; rotation < 4 && !pattern->code; rotation++)
    prior[rotation] = UPRIGHT * uprightness (patch, rotation);
  for (guint k = 0; k < n; k++)
    if (list[k].weight + prior[list[k].rotation] > most) {
      most = list[k].weight + prior[list[k].rotation];
      first = k;
    }
  *best = list[first];
  best->weight = G_MAXFLOAT;
  for (guint k = 0; k < n; k++) {
    gfloat lead = list[first].weight - list[k].weight;

    /* Of two that look the same either is right: the more upright one was taken. */
    if (k == first || are_twins (pattern, &list[first], &list[k]))
      continue;
    best->weight = MIN (best->weight, lead);
  }
  if (best->weight == G_MAXFLOAT)
    best->weight = -OUTSIDE;
  return TRUE;
}

/**
 * cloth_board_scratch_new:
 *
 * Returns: (transfer full): memory for cloth_place_board() to work in.
 *
 * Since: 0.1
 */
ClothBoardScratch *
cloth_board_scratch_new (void)
{
  ClothBoardScratch *scratch = g_new (ClothBoardScratch, 1);

  scratch->evidence = g_array_new (FALSE, FALSE, sizeof (Evidence));
  scratch->placements = g_array_new (FALSE, FALSE, sizeof (ClothPlacement));
  return scratch;
}

/**
 * cloth_board_scratch_free:
 * @scratch: (transfer full): the memory
 *
 * Since: 0.1
 */
void
cloth_board_scratch_free (ClothBoardScratch * scratch)
{
  g_array_unref (scratch->evidence);
  g_array_unref (scratch->placements);
  g_free (scratch);
}
