/* Cloth smaller than its pattern.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "stretch", "stretch_anisotropy", "focal_length",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_shrinkage = {
  .id = "shrinkage",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "Rest lengths are multiplied by 1 − warp and 1 − weft; the mass "
      "of a piece stays.",
  .source =
      "Washing and relaxing: 0.1 to 5%.",
  .regressor =
      "A steady tension, even all over the cloth and there without "
      "load; cosine 0.46 with stretch.",
  .confusions = confusions,
  .n_parameters = 2,
  .parameters = {
    {.name = "warp", .unit = "1", .null_value = 0, .min = -0.3, .max = 0.5,
        .prior = 0.02,
        .blurb = "Share by which lengths along u shrink; negative when they grow"},
    {.name = "weft", .unit = "1", .null_value = 0, .min = -0.3, .max = 0.5,
        .prior = 0.02,
        .blurb = "Share by which lengths along v shrink"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

/* ∂x/∂(u, v) grows as lengths at rest shrink. */
static void
setup (ClothLaneState * state, ClothLaneEffect * effect)
{
  ClothLane one = cloth_lane_set (1.);
  ClothLane u = one / (one - effect->p[0]), v = one / (one - effect->p[1]);

  state->rest[0] *= u;
  state->rest[1] *= u;
  state->rest[2] *= v;
  state->rest[3] *= v;
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_shrinkage) = {
  .changes_rest = TRUE,
  .setup = setup,
};
#endif
