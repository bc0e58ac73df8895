/* Folds that stay.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "rest_curvature", "hysteresis", "bending_softening",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_plasticity = {
  .id = "plasticity",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "Where a fold is sharper than the yield curvature, its rest "
      "curvature follows by a share of what exceeds it, and stays.",
  .source =
      "Creases of 10 to 50 1/m remain in cloth.",
  .regressor =
      "A bending moment that is there after a sharp fold has passed and "
      "was not before it; loading and unloading differ.",
  .confusions = confusions,
  .n_parameters = 2,
  .parameters = {
    {.name = "share", .unit = "1", .null_value = 0, .min = 0, .max = 1,
        .prior = 0.3, .one_sided = TRUE,
        .blurb = "Share of the curvature beyond yield that stays"},
    {.name = "yield", .unit = "1/m", .null_value = 30, .min = 0, .max = 1000,
        .prior = 20, .shapes = TRUE, .n_tried = 1, .tried = {10},
        .blurb = "Curvature from which folds stay; without share it means nothing"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

static void
reset (ClothLaneState * state, ClothLaneEffect * effect, ClothMask lanes)
{
  ClothLane *creases = effect->state, zero = cloth_lane_set (0.);

  for (guint i = 0; i < state->body->n_hinges; i++)
    creases[i] = cloth_lane_select (lanes, zero, creases[i]);
}

/* The curvature drags the crease along once it is the yield away from it, so what stays
 * is a matter of the folds, not of how long they last. */
static void
force (ClothLaneState * state, ClothLaneEffect * effect)
{
  ClothLane *creases = effect->state, share = effect->p[0];
  ClothLane yield = effect->p[1];

  for (guint i = 0; i < state->body->n_hinges; i++) {
    ClothLaneFold fold;
    ClothLane curvature;

    cloth_lane_fold (state, i, &fold);
    curvature = cloth_lane_dot (fold.y, fold.normal) / fold.form;
    creases[i] = cloth_lane_max (curvature - yield,
        cloth_lane_min (curvature + yield, creases[i]));
    for (guint k = 0; k < 3; k++)
      fold.y[k] = share * creases[i] * fold.form * fold.normal[k];
    cloth_lane_unfold (state, i, &fold, fold.y);
  }
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_plasticity) = {
  .order = CLOTH_LANE_ORDER_CREASES,
  .hinge_size = sizeof (ClothLane),
  .force = force,
  .reset = reset,
};
#endif
