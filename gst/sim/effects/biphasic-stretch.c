/* Stretch that stiffens beyond a knee.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "stretch", "hysteresis",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_biphasic_stretch = {
  .id = "biphasic_stretch",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "Beyond the strain at the knee, stretch stiffness is the model’s "
      "times 1 + ratio, as in knits whose loops straighten first.",
  .source =
      "Loading curves of knits and wovens: Wang, O’Brien and "
      "Ramamoorthi, ACM Transactions on Graphics 30(4), 2011; knee: own "
      "choice.",
  .regressor =
      "A tension in proportion to the strain beyond the knee, none "
      "below it, so below the clamps and in fast motion only.",
  .confusions = confusions,
  .n_parameters = 2,
  .parameters = {
    {.name = "ratio", .unit = "1", .null_value = 0, .min = -0.95, .max = 100,
        .prior = 3,
        .blurb = "Stiffness added beyond the knee over the model’s"},
    {.name = "knee", .unit = "1", .null_value = 0.1, .min = 0, .max = 10,
        .prior = 0.1, .shapes = TRUE, .n_tried = 1, .tried = {0.02},
        .blurb = "Strain from which it acts; without ratio it means nothing"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

static void
rate (const ClothLaneState * state, const ClothLaneEffect * effect,
    ClothLane * omega2, ClothLane * friction)
{
  *omega2 += *omega2 * cloth_lane_max (effect->p[0], cloth_lane_set (0.));
}

static void
force (ClothLaneState * state, ClothLaneEffect * effect)
{
  ClothLane zero = cloth_lane_set (0.), knee = effect->p[1];
  ClothLane warp = state->stretch_warp * effect->p[0];
  ClothLane weft = state->stretch_weft * effect->p[0];

  for (guint i = 0; i < state->body->n_triangles; i++) {
    const ClothLaneTriangle *t = &state->triangles[i];
    ClothLaneStrain strain;

    cloth_lane_strain (state, t, &strain);
    cloth_lane_pull (state, t, &strain,
        warp * cloth_lane_max (strain.warp - knee, zero),
        weft * cloth_lane_max (strain.weft - knee, zero));
  }
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_biphasic_stretch) = {
  .order = CLOTH_LANE_ORDER_THREADS,
  .rate = rate,
  .force = force,
};
#endif
