/* Simulations of a recorded scene.
 *
 * The observer is that of data assimilation: weak springs of stiffness gain·m and damping
 * 2ζ√gain·m draw each seen vertex to where it was seen (nudging). What it lacks in force
 * shows as a steady distance, and chaos is held down.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/rollout.h"

#include <math.h>
#include <string.h>

typedef struct
{
  const ClothRecording *recording;
  ClothSim *sim;
  guint n_models;
  gdouble *weights;             /* of the running frame */
  gdouble *x, *v;
} Run;

static void
run_clear (Run * run)
{
  cloth_sim_free (run->sim);
  g_free (run->weights);
  g_free (run->x);
  g_free (run->v);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Run, run_clear)
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
  recording, NULL, n_models};
  run->sim = cloth_sim_new (recording->scene, models, n_models, &sim_options,
      error);
  if (!run->sim)
    return FALSE;
  run->weights = g_new (gdouble, recording->n);
  run->x = g_new (gdouble, 3 * (gsize) recording->n);
  run->v = g_new (gdouble, 3 * (gsize) recording->n);
  /* it moves from the first frame as it was seen to move */
  for (guint m = 0; m < n_models; m++)
    cloth_sim_set_state (run->sim, m, recording->y, recording->velocity,
        recording->times[0]);
  return TRUE;
}

static void
nudge (Run * run, guint frame, const gdouble * gains)
{
  const ClothRecording *r = run->recording;
  guint next = MIN (frame + 1, r->n_frames - 1);
  gsize row = 3 * (gsize) r->n;

  for (guint v = 0; v < r->n; v++)
    run->weights[v] = r->seen[(gsize) frame * r->n + v] *
        r->seen[(gsize) next * r->n + v];
  for (guint m = 0; m < run->n_models; m++)
    cloth_sim_set_targets (run->sim, m, r->y + frame * row, r->y + next * row,
        r->velocity + frame * row, r->velocity + next * row, run->weights,
        gains[m], 2. * CLOTH_ROLLOUT_ZETA * sqrt (gains[m]), r->times[frame],
        r->times[next]);
}

static void
tell (Run * run, guint frame, ClothRolloutFrame each, gpointer data)
{
  for (guint m = 0; m < run->n_models; m++) {
    cloth_sim_get_positions (run->sim, m, run->x);
    each (data, m, frame, run->x);
  }
}

static void
judge (Run * run, gboolean * sound)
{
  for (guint m = 0; m < run->n_models; m++)
    sound[m] = sound[m]
        && cloth_sim_get_state (run->sim, m, NULL) == CLOTH_SIM_OK;
}

/**
 * cloth_rollout_nudged:
 * @recording: what draws them
 * @models: (array length=n_models): the models
 * @gains: (array length=n_models): of each model's observer, 1/s²
 * @n_models: how many
 * @options: how to simulate
 * @each: called for each model in each frame, from one thread
 * @data: for @each
 * @sound: (out) (array length=n_models): which models did not diverge
 * @error: #ClothSimError
 *
 * Since: 0.1
 */
gboolean
cloth_rollout_nudged (const ClothRecording * recording,
    const ClothModel * const *models, const gdouble * gains, guint n_models,
    const ClothRolloutOptions * options, ClothRolloutFrame each,
    gpointer data, gboolean * sound, GError ** error)
{
  g_auto (Run) run = { 0 };

  if (!run_init (&run, recording, models, n_models, options, error))
    return FALSE;
  for (guint m = 0; m < n_models; m++)
    sound[m] = TRUE;
  tell (&run, 0, each, data);
  for (guint frame = 0; frame + 1 < recording->n_frames; frame++) {
    nudge (&run, frame, gains);
    cloth_sim_advance (run.sim, recording->times[frame + 1]);
    tell (&run, frame + 1, each, data);
  }
  judge (&run, sound);
  return TRUE;
}

/**
 * cloth_rollout_windows:
 * @recording: what is compared with
 * @models: (array length=n_models): the models
 * @n_models: how many
 * @gain: of the observer that leads up to each window, 1/s²
 * @window_s: length of the windows, s
 * @options: how to simulate
 * @each: called for each model in each frame of each window but its first
 * @data: for @each
 * @sound: (out) (array length=n_models): which models did not diverge
 * @error: #ClothSimError
 *
 * The take in windows, each simulated freely from the state that nudging has reached at
 * its start.
 *
 * Since: 0.1
 */
gboolean
cloth_rollout_windows (const ClothRecording * recording,
    const ClothModel * const *models, guint n_models, gdouble gain,
    gdouble window_s, const ClothRolloutOptions * options,
    ClothRolloutFrame each, gpointer data, gboolean * sound, GError ** error)
{
  g_auto (Run) led = { 0 }, let_go = { 0 };
  g_autofree gdouble *gains = g_new (gdouble, n_models);
  g_autofree gdouble *none = g_new0 (gdouble, n_models);
  guint frame = 0;

  if (!run_init (&led, recording, models, n_models, options, error)
      || !run_init (&let_go, recording, models, n_models, options, error))
    return FALSE;
  for (guint m = 0; m < n_models; m++) {
    gains[m] = gain;
    sound[m] = TRUE;
  }
  while (frame + 1 < recording->n_frames) {
    guint begin = frame;

    for (guint m = 0; m < n_models; m++) {
      cloth_sim_get_positions (led.sim, m, let_go.x);
      cloth_sim_get_velocities (led.sim, m, let_go.v);
      cloth_sim_set_state (let_go.sim, m, let_go.x, let_go.v,
          recording->times[begin]);
    }
    while (frame + 1 < recording->n_frames && (frame == begin
            || recording->times[frame + 1] - recording->times[begin] <
            window_s + 1e-9)) {
      nudge (&led, frame, gains);
      cloth_sim_advance (led.sim, recording->times[frame + 1]);
      nudge (&let_go, frame, none);
      cloth_sim_advance (let_go.sim, recording->times[frame + 1]);
      tell (&let_go, ++frame, each, data);
    }
    judge (&led, sound);
    judge (&let_go, sound);
  }
  return TRUE;
}
