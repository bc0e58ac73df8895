/* Axes that were exchanged.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/take/measurement.h"

#include <math.h>

static const gchar *const confusions[] = {
  "label_exchange", "misalignment",
  NULL
};

/* What is no axis makes positions fall together, which is refused. */
void
cloth_measurement_axes_exchange (const gdouble * values,
    ClothMeasurement * measurement)
{
  const gdouble shift[3] = { 0. };
  gdouble matrix[9] = { 0. };

  for (guint i = 0; i < 3; i++)
    for (guint k = 0; k < 3; k++)
      if (fabs (values[i]) == k + 1.)
        matrix[3 * i + k] = values[i] > 0. ? 1. : -1.;
  cloth_measurement_map (measurement, matrix, shift);
}

/* *INDENT-OFF* */
const ClothEffect cloth_effect_axes_exchange = {
  .id = "axes_exchange",
  .side = CLOTH_EFFECT_MEASUREMENT,
  .blurb =
      "Axes of the recorded positions are exchanged or point the other way.",
  .source =
      "Programs differ in whether y or z points up, and in whether axes are "
      "right-handed.",
  .regressor =
      "The recorded cloth is the simulated one seen in a mirror or turned "
      "by a quarter; the clamps’ log is not.",
  .confusions = confusions,
  .test = CLOTH_EFFECT_TEST_TRIAL,
  .untested =
      "Exchanged axes are not looked for here.",
  .n_parameters = 3,
  .parameters = {
    {.name = "x", .unit = "1", .null_value = 1, .min = -3, .max = 3,
        .prior = 1,
        .n_tried = 9, .tried = {1, 1, 2, -1, 1, -2, 2, -1, 1},
        .blurb = "True axis that is recorded as x: 1 for x, 2 for y, 3 for z; "
            "negative: its opposite"},
    {.name = "y", .unit = "1", .null_value = 2, .min = -3, .max = 3,
        .prior = 1,
        .n_tried = 9, .tried = {3, -3, 1, 2, -2, 1, -1, -2, 2},
        .blurb = "True axis that is recorded as y: 1 for x, 2 for y, 3 for z; "
            "negative: its opposite"},
    {.name = "z", .unit = "1", .null_value = 3, .min = -3, .max = 3,
        .prior = 1,
        .n_tried = 9, .tried = {-2, 2, 3, 3, 3, 3, 3, 3, -3},
        .blurb = "True axis that is recorded as z: 1 for x, 2 for y, 3 for z; "
            "negative: its opposite"},
  }
};
/* *INDENT-ON* */
