/* Warp and weft stretch differently.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "bending_anisotropy", "grain_angle", "shrinkage",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_stretch_anisotropy = {
  .id = "stretch_anisotropy",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "Stretch stiffness along the warp is the model’s times "
      "exp(log_ratio/2), along the weft times exp(−log_ratio/2).",
  .source =
      "Prior: own choice.",
  .regressor =
      "Forces within the plane of one sign along the warp, of the other "
      "along the weft.",
  .confusions = confusions,
  .same_as = "stretch.warp",
  .n_parameters = 1,
  .parameters = {
    {.name = "log_ratio", .unit = "1", .null_value = 0, .min = -4.6, .max = 4.6,
        .prior = 0.6,
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

  state->stretch_warp *= cloth_lane_exp (half);
  state->stretch_weft *= cloth_lane_exp (-half);
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_stretch_anisotropy) = {
  .setup = setup,
};
#endif
