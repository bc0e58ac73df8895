/* Folds that stay.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/effects/effects.h"

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
        .prior = 20,
        .blurb = "Curvature from which folds stay; without share it means nothing"},
  }
};
/* *INDENT-ON* */
#endif
