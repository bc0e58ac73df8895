/* More internal damping than the model’s.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "time_step", "hysteresis",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_damping_stiffness = {
  .id = "damping_stiffness",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "Inner forces lag by a time, on top of the model’s.",
  .source =
      "Stiffness-proportional part of Rayleigh’s damping, 1e-4 to 5e-3 "
      "s in cloth.",
  .regressor =
      "A force against the rate of strain and of bending, so in the "
      "high modes; damping of the integrator looks alike but changes "
      "with the time step.",
  .confusions = confusions,
  .same_as = "damping.stiffness",
  .n_parameters = 1,
  .parameters = {
    {.name = "time", .unit = "s", .null_value = 0, .min = 0, .max = 0.1,
        .prior = 0.001, .one_sided = TRUE,
        .blurb = "What β of αM + βK is larger by"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

static void
setup (ClothLaneState * state, ClothLaneEffect * effect)
{
  state->beta += effect->p[0];
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_damping_stiffness) = {
  .setup = setup,
};
#endif
