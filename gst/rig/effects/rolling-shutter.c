/* rolling_shutter: Rows that are exposed one after the other.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/capture.h"

static const gchar *const confusions[] = { "sync_offset", "clamp_delay", NULL };

void
cloth_capture_rolling_shutter (const gdouble * values, ClothCapture * capture)
{
  capture->camera.rolling_shutter_s += values[0];
}

/* *INDENT-OFF* */
const ClothEffect cloth_effect_rolling_shutter = {
  .id = "rolling_shutter",
  .side = CLOTH_EFFECT_CAMERA,
  .blurb =
      "The rows of a picture are exposed one after the other, and the rig "
      "doesn't know for how long.",
  .source =
      "Data sheets of rolling-shutter sensors: 5 to 30 ms a picture.",
  .regressor =
      "The residual is the velocity times a delay that grows from the first "
      "row to the last.",
  .confusions = confusions,
  .shared = TRUE,
  .n_parameters = 1,
  .parameters = {
    {.name = "seconds", .unit = "s", .null_value = 0, .min = 0, .max = 0.1,
        .prior = 0.01, .one_sided = TRUE,
        .blurb = "Added to the time from the first to the last row"},
  }
};
/* *INDENT-ON* */
