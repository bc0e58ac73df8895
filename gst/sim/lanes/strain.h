/* Strains of triangles from products of their edges, and the forces of stresses; stretch of springs.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/sim/lanes/state.h"

/* Products of the edges e1, e2 of one triangle and half their rates. */
typedef struct
{
  ClothLane e1[3], e2[3];
  ClothLane d[3], r[3];
} ClothLaneEdges;

CLOTH_LANE_INLINE void
cloth_lane_measure (const ClothLaneState * state, const ClothLaneTriangle * t,
    ClothLaneEdges * edges)
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
cloth_lane_map (const ClothReal t[9], gboolean right, const ClothLane d[3], ClothLane m[3])
{
  for (guint k = 0; k < 3; k++)
    m[k] = right ? d[k] * t[4 * k] :
        d[0] * t[3 * k] + d[1] * t[3 * k + 1] + d[2] * t[3 * k + 2];
}

CLOTH_LANE_INLINE void
cloth_lane_map_back (const ClothReal t[9], gboolean right, const ClothLane s[3],
    ClothLane m[3])
{
  for (guint k = 0; k < 3; k++)
    m[k] = right ? s[k] * t[4 * k] :
        s[0] * t[k] + s[1] * t[3 + k] + s[2] * t[6 + k];
}

CLOTH_LANE_INLINE void
cloth_lane_map_rest (const ClothLane metric[9], ClothLane m[3])
{
  ClothLane d[3] = { m[0], m[1], m[2] };

  for (guint k = 0; k < 3; k++)
    m[k] = d[0] * metric[3 * k] + d[1] * metric[3 * k + 1] +
        d[2] * metric[3 * k + 2];
}

CLOTH_LANE_INLINE void
cloth_lane_map_rest_back (const ClothLane metric[9], ClothLane s[3])
{
  ClothLane d[3] = { s[0], s[1], s[2] };

  for (guint k = 0; k < 3; k++)
    s[k] = d[0] * metric[k] + d[1] * metric[3 + k] + d[2] * metric[6 + k];
}

/* Adds the forces of the stresses s (warp, weft, shear; N/m) to the corners. */
CLOTH_LANE_INLINE void
cloth_lane_push_edges (ClothLaneState * state, const ClothLaneTriangle * t,
    const ClothLaneEdges * edges, gboolean right, gboolean rest_changed,
    ClothLane s[3])
{
  ClothLane3 *f = state->f;
  const guint32 *p = t->particle;
  ClothLane g[3];

  if (rest_changed)
    cloth_lane_map_rest_back (state->metric, s);
  cloth_lane_map_back (t->t, right, s, g);
  for (guint k = 0; k < 3; k++)
    g[k] *= t->area;
  g[2] *= cloth_lane_set (0.5);
  for (guint k = 0; k < 3; k++) {
    ClothLane f1 = g[0] * edges->e1[k] + g[2] * edges->e2[k];
    ClothLane f2 = g[2] * edges->e1[k] + g[1] * edges->e2[k];

    f[p[0]][k] += f1 + f2;
    f[p[1]][k] -= f1;
    f[p[2]][k] -= f2;
  }
}

/* Green's strains of a triangle along warp and weft. */
typedef struct
{
  ClothLaneEdges edges;
  ClothLane warp, weft;
} ClothLaneStrain;

CLOTH_LANE_INLINE void
cloth_lane_strain (const ClothLaneState * state, const ClothLaneTriangle * t,
    ClothLaneStrain * strain)
{
  ClothLane half = cloth_lane_set (0.5), m[3];

  cloth_lane_measure (state, t, &strain->edges);
  cloth_lane_map (t->t, FALSE, strain->edges.d, m);
  cloth_lane_map_rest (state->metric, m);
  strain->warp = m[0] * half - half;
  strain->weft = m[1] * half - half;
}

/* Adds the forces of tensions along warp and weft, N/m. */
CLOTH_LANE_INLINE void
cloth_lane_pull (ClothLaneState * state, const ClothLaneTriangle * t,
    const ClothLaneStrain * strain, ClothLane warp, ClothLane weft)
{
  ClothLane s[3] = { warp * state->rest_area, weft * state->rest_area,
    cloth_lane_set (0.)
  };

  cloth_lane_push_edges (state, t, &strain->edges, FALSE, TRUE, s);
}

/* What the effects' change of the rest shape does to the length of a spring. */
CLOTH_LANE_INLINE ClothLane
cloth_lane_spring_rest (const ClothLaneState * state, const ClothLaneSpring * s)
{
  const ClothLane *r = state->rest;
  ClothLane det = r[0] * r[3] - r[1] * r[2];
  ClothLane u = (r[3] * s->u - r[1] * s->v) / det;
  ClothLane v = (r[0] * s->v - r[2] * s->u) / det;
  ClothReal square = s->u * s->u + s->v * s->v;

  return cloth_lane_sqrt ((u * u + v * v) / square) * s->length;
}

CLOTH_LANE_INLINE ClothLane
cloth_lane_spring_stiffness (const ClothLaneState * state, const ClothLaneSpring * s)
{
  return state->stretch_warp * s->warp + state->stretch_weft * s->weft +
      state->shear * s->shear;
}

/* By how much a spring is longer than at rest, m; the way from one end to the other, and one over its length. */
CLOTH_LANE_INLINE ClothLane
cloth_lane_spring_stretch (const ClothLaneState * state, const ClothLaneSpring * s,
    gboolean rest_changed, ClothLane along[3], ClothLane * inverse)
{
  ClothLane length;

  cloth_lane_subtract (state->x[s->particle[1]], state->x[s->particle[0]],
      along);
  length = cloth_lane_sqrt (cloth_lane_dot (along, along));
  *inverse = cloth_lane_set (1.) /
      cloth_lane_max (length, cloth_lane_set (1e-12));
  return rest_changed ? length - cloth_lane_spring_rest (state,
      s) : length - s->length;
}
