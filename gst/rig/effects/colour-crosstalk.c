/* colour_crosstalk: Colour channels that leak into each other.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/capture.h"

static const gchar *const confusions[] = { "noise", "defocus", NULL };

void
cloth_capture_colour_crosstalk (const gdouble * values, ClothCapture * capture)
{
  if (values[0] != 0)
    capture->crosstalk = 1 - (1 - capture->crosstalk) * (1 - values[0]);
}

/* *INDENT-OFF* */
const ClothEffect cloth_effect_colour_crosstalk = {
  .id = "colour_crosstalk",
  .side = CLOTH_EFFECT_IMAGE,
  .blurb =
      "Each colour channel takes a share of its light from the two others.",
  .source =
      "Overlap of the colour filters of a sensor: 5 to 30%.",
  .regressor =
      "Colours are paler: the labels of dots are taken for others, and their "
      "centres scatter more.",
  .confusions = confusions,
  .test = CLOTH_EFFECT_TEST_NONE,
  .untested =
      "It moves no point but makes all scatter more: see the share of the "
      "stage “detection”.",
  .n_parameters = 1,
  .parameters = {
    {.name = "share", .unit = "1", .null_value = 0, .min = 0, .max = 0.66,
        .prior = 0.1, .one_sided = TRUE,
        .blurb =
            "Share of a channel that comes from the two others, half from each"},
  }
};
/* *INDENT-ON* */
