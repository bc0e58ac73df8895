/* Bending stiffness that falls with curvature.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/effects/effects.h"

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
#endif
