/* motion_blur: A shutter that stays open.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/effects/effects.h"

static const gchar *const confusions[] =
    { "sync_offset", "defocus", "clamp_delay", NULL };

static void
apply (const gdouble * values, ClothCapture * capture)
{
  capture->exposure_s += values[0];
}

const ClothCaptureEffect cloth_capture_motion_blur = {
  {
        "motion_blur",
        CLOTH_EFFECT_IMAGE,
        "The shutter is open for a while from the frame's time on, and a "
        "moving point is smeared.",
        "The middle of a streak lies half the exposure later; its spread is "
        "that of a uniform distribution.",
        "The residual is the velocity times half the exposure, and points "
        "that move fast across the picture scatter more along their way.",
        confusions,
        1,
        {
              {"exposure", "s", 0, 0, 0.1, 0.01, TRUE,
                  "How long the shutter is open"},
            }
      },
  apply
};
