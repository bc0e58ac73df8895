/* A recording that is late.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/take/measurement.h"

static const gchar *const confusions[] = {
  "clamp_delay", "time_scale", "sync_offset",
  NULL
};

void
cloth_measurement_recording_delay (const gdouble * values,
    ClothMeasurement * measurement)
{
  measurement->delay_s += values[0];
}

/* *INDENT-OFF* */
const ClothEffect cloth_effect_recording_delay = {
  .id = "recording_delay",
  .side = CLOTH_EFFECT_MEASUREMENT,
  .blurb =
      "All frames bear a later time stamp than the clamps’ log would give "
      "them.",
  .source =
      "Delays of 10 to 350 ms between pictures and a robot’s log.",
  .regressor =
      "A displacement along the velocity of every point, the held ones "
      "included; nothing shows at rest.",
  .confusions = confusions,
  .untested =
      "Beside clamps that may be late, too, a clock fits what others leave: "
      "it is tested where it is asked for by name.",
  .n_parameters = 1,
  .parameters = {
    {.name = "seconds", .unit = "s", .null_value = 0, .min = -1, .max = 1,
        .prior = 0.05,
        .blurb = "How much later than by the clamps’ log the frames are stamped"},
  }
};
/* *INDENT-ON* */
