/* A steady wind.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "gravity_tilt", "gust",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_wind = {
  .id = "wind",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "A steady wind pushes the cloth along its normal: force ½ρ C "
      "(s(w_n − v_n)(w_n − v_n) + s(v_n) v_n) n on each unit of area, "
      "s(u) = √(u² + turbulence²): what the wind adds to the drag in "
      "still air, so it acts with air_drag or without.",
  .source =
      "Normal force of a plate across the flow, C_N 1.1 to 2: Hoerner, "
      "Fluid-Dynamic Drag, 1965, chapter 3; mean force of a fluctuating "
      "flow by its linearisation.",
  .regressor =
      "A force along the normal that is steady where the cloth is, in "
      "proportion to the normal part of one fixed direction; cosine "
      "0.89 with gravity_tilt, which does not follow the normal.",
  .confusions = confusions,
  .is_moving_air = TRUE,
  .n_parameters = 5,
  .parameters = {
    {.name = "x", .unit = "m/s", .null_value = 0, .min = -30, .max = 30,
        .prior = 1,
        .blurb = "Velocity of the air along x"},
    {.name = "y", .unit = "m/s", .null_value = 0, .min = -30, .max = 30,
        .prior = 1,
        .blurb = "Velocity of the air along y"},
    {.name = "z", .unit = "m/s", .null_value = 0, .min = -30, .max = 30,
        .prior = 0.3,
        .blurb = "Velocity of the air along z, upwards"},
    {.name = "coefficient", .unit = "1", .null_value = 1.5, .min = 0, .max = 20,
        .prior = 0.5, .shapes = TRUE,
        .blurb = "C_N of the cloth in this wind; at any value no wind means no "
            "force; in a model that has air_drag give both the same"},
    {.name = "turbulence", .unit = "m/s", .null_value = 0.5, .min = 0.01, .max = 10,
        .prior = 0.3, .shapes = TRUE,
        .blurb = "Speed below which the force is in proportion to the wind, for "
            "air that is never still; about 1.6 times the standard deviation "
            "of its fluctuations"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

static void
force (ClothLaneState * state, ClothLaneEffect * effect)
{
  CLOTH_LANE_NAME (cloth_lane_wind) (state, effect->p, effect->p[3],
      effect->p[4]);
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_wind) = {
  .order = CLOTH_LANE_ORDER_AIR,
  .force = force,
};
#endif
