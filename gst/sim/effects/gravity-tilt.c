/* A world that is not upright.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

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
#else

#include "gst/sim/lanes/hooks.h"

/* Rodrigues' formula about (y, −x, 0). */
static void
setup (ClothLaneState * state, ClothLaneEffect * effect)
{
  for (guint l = 0; l < CLOTH_N_LANES; l++) {
    gdouble x = CLOTH_LANE_AT (&effect->p[0], l) * (G_PI / 180.);
    gdouble y = CLOTH_LANE_AT (&effect->p[1], l) * (G_PI / 180.);
    gdouble angle = sqrt (x * x + y * y), g[3], axis[2], along;

    if (angle == 0.)
      continue;
    axis[0] = y / angle;
    axis[1] = -x / angle;
    for (guint k = 0; k < 3; k++)
      g[k] = CLOTH_LANE_AT (&state->gravity[k], l);
    along = (axis[0] * g[0] + axis[1] * g[1]) * (1. - cos (angle));
    CLOTH_LANE_AT (&state->gravity[0], l) = (ClothReal) (g[0] * cos (angle) +
        axis[1] * g[2] * sin (angle) + axis[0] * along);
    CLOTH_LANE_AT (&state->gravity[1], l) = (ClothReal) (g[1] * cos (angle) -
        axis[0] * g[2] * sin (angle) + axis[1] * along);
    CLOTH_LANE_AT (&state->gravity[2], l) = (ClothReal) (g[2] * cos (angle) +
        (axis[0] * g[1] - axis[1] * g[0]) * sin (angle));
  }
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_gravity_tilt) = {
  .order = CLOTH_LANE_ORDER_DIRECTIONS,
  .setup = setup,
};
#endif
