/* More loss of velocity than the model’s.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "air_drag_linear", "air_drag", "air_drag_tangential",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_damping_mass = {
  .id = "damping_mass",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "Velocity is lost at a rate, on top of the model’s: force −rate m "
      "v.",
  .source =
      "Mass-proportional part of Rayleigh’s damping, 0.5 to 3 1/s in "
      "cloth.",
  .regressor =
      "A force against the velocity in proportion to mass; the same as "
      "air_drag_linear where the areal mass is even.",
  .confusions = confusions,
  .same_as = "damping.mass",
  .n_parameters = 1,
  .parameters = {
    {.name = "rate", .unit = "1/s", .null_value = 0, .min = 0, .max = 50,
        .prior = 1, .one_sided = TRUE,
        .blurb = "What α of αM + βK is larger by"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

static void
setup (ClothLaneState * state, ClothLaneEffect * effect)
{
  state->alpha += effect->p[0];
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_damping_mass) = {
  .setup = setup,
};
#endif
