/* lens_distortion: Radial distortion that the calibration missed.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/capture.h"

static const gchar *const confusions[] =
    { "focal_length", "extrinsic_drift", NULL };

void
cloth_capture_lens_distortion (const gdouble * values, ClothCapture * capture)
{
  if (values[0] == 0 && values[1] == 0)
    return;
  if (capture->camera.lens == CLOTH_LENS_NONE)
    capture->camera.lens = CLOTH_LENS_BROWN5;
  capture->camera.k[0] += values[0];
  capture->camera.k[1] += values[1];
}

/* *INDENT-OFF* */
const ClothEffect cloth_effect_lens_distortion = {
  .id = "lens_distortion",
  .side = CLOTH_EFFECT_CAMERA,
  .blurb =
      "The lens bends lines more than its calibration says.",
  .source =
      "D. C. Brown, Close-range camera calibration, 1971; residual k1 after a "
      "poor calibration is some hundredths.",
  .regressor =
      "Triangulated points are off by an amount that grows with the cube of "
      "the distance from the picture's centre, in each camera alike, moving "
      "or not; reprojection residuals show it when three cameras see a point.",
  .confusions = confusions,
  .shared = TRUE,
  .n_parameters = 2,
  .parameters = {
    {.name = "k1", .unit = "1", .null_value = 0, .min = -1, .max = 1,
        .prior = 0.02,
        .blurb = "Added to the coefficient of r³"},
    {.name = "k2", .unit = "1", .null_value = 0, .min = -1, .max = 1,
        .prior = 0.02,
        .blurb = "Added to the coefficient of r⁵"},
  }
};
/* *INDENT-ON* */
