/* noise: Noise of the sensor.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/capture.h"

#include <math.h>

static const gchar *const confusions[] =
    { "defocus", "colour_crosstalk", NULL };

void
cloth_capture_noise (const gdouble * values, ClothCapture * capture)
{
  capture->read_noise = values[0] == 0 ? capture->read_noise
      : hypot (capture->read_noise, values[0]);
  capture->shot_noise = values[1] == 0 ? capture->shot_noise
      : hypot (capture->shot_noise, values[1]);
}

/* *INDENT-OFF* */
const ClothEffect cloth_effect_noise = {
  .id = "noise",
  .side = CLOTH_EFFECT_IMAGE,
  .blurb =
      "The sensor adds noise to every pixel of every picture.",
  .source =
      "Photon transfer: a constant part from reading out, and a part whose "
      "square grows with the light.",
  .regressor =
      "Points scatter without any pattern in space or time.",
  .confusions = confusions,
  .test = CLOTH_EFFECT_TEST_NONE,
  .untested =
      "It moves no point but makes all scatter more: see the share of the "
      "stage “detection”.",
  .n_parameters = 2,
  .parameters = {
    {.name = "sigma", .unit = "1", .null_value = 0, .min = 0, .max = 50,
        .prior = 2, .one_sided = TRUE,
        .blurb = "Standard deviation in black, grey levels of 255"},
    {.name = "shot", .unit = "1", .null_value = 0, .min = 0, .max = 50,
        .prior = 2, .one_sided = TRUE,
        .blurb =
            "Standard deviation that light adds in full white, grey levels of "
            "255"},
  }
};
/* *INDENT-ON* */
