/* A world that is turned and shifted.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/take/measurement.h"

#include "gst/rig/rotation.h"

static const gchar *const confusions[] = {
  "gravity_tilt", "extrinsic_drift", "position_scale",
  NULL
};

void
cloth_measurement_misalignment (const gdouble * values,
    ClothMeasurement * measurement)
{
  const gdouble turn[3] = { values[0] * (G_PI / 180.),
    values[1] * (G_PI / 180.), values[2] * (G_PI / 180.)
  };
  gdouble matrix[9] = { 1., 0., 0., 0., 1., 0., 0., 0., 1. };

  if (turn[0] != 0. || turn[1] != 0. || turn[2] != 0.)
    cloth_rotation_from_vector (turn, matrix);
  cloth_measurement_map (measurement, matrix, values + 3);
}

/* *INDENT-OFF* */
const ClothEffect cloth_effect_misalignment = {
  .id = "misalignment",
  .side = CLOTH_EFFECT_MEASUREMENT,
  .blurb =
      "The recording’s world is turned and shifted against that of the "
      "clamps’ log and of gravity.",
  .source =
      "Fits of a robot’s frame to that of cameras: up to 5° and some "
      "centimetres; own choice.",
  .regressor =
      "One rigid displacement of all points, the held ones included, in all "
      "frames; gravity_tilt turns what hangs, but not what is held.",
  .confusions = confusions,
  .n_parameters = 6,
  .parameters = {
    {.name = "turn_x", .unit = "°", .null_value = 0, .min = -45, .max = 45,
        .prior = 2.5,
        .blurb = "Rotation vector, x: recorded positions are turned by it about "
            "the origin"},
    {.name = "turn_y", .unit = "°", .null_value = 0, .min = -45, .max = 45,
        .prior = 2.5,
        .blurb = "Rotation vector, y: recorded positions are turned by it about "
            "the origin"},
    {.name = "turn_z", .unit = "°", .null_value = 0, .min = -45, .max = 45,
        .prior = 2.5,
        .blurb = "Rotation vector, z: recorded positions are turned by it about "
            "the origin"},
    {.name = "shift_x", .unit = "m", .null_value = 0, .min = -1, .max = 1,
        .prior = 0.02,
        .blurb = "How far recorded positions are shifted along x after that"},
    {.name = "shift_y", .unit = "m", .null_value = 0, .min = -1, .max = 1,
        .prior = 0.02,
        .blurb = "How far recorded positions are shifted along y after that"},
    {.name = "shift_z", .unit = "m", .null_value = 0, .min = -1, .max = 1,
        .prior = 0.02,
        .blurb = "How far recorded positions are shifted along z after that"},
  }
};
/* *INDENT-ON* */
