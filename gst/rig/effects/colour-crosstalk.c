/* colour_crosstalk: Colour channels that leak into each other.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/effects/effects.h"

static const gchar *const confusions[] = { "noise", "defocus", NULL };

static void
apply (const gdouble * values, ClothCapture * capture)
{
  if (values[0] != 0)
    capture->crosstalk = 1 - (1 - capture->crosstalk) * (1 - values[0]);
}

const ClothCaptureEffect cloth_capture_colour_crosstalk = {
  {
        "colour_crosstalk",
        CLOTH_EFFECT_IMAGE,
        "Each colour channel takes a share of its light from the two others.",
        "Overlap of the colour filters of a sensor: 5 to 30%.",
        "Colours are paler: the labels of dots are taken for others, and "
        "their centres scatter more.",
        confusions,
        1,
        {
              {"share", "1", 0, 0, 0.66, 0.1, TRUE,
                  "Share of a channel that comes from the two others, half "
                    "from each"},
            }
      },
  apply
};
