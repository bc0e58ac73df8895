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
#include "gst/sim/lanes/state.h"

/* Products of the edges e1, e2 of one triangle and half their rates. */
typedef struct
{
  ClothLane e1[3], e2[3];
  ClothLane d[3], r[3];
} Edges;

CLOTH_LANE_INLINE void
measure (const ClothLaneState * state, const ClothLaneTriangle * t,
    Edges * edges)
{
  const guint32 *p = t->particle;
  ClothLane v1[3], v2[3];

  cloth_lane_subtract (state->x[p[1]], state->x[p[0]], edges->e1);
  cloth_lane_subtract (state->x[p[2]], state->x[p[0]], edges->e2);
  cloth_lane_subtract (state->v[p[1]], state->v[p[0]], v1);
  cloth_lane_subtract (state->v[p[2]], state->v[p[0]], v2);
  edges->d[0] = cloth_lane_dot (edges->e1, edges->e1);
  edges->d[1] = cloth_lane_dot (edges->e2, edges->e2);
  edges->d[2] = cloth_lane_dot (edges->e1, edges->e2);
  edges->r[0] = cloth_lane_dot (edges->e1, v1);
  edges->r[1] = cloth_lane_dot (edges->e2, v2);
  edges->r[2] = (cloth_lane_dot (edges->e1, v2) +
      cloth_lane_dot (edges->e2, v1)) * cloth_lane_set (0.5);
}

/* m = matrix · d, of a triangle; its own when right-angled is diagonal. */
CLOTH_LANE_INLINE void
map (const ClothReal t[9], gboolean right, const ClothLane d[3], ClothLane m[3])
{
  for (guint k = 0; k < 3; k++)
    m[k] = right ? d[k] * t[4 * k] :
        d[0] * t[3 * k] + d[1] * t[3 * k + 1] + d[2] * t[3 * k + 2];
}

CLOTH_LANE_INLINE void
map_back (const ClothReal t[9], gboolean right, const ClothLane s[3],
    ClothLane m[3])
{
  for (guint k = 0; k < 3; k++)
    m[k] = right ? s[k] * t[4 * k] :
        s[0] * t[k] + s[1] * t[3 + k] + s[2] * t[6 + k];
}

CLOTH_LANE_INLINE void
map_rest (const ClothLane metric[9], ClothLane m[3])
{
  ClothLane d[3] = { m[0], m[1], m[2] };

  for (guint k = 0; k < 3; k++)
    m[k] = d[0] * metric[3 * k] + d[1] * metric[3 * k + 1] +
        d[2] * metric[3 * k + 2];
}

CLOTH_LANE_INLINE void
map_rest_back (const ClothLane metric[9], ClothLane s[3])
{
  ClothLane d[3] = { s[0], s[1], s[2] };

  for (guint k = 0; k < 3; k++)
    s[k] = d[0] * metric[k] + d[1] * metric[3 + k] + d[2] * metric[6 + k];
}

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
  /* by particle, so that loads and stores of one row are of one place */
  ClothLane3 *f = state->f;
  ClothLane half = cloth_lane_set (0.5), ratio = state->compression_ratio;
  ClothLane warp = state->stretch_warp * state->rest_area;
  ClothLane weft = state->stretch_weft * state->rest_area;
  ClothLane shear = state->shear * state->rest_area;
  ClothLane damp_warp = warp * state->beta, damp_weft = weft * state->beta;
  ClothLane damp_shear = shear * state->beta * cloth_lane_set (2.);

  for (guint i = begin; i < end; i++) {
    const ClothLaneTriangle *t = &state->triangles[i];
    const guint32 *p = t->particle;
    ClothLane m[3], r[3], s[3], g[3];
    Edges edges;

    measure (state, t, &edges);
    map (t->t, right, edges.d, m);
    map (t->t, right, edges.r, r);
    if (rest_changed) {
      map_rest (state->metric, m);
      map_rest (state->metric, r);
    }
    s[0] = warp * split (m[0] * half - half, ratio) + damp_warp * r[0];
    s[1] = weft * split (m[1] * half - half, ratio) + damp_weft * r[1];
    s[2] = (shear * m[2] + damp_shear * r[2]) * cloth_lane_set (2.);
    if (rest_changed)
      map_rest_back (state->metric, s);
    map_back (t->t, right, s, g);
    for (guint k = 0; k < 3; k++)
      g[k] *= t->area;
    g[2] *= half;
    for (guint k = 0; k < 3; k++) {
      ClothLane f1 = g[0] * edges.e1[k] + g[2] * edges.e2[k];
      ClothLane f2 = g[2] * edges.e1[k] + g[1] * edges.e2[k];

      f[p[0]][k] += f1 + f2;
      f[p[1]][k] -= f1;
      f[p[2]][k] -= f2;
    }
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
    Edges edges;

    measure (state, t, &edges);
    map (t->t, FALSE, edges.d, m);
    map_rest (state->metric, m);
    e[0] = m[0] * half - half;
    e[1] = m[1] * half - half;
    energy += (state->stretch_warp * e[0] * split (e[0],
            state->compression_ratio) + state->stretch_weft * e[1] *
        split (e[1], state->compression_ratio) +
        state->shear * m[2] * m[2]) * half * state->rest_area * t->area;
  }
  return energy;
}
