/* Bending of hinges. The energy of a fold is quadratic in the positions (Bergou et al.
 * 2006: right as long as the cloth hardly stretches), so its forces are a constant matrix
 * times the positions; damping takes the velocities along: K (x + βv).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/lanes/state.h"

/* Adds the bending forces. */
void CLOTH_LANE_NAME (cloth_lane_bending) (ClothLaneState * state)
{
  ClothLane3 *f = state->f;
  ClothLane beta = state->beta;

  for (guint i = 0; i < state->body->n_hinges; i++) {
    const ClothLaneHinge *h = &state->hinges[i];
    const guint32 *p = h->particle;
    ClothLane stiffness =
        state->bending_warp * h->warp + state->bending_weft * h->weft;

    for (guint k = 0; k < 3; k++) {
      ClothLane fold = cloth_lane_set (0.), rate = cloth_lane_set (0.);

      for (guint corner = 0; corner < 4; corner++) {
        fold += state->x[p[corner]][k] * h->c[corner];
        rate += state->v[p[corner]][k] * h->c[corner];
      }
      fold = (fold + beta * rate) * stiffness;
      for (guint corner = 0; corner < 4; corner++)
        f[p[corner]][k] -= fold * h->c[corner];
    }
  }
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
      ClothLane fold = cloth_lane_set (0.);

      for (guint corner = 0; corner < 4; corner++)
        fold += state->x[h->particle[corner]][k] * h->c[corner];
      energy += stiffness * fold * fold * cloth_lane_set (0.5);
    }
  }
  return energy;
}
