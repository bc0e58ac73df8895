/* Drag in proportion to the velocity, the same in all directions.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/effect/effect.h"

#ifndef CLOTH_SIM_LANES
static const gchar *const confusions[] = {
  "air_drag", "air_drag_tangential", "damping_mass",
  NULL
};

/* *INDENT-OFF* */
const ClothEffect cloth_effect_air_drag_linear = {
  .id = "air_drag_linear",
  .side = CLOTH_EFFECT_PHYSICS,
  .blurb =
      "Air brakes every piece of cloth against its velocity, in "
      "proportion to it, whichever way the piece faces: force −c v on "
      "each unit of area.",
  .source =
      "Drag of some simulators, Blender’s among them; prior: the slope "
      "of ½ρ C_N v² at 0.3 m/s.",
  .regressor =
      "A force against the whole velocity, tangential parts included, "
      "in proportion to it; cosine 0.93 with air_drag, and the same as "
      "damping_mass where the areal mass is even.",
  .confusions = confusions,
  .n_parameters = 1,
  .parameters = {
    {.name = "coefficient", .unit = "N s/m³", .null_value = 0, .min = 0, .max = 20,
        .prior = 0.3, .one_sided = TRUE,
        .blurb = "Force on each unit of area over the velocity"},
  }
};
/* *INDENT-ON* */
#else

#include "gst/sim/lanes/hooks.h"

static void
rate (const ClothLaneState * state, const ClothLaneEffect * effect,
    ClothLane * omega2, ClothLane * friction)
{
  ClothLane most = cloth_lane_set (0.);

  for (guint i = 0; i < state->n; i++)
    most = cloth_lane_max (most,
        state->inverse_mass[i] * (ClothReal) state->body->area[i]);
  *friction += effect->p[0] * most;
}

static void
force (ClothLaneState * state, ClothLaneEffect * effect)
{
  for (guint i = 0; i < state->n; i++) {
    ClothLane drag = effect->p[0] * (ClothReal) state->body->area[i];

    for (guint k = 0; k < 3; k++)
      state->f[i][k] -= drag * state->v[i][k];
  }
}

const ClothLaneHooks CLOTH_LANE_NAME (cloth_hooks_air_drag_linear) = {
  .order = CLOTH_LANE_ORDER_AIR,
  .rate = rate,
  .force = force,
};
#endif
