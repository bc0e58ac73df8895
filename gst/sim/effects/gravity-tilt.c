/* A world that is not upright.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/effects/effects.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "wind", "extrinsic_drift",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_gravity_tilt = {
  .id = "gravity_tilt",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "Gravity is turned against the world’s axes, as by a rig whose z "
      "is not quite up; its size stays.",
  .source =
      "Levelling of a rig by hand: 0.5 to 5°.",
  .regressor =
      "A steady force in proportion to mass in one horizontal "
      "direction; cosine 0.89 with wind, which follows the normal.",
  .confusions = confusions,
  .n_parameters = 2,
  .parameters = {
    {.name = "x", .unit = "°", .null_value = 0, .min = -45, .max = 45,
        .prior = 2.5,
        .blurb = "Angle by which what hangs is turned towards x; gravity is turned "
            "by the rotation vector (y, −x, 0)"},
    {.name = "y", .unit = "°", .null_value = 0, .min = -45, .max = 45,
        .prior = 2.5,
        .blurb = "Angle by which it is turned towards y"},
  }
};
/* *INDENT-ON* */
#endif
