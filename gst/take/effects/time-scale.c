/* A frame rate that is not the one stated.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/take/measurement.h"

static const gchar *const confusions[] = {
  "recording_delay", "gravity_scale", "position_scale",
  NULL
};

void
cloth_measurement_time_scale (const gdouble * values,
    ClothMeasurement * measurement)
{
  measurement->time_factor *= values[0];
  measurement->delay_s *= values[0];
}

/* *INDENT-OFF* */
const ClothEffect cloth_effect_time_scale = {
  .id = "time_scale",
  .side = CLOTH_EFFECT_MEASUREMENT,
  .blurb =
      "The recording’s clock runs faster or slower than the clamps’, as "
      "when its frame rate is not the one stated.",
  .source =
      "Cameras of 30 and of 29.97 frames a second differ by 0.1%, those "
      "that lose light by several percent; own choice.",
  .regressor =
      "A delay that grows with time, from the first frame on.",
  .confusions = confusions,
  .untested =
      "Beside clamps that may be late, too, a clock fits what others leave: "
      "it is tested where it is asked for by name.",
  .n_parameters = 1,
  .parameters = {
    {.name = "factor", .unit = "1", .null_value = 1, .min = 0.5, .max = 2,
        .prior = 0.03,
        .blurb = "Seconds that the recording counts while one passes"},
  }
};
/* *INDENT-ON* */
