/* frame_drop: Pictures that are lost.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/effects/effects.h"

static const gchar *const confusions[] = { "sync_offset", NULL };

static void
apply (const gdouble * values, ClothCapture * capture)
{
  if (values[0] != 0)
    capture->drop_rate = 1 - (1 - capture->drop_rate) * (1 - values[0]);
}

const ClothCaptureEffect cloth_capture_frame_drop = {
  {
        "frame_drop",
        CLOTH_EFFECT_CAMERA,
        "Pictures are lost now and then, and the one before stands in for "
        "each.",
        "Recorders that hold a constant rate repeat the last picture.",
        "Single frames show the cloth of the frame before: the residual is "
        "the velocity times one interval, in bursts.",
        confusions,
        1,
        {
              {"rate", "1", 0, 0, 0.9, 0.02, TRUE,
                  "Share of the pictures that are lost, each by itself"},
            }
      },
  apply
};
