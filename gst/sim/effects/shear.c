/* Shear stiffness other than the model’s.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "areal_mass", "mesh_diagonals", "grain_angle",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_shear = {
  .id = "shear",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "Shear stiffness is the model’s times exp(log_ratio).",
  .source =
      "Knits 29 to 210 N/m.",
  .regressor =
      "Forces within the plane in proportion to the angle between warp "
      "and weft threads; cosine −0.67 with areal_mass.",
  .confusions = confusions,
  .same_as = "shear",
  .n_parameters = 1,
  .parameters = {
    {.name = "log_ratio", .unit = "1", .null_value = 0, .min = -6.9, .max = 6.9,
        .prior = 0.6,
        .blurb = "Natural logarithm of the ratio to the model’s stiffness"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

static void
setup (ClothLaneState * state, ClothLaneEffect * effect)
{
  state->shear *= cloth_lane_exp (effect->p[0]);
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_shear) = {
  .setup = setup,
};
#endif
