/* sync_offset: A camera whose clock is off.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/effects/effects.h"

static const gchar *const confusions[] =
    { "clamp_delay", "rolling_shutter", "motion_blur", "frame_drop", NULL };

static void
apply (const gdouble * values, ClothCapture * capture)
{
  capture->camera.offset_s += values[0];
}

const ClothCaptureEffect cloth_capture_sync_offset = {
  {
        "sync_offset",
        CLOTH_EFFECT_CAMERA,
        "The camera's time is another than the rig says, so its pictures "
        "show the cloth earlier or later.",
        "Free-running cameras: up to half a frame; delays of capture cards: "
        "10 to 350 ms.",
        "The residual is the velocity times the delay: all points lag alike, "
        "and nothing shows at rest.",
        confusions,
        1,
        {
              {"seconds", "s", 0, -0.5, 0.5, 0.01, FALSE,
                  "Added to the camera's time minus the rig's: with more of it "
                    "a picture shows an earlier cloth"},
            }
      },
  apply
};
