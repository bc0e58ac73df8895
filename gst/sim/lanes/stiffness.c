/* The matrix of a linearly implicit step, by its products alone. Of a force
 * f = −Σ s ∂E/∂x of strains E and stresses s = k E the stiffness is
 * Σ k ∂E ∂Eᵀ + s ∂²E: the first term is positive, of the second only the positive part is
 * kept, which is that of pulled cloth; what pushes only hastens its own buckling and
 * would cost the conjugate gradients their footing (Baraff and Witkin 1998, section 4;
 * Choi and Ko 2002). Damping has the first term with the full moduli, as the forces have.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/lanes/stiffness.h"

void
CLOTH_LANE_NAME (cloth_lane_stiffness_new) (const ClothLaneState * state,
    ClothLaneStiffness * matrix)
{
  if (state->force_model == CLOTH_FORCE_MASS_SPRING)
    matrix->links = g_aligned_alloc0 (state->body->n_springs + 1,
        sizeof *matrix->links, 64);
  else
    matrix->facets = g_aligned_alloc0 (state->body->n_triangles + 1,
        sizeof *matrix->facets, 64);
  matrix->grip = g_aligned_alloc0 (state->body->n_held + 1,
      sizeof *matrix->grip, 64);
}

void CLOTH_LANE_NAME (cloth_lane_stiffness_clear) (ClothLaneStiffness * matrix)
{
  g_aligned_free (matrix->facets);
  g_aligned_free (matrix->links);
  g_aligned_free (matrix->grip);
}

/* The positive part of the symmetric matrix g[0] g[2]; g[2] g[1]. */
CLOTH_LANE_INLINE void
positive_part (ClothLane g[3])
{
  ClothLane half = cloth_lane_set (0.5), zero = cloth_lane_set (0.);
  ClothLane mean = (g[0] + g[1]) * half, difference = (g[0] - g[1]) * half;
  ClothLane r = cloth_lane_sqrt (difference * difference + g[2] * g[2]);
  ClothLane large = cloth_lane_max (mean + r, zero);
  ClothLane small = cloth_lane_max (mean - r, zero);
  ClothLane share = (large - small) /
      cloth_lane_max (r + r, cloth_lane_set (1e-30));

  g[0] = share * (g[0] - mean + r) + small;
  g[1] = share * (g[1] - mean + r) + small;
  g[2] = share * g[2];
}

/* Takes the edges, the moduli by the sign of the strain and the tension of each. */
void
CLOTH_LANE_NAME (cloth_lane_stiffness_update) (const ClothLaneState * state,
    ClothLaneStiffness * matrix)
{
  ClothLane half = cloth_lane_set (0.5), zero = cloth_lane_set (0.);
  ClothLane moduli[3] = { state->stretch_warp * state->rest_area,
    state->stretch_weft * state->rest_area, state->shear * state->rest_area
  };

  if (matrix->links)
    CLOTH_LANE_NAME (cloth_lane_springs_links) (state, matrix->links);
  for (guint i = 0; matrix->facets && i < state->body->n_triangles; i++) {
    const ClothLaneTriangle *t = &state->triangles[i];
    ClothLaneFacet *facet = &matrix->facets[i];
    const guint32 *p = t->particle;
    ClothLane d[3], m[3], s[3];

    cloth_lane_subtract (state->x[p[1]], state->x[p[0]], facet->e1);
    cloth_lane_subtract (state->x[p[2]], state->x[p[0]], facet->e2);
    d[0] = cloth_lane_dot (facet->e1, facet->e1);
    d[1] = cloth_lane_dot (facet->e2, facet->e2);
    d[2] = cloth_lane_dot (facet->e1, facet->e2);
    cloth_lane_map (t->t, FALSE, d, m);
    cloth_lane_map_rest (state->metric, m);
    for (guint k = 0; k < 2; k++) {
      ClothLane strain = m[k] * half - half;

      facet->k[k] = moduli[k] * cloth_lane_select (cloth_lane_less (strain,
              zero), state->compression_ratio, cloth_lane_set (1.));
      s[k] = facet->k[k] * strain;
    }
    s[2] = moduli[2] * m[2] * cloth_lane_set (2.);
    facet->k[2] = moduli[2] * cloth_lane_set (4.);
    cloth_lane_map_rest_back (state->metric, s);
    cloth_lane_map_back (t->t, FALSE, s, facet->g);
    for (guint k = 0; k < 3; k++) {
      facet->g[k] *= t->area;
      facet->k[k] *= t->area;
    }
    facet->g[2] *= half;
    positive_part (facet->g);
  }
}

/* Full moduli times hβ, of which a triangle has its area's share. */
CLOTH_LANE_INLINE void
damping_moduli (const ClothLaneState * state, const ClothLaneStiffness * matrix,
    ClothLane damping[3])
{
  ClothLane scale = matrix->h * state->beta * state->rest_area;

  damping[0] = scale * state->stretch_warp;
  damping[1] = scale * state->stretch_weft;
  damping[2] = scale * state->shear * cloth_lane_set (4.);
}

CLOTH_LANE_INLINE void
apply_facets (const ClothLaneState * state, const ClothLaneStiffness * matrix,
    guint begin, guint end, gboolean right, gboolean rest_changed,
    const ClothLane3 * d, ClothLane3 * q)
{
  ClothLane half = cloth_lane_set (0.5), h2 = matrix->h2, damping[3];

  damping_moduli (state, matrix, damping);
  for (guint i = begin; i < end; i++) {
    const ClothLaneTriangle *t = &state->triangles[i];
    const ClothLaneFacet *facet = &matrix->facets[i];
    const guint32 *p = t->particle;
    ClothLane d1[3], d2[3], r[3], s[3], g[3];

    cloth_lane_subtract (d[p[1]], d[p[0]], d1);
    cloth_lane_subtract (d[p[2]], d[p[0]], d2);
    r[0] = cloth_lane_dot (facet->e1, d1);
    r[1] = cloth_lane_dot (facet->e2, d2);
    r[2] = (cloth_lane_dot (facet->e1, d2) + cloth_lane_dot (facet->e2, d1)) *
        half;
    cloth_lane_map (t->t, right, r, s);
    if (rest_changed)
      cloth_lane_map_rest (state->metric, s);
    for (guint k = 0; k < 3; k++)
      s[k] *= h2 * facet->k[k] + damping[k] * t->area;
    if (rest_changed)
      cloth_lane_map_rest_back (state->metric, s);
    cloth_lane_map_back (t->t, right, s, g);
    g[2] *= half;
    for (guint k = 0; k < 3; k++) {
      ClothLane q1 = g[0] * facet->e1[k] + g[2] * facet->e2[k] +
          h2 * (facet->g[0] * d1[k] + facet->g[2] * d2[k]);
      ClothLane q2 = g[2] * facet->e1[k] + g[1] * facet->e2[k] +
          h2 * (facet->g[2] * d1[k] + facet->g[1] * d2[k]);

      q[p[0]][k] -= q1 + q2;
      q[p[1]][k] += q1;
      q[p[2]][k] += q2;
    }
  }
}

static void
apply_links (const ClothLaneState * state, const ClothLaneStiffness * matrix,
    const ClothLane3 * d, ClothLane3 * q)
{
  ClothLane h2 = matrix->h2, damping = matrix->h * state->beta;

  for (guint i = 0; i < state->body->n_springs; i++) {
    const ClothLaneLink *link = &matrix->links[i];
    const guint32 *p = state->springs[i].particle;
    ClothLane difference[3], along;

    cloth_lane_subtract (d[p[1]], d[p[0]], difference);
    along = cloth_lane_dot (link->along, difference) *
        (h2 * (link->k - link->g) + damping * link->damped);
    for (guint k = 0; k < 3; k++) {
      ClothLane pull = along * link->along[k] + h2 * link->g * difference[k];

      q[p[0]][k] -= pull;
      q[p[1]][k] += pull;
    }
  }
}

/* What the matrix has on its diagonal beside the cloth's stiffness. */
CLOTH_LANE_INLINE ClothLane
own (const ClothLaneState * state, const ClothLaneStiffness * matrix, guint i)
{
  const ClothLaneTargets *t = &state->targets;
  ClothLane mass = state->mass[i] * matrix->mass;

  if (state->has_targets && !t->matrix)
    mass += state->mass[i] * t->weight[i] *
        (matrix->h2 * t->gain + matrix->h * t->damping);
  return mass;
}

/* The same of springs whose weights are matrices. */
CLOTH_LANE_INLINE ClothLane
drawn (const ClothLaneState * state, const ClothLaneStiffness * matrix, guint i)
{
  const ClothLaneTargets *t = &state->targets;

  return state->mass[i] * (matrix->h2 * t->gain + matrix->h * t->damping);
}

/* q = the matrix times d. */
void
CLOTH_LANE_NAME (cloth_lane_stiffness_apply) (const ClothLaneState * state,
    const ClothLaneStiffness * matrix, const ClothLane3 * d, ClothLane3 * q)
{
  guint right = state->body->n_right, n = state->body->n_triangles;
  ClothLane scale = matrix->h2 + matrix->h * state->beta;

  for (guint i = 0; i < state->n; i++) {
    ClothLane mass = own (state, matrix, i);

    for (guint k = 0; k < 3; k++)
      q[i][k] = mass * d[i][k];
  }
  for (guint i = 0; state->targets.matrix && i < state->n; i++) {
    ClothLane pull[3], mass = drawn (state, matrix, i);

    cloth_lane_symmetric (state->targets.matrix[i], d[i], pull);
    for (guint k = 0; k < 3; k++)
      q[i][k] += mass * pull[k];
  }
  for (guint i = 0; i < state->body->n_held; i++) {
    guint p = state->body->held[i].particle;

    for (guint k = 0; k < 3; k++)
      q[p][k] += matrix->h2 * matrix->grip[i] * d[p][k];
  }
  if (matrix->links) {
    apply_links (state, matrix, d, q);
  } else if (state->rest_changed) {
    apply_facets (state, matrix, 0, n, FALSE, TRUE, d, q);
  } else {
    apply_facets (state, matrix, 0, right, TRUE, FALSE, d, q);
    apply_facets (state, matrix, right, n, FALSE, FALSE, d, q);
  }
  CLOTH_LANE_NAME (cloth_lane_bends) (state, scale * state->bending_warp,
      scale * state->bending_weft, d, q);
  CLOTH_LANE_NAME (cloth_lane_pulls_apply) (state, matrix->h, matrix->h2, d, q);
}

/* Adds s w wᵀ to a symmetric block: xx, yy, zz, yz, xz, xy. */
CLOTH_LANE_INLINE void
add_square (ClothLane block[6], ClothLane s, const ClothLane w[3])
{
  for (guint k = 0; k < 3; k++) {
    block[k] += s * w[k] * w[k];
    block[3 + k] += s * w[(k + 1) % 3] * w[(k + 2) % 3];
  }
}

CLOTH_LANE_INLINE void
add_unit (ClothLane block[6], ClothLane s)
{
  for (guint k = 0; k < 3; k++)
    block[k] += s;
}

static void
add_facets (const ClothLaneState * state, const ClothLaneStiffness * matrix,
    ClothLane (*block)[6])
{
  ClothLane half = cloth_lane_set (0.5), damping[3];

  damping_moduli (state, matrix, damping);
  for (guint i = 0; i < state->body->n_triangles; i++) {
    const ClothLaneTriangle *t = &state->triangles[i];
    const ClothLaneFacet *facet = &matrix->facets[i];
    const ClothLane *g = facet->g;
    /* how each strain changes with each corner */
    ClothLane w[3][3][3];

    for (guint k = 0; k < 3; k++) {
      for (guint corner = 1; corner < 3; corner++) {
        const ClothLane *own_edge = corner == 1 ? facet->e1 : facet->e2;
        const ClothLane *other = corner == 1 ? facet->e2 : facet->e1;
        ClothLane r[3] = { cloth_lane_set (0.), cloth_lane_set (0.),
          other[k] * half
        }, m[3];

        r[corner - 1] = own_edge[k];
        cloth_lane_map (t->t, FALSE, r, m);
        cloth_lane_map_rest (state->metric, m);
        for (guint j = 0; j < 3; j++)
          w[corner][j][k] = m[j];
      }
      for (guint j = 0; j < 3; j++)
        w[0][j][k] = -(w[1][j][k] + w[2][j][k]);
    }
    for (guint corner = 0; corner < 3; corner++) {
      ClothLane *b = block[t->particle[corner]];

      for (guint j = 0; j < 3; j++)
        add_square (b, matrix->h2 * facet->k[j] + damping[j] * t->area,
            w[corner][j]);
      add_unit (b, matrix->h2 * (corner == 1 ? g[0] : corner == 2 ? g[1] :
              g[0] + g[1] + g[2] + g[2]));
    }
  }
}

static void
add_links (const ClothLaneState * state, const ClothLaneStiffness * matrix,
    ClothLane (*block)[6])
{
  for (guint i = 0; i < state->body->n_springs; i++) {
    const ClothLaneLink *link = &matrix->links[i];

    for (guint end = 0; end < 2; end++) {
      ClothLane *b = block[state->springs[i].particle[end]];

      add_square (b, matrix->h2 * (link->k - link->g) +
          matrix->h * state->beta * link->damped, link->along);
      add_unit (b, matrix->h2 * link->g);
    }
  }
}

CLOTH_LANE_INLINE void
invert (ClothLane b[6])
{
  ClothLane c[6], det;

  c[0] = b[1] * b[2] - b[3] * b[3];
  c[1] = b[0] * b[2] - b[4] * b[4];
  c[2] = b[0] * b[1] - b[5] * b[5];
  c[3] = b[4] * b[5] - b[0] * b[3];
  c[4] = b[3] * b[5] - b[1] * b[4];
  c[5] = b[3] * b[4] - b[2] * b[5];
  det = b[0] * c[0] + b[5] * c[5] + b[4] * c[4];
  for (guint k = 0; k < 6; k++)
    b[k] = c[k] / det;
}

/* The inverses of the blocks of the particles themselves: xx, yy, zz, yz, xz, xy. */
void
CLOTH_LANE_NAME (cloth_lane_stiffness_diagonal) (const ClothLaneState * state,
    const ClothLaneStiffness * matrix, ClothLane (*inverse)[6])
{
  ClothLane scale = matrix->h2 + matrix->h * state->beta;

  for (guint i = 0; i < state->n; i++) {
    memset (inverse[i], 0, sizeof inverse[i]);
    add_unit (inverse[i], own (state, matrix, i));
  }
  for (guint i = 0; state->targets.matrix && i < state->n; i++)
    for (guint k = 0; k < 6; k++)
      inverse[i][k] += drawn (state, matrix, i) * state->targets.matrix[i][k];
  for (guint i = 0; i < state->body->n_held; i++)
    add_unit (inverse[state->body->held[i].particle],
        matrix->h2 * matrix->grip[i]);
  if (matrix->links)
    add_links (state, matrix, inverse);
  else
    add_facets (state, matrix, inverse);
  for (guint i = 0; state->bends && i < state->n; i++) {
    const guint32 *first = state->body->first_bend;
    ClothReal warp = 0, weft = 0;

    for (guint m = first[i]; m < first[i + 1]; m++) {
      warp -= state->bends[m].warp;
      weft -= state->bends[m].weft;
    }
    add_unit (inverse[i], scale * (state->bending_warp * warp +
            state->bending_weft * weft));
  }
  for (guint i = 0; state->hinges && i < state->body->n_hinges; i++) {
    const ClothLaneHinge *hinge = &state->hinges[i];
    ClothLane stiffness = scale * (state->bending_warp * hinge->warp +
        state->bending_weft * hinge->weft);

    for (guint corner = 0; corner < 4; corner++)
      add_unit (inverse[hinge->particle[corner]],
          stiffness * (hinge->c[corner] * hinge->c[corner]));
  }
  CLOTH_LANE_NAME (cloth_lane_pulls_diagonal) (state, matrix->h, matrix->h2,
      inverse);
  for (guint i = 0; i < state->n; i++)
    invert (inverse[i]);
}

/* By how much a move changes the stretch of any triangle or spring, at most: Green's
 * strain, that of compressed cloth counted as 0, whose folds come and go. */
ClothLane
CLOTH_LANE_NAME (cloth_lane_stiffness_change) (const ClothLaneState * state,
    const ClothLaneStiffness * matrix, const ClothLane3 * dx)
{
  ClothLane most = cloth_lane_set (0.), half = cloth_lane_set (0.5);
  ClothLane zero = cloth_lane_set (0.);

  for (guint i = 0; matrix->facets && i < state->body->n_triangles; i++) {
    const ClothLaneTriangle *t = &state->triangles[i];
    const ClothLaneFacet *facet = &matrix->facets[i];
    const guint32 *p = t->particle;
    ClothLane strain[2][2];

    for (guint after = 0; after < 2; after++) {
      ClothLane e1[3], e2[3], d[3], m[3];

      for (guint k = 0; k < 3; k++) {
        e1[k] = facet->e1[k];
        e2[k] = facet->e2[k];
        if (after) {
          e1[k] += dx[p[1]][k] - dx[p[0]][k];
          e2[k] += dx[p[2]][k] - dx[p[0]][k];
        }
      }
      d[0] = cloth_lane_dot (e1, e1);
      d[1] = cloth_lane_dot (e2, e2);
      d[2] = cloth_lane_dot (e1, e2);
      cloth_lane_map (t->t, FALSE, d, m);
      cloth_lane_map_rest (state->metric, m);
      for (guint k = 0; k < 2; k++)
        strain[after][k] = cloth_lane_max (m[k] * half - half, zero);
    }
    for (guint k = 0; k < 2; k++)
      most = cloth_lane_max (cloth_lane_abs (strain[1][k] - strain[0][k]),
          most);
  }
  for (guint i = 0; matrix->links && i < state->body->n_springs; i++) {
    const ClothLaneSpring *s = &state->springs[i];
    ClothLane along[3];

    cloth_lane_subtract (dx[s->particle[1]], dx[s->particle[0]], along);
    most = cloth_lane_max (cloth_lane_abs (cloth_lane_dot (along,
                matrix->links[i].along)) / s->length, most);
  }
  return most;
}
