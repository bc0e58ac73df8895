/* Bending stiffness other than the model’s.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "stretch", "bending_anisotropy", "areal_mass", "mesh_resolution",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_bending = {
  .id = "bending",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "Both bending stiffnesses are the model’s times exp(log_ratio).",
  .source =
      "618 measured fabrics: median 1.4e-5 N·m, 5 to 95% 1.1e-6 to "
      "1.1e-4.",
  .regressor =
      "A force along the normal in proportion to the change of "
      "curvature from hinge to hinge; cosine 0.63 with stretch along "
      "the warp, −0.67 with areal_mass.",
  .confusions = confusions,
  .same_as = "bending.warp",
  .n_parameters = 1,
  .parameters = {
    {.name = "log_ratio", .unit = "1", .null_value = 0, .min = -6.9, .max = 6.9,
        .prior = 1.4,
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

  state->bending_warp *= factor;
  state->bending_weft *= factor;
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_bending) = {
  .setup = setup,
};
#endif
