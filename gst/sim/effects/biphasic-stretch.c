/* Stretch that stiffens beyond a knee.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/effects/effects.h"

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
    {.name = "knee", .unit = "1", .null_value = 0.1, .min = 0, .max = 2,
        .prior = 0.1,
        .blurb = "Strain from which it acts; without ratio it means nothing"},
  }
};
/* *INDENT-ON* */
#endif
