/* sync_offset: A camera whose clock is off.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/capture.h"

static const gchar *const confusions[] =
    { "clamp_delay", "rolling_shutter", "motion_blur", "frame_drop", NULL };

void
cloth_capture_sync_offset (const gdouble * values, ClothCapture * capture)
{
  capture->camera.offset_s += values[0];
}

/* *INDENT-OFF* */
const ClothEffect cloth_effect_sync_offset = {
  .id = "sync_offset",
  .side = CLOTH_EFFECT_CAMERA,
  .blurb =
      "The camera's time is another than the rig says, so its pictures show "
      "the cloth earlier or later.",
  .source =
      "Free-running cameras: up to half a frame; delays of capture cards: 10 "
      "to 350 ms.",
  .regressor =
      "The residual is the velocity times the delay: all points lag alike, "
      "and nothing shows at rest.",
  .confusions = confusions,
  .n_parameters = 1,
  .parameters = {
    {.name = "seconds", .unit = "s", .null_value = 0, .min = -0.5, .max = 0.5,
        .prior = 0.01,
        .blurb =
            "Added to the camera's time minus the rig's: with more of it a "
            "picture shows an earlier cloth"},
  }
};
/* *INDENT-ON* */
