/* Linearly implicit Euler (Baraff and Witkin 1998): with the stiffness K and the damping
 * D = αM + βK at the start of a step of length h,
 *   (M + h D + h² K) Δv = h (f − h K v),  v += Δv,  x += h v.
 * The system is solved by conjugate gradients, each particle's block on the diagonal
 * inverted before (block Jacobi). Lanes converge one by one, and one that has is left
 * alone, so its result does not depend on the others. Held particles keep the change of
 * velocity that takes them to their clamps; the rest is solved in what they leave free.
 * Effects' forces are those at the start of the step.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/lanes/stiffness.h"

/* Residual over that of the start, in the norm of the preconditioner. */
#define TOLERANCE 1e-5
/* Speeds that are nothing, m/s. */
#define NOTHING 1e-9
#define MAX_ITERATIONS 300
/* What a step may change of a stretch, and of a place by the change of its velocity
 * alone, m: half of that is about the error of the step. */
#define MAX_STRAIN 0.01
#define MAX_PLACE 2e-4

struct _ClothLaneImplicit
{
  ClothLaneStiffness matrix;
  ClothLane3 *kv;               /* K v at the start of the step */
  ClothLane3 *dv, *r, *p, *q;
    ClothLane (*inverse)[6];
  ClothMask *hard;              /* of each clamp: lanes where it holds */
  gboolean begun;               /* forces and matrix are those of the present state */
};

ClothLaneImplicit *CLOTH_LANE_NAME (cloth_lane_implicit_new) (const
    ClothLaneState * state)
{
  ClothLaneImplicit * implicit =
      g_aligned_alloc0 (1, sizeof (ClothLaneImplicit), 64);
  ClothLane3 **arrays[] = { &implicit->kv, &implicit->dv, &implicit->r,
    &implicit->p, &implicit->q
  };

  for (guint i = 0; i < G_N_ELEMENTS (arrays); i++)
    *arrays[i] = g_aligned_alloc0 (state->n + 1, sizeof (ClothLane3), 64);
  implicit->inverse = g_aligned_alloc0 (state->n + 1,
      sizeof *implicit->inverse, 64);
  implicit->hard = g_aligned_alloc0 (state->body->n_held + 1,
      sizeof *implicit->hard, 64);
  CLOTH_LANE_NAME (cloth_lane_stiffness_new) (state, &implicit->matrix);
  return implicit;
}

void CLOTH_LANE_NAME (cloth_lane_implicit_free) (ClothLaneImplicit * implicit)
{
  if (!implicit)
    return;
  g_aligned_free (implicit->kv);
  g_aligned_free (implicit->dv);
  g_aligned_free (implicit->r);
  g_aligned_free (implicit->p);
  g_aligned_free (implicit->q);
  g_aligned_free (implicit->inverse);
  g_aligned_free (implicit->hard);
  CLOTH_LANE_NAME (cloth_lane_stiffness_clear) (&implicit->matrix);
  g_aligned_free (implicit);
}

/* Forces, matrix and K v of the state, once a step however often its length is tried. */
static void
begin (ClothLaneState * state)
{
  ClothLaneImplicit *implicit = state->implicit;
  ClothLaneStiffness *matrix = &implicit->matrix;

  if (implicit->begun)
    return;
  CLOTH_LANE_NAME (cloth_lane_forces) (state);
  CLOTH_LANE_NAME (cloth_lane_stiffness_update) (state, matrix);
  matrix->mass = matrix->h = cloth_lane_set (0.);
  matrix->h2 = cloth_lane_set (1.);
  CLOTH_LANE_NAME (cloth_lane_stiffness_apply) (state, matrix,
      (const ClothLane3 *) state->v, implicit->kv);
  implicit->begun = TRUE;
}

/* Where clamps hold, the change of velocity is given. */
static void
hold (ClothLaneState * state)
{
  ClothLaneImplicit *implicit = state->implicit;
  ClothLane per_dt = cloth_lane_set (1. / state->dt);

  memset (implicit->dv, 0, state->n * sizeof *implicit->dv);
  for (guint i = 0; i < state->body->n_held; i++) {
    guint p = state->body->held[i].particle;
    ClothLane place[3];

    memset (&implicit->hard[i], 0, sizeof implicit->hard[i]);
    if (!CLOTH_LANE_NAME (cloth_lane_clamp_grips) (state, i,
            state->time + state->dt, state->x[p], place))
      continue;
    implicit->hard[i] =
        cloth_lane_equal (state->compliance, cloth_lane_set (0.));
    for (guint k = 0; k < 3; k++)
      implicit->dv[p][k] = cloth_lane_select (implicit->hard[i],
          (place[k] - state->x[p][k]) * per_dt - state->v[p][k],
          implicit->dv[p][k]);
  }
}

/* Nothing of what is held. */
static void
filter (const ClothLaneState * state, ClothLane3 * a)
{
  for (guint i = 0; i < state->body->n_held; i++) {
    guint p = state->body->held[i].particle;

    for (guint k = 0; k < 3; k++)
      a[p][k] = cloth_lane_select (state->implicit->hard[i],
          cloth_lane_set (0.), a[p][k]);
  }
}

CLOTH_LANE_INLINE void
precondition (const ClothLane b[6], const ClothLane r[3], ClothLane z[3])
{
  z[0] = b[0] * r[0] + b[5] * r[1] + b[4] * r[2];
  z[1] = b[5] * r[0] + b[1] * r[1] + b[3] * r[2];
  z[2] = b[4] * r[0] + b[3] * r[1] + b[2] * r[2];
}

/* r · P⁻¹ r, and p = P⁻¹ r + β p. */
static ClothLane
direct (ClothLaneState * state, ClothLane before, gboolean first)
{
  ClothLaneImplicit *implicit = state->implicit;
  ClothLane rho = cloth_lane_set (0.), beta;

  for (guint i = 0; i < state->n; i++) {
    ClothLane z[3];

    precondition (implicit->inverse[i], implicit->r[i], z);
    rho += cloth_lane_dot (implicit->r[i], z);
  }
  beta = first ? cloth_lane_set (0.) : rho / before;
  for (guint i = 0; i < state->n; i++) {
    ClothLane z[3];

    precondition (implicit->inverse[i], implicit->r[i], z);
    for (guint k = 0; k < 3; k++)
      implicit->p[i][k] = first ? z[k] : z[k] + beta * implicit->p[i][k];
  }
  return rho;
}

/* Lanes where it did not converge. */
static ClothMask
conjugate_gradients (ClothLaneState * state)
{
  ClothLaneImplicit *implicit = state->implicit;
  ClothLane zero = cloth_lane_set (0.), total = zero, rho, bound;
  ClothMask active;

  for (guint i = 0; i < state->n; i++)
    total += state->mass[i];
  rho = direct (state, zero, TRUE);
  bound = cloth_lane_max (rho * cloth_lane_set (TOLERANCE * TOLERANCE),
      total * cloth_lane_set (NOTHING * NOTHING));
  active = ~cloth_lane_less (rho, bound);
  for (guint n = 0; n < MAX_ITERATIONS && cloth_lane_any (active); n++) {
    ClothLane along = zero, step;

    CLOTH_LANE_NAME (cloth_lane_stiffness_apply) (state, &implicit->matrix,
        (const ClothLane3 *) implicit->p, implicit->q);
    filter (state, implicit->q);
    for (guint i = 0; i < state->n; i++)
      along += cloth_lane_dot (implicit->p[i], implicit->q[i]);
    step = rho / along;
    for (guint i = 0; i < state->n; i++) {
      for (guint k = 0; k < 3; k++) {
        implicit->dv[i][k] = cloth_lane_select (active,
            implicit->dv[i][k] + step * implicit->p[i][k], implicit->dv[i][k]);
        implicit->r[i][k] -= step * implicit->q[i][k];
      }
    }
    rho = direct (state, rho, FALSE);
    active &= ~cloth_lane_less (rho, bound);
  }
  return active;
}

/* Solves a step of state->dt without taking it. Returns by how much it is too long, at
 * most 1 when it is not: of lanes that have not diverged. */
gdouble CLOTH_LANE_NAME (cloth_lane_implicit_solve) (ClothLaneState * state)
{
  ClothLaneImplicit *implicit = state->implicit;
  ClothLaneStiffness *matrix = &implicit->matrix;
  ClothLane h = cloth_lane_set (state->dt), h2 = h * h, most, furthest;
  ClothMask failed;
  gdouble worst = 0.;

  begin (state);
  matrix->h = h;
  matrix->h2 = h2;
  matrix->mass = cloth_lane_set (1.) + state->alpha * h;
  hold (state);
  CLOTH_LANE_NAME (cloth_lane_stiffness_diagonal) (state, matrix,
      implicit->inverse);
  CLOTH_LANE_NAME (cloth_lane_stiffness_apply) (state, matrix,
      (const ClothLane3 *) implicit->dv, implicit->r);
  for (guint i = 0; i < state->n; i++)
    for (guint k = 0; k < 3; k++)
      implicit->r[i][k] = h * (state->f[i][k] + state->mass[i] *
          (state->gravity[k] - state->alpha * state->v[i][k])) -
          h2 * implicit->kv[i][k] - implicit->r[i][k];
  filter (state, implicit->r);
  failed = conjugate_gradients (state);
  /* the way of the step */
  furthest = cloth_lane_set (0.);
  for (guint i = 0; i < state->n; i++) {
    furthest = cloth_lane_max (cloth_lane_dot (implicit->dv[i],
            implicit->dv[i]), furthest);
    for (guint k = 0; k < 3; k++)
      implicit->q[i][k] = h * (state->v[i][k] + implicit->dv[i][k]);
  }
  most = CLOTH_LANE_NAME (cloth_lane_stiffness_change) (state, matrix,
      (const ClothLane3 *) implicit->q);
  for (guint l = 0; l < CLOTH_N_LANES; l++) {
    gdouble bad = MAX (CLOTH_LANE_AT (&most, l) / MAX_STRAIN,
        sqrt (CLOTH_LANE_AT (&furthest, l)) * state->dt / MAX_PLACE);

    if (CLOTH_LANE_AT (&state->diverged, l))
      continue;
    if (CLOTH_LANE_AT (&failed, l) || !isfinite (bad))
      bad = INFINITY;
    worst = MAX (worst, bad);
  }
  return worst;
}

/* Takes the step that was solved. */
void CLOTH_LANE_NAME (cloth_lane_implicit_take) (ClothLaneState * state)
{
  ClothLaneImplicit *implicit = state->implicit;
  ClothLane h = cloth_lane_set (state->dt);

  for (guint i = 0; i < state->n; i++) {
    for (guint k = 0; k < 3; k++) {
      state->v[i][k] += implicit->dv[i][k];
      state->x[i][k] += h * state->v[i][k];
      state->f[i][k] = cloth_lane_set (0.);
    }
  }
  implicit->begun = FALSE;
}
