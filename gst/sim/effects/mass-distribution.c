/* A heavy hem.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/effects/effects.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "areal_mass", "air_drag",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_mass_distribution = {
  .id = "mass_distribution",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "Areal mass is larger by a factor in a band along the lower edge, "
      "where v is largest: a hem, a seam, wet cloth.",
  .source =
      "Hem, seam or wet edge: 2 to 5 times over 2 cm.",
  .regressor =
      "A force in proportion to gravity minus acceleration in the "
      "lowest band alone, which tensions all above.",
  .confusions = confusions,
  .n_parameters = 2,
  .parameters = {
    {.name = "factor", .unit = "1", .null_value = 1, .min = 1, .max = 20,
        .prior = 2, .one_sided = TRUE,
        .blurb = "Areal mass in the band over that of the rest"},
    {.name = "height", .unit = "m", .null_value = 0.02, .min = 0.001, .max = 10,
        .prior = 0.02,
        .blurb = "Height of the band on the flat cloth; with a factor of 1 it "
            "means nothing"},
  }
};
/* *INDENT-ON* */
#endif
