/* Positions that were smoothed in time.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/take/measurement.h"

#include <math.h>

static const gchar *const confusions[] = {
  "motion_blur", "damping_stiffness", "damping_mass",
  NULL
};

void
cloth_measurement_smoothing (const gdouble * values,
    ClothMeasurement * measurement)
{
  measurement->smoothing_s = hypot (measurement->smoothing_s, values[0]);
}

/* *INDENT-OFF* */
const ClothEffect cloth_effect_smoothing = {
  .id = "smoothing",
  .side = CLOTH_EFFECT_MEASUREMENT,
  .blurb =
      "Positions are means over time, weighted by a bell, as filters of "
      "motion capture give them.",
  .source =
      "Low passes of 6 to 10 Hz, which are usual in motion capture, have "
      "the width 15 to 25 ms.",
  .regressor =
      "A displacement along the acceleration of every point, by half the "
      "square of the width.",
  .confusions = confusions,
  .n_parameters = 1,
  .parameters = {
    {.name = "width", .unit = "s", .null_value = 0, .min = 0, .max = 0.5,
        .prior = 0.03, .one_sided = TRUE,
        .blurb = "Standard deviation of the bell"},
  }
};
/* *INDENT-ON* */
