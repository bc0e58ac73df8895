/* Cloth cut askew to its threads.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/effects/effects.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "stretch_anisotropy", "bending_anisotropy", "shear",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_grain_angle = {
  .id = "grain_angle",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "The threads are turned against u and v by an angle.",
  .source =
      "Prior: own choice, a few degrees of skew.",
  .regressor =
      "Forces within the plane that couple stretch and shear, of "
      "opposite sign left and right of the middle.",
  .confusions = confusions,
  .n_parameters = 1,
  .parameters = {
    {.name = "angle", .unit = "°", .null_value = 0, .min = -90, .max = 90,
        .prior = 3,
        .blurb = "From u to the warp, positive towards v"},
  }
};
/* *INDENT-ON* */
#endif
