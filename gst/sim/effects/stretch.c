/* Stretch stiffness other than the model’s.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "bending", "shrinkage", "areal_mass", "biphasic_stretch",
  "clamp_compliance",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_stretch = {
  .id = "stretch",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "Both stretch stiffnesses are the model’s times exp(log_ratio).",
  .source =
      "Knits 25 to 490 N/m, wovens 4,000 N/m.",
  .regressor =
      "Forces within the plane in proportion to the strains of warp and "
      "weft, most below the clamps; cosine 0.63 with bending, 0.46 with "
      "shrinkage, −0.67 with areal_mass.",
  .confusions = confusions,
  .same_as = "stretch.warp",
  .n_parameters = 1,
  .parameters = {
    {.name = "log_ratio", .unit = "1", .null_value = 0, .min = -6.9, .max = 6.9,
        .prior = 0.9,
        .blurb = "Natural logarithm of the ratio to the model’s stiffness"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

static void
setup (ClothLaneState * state, ClothLaneEffect * effect)
{
  ClothLane factor = cloth_lane_exp (effect->p[0]);

  state->stretch_warp *= factor;
  state->stretch_weft *= factor;
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_stretch) = {
  .setup = setup,
};
#endif
