/* Vertices under the labels of others.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/take/measurement.h"

static const gchar *const confusions[] = {
  "axes_exchange", "shrinkage",
  NULL
};

void
cloth_measurement_label_exchange (const gdouble * values,
    ClothMeasurement * measurement)
{
  measurement->mirrored += values[0];
  measurement->turned += values[1];
  measurement->columns += values[2];
  measurement->rows += values[3];
}

/* *INDENT-OFF* */
const ClothEffect cloth_effect_label_exchange = {
  .id = "label_exchange",
  .side = CLOTH_EFFECT_MEASUREMENT,
  .blurb =
      "The grid of labels is mirrored, turned or shifted against the cloth.",
  .source =
      "A grid that is labelled from the wrong corner, or counted from the "
      "next column.",
  .regressor =
      "The same surface, but each vertex is where another one should be; "
      "held ones are not at their clamps.",
  .confusions = confusions,
  .test = CLOTH_EFFECT_TEST_TRIAL,
  .untested =
      "Exchanged labels are not looked for here.",
  .n_parameters = 4,
  .parameters = {
    {.name = "mirrored", .unit = "1", .null_value = 0, .min = 0, .max = 1,
        .prior = 1,
        .n_tried = 11, .tried = {1, 0, 1, 0, 0, 0, 0, 0, 0, 1, 1},
        .blurb = "1: columns are counted from the other end"},
    {.name = "turned", .unit = "1", .null_value = 0, .min = 0, .max = 3,
        .prior = 1,
        .n_tried = 11, .tried = {0, 2, 2, 0, 0, 0, 0, 1, 3, 1, 3},
        .blurb = "Quarter turns of the labels after that; odd ones of square "
            "grids only"},
    {.name = "columns", .unit = "1", .null_value = 0, .min = -8, .max = 8,
        .prior = 1,
        .n_tried = 11, .tried = {0, 0, 0, 1, -1, 0, 0, 0, 0, 0, 0},
        .blurb = "How many columns the labels are shifted by then"},
    {.name = "rows", .unit = "1", .null_value = 0, .min = -8, .max = 8,
        .prior = 1,
        .n_tried = 11, .tried = {0, 0, 0, 0, 0, 1, -1, 0, 0, 0, 0},
        .blurb = "How many rows"},
  }
};
/* *INDENT-ON* */
