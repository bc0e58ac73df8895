/* Cloth smaller than its pattern.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/effects/effects.h"

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
#endif
