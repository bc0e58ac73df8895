/* Bending of hinges. The energy of a fold is quadratic in the positions (Bergou et al.
 * 2006: right as long as the cloth hardly stretches), so its forces are a constant matrix
 * times the positions; damping takes the velocities along: K (x + βv).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/lanes/state.h"

CLOTH_LANE_INLINE void
fold (const ClothLaneState * state, guint begin, guint end, guint corners)
{
  ClothLane3 *z = state->z, *f = state->f;
  ClothLane warp = state->bending_warp, weft = state->bending_weft;

  for (guint i = begin; i < end; i++) {
    const ClothLaneHinge *h = &state->hinges[i];
    const guint32 *p = h->particle;
    ClothLane stiffness = warp * h->warp + weft * h->weft;

    for (guint k = 0; k < 3; k++) {
      ClothLane y = z[p[0]][k] * h->c[0];

      for (guint corner = 1; corner < corners; corner++)
        y += z[p[corner]][k] * h->c[corner];
      y *= stiffness;
      for (guint corner = 0; corner < corners; corner++)
        f[p[corner]][k] -= y * h->c[corner];
    }
  }
}

/* Adds the bending forces. */
void CLOTH_LANE_NAME (cloth_lane_bending) (ClothLaneState * state)
{
  ClothLane beta = state->beta;

  for (guint i = 0; i < state->n; i++)
    for (guint k = 0; k < 3; k++)
      state->z[i][k] = state->x[i][k] + beta * state->v[i][k];
  fold (state, 0, state->body->n_straight, 3);
  fold (state, state->body->n_straight, state->body->n_hinges, 4);
}

ClothLane
CLOTH_LANE_NAME (cloth_lane_bending_energy) (const ClothLaneState * state)
{
  ClothLane energy = cloth_lane_set (0.);

  for (guint i = 0; i < state->body->n_hinges; i++) {
    const ClothLaneHinge *h = &state->hinges[i];
    ClothLane stiffness =
        state->bending_warp * h->warp + state->bending_weft * h->weft;

    for (guint k = 0; k < 3; k++) {
      ClothLane y = cloth_lane_set (0.);

      for (guint corner = 0; corner < 4; corner++)
        y += state->x[h->particle[corner]][k] * h->c[corner];
      energy += stiffness * y * y * cloth_lane_set (0.5);
    }
  }
  return energy;
}
