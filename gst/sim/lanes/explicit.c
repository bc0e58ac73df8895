/* Leapfrog: velocities are those of the middle between two places (Hairer, Lubich and Wanner,
 * Geometric Numerical Integration, section I.1.4).
 *   v₊ = v + ½ (h₋ + h) M⁻¹ f (x, v),  x₊ = x + h v₊,
 * where h₋ is the step before, 0 where velocities were set: those are of the time of the places.
 * So places are of second order in h, whatever the steps are. The observer and
 * pulls, whose damping is strong, have velocities of the time of the places, as the last two say;
 * other forces those of half a step ago, which is of first order in them alone.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/lanes/motion.h"

/* The cloth's own forces at x and v, into f. */
void CLOTH_LANE_NAME (cloth_lane_own_forces) (ClothLaneState * state)
{
  if (state->grid) {
    CLOTH_LANE_NAME (cloth_lane_grid_forces) (state);
    CLOTH_LANE_NAME (cloth_lane_membrane_rest) (state);
    return;
  }
  memset (state->f, 0, state->n * sizeof *state->f);
  if (state->force_model == CLOTH_FORCE_MASS_SPRING)
    CLOTH_LANE_NAME (cloth_lane_springs) (state);
  else
    CLOTH_LANE_NAME (cloth_lane_membrane) (state);
  CLOTH_LANE_NAME (cloth_lane_bending) (state);
}

/* Adds those of effects to f. */
void CLOTH_LANE_NAME (cloth_lane_effect_forces) (ClothLaneState * state)
{
  for (guint i = 0; i < state->n_effects; i++)
    if (state->effects[i].hooks->force)
      state->effects[i].hooks->force (state, &state->effects[i]);
}

/* Changes f, where all forces are, by what effects make of them. */
void CLOTH_LANE_NAME (cloth_lane_inertia) (ClothLaneState * state)
{
  for (guint i = 0; i < state->n_effects; i++)
    if (state->effects[i].hooks->inertia)
      state->effects[i].hooks->inertia (state, &state->effects[i]);
}

/* All of them into f: gravity, damping αM and the observer are the integrator's, which
 * knows the accelerations. */
void CLOTH_LANE_NAME (cloth_lane_forces) (ClothLaneState * state)
{
  CLOTH_LANE_NAME (cloth_lane_own_forces) (state);
  CLOTH_LANE_NAME (cloth_lane_effect_forces) (state);
  CLOTH_LANE_NAME (cloth_lane_inertia) (state);
}

CLOTH_LANE_INLINE void
move (ClothLaneState * state, gboolean nudged)
{
  ClothLaneMotion motion;

  cloth_lane_motion_init (state, state->kick, &motion);
  for (guint i = 0; i < state->n; i++)
    cloth_lane_move (state, &motion, i, state->f[i], nudged);
}

/* One step of state->dt. */
void CLOTH_LANE_NAME (cloth_lane_explicit) (ClothLaneState * state)
{
  if (state->pulls.n) {
    memset (state->others, 0, state->n * sizeof *state->others);
    CLOTH_LANE_NAME (cloth_lane_pulls) (state, state->time, state->others);
  }
  if (state->grid_alone && !state->has_forces) {
    CLOTH_LANE_NAME (cloth_lane_grid_step) (state);
    return;
  }
  CLOTH_LANE_NAME (cloth_lane_forces) (state);
  for (guint i = 0; state->pulls.n && i < state->n; i++)
    for (guint k = 0; k < 3; k++)
      state->f[i][k] += state->others[i][k];
  if (state->has_targets)
    move (state, TRUE);
  else
    move (state, FALSE);
}

/* Stiffness over mass, the bound of ω² by Gershgorin's rows. */
ClothLane CLOTH_LANE_NAME (cloth_lane_stiffness) (const ClothLaneState * state)
{
  ClothLane most = cloth_lane_set (0.);

  for (guint i = 0; i < state->n; i++) {
    const ClothBodyBound *b = &state->body->bounds[i];
    ClothLane u = state->stretch_warp * (ClothReal) b->warp +
        state->shear * (ClothReal) b->shear_u;
    ClothLane v = state->stretch_weft * (ClothReal) b->weft +
        state->shear * (ClothReal) b->shear_v;

    if (state->force_model == CLOTH_FORCE_MASS_SPRING) {
      u = state->stretch_warp * (ClothReal) b->springs[0][0] +
          state->stretch_weft * (ClothReal) b->springs[0][1] +
          state->shear * (ClothReal) b->springs[0][2];
      v = state->stretch_warp * (ClothReal) b->springs[1][0] +
          state->stretch_weft * (ClothReal) b->springs[1][1] +
          state->shear * (ClothReal) b->springs[1][2];
    }
    most = cloth_lane_max (most, (cloth_lane_max (u, v) +
            cloth_lane_bend_bound (state, i)) * state->inverse_mass[i]);
  }
  return most;
}

/* The largest stable step of each lane. A mode of frequency ω damped by c (1/s) is stable
 * when h²ω² + 2hc < 4 (Jury's criterion on its two-by-two map). */
ClothLane
CLOTH_LANE_NAME (cloth_lane_explicit_time_step) (const ClothLaneState * state,
    const ClothLaneBounds * bounds)
{
  ClothLane four = cloth_lane_set (4.), least = cloth_lane_set (1e-6);
  /* even when nothing is stiff there is a step */
  const ClothLanePulls *pulls = &state->pulls;
  ClothLane more = bounds->own - state->own_omega2;
  ClothLane omega2 = state->omega2 + state->targets.gain +
      pulls->gain * pulls->bound + more + bounds->pulled;
  /* velocities that change their sign in each step are ahead twice as large */
  ClothLane friction = state->friction + state->beta * more +
      cloth_lane_set (2.) * (state->targets.damping +
      pulls->damping * pulls->bound);
  ClothLane stiff;

  /* of an implicit step effects alone are explicit */
  if (state->implicit) {
    omega2 = state->omega2 - state->own_omega2;
    friction = state->friction - state->own_friction;
  }
  stiff = cloth_lane_max (omega2, least);

  return four * cloth_lane_set (bounds->margin) / (friction +
      cloth_lane_sqrt (friction * friction + four * stiff));
}
