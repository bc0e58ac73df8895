/* How stiff the cloth is as it is stretched now: more than at rest, for which steps are found first.
 *
 * Of a triangle with strains E, stresses S and hat functions with the gradients (u_a, v_a) the stiffness between corners
 * a and b is, in St. Venant and Kirchhoff's law,
 *   K_ab = area (c_warp u_a u_b x_u x_uᵀ + c_weft v_a v_b x_v x_vᵀ + c_shear (u_a x_v + v_a x_u)(u_b x_v + v_b x_u)ᵀ)
 *        + area (S_uu u_a u_b + S_vv v_a v_b + S_uv (u_a v_b + v_a u_b)) 1.
 * The first line grows with |x_u|² and |x_v|² and is damped by β times as much. The second, of tensions, is not damped at
 * all: across a pulled thread lengths don't change. Compression is left out, as it hastens buckling and no more.
 * Where x_u and x_v, at the angle θ, are not perpendicular the terms of warp and weft add up to (1 + |cos θ|) times the
 * larger at most. Gershgorin's rows bound both; what a clamp holds doesn't move, so it has neither row nor column.
 * Springs: k n nᵀ, and k (1 − L/l) in all directions.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/lanes/strain.h"

/* A row is what acts on one particle: along u, along v, and tensions. */
typedef enum
{
  ALONG_U,
  ALONG_V,
  PULLED
} Part;

static ClothLane
above_zero (ClothLane a)
{
  return cloth_lane_max (a, cloth_lane_set (0.));
}

static void
add_triangle (const ClothLaneState * state, guint triangle, ClothLane3 * rows)
{
  const ClothBodyTriangle *t = &state->body->triangles[triangle];
  const gdouble u[3] = { -t->g[0] - t->g[2], t->g[0], t->g[2] };
  const gdouble v[3] = { -t->g[1] - t->g[3], t->g[1], t->g[3] };
  gdouble sum_u = 0., sum_v = 0.;
  ClothLane half = cloth_lane_set (0.5), m[3], most, aslant, tension[3];
  ClothLaneEdges edges;

  cloth_lane_measure (state, &state->triangles[triangle], &edges);
  cloth_lane_map (state->triangles[triangle].t, FALSE, edges.d, m);
  cloth_lane_map_rest (state->metric, m);
  most = cloth_lane_max (m[0], m[1]);
  aslant = cloth_lane_set (1.) + cloth_lane_abs (m[2]) /
      cloth_lane_sqrt (cloth_lane_max (m[0] * m[1], cloth_lane_set (1e-12)));
  tension[0] = state->stretch_warp * above_zero (m[0] * half - half);
  tension[1] = state->stretch_weft * above_zero (m[1] * half - half);
  tension[2] = state->shear * cloth_lane_abs (m[2]);
  for (guint k = 0; k < 3; k++) {
    sum_u += state->fixed[t->particle[k]] ? 0. : fabs (u[k]);
    sum_v += state->fixed[t->particle[k]] ? 0. : fabs (v[k]);
  }
  for (guint k = 0; k < 3; k++) {
    ClothLane *row = rows[t->particle[k]];
    const gdouble one_u = t->area * fabs (u[k]), one_v = t->area * fabs (v[k]);
    const gdouble sheared = sum_u + sum_v;

    row[ALONG_U] +=
        state->stretch_warp * m[0] * aslant * cloth_lane_set (one_u * sum_u) +
        state->shear * most * cloth_lane_set (one_v * sheared);
    row[ALONG_V] +=
        state->stretch_weft * m[1] * aslant * cloth_lane_set (one_v * sum_v) +
        state->shear * most * cloth_lane_set (one_u * sheared);
    row[PULLED] +=
        tension[0] * cloth_lane_set (one_u * sum_u) +
        tension[1] * cloth_lane_set (one_v * sum_v) +
        tension[2] * cloth_lane_set (one_u * sum_v + one_v * sum_u);
  }
}

static void
add_spring (const ClothLaneState * state, guint spring, ClothLane3 * rows)
{
  const ClothLaneSpring *s = &state->springs[spring];
  ClothLane along[3], inverse;
  ClothLane longer = cloth_lane_spring_stretch (state, s, state->rest_changed,
      along, &inverse);
  ClothLane tension = cloth_lane_spring_stiffness (state, s) *
      above_zero (longer) * inverse;

  for (guint end = 0; end < 2; end++)
    rows[s->particle[end]][PULLED] += state->fixed[s->particle[!end]] ?
        tension : tension + tension;
}

/* Which particles clamps hold, and will for a frame: in all lanes alike. */
static void
find_fixed (ClothLaneState * state)
{
  const ClothLane zero = cloth_lane_set (0.);

  memset (state->fixed, 0, state->n);
  if (cloth_lane_any (cloth_lane_less (zero, state->compliance)))
    return;
  for (guint i = 0; i < state->body->n_held; i++)
    if (state->body->held[i].from_s <= state->time
        && state->body->held[i].until_s >= state->time + state->body->frame_s)
      state->fixed[state->body->held[i].particle] = TRUE;
}

/* The bounds of the cloth as it is now. */
void CLOTH_LANE_NAME (cloth_lane_strained) (ClothLaneState * state)
{
  /* between steps nobody needs the forces */
  ClothLane3 *rows = state->f;
  const gboolean springs = state->force_model == CLOTH_FORCE_MASS_SPRING;
  ClothLaneBounds *bounds = &state->strained;
  ClothLane ratio;

  find_fixed (state);
  memset (rows, 0, state->n * sizeof *rows);
  for (guint i = 0; !springs && i < state->body->n_triangles; i++)
    add_triangle (state, i, rows);
  for (guint i = 0; springs && i < state->body->n_springs; i++)
    add_spring (state, i, rows);
  bounds->own = bounds->pulled = cloth_lane_set (0.);
  for (guint i = 0; i < state->n; i++) {
    if (state->fixed[i])
      continue;
    bounds->own =
        cloth_lane_max (bounds->own, (cloth_lane_max (rows[i][ALONG_U],
                rows[i][ALONG_V]) + cloth_lane_bend_bound (state,
                i)) * state->inverse_mass[i]);
    bounds->pulled =
        cloth_lane_max (bounds->pulled,
        rows[i][PULLED] * state->inverse_mass[i]);
  }
  if (springs)
    bounds->own = state->own_omega2;
  /* what stands still needs no steps */
  bounds->own = cloth_lane_select (state->diverged, state->own_omega2,
      bounds->own);
  bounds->pulled = cloth_lane_select (state->diverged, cloth_lane_set (0.),
      bounds->pulled);
  /* threads that effects make stiffer pull and stiffen as much more; that is not damped */
  ratio = state->omega2 / cloth_lane_max (state->own_omega2,
      cloth_lane_set (1e-12));
  bounds->pulled = bounds->pulled * ratio + above_zero (bounds->own -
      state->own_omega2) * above_zero (ratio - cloth_lane_set (1.));
  bounds->margin = CLOTH_LANE_MARGIN_STRAINED;
}
