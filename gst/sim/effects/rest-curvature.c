/* Cloth that curls by itself.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "plasticity", "bending",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_rest_curvature = {
  .id = "rest_curvature",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "The cloth at rest is curved, positive towards the side its "
      "normal u × v points to.",
  .source =
      "Creases and curling edges of 10 to 50 1/m.",
  .regressor =
      "A steady bending moment along folds and edges, whatever the "
      "motion.",
  .confusions = confusions,
  .n_parameters = 2,
  .parameters = {
    {.name = "warp", .unit = "1/m", .null_value = 0, .min = -500, .max = 500,
        .prior = 20,
        .blurb = "Curvature of threads along u"},
    {.name = "weft", .unit = "1/m", .null_value = 0, .min = -500, .max = 500,
        .prior = 20,
        .blurb = "Curvature of threads along v"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

static void
force (ClothLaneState * state, ClothLaneEffect * effect)
{
  for (guint i = 0; i < state->body->n_hinges; i++) {
    const gdouble *form = state->body->hinges[i].form;
    ClothLane rest = effect->p[0] * (ClothReal) form[0] +
        effect->p[1] * (ClothReal) form[1];
    ClothLaneFold fold;

    cloth_lane_fold (state, i, &fold);
    for (guint k = 0; k < 3; k++)
      fold.y[k] = rest * fold.normal[k];
    cloth_lane_unfold (state, i, &fold, fold.y);
  }
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_rest_curvature) = {
  .order = CLOTH_LANE_ORDER_FOLDS,
  .force = force,
};
#endif
