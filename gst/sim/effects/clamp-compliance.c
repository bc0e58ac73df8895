/* Clamps that give.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "clamp_slip", "stretch",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_clamp_compliance = {
  .id = "clamp_compliance",
  .side = CLOTH_EFFECT_CLAMP,
  .blurb =
      "Clamps hold the cloth through springs.",
  .source =
      "Clamps of 50 to 500 N/m.",
  .regressor =
      "A displacement at the clamps in proportion to their load, gone "
      "when the load is.",
  .confusions = confusions,
  .n_parameters = 1,
  .parameters = {
    {.name = "compliance", .unit = "m/N", .null_value = 0, .min = 0, .max = 0.5,
        .prior = 0.005, .one_sided = TRUE,
        .blurb = "Displacement of a held vertex over its load"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

static void
setup (ClothLaneState * state, ClothLaneEffect * effect)
{
  state->compliance += effect->p[0];
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_clamp_compliance) = {
  .setup = setup,
};
#endif
