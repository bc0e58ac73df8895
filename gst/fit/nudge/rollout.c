/* Simulations of a whole recording, nudged to it or let go in windows.
 *
 * Model: M x″ = F (x, x′; θ) + M g W (y − x) + M 2ζ√g W (y′ − x′), with y the recorded positions,
 *   g the gain of the observer, ζ its damping ratio and W 1 where a vertex was seen, else 0.
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
#include "gst/math/pool.h"

typedef struct
{
  const ClothRecording *recording;
  const ClothRolloutOptions *options;
  ClothSim *sim;
  guint n_models;
  gdouble *weights;             /* of the running frame */
  gdouble *dampings;            /* of each model's observer */
  ClothPool *pool;
  gsize row;                    /* numbers of a model */
  gdouble *x;                   /* of each model */
  gdouble *v;
  /* of the running call of report_frame () */
  ClothRolloutFrame on_frame;
  gpointer data;
  guint frame;
} Run;

static void
run_clear (Run * run)
{
  cloth_sim_free (run->sim);
  g_clear_pointer (&run->pool, cloth_pool_free);
  g_free (run->weights);
  g_free (run->dampings);
  g_free (run->x);
  g_free (run->v);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Run, run_clear);

static gboolean
run_init (Run * run, const ClothRecording * recording,
    const ClothModel * const *models, guint n_models,
    const ClothRolloutOptions * options, GError ** error)
{
  /* single numbers: steps of derivatives are far above their rounding */
  const ClothSimOptions sim_options = {
    TRUE, options->threads, CLOTH_SIMD_BEST, options->seed
  };

  *run = (Run) {
  recording, options, NULL, n_models,.row = 3 * (gsize) recording->n};
  run->sim = cloth_sim_new (recording->scene, models, n_models, &sim_options,
      error);
  if (!run->sim)
    return FALSE;
  run->pool = cloth_pool_new (options->threads);
  run->weights = g_new (gdouble, recording->n);
  run->dampings = g_new (gdouble, n_models);
  run->x = g_new (gdouble, run->row * n_models);
  run->v = g_new (gdouble, run->row);
  /* it moves from the first frame as it was seen to move */
  for (guint m = 0; m < n_models; m++)
    cloth_sim_set_state (run->sim, m, recording->y, recording->velocity,
        recording->times[0]);
  return TRUE;
}

static void
set_targets (Run * run, guint frame, const gdouble * gains)
{
  const ClothRecording *r = run->recording;
  guint next = MIN (frame + 1, r->n_frames - 1);
  gsize row = 3 * (gsize) r->n;

  for (guint v = 0; v < r->n; v++)
    run->weights[v] = r->seen[(gsize) frame * r->n + v] *
        r->seen[(gsize) next * r->n + v];
  for (guint m = 0; m < run->n_models; m++)
    run->dampings[m] = 2. * CLOTH_ROLLOUT_ZETA * sqrt (gains[m]);
  cloth_sim_set_all_targets (run->sim, r->y + frame * row, r->y + next * row,
      r->velocity + frame * row, r->velocity + next * row, run->weights, gains,
      run->dampings, r->times[frame], r->times[next]);
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
    cloth_sim_get_positions (run->sim, m, run->x + m * run->row);
  cloth_pool_run (run->pool, report_models, run, run->n_models);
  if (!run->options->progress
      || run->options->progress (run->options->data,
          (frame + 1.) / run->recording->n_frames))
    return TRUE;
  g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_CANCELLED,
      "the diagnosis was stopped");
  return FALSE;
}

/* A model is sound if all its simulations are. */
static void
note_diverged (Run * run, const ClothModel * const *models, guint n,
    gboolean * sound)
{
  for (guint m = 0; m < run->n_models; m++) {
    gdouble since_s;

    if (!sound[m % n]
        || cloth_sim_get_state (run->sim, m, &since_s) == CLOTH_SIM_OK)
      continue;
    sound[m % n] = FALSE;
    if (run->options->failed)
      run->options->failed (run->options->data, run->recording, models[m % n],
          since_s);
  }
}

/* @recording: what draws them
 * @models: (array length=n_models): the models
 * @gains: (array length=n_models): of each model's observer, 1/s²
 * @n_models: how many
 * @options: how to simulate
 * @on_frame: called for each model in each frame
 * @data: for @on_frame
 * @sound: (out) (array length=n_models): which models did not diverge
 * @error: #ClothSimError, or #ClothFitError when it was stopped
 */
gboolean
cloth_rollout_nudged (const ClothRecording * recording,
    const ClothModel * const *models, const gdouble * gains, guint n_models,
    const ClothRolloutOptions * options, ClothRolloutFrame on_frame,
    gpointer data, gboolean * sound, GError ** error)
{
  g_auto (Run) run = { 0 };

  if (!run_init (&run, recording, models, n_models, options, error))
    return FALSE;
  for (guint m = 0; m < n_models; m++)
    sound[m] = TRUE;
  if (!report_frame (&run, 0, on_frame, data, error))
    return FALSE;
  for (guint frame = 0; frame + 1 < recording->n_frames; frame++) {
    set_targets (&run, frame, gains);
    cloth_sim_advance (run.sim, recording->times[frame + 1]);
    if (!report_frame (&run, frame + 1, on_frame, data, error))
      return FALSE;
  }
  note_diverged (&run, models, n_models, sound);
  return TRUE;
}

/* @recording: what is compared with
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
cloth_rollout_windows (const ClothRecording * recording,
    const ClothModel * const *models, guint n_models, gdouble gain,
    gdouble window_s, const ClothRolloutOptions * options,
    ClothRolloutFrame on_frame, gpointer data, gboolean * sound,
    GError ** error)
{
  g_auto (Run) run = { 0 };
  /* side by side: those let go, those nudged */
  g_autofree const ClothModel **both = g_new (const ClothModel *, 2 * n_models);
  g_autofree gdouble *gains = g_new0 (gdouble, 2 * n_models);
  g_autofree guint *windows = cloth_rollout_list_windows (recording, window_s);

  for (guint m = 0; m < n_models; m++) {
    both[m] = both[n_models + m] = models[m];
    gains[n_models + m] = gain;
    sound[m] = TRUE;
  }
  if (!run_init (&run, recording, both, 2 * n_models, options, error))
    return FALSE;
  for (guint frame = 0; frame + 1 < recording->n_frames; frame++) {
    if (frame && windows[frame + 1] != windows[frame]) {
      note_diverged (&run, models, n_models, sound);
      for (guint m = 0; m < n_models; m++) {
        cloth_sim_get_positions (run.sim, n_models + m, run.x);
        cloth_sim_get_velocities (run.sim, n_models + m, run.v);
        cloth_sim_set_state (run.sim, m, run.x, run.v, recording->times[frame]);
      }
    }
    set_targets (&run, frame, gains);
    cloth_sim_advance (run.sim, recording->times[frame + 1]);
    if (!report_frame (&run, frame + 1, on_frame, data, error))
      return FALSE;
  }
  note_diverged (&run, models, n_models, sound);
  return TRUE;
}

/* @recording: a recording
 * @window_s: length of the windows, s
 *
 * A window begins at the frame where the one before ends.
 *
 * Returns: (transfer full) (array): the window that leads to each frame; of the first
 *   frame that of the second
 */
guint *
cloth_rollout_list_windows (const ClothRecording * recording, gdouble window_s)
{
  guint *windows = g_new0 (guint, recording->n_frames);
  guint begin = 0;

  for (guint frame = 1; frame < recording->n_frames; frame++) {
    gboolean over = frame > begin + 1 && !(recording->times[frame] -
        recording->times[begin] < window_s + 1e-9);

    windows[frame] = windows[frame - 1] + over;
    if (over)
      begin = frame - 1;
  }
  return windows;
}
