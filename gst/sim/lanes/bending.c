/* Bending. The energy of a fold is quadratic in the positions (Bergou et al. 2006: right
 * as long as the cloth hardly stretches), so its forces are a constant matrix times the
 * positions; damping takes the velocities along: K (x + βv). Grids go fold by fold, other
 * meshes by the rows of the matrix.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/lanes/state.h"

CLOTH_LANE_INLINE void
folds (const ClothLaneState * state, guint begin, guint end, guint corners,
    ClothLane warp, ClothLane weft, const ClothLane3 * z, ClothLane3 * f)
{
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
        f[p[corner]][k] += y * h->c[corner];
    }
  }
}

/* Differences: so places far from the origin don't cost digits. */
static void
rows (const ClothLaneState * state, ClothLane warp, ClothLane weft,
    const ClothLane3 * z, ClothLane3 * f)
{
  const guint32 *first = state->body->first_bend;

  for (guint i = 0; i < state->n; i++) {
    ClothLane sum[3] = { f[i][0], f[i][1], f[i][2] };

    for (guint m = first[i]; m < first[i + 1]; m++) {
      const ClothLaneBend *bend = &state->bends[m];
      ClothLane stiffness = warp * bend->warp + weft * bend->weft;

      for (guint k = 0; k < 3; k++)
        sum[k] += stiffness * (z[bend->particle][k] - z[i][k]);
    }
    for (guint k = 0; k < 3; k++)
      f[i][k] = sum[k];
  }
}

/* Adds the hinges' matrix times z to f, by @warp and @weft. */
void CLOTH_LANE_NAME (cloth_lane_bends) (const ClothLaneState * state,
    ClothLane warp, ClothLane weft, const ClothLane3 * z, ClothLane3 * f)
{
  const ClothBody * body = state->body;

  if (state->bends) {
    rows (state, warp, weft, z, f);
    return;
  }
  folds (state, 0, body->n_straight, 3, warp, weft, z, f);
  folds (state, body->n_straight, body->n_hinges, 4, warp, weft, z, f);
}

/* Adds the bending forces. */
void CLOTH_LANE_NAME (cloth_lane_bending) (ClothLaneState * state)
{
  ClothLane beta = state->beta;

  for (guint i = 0; i < state->n; i++)
    for (guint k = 0; k < 3; k++)
      state->z[i][k] = state->x[i][k] + beta * state->v[i][k];
  CLOTH_LANE_NAME (cloth_lane_bends) (state, -state->bending_warp,
      -state->bending_weft, state->z, state->f);
}

ClothLane
CLOTH_LANE_NAME (cloth_lane_bending_energy) (const ClothLaneState * state)
{
  ClothLane energy = cloth_lane_set (0.);

  for (guint i = 0; i < state->body->n_hinges; i++) {
    const ClothBodyHinge *h = &state->body->hinges[i];
    ClothLane stiffness = state->bending_warp * (ClothReal) h->warp +
        state->bending_weft * (ClothReal) h->weft;

    for (guint k = 0; k < 3; k++) {
      ClothLane y = cloth_lane_set (0.);

      for (guint corner = 0; corner < h->n; corner++)
        y += state->x[h->particle[corner]][k] * (ClothReal) h->c[corner];
      energy += stiffness * y * y * cloth_lane_set (0.5);
    }
  }
  return energy;
}
