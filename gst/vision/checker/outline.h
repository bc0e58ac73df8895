/* The outline of one square, completed from some of its corners.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/image.h"

G_BEGIN_DECLS

/* @x: columns of the corners in ring order, turning from x towards y, px
 * @y: rows of them
 * @cov: covariance xx, xy, yy of each, px²
 * @have: which corners are there; the others are guesses
 * @saddle: which corners have black and white alternating around them
 * @sure: which corners left little to explain when fitted; at the others something else
 *   than squares may meet
 * @thorough: whether to try a smaller window where the usual one fails
 * @joined: which edges, from corner k to k + 1, are known to be edges
 */
typedef struct {
  gfloat x[4], y[4];
  gfloat cov[4][3];
  gboolean have[4];
  gboolean saddle[4];
  gboolean sure[4];
  gboolean thorough;
  gboolean joined[4];
} ClothOutline;

gboolean cloth_outline_fit (ClothOutline * outline, const ClothImage * image,
    gint corner, gfloat x, gfloat y, gfloat max_shift, gboolean black);
gboolean cloth_outline_complete (ClothOutline * outline,
    const ClothImage * image, gboolean black);

G_END_DECLS
