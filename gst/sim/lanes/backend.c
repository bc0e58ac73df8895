/* A group of lanes: its memory, its models and its clock.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/lanes/backend.h"

#include "gst/sim/lanes/state.h"

/* No cloth is as fast as this, m/s. */
#define MAX_SPEED 1000.
/* A pull that bounds nothing still has a logarithm. */
#define LEAST_BOUND 1e-6

static gpointer
lanes_new (gsize n, gsize size)
{
  return g_aligned_alloc0 (n + 1, size, 64);
}

static void
load_rest (ClothLaneState * state, const ClothBody * body)
{
  state->triangles = g_new0 (ClothLaneTriangle, body->n_triangles + 1);
  for (guint i = 0; i < body->n_triangles; i++) {
    const ClothBodyTriangle *from = &body->triangles[i];
    const gdouble *g = from->g;
    const gdouble t[9] = {
      g[0] * g[0], g[2] * g[2], 2. * g[0] * g[2],
      g[1] * g[1], g[3] * g[3], 2. * g[1] * g[3],
      g[0] * g[1], g[2] * g[3], g[0] * g[3] + g[1] * g[2]
    };
    ClothLaneTriangle *to = &state->triangles[i];

    memcpy (to->particle, from->particle, sizeof to->particle);
    to->area = (ClothReal) from->area;
    for (guint k = 0; k < 9; k++)
      to->t[k] = (ClothReal) t[k];
  }
  if (body->bends) {
    state->bends = g_new (ClothLaneBend, body->n_bends + 1);
    for (guint i = 0; i < body->n_bends; i++)
      state->bends[i] = (ClothLaneBend) {
      body->bends[i].particle, (ClothReal) body->bends[i].warp,
          (ClothReal) body->bends[i].weft};
    return;
  }
  state->hinges = g_new0 (ClothLaneHinge, body->n_hinges + 1);
  for (guint i = 0; i < body->n_hinges; i++) {
    const ClothBodyHinge *from = &body->hinges[i];
    ClothLaneHinge *to = &state->hinges[i];

    memcpy (to->particle, from->particle, sizeof to->particle);
    for (guint k = 0; k < 4; k++)
      to->c[k] = (ClothReal) from->c[k];
    to->warp = (ClothReal) from->warp;
    to->weft = (ClothReal) from->weft;
  }
}

static void
load_springs (ClothLaneState * state, const ClothBody * body)
{
  state->springs = g_new0 (ClothLaneSpring, body->n_springs + 1);
  for (guint i = 0; i < body->n_springs; i++) {
    const ClothBodySpring *from = &body->springs[i];

    state->springs[i] = (ClothLaneSpring) {
      {
    from->particle[0], from->particle[1]}, (ClothReal) from->u,
          (ClothReal) from->v, (ClothReal) hypot (from->u, from->v),
          (ClothReal) from->warp, (ClothReal) from->weft,
          (ClothReal) from->shear};
  }
}

static void
load_models (ClothLaneState * state, const ClothModel * const *models)
{
  const struct
  {
    ClothLane *lane;
    gsize offset;
  } keys[] = {
    {&state->density, G_STRUCT_OFFSET (ClothModel, areal_density)},
    {&state->stretch_warp, G_STRUCT_OFFSET (ClothModel, stretch_warp)},
    {&state->stretch_weft, G_STRUCT_OFFSET (ClothModel, stretch_weft)},
    {&state->shear, G_STRUCT_OFFSET (ClothModel, shear)},
    {&state->bending_warp, G_STRUCT_OFFSET (ClothModel, bending_warp)},
    {&state->bending_weft, G_STRUCT_OFFSET (ClothModel, bending_weft)},
    {&state->alpha, G_STRUCT_OFFSET (ClothModel, damping_mass)},
    {&state->beta, G_STRUCT_OFFSET (ClothModel, damping_stiffness)},
    {&state->compression_ratio, G_STRUCT_OFFSET (ClothModel,
            compression_ratio)},
    {&state->air_density, G_STRUCT_OFFSET (ClothModel, air_density)},
  };

  for (guint l = 0; l < CLOTH_N_LANES; l++)
    for (guint k = 0; k < G_N_ELEMENTS (keys); k++)
      CLOTH_LANE_AT (keys[k].lane, l) = (ClothReal)
          G_STRUCT_MEMBER (gdouble, models[l], keys[k].offset);
  for (guint k = 0; k < 3; k++)
    state->gravity[k] = cloth_lane_set (state->body->gravity[k]);
  state->rest[0] = state->rest[3] = cloth_lane_set (1.);
  for (guint i = 0; i < state->n; i++)
    state->mass[i] = state->density * (ClothReal) state->body->area[i];
}

static const gdouble *
find_values (const ClothModel * model, const ClothEffect * effect)
{
  for (guint i = 0; i < model->effects->len; i++) {
    const ClothModelEffect *e =
        &g_array_index (model->effects, ClothModelEffect, i);

    if (e->effect == effect)
      return e->values;
  }
  return NULL;
}

/* Adds an effect if any of the models has it. */
static void
load_effect (ClothLaneState * state, const ClothModel * const *models,
    const ClothLanePart * part)
{
  ClothLaneEffect *effect = &state->effects[state->n_effects];
  const ClothLaneHooks *hooks = part->hooks;
  gboolean there = FALSE;

  for (guint l = 0; l < CLOTH_N_LANES; l++) {
    const gdouble *values = find_values (models[l], part->effect);

    there |= values != NULL;
    for (guint k = 0; k < part->effect->n_parameters; k++) {
      const ClothEffectParameter *p = &part->effect->parameters[k];

      CLOTH_LANE_AT (&effect->p[k], l) =
          (ClothReal) ((values ? values[k] : p->null_value) -
          (p->moment ? state->body->epoch : 0.));
    }
  }
  if (!there)
    return;
  effect->hooks = hooks;
  effect->state = lanes_new (1, hooks->state_size * state->n +
      hooks->triangle_size * state->body->n_triangles +
      hooks->hinge_size * state->body->n_hinges + hooks->fixed_size);
  state->has_forces |= hooks->force != NULL;
  state->has_inertia |= hooks->inertia != NULL;
  state->n_effects++;
}

static void
load_effects (ClothLaneState * state, const ClothModel * const *models)
{
  const ClothLanePart *parts = CLOTH_LANE_NAME (cloth_lane_parts);
  guint n = 0;

  while (parts[n].effect)
    n++;
  state->effects = lanes_new (n, sizeof *state->effects);
  for (guint order = 0; order < CLOTH_LANE_N_ORDERS; order++)
    for (guint i = 0; i < n; i++)
      if (parts[i].hooks->order == order)
        load_effect (state, models, &parts[i]);
}

/* What follows from the numbers once every effect has had its say. */
static void
prepare (ClothLaneState * state)
{
  const ClothLane *r = state->rest;
  ClothLane one = cloth_lane_set (1.), det;
  gboolean changed = FALSE;

  for (guint i = 0; i < state->n_effects; i++)
    if (state->effects[i].hooks->setup)
      state->effects[i].hooks->setup (state, &state->effects[i]);
  for (guint i = 0; i < state->n; i++)
    state->inverse_mass[i] = one / state->mass[i];
  state->omega2 = CLOTH_LANE_NAME (cloth_lane_stiffness) (state);
  state->friction = state->alpha + state->beta * state->omega2;
  state->own_omega2 = state->omega2;
  state->own_friction = state->friction;
  for (guint i = 0; i < state->n_effects; i++)
    if (state->effects[i].hooks->rate)
      state->effects[i].hooks->rate (state, &state->effects[i],
          &state->omega2, &state->friction);
  for (guint k = 0; k < 4; k++)
    for (guint l = 0; l < CLOTH_N_LANES; l++)
      changed |= CLOTH_LANE_AT (&r[k], l) != (k == 0 || k == 3 ? 1. : 0.);
  state->rest_changed = changed;
  state->grid_alone = state->grid && !changed && !state->has_inertia;
  /* (a, b)' = (a r0 + b r2, a r1 + b r3), and the products of a' and b' */
  state->metric[0] = r[0] * r[0];
  state->metric[1] = r[2] * r[2];
  state->metric[2] = r[0] * r[2] + r[0] * r[2];
  state->metric[3] = r[1] * r[1];
  state->metric[4] = r[3] * r[3];
  state->metric[5] = r[1] * r[3] + r[1] * r[3];
  state->metric[6] = r[0] * r[1];
  state->metric[7] = r[2] * r[3];
  state->metric[8] = r[0] * r[3] + r[1] * r[2];
  det = r[0] * r[3] - r[1] * r[2];
  state->rest_area = one / det;
}

static void
set_lane (ClothLane3 * to, guint lane, guint n, const gdouble * from)
{
  for (guint i = 0; i < n; i++)
    for (guint k = 0; k < 3; k++)
      CLOTH_LANE_AT (&to[i][k], lane) = (ClothReal) from[3 * i + k];
}

static void
keep_sound (ClothLaneState * state)
{
  memcpy (state->sound_x, state->x, state->n * sizeof *state->x);
  memcpy (state->sound_v, state->v, state->n * sizeof *state->v);
}

static void
group_free (gpointer group)
{
  ClothLaneState *state = group;

  for (guint i = 0; i < state->n_effects; i++) {
    if (state->effects[i].hooks->clear)
      state->effects[i].hooks->clear (state, &state->effects[i]);
    g_aligned_free (state->effects[i].state);
  }
  g_aligned_free (state->effects);
  CLOTH_LANE_NAME (cloth_lane_obstacles_free) (state);
  CLOTH_LANE_NAME (cloth_lane_grid_free) (state->grid);
  CLOTH_LANE_NAME (cloth_lane_implicit_free) (state->implicit);
  g_aligned_free (state->targets.pull);
  g_aligned_free (state->targets.change);
  g_aligned_free (state->targets.weight);
  g_aligned_free (state->targets.matrix);
  g_aligned_free (state->pulls.list);
  g_aligned_free (state->pulls.stiffness);
  g_aligned_free (state->pulls.mass);
  g_aligned_free (state->pulls.rows);
  g_aligned_free (state->pulls.drawn);
  for (guint l = 0; l < CLOTH_N_LANES; l++)
    if (l == 0 || state->paths[l] != state->paths[0])
      g_free (state->paths[l]);
  g_aligned_free (state->x);
  g_aligned_free (state->v);
  g_aligned_free (state->f);
  g_aligned_free (state->z);
  g_aligned_free (state->mass);
  g_aligned_free (state->inverse_mass);
  g_aligned_free (state->last_v);
  g_aligned_free (state->before_v);
  g_aligned_free (state->others);
  g_aligned_free (state->sound_x);
  g_aligned_free (state->sound_v);
  g_aligned_free (state->held_offset);
  g_aligned_free (state->held_x);
  g_aligned_free (state->held);
  g_free (state->held_since);
  g_free (state->fixed);
  g_free (state->triangles);
  g_free (state->hinges);
  g_free (state->bends);
  g_free (state->springs);
  g_aligned_free (state);
}

static void
reset_effects (ClothLaneState * state, ClothMask lanes)
{
  for (guint i = 0; i < state->n_effects; i++)
    if (state->effects[i].hooks->reset)
      state->effects[i].hooks->reset (state, &state->effects[i], lanes);
}

static gpointer
group_new (const ClothBody * body, const ClothModel * const *models,
    guint n_models, guint64 seed)
{
  ClothLaneState *state = lanes_new (1, sizeof *state);
  const ClothModel *all[CLOTH_N_LANES];
  guint n = body->n_particles;

  for (guint l = 0; l < CLOTH_N_LANES; l++)
    all[l] = models[l < n_models ? l : 0];
  state->body = body;
  state->n_models = n_models;
  state->seed = seed;
  state->n = n;
  state->x = lanes_new (n, sizeof *state->x);
  state->v = lanes_new (n, sizeof *state->v);
  state->f = lanes_new (n, sizeof *state->f);
  state->z = lanes_new (n, sizeof *state->z);
  state->last_v = lanes_new (n, sizeof *state->v);
  state->before_v = lanes_new (n, sizeof *state->v);
  state->others = lanes_new (n, sizeof *state->f);
  state->sound_x = lanes_new (n, sizeof *state->x);
  state->sound_v = lanes_new (n, sizeof *state->v);
  state->mass = lanes_new (n, sizeof *state->mass);
  state->inverse_mass = lanes_new (n, sizeof *state->mass);
  state->held = lanes_new (body->n_held, sizeof *state->held);
  state->held_since = g_new0 (gdouble, CLOTH_N_LANES *
      (gsize) (body->n_held + 1));
  state->fixed = g_new0 (guint8, n);
  state->held_offset = lanes_new (body->n_held, sizeof *state->held_offset);
  state->held_x = lanes_new (body->n_held, sizeof *state->held_x);
  load_rest (state, body);
  load_springs (state, body);
  state->force_model = models[0]->force_model;
  if (state->force_model == CLOTH_FORCE_MEMBRANE)
    state->grid = CLOTH_LANE_NAME (cloth_lane_grid_new) (body);
  state->obstacles = CLOTH_LANE_NAME (cloth_lane_obstacles_new) (state);
  if (models[0]->integrator == CLOTH_INTEGRATOR_IMPLICIT)
    state->implicit = CLOTH_LANE_NAME (cloth_lane_implicit_new) (state);
  load_models (state, all);
  load_effects (state, all);
  prepare (state);
  for (guint i = 0; i < body->n_vertices; i++) {
    for (guint k = 0; k < 3; k++) {
      state->x[body->particle[i]][k] =
          cloth_lane_set (body->positions[3 * i + k]);
      state->v[body->particle[i]][k] =
          cloth_lane_set (body->velocities[3 * i + k]);
    }
  }
  state->time = 0.;
  reset_effects (state, cloth_lane_equal (state->alpha, state->alpha));
  keep_sound (state);
  return state;
}

static void
group_strain (gpointer group)
{
  CLOTH_LANE_NAME (cloth_lane_strained) (group);
}

static gdouble
group_time_step (gpointer group, guint stages, gdouble longest,
    gboolean strained)
{
  ClothLaneState *state = group;
  const ClothLaneBounds rest = { state->own_omega2, cloth_lane_set (0.),
    CLOTH_LANE_MARGIN
  };
  const ClothLaneBounds *bounds = strained ? &state->strained : &rest;
  ClothLane each;
  gdouble least = state->implicit ? MIN (longest, state->body->frame_s) :
      longest;

  if (stages > 1)
    return CLOTH_LANE_NAME (cloth_lane_staged_time_step) (state, bounds,
        stages, longest);
  each = CLOTH_LANE_NAME (cloth_lane_explicit_time_step) (state, bounds);

  for (guint l = 0; l < CLOTH_N_LANES; l++)
    least = MIN (least, (gdouble) CLOTH_LANE_AT (&each, l));
  return least;
}

/* Lanes with a speed beyond all measure, or NaN, go back to where they were sound and
 * stay there; the others don't notice. */
static void
check_sound (ClothLaneState * state, gdouble since)
{
  ClothLane limit = cloth_lane_set (MAX_SPEED * MAX_SPEED);
  ClothLane zero = cloth_lane_set (0.);
  ClothMask sound = cloth_lane_equal (zero, zero), newly;

  for (guint i = 0; i < state->n; i++)
    sound &= cloth_lane_less (cloth_lane_dot (state->v[i], state->v[i]), limit)
        & cloth_lane_equal (state->x[i][0] - state->x[i][0], zero)
        & cloth_lane_equal (state->x[i][1] - state->x[i][1], zero)
        & cloth_lane_equal (state->x[i][2] - state->x[i][2], zero);
  newly = ~sound & ~state->diverged;
  state->diverged |= newly;
  for (guint l = 0; l < CLOTH_N_LANES; l++)
    if (CLOTH_LANE_AT (&newly, l))
      state->diverged_since[l] = since;
  if (cloth_lane_any (state->diverged)) {
    for (guint i = 0; i < state->n; i++) {
      for (guint k = 0; k < 3; k++) {
        state->x[i][k] = cloth_lane_select (state->diverged,
            state->sound_x[i][k], state->x[i][k]);
        state->v[i][k] = cloth_lane_select (state->diverged, zero,
            state->v[i][k]);
      }
    }
  }
  keep_sound (state);
}

/* What comes after the particles moved. */
static void
finish_step (ClothLaneState * state, gdouble time_s)
{
  state->time = time_s;
  CLOTH_LANE_NAME (cloth_lane_obstacles) (state);
  CLOTH_LANE_NAME (cloth_lane_clamps) (state);
  for (guint i = 0; i < state->n_effects; i++)
    if (state->effects[i].hooks->collide)
      state->effects[i].hooks->collide (state, &state->effects[i]);
}

static gdouble
group_try_step (gpointer group, gdouble until_s)
{
  ClothLaneState *state = group;

  state->dt = until_s - state->time;
  return CLOTH_LANE_NAME (cloth_lane_implicit_solve) (state);
}

static void
group_take_step (gpointer group, gdouble until_s)
{
  ClothLaneState *state = group;
  gdouble start = state->time;

  CLOTH_LANE_NAME (cloth_lane_implicit_take) (state);
  state->steps_left = 0;
  finish_step (state, until_s);
  check_sound (state, start);
}

static void
group_advance (gpointer group, gdouble until_s, guint n_steps, guint stages)
{
  ClothLaneState *state = group;
  gdouble start = state->time;
  ClothLane half;

  state->dt = (until_s - start) / n_steps;
  state->reach = cloth_lane_set (state->dt);
  half = cloth_lane_set (state->dt / 2.);
  state->stages = stages;
  for (guint step = 1; step <= n_steps
      && !cloth_body_is_stopped (state->body); step++) {
    state->steps_left = n_steps - step;
    if (state->implicit) {
      CLOTH_LANE_NAME (cloth_lane_implicit_solve) (state);
      CLOTH_LANE_NAME (cloth_lane_implicit_take) (state);
    } else {
      state->kick = state->lag + half;
      if (stages > 1)
        CLOTH_LANE_NAME (cloth_lane_staged) (state);
      else
        CLOTH_LANE_NAME (cloth_lane_explicit) (state);
      state->lag = half;
      state->ahead = half / state->kick;
    }
    finish_step (state, step == n_steps ? until_s :
        start + (until_s - start) * step / n_steps);
  }
  /* also of what was stopped: all groups have one clock */
  state->time = until_s;
  check_sound (state, start);
}

static void
group_get (gpointer group, guint lane, gdouble * x, gdouble * v)
{
  ClothLaneState *state = group;

  for (guint i = 0; i < state->n; i++) {
    for (guint k = 0; k < 3; k++) {
      if (x)
        x[3 * i + k] = CLOTH_LANE_AT (&state->x[i][k], lane);
      if (v)
        v[3 * i + k] = CLOTH_LANE_AT (&state->v[i][k], lane);
    }
  }
}

/* Lanes beyond the models follow the first, so that none of them is ever a reason to take
 * smaller steps. */
static gboolean
repeats (const ClothLaneState * state, guint lane, guint of)
{
  return lane == of || (of == 0 && lane >= state->n_models);
}

static void
group_set (gpointer group, guint lane, const gdouble * x, const gdouble * v,
    gdouble lag_s)
{
  ClothLaneState *state = group;
  ClothMask lanes = state->diverged ^ state->diverged;

  for (guint l = 0; l < CLOTH_N_LANES; l++) {
    if (!repeats (state, l, lane))
      continue;
    set_lane (state->x, l, state->n, x);
    set_lane (state->v, l, state->n, v);
    CLOTH_LANE_AT (&lanes, l) = -1;
    set_lane (state->before_v, l, state->n, v);
    CLOTH_LANE_AT (&state->lag, l) = (ClothReal) lag_s;
  }
  state->diverged &= ~lanes;
  CLOTH_LANE_NAME (cloth_lane_clamps_reset) (state, lanes);
  if (state->implicit)
    CLOTH_LANE_NAME (cloth_lane_implicit_reset) (state, lanes);
  reset_effects (state, lanes);
  keep_sound (state);
}

static gdouble
group_lag (gpointer group, guint lane)
{
  return CLOTH_LANE_AT (&((ClothLaneState *) group)->lag, lane);
}

static void
group_set_time (gpointer group, gdouble time_s)
{
  ((ClothLaneState *) group)->time = time_s;
}

/* What draws a particle in a lane: its weight times, or its matrix times, now and next. */
static void
set_target (ClothLaneTargets * t, guint i, guint lane,
    const gdouble matrix[6], const gdouble now[3], const gdouble next[3])
{
  static const guint at[3][3] = { {0, 5, 4}, {5, 1, 3}, {4, 3, 2} };

  for (guint k = 0; k < 6; k++)
    CLOTH_LANE_AT (&t->matrix[i][k], lane) = (ClothReal) matrix[k];
  for (guint k = 0; k < 3; k++) {
    gdouble pull = 0., change = 0.;

    for (guint l = 0; l < 3; l++) {
      pull += matrix[at[k][l]] * now[l];
      change += matrix[at[k][l]] * (next[l] - now[l]);
    }
    CLOTH_LANE_AT (&t->pull[i][k], lane) = (ClothReal) pull;
    CLOTH_LANE_AT (&t->change[i][k], lane) = (ClothReal) change;
  }
}

static void
reserve_targets (ClothLaneState * state, gboolean matrices)
{
  ClothLaneTargets *t = &state->targets;

  if (!t->weight) {
    t->pull = lanes_new (state->n, sizeof *t->pull);
    t->change = lanes_new (state->n, sizeof *t->change);
    t->weight = lanes_new (state->n, sizeof *t->weight);
    state->has_targets = TRUE;
  }
  if (t->matrix || !matrices)
    return;
  t->matrix = lanes_new (state->n, sizeof *t->matrix);
  for (guint i = 0; i < state->n; i++)
    for (guint k = 0; k < 3; k++)
      t->matrix[i][k] = t->weight[i];
}

static void
group_set_targets (gpointer group, guint lane, guint n,
    const gdouble * const y[4], const gdouble * weights,
    const gdouble * matrices, const gdouble * gains, const gdouble * dampings,
    gdouble t_now, gdouble t_next)
{
  ClothLaneState *state = group;
  ClothLaneTargets *t = &state->targets;
  gint of[CLOTH_N_LANES];       /* whose targets each lane gets; -1: none */

  reserve_targets (state, matrices != NULL);
  for (guint l = 0; l < CLOTH_N_LANES; l++) {
    of[l] = -1;
    for (guint i = 0; i < n; i++)
      if (repeats (state, l, lane + i))
        of[l] = (gint) i;
  }
  for (guint i = 0; i < state->n; i++)
    for (guint l = 0; l < CLOTH_N_LANES; l++) {
      gdouble gain, damping, now[3], next[3];

      if (of[l] < 0)
        continue;
      gain = gains[of[l]];
      damping = dampings[of[l]];
      CLOTH_LANE_AT (&t->weight[i], l) = (ClothReal) weights[i];
      for (guint k = 0; k < 3; k++) {
        guint at = 3 * i + k;

        now[k] = gain * y[0][at] + damping * y[2][at];
        next[k] = gain * y[1][at] + damping * y[3][at];
        CLOTH_LANE_AT (&t->pull[i][k], l) = (ClothReal) (weights[i] * now[k]);
        CLOTH_LANE_AT (&t->change[i][k], l) =
            (ClothReal) (weights[i] * (next[k] - now[k]));
      }
      if (matrices)
        set_target (t, i, l, matrices + 6 * (gsize) i, now, next);
      else if (t->matrix)
        set_target (t, i, l, (const gdouble[6]) { weights[i], weights[i],
            weights[i]
            }, now, next);
    }
  for (guint l = 0; l < CLOTH_N_LANES; l++) {
    if (of[l] < 0)
      continue;
    CLOTH_LANE_AT (&t->gain, l) = (ClothReal) gains[of[l]];
    CLOTH_LANE_AT (&t->damping, l) = (ClothReal) dampings[of[l]];
    t->now[l] = t_now;
    t->next[l] = t_next;
  }
}

static void
load_end (ClothLanePull * to, const ClothPull * from, gdouble square)
{
  for (guint k = 0; k < 3; k++) {
    to->target[0][k] = (ClothReal) from->now.target[k];
    to->target[1][k] = (ClothReal) (from->next.target[k] - from->now.target[k]);
    to->velocity[0][k] = (ClothReal) from->now.velocity[k];
    to->velocity[1][k] = (ClothReal) (from->next.velocity[k] -
        from->now.velocity[k]);
  }
  to->strongest = 0.;
  for (guint k = 0; k < 6; k++) {
    gdouble now = square * from->now.information[k];
    gdouble next = square * from->next.information[k];

    to->information[0][k] = (ClothReal) now;
    to->information[1][k] = (ClothReal) (next - now);
  }
  /* the trace is no less than the largest eigenvalue */
  to->strongest = square * MAX (from->now.information[0] +
      from->now.information[1] + from->now.information[2],
      from->next.information[0] + from->next.information[1] +
      from->next.information[2]);
}

static guint
count_corners (const ClothPull * pull)
{
  return pull->corner[0] == pull->corner[1]
      && pull->corner[0] == pull->corner[2] ? 1 : 3;
}

static void
load_pull (ClothLanePull * to, const ClothPull * from,
    const ClothPullOptions * options)
{
  gdouble squares = 1., factor = 1.;

  to->n = count_corners (from);
  for (guint i = 0; i < to->n && to->n == 3; i++)
    squares += from->weight[i] * from->weight[i];
  if (options->shares == CLOTH_PULL_PRINTED && to->n == 3)
    factor = 2. / squares;
  for (guint i = 0; i < to->n; i++) {
    gdouble weight = to->n == 1 ? 1. : from->weight[i];

    to->particle[i] = from->corner[i];
    to->at[i] = (ClothReal) weight;
    to->share[i] = (ClothReal) (factor * weight);
  }
  load_end (to, from, options->sigma * options->sigma);
}

static void
reserve_pulls (ClothLaneState * state, guint n)
{
  ClothLanePulls *p = &state->pulls;

  if (!p->rows) {
    p->rows = lanes_new (state->n, sizeof *p->rows);
    p->drawn = lanes_new (state->n, sizeof *p->drawn);
  }
  if (n <= p->size)
    return;
  g_aligned_free (p->list);
  g_aligned_free (p->mass);
  g_aligned_free (p->stiffness);
  p->list = lanes_new (n, sizeof *p->list);
  p->mass = lanes_new (n, sizeof *p->mass);
  p->stiffness = lanes_new (n, sizeof *p->stiffness);
  p->size = n;
}

static gboolean
group_set_pulls (gpointer group, const ClothPull * pulls, guint n,
    const ClothPullOptions * options, const gdouble * gains,
    const gdouble * dampings, gdouble t_now, gdouble t_next)
{
  ClothLaneState *state = group;
  ClothLanePulls *p = &state->pulls;
  gboolean changed = FALSE;
  ClothLane bound;

  reserve_pulls (state, n);
  p->n = p->n_single = 0;
  for (guint corners = 1; corners <= 3; corners += 2) {
    for (guint i = 0; i < n; i++)
      if (count_corners (&pulls[i]) == corners)
        load_pull (&p->list[p->n++], &pulls[i], options);
    if (corners == 1)
      p->n_single = p->n;
  }
  p->law = options->law;
  p->softening = options->softening;
  p->per_square = 1. / (options->sigma * options->sigma);
  p->now = t_now;
  p->per_span = 1. / (t_next - t_now);
  CLOTH_LANE_NAME (cloth_lane_pulls_weigh) (state);
  bound = CLOTH_LANE_NAME (cloth_lane_pulls_bound) (state, p->rows);
  for (guint l = 0; l < CLOTH_N_LANES; l++) {
    guint of = l < state->n_models ? l : 0;
    ClothReal gain = (ClothReal) gains[of], damping = (ClothReal) dampings[of];
    /* in half octaves, so that it seldom changes from interval to interval */
    ClothReal most = (ClothReal) (n ? exp2 (ceil (2. * log2 (CLOTH_LANE_AT
                    (&bound, l) + LEAST_BOUND)) / 2.) : 0.);

    changed |= CLOTH_LANE_AT (&p->gain, l) != gain
        || CLOTH_LANE_AT (&p->damping, l) != damping
        || CLOTH_LANE_AT (&p->bound, l) != most;
    CLOTH_LANE_AT (&p->gain, l) = gain;
    CLOTH_LANE_AT (&p->damping, l) = damping;
    CLOTH_LANE_AT (&p->bound, l) = most;
  }
  return changed;
}

static void
group_set_paths (gpointer group, guint lane, const gdouble * paths)
{
  ClothLaneState *state = group;
  gsize size = 3 * sizeof (gdouble) * state->body->n_frames *
      state->body->n_held;
  gdouble *copy = paths ? g_memdup2 (paths, size) : NULL;

  for (guint l = CLOTH_N_LANES; l-- > 0;) {
    if (!repeats (state, l, lane))
      continue;
    if (l == lane)
      g_free (state->paths[l]);
    state->paths[l] = copy;
  }
}

static gdouble
group_diverged (gpointer group, guint lane)
{
  ClothLaneState *state = group;

  return CLOTH_LANE_AT (&state->diverged, lane) ?
      state->diverged_since[lane] : NAN;
}

static ClothSimEnergy
group_energy (gpointer group, guint lane)
{
  ClothLaneState *state = group;
  ClothLane elastic = CLOTH_LANE_NAME (cloth_lane_bending_energy) (state) +
      (state->force_model == CLOTH_FORCE_MASS_SPRING ?
      CLOTH_LANE_NAME (cloth_lane_springs_energy) (state) :
      CLOTH_LANE_NAME (cloth_lane_membrane_energy) (state));
  ClothSimEnergy energy = { 0., CLOTH_LANE_AT (&elastic, lane), 0. };

  for (guint i = 0; i < state->n; i++) {
    gdouble mass = CLOTH_LANE_AT (&state->mass[i], lane);

    for (guint k = 0; k < 3; k++) {
      gdouble v = CLOTH_LANE_AT (&state->v[i][k], lane);

      energy.kinetic += 0.5 * mass * v * v;
      energy.gravity -= mass * CLOTH_LANE_AT (&state->gravity[k], lane) *
          CLOTH_LANE_AT (&state->x[i][k], lane);
    }
  }
  return energy;
}

/* Of grids all of the cloth's forces are found in one pass, unless lengths at rest change
 * or an effect acts on the sum of all forces; contact is looked for lane by lane. */
static ClothLaneCost
cost (const ClothEffect * effect)
{
  const ClothLanePart *part = CLOTH_LANE_NAME (cloth_lane_parts);

  while (part->effect && part->effect != effect)
    part++;
  if (!part->effect)
    return CLOTH_LANE_COST_NONE;
  if (part->hooks->changes_rest || part->hooks->inertia || part->hooks->collide)
    return CLOTH_LANE_COST_HIGH;
  return part->hooks->force ? CLOTH_LANE_COST_LOW : CLOTH_LANE_COST_NONE;
}

extern const ClothLaneBackend CLOTH_LANE_NAME (cloth_lane_backend);

const ClothLaneBackend CLOTH_LANE_NAME (cloth_lane_backend) = {
  CLOTH_N_LANES, cost, group_new, group_free, group_strain, group_time_step,
  group_advance,
  group_try_step, group_take_step,
  group_get, group_lag, group_set, group_set_time, group_set_targets,
  group_set_pulls,
  group_set_paths, group_diverged, group_energy
};
