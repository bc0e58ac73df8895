/* What holds the cloth: clamps along their paths, and the weak springs of an observer.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/lanes/state.h"

/* Forgets who was held in some lanes: the next step counts as the moment of gripping there. */
void CLOTH_LANE_NAME (cloth_lane_clamps_reset) (ClothLaneState * state,
    ClothMask lanes)
{
  for (guint i = 0; i < state->body->n_held; i++)
    state->held[i] &= ~lanes;
}

static void
clamp_place (const ClothLaneState * state, guint held, gdouble time,
    ClothLane place[3])
{
  gdouble path[3];

  for (guint l = 0; l < CLOTH_N_LANES; l++) {
    if (l == 0 || state->paths[l] != state->paths[l - 1])
      cloth_lane_path (state, held, l, time, path);
    for (guint k = 0; k < 3; k++)
      CLOTH_LANE_AT (&place[k], l) = (ClothReal) path[k];
  }
  for (guint i = 0; i < state->n_effects; i++)
    if (state->effects[i].hooks->clamp)
      state->effects[i].hooks->clamp (state, &state->effects[i], held, time,
          place);
}

/* The clamp grips in these lanes. */
static void
grip (ClothLaneState * state, guint i, gdouble start_s, ClothMask lanes,
    const ClothLane before[3])
{
  ClothLane place[3];

  clamp_place (state, i, start_s, place);
  for (guint k = 0; k < 3; k++) {
    state->held_x[i][k] = cloth_lane_select (lanes, before[k],
        state->held_x[i][k]);
    state->held_offset[i][k] = cloth_lane_select (lanes, before[k] - place[k],
        state->held_offset[i][k]);
  }
  for (guint l = 0; l < CLOTH_N_LANES; l++)
    if (CLOTH_LANE_AT (&lanes, l))
      state->held_since[CLOTH_N_LANES * (gsize) i + l] = start_s;
  state->held[i] |= lanes;
}

/* Where a clamp wants its particle at the end of a step; FALSE when it does not hold it
 * then. Before the step the particle is at @before. One that is off its path when the
 * clamp grips is drawn to it within one frame, not thrown. */
gboolean
CLOTH_LANE_NAME (cloth_lane_clamp_grips) (ClothLaneState * state, guint i,
    gdouble time_s, const ClothLane before[3], ClothLane place[3])
{
  const ClothBodyHeld * held = &state->body->held[i];
  const gdouble *since = state->held_since + CLOTH_N_LANES * (gsize) i;
  const ClothMask others = ~state->held[i];
  ClothLane share;

  /* half a step of tolerance: no clamp grips for a rounding error */
  if (time_s < held->from_s + 0.5 * state->dt
      || time_s > held->until_s + 0.5 * state->dt) {
    state->held[i] = state->held[i] ^ state->held[i];
    return FALSE;
  }
  if (cloth_lane_any (others))
    grip (state, i, time_s - state->dt, others, before);
  clamp_place (state, i, time_s, place);
  for (guint l = 0; l < CLOTH_N_LANES; l++)
    CLOTH_LANE_AT (&share, l) = (ClothReal) MAX (0., 1. - (time_s - since[l]) /
        state->body->frame_s);
  for (guint k = 0; k < 3; k++)
    place[k] += share * state->held_offset[i][k];
  return TRUE;
}

/* Puts held particles where their clamps are at the end of the step, which state->time
 * already says. Clamps that give have had their part in an implicit step. */
void CLOTH_LANE_NAME (cloth_lane_clamps) (ClothLaneState * state)
{
  const ClothBody *body = state->body;
  ClothLane per_dt = cloth_lane_set (1. / state->dt);
  ClothLane dt = cloth_lane_set (state->dt);
  ClothMask hard = cloth_lane_equal (state->compliance, cloth_lane_set (0.));

  for (guint i = 0; i < body->n_held; i++) {
    guint p = body->held[i].particle;
    ClothLane mass = state->compliance * state->mass[p], before[3], place[3];

    for (guint k = 0; k < 3; k++)
      before[k] = state->x[p][k] - dt * state->v[p][k];
    if (!CLOTH_LANE_NAME (cloth_lane_clamp_grips) (state, i, state->time,
            before, place))
      continue;
    for (guint k = 0; k < 3; k++) {
      ClothLane free_v = state->v[p][k], x = before[k];

      /* the spring's force at the end of the step: stable however stiff it is */
      free_v = (free_v * mass + dt * (place[k] - x)) / (mass + dt * dt);
      x += dt * free_v;
      if (state->implicit) {
        free_v = state->v[p][k];
        x = state->x[p][k];
      }
      state->x[p][k] = cloth_lane_select (hard, place[k], x);
      state->v[p][k] = cloth_lane_select (hard,
          (place[k] - state->held_x[i][k]) * per_dt, free_v);
      state->held_x[i][k] = state->x[p][k];
    }
  }
}

/* Adds the forces of the observer's springs at a time to f. */
void
CLOTH_LANE_NAME (cloth_lane_targets) (const ClothLaneState * state,
    gdouble time_s, ClothLane3 * f)
{
  ClothLane share = cloth_lane_targets_share (state, time_s);

  for (guint i = 0; i < state->n; i++) {
    ClothLane pull[3];

    cloth_lane_target (state, i, share, pull);
    for (guint k = 0; k < 3; k++)
      f[i][k] += state->mass[i] * pull[k];
  }
}
