/* Gusts: a wind that comes and goes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/effects/effects.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "wind", "gravity_tilt",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_gust = {
  .id = "gust",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "A wind of random speed, an Ornstein–Uhlenbeck process of mean 0 "
      "that follows from the seed, pushes the cloth along its normal "
      "with the law of wind.",
  .source =
      "Uhlenbeck and Ornstein, Physical Review 36, 1930; intensities "
      "are 10 to 30% of the mean wind.",
  .regressor =
      "A force along the normal, alike for all of the cloth at a time, "
      "whose sign and size change with a correlation time; a steady "
      "wind fitted to parts of the take would not stay the same.",
  .confusions = confusions,
  .n_parameters = 5,
  .parameters = {
    {.name = "intensity", .unit = "m/s", .null_value = 0, .min = 0, .max = 20,
        .prior = 0.3, .one_sided = TRUE,
        .blurb = "Standard deviation of the speed"},
    {.name = "time", .unit = "s", .null_value = 0.5, .min = 0.01, .max = 60,
        .prior = 0.5,
        .blurb = "Correlation time: after it 37% of a gust are left"},
    {.name = "azimuth", .unit = "°", .null_value = 90, .min = -180, .max = 180,
        .prior = 90,
        .blurb = "Horizontal direction that positive gusts blow to: 0 is x, 90 is "
            "y"},
    {.name = "coefficient", .unit = "1", .null_value = 1.5, .min = 0, .max = 20,
        .prior = 0.5,
        .blurb = "C_N of the cloth in this wind; at any value no wind means no "
            "force; in a model that has air_drag give both the same"},
    {.name = "turbulence", .unit = "m/s", .null_value = 0.5, .min = 0.01, .max = 10,
        .prior = 0.3,
        .blurb = "Speed below which the force is in proportion to the wind, for "
            "air that is never still; about 1.6 times the standard deviation "
            "of its fluctuations"},
  }
};
/* *INDENT-ON* */
#endif
