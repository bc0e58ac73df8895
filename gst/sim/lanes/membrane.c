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

/* Which shape at rest. */
typedef enum
{
  SAME,                         /* the uv's own */
  CHANGED,                      /* what effects made of it */
  DIFFERENCE                    /* the forces of the latter minus those of the former */
} Rest;

/* Stresses of the products m of x_u and x_v and half their rates r; @area of the cloth at
 * rest over that in uv. */
CLOTH_LANE_INLINE void
stresses (const ClothLaneState * state, ClothLane area, const ClothLane m[3],
    const ClothLane r[3], ClothLane s[3])
{
  ClothLane half = cloth_lane_set (0.5), two = cloth_lane_set (2.);
  ClothLane ratio = state->compression_ratio, beta = state->beta;

  s[0] = state->stretch_warp * area * (split (m[0] * half - half, ratio) +
      beta * r[0]);
  s[1] = state->stretch_weft * area * (split (m[1] * half - half, ratio) +
      beta * r[1]);
  s[2] = state->shear * area * two * (m[2] + two * beta * r[2]);
}

CLOTH_LANE_INLINE void
triangles (ClothLaneState * state, guint begin, guint end, gboolean right,
    Rest rest)
{
  ClothLane one = cloth_lane_set (1.);

  for (guint i = begin; i < end; i++) {
    const ClothLaneTriangle *t = &state->triangles[i];
    ClothLane m[3], r[3], s[3], same[3];
    ClothLaneEdges edges;

    cloth_lane_measure (state, t, &edges);
    cloth_lane_map (t->t, right, edges.d, m);
    cloth_lane_map (t->t, right, edges.r, r);
    if (rest != CHANGED)
      stresses (state, one, m, r, same);
    if (rest != SAME) {
      cloth_lane_map_rest (state->metric, m);
      cloth_lane_map_rest (state->metric, r);
      stresses (state, state->rest_area, m, r, s);
      cloth_lane_map_rest_back (state->metric, s);
    }
    for (guint k = 0; k < 3; k++)
      s[k] = rest == SAME ? same[k] : rest == CHANGED ? s[k] : s[k] - same[k];
    cloth_lane_push_edges (state, t, &edges, right, FALSE, s);
  }
}

CLOTH_LANE_INLINE void
all_triangles (ClothLaneState * state, Rest rest)
{
  guint right = state->body->n_right, n = state->body->n_triangles;

  triangles (state, 0, right, TRUE, rest);
  triangles (state, right, n, FALSE, rest);
}

/* Adds the membrane's forces. */
void CLOTH_LANE_NAME (cloth_lane_membrane) (ClothLaneState * state)
{
  /* maps that are the identity change no bit: which loop runs is a matter of speed */
  if (state->rest_changed)
    all_triangles (state, CHANGED);
  else
    all_triangles (state, SAME);
}

/* Adds what another shape at rest changes in the membrane's forces. */
void CLOTH_LANE_NAME (cloth_lane_membrane_rest) (ClothLaneState * state)
{
  if (state->rest_changed)
    all_triangles (state, DIFFERENCE);
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
