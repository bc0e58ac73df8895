/* Tracking the squares of a checkerboard on cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/pattern/pattern.h"
#include "gst/vision/image.h"
#include "gst/vision/corner/saddle.h"

G_BEGIN_DECLS

/* @CLOTH_QUAD_TRACKED: seen in this picture
 * @CLOTH_QUAD_PREDICTED: not seen; placed by its past motion and its neighbours
 * @CLOTH_QUAD_LOST: was tracked or predicted in the last picture and is no more; its
 *   corners are where it was guessed last
 */
typedef enum {
  CLOTH_QUAD_TRACKED,
  CLOTH_QUAD_PREDICTED,
  CLOTH_QUAD_LOST
} ClothQuadState;

/* @CLOTH_SQUARES_BLACK: the black squares, as the paper does
 * @CLOTH_SQUARES_WHITE: the white ones
 * @CLOTH_SQUARES_BOTH: all of them
 *
 * Which squares are tracked.
 */
typedef enum {
  CLOTH_SQUARES_BLACK,
  CLOTH_SQUARES_WHITE,
  CLOTH_SQUARES_BOTH
} ClothSquares;

/* @column: column of the square on the board
 * @row: row of it
 * @state: whether it was seen
 * @black: its colour
 * @confidence: template confidence, [-1, 1]
 * @x: columns of its corners, px: top-left, top-right, bottom-right, bottom-left as they
 *   lie on the flat board
 * @y: rows of them
 * @cov: covariance xx, xy, yy of each corner, px²
 */
typedef struct {
  gint column, row;
  ClothQuadState state;
  gboolean black;
  gfloat confidence;
  gfloat x[4], y[4];
  gfloat cov[4][3];
} ClothQuad;

/* @alpha: width of the template's lapels over the square's edge (paper: 0.25)
 * @c_low: confidence below which a square is given up (paper: 0.62)
 * @c_high: confidence at which the search for a better match stops (paper: 0.75)
 * @c_pred: confidence from which a square may predict its neighbours (paper: 0.7)
 * @damping: factor on the confidence of a square just added (paper: 0.9)
 * @consistency: distance, over the largest square's size, up to which two squares agree on
 *   a common corner (paper: 0.4)
 * @max_variants: most corner triples tried for a square
 * @link: whether to join saddles into patches first; without it a square must be given and
 *   the tracker is the paper's alone
 * @squares: which squares are tracked
 */
typedef struct {
  gfloat alpha;
  gfloat c_low, c_high, c_pred;
  gfloat damping;
  gfloat consistency;
  guint max_variants;
  gboolean link;
  ClothSquares squares;
} ClothQuadParams;

typedef struct _ClothQuadTracker ClothQuadTracker;

ClothQuadParams cloth_quad_default_params (void);

ClothQuadTracker *cloth_quad_tracker_new (const ClothPattern * pattern);
void cloth_quad_tracker_free (ClothQuadTracker * tracker);
void cloth_quad_tracker_reset (ClothQuadTracker * tracker);
void cloth_quad_tracker_seed (ClothQuadTracker * tracker, const gfloat x[4],
    const gfloat y[4], gint column, gint row);
const ClothQuad *cloth_quad_tracker_run (ClothQuadTracker * tracker,
    const ClothQuadParams * params, const ClothImage * image,
    const ClothSaddle * saddles, guint n_saddles,
    const ClothSaddleCandidate * candidates, guint n_candidates,
    guint * n_quads);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothQuadTracker, cloth_quad_tracker_free)
G_END_DECLS
