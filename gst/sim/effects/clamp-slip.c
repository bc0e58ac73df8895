/* A clamp that slipped.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/effects/effects.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "clamp_compliance", "clamp_delay", "extrinsic_drift",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_clamp_slip = {
  .id = "clamp_slip",
  .side = CLOTH_EFFECT_CLAMP,
  .blurb =
      "From a time on a clamp holds the cloth off its logged path; it "
      "gets there evenly within 0.05 s.",
  .source =
      "Slips of 1 to 30 mm.",
  .regressor =
      "A jump of the residual next to one clamp that then stays: slip "
      "is irreversible, compliance is not.",
  .confusions = confusions,
  .n_parameters = 5,
  .parameters = {
    {.name = "x", .unit = "m", .null_value = 0, .min = -0.5, .max = 0.5,
        .prior = 0.01,
        .blurb = "Displacement along x"},
    {.name = "y", .unit = "m", .null_value = 0, .min = -0.5, .max = 0.5,
        .prior = 0.01,
        .blurb = "Displacement along y"},
    {.name = "z", .unit = "m", .null_value = 0, .min = -0.5, .max = 0.5,
        .prior = 0.01,
        .blurb = "Displacement along z"},
    {.name = "time", .unit = "s", .null_value = 0, .min = -1000000.0, .max = 1000000.0,
        .prior = 1,
        .blurb = "When it began; without displacement it means nothing"},
    {.name = "held", .unit = "1", .null_value = -1, .min = -1, .max = 999999,
        .prior = 1,
        .blurb = "Which clamp, counted from 0 in the list “held” of the take; −1 "
            "is every one"},
  }
};
/* *INDENT-ON* */
#endif
