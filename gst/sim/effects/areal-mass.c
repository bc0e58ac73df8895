/* Areal mass other than the model’s.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "stretch", "shear", "bending", "added_mass",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_areal_mass = {
  .id = "areal_mass",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "Areal mass is the model’s times exp(log_ratio), everything else "
      "stays. With stiffness, damping and drag free as well it is a "
      "gauge: scaling all of them together changes nothing.",
  .source =
      "Prior: own choice.",
  .regressor =
      "A force in proportion to gravity minus acceleration; cosine "
      "−0.67 with stretch, shear and bending together.",
  .confusions = confusions,
  .n_parameters = 1,
  .parameters = {
    {.name = "log_ratio", .unit = "1", .null_value = 0, .min = -2.3, .max = 2.3,
        .prior = 0.2,
        .blurb = "Natural logarithm of the ratio to the model’s areal density"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

static void
setup (ClothLaneState * state, ClothLaneEffect * effect)
{
  ClothLane factor = cloth_lane_exp (effect->p[0]);

  state->density *= factor;
  for (guint i = 0; i < state->n; i++)
    state->mass[i] *= factor;
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_areal_mass) = {
  .setup = setup,
};
#endif
