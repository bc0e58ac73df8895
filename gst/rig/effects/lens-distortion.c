/* lens_distortion: Radial distortion that the calibration missed.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/effects/effects.h"

static const gchar *const confusions[] =
    { "focal_length", "extrinsic_drift", NULL };

static void
apply (const gdouble * values, ClothCapture * capture)
{
  if (values[0] == 0 && values[1] == 0)
    return;
  if (capture->camera.lens == CLOTH_LENS_NONE)
    capture->camera.lens = CLOTH_LENS_BROWN5;
  capture->camera.k[0] += values[0];
  capture->camera.k[1] += values[1];
}

const ClothCaptureEffect cloth_capture_lens_distortion = {
  {
        "lens_distortion",
        CLOTH_EFFECT_CAMERA,
        "The lens bends lines more than its calibration says.",
        "D. C. Brown, Close-range camera calibration, 1971; residual k1 "
        "after a poor calibration is some hundredths.",
        "Triangulated points are off by an amount that grows with the cube "
        "of the distance from the picture's centre, in each camera alike, "
        "moving or not; reprojection residuals show it when three cameras "
        "see a point.",
        confusions,
        2,
        {
              {"k1", "1", 0, -1, 1, 0.02, FALSE,
                  "Added to the coefficient of r³"},
              {"k2", "1", 0, -1, 1, 0.02, FALSE,
                  "Added to the coefficient of r⁵"},
            }
      },
  apply
};
