/* Air that has to move with the cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/effects/effects.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "areal_mass", "gravity_scale",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_added_mass = {
  .id = "added_mass",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "Air that is carried along adds inertia, but no weight, to motion "
      "along the normal.",
  .source =
      "Plate of width b: π ρ b/4 on each unit of area, 0.04 to 0.5 "
      "kg/m² for folds to whole sheets: Lamb, Hydrodynamics, 1932.",
  .regressor =
      "A force against the normal acceleration, in proportion to it.",
  .confusions = confusions,
  .n_parameters = 1,
  .parameters = {
    {.name = "mass", .unit = "kg/m²", .null_value = 0, .min = 0, .max = 5,
        .prior = 0.2, .one_sided = TRUE,
        .blurb = "Mass of the air that moves with each unit of area"},
  }
};
/* *INDENT-ON* */
#endif
