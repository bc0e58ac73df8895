/* Clamps logged at another time.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "sync_offset", "clamp_slip",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_clamp_delay = {
  .id = "clamp_delay",
  .side = CLOTH_EFFECT_CLAMP,
  .blurb =
      "Clamps really were at time t where their log has them at t − "
      "delay.",
  .source =
      "Delays of 10 to 350 ms between a robot’s log and pictures.",
  .regressor =
      "A displacement of the clamps along their velocity; all of the "
      "cloth follows them later, where sync_offset shifts every point "
      "alike.",
  .confusions = confusions,
  .n_parameters = 1,
  .parameters = {
    {.name = "delay", .unit = "s", .null_value = 0, .min = -1, .max = 1,
        .prior = 0.1,
        .blurb = "How much later than logged the clamps moved"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

static void
clamp (const ClothLaneState * state, const ClothLaneEffect * effect,
    guint held, gdouble time_s, ClothLane position[3])
{
  gdouble now[3], then[3];

  for (guint l = 0; l < CLOTH_N_LANES; l++) {
    cloth_lane_path (state, held, l, time_s, now);
    cloth_lane_path (state, held, l,
        time_s - CLOTH_LANE_AT (&effect->p[0], l), then);
    for (guint k = 0; k < 3; k++)
      CLOTH_LANE_AT (&position[k], l) += (ClothReal) (then[k] - now[k]);
  }
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_clamp_delay) = {
  .clamp = clamp,
};
#endif
