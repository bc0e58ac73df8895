/* The exact place of a corner where two straight edges cross.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/simd.h"
#include "gst/vision/image.h"

G_BEGIN_DECLS

/* @radius: of the window, px, 2 to 12; it should not reach the next corners
 * @max_shift: the fit fails when it moves farther than this from its start, px
 * @blur: width of the edges to start from, px
 * @linear_light: whether to fit the squares of the grey levels. Films are coded with a
 *   gamma near 2, and blur acts on light: without this the lone corner of a dark square
 *   comes out some tenths of a pixel inside. Saddles don't need it.
 * @known_angles: whether @theta holds the start
 * @theta: directions of both edges to start from, radians from +x towards +y; they may
 *   be 20 degrees off
 */
typedef struct {
  gfloat radius;
  gfloat max_shift;
  gfloat blur;
  gboolean linear_light;
  gboolean known_angles;
  gfloat theta[2];
} ClothCornerParams;

/* @x: column of the corner, px, centre of the top-left pixel at 0
 * @y: row of the corner, px
 * @cov: covariance xx, xy, yy of (@x, @y), px²
 * @theta: directions of both edges, radians from +x towards +y, in the order of the start
 * @blur: width of the edges (sigma of the Gaussian), px
 * @c: the intensity is c0 + c1·e1 + c2·e2 + c3·e1·e2 with e_i in [−1, 1] the side of
 *   edge i, positive to the left of its direction as seen with y downwards, grey levels
 * @contrast: brightest minus darkest of the four quadrants, grey levels
 * @rms: weighted residual, corrected for the fitted parameters, grey levels
 * @iterations: evaluations of the model
 *
 * A checker corner has c1 = c2 = 0, the corner of a square that stands alone
 * |c1| = |c2| = |c3|.
 */
typedef struct {
  gfloat x, y;
  gfloat cov[3];
  gfloat theta[2];
  gfloat blur;
  gfloat c[4];
  gfloat contrast;
  gfloat rms;
  gint iterations;
} ClothCornerFit;

/* Whether bright and dark alternate around the corner: edge products outweigh edges. */
static inline gboolean
cloth_corner_is_saddle (const ClothCornerFit * fit)
{
  return ABS (fit->c[3]) > ABS (fit->c[1]) + ABS (fit->c[2]);
}

ClothCornerParams cloth_corner_default_params (void);
gboolean cloth_corner_refine (const ClothImage * image, gfloat x, gfloat y,
    const ClothCornerParams * params, ClothSimd level, ClothCornerFit * fit);

G_END_DECLS
