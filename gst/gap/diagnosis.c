/* The state of a diagnosis under way: its parts, its progress and what several stages ask of it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/diagnosis.h"

#include "gst/fit/recording/recording.h"

#include <string.h>

/* Tells the caller how far the diagnosis is, after each frame of each simulation. */
static gboolean
frame_done (gpointer data, gdouble share)
{
  ClothDiagnosis *d = data;
  gdouble at = d->from + (d->to - d->from) * d->each * share;

  if (share >= 1.)
    d->from = at;
  return !d->options->progress
      || d->options->progress (d->options->progress_data, at, d->what);
}

/* @d: (out caller-allocates): a diagnosis of nothing yet
 * @takes: (array length=n_takes): what was recorded; kept by reference
 * @n_takes: how many
 * @options: what else is given; kept by reference
 */
void
cloth_diagnosis_init (ClothDiagnosis * d, ClothTake ** takes, guint n_takes,
    const ClothGapOptions * options)
{
  *d = (ClothDiagnosis) {
  takes, n_takes, options};
  cloth_estimate_options_init (&d->study);
  d->study.rollout.seed = options->seed;
  d->study.rollout.threads = options->threads;
  d->study.rollout.progress = frame_done;
  d->study.rollout.data = d;
  d->result = cloth_gap_result_new ();
  d->recordings = g_ptr_array_new_with_free_func (
      (GDestroyNotify) cloth_recording_free);
  d->twins = g_ptr_array_new_with_free_func (
      (GDestroyNotify) cloth_recording_free);
  d->afters = g_ptr_array_new_with_free_func (
      (GDestroyNotify) cloth_recording_free);
  d->studies = g_ptr_array_new_with_free_func (
      (GDestroyNotify) cloth_sensitivities_free);
}

/* @d: a diagnosis
 *
 * Frees all that it holds.
 */
void
cloth_diagnosis_clear (ClothDiagnosis * d)
{
  g_clear_pointer (&d->studies, g_ptr_array_unref);
  cloth_model_free (d->model);
  cloth_candidates_free (d->candidates);
  g_free (d->precisions);
  g_free (d->all);
  cloth_power_spectrum_free (d->discrepancy_variance);
  g_free (d->clamps_off);
  for (guint i = 0; i < CLOTH_DIAGNOSIS_N_SUBSETS; i++)
    cloth_model_free (d->fitted[i]);
  cloth_model_free (d->with);
  cloth_energy_spectrum_free (d->before);
  cloth_energy_spectrum_free (d->after);
  cloth_energy_spectrum_free (d->floor);
  cloth_gap_result_free (d->result);
  g_free (d->nudged);
  for (guint i = 0; i < d->n_nulls; i++)
    cloth_windowed_gap_free (d->nulls[i]);
  g_free (d->what);
  for (guint i = 0; d->uncorrected && i < d->recordings->len; i++)
    g_free (d->uncorrected[i]);
  g_free (d->uncorrected);
  g_clear_pointer (&d->camera_effects, g_array_unref);
  g_clear_pointer (&d->measured, g_array_unref);
  g_clear_pointer (&d->recordings, g_ptr_array_unref);
  g_clear_pointer (&d->twins, g_ptr_array_unref);
  g_clear_pointer (&d->afters, g_ptr_array_unref);
}

/* @d: a diagnosis
 * @from: share of all the work that is done when the part begins
 * @to: share that is done when it ends
 * @each: share of the rest of the part that each simulation is
 * @what: what is being done, a few words
 *
 * Begins a part of the work.
 */
void
cloth_diagnosis_begin_part (ClothDiagnosis * d, gdouble from, gdouble to,
    gdouble each, const gchar * what)
{
  d->from = from;
  d->to = to;
  d->each = each;
  g_free (d->what);
  d->what = g_strdup (what);
}

/* @d: a diagnosis
 * @recording: which recording
 *
 * Returns: (nullable): what the cameras saw of it
 */
ClothObservations *
cloth_diagnosis_observations (const ClothDiagnosis * d, guint recording)
{
  const ClothGapOptions *o = d->options;
  ClothObservations *const *all = o->observations;

  if (recording >= d->n_takes + o->n_baselines) {
    all = o->hold_out_observations;
    recording -= d->n_takes + o->n_baselines;
  } else if (recording >= d->n_takes) {
    all = o->baseline_observations;
    recording -= d->n_takes;
  }
  return all ? all[recording] : NULL;
}

/* @d: a diagnosis
 *
 * Returns: whether cameras saw any of the takes
 */
gboolean
cloth_diagnosis_has_observations (const ClothDiagnosis * d)
{
  for (guint i = 0; i < d->n_takes; i++)
    if (cloth_diagnosis_observations (d, i))
      return TRUE;
  return FALSE;
}

/* @d: a diagnosis
 * @recording: which recording
 *
 * Returns: (nullable): what the user's simulator made of it, at its vertices and times
 */
ClothRecording *
cloth_diagnosis_twin (const ClothDiagnosis * d, guint recording)
{
  const guint end = d->n_takes + d->options->n_baselines;

  if (!d->twins->len || (recording >= d->n_takes && recording < end))
    return NULL;
  return g_ptr_array_index (d->twins, recording < end ? recording :
      recording - d->options->n_baselines);
}

/* @d: a diagnosis
 * @recording: which recording
 *
 * Returns: (nullable): what the user's simulator made of it with the effect added
 */
ClothRecording *
cloth_diagnosis_after (const ClothDiagnosis * d, guint recording)
{
  const guint begin = d->options->n_hold_outs ?
      d->n_takes + d->options->n_baselines : 0;

  return recording >= begin && recording - begin < d->afters->len ?
      g_ptr_array_index (d->afters, recording - begin) : NULL;
}

/* @d: a diagnosis
 *
 * Returns: how many of the camera faults are large enough to matter
 */
guint
cloth_diagnosis_count_faults (const ClothDiagnosis * d)
{
  guint n = 0;

  for (guint i = 0; i < d->n_faults; i++)
    n += !d->faults[i].small;
  return n;
}

/* @model: a model
 *
 * Returns: (transfer full): the model with the other force model
 */
ClothModel *
cloth_diagnosis_other_model (const ClothModel * model)
{
  ClothModel *other = cloth_model_copy (model);

  other->force_model = other->force_model == CLOTH_FORCE_MEMBRANE ?
      CLOTH_FORCE_MASS_SPRING : CLOTH_FORCE_MEMBRANE;
  return other;
}

/* @d: a diagnosis
 *
 * Returns: whether the user's simulator is run with the accepted effects, which judges them better than ours
 */
gboolean
cloth_diagnosis_runs_theirs (const ClothDiagnosis * d)
{
  return d->afters->len || d->options->simulator;
}

/* @d: a diagnosis
 * @subset: which of the accepted effects: bit k stands for the k-th
 * @directions: (out) (array): the free numbers and the directions of what is accepted, but those of
 *   what is there or not
 * @precisions: (out) (array): of their priors
 *
 * Returns: how many there are
 */
guint
cloth_diagnosis_list_accepted (const ClothDiagnosis * d, guint subset,
    guint * directions, gdouble * precisions)
{
  guint m = d->candidates->n_free;

  memcpy (directions, d->all, m * sizeof *directions);
  memcpy (precisions, d->precisions, m * sizeof *precisions);
  for (guint c = 0; c < d->n_accepted; c++)
    for (guint k = 0; (subset >> c & 1) && k < cloth_diagnosis_accepted (d,
            c)->n; k++) {
      const guint direction = cloth_diagnosis_accepted (d, c)->first + k;
      const ClothDirection *of =
          cloth_candidates_direction (d->candidates, direction);

      if (of->present)
        continue;
      directions[m] = direction;
      precisions[m++] = 1. / (of->prior * of->prior);
    }
  return m;
}

static gboolean
has_fault (const ClothRecording * recording, const ClothModel * model)
{
  ClothMeasurement m;

  return cloth_recording_find_measurement (recording, model, &m, NULL)
      && !cloth_measurement_is_null (&m);
}

/* @recording: a recording
 * @model: a model
 *
 * Returns: (transfer full) (nullable): the recording without what the model says was wrong with it;
 *   %NULL: nothing was
 */
ClothRecording *
cloth_diagnosis_correct (const ClothRecording * recording,
    const ClothModel * model)
{
  ClothMeasurement m;

  if (!has_fault (recording, model)
      || !cloth_recording_find_measurement (recording, model, &m, NULL))
    return NULL;
  return cloth_recording_correct (recording, &m);
}

/* @d: a diagnosis
 * @recording: what the models are held against
 * @models: (array length=n): models
 * @n: how many
 * @error: #ClothSimError
 *
 * Simulates each model twice: nudged to the recording all along, without what the model says was wrong
 * with it, and from there let go at the start of each window.
 *
 * Returns: (transfer full) (nullable) (array length=n): their distances from the recording
 */
ClothWindowedGap **
cloth_diagnosis_measure_windows (ClothDiagnosis * d,
    const ClothRecording * recording, const ClothModel * const *models,
    guint n, GError ** error)
{
  ClothWindowedGap **gaps = g_new0 (ClothWindowedGap *, n);
  g_autofree const ClothModel **some = g_new (const ClothModel *, n);
  g_autofree gboolean *done = g_new0 (gboolean, n);

  d->study.simulations += 2 * n;
  /* those that are held against the same recording run side by side */
  for (guint i = 0; i < n; i++) {
    g_autoptr (ClothRecording) corrected = NULL;
    ClothWindowedGap **here = NULL;
    guint n_some = 0;

    if (done[i])
      continue;
    corrected = cloth_diagnosis_correct (recording, models[i]);
    some[n_some++] = models[i];
    for (guint k = i + 1; k < n && !corrected; k++)
      if (!done[k] && !has_fault (recording, models[k]))
        some[n_some++] = models[k];
    here = cloth_windowed_gaps_new (corrected ? corrected : recording, some,
        n_some, CLOTH_DIAGNOSIS_WINDOW_GAIN, CLOTH_DIAGNOSIS_WINDOW_S,
        &d->study.rollout, error);
    if (!here) {
      for (guint k = 0; k < n; k++)
        cloth_windowed_gap_free (gaps[k]);
      g_free (gaps);
      return NULL;
    }
    for (guint k = i, at = 0; at < n_some; k++)
      if (models[k] == some[at] && !done[k]) {
        gaps[k] = here[at++];
        done[k] = TRUE;
      }
    g_free (here);
  }
  return gaps;
}
