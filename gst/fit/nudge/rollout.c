/* Simulations of a whole recording, nudged to it or let go in windows.
 *
 * Model: M x″ = F (x, x′; θ) + M g W (y − x) + M 2ζ√g W (y′ − x′), with y the recorded positions,
 *   g the gain of the observer, ζ its damping ratio and W 1 where a vertex was seen, else 0; where
 *   the noise differs from direction to direction W is a matrix, ClothRecordingNoise's draw.
 * Assumption: between two frames y and y′ lie on straight lines. The springs are so weak
 *   that forces which the model lacks show as a distance, and so strong that run-to-run
 *   variability does not grow.
 * Formula: a missing force f per mass shows as a steady distance f/g. The simulation forgets
 *   its past with the time 1/(ζ√g). In windows the gap is that of a free simulation from the
 *   nudged state at the window's start.
 * Reference: Hoke and Anthes 1976 (nudging); Kalnay, Atmospheric Modeling, Data Assimilation and
 *   Predictability, 2003, section 5.6.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/nudge/rollout.h"

#include <math.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/fit/recording/recording.h"
#include "gst/math/pool.h"

/* Models that are computed side by side, as narrow lanes have them. */
#define MODELS_A_GROUP 8.
/* A window's last frame may be so much of a frame late. */
#define LATE 0.25

/* Models that one ClothSim can step together: those that agree in what it shares, and need steps of
 * about the same length, as it takes the shortest for all. */
typedef struct
{
  ClothSim *sim;
  guint n;
  guint *of;                    /* which of all models each is */
  guint first;                  /* of all models */
  guint octave;                 /* how often their steps halve the longest of all models */
  gdouble step;                 /* the shortest that one of them needs, s */
  const ClothRecording *shared; /* what all of them are drawn to; NULL: they differ */
  gdouble *gains;
  gdouble *dampings;
} Batch;

typedef struct
{
  const ClothRecording *const *targets; /* of each model */
  const ClothModel *const *models;
  guint n_models;
  const ClothRolloutOptions *options;
  guint n_batches;
  Batch *batches;
  guint *batch_of;              /* of each model */
  guint *rank_of;               /* of each model: which of its batch */
  ClothPool *pool;
  gsize row;                    /* numbers of a model */
  gdouble *weights;             /* [model][vertex], of the running frame */
  gdouble *matrices;            /* [model][vertex][6], likewise */
  gdouble *x;                   /* [model][vertex][3] */
  guint frame;                  /* that is running */
  gboolean nudged;
  /* of the running call of report_frame () */
  ClothRolloutFrame on_frame;
  gpointer data;
} Run;

static void
run_clear (Run * run)
{
  for (guint b = 0; b < run->n_batches; b++) {
    cloth_sim_free (run->batches[b].sim);
    g_free (run->batches[b].of);
    g_free (run->batches[b].gains);
    g_free (run->batches[b].dampings);
  }
  g_free (run->batches);
  g_free (run->batch_of);
  g_free (run->rank_of);
  g_clear_pointer (&run->pool, cloth_pool_free);
  g_free (run->weights);
  g_free (run->matrices);
  g_free (run->x);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Run, run_clear);

/* The longest step that each model could take by itself, s; of one that can't be simulated none. */
typedef struct
{
  const Run *run;
  gdouble *each;
} Steps;

static void
find_steps (gpointer data, guint begin, guint end, guint worker)
{
  const Steps *steps = data;
  const Run *run = steps->run;
  const ClothSimOptions options = {
    TRUE, 1, CLOTH_SIMD_BEST, run->options->seed
  };

  for (guint m = begin; m < end; m++) {
    g_autoptr (ClothSim) sim = cloth_sim_new (run->targets[0]->scene,
        &run->models[m], 1, &options, NULL);

    steps->each[m] = sim ? cloth_sim_get_time_step (sim) : 0.;
  }
}

/* What a batch costs: so many groups of models step side by side, so often a second. */
static gdouble
cost_of (guint n_models, gdouble step)
{
  return step > 0. ? ceil (n_models / MODELS_A_GROUP) / step : 0.;
}

/* Models that need steps much shorter than the others' would bind these too: they are by themselves
 * where that costs less. How models are parted is a matter of the models alone, not of the machine. */
static void
merge_batches (Run * run)
{
  for (guint a = 0; a < run->n_batches; a++)
    for (guint b = a + 1; b < run->n_batches; b++) {
      Batch *one = &run->batches[a], *other = &run->batches[b];
      const gdouble step = MIN (one->step, other->step);

      if (!cloth_sim_can_share (run->models[one->first],
              run->models[other->first])
          || cost_of (one->n + other->n, step) > cost_of (one->n, one->step) +
          cost_of (other->n, other->step))
        continue;
      one->n += other->n;
      one->step = step;
      for (guint m = 0; m < run->n_models; m++)
        run->batch_of[m] = run->batch_of[m] == b ? a : run->batch_of[m] > b ?
            run->batch_of[m] - 1 : run->batch_of[m];
      memmove (other, other + 1, (--run->n_batches - b) * sizeof *other);
      b = a;
    }
}

/* The batch that each model is in: those that can share a simulation, and need steps within an
 * octave of each other. */
static void
list_batches (Run * run, const gdouble * steps)
{
  gdouble longest = 0.;

  for (guint m = 0; m < run->n_models; m++)
    longest = MAX (longest, steps[m]);
  for (guint m = 0; m < run->n_models; m++) {
    const guint octave = steps[m] > 0. ?
        (guint) floor (log2 (longest / steps[m])) : 0;
    guint b = 0;
    Batch *batch;

    while (b < run->n_batches && (run->batches[b].octave != octave
            || !cloth_sim_can_share (run->models[run->batches[b].first],
                run->models[m])))
      b++;
    batch = &run->batches[b];
    if (b == run->n_batches) {
      run->n_batches++;
      *batch = (Batch) {
        .first = m,.octave = octave,.step = steps[m]
      };
    }
    batch->n++;
    batch->step = MIN (batch->step, steps[m]);
    run->batch_of[m] = b;
  }
  merge_batches (run);
}

/* Which of all models each batch has, and what all of these are drawn to. */
static void
fill_batches (Run * run)
{
  for (guint b = 0; b < run->n_batches; b++) {
    Batch *batch = &run->batches[b];

    batch->of = g_new (guint, batch->n);
    batch->shared = run->targets[batch->first];
    batch->n = 0;
  }
  for (guint m = 0; m < run->n_models; m++) {
    Batch *batch = &run->batches[run->batch_of[m]];

    if (batch->shared != run->targets[m])
      batch->shared = NULL;
    run->rank_of[m] = batch->n;
    batch->of[batch->n++] = m;
  }
}

/* Those that do are stepped one after the other by all threads, the others side by side. */
static gboolean
has_several_groups (const Batch * batch)
{
  return batch->n > MODELS_A_GROUP;
}

static gboolean
start_batch (Run * run, Batch * batch, const gdouble * gains, GError ** error)
{
  /* single numbers: steps of derivatives are far above their rounding */
  const ClothSimOptions options = {
    TRUE, has_several_groups (batch) ? run->options->threads : 1,
    CLOTH_SIMD_BEST, run->options->seed
  };
  g_autofree const ClothModel **models = g_new (const ClothModel *, batch->n);
  g_autofree gdouble *start = g_new (gdouble, run->row);
  g_autofree gdouble *speeds = g_new (gdouble, run->row);

  for (guint i = 0; i < batch->n; i++)
    models[i] = run->models[batch->of[i]];
  batch->sim = cloth_sim_new (run->targets[0]->scene, models, batch->n,
      &options, error);
  if (!batch->sim)
    return FALSE;
  batch->gains = g_new0 (gdouble, batch->n);
  batch->dampings = g_new0 (gdouble, batch->n);
  for (guint i = 0; i < batch->n; i++) {
    const ClothRecording *r = run->targets[batch->of[i]];

    batch->gains[i] = gains ? gains[batch->of[i]] : 0.;
    batch->dampings[i] = 2. * CLOTH_ROLLOUT_ZETA * sqrt (batch->gains[i]);
    /* it moves from the first frame as it was seen to move */
    cloth_recording_find_start (r, start, speeds);
    if (r->scene != run->targets[0]->scene)
      cloth_sim_set_clamps (batch->sim, i, r->scene->clamps);
    cloth_sim_set_state (batch->sim, i, start, speeds, r->times[0]);
  }
  return TRUE;
}

/* @gains: (nullable): of each model's observer; %NULL: nothing draws them */
static gboolean
run_init (Run * run, const ClothRecording * const *targets,
    const ClothModel * const *models, const gdouble * gains, guint n_models,
    const ClothRolloutOptions * options, GError ** error)
{
  const guint n = targets[0]->n;
  g_autofree gdouble *each = g_new (gdouble, n_models);
  Steps steps = { run, each };

  *run = (Run) {
  targets, models, n_models, options,.row = 3 * (gsize) n,.nudged =
        gains != NULL};
  run->pool = cloth_pool_new (options->threads);
  run->batches = g_new0 (Batch, n_models);
  run->batch_of = g_new (guint, n_models);
  run->rank_of = g_new (guint, n_models);
  run->weights = g_new (gdouble, (gsize) n * n_models);
  run->matrices = g_new (gdouble, 6 * (gsize) n * n_models);
  run->x = g_new (gdouble, run->row * n_models);
  cloth_pool_run_one_by_one (run->pool, find_steps, &steps, n_models);
  list_batches (run, each);
  fill_batches (run);
  for (guint b = 0; b < run->n_batches; b++)
    if (!start_batch (run, &run->batches[b], gains, error))
      return FALSE;
  return TRUE;
}

/* Weights of the running frame: 1 where a vertex is seen in it and in the next. */
static void
find_weights (const ClothRecording * r, guint frame, gdouble * weights)
{
  for (guint v = 0; v < r->n; v++)
    weights[v] = r->seen[(gsize) frame * r->n + v] *
        r->seen[((gsize) frame + 1) * r->n + v];
}

/* Along which directions the running frame draws: those of it or of the next one, whichever tells of
 * fewer. Along the others a target is where the cloth was taken to be. */
static void
find_matrices (const ClothRecording * r, guint frame, gdouble * matrices)
{
  const gdouble *now = r->noise->draw + 6 * (gsize) frame * r->n;
  const gdouble *next = now + 6 * (gsize) r->n;

  for (gsize i = 0; i < 6 * (gsize) r->n; i += 6)
    memcpy (matrices + i, now[i] + now[i + 1] + now[i + 2] <=
        next[i] + next[i + 1] + next[i + 2] ? now + i : next + i,
        6 * sizeof *matrices);
}

static void
set_targets (Run * run, Batch * batch)
{
  for (guint i = 0; i < (batch->shared ? 1 : batch->n); i++) {
    const ClothRecording *r = run->targets[batch->of[i]];
    gdouble *weights = run->weights + (gsize) batch->of[i] * r->n;
    gdouble *matrices = r->noise ?
        run->matrices + 2 * (gsize) batch->of[i] * run->row : NULL;
    const gdouble *y = (r->targets ? r->targets : r->y) + run->frame * run->row;
    const gdouble *velocity = r->velocity + run->frame * run->row;

    find_weights (r, run->frame, weights);
    if (matrices)
      find_matrices (r, run->frame, matrices);
    if (batch->shared)
      cloth_sim_set_all_targets (batch->sim, y, y + run->row, velocity,
          velocity + run->row, weights, matrices, batch->gains,
          batch->dampings, r->times[run->frame], r->times[run->frame + 1]);
    else
      cloth_sim_set_targets (batch->sim, i, y, y + run->row, velocity,
          velocity + run->row, weights, matrices, batch->gains[i],
          batch->dampings[i], r->times[run->frame], r->times[run->frame + 1]);
  }
}

static void
advance_batch (Run * run, Batch * batch)
{
  if (run->nudged)
    set_targets (run, batch);
  cloth_sim_advance (batch->sim, run->targets[0]->times[run->frame + 1]);
}

static void
advance_small_batches (gpointer data, guint begin, guint end, guint worker)
{
  Run *run = data;

  for (guint b = begin; b < end; b++)
    if (!has_several_groups (&run->batches[b]))
      advance_batch (run, &run->batches[b]);
}

/* To the next frame. */
static void
advance (Run * run, guint frame)
{
  run->frame = frame;
  for (guint b = 0; b < run->n_batches; b++)
    if (has_several_groups (&run->batches[b]))
      advance_batch (run, &run->batches[b]);
  cloth_pool_run_one_by_one (run->pool, advance_small_batches, run,
      run->n_batches);
}

static ClothSim *
sim_of (const Run * run, guint model)
{
  return run->batches[run->batch_of[model]].sim;
}

static void
report_models (gpointer data, guint begin, guint end, guint worker)
{
  Run *run = data;

  for (guint m = begin; m < end; m++)
    run->on_frame (run->data, m, run->frame, run->x + m * run->row);
}

static gboolean
report_frame (Run * run, guint frame, ClothRolloutFrame on_frame, gpointer data,
    GError ** error)
{
  run->on_frame = on_frame;
  run->data = data;
  run->frame = frame;
  for (guint m = 0; m < run->n_models; m++)
    cloth_sim_get_positions (sim_of (run, m), run->rank_of[m],
        run->x + m * run->row);
  cloth_pool_run (run->pool, report_models, run, run->n_models);
  if (!run->options->progress
      || run->options->progress (run->options->data,
          (frame + 1.) / run->targets[0]->n_frames))
    return TRUE;
  g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_CANCELLED,
      "the diagnosis was stopped");
  return FALSE;
}

/* The first @n models, and those that are simulated a second time behind them: a model is
 * sound if all its simulations are. */
static void
note_diverged (Run * run, guint n, gboolean * sound)
{
  for (guint m = 0; m < run->n_models; m++) {
    gdouble since_s;

    if (!sound[m % n]
        || cloth_sim_get_state (sim_of (run, m), run->rank_of[m],
            &since_s) == CLOTH_SIM_OK)
      continue;
    sound[m % n] = FALSE;
    if (run->options->failed)
      run->options->failed (run->options->data, run->targets[m],
          run->models[m], since_s);
  }
}

/* All frames, one after the other. */
static gboolean
run_through (Run * run, ClothRolloutFrame on_frame, gpointer data,
    gboolean * sound, GError ** error)
{
  for (guint m = 0; m < run->n_models; m++)
    sound[m] = TRUE;
  if (!report_frame (run, 0, on_frame, data, error))
    return FALSE;
  for (guint frame = 0; frame + 1 < run->targets[0]->n_frames; frame++) {
    advance (run, frame);
    if (!report_frame (run, frame + 1, on_frame, data, error))
      return FALSE;
  }
  note_diverged (run, run->n_models, sound);
  return TRUE;
}

static const ClothRecording **
repeat (const ClothRecording * recording, guint n)
{
  const ClothRecording **targets = g_new (const ClothRecording *, n);

  for (guint i = 0; i < n; i++)
    targets[i] = recording;
  return targets;
}

/* @targets: (array length=n_models): what draws each model, and where it starts. They are of
 *   one scene, that of the first, with the same times; positions, velocities, what was
 *   seen and the paths of the clamps are their own
 * @models: (array length=n_models): the models
 * @gains: (array length=n_models): of each model's observer, 1/s²
 * @n_models: how many, at least 1
 * @options: how to simulate
 * @on_frame: called for each model in each frame
 * @data: for @on_frame
 * @sound: (out) (array length=n_models): which models did not diverge
 * @error: #ClothSimError, or #ClothFitError when it was stopped
 *
 * Models may differ in all that a model has. Those that share force model, integrator,
 * steps and mesh are computed side by side, which takes far less time.
 */
gboolean
cloth_rollout_nudged (const ClothRecording * const *targets,
    const ClothModel * const *models, const gdouble * gains, guint n_models,
    const ClothRolloutOptions * options, ClothRolloutFrame on_frame,
    gpointer data, gboolean * sound, GError ** error)
{
  g_auto (Run) run = { 0 };

  return run_init (&run, targets, models, gains, n_models, options, error)
      && run_through (&run, on_frame, data, sound, error);
}

typedef struct
{
  gdouble *paths;
  gsize row, all;               /* numbers of a frame, of a path */
} Paths;

static void
keep_paths (gpointer data, guint model, guint frame, const gdouble * positions)
{
  const Paths *p = data;

  memcpy (p->paths + model * p->all + frame * p->row, positions,
      p->row * sizeof *p->paths);
}

/* @targets: (array length=n): what draws the model, and where it starts, as cloth_rollout_nudged () has it
 * @n: how many, at least 1
 * @model: the model
 * @gain: of its observer, 1/s²
 * @options: how to simulate
 * @paths: (out) (array): where each target has the model in each frame, [n][n_frames][vertices][3], m
 * @sound: (out) (array length=n): where it did not diverge
 * @error: #ClothSimError, or #ClothFitError when it was stopped
 *
 * cloth_rollout_nudged () of one model, kept.
 */
gboolean
cloth_rollout_follow (const ClothRecording * const *targets, guint n,
    const ClothModel * model, gdouble gain,
    const ClothRolloutOptions * options, gdouble * paths, gboolean * sound,
    GError ** error)
{
  const gsize row = 3 * (gsize) targets[0]->n;
  g_autofree const ClothModel **models = g_new (const ClothModel *, n);
  g_autofree gdouble *gains = g_new (gdouble, n);
  Paths keep = { paths, row, row * targets[0]->n_frames };

  for (guint i = 0; i < n; i++) {
    models[i] = model;
    gains[i] = gain;
  }
  return cloth_rollout_nudged (targets, models, gains, n, options, keep_paths,
      &keep, sound, error);
}

/* @recording: a recording
 * @lead_s: how long a model is drawn to it, s
 *
 * Returns: so many frames
 */
guint
cloth_rollout_count_led (const ClothRecording * recording, gdouble lead_s)
{
  guint frame = 0;

  while (frame < recording->n_frames
      && recording->times[frame] < recording->times[0] + lead_s)
    frame++;
  return frame;
}

/* @recording: what draws the models at first
 * @models: (array length=n_models): the models
 * @gains: (array length=n_models): of each model's observer, 1/s²
 * @n_models: how many, at least 1
 * @lead_s: how long it draws, s
 * @options: how to simulate
 * @on_frame: called for each model in each frame
 * @data: for @on_frame
 * @sound: (out) (array length=n_models): which models did not diverge
 * @error: #ClothSimError, or #ClothFitError when it was stopped
 *
 * As cloth_rollout_nudged (), but then nothing draws the models. Noise of the first frame would shake the cloth
 * as nothing real does: the observer leads them past it.
 */
gboolean
cloth_rollout_led (const ClothRecording * recording,
    const ClothModel * const *models, const gdouble * gains, guint n_models,
    gdouble lead_s, const ClothRolloutOptions * options,
    ClothRolloutFrame on_frame, gpointer data, gboolean * sound,
    GError ** error)
{
  const gsize begin = (gsize) cloth_rollout_count_led (recording, lead_s) *
      recording->n;
  /* nobody sees the cloth any more */
  g_autofree gdouble *seen =
      g_new0 (gdouble, (gsize) recording->n * recording->n_frames);
  ClothRecording led = *recording;
  g_autofree const ClothRecording **targets = repeat (&led, n_models);

  memcpy (seen, recording->seen, begin * sizeof *seen);
  led.seen = seen;
  return cloth_rollout_nudged (targets, models, gains, n_models, options,
      on_frame, data, sound, error);
}

/* @recording: where it starts: its first positions and velocities, its scene and times
 * @models: (array length=n_models): the models
 * @n_models: how many, at least 1
 * @options: how to simulate
 * @on_frame: called for each model in each frame
 * @data: for @on_frame
 * @sound: (out) (array length=n_models): which models did not diverge
 * @error: #ClothSimError, or #ClothFitError when it was stopped
 *
 * As cloth_rollout_nudged (), but nothing draws the models: what the recording shows later
 * doesn't matter.
 */
gboolean
cloth_rollout_free (const ClothRecording * recording,
    const ClothModel * const *models, guint n_models,
    const ClothRolloutOptions * options, ClothRolloutFrame on_frame,
    gpointer data, gboolean * sound, GError ** error)
{
  g_auto (Run) run = { 0 };
  g_autofree const ClothRecording **targets = repeat (recording, n_models);

  return run_init (&run, targets, models, NULL, n_models, options, error)
      && run_through (&run, on_frame, data, sound, error);
}

/* @targets: (array length=n_models): what leads each model up to its windows, as
 *   cloth_rollout_nudged () has it
 * @models: (array length=n_models): the models
 * @n_models: how many
 * @gain: of the observer that leads up to each window, 1/s²
 * @window_s: length of the windows, s
 * @options: how to simulate
 * @on_frame: called for each model in each frame of each window but its first; and in all
 *   frames but the first for the model nudged all along, as @n_models + its index
 * @data: for @on_frame
 * @sound: (out) (array length=n_models): which models did not diverge
 * @error: #ClothSimError, or #ClothFitError when it was stopped
 *
 * The take in windows, each simulated freely from the state that nudging has reached at
 * its start.
 */
gboolean
cloth_rollout_windows (const ClothRecording * const *targets,
    const ClothModel * const *models, guint n_models, gdouble gain,
    gdouble window_s, const ClothRolloutOptions * options,
    ClothRolloutFrame on_frame, gpointer data, gboolean * sound,
    GError ** error)
{
  g_auto (Run) run = { 0 };
  /* side by side: those let go, those nudged */
  g_autofree const ClothRecording **twice =
      g_new (const ClothRecording *, 2 * n_models);
  g_autofree const ClothModel **both = g_new (const ClothModel *, 2 * n_models);
  g_autofree gdouble *gains = g_new0 (gdouble, 2 * n_models);
  g_autofree guint *windows = cloth_rollout_list_windows (targets[0], window_s);

  for (guint m = 0; m < n_models; m++) {
    twice[m] = twice[n_models + m] = targets[m];
    both[m] = both[n_models + m] = models[m];
    gains[n_models + m] = gain;
    sound[m] = TRUE;
  }
  if (!run_init (&run, twice, both, gains, 2 * n_models, options, error))
    return FALSE;
  for (guint frame = 0; frame + 1 < targets[0]->n_frames; frame++) {
    if (frame && windows[frame + 1] != windows[frame]) {
      note_diverged (&run, n_models, sound);
      for (guint m = 0; m < n_models; m++) {
        guint nudged = n_models + m;

        cloth_sim_copy_state (sim_of (&run, m), run.rank_of[m],
            sim_of (&run, nudged), run.rank_of[nudged]);
      }
    }
    advance (&run, frame);
    if (!report_frame (&run, frame + 1, on_frame, data, error))
      return FALSE;
  }
  note_diverged (&run, n_models, sound);
  return TRUE;
}

/* @recording: a recording
 * @window_s: length of the windows, s
 *
 * A window begins at the frame where the one before ends; its last frame may be a little late.
 *
 * Returns: (transfer full) (array): the window that leads to each frame; of the first
 *   frame that of the second
 */
guint *
cloth_rollout_list_windows (const ClothRecording * recording, gdouble window_s)
{
  guint *windows = g_new0 (guint, recording->n_frames);
  const gdouble slack = LATE * cloth_recording_get_frame_s (recording);
  guint begin = 0;

  for (guint frame = 1; frame < recording->n_frames; frame++) {
    gboolean over = frame > begin + 1 && !(recording->times[frame] -
        recording->times[begin] < window_s + slack);

    windows[frame] = windows[frame - 1] + over;
    if (over)
      begin = frame - 1;
  }
  return windows;
}
