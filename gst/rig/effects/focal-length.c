/* focal_length: A focal length that is not the calibrated one.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/capture.h"

static const gchar *const confusions[] =
    { "lens_distortion", "extrinsic_drift", "shrinkage", NULL };

void
cloth_capture_focal_length (const gdouble * values, ClothCapture * capture)
{
  capture->camera.K[0] *= 1 + values[0];
  capture->camera.K[1] *= 1 + values[0];
  capture->camera.K[4] *= 1 + values[0];
}

/* *INDENT-OFF* */
const ClothEffect cloth_effect_focal_length = {
  .id = "focal_length",
  .side = CLOTH_EFFECT_CAMERA,
  .blurb =
      "The focal length is another than the calibrated one, as after "
      "refocusing.",
  .source =
      "Focus breathing of fixed lenses: 0.1 to 2% of the focal length.",
  .regressor =
      "The cloth seems nearer or farther and larger or smaller by one factor, "
      "at rest too.",
  .confusions = confusions,
  .shared = TRUE,
  .n_parameters = 1,
  .parameters = {
    {.name = "error", .unit = "1", .null_value = 0, .min = -0.2, .max = 0.2,
        .prior = 0.005,
        .blurb = "True focal length over the calibrated one, minus 1"},
  }
};
/* *INDENT-ON* */
