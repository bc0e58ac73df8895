/* Which of the printed colours a dot has.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/dot/dot.h"
#include "gst/vision/label/dot-label.h"

G_BEGIN_DECLS

/* @mean: Cb and Cr of the dot over its luma, both above the ground's
 * @cov: covariance xx, xy, yy of them from dot to dot, without the picture's noise
 *
 * One colour as a camera sees it. What shading does to a colour drops out of its
 * @mean.
 */
typedef struct {
  gfloat mean[2];
  gfloat cov[3];
} ClothDotColourClass;

/* @n: number of colours, 2 to %CLOTH_DOT_COLOURS_MAX
 * @classes: the first @n of them
 * @ground: Cb and Cr of the ground, grey levels from 128
 * @noise: standard deviation of a dot's mean Cb and Cr, grey levels
 * @outliers: share of dots that look like none of the colours
 * @seen: how many dots each class was learnt from, as far as it remembers
 * @kr: share of red in the pictures' luma
 * @kb: share of blue in the pictures' luma
 *
 * The colours of the dots as one camera sees them. Plain data: copy it to keep it.
 */
typedef struct {
  gint n;
  ClothDotColourClass classes[CLOTH_DOT_COLOURS_MAX];
  gfloat ground[2];
  gfloat noise;
  gfloat outliers;
  gfloat seen[CLOTH_DOT_COLOURS_MAX];
  gfloat kr, kb;
} ClothDotColourModel;

void cloth_dot_colour_model_init (ClothDotColourModel * model, gint n,
    const guint8 (*rgb)[3], gfloat kr, gfloat kb);
void cloth_dot_colour_model_classify (const ClothDotColourModel * model,
    const ClothDot * dots, guint n_dots, gfloat * log_likelihoods);

gboolean cloth_dot_colour_model_adapt (ClothDotColourModel * model,
    const ClothDot * dots, guint n_dots);
void cloth_dot_colour_model_learn (ClothDotColourModel * model,
    const ClothDot * dots, guint n_dots, const gint8 * colours);
void cloth_dot_colour_model_vote (const ClothDotColourModel * model,
    const ClothPlanarImage * image, const ClothDot * dots, guint n_dots,
    gfloat * log_likelihoods);

G_END_DECLS
