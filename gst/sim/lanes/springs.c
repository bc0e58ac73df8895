/* The mass–spring model: structural and shear springs that push back less than they pull,
 * each with a damper; its bend springs are those of bending.c.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/lanes/strain.h"

CLOTH_LANE_INLINE ClothLane
split (ClothLane stretch, ClothLane ratio)
{
  ClothLane zero = cloth_lane_set (0.);

  return cloth_lane_max (stretch, zero) + ratio * cloth_lane_min (stretch,
      zero);
}

CLOTH_LANE_INLINE void
springs (ClothLaneState * state, gboolean rest_changed)
{
  ClothLane ratio = state->compression_ratio, beta = state->beta;

  for (guint i = 0; i < state->body->n_springs; i++) {
    const ClothLaneSpring *s = &state->springs[i];
    guint32 a = s->particle[0], b = s->particle[1];
    ClothLane along[3], velocity[3], inverse, rate, force;
    ClothLane stretch =
        cloth_lane_spring_stretch (state, s, rest_changed, along, &inverse);

    cloth_lane_subtract (state->v[b], state->v[a], velocity);
    rate = cloth_lane_dot (along, velocity) * inverse;
    force = cloth_lane_spring_stiffness (state, s) * (split (stretch, ratio) +
        beta * rate) * inverse;
    for (guint k = 0; k < 3; k++) {
      ClothLane pull = force * along[k];

      state->f[a][k] += pull;
      state->f[b][k] -= pull;
    }
  }
}

/* Adds the springs' forces. */
void CLOTH_LANE_NAME (cloth_lane_springs) (ClothLaneState * state)
{
  if (state->rest_changed)
    springs (state, TRUE);
  else
    springs (state, FALSE);
}

ClothLane
CLOTH_LANE_NAME (cloth_lane_springs_energy) (const ClothLaneState * state)
{
  ClothLane energy = cloth_lane_set (0.), half = cloth_lane_set (0.5);

  for (guint i = 0; i < state->body->n_springs; i++) {
    const ClothLaneSpring *s = &state->springs[i];
    ClothLane along[3], inverse;
    ClothLane stretch =
        cloth_lane_spring_stretch (state, s, TRUE, along, &inverse);

    energy += half * cloth_lane_spring_stiffness (state, s) * stretch *
        split (stretch, state->compression_ratio);
  }
  return energy;
}

/* Each spring's part of an implicit step's matrix. */
void CLOTH_LANE_NAME (cloth_lane_springs_links) (const ClothLaneState * state,
    ClothLaneLink * links)
{
  ClothLane zero = cloth_lane_set (0.), one = cloth_lane_set (1.);

  for (guint i = 0; i < state->body->n_springs; i++) {
    const ClothLaneSpring *s = &state->springs[i];
    ClothLaneLink *link = &links[i];
    ClothLane inverse, stretch;

    stretch =
        cloth_lane_spring_stretch (state, s, state->rest_changed, link->along,
        &inverse);
    for (guint k = 0; k < 3; k++)
      link->along[k] *= inverse;
    link->damped = cloth_lane_spring_stiffness (state, s);
    link->k = link->damped * cloth_lane_select (cloth_lane_less (stretch,
            zero), state->compression_ratio, one);
    link->g = link->damped * cloth_lane_max (stretch, zero) * inverse;
  }
}
