/* Gravity, or the time base, is off.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "areal_mass", "added_mass", "focal_length",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_gravity_scale = {
  .id = "gravity_scale",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "Gravity is multiplied by a factor. A frame rate that is wrong by "
      "a factor f looks the same as f².",
  .source =
      "Prior: own choice.",
  .regressor =
      "A steady force in proportion to weight.",
  .confusions = confusions,
  .n_parameters = 1,
  .parameters = {
    {.name = "factor", .unit = "1", .null_value = 1, .min = 0.25, .max = 4,
        .prior = 0.02,
        .blurb = "What gravity is multiplied with"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

static void
setup (ClothLaneState * state, ClothLaneEffect * effect)
{
  for (guint k = 0; k < 3; k++)
    state->gravity[k] *= effect->p[0];
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_gravity_scale) = {
  .setup = setup,
};
#endif
