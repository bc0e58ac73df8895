/* Positions in a wrong unit of length.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/take/measurement.h"

static const gchar *const confusions[] = {
  "shrinkage", "time_scale", "gravity_scale",
  NULL
};

void
cloth_measurement_position_scale (const gdouble * values,
    ClothMeasurement * measurement)
{
  const gdouble matrix[9] = { values[0], 0., 0., 0., values[0], 0., 0., 0.,
    values[0]
  };
  const gdouble shift[3] = { 0. };

  cloth_measurement_map (measurement, matrix, shift);
}

/* *INDENT-OFF* */
const ClothEffect cloth_effect_position_scale = {
  .id = "position_scale",
  .side = CLOTH_EFFECT_MEASUREMENT,
  .blurb =
      "All recorded positions are multiplied by a factor, from the origin "
      "of the world on.",
  .source =
      "A calibration board measured 1 to 3% too short, or its paper shrunk; "
      "own choice.",
  .regressor =
      "A displacement in proportion to the distance from the origin, at "
      "rest too; the clamps’ log and gravity are as they were.",
  .confusions = confusions,
  .n_parameters = 1,
  .parameters = {
    {.name = "factor", .unit = "1", .null_value = 1, .min = 0.5, .max = 2,
        .prior = 0.02,
        .blurb = "What recorded positions are true ones multiplied with"},
  }
};
/* *INDENT-ON* */
