/* shading_shift: Light that changes across a dot moves its centre.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/capture.h"

static const gchar *const confusions[] = { "extrinsic_drift", NULL };

void
cloth_capture_shading_shift (const gdouble * values, ClothCapture * capture)
{
  capture->light_gradient[0] += values[0];
  capture->light_gradient[1] += values[1];
}

/* *INDENT-OFF* */
const ClothEffect cloth_effect_shading_shift = {
  .id = "shading_shift",
  .side = CLOTH_EFFECT_IMAGE,
  .blurb =
      "The light changes across the picture, and the centre of a dot weighted "
      "by its light moves to the brighter side.",
  .source =
      "First moment of a disc of radius r under a linear change g of the "
      "light: g·r²/4.",
  .regressor =
      "Centres of dots are off along one direction of the picture by the "
      "square of their size; corners are not.",
  .confusions = confusions,
  .test = CLOTH_EFFECT_TEST_NONE,
  .untested =
      "It moves the centres of dots by the square of their size, which "
      "observations don't hold.",
  .n_parameters = 2,
  .parameters = {
    {.name = "x", .unit = "1/px", .null_value = 0, .min = -0.02, .max = 0.02,
        .prior = 0.002,
        .blurb = "Relative change of the light per pixel along a row"},
    {.name = "y", .unit = "1/px", .null_value = 0, .min = -0.02, .max = 0.02,
        .prior = 0.002,
        .blurb = "Relative change of the light per pixel down a column"},
  }
};
/* *INDENT-ON* */
