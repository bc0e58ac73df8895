/* Steps whose velocities are found in stages. Damping that grows with stiffness binds an
 * explicit step far below what the stiffness itself allows. Runge and Kutta's method of
 * Legendre polynomials (RKL1: Meyer, Balsara and Aslam 2014) stays stable with s stages
 * for steps (s² + s)/2 times as long. The places wait meanwhile; with one stage it is the
 * step of explicit.c.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/lanes/motion.h"

/* Modes are looked at in so many steps of stiffness. */
#define N_MODES 64
/* At −1 odd polynomials are −1: neither damped nor stable beyond. */
#define LEAST_ARGUMENT (-0.9)
/* Each trial of a step is so much shorter: an eighth of an octave. */
#define SHORTER 0.917004043204671
/* No model asks for a shorter step, s. */
#define LEAST_STEP 1e-12

/* Held particles keep their velocity, against all that pulls. */
static void
hold (ClothLaneState * state)
{
  const ClothBody *body = state->body;
  ClothMask hard = cloth_lane_equal (state->compliance, cloth_lane_set (0.));

  for (guint i = 0; i < body->n_held; i++) {
    guint p = body->held[i].particle;

    for (guint k = 0; k < 3; k++)
      state->v[p][k] = cloth_lane_select (hard & state->held[i],
          state->last_v[p][k], state->v[p][k]);
  }
}

/* Effects and the observer push alike in all stages. */
static void
find_others (ClothLaneState * state)
{
  ClothLane3 *f = state->f;

  state->has_others = state->has_forces || state->has_targets
      || state->pulls.n > 0;
  if (!state->has_others)
    return;
  memset (f, 0, state->n * sizeof *f);
  CLOTH_LANE_NAME (cloth_lane_effect_forces) (state);
  if (state->has_targets)
    CLOTH_LANE_NAME (cloth_lane_targets) (state, state->time, f);
  CLOTH_LANE_NAME (cloth_lane_pulls) (state, state->time, f);
  state->f = state->others;
  state->others = f;
}

/* What a stage wrote in place of the velocities before the last ones becomes the last ones. */
static void
exchange (ClothLaneState * state)
{
  ClothLane3 *v = state->v;

  state->v = state->last_v;
  state->last_v = v;
}

static void
stage (ClothLaneState * state, ClothLane h, gdouble mu, gdouble nu)
{
  ClothLaneStage stage;

  CLOTH_LANE_NAME (cloth_lane_own_forces) (state);
  if (state->has_others)
    for (guint i = 0; i < state->n; i++)
      for (guint k = 0; k < 3; k++)
        state->f[i][k] += state->others[i][k];
  CLOTH_LANE_NAME (cloth_lane_inertia) (state);
  cloth_lane_stage_init (state, h, mu, nu, &stage);
  for (guint i = 0; i < state->n; i++)
    cloth_lane_stage (state, &stage, i, state->f[i]);
}

/* One step of state->dt in state->stages. */
void CLOTH_LANE_NAME (cloth_lane_staged) (ClothLaneState * state)
{
  ClothLane dt = cloth_lane_set (state->dt);
  gdouble s = state->stages;

  find_others (state);
  memcpy (state->before_v, state->v, state->n * sizeof *state->v);
  for (guint j = 1; j <= state->stages; j++) {
    gdouble weight = (2. * j - 1.) / j;
    ClothLane h = state->kick * cloth_lane_set (weight * 2. / (s * s + s));
    gdouble mu = j > 1 ? weight : 1., nu = j > 1 ? (1. - j) / j : 0.;

    if (state->grid_alone)
      CLOTH_LANE_NAME (cloth_lane_grid_stage) (state, h, mu, nu);
    else
      stage (state, h, mu, nu);
    exchange (state);
    hold (state);
  }
  for (guint i = 0; i < state->n; i++)
    for (guint k = 0; k < 3; k++)
      state->x[i][k] += dt * state->v[i][k];
}

/* The Legendre polynomial of degree n at x. */
static gdouble
legendre (guint n, gdouble x)
{
  gdouble last = 1., now = x;

  for (guint j = 2; j <= n; j++) {
    gdouble next = ((2. * j - 1.) * x * now - (j - 1.) * last) / j;

    last = now;
    now = next;
  }
  return now;
}

/* Whether all modes of ω² up to @omega2, damped by @beta ω² in stages and by @c besides, with @pulled 1/s² more that
 * no stage damps, are stable: Jury's criterion on v ← R v − h φ ω² x, x ← x + h v, where R is what the
 * stages leave of v and φ what they let through of a force. */
static gboolean
is_stable (guint stages, gdouble h, gdouble omega2, gdouble beta,
    gdouble pulled, gdouble c)
{
  /* tensions act on modes that nothing else holds, too */
  for (guint i = pulled > 0. ? 0 : 1; i <= N_MODES; i++) {
    gdouble square = omega2 * i / N_MODES, z = h * beta * square;
    gdouble x = 1. - 2. * z / (stages * (stages + 1.));
    gdouble r = legendre (stages, x), phi = z > 1e-9 ? (1. - r) / z : 1.;

    if (x < LEAST_ARGUMENT
        || !(phi * (h * h * (square + pulled) + 2. * h * c) < 2. * (1. + r)))
      return FALSE;
  }
  return TRUE;
}

/* The largest step, at most @longest, that is stable with so many stages in all lanes. */
gdouble
CLOTH_LANE_NAME (cloth_lane_staged_time_step) (const ClothLaneState * state,
    const ClothLaneBounds * bounds, guint stages, gdouble longest)
{
  const gdouble margin = bounds->margin;
  ClothLane pulled = state->pulls.gain * state->pulls.bound;
  ClothLane dragged = state->pulls.damping * state->pulls.bound;

  for (guint l = 0; l < CLOTH_N_LANES; l++) {
    const gdouble own = CLOTH_LANE_AT (&state->own_omega2, l);
    const gdouble now = CLOTH_LANE_AT (&bounds->own, l);
    const gdouble damped = CLOTH_LANE_AT (&state->beta, l) * now;
    const gdouble tension = CLOTH_LANE_AT (&bounds->pulled, l);
    gdouble omega2 = CLOTH_LANE_AT (&state->omega2, l) + (now - own) +
        CLOTH_LANE_AT (&state->targets.gain, l) + CLOTH_LANE_AT (&pulled, l);
    /* velocities that change their sign in each step are ahead twice as large */
    gdouble c = CLOTH_LANE_AT (&state->friction, l) +
        2. * CLOTH_LANE_AT (&state->targets.damping, l) +
        2. * CLOTH_LANE_AT (&dragged, l) -
        CLOTH_LANE_AT (&state->beta, l) * own;

    while (longest > LEAST_STEP
        && !is_stable (stages, longest, omega2 / (margin * margin),
            omega2 > 0. ? damped / omega2 : 0., tension / (margin * margin),
            c / margin))
      longest *= SHORTER;
  }
  return longest;
}
