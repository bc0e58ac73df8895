/* Bending stiffness that falls with curvature.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "bending", "plasticity", "hysteresis",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_bending_softening = {
  .id = "bending_softening",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "The bending moment of curvature κ is that of the model over 1 + "
      "length·|κ|.",
  .source =
      "Measured fabrics: median −13% at 50 1/m, a length of 0.003 m.",
  .regressor =
      "A force along the normal at sharp folds, against the bending "
      "force, growing with the square of the curvature.",
  .confusions = confusions,
  .n_parameters = 1,
  .parameters = {
    {.name = "length", .unit = "m", .null_value = 0, .min = 0, .max = 0.1,
        .prior = 0.003, .one_sided = TRUE,
        .blurb = "Radius of curvature at which half of the stiffness is left"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

/* The moment is 1/(1 + length κ) of the model's: what is missing is taken back. */
static void
force (ClothLaneState * state, ClothLaneEffect * effect)
{
  ClothLane one = cloth_lane_set (1.);

  for (guint i = 0; i < state->body->n_hinges; i++) {
    ClothLaneFold fold;
    ClothLane part;

    cloth_lane_fold (state, i, &fold);
    part = effect->p[0] * cloth_lane_sqrt (cloth_lane_dot (fold.y, fold.y)) /
        fold.form;
    part = part / (one + part);
    for (guint k = 0; k < 3; k++)
      fold.y[k] *= part;
    cloth_lane_unfold (state, i, &fold, fold.y);
  }
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_bending_softening) = {
  .order = CLOTH_LANE_ORDER_FOLDS,
  .force = force,
};
#endif
