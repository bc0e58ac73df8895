/* shading_shift: Light that changes across a dot moves its centre.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/effects/effects.h"

static const gchar *const confusions[] = { "extrinsic_drift", NULL };

static void
apply (const gdouble * values, ClothCapture * capture)
{
  capture->light_gradient[0] += values[0];
  capture->light_gradient[1] += values[1];
}

const ClothCaptureEffect cloth_capture_shading_shift = {
  {
        "shading_shift",
        CLOTH_EFFECT_IMAGE,
        "The light changes across the picture, and the centre of a dot "
        "weighted by its light moves to the brighter side.",
        "First moment of a disc of radius r under a linear change g of the "
        "light: g·r²/4.",
        "Centres of dots are off along one direction of the picture by the "
        "square of their size; corners are not.",
        confusions,
        2,
        {
              {"x", "1/px", 0, -0.02, 0.02, 0.002, FALSE,
                  "Relative change of the light per pixel along a row"},
              {"y", "1/px", 0, -0.02, 0.02, 0.002, FALSE,
                  "Relative change of the light per pixel down a column"},
            }
      },
  apply
};
