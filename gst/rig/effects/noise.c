/* noise: Noise of the sensor.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/effects/effects.h"

#include <math.h>

static const gchar *const confusions[] =
    { "defocus", "colour_crosstalk", NULL };

static void
apply (const gdouble * values, ClothCapture * capture)
{
  capture->read_noise = values[0] == 0 ? capture->read_noise
      : hypot (capture->read_noise, values[0]);
  capture->shot_noise = values[1] == 0 ? capture->shot_noise
      : hypot (capture->shot_noise, values[1]);
}

const ClothCaptureEffect cloth_capture_noise = {
  {
        "noise",
        CLOTH_EFFECT_IMAGE,
        "The sensor adds noise to every pixel of every picture.",
        "Photon transfer: a constant part from reading out, and a part whose "
        "square grows with the light.",
        "Points scatter without any pattern in space or time.",
        confusions,
        2,
        {
              {"sigma", "1", 0, 0, 50, 2, TRUE,
                  "Standard deviation in black, grey levels of 255"},
              {"shot", "1", 0, 0, 50, 2, TRUE,
                  "Standard deviation that light adds in full white, grey "
                    "levels of 255"},
            }
      },
  apply
};
