/* The orthotropic membrane: St. Venant–Kirchhoff triangles that push back less than they
 * pull, with Kelvin–Voigt damping.
 *
 * With x_u = ∂x/∂u and x_v = ∂x/∂v of a triangle, Green's strains are
 * ½(x_u·x_u − 1), ½(x_v·x_v − 1) and γ = x_u·x_v. These products are a linear map t of
 * the products of the edges, so the strains, their rates and the forces come straight
 * from edges and differences of velocity:
 *   energy = area (½ c_warp E_uu² + ½ c_weft E_vv² + ½ c_shear γ²).
 * Negative strains count with compression_ratio. The damping has the full moduli always:
 * else nothing calms compressed cloth, and derivatives of its motion are worthless.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/lanes/strain.h"

CLOTH_LANE_INLINE ClothLane
split (ClothLane strain, ClothLane ratio)
{
  ClothLane zero = cloth_lane_set (0.);

  return cloth_lane_max (strain, zero) + ratio * cloth_lane_min (strain, zero);
}

CLOTH_LANE_INLINE void
triangles (ClothLaneState * state, guint begin, guint end, gboolean right,
    gboolean rest_changed)
{
  ClothLane half = cloth_lane_set (0.5), ratio = state->compression_ratio;
  ClothLane warp = state->stretch_warp * state->rest_area;
  ClothLane weft = state->stretch_weft * state->rest_area;
  ClothLane shear = state->shear * state->rest_area;
  ClothLane damp_warp = warp * state->beta, damp_weft = weft * state->beta;
  ClothLane damp_shear = shear * state->beta * cloth_lane_set (2.);

  for (guint i = begin; i < end; i++) {
    const ClothLaneTriangle *t = &state->triangles[i];
    ClothLane m[3], r[3], s[3];
    ClothLaneEdges edges;

    cloth_lane_measure (state, t, &edges);
    cloth_lane_map (t->t, right, edges.d, m);
    cloth_lane_map (t->t, right, edges.r, r);
    if (rest_changed) {
      cloth_lane_map_rest (state->metric, m);
      cloth_lane_map_rest (state->metric, r);
    }
    s[0] = warp * split (m[0] * half - half, ratio) + damp_warp * r[0];
    s[1] = weft * split (m[1] * half - half, ratio) + damp_weft * r[1];
    s[2] = (shear * m[2] + damp_shear * r[2]) * cloth_lane_set (2.);
    cloth_lane_push_edges (state, t, &edges, right, rest_changed, s);
  }
}

/* Adds the membrane's forces. */
void CLOTH_LANE_NAME (cloth_lane_membrane) (ClothLaneState * state)
{
  guint right = state->body->n_right, n = state->body->n_triangles;

  /* maps that are the identity change no bit: which loop runs is a matter of speed */
  if (state->rest_changed) {
    triangles (state, 0, right, TRUE, TRUE);
    triangles (state, right, n, FALSE, TRUE);
  } else {
    triangles (state, 0, right, TRUE, FALSE);
    triangles (state, right, n, FALSE, FALSE);
  }
}

ClothLane
CLOTH_LANE_NAME (cloth_lane_membrane_energy) (const ClothLaneState * state)
{
  ClothLane energy = cloth_lane_set (0.), half = cloth_lane_set (0.5);

  for (guint i = 0; i < state->body->n_triangles; i++) {
    const ClothLaneTriangle *t = &state->triangles[i];
    ClothLane m[3], e[2];
    ClothLaneEdges edges;

    cloth_lane_measure (state, t, &edges);
    cloth_lane_map (t->t, FALSE, edges.d, m);
    cloth_lane_map_rest (state->metric, m);
    e[0] = m[0] * half - half;
    e[1] = m[1] * half - half;
    energy += (state->stretch_warp * e[0] * split (e[0],
            state->compression_ratio) + state->stretch_weft * e[1] *
        split (e[1], state->compression_ratio) +
        state->shear * m[2] * m[2]) * half * state->rest_area * t->area;
  }
  return energy;
}
