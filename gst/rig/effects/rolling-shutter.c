/* rolling_shutter: Rows that are exposed one after the other.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/effects/effects.h"

static const gchar *const confusions[] = { "sync_offset", "clamp_delay", NULL };

static void
apply (const gdouble * values, ClothCapture * capture)
{
  capture->camera.rolling_shutter_s += values[0];
}

const ClothCaptureEffect cloth_capture_rolling_shutter = {
  {
        "rolling_shutter",
        CLOTH_EFFECT_CAMERA,
        "The rows of a picture are exposed one after the other, and the rig "
        "doesn't know for how long.",
        "Data sheets of rolling-shutter sensors: 5 to 30 ms a picture.",
        "The residual is the velocity times a delay that grows from the "
        "first row to the last.",
        confusions,
        1,
        {
              {"seconds", "s", 0, 0, 0.1, 0.01, TRUE,
                  "Added to the time from the first to the last row"},
            }
      },
  apply
};
