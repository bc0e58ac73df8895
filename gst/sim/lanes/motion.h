/* What the forces do to a particle in a step, or in a stage of one.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/sim/lanes/state.h"

/* What all particles share in a step. */
typedef struct
{
  ClothLane h;                  /* s: so long the particles move */
  ClothLane kick;               /* s: so long forces act on them */
  ClothLane alpha, g[3];        /* times kick */
  ClothLane share;              /* of the observer's way from now to next */
} ClothLaneMotion;

CLOTH_LANE_INLINE void
cloth_lane_motion_init (const ClothLaneState * state, ClothLane kick,
    ClothLaneMotion * motion)
{
  motion->h = cloth_lane_set (state->dt);
  motion->kick = kick;
  motion->alpha = kick * state->alpha;
  for (guint k = 0; k < 3; k++)
    motion->g[k] = kick * state->gravity[k];
  motion->share = cloth_lane_targets_share (state, state->time);
}

/* Leapfrog: the velocity by the force at the old place, the place by the new velocity. */
CLOTH_LANE_INLINE void
cloth_lane_move (ClothLaneState * state, const ClothLaneMotion * motion,
    guint particle, const ClothLane force[3], gboolean nudged)
{
  ClothLane w = motion->kick * state->inverse_mass[particle], pull[3];

  if (nudged)
    cloth_lane_target (state, particle, motion->share, pull);
  for (guint k = 0; k < 3; k++) {
    ClothLane v = state->v[particle][k];
    ClothLane dv = force[k] * w + (motion->g[k] - motion->alpha * v);

    if (nudged)
      dv += motion->kick * pull[k];
    state->before_v[particle][k] = v;
    v += dv;
    state->v[particle][k] = v;
    state->x[particle][k] += motion->h * v;
  }
}

/* What all particles share in a stage: v_j = μ v_{j−1} + ν v_{j−2} + h a (v_{j−1}). */
typedef struct
{
  ClothLane mu, nu;
  ClothLaneMotion motion;
} ClothLaneStage;

CLOTH_LANE_INLINE void
cloth_lane_stage_init (const ClothLaneState * state, ClothLane h, gdouble mu,
    gdouble nu, ClothLaneStage * stage)
{
  cloth_lane_motion_init (state, h, &stage->motion);
  stage->mu = cloth_lane_set (mu);
  stage->nu = cloth_lane_set (nu);
}

CLOTH_LANE_INLINE void
cloth_lane_stage (ClothLaneState * state, const ClothLaneStage * stage,
    guint particle, const ClothLane force[3])
{
  const ClothLaneMotion *motion = &stage->motion;
  ClothLane w = motion->kick * state->inverse_mass[particle];

  for (guint k = 0; k < 3; k++) {
    ClothLane v = state->v[particle][k];

    state->last_v[particle][k] = stage->mu * v + stage->nu *
        state->last_v[particle][k] + (force[k] * w + (motion->g[k] -
            motion->alpha * v));
  }
}
