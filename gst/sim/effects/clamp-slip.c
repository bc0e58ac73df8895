/* A clamp that slipped.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

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
  .test = CLOTH_EFFECT_TEST_JUMP,
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
    {.name = "time", .unit = "s", .null_value = 0, .min = -1e11, .max = 1e11,
        .prior = 1, .shapes = TRUE, .moment = TRUE,
        .blurb = "When it began; without displacement it means nothing"},
    {.name = "held", .unit = "1", .null_value = -1, .min = -1, .max = 999999,
        .prior = 1, .shapes = TRUE,
        .blurb = "Which clamp, counted from 0 in the list “held” of the take; −1 "
            "is every one"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

/* Time in which it slips, s. */
#define SLIP 0.05

static void
clamp (const ClothLaneState * state, const ClothLaneEffect * effect,
    guint held, gdouble time_s, ClothLane position[3])
{
  ClothLane zero = cloth_lane_set (0.), one = cloth_lane_set (1.);
  ClothLane share = (cloth_lane_set (time_s) - effect->p[3]) *
      cloth_lane_set (1. / SLIP);
  ClothMask which = cloth_lane_equal (effect->p[4], cloth_lane_set (held)) |
      cloth_lane_less (effect->p[4], zero);

  share = cloth_lane_select (which, cloth_lane_max (zero,
          cloth_lane_min (one, share)), zero);
  for (guint k = 0; k < 3; k++)
    position[k] += share * effect->p[k];
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_clamp_slip) = {
  .clamp = clamp,
};
#endif
