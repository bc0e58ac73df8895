/* The simulator: models into groups of lanes, groups onto threads.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/sim.h"

#include <math.h>
#include <string.h>

#include "gst/math/pool.h"
#include "gst/sim/bodybuild.h"
#include "gst/sim/group.h"
#include "gst/sim/numerics.h"

/* Steps an octave that automatic time steps are rounded down to, so that models that are
 * nearly alike take the same steps and their difference is their own. */
#define STEPS_AN_OCTAVE 8.
/* Shorter implicit steps than this part of a frame are not tried. */
#define LEAST_STEP (1. / 4096.)
/* After so many steps in a row that could have been longer, the next one is longer. */
#define GOOD_STEPS 3
/* Steps of one cloth_sim_advance (); more means a model far out of range. */
#define MAX_STEPS 1e8
/* Models that need shorter steps are refused, s: they would take days. */
#define SHORTEST_STEP 1e-8
/* Most stages of a step; the cost of the rest of a step, in stages; how many times as long
 * as a plain step a staged one may be. */
#define MAX_STAGES 8
#define OTHER_COSTS 0.6
#define LONGEST_STAGED 64.
/* Stretched cloth takes steps of no smaller share of those at rest: what needs them is about to tear apart. */
#define LEAST_STRAINED 0.125
/* What rounding may make of the information in a direction of which nothing is known, of all. */
#define ROUNDING 1e-9

struct _ClothSim
{
  ClothNumerics *numerics;
  ClothBody *body;
  ClothPool *pool;
  guint n_vertices;             /* of the scene; effects may give the body more */
  guint n_models;
  guint n_groups;
  ClothSimGroup *groups;        /* those with the most to do first */
  guint *group_of;              /* of each model */
  guint *rank_of;               /* of each model: where it is in the groups' order */
  gdouble time;                 /* from the first frame on, s */
  gdouble fixed_step;           /* of the models, 0 = automatic */
  gdouble time_step;
  gdouble strained_step;        /* of the last advance, in equal steps */
  guint stages;                 /* of a step */
  gboolean stale;               /* the time step is to be found anew */
  gboolean implicit;
  gboolean adaptive;            /* implicit with an automatic step */
  gdouble longest_step;
  gdouble patience;             /* how much more than usual a step may be wrong */
  guint good_steps;             /* in a row */
  gdouble *scratch[5];          /* by particle or by vertex */
  gdouble *weights;             /* by vertex of the body */
  gdouble *gains, *dampings;    /* of the observer, by rank */
  gdouble *matrices;            /* of the observer's springs, by particle, and scratch */
  GArray *pulls;                /* the last ones, by particle */
  gdouble lighter;              /* the scene's vertices are than the cloth on a finer mesh */
  gdouble *pull_gains, *pull_dampings;  /* by rank */
  /* of the running advance */
  gdouble until;
  guint n_steps, n_stages;
  gdouble *too_long;            /* of each group, an implicit step */
};

static gboolean
check_models (const ClothModel * const *models, guint n_models, GError ** error)
{
  if (n_models == 0) {
    g_set_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_MODEL,
        "no model: give at least one");
    return FALSE;
  }
  for (guint i = 0; i < n_models; i++) {
    const ClothModel *m = models[i];
    const gchar *key = NULL;
    g_autoptr (GError) cause = NULL;

    if (!cloth_model_check (m, &cause)) {
      g_set_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_MODEL,
          "model %u: %s", i, cause->message);
      return FALSE;
    }
    if (m->force_model != models[0]->force_model)
      key = "force_model";
    else if (m->integrator != models[0]->integrator)
      key = "integrator";
    else if (m->time_step != models[0]->time_step)
      key = "time_step";
    if (key) {
      g_set_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_MODEL,
          "models 0 and %u differ in %s: models simulated together must agree "
          "in it", i, key);
      return FALSE;
    }
  }
  return TRUE;
}

static gdouble
round_step (gdouble step)
{
  /* one that is rounded already stays */
  return exp2 (floor (log2 (step) * STEPS_AN_OCTAVE + 1e-6) / STEPS_AN_OCTAVE);
}

/* The largest step, at most @longest, that all models can take. */
static gdouble
bound (const ClothSim * sim, guint stages, gdouble longest, gboolean strained)
{
  for (guint i = 0; i < sim->n_groups; i++)
    longest =
        MIN (longest, sim->groups[i].backend->time_step (sim->groups[i].lanes,
            stages, longest, strained));
  return longest;
}

/* The number of stages that reaches a given step, or the one that costs least; the
 * longest step that it allows. */
static gdouble
find_stages (ClothSim * sim)
{
  const gdouble wanted = sim->fixed_step * MAX (sim->numerics->step_factor, 1.);
  gdouble best = bound (sim, 1, INFINITY, FALSE), longest;

  sim->stages = 1;
  if (sim->implicit)
    return best;
  /* what is tried from there on is rounded already */
  longest = round_step (LONGEST_STAGED * best);
  for (guint s = 2; s <= MAX_STAGES && !(wanted > 0. && best >= wanted); s++) {
    gdouble step = bound (sim, s, longest, FALSE);

    if (wanted > 0. ? step > best : (s + OTHER_COSTS) / step <
        (sim->stages + OTHER_COSTS) / best) {
      sim->stages = s;
      best = step;
    }
  }
  return best;
}

static void
find_time_step (ClothSim * sim)
{
  gdouble least = find_stages (sim);

  /* a frame is one step, not a rounded one and a rest */
  if (!sim->implicit || least < sim->body->frame_s)
    least = round_step (least);
  sim->longest_step = (sim->fixed_step > 0. ? sim->fixed_step : least) *
      sim->numerics->step_factor;
  /* the cloth itself bounds no implicit step */
  if (sim->numerics->step_factor != 1. && (!sim->implicit || sim->adaptive))
    sim->longest_step = MIN (sim->longest_step, least);
  if (!sim->adaptive || sim->time_step == 0.
      || sim->time_step > sim->longest_step)
    sim->time_step = sim->longest_step;
  sim->strained_step = INFINITY;
  sim->stale = FALSE;
}

static gboolean
check_time_step (const ClothSim * sim, const ClothModel * const *models,
    GError ** error)
{
  const ClothModel *stiff = models[0];

  if (sim->longest_step >= SHORTEST_STEP)
    return TRUE;
  if (sim->fixed_step > 0.) {
    g_set_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_MODEL,
        "“time_step” is %g s, %g s with the effects; steps must not be "
        "shorter than %g s: give 0 for an automatic one", sim->fixed_step,
        sim->longest_step, SHORTEST_STEP);
    return FALSE;
  }
  for (guint i = 1; i < sim->n_models; i++)
    if (models[i]->stretch_warp + models[i]->stretch_weft
        > stiff->stretch_warp + stiff->stretch_weft)
      stiff = models[i];
  g_set_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_MODEL,
      "steps of %g s would be needed, and %g s are the shortest: lower the "
      "stiffnesses or damping.stiffness (“stretch” is %g and %g, “shear” %g, "
      "“bending” %g and %g, “damping.stiffness” %g), or set “integrator” to "
      "implicit", sim->longest_step, SHORTEST_STEP, stiff->stretch_warp,
      stiff->stretch_weft, stiff->shear, stiff->bending_warp,
      stiff->bending_weft, stiff->damping_stiffness);
  return FALSE;
}

/* @a: a model
 * @b: another
 *
 * Returns: whether one simulation can have both: they agree in force_model, integrator,
 *   time_step and the numerics effects
 */
gboolean
cloth_sim_can_share (const ClothModel * a, const ClothModel * b)
{
  return a->force_model == b->force_model && a->integrator == b->integrator
      && a->time_step == b->time_step && cloth_numerics_agree (a, b);
}

/* The cloth's area over that of the scene's own vertices, which share it with those of a finer
 * mesh. */
static gdouble
find_lighter (const ClothSim * sim)
{
  const guint32 *kept = sim->numerics->kept;
  gdouble all = 0., own = 0.;

  for (guint i = 0; i < sim->body->n_particles; i++)
    all += sim->body->area[i];
  for (guint i = 0; kept && i < sim->n_vertices; i++)
    own += sim->body->area[sim->body->particle[kept[i]]];
  return kept ? all / own : 1.;
}

/* @scene: what to simulate; nothing of it is kept
 * @models: the models to simulate it with; nothing of them is kept
 * @n_models: how many, at least 1; they must agree in force_model, integrator,
 *   time_step and the numerics effects
 * @options: (nullable): %NULL for double precision, all processors and seed 0
 * @error: #ClothSimError, also for what cloth_scene_check () or cloth_model_check ()
 *   refuse, and for models that would need steps shorter than 1e-8 s
 *
 * Models are computed side by side in vector instructions and on several threads. What
 * becomes of a model does not depend on its neighbours, the threads or the instruction
 * set, to the last bit, but for the time step: an automatic one is the smallest that any
 * of the models needs, rounded down to an eighth of an octave, and a smaller one while any of them is stretched far, down to
 * an eighth where one is about to burst.
 *
 * Models with the effects time_step, mesh_resolution or mesh_diagonals are simulated with
 * other steps or on another mesh; what goes in and comes out is about @scene's own
 * vertices all the same. They must agree in these effects too.
 *
 * Returns: (transfer full) (nullable): the simulation at the time of the first frame
 */
ClothSim *
cloth_sim_new (const ClothScene * scene, const ClothModel * const *models,
    guint n_models, const ClothSimOptions * options, GError ** error)
{
  const ClothSimOptions usual = { FALSE, 0, CLOTH_SIMD_BEST, 0 };
  g_autoptr (ClothSim) sim = g_new0 (ClothSim, 1);
  g_autoptr (GError) cause = NULL;

  if (!options)
    options = &usual;
  if (!cloth_scene_check (scene, &cause)) {
    g_set_error_literal (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_SCENE,
        cause->message);
    return NULL;
  }
  if (!check_models (models, n_models, error))
    return NULL;
  sim->numerics = cloth_numerics_new (scene, models, n_models, error);
  if (!sim->numerics)
    return NULL;
  sim->n_vertices = scene->topology->n_vertices;
  sim->body = cloth_body_new (sim->numerics->scene, error);
  if (!sim->body)
    return NULL;
  sim->body->stop = options->stop;
  sim->n_models = n_models;
  sim->fixed_step = models[0]->time_step;
  sim->implicit = models[0]->integrator == CLOTH_INTEGRATOR_IMPLICIT;
  sim->adaptive = sim->implicit && sim->fixed_step == 0.;
  /* twice as long is four times as far off */
  sim->patience = sim->numerics->step_factor * sim->numerics->step_factor;
  sim->time = 0.;
  for (guint i = 0; i < G_N_ELEMENTS (sim->scratch); i++)
    sim->scratch[i] = g_new0 (gdouble, 3 * (gsize) MAX (sim->n_vertices,
            sim->body->n_particles));
  sim->gains = g_new0 (gdouble, n_models);
  sim->dampings = g_new0 (gdouble, n_models);
  sim->lighter = find_lighter (sim);
  sim->pulls = g_array_new (FALSE, FALSE, sizeof (ClothPull));
  sim->pull_gains = g_new0 (gdouble, n_models);
  sim->pull_dampings = g_new0 (gdouble, n_models);
  sim->weights = g_new (gdouble, sim->body->n_vertices);
  sim->pool = cloth_pool_new (options->threads);
  sim->group_of = g_new (guint, n_models);
  sim->rank_of = g_new (guint, n_models);
  sim->groups = cloth_sim_groups_new (sim->body, models, n_models, options,
      cloth_pool_get_n_threads (sim->pool), sim->group_of, sim->rank_of,
      &sim->n_groups);
  sim->too_long = g_new0 (gdouble, sim->n_groups);
  find_time_step (sim);
  if (!check_time_step (sim, models, error))
    return NULL;
  return g_steal_pointer (&sim);
}

/* @sim: (nullable) (transfer full): a simulation
 */
void
cloth_sim_free (ClothSim * sim)
{
  if (!sim)
    return;
  cloth_sim_groups_free (sim->groups, sim->n_groups);
  g_free (sim->group_of);
  g_free (sim->rank_of);
  g_free (sim->too_long);
  for (guint i = 0; i < G_N_ELEMENTS (sim->scratch); i++)
    g_free (sim->scratch[i]);
  g_free (sim->weights);
  g_free (sim->gains);
  g_free (sim->dampings);
  g_free (sim->matrices);
  g_clear_pointer (&sim->pulls, g_array_unref);
  g_free (sim->pull_gains);
  g_free (sim->pull_dampings);
  g_clear_pointer (&sim->pool, cloth_pool_free);
  g_clear_pointer (&sim->body, cloth_body_free);
  g_clear_pointer (&sim->numerics, cloth_numerics_free);
  g_free (sim);
}

/* @sim: a simulation
 *
 * Returns: how many models it has
 */
guint
cloth_sim_get_n_models (const ClothSim * sim)
{
  return sim->n_models;
}

/* @sim: a simulation
 *
 * Returns: how many vertices its cloth has
 */
guint
cloth_sim_get_n_vertices (const ClothSim * sim)
{
  return sim->n_vertices;
}

static void
advance_groups (gpointer data, guint begin, guint end, guint worker)
{
  ClothSim *sim = data;

  for (guint i = begin; i < end; i++)
    sim->groups[i].backend->advance (sim->groups[i].lanes, sim->until,
        sim->n_steps, sim->n_stages);
}

static void
try_groups (gpointer data, guint begin, guint end, guint worker)
{
  ClothSim *sim = data;

  for (guint i = begin; i < end; i++)
    sim->too_long[i] =
        sim->groups[i].backend->try_step (sim->groups[i].lanes, sim->until);
}

static void
take_groups (gpointer data, guint begin, guint end, guint worker)
{
  ClothSim *sim = data;

  for (guint i = begin; i < end; i++)
    sim->groups[i].backend->take_step (sim->groups[i].lanes, sim->until);
}

/* Implicit steps that all models can take: half as long when one can't, twice as long
 * when none minds for a while. */
static void
advance_adaptive (ClothSim * sim, gdouble until_s)
{
  gdouble least = sim->body->frame_s * LEAST_STEP;

  while (sim->time < until_s && !cloth_body_is_stopped (sim->body)) {
    gdouble span = until_s - sim->time, worst = 0.;
    gdouble n = ceil (span / sim->time_step - 1e-9);

    sim->until = n > 1. ? sim->time + span / n : until_s;
    cloth_pool_run_one_by_one (sim->pool, try_groups, sim, sim->n_groups);
    for (guint i = 0; i < sim->n_groups; i++)
      worst = MAX (worst, sim->too_long[i] / sim->patience);
    if (worst > 1. && sim->time_step > least) {
      sim->time_step = MIN (sim->time_step, sim->until - sim->time) / 2.;
      sim->good_steps = 0;
      continue;
    }
    cloth_pool_run_one_by_one (sim->pool, take_groups, sim, sim->n_groups);
    sim->time = sim->until;
    sim->good_steps = worst < 0.2 ? sim->good_steps + 1 : 0;
    if (sim->good_steps >= GOOD_STEPS) {
      sim->time_step = MIN (2. * sim->time_step, sim->longest_step);
      sim->good_steps = 0;
    }
  }
}

static void
strain_groups (gpointer data, guint begin, guint end, guint worker)
{
  ClothSim *sim = data;

  for (guint i = begin; i < end; i++)
    sim->groups[i].backend->strain (sim->groups[i].lanes);
}

/* Finds the step of cloth as it is stretched now, which is stiffer than at rest, when the step is an automatic one; and
 * how many stages it needs. */
static void
find_strained_step (ClothSim * sim)
{
  /* the effect time_step shortens all steps alike */
  const gdouble share = MIN (sim->numerics->step_factor, 1.);
  gdouble step;

  sim->strained_step = sim->time_step;
  sim->n_stages = sim->stages;
  if (sim->fixed_step > 0.)
    return;
  cloth_pool_run_one_by_one (sim->pool, strain_groups, sim, sim->n_groups);
  step = bound (sim, sim->stages, sim->time_step / share, TRUE);
  if (step * share >= sim->time_step)
    return;
  step = MAX (round_step (step), sim->time_step / share * LEAST_STRAINED);
  sim->strained_step = step * share;
  for (guint s = 1; s < sim->n_stages; s++)
    if (bound (sim, s, step, TRUE) >= step)
      sim->n_stages = s;
}

/* @sim: a simulation
 * @until_s: where to stop, seconds; nothing happens when that is not ahead
 *
 * Moves all models on, in equal steps no longer than cloth_sim_get_time_step (); in shorter ones while some cloth is
 * stretched far, by a fifth or so, and the step is an automatic one. A model
 * that diverges is put back to where it was at the start of this call and stays there. Comes back early when the options'
 * stop says so.
 */
void
cloth_sim_advance (ClothSim * sim, gdouble until_s)
{
  gdouble span;

  until_s -= sim->body->epoch;
  span = until_s - sim->time;
  if (!(span > 0.) || !isfinite (span))
    return;
  if (sim->stale)
    find_time_step (sim);
  if (sim->adaptive) {
    advance_adaptive (sim, until_s);
    return;
  }
  find_strained_step (sim);
  sim->until = until_s;
  /* a step too many for a rounding error would be a waste */
  sim->n_steps =
      (guint) CLAMP (ceil (span / sim->strained_step - 1e-9), 1., MAX_STEPS);
  cloth_pool_run_one_by_one (sim->pool, advance_groups, sim, sim->n_groups);
  sim->time = until_s;
}

/* @sim: a simulation
 *
 * Returns: the time that its models have reached, seconds
 */
gdouble
cloth_sim_get_time (const ClothSim * sim)
{
  return sim->time + sim->body->epoch;
}

/* @sim: a simulation
 *
 * Returns: the longest step that cloth_sim_advance () takes, or took last if some cloth was stretched far, seconds
 */
gdouble
cloth_sim_get_time_step (ClothSim * sim)
{
  if (sim->stale)
    find_time_step (sim);
  return MIN (sim->time_step, sim->strained_step);
}

static const ClothSimGroup *
group_of (const ClothSim * sim, guint model, guint * lane)
{
  const ClothSimGroup *group = &sim->groups[sim->group_of[model]];

  *lane = sim->rank_of[model] - group->first;
  return group;
}

static void
from_particles (const ClothSim * sim, const gdouble * particles,
    gdouble * vertices)
{
  const guint32 *kept = sim->numerics->kept;

  for (guint i = 0; i < sim->n_vertices; i++)
    memcpy (vertices + 3 * i,
        particles + 3 * (gsize) sim->body->particle[kept ? kept[i] : i],
        3 * sizeof *vertices);
}

/* Of sewn vertices the first one counts. */
static void
to_particles (const ClothSim * sim, const gdouble * vertices,
    gdouble * particles)
{
  vertices = cloth_numerics_spread (sim->numerics, 3, vertices);
  for (guint i = sim->body->n_vertices; i-- > 0;)
    memcpy (particles + 3 * (gsize) sim->body->particle[i], vertices + 3 * i,
        3 * sizeof *vertices);
}

/* @sim: a simulation
 * @model: index of a model
 * @positions: (out caller-allocates): where its vertices are, n_vertices · 3, metres
 */
void
cloth_sim_get_positions (const ClothSim * sim, guint model, gdouble * positions)
{
  guint lane;
  const ClothSimGroup *group = group_of (sim, model, &lane);

  group->backend->get (group->lanes, lane, sim->scratch[0], NULL);
  from_particles (sim, sim->scratch[0], positions);
}

/* @sim: a simulation
 * @model: index of a model
 * @velocities: (out caller-allocates): how fast its vertices are, n_vertices · 3, m/s
 *
 * Of explicit steps it is the velocity in the middle of the last one, from place to place.
 */
void
cloth_sim_get_velocities (const ClothSim * sim, guint model,
    gdouble * velocities)
{
  guint lane;
  const ClothSimGroup *group = group_of (sim, model, &lane);

  group->backend->get (group->lanes, lane, NULL, sim->scratch[0]);
  from_particles (sim, sim->scratch[0], velocities);
}

/* What is in the scratch becomes the state of a model. */
static void
set_particles (ClothSim * sim, guint model, gdouble lag_s, gdouble time_s)
{
  guint lane;
  const ClothSimGroup *group = group_of (sim, model, &lane);

  group->backend->set (group->lanes, lane, sim->scratch[0], sim->scratch[1],
      lag_s);
  if (time_s == sim->time)
    return;
  for (guint i = 0; i < sim->n_groups; i++)
    sim->groups[i].backend->set_time (sim->groups[i].lanes, time_s);
  sim->time = time_s;
}

/* @sim: a simulation
 * @model: index of a model
 * @positions: where its vertices are to be, n_vertices · 3, metres
 * @velocities: (nullable): how fast, m/s; %NULL: at rest
 * @time_s: the time from which the simulation, all models of it, goes on
 *
 * Puts a model somewhere else, for example where it was observed. One that had diverged
 * moves again. Vertices that a clamp holds are drawn to its path within one frame. Of
 * vertices that are sewn together the first one's state counts.
 */
void
cloth_sim_set_state (ClothSim * sim, guint model, const gdouble * positions,
    const gdouble * velocities, gdouble time_s)
{
  to_particles (sim, positions, sim->scratch[0]);
  if (velocities)
    to_particles (sim, velocities, sim->scratch[1]);
  else
    memset (sim->scratch[1], 0,
        3 * (gsize) sim->body->n_particles * sizeof (gdouble));
  set_particles (sim, model, 0., time_s - sim->body->epoch);
}

/* @sim: a simulation
 * @model: index of a model
 * @from: a simulation of the same cloth, @sim itself or another one
 * @of: index of one of its models
 *
 * Puts a model where another one is now, with its velocities as they are: those of explicit steps
 * are half a step behind the places, and go on from there. Else as cloth_sim_set_state () at the
 * time of that other simulation.
 */
void
cloth_sim_copy_state (ClothSim * sim, guint model, const ClothSim * from,
    guint of)
{
  guint lane;
  const ClothSimGroup *group = group_of (from, of, &lane);

  group->backend->get (group->lanes, lane, from->scratch[0], from->scratch[1]);
  from_particles (from, from->scratch[0], from->scratch[2]);
  from_particles (from, from->scratch[1], from->scratch[3]);
  to_particles (sim, from->scratch[2], sim->scratch[0]);
  to_particles (sim, from->scratch[3], sim->scratch[1]);
  set_particles (sim, model, group->backend->lag (group->lanes, lane),
      from->time + (from->body->epoch - sim->body->epoch));
}

/* @sim: a simulation
 * @model: index of a model
 * @since_s: (out) (optional): when it was sound for the last time, NaN when it is
 *
 * Returns: whether the model still moves
 */
ClothSimState
cloth_sim_get_state (const ClothSim * sim, guint model, gdouble * since_s)
{
  guint lane;
  const ClothSimGroup *group = group_of (sim, model, &lane);
  gdouble since = group->backend->diverged (group->lanes, lane);

  if (since_s)
    *since_s = since + sim->body->epoch;
  return isnan (since) ? CLOTH_SIM_OK : CLOTH_SIM_DIVERGED;
}

/* @sim: a simulation
 * @model: index of a model
 *
 * Returns: its energies now, without those of effects
 */
ClothSimEnergy
cloth_sim_get_energy (const ClothSim * sim, guint model)
{
  guint lane;
  const ClothSimGroup *group = group_of (sim, model, &lane);

  return group->backend->energy (group->lanes, lane);
}

/* The same of matrices, three numbers of each at a time. */
static void
spread_matrices (ClothSim * sim, const gdouble * matrices)
{
  const gsize n = 6 * (gsize) sim->body->n_particles;
  gdouble *half;

  if (!sim->matrices)
    sim->matrices = g_new (gdouble, n + 3 * (gsize) sim->n_vertices);
  half = sim->matrices + n;
  memset (sim->matrices, 0, n * sizeof *sim->matrices);
  for (guint part = 0; part < 6; part += 3) {
    const gdouble *spread;

    for (guint i = 0; i < sim->n_vertices; i++)
      memcpy (half + 3 * i, matrices + 6 * (gsize) i + part, 3 * sizeof *half);
    spread = cloth_numerics_spread (sim->numerics, 3, half);
    for (guint i = 0; i < sim->body->n_vertices; i++)
      for (guint k = 0; sim->weights[i] > 0. && k < 3; k++)
        sim->matrices[6 * (gsize) sim->body->particle[i] + part + k] +=
            sim->weights[i] * spread[3 * i + k];
  }
}

/* What is to draw the particles, into the scratch: of sewn vertices the mean. */
static void
spread_targets (ClothSim * sim, const gdouble * now, const gdouble * next,
    const gdouble * velocity_now, const gdouble * velocity_next,
    const gdouble * weights, const gdouble * matrices)
{
  const gdouble *from[4] = { now, next, velocity_now, velocity_next };
  gdouble *total = sim->scratch[4];
  guint n = sim->body->n_particles;

  /* a vertex between one that was seen and one that was not gets the weight NaN, and is
   * not drawn */
  for (guint i = 0; i < sim->n_vertices; i++) {
    gdouble sum = 0.;

    for (guint k = 0; k < 4; k++)
      sum += from[k][3 * i] + from[k][3 * i + 1] + from[k][3 * i + 2];
    sim->weights[i] = isfinite (sum) && weights[i] > 0. ? weights[i] : NAN;
  }
  memmove (sim->weights, cloth_numerics_spread (sim->numerics, 1,
          sim->weights), sim->body->n_vertices * sizeof (gdouble));
  for (guint k = 0; k < 4; k++) {
    const gdouble *y = cloth_numerics_spread (sim->numerics, 3, from[k]);

    memset (sim->scratch[k], 0, 3 * (gsize) n * sizeof (gdouble));
    memset (total, 0, n * sizeof (gdouble));
    for (guint i = 0; i < sim->body->n_vertices; i++) {
      guint p = sim->body->particle[i];
      gdouble weight = sim->weights[i];

      if (!(weight > 0.))
        continue;
      total[p] += weight;
      for (guint c = 0; c < 3; c++)
        sim->scratch[k][3 * p + c] += (y[3 * i + c] -
            sim->scratch[k][3 * p + c]) * (weight / total[p]);
    }
  }
  if (matrices)
    spread_matrices (sim, matrices);
}

static void
set_gain (ClothSim * sim, guint model, gdouble gain, gdouble damping)
{
  guint rank = sim->rank_of[model];

  sim->stale = sim->stale || gain != sim->gains[rank]
      || damping != sim->dampings[rank];
  sim->gains[rank] = gain;
  sim->dampings[rank] = damping;
}

/* Draws @n lanes of a group to what is in the scratch. */
static void
draw (ClothSim * sim, const ClothSimGroup * group, guint lane, guint n,
    gboolean matrices, gdouble t_now, gdouble t_next)
{
  group->backend->set_targets (group->lanes, lane, n,
      (const gdouble * const *) sim->scratch, sim->scratch[4],
      matrices ? sim->matrices : NULL,
      sim->gains + group->first + lane, sim->dampings + group->first + lane,
      t_now - sim->body->epoch, t_next - sim->body->epoch);
}

/* @sim: a simulation
 * @model: index of a model
 * @now: where the vertices were observed at @t_now, n_vertices · 3, metres
 * @next: where they were at @t_next
 * @velocity_now: their velocities at @t_now, m/s
 * @velocity_next: their velocities at @t_next
 * @weights: one number of each vertex, 0 for those not observed
 * @matrices: (nullable): six numbers of each vertex, instead of its weight: a symmetric matrix
 *   xx, yy, zz, yz, xz, xy with no eigenvalue below 0 or above 1, for those of which some
 *   directions are known better than others; where the weight is 0 there is none
 * @gain: 1/s²
 * @damping: 1/s
 * @t_now: seconds
 * @t_next: seconds, after @t_now
 *
 * Draws a model to what was observed (an observer, or nudging): until the next call each
 * vertex of mass m and weight w feels gain·m·w·(y − x) + damping·m·w·(y′ − v), with y and
 * y′ on straight lines from now to next. Where a number is not finite the weight counts
 * as 0. Sewn vertices are drawn to the weighted mean of their targets. The gains take
 * part in the time step.
 */
void
cloth_sim_set_targets (ClothSim * sim, guint model, const gdouble * now,
    const gdouble * next, const gdouble * velocity_now,
    const gdouble * velocity_next, const gdouble * weights,
    const gdouble * matrices, gdouble gain, gdouble damping, gdouble t_now,
    gdouble t_next)
{
  guint lane;
  const ClothSimGroup *group = group_of (sim, model, &lane);

  spread_targets (sim, now, next, velocity_now, velocity_next, weights,
      matrices);
  set_gain (sim, model, gain, damping);
  draw (sim, group, lane, 1, matrices != NULL, t_now, t_next);
}

/* @sim: a simulation
 * @now: where the vertices were observed at @t_now, n_vertices · 3, metres
 * @next: where they were at @t_next
 * @velocity_now: their velocities at @t_now, m/s
 * @velocity_next: their velocities at @t_next
 * @weights: one number of each vertex, 0 for those not observed
 * @matrices: (nullable): as there
 * @gains: (array): of each model, 1/s²
 * @dampings: (array): of each model, 1/s
 * @t_now: seconds
 * @t_next: seconds, after @t_now
 *
 * As cloth_sim_set_targets () for every model, in less time.
 */
void
cloth_sim_set_all_targets (ClothSim * sim, const gdouble * now,
    const gdouble * next, const gdouble * velocity_now,
    const gdouble * velocity_next, const gdouble * weights,
    const gdouble * matrices, const gdouble * gains, const gdouble * dampings,
    gdouble t_now, gdouble t_next)
{
  spread_targets (sim, now, next, velocity_now, velocity_next, weights,
      matrices);
  for (guint model = 0; model < sim->n_models; model++)
    set_gain (sim, model, gains[model], dampings[model]);
  for (guint i = 0; i < sim->n_groups; i++)
    draw (sim, &sim->groups[i], 0, sim->groups[i].n, matrices != NULL, t_now,
        t_next);
}

/* NULL: it is a covariance's inverse, or nothing. */
static const gchar *
find_fault_of_end (const ClothPullEnd * end)
{
  const gdouble *s = end->information;
  gdouble sum = s[0] + s[1] + s[2] + s[3] + s[4] + s[5], minors[3], det;
  gdouble trace = s[0] + s[1] + s[2];

  for (guint k = 0; k < 3; k++)
    sum += end->target[k] + end->velocity[k];
  if (!isfinite (sum))
    return "has a number that is not finite";
  minors[0] = s[1] * s[2] - s[3] * s[3];
  minors[1] = s[0] * s[2] - s[4] * s[4];
  minors[2] = s[0] * s[1] - s[5] * s[5];
  det = s[0] * minors[0] + s[5] * (s[3] * s[4] - s[5] * s[2]) +
      s[4] * (s[5] * s[3] - s[1] * s[4]);
  for (guint k = 0; k < 3; k++)
    if (s[k] < 0. || minors[k] < -ROUNDING * trace * trace)
      return "has an information that is negative in a direction";
  if (det < -ROUNDING * trace * trace * trace)
    return "has an information that is negative in a direction";
  return NULL;
}

static gboolean
add_pull (ClothSim * sim, const ClothPull * pull, guint index, GError ** error)
{
  const guint32 *kept = sim->numerics->kept;
  const gchar *fault = find_fault_of_end (&pull->now);
  gdouble sum = pull->weight[0] + pull->weight[1] + pull->weight[2];
  ClothPull own = *pull;

  if (!fault)
    fault = find_fault_of_end (&pull->next);
  if (!fault && !(fabs (sum - 1.) < 1e-6))
    fault = "has weights whose sum is not 1";
  for (guint i = 0; i < 3 && !fault; i++) {
    if (pull->corner[i] >= sim->n_vertices)
      fault = "is at a vertex that the cloth has not";
    else
      own.corner[i] = sim->body->particle[kept ? kept[pull->corner[i]] :
          pull->corner[i]];
  }
  if (fault) {
    g_set_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_PULL,
        "pull %u %s", index, fault);
    return FALSE;
  }
  g_array_append_val (sim->pulls, own);
  return TRUE;
}

/* @sim: a simulation
 * @pulls: (array length=n): what draws the cloth in an interval; all of them replace those
 *   before
 * @n: how many; 0: nothing draws it any more
 * @options: how they draw
 * @gains: (array): of each model, 1/s²; a model of gain and damping 0 is drawn by nothing
 * @dampings: (array): of each model, 1/s
 * @t_now: when the interval begins, s
 * @t_next: when it ends, s
 * @error: #ClothSimError
 *
 * The same pulls for every model, each with a strength of its own; beside
 * cloth_sim_set_targets (). On a mesh that a numerics effect made finer their points have the
 * mass of the scene's vertices. Pulls take part in the time step.
 *
 * Returns: %FALSE when a pull is impossible, or a strength asks for steps that are too short:
 *   then nothing draws the cloth
 */
gboolean
cloth_sim_set_pulls (ClothSim * sim, const ClothPull * pulls, guint n,
    const ClothPullOptions * options, const gdouble * gains,
    const gdouble * dampings, gdouble t_now, gdouble t_next, GError ** error)
{
  ClothPullOptions own = *options;
  gboolean sound = options->softening > 0. && isfinite (options->softening)
      && options->sigma > 0. && isfinite (options->sigma) && t_next > t_now;

  own.sigma *= sqrt (sim->lighter);
  g_array_set_size (sim->pulls, 0);
  if (!sound)
    g_set_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_PULL, "pulls need a "
        "softening and a sigma above 0, and an interval that is not empty; "
        "they are %g, %g m and %g to %g s", options->softening, options->sigma,
        t_now, t_next);
  for (guint i = 0; i < n && sound; i++)
    sound = add_pull (sim, &pulls[i], i, error);
  if (!sound)
    g_array_set_size (sim->pulls, 0);
  for (guint model = 0; model < sim->n_models; model++) {
    guint rank = sim->rank_of[model];

    sim->pull_gains[rank] = gains[model];
    sim->pull_dampings[rank] = dampings[model];
  }
  for (guint i = 0; i < sim->n_groups; i++)
    if (sim->groups[i].backend->set_pulls (sim->groups[i].lanes,
            (const ClothPull *) sim->pulls->data, sim->pulls->len, &own,
            sim->pull_gains + sim->groups[i].first,
            sim->pull_dampings + sim->groups[i].first,
            t_now - sim->body->epoch, t_next - sim->body->epoch))
      sim->stale = TRUE;
  if (!sound || n == 0)
    return sound;
  if (sim->stale)
    find_time_step (sim);
  if (sim->time_step >= SHORTEST_STEP)
    return TRUE;
  g_set_error (error, CLOTH_SIM_ERROR, CLOTH_SIM_ERROR_PULL,
      "pulls of this strength ask for steps of %.2g s; lower the gain or the "
      "damping, or soften the law", sim->time_step);
  return cloth_sim_set_pulls (sim, NULL, 0, options, gains, dampings, t_now,
      t_next, NULL) && FALSE;
}

/* @sim: a simulation
 * @model: index of a model
 * @paths: (nullable): where its clamps go, [n_frames][held][3] as in the scene, m; %NULL:
 *   where the scene has them
 *
 * Moves a model's clamps along other paths than its neighbours': for paths that nobody
 * logged and a fit has to find.
 */
void
cloth_sim_set_clamps (ClothSim * sim, guint model, const gdouble * paths)
{
  guint lane;
  const ClothSimGroup *group = group_of (sim, model, &lane);

  group->backend->set_paths (group->lanes, lane, paths);
}
