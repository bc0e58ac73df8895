/* Linearly implicit steps of two orders. From places x and velocities v a step of length h
 * goes to
 *   x₊ = x + a Δx + γ v₊,  v₊ = v + a Δv + γ M⁻¹ f (x₊, v₊),
 * where Δx and Δv are what the step before has changed, 1/ω times as long. a = 0 is implicit
 * Euler, a = ω²/(1 + 2ω) the second backward difference formula, BDF2 (Hairer, Nørsett and
 * Wanner, Solving Ordinary Differential Equations I, section III.5); γ = h (1 − a/ω) makes
 * every a between them of first order at least. Forces are taken at a place x* and velocity v*, and with the
 * stiffness K and the damping D = αM + βK there one linear system gives w = v₊ − v* (Baraff
 * and Witkin 1998; Choi and Ko 2002):
 *   (M + γ D + γ² K) w = M (v + a Δv − v*) + γ (f (x*, v*) − K (x + a Δx + γ v* − x*)).
 * Euler takes them where the cloth is, x and v, BDF2 where it should come to, x + ω Δx and
 * v + ω Δv: so forces whose change K does not know, those of effects among them, are of
 * second order too. A lane takes BDF2 where its motion is smooth, Euler where it is not, and
 * something between these between these: to jump would be no small change for a small
 * change of a parameter.
 *
 * The system is solved by conjugate gradients that start from v₊ = v + ω Δv, each
 * particle's block on the diagonal inverted before (block Jacobi). Lanes converge one by
 * one, and one that has is left alone, so its result does not depend on the others. Held
 * particles keep the velocity that takes them to their clamps; the rest is solved in what
 * they leave free.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/lanes/stiffness.h"

/* Residual over that of w = 0, in the norm of the preconditioner. */
#define TOLERANCE 1e-3
/* Speeds that are nothing, m/s. */
#define NOTHING 1e-9
#define MAX_ITERATIONS 300
/* What a step may change of a stretch, and by how much a place may be wrong, m. */
#define MAX_STRAIN 0.01
#define MAX_PLACE 3e-5
/* What is about a step's error, over its length and its change of velocity, or what of that
 * was not foreseen. */
#define EULER_ERROR 0.5
#define BDF2_ERROR (2. / 9.)
/* Nothing is predicted from a step so many times shorter. */
#define MAX_GROWTH 2.1

struct _ClothLaneImplicit
{
  ClothLaneStiffness matrix;
  ClothLane3 *w, *r, *p, *q;
    ClothLane (*inverse)[6];
  ClothMask *hard;              /* of each clamp: lanes where it holds */
  ClothLane3 *x, *v;            /* x* and v* */
  ClothLane3 *last_x, *last_v;  /* before the last step */
  gdouble last_dt;
  ClothMask known;              /* lanes where there was a last step */
  ClothLane smooth;             /* 1: BDF2, 0: Euler */
  ClothLane next_smooth;        /* what the running step makes of that */
  /* of the running step; ω is 0 in lanes without a last step, ahead ω times smooth */
  ClothLane omega, ahead, gamma, a;
};

ClothLaneImplicit *CLOTH_LANE_NAME (cloth_lane_implicit_new) (const
    ClothLaneState * state)
{
  ClothLaneImplicit * implicit =
      g_aligned_alloc0 (1, sizeof (ClothLaneImplicit), 64);
  ClothLane3 **arrays[] = { &implicit->w, &implicit->r, &implicit->p,
    &implicit->q, &implicit->x, &implicit->v, &implicit->last_x,
    &implicit->last_v
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
  g_aligned_free (implicit->w);
  g_aligned_free (implicit->r);
  g_aligned_free (implicit->p);
  g_aligned_free (implicit->q);
  g_aligned_free (implicit->x);
  g_aligned_free (implicit->v);
  g_aligned_free (implicit->last_x);
  g_aligned_free (implicit->last_v);
  g_aligned_free (implicit->inverse);
  g_aligned_free (implicit->hard);
  CLOTH_LANE_NAME (cloth_lane_stiffness_clear) (&implicit->matrix);
  g_aligned_free (implicit);
}

/* Forgets the last step of lanes whose state was set from outside. */
void CLOTH_LANE_NAME (cloth_lane_implicit_reset) (ClothLaneState * state,
    ClothMask lanes)
{
  state->implicit->known &= ~lanes;
}

/* The formula that each lane takes for a step of this length. */
static void
choose_order (ClothLaneState * state)
{
  ClothLaneImplicit *implicit = state->implicit;
  ClothLane one = cloth_lane_set (1.), h = cloth_lane_set (state->dt);
  gdouble omega = state->dt / implicit->last_dt;

  /* the first step of all has no ω either */
  implicit->omega = cloth_lane_select (implicit->known,
      cloth_lane_set (omega < MAX_GROWTH ? omega : 0.), cloth_lane_set (0.));
  implicit->ahead = implicit->omega * implicit->smooth;
  implicit->a = implicit->ahead * implicit->omega /
      (one + implicit->omega + implicit->omega);
  implicit->gamma = h * (one - implicit->ahead /
      (one + implicit->omega + implicit->omega));
  state->reach = implicit->gamma;
  implicit->matrix.h = implicit->gamma;
  implicit->matrix.h2 = implicit->gamma * implicit->gamma;
  implicit->matrix.mass = cloth_lane_set (1.) + state->alpha * implicit->gamma;
}

static void
swap (ClothLaneState * state)
{
  ClothLaneImplicit *implicit = state->implicit;
  ClothLane3 *x = state->x, *v = state->v;

  state->x = implicit->x;
  state->v = implicit->v;
  implicit->x = x;
  implicit->v = v;
}

/* Forces into r, and the matrix, at x* and v*. */
static void
linearise (ClothLaneState * state)
{
  ClothLaneImplicit *implicit = state->implicit;
  ClothLane ahead = implicit->ahead;

  for (guint i = 0; i < state->n; i++) {
    for (guint k = 0; k < 3; k++) {
      ClothLane x = state->x[i][k], v = state->v[i][k];

      implicit->x[i][k] = x + ahead * (x - implicit->last_x[i][k]);
      implicit->v[i][k] = v + ahead * (v - implicit->last_v[i][k]);
    }
  }
  swap (state);
  CLOTH_LANE_NAME (cloth_lane_forces) (state);
  CLOTH_LANE_NAME (cloth_lane_stiffness_update) (state, &implicit->matrix);
  if (state->has_targets)
    CLOTH_LANE_NAME (cloth_lane_targets) (state, state->time + state->dt,
        state->f);
  CLOTH_LANE_NAME (cloth_lane_pulls) (state, state->time + state->dt, state->f);
  CLOTH_LANE_NAME (cloth_lane_pulls_update) (state, state->time + state->dt);
  for (guint i = 0; i < state->n; i++)
    for (guint k = 0; k < 3; k++)
      implicit->r[i][k] = state->f[i][k] + state->mass[i] *
          (state->gravity[k] - state->alpha * state->v[i][k]);
  swap (state);
}

/* Where clamps hold, the velocity is given; where they give, they are springs. */
static void
hold (ClothLaneState * state)
{
  ClothLaneImplicit *implicit = state->implicit;
  ClothLane zero = cloth_lane_set (0.), one = cloth_lane_set (1.);
  ClothMask hard = cloth_lane_equal (state->compliance, zero);

  memset (implicit->w, 0, state->n * sizeof *implicit->w);
  for (guint i = 0; i < state->body->n_held; i++) {
    guint p = state->body->held[i].particle;
    const ClothLane *x = state->x[p];
    ClothLane place[3];

    memset (&implicit->hard[i], 0, sizeof implicit->hard[i]);
    implicit->matrix.grip[i] = zero;
    if (!CLOTH_LANE_NAME (cloth_lane_clamp_grips) (state, i,
            state->time + state->dt, x, place))
      continue;
    implicit->hard[i] = hard;
    implicit->matrix.grip[i] =
        cloth_lane_select (hard, zero, one / state->compliance);
    for (guint k = 0; k < 3; k++) {
      ClothLane come = x[k] + implicit->a * (x[k] - implicit->last_x[p][k]);

      implicit->w[p][k] = cloth_lane_select (hard, (place[k] - come) /
          implicit->gamma - implicit->v[p][k], zero);
      implicit->r[p][k] += implicit->matrix.grip[i] *
          (place[k] - implicit->x[p][k]);
    }
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

/* q = P⁻¹ r; returns r · q. */
static ClothLane
residual (ClothLaneState * state)
{
  ClothLaneImplicit *implicit = state->implicit;
  ClothLane rho = cloth_lane_set (0.);

  for (guint i = 0; i < state->n; i++) {
    cloth_lane_symmetric (implicit->inverse[i], implicit->r[i], implicit->q[i]);
    rho += cloth_lane_dot (implicit->r[i], implicit->q[i]);
  }
  return rho;
}

/* r −= the matrix times a, which is put into q. */
static void
subtract_product (ClothLaneState * state, const ClothLane3 * a)
{
  ClothLaneImplicit *implicit = state->implicit;

  CLOTH_LANE_NAME (cloth_lane_stiffness_apply) (state, &implicit->matrix, a,
      implicit->q);
  filter (state, implicit->q);
  for (guint i = 0; i < state->n; i++)
    cloth_lane_subtract (implicit->r[i], implicit->q[i], implicit->r[i]);
}

/* The right side of the system; w is that of what is held alone until it is solved. */
static void
load (ClothLaneState * state)
{
  ClothLaneImplicit *implicit = state->implicit;
  ClothLaneStiffness still = implicit->matrix;
  ClothLane gamma = implicit->gamma, a = implicit->a;

  for (guint i = 0; i < state->n; i++) {
    for (guint k = 0; k < 3; k++) {
      ClothLane x = state->x[i][k];

      implicit->p[i][k] = x + a * (x - implicit->last_x[i][k]) +
          gamma * implicit->v[i][k] - implicit->x[i][k];
    }
  }
  still.mass = still.h = cloth_lane_set (0.);
  still.h2 = cloth_lane_set (1.);
  CLOTH_LANE_NAME (cloth_lane_stiffness_apply) (state, &still,
      (const ClothLane3 *) implicit->p, implicit->q);
  for (guint i = 0; i < state->n; i++) {
    for (guint k = 0; k < 3; k++) {
      ClothLane v = state->v[i][k];

      implicit->r[i][k] = gamma * (implicit->r[i][k] - implicit->q[i][k]) +
          state->mass[i] * (v + a * (v - implicit->last_v[i][k]) -
          implicit->v[i][k]);
    }
  }
  filter (state, implicit->r);
}

/* Lanes where it did not converge. */
static ClothMask
conjugate_gradients (ClothLaneState * state)
{
  ClothLaneImplicit *implicit = state->implicit;
  ClothLane zero = cloth_lane_set (0.), total = zero, rho, beta, bound;
  ClothMask active;

  for (guint i = 0; i < state->n; i++)
    total += state->mass[i];
  subtract_product (state, (const ClothLane3 *) implicit->w);
  bound = cloth_lane_max (residual (state) * cloth_lane_set (TOLERANCE *
          TOLERANCE), total * cloth_lane_set (NOTHING * NOTHING));
  for (guint i = 0; i < state->n; i++)
    for (guint k = 0; k < 3; k++)
      implicit->p[i][k] = (implicit->omega - implicit->ahead) *
          (state->v[i][k] - implicit->last_v[i][k]);
  filter (state, implicit->p);
  for (guint i = 0; i < state->n; i++)
    for (guint k = 0; k < 3; k++)
      implicit->w[i][k] += implicit->p[i][k];
  subtract_product (state, (const ClothLane3 *) implicit->p);
  rho = residual (state);
  memcpy (implicit->p, implicit->q, state->n * sizeof *implicit->p);
  active = ~cloth_lane_less (rho, bound) & ~state->diverged;
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
        implicit->w[i][k] = cloth_lane_select (active,
            implicit->w[i][k] + step * implicit->p[i][k], implicit->w[i][k]);
        implicit->r[i][k] -= step * implicit->q[i][k];
      }
    }
    beta = cloth_lane_set (1.) / rho;
    rho = residual (state);
    beta *= rho;
    for (guint i = 0; i < state->n; i++)
      for (guint k = 0; k < 3; k++)
        implicit->p[i][k] = implicit->q[i][k] + beta * implicit->p[i][k];
    active &= ~cloth_lane_less (rho, bound);
  }
  return active;
}

/* By how much the step is too long in each lane, and how much the next one may count on
 * this one: all when a quarter of its change of velocity was foreseen, and nothing when
 * nothing was. */
static ClothLane
judge (ClothLaneState * state)
{
  ClothLaneImplicit *implicit = state->implicit;
  ClothLane zero = cloth_lane_set (0.), changed = zero, unforeseen = zero;
  ClothLane one = cloth_lane_set (1.), four = cloth_lane_set (4.), share, error;

  for (guint i = 0; i < state->n; i++)
    for (guint k = 0; k < 3; k++)
      implicit->p[i][k] = implicit->v[i][k] + implicit->w[i][k] -
          state->v[i][k];
  filter (state, implicit->p);
  for (guint i = 0; i < state->n; i++) {
    ClothLane rest[3];

    changed = cloth_lane_max (cloth_lane_dot (implicit->p[i],
            implicit->p[i]), changed);
    for (guint k = 0; k < 3; k++)
      rest[k] = implicit->p[i][k] - implicit->omega *
          (state->v[i][k] - implicit->last_v[i][k]);
    unforeseen = cloth_lane_max (cloth_lane_dot (rest, rest), unforeseen);
  }
  changed = cloth_lane_sqrt (changed);
  unforeseen = cloth_lane_sqrt (unforeseen);
  share = unforeseen / cloth_lane_max (changed, cloth_lane_set (NOTHING));
  implicit->next_smooth = cloth_lane_select (cloth_lane_less (zero,
          implicit->omega), cloth_lane_max (cloth_lane_min (four - four * share,
              one), zero), zero);
  error = (unforeseen * implicit->smooth * cloth_lane_set (BDF2_ERROR) +
      changed * (one - implicit->smooth) * cloth_lane_set (EULER_ERROR)) *
      cloth_lane_set (state->dt / MAX_PLACE);
  for (guint i = 0; i < state->n; i++) {
    for (guint k = 0; k < 3; k++) {
      ClothLane x = state->x[i][k];

      implicit->q[i][k] = x + implicit->a * (x - implicit->last_x[i][k]) +
          implicit->gamma * (implicit->v[i][k] + implicit->w[i][k]) -
          implicit->x[i][k];
    }
  }
  return cloth_lane_max (CLOTH_LANE_NAME (cloth_lane_stiffness_change) (state,
          &implicit->matrix, (const ClothLane3 *) implicit->q) *
      cloth_lane_set (1. / MAX_STRAIN), error);
}

/* Solves a step of state->dt without taking it. Returns by how much it is too long, at
 * most 1 when it is not: of lanes that have not diverged. */
gdouble CLOTH_LANE_NAME (cloth_lane_implicit_solve) (ClothLaneState * state)
{
  ClothLaneImplicit *implicit = state->implicit;
  ClothMask failed;
  ClothLane bad;
  gdouble worst = 0.;

  choose_order (state);
  linearise (state);
  hold (state);
  load (state);
  CLOTH_LANE_NAME (cloth_lane_stiffness_diagonal) (state, &implicit->matrix,
      implicit->inverse);
  failed = conjugate_gradients (state);
  bad = judge (state);
  for (guint l = 0; l < CLOTH_N_LANES; l++) {
    gdouble one = CLOTH_LANE_AT (&bad, l);

    if (CLOTH_LANE_AT (&state->diverged, l))
      continue;
    if (CLOTH_LANE_AT (&failed, l) || !isfinite (one))
      one = INFINITY;
    worst = MAX (worst, one);
  }
  return worst;
}

/* Takes the step that was solved. */
void CLOTH_LANE_NAME (cloth_lane_implicit_take) (ClothLaneState * state)
{
  ClothLaneImplicit *implicit = state->implicit;

  for (guint i = 0; i < state->n; i++) {
    for (guint k = 0; k < 3; k++) {
      ClothLane x = state->x[i][k], v = state->v[i][k];

      state->v[i][k] = implicit->v[i][k] + implicit->w[i][k];
      state->x[i][k] = x + implicit->a * (x - implicit->last_x[i][k]) +
          implicit->gamma * state->v[i][k];
      implicit->last_x[i][k] = x;
      implicit->last_v[i][k] = v;
    }
  }
  implicit->smooth = implicit->next_smooth;
  implicit->known = cloth_lane_equal (state->alpha, state->alpha);
  implicit->last_dt = state->dt;
}
