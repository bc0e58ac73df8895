/* focal_length: A focal length that is not the calibrated one.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/effects/effects.h"

static const gchar *const confusions[] =
    { "lens_distortion", "extrinsic_drift", "shrinkage", NULL };

static void
apply (const gdouble * values, ClothCapture * capture)
{
  capture->camera.K[0] *= 1 + values[0];
  capture->camera.K[1] *= 1 + values[0];
  capture->camera.K[4] *= 1 + values[0];
}

const ClothCaptureEffect cloth_capture_focal_length = {
  {
        "focal_length",
        CLOTH_EFFECT_CAMERA,
        "The focal length is another than the calibrated one, as after "
        "refocusing.",
        "Focus breathing of fixed lenses: 0.1 to 2% of the focal length.",
        "The cloth seems nearer or farther and larger or smaller by one "
        "factor, at rest too.",
        confusions,
        1,
        {
              {"error", "1", 0, -0.2, 0.2, 0.005, FALSE,
                  "True focal length over the calibrated one, minus 1"},
            }
      },
  apply
};
