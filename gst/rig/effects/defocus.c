/* defocus: A picture out of focus.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/capture.h"

#include <math.h>

static const gchar *const confusions[] = { "noise", "motion_blur", NULL };

void
cloth_capture_defocus (const gdouble * values, ClothCapture * capture)
{
  capture->defocus_px = values[0] == 0 ? capture->defocus_px
      : hypot (capture->defocus_px, values[0]);
}

/* *INDENT-OFF* */
const ClothEffect cloth_effect_defocus = {
  .id = "defocus",
  .side = CLOTH_EFFECT_IMAGE,
  .blurb =
      "The picture is out of focus by a Gaussian point spread.",
  .source =
      "Cramér–Rao bound of a point found at the crossing of two blurred edges.",
  .regressor =
      "Points scatter more, everywhere and at rest too; none is moved.",
  .confusions = confusions,
  .test = CLOTH_EFFECT_TEST_NONE,
  .untested =
      "It moves no point but makes all scatter more: see the share of the "
      "stage “detection”.",
  .n_parameters = 1,
  .parameters = {
    {.name = "sigma", .unit = "px", .null_value = 0, .min = 0, .max = 20,
        .prior = 1, .one_sided = TRUE,
        .blurb = "Standard deviation of the point spread"},
  }
};
/* *INDENT-ON* */
