/* Folds of hinges, for effects that need their sign or size.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/sim/lanes/state.h"

typedef struct
{
  ClothLane y[3];               /* Σ c x */
  ClothLane normal[3];          /* of unit length, along x_u × x_v */
  ClothLane stiffness;          /* of the hinge: its force is −stiffness c y */
  ClothReal form;               /* |y| of a fold along the hinge of curvature 1/m */
} ClothLaneFold;

CLOTH_LANE_INLINE void
cloth_lane_fold (const ClothLaneState * state, guint hinge,
    ClothLaneFold * fold)
{
  const ClothBodyHinge *h = &state->body->hinges[hinge];
  const guint32 *p = h->particle;
  ClothLane along[3], across[3], length;

  fold->stiffness = state->bending_warp * (ClothReal) h->warp +
      state->bending_weft * (ClothReal) h->weft;
  fold->form = (ClothReal) sqrt (h->form[0] * h->form[0] +
      h->form[1] * h->form[1] + h->form[2] * h->form[2]);
  cloth_lane_subtract (state->x[p[3]], state->x[p[2]], along);
  cloth_lane_subtract (state->x[p[1]], state->x[p[0]], across);
  cloth_lane_cross (along, across, fold->normal);
  length = cloth_lane_sqrt (cloth_lane_max (cloth_lane_dot (fold->normal,
              fold->normal), cloth_lane_set (1e-30)));
  for (guint k = 0; k < 3; k++) {
    fold->normal[k] = fold->normal[k] * (ClothReal) h->side / length;
    fold->y[k] = state->x[p[0]][k] * (ClothReal) h->c[0];
    for (guint corner = 1; corner < h->n; corner++)
      fold->y[k] += state->x[p[corner]][k] * (ClothReal) h->c[corner];
  }
}

/* Adds the forces that draw Σ c x towards y. */
CLOTH_LANE_INLINE void
cloth_lane_unfold (ClothLaneState * state, guint hinge,
    const ClothLaneFold * fold, const ClothLane y[3])
{
  const ClothBodyHinge *h = &state->body->hinges[hinge];

  for (guint corner = 0; corner < h->n; corner++) {
    ClothLane factor = fold->stiffness * (ClothReal) h->c[corner];

    for (guint k = 0; k < 3; k++)
      state->f[h->particle[corner]][k] += factor * y[k];
  }
}
