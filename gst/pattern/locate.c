/* Finds a patch of observed squares on a coded checkerboard.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/pattern/code.h"

#include <string.h>

/* Log-likelihood ratios become whole numbers, so that the sum is exact, the same in any
 * order, and 8 of them fit one SSE register; beyond the limit they saturate, so that no
 * single square decides. 500·500·16·128 fits 32 bits. */
#define STEPS_PER_NAT 128
#define MAX_NATS 16
#define LANES 8

struct _ClothCodeLocator
{
  gint columns, rows;
  gboolean first_black;
  guint8 *code;

  /* The board as +1 (dot), −1 (none), with a margin of zeros all round so that a patch
   * may hang over. */
  gint16 *board;
  gint margin, stride;

  /* One turned patch, its rows padded with zeros, and its integral of absolutes. */
  gint16 *patch;
  gint32 *integral;
};

/**
 * cloth_code_locator_new:
 * @pattern: a coded board; not needed afterwards
 *
 * Returns: (transfer full) (nullable): a locator, to be used by one thread at a time;
 *   %NULL when @pattern has no code
 *
 * Since: 0.1
 */
ClothCodeLocator *
cloth_code_locator_new (const ClothPattern * pattern)
{
  ClothCodeLocator *locator;

  if (!pattern->code)
    return NULL;
  locator = g_new0 (ClothCodeLocator, 1);
  locator->columns = pattern->columns;
  locator->rows = pattern->rows;
  locator->first_black = !!pattern->first_black;
  locator->code =
      g_memdup2 (pattern->code, (gsize) pattern->columns * pattern->rows);
  return locator;
}

/**
 * cloth_code_locator_free:
 * @locator: (nullable) (transfer full): a locator
 *
 * Since: 0.1
 */
void
cloth_code_locator_free (ClothCodeLocator * locator)
{
  if (!locator)
    return;
  g_free (locator->code);
  g_free (locator->board);
  g_free (locator->patch);
  g_free (locator->integral);
  g_free (locator);
}

/* Grows the buffers for patches of up to @extent squares each way. */
static void
locator_reserve (ClothCodeLocator * locator, gint extent)
{
  const gint margin = (extent + LANES - 1) / LANES * LANES;

  if (locator->board && margin <= locator->margin)
    return;
  g_free (locator->board);
  g_free (locator->patch);
  g_free (locator->integral);
  locator->margin = margin;
  /* The last row's padded patch ends within the next row. */
  locator->stride = locator->columns + 2 * margin;
  locator->board = g_new0 (gint16,
      (gsize) locator->stride * (gsize) (locator->rows + 2 * margin + 1));
  for (gint row = 0; row < locator->rows; row++) {
    for (gint column = 0; column < locator->columns; column++)
      locator->board[(row + margin) * locator->stride + column + margin] =
          locator->code[row * locator->columns + column] ? 1 : -1;
  }
  locator->patch = g_new0 (gint16, (gsize) margin * (gsize) margin);
  locator->integral =
      g_new0 (gint32, (gsize) (margin + 1) * (gsize) (margin + 1));
}

/* The part of the observed patch that has anything known, turned. */
typedef struct
{
  gint width, height, padded;
  /* Where the patch's square (0, 0) lies from the turned part's top-left one. */
  gint anchor_x, anchor_y;
  gboolean first_black;
} Turned;

static gint16
quantise (gfloat llr)
{
  gfloat steps = CLAMP (llr, -MAX_NATS, MAX_NATS) * STEPS_PER_NAT;

  if (llr != llr)
    return 0;
  return (gint16) (steps + (steps < 0 ? -0.5f : 0.5f));
}

static void
turn_patch (ClothCodeLocator * locator, const gfloat * llr, gint columns,
    const gint box[4], gboolean first_black, gint rotation, Turned * turned)
{
  const ClothCodePlacement turn = { 0, 0, rotation, 0 };
  gint x0, y0, x1, y1, stride;

  cloth_code_square (&turn, box[0], box[1], &x0, &y0);
  cloth_code_square (&turn, box[2], box[3], &x1, &y1);
  turned->anchor_x = -MIN (x0, x1);
  turned->anchor_y = -MIN (y0, y1);
  turned->width = ABS (x1 - x0) + 1;
  turned->height = ABS (y1 - y0) + 1;
  turned->padded = (turned->width + LANES - 1) / LANES * LANES;
  /* Colours turn with the squares, so parities in patch coordinates still hold. */
  turned->first_black =
      (((turned->anchor_x + turned->anchor_y) & 1) == 0) == !!first_black;
  memset (locator->patch, 0, sizeof (gint16) * (gsize) turned->padded *
      (gsize) turned->height);
  for (gint j = box[1]; j <= box[3]; j++) {
    for (gint i = box[0]; i <= box[2]; i++) {
      gint x, y;

      cloth_code_square (&turn, i, j, &x, &y);
      locator->patch[(y + turned->anchor_y) * turned->padded + x +
          turned->anchor_x] = quantise (llr[j * columns + i]);
    }
  }
  stride = turned->width + 1;
  memset (locator->integral, 0, sizeof (gint32) * (gsize) stride);
  for (gint y = 0; y < turned->height; y++) {
    gint32 *above = locator->integral + y * stride;
    gint32 sum = 0;

    above[stride] = 0;
    for (gint x = 0; x < turned->width; x++) {
      sum += ABS (locator->patch[y * turned->padded + x]);
      above[stride + x + 1] = above[x + 1] + sum;
    }
  }
}

static gint32
dot (const gint16 * board, gint stride, const gint16 * patch, gint padded,
    gint rows)
{
  gint32 sum = 0;

  for (gint y = 0; y < rows; y++) {
    for (gint x = 0; x < padded; x += LANES) {
      for (gint lane = 0; lane < LANES; lane++)
        sum += board[x + lane] * patch[x + lane];
    }
    board += stride;
    patch += padded;
  }
  return sum;
}

static void
take_score (gint32 score, gint column, gint row, gint rotation,
    gint32 scores[2], ClothCodePlacement placements[2])
{
  const ClothCodePlacement placement = { column, row, rotation,
    0.5 * score / STEPS_PER_NAT
  };

  if (score > scores[0]) {
    scores[1] = scores[0];
    placements[1] = placements[0];
    scores[0] = score;
    placements[0] = placement;
  } else if (score > scores[1]) {
    scores[1] = score;
    placements[1] = placement;
  }
}

static void
score_rotation (ClothCodeLocator * locator, const Turned * turned,
    gint rotation, gint32 scores[2], ClothCodePlacement placements[2])
{
  const gint stride = turned->width + 1;
  const gint32 *integral = locator->integral;
  const gint32 total = integral[turned->height * stride + turned->width];

  for (gint row = 1 - turned->height; row < locator->rows; row++) {
    const gint y0 = MAX (0, -row);
    const gint y1 = MIN (turned->height, locator->rows - row);
    /* The same colour under the top-left square. */
    const gint parity =
        (row & 1) ^ (turned->first_black != locator->first_black);
    gint column = 1 - turned->width;

    for (column += (column & 1) != parity; column < locator->columns;
        column += 2) {
      const gint x0 = MAX (0, -column);
      const gint x1 = MIN (turned->width, locator->columns - column);
      const gint32 inside = integral[y1 * stride + x1]
          - integral[y0 * stride + x1] - integral[y1 * stride + x0]
          + integral[y0 * stride + x0];
      const gint32 outside = total - inside;
      gint32 sum;

      if (inside - outside <= scores[1])
        continue;
      sum = dot (locator->board + (row + y0 + locator->margin)
          * locator->stride + column + locator->margin, locator->stride,
          locator->patch + y0 * turned->padded, turned->padded, y1 - y0);
      take_score (sum - outside, column + turned->anchor_x,
          row + turned->anchor_y, rotation, scores, placements);
    }
  }
}

/**
 * cloth_code_locate:
 * @locator: of the board
 * @llr: (array): @rows·@columns, for each observed square the logarithm of
 *   P(observation | dot) over P(observation | no dot), 0 where unknown; not a number
 *   counts as unknown, values saturate at ±16
 * @columns: squares in a row of the patch, 1 to 500
 * @rows: squares in a column of the patch, 1 to 500
 * @first_black: whether the patch's square (0, 0) is black, seen or not
 * @best: (out): the likeliest placement
 * @second: (out): the runner-up; its score is `-G_MAXDOUBLE` when there is none
 *
 * Scores every placement of the patch, in all four rotations, that lays black squares
 * on black ones. A known square that comes to lie outside the board counts as misread.
 * The margin `best->score - second->score` says how sure the place is: it is the
 * logarithm of their likelihoods' ratio. Equal scores (nothing known, a board's
 * symmetry) have a margin of 0.
 *
 * Returns: %FALSE when nothing is known or no placement fits; @best and @second are
 *   then not set
 *
 * Since: 0.1
 */
gboolean
cloth_code_locate (ClothCodeLocator * locator, const gfloat * llr,
    gint columns, gint rows, gboolean first_black, ClothCodePlacement * best,
    ClothCodePlacement * second)
{
  ClothCodePlacement placements[2] = { {0, 0, 0, -G_MAXDOUBLE},
  {0, 0, 0, -G_MAXDOUBLE}
  };
  gint32 scores[2] = { G_MININT32, G_MININT32 };
  gint box[4] = { G_MAXINT, G_MAXINT, -1, -1 };

  g_return_val_if_fail (columns >= 1 && columns <= CLOTH_PATTERN_MAX_SQUARES,
      FALSE);
  g_return_val_if_fail (rows >= 1 && rows <= CLOTH_PATTERN_MAX_SQUARES, FALSE);
  for (gint j = 0; j < rows; j++) {
    for (gint i = 0; i < columns; i++) {
      if (quantise (llr[j * columns + i])) {
        box[0] = MIN (box[0], i);
        box[1] = MIN (box[1], j);
        box[2] = MAX (box[2], i);
        box[3] = MAX (box[3], j);
      }
    }
  }
  if (box[2] < 0)
    return FALSE;
  locator_reserve (locator, MAX (columns, rows));
  for (gint rotation = 0; rotation < 4; rotation++) {
    Turned turned;

    turn_patch (locator, llr, columns, box, first_black, rotation, &turned);
    score_rotation (locator, &turned, rotation, scores, placements);
  }
  if (scores[0] == G_MININT32)
    return FALSE;
  *best = placements[0];
  *second = placements[1];
  return TRUE;
}
