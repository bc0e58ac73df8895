/* Warp and weft bend differently.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "bending", "stretch_anisotropy", "grain_angle",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_bending_anisotropy = {
  .id = "bending_anisotropy",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "Bending stiffness along the warp is the model’s times "
      "exp(log_ratio/2), along the weft times exp(−log_ratio/2).",
  .source =
      "Measured fabrics: warp over weft has the median 1.7 and the 95% "
      "quantile 5.1, either way.",
  .regressor =
      "Bending forces of one sign in folds across the warp, of the "
      "other in folds across the weft.",
  .confusions = confusions,
  .same_as = "bending.warp",
  .n_parameters = 1,
  .parameters = {
    {.name = "log_ratio", .unit = "1", .null_value = 0, .min = -4.6, .max = 4.6,
        .prior = 0.8,
        .blurb = "Natural logarithm of what the ratio warp to weft is multiplied "
            "with"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

static void
setup (ClothLaneState * state, ClothLaneEffect * effect)
{
  ClothLane half = effect->p[0] * cloth_lane_set (0.5);

  state->bending_warp *= cloth_lane_exp (half);
  state->bending_weft *= cloth_lane_exp (-half);
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_bending_anisotropy) = {
  .setup = setup,
};
#endif
