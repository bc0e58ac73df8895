/* The code of a coded checkerboard: dots that tell where on the board a patch lies.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/pattern/pattern.h"

G_BEGIN_DECLS

/**
 * CLOTH_CODE_DISTANCE:
 *
 * Least number of dots by which any two windows of a generated code differ, in all
 * rotations.
 *
 * Since: 0.1
 */
#define CLOTH_CODE_DISTANCE 3

/**
 * CLOTH_CODE_DOT_RATIO:
 *
 * Default diameter of a dot over the edge of its square. A dot takes 7% of its square,
 * so the confidence of a black square that carries one is still 0.93.
 *
 * Since: 0.1
 */
#define CLOTH_CODE_DOT_RATIO 0.3

/**
 * ClothCodePlacement:
 * @column: column of the board's square under the patch's square (0, 0); outside the
 *   board where the patch hangs over its edge
 * @row: its row
 * @rotation: clockwise quarter turns (seen with x right and y down) that lay the patch
 *   on the board
 * @score: sum over the patch of the log-likelihood ratios that this placement's dots
 *   pick, halved, nats: the difference of two placements' scores is the logarithm of
 *   the ratio of their likelihoods
 *
 * Where a patch of squares lies on the board.
 *
 * Since: 0.1
 */
typedef struct {
  gint column, row;
  gint rotation;
  gdouble score;
} ClothCodePlacement;

gboolean cloth_code_generate (ClothPattern * pattern, gdouble dot_ratio,
    guint64 seed, gint * window, GError ** error);

typedef struct _ClothCodeLocator ClothCodeLocator;

ClothCodeLocator *cloth_code_locator_new (const ClothPattern * pattern);
void cloth_code_locator_free (ClothCodeLocator * locator);
gboolean cloth_code_locate (ClothCodeLocator * locator, const gfloat * llr,
    gint columns, gint rows, gboolean first_black, ClothCodePlacement * best,
    ClothCodePlacement * second);

/**
 * cloth_code_square:
 * @placement: a placement
 * @i: column in the patch
 * @j: row in the patch
 * @column: (out): column on the board
 * @row: (out): row on the board
 *
 * The board's square under the patch's square (@i, @j).
 *
 * Since: 0.1
 */
static inline void
cloth_code_square (const ClothCodePlacement * placement, gint i, gint j,
    gint * column, gint * row)
{
  static const gint turn[4][2] = { {1, 0}, {0, 1}, {-1, 0}, {0, -1} };
  const gint c = turn[placement->rotation & 3][0];
  const gint s = turn[placement->rotation & 3][1];

  *column = placement->column + c * i - s * j;
  *row = placement->row + s * i + c * j;
}

/**
 * cloth_code_vertex:
 * @placement: a placement
 * @i: column in the patch, 0 to its columns inclusive
 * @j: row in the patch, 0 to its rows inclusive
 * @column: (out): column on the board
 * @row: (out): row on the board
 *
 * The board's corner under the patch's corner (@i, @j), the top-left one of square
 * (@i, @j). A board of n columns has n + 1 columns of corners.
 *
 * Since: 0.1
 */
static inline void
cloth_code_vertex (const ClothCodePlacement * placement, gint i, gint j,
    gint * column, gint * row)
{
  const gint q = placement->rotation & 3;

  /* Squares turn about their centres, half a square from their corners. */
  cloth_code_square (placement, i, j, column, row);
  *column += q == 1 || q == 2;
  *row += q == 2 || q == 3;
}

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothCodeLocator, cloth_code_locator_free)
G_END_DECLS
