/* defocus: A picture out of focus.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/effects/effects.h"

#include <math.h>

static const gchar *const confusions[] = { "noise", "motion_blur", NULL };

static void
apply (const gdouble * values, ClothCapture * capture)
{
  capture->defocus_px = values[0] == 0 ? capture->defocus_px
      : hypot (capture->defocus_px, values[0]);
}

const ClothCaptureEffect cloth_capture_defocus = {
  {
        "defocus",
        CLOTH_EFFECT_IMAGE,
        "The picture is out of focus by a Gaussian point spread.",
        "Cramér–Rao bound of a point found at the crossing of two blurred "
        "edges.",
        "Points scatter more, everywhere and at rest too; none is moved.",
        confusions,
        1,
        {
              {"sigma", "px", 0, 0, 20, 1, TRUE,
                  "Standard deviation of the point spread"},
            }
      },
  apply
};
