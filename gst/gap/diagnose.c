/* The diagnosis.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/diagnosis.h"

#include "config.h"

#include <math.h>
#include <string.h>

#include "gst/gap/inputs.h"
#include "gst/file/hash.h"

/* Version of the priors and thresholds: a change of either changes probabilities. */
#define PRIORS "4"

/* Squared gap of the nearest over that of the likeliest from which on it is taken. */
#define NEARER 0.8
/* Simulations of the fit of the free numbers. */
#define N_FIT 6
/* Free numbers that were fitted on baselines give way by this share of their standard
 * deviations, and by no more than so many such shares: else they would take the place of
 * what is missing. */
#define FROZEN_SHARE 0.5
#define FROZEN_REACH 2.
/* A number is at the end of its range when it is this share of it away. */
#define AT_END 1e-3
/* Of a simulation, for each frame. */
#define MOST_STEPS 2e4
/* On takes that move otherwise than a baseline, what the baseline asks for of an effect
 * itself is taken off the effect's evidence so many times; without a baseline, what the
 * difference of the two force models asks for. */
#define NULL_SHARE 1.5
/* And this often the largest of them is the evidence that any effect must have there. */
#define NULL_MARGIN 2.

static void
diagnosis_clear (ClothDiagnosis * d)
{
  g_clear_pointer (&d->studies, g_ptr_array_unref);
  cloth_model_free (d->model);
  cloth_candidates_free (d->candidates);
  g_free (d->precisions);
  g_free (d->all);
  for (guint g = 0; g < CLOTH_ESTIMATE_N_GAINS; g++)
    cloth_normal_equations_free (d->normals[g]);
  g_free (d->variability_precisions);
  g_free (d->nuisances);
  g_free (d->nuisance_precisions);
  g_free (d->sound);
  g_free (d->blocks);
  for (guint i = 0; i < d->n_chosen; i++)
    cloth_model_free (d->with[i]);
  cloth_energy_spectrum_free (d->before);
  cloth_energy_spectrum_free (d->after);
  cloth_energy_spectrum_free (d->floor);
  cloth_gap_result_free (d->result);
  g_free (d->nudged);
  for (guint i = 0; i < d->n_nulls; i++)
    cloth_windowed_gap_free (d->nulls[i]);
  g_free (d->what);
  g_free (d->unknown);
  g_free (d->null_evidence);
  for (guint i = 0; d->filmed && i < d->recordings->len; i++)
    g_free (d->filmed[i]);
  g_free (d->filmed);
  g_clear_pointer (&d->camera_effects, g_array_unref);
  g_clear_pointer (&d->recordings, g_ptr_array_unref);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (ClothDiagnosis, diagnosis_clear)
     static gboolean frame_done (gpointer data, gdouble share)
{
  ClothDiagnosis *d = data;
  gdouble at = d->from + (d->to - d->from) * d->each * share;

  if (share >= 1.)
    d->from = at;
  return !d->options->progress
      || d->options->progress (d->options->progress_data, at, d->what);
}

/* What comes now: from where to where it gets, and of the rest of it each simulation. */
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

static gboolean
load_one (ClothDiagnosis * d, ClothTake * take, ClothGapRole role,
    GError ** error)
{
  ClothRecording *r = cloth_recording_new (take, error), *first;
  g_autofree gchar *sha256 = NULL;

  if (!r)
    return FALSE;
  g_ptr_array_add (d->recordings, r);
  first = cloth_diagnosis_recording (d, 0);
  if (!cloth_gap_check_same_cloth (r->name, r->scene->topology, first->name,
          first->scene->topology, error) ||
      !(sha256 = cloth_take_sha256 (take, error)))
    return FALSE;
  /* the same cloth may be filmed twice */
  for (guint i = 0; i + 1 < d->recordings->len
      && !cloth_diagnosis_has_observations (d); i++)
    if (!cloth_recording_check_other (r, cloth_diagnosis_recording (d, i),
            error))
      return FALSE;
  cloth_gap_result_add_input (d->result, role, r->name, sha256);
  if (role != CLOTH_GAP_HOLD_OUT)
    g_ptr_array_add (d->studies, cloth_sensitivities_new (r, &d->study));
  return TRUE;
}

/* A stream may outlive its model's file: then there is no hash. */
static void
note_model (ClothDiagnosis * d)
{
  const gchar *path = d->options->model_file;
  g_autofree gchar *name = path ? g_path_get_basename (path) : NULL;
  g_autofree gchar *sha256 = path ? cloth_file_sha256 (path, NULL) : NULL;

  if (path)
    cloth_gap_result_add_input (d->result, CLOTH_GAP_MODEL, name, sha256);
}

static gboolean
load (ClothDiagnosis * d, GError ** error)
{
  const ClothGapOptions *o = d->options;

  for (guint i = 0; i < d->n_takes; i++)
    if (!load_one (d, d->takes[i], CLOTH_GAP_TAKE, error))
      return FALSE;
  for (guint i = 0; i < o->n_baselines; i++)
    if (!load_one (d, o->baselines[i], CLOTH_GAP_BASELINE, error))
      return FALSE;
  for (guint i = 0; i < o->n_hold_outs; i++)
    if (!load_one (d, o->hold_outs[i], CLOTH_GAP_HOLD_OUT, error))
      return FALSE;
  note_model (d);
  return TRUE;
}

/* A model that needs too many steps would seem to hang: nothing may be said within a frame. */
static gboolean
check_steps (ClothDiagnosis * d, const ClothModel * model, GError ** error)
{
  const ClothSimOptions options = { FALSE, 1, CLOTH_SIMD_BEST, 0 };
  const ClothRecording *r = cloth_diagnosis_recording (d, 0);
  g_autoptr (ClothSim) sim = cloth_sim_new (r->scene, &model, 1, &options,
      error);
  gdouble steps;

  if (!sim)
    return FALSE;
  /* frames further apart are doubted anyway */
  steps = fmin ((r->times[r->n_frames - 1] - r->times[0]) / (r->n_frames - 1),
      CLOTH_DIAGNOSIS_WINDOW_S) / cloth_sim_get_time_step (sim);
  if (steps <= MOST_STEPS)
    return TRUE;
  g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_MODEL, "the model needs "
      "%.2g steps a frame of %s, and a diagnosis simulates it hundreds of "
      "times; lower “damping.stiffness” or the stiffnesses", steps,
      r->name);
  return FALSE;
}

static void
skip (gpointer data, const ClothEffect * effect, const gchar * reason)
{
  ClothDiagnosis *d = data;

  if (effect->side == CLOTH_EFFECT_CAMERA || effect->side == CLOTH_EFFECT_IMAGE) {
    const gchar *blind = cloth_camera_why_not (effect);

    if (d->has_camera_errors && !blind)
      return;
    if (cloth_diagnosis_has_observations (d))
      reason = blind ? blind : "No point was seen by two cameras at a time.";
  }
  cloth_gap_result_add_untested (d->result, effect, reason);
}

/* Where a fit ends at the end of a number's range in the model the cloth may be beyond it,
 * and the floor higher than it need be. What can't be is not beyond it. */
static void
note_ends (ClothDiagnosis * d)
{
  g_autoptr (GString) names = g_string_new (NULL);

  for (guint i = 0; i < d->candidates->n_free; i++) {
    const ClothModelFree *f = &g_array_index (d->model->free, ClothModelFree,
        i);
    const ClothDirection *direction =
        cloth_candidates_direction (d->candidates, i);
    const gdouble place = cloth_candidates_place (d->candidates, d->model,
        i), slack = AT_END * (direction->high - direction->low);
    gdouble value = 0., possible[2] = { -INFINITY, INFINITY };

    cloth_model_get (d->model, f->name, &value, NULL);
    cloth_model_get_range (f->name, possible, NULL);
    if ((place - direction->low < slack && f->range[0] > possible[0])
        || (direction->high - place < slack && f->range[1] < possible[1]))
      g_string_append_printf (names, "%s%s (%.3g)", names->len ? ", " : "",
          f->name, value);
  }
  if (names->len) {
    g_string_prepend (names, "These numbers of the model were fitted to the "
        "end of their ranges, which may be too narrow for this cloth: ");
    g_string_append_c (names, '.');
    cloth_gap_result_add_note (d->result, names->str);
  }
}

/* The model's free numbers: fitted on the baselines, else on the takes. The likeliest may
 * leave a cloth that is stretched for the sake of its wrinkles, where the simulator can't
 * make these; then what is nearest is taken. */
static gboolean
fit_free (ClothDiagnosis * d, const ClothModel * model, GError ** error)
{
  guint begin = d->options->n_baselines ? d->n_takes : 0;
  guint n = d->options->n_baselines ? d->options->n_baselines : d->n_takes;
  guint m = d->candidates->n_free;
  g_autofree gdouble *precisions = g_new (gdouble, m + 1);
  g_autofree gdouble *sigmas = g_new0 (gdouble, 2 * m + 1);
  ClothSensitivities **studies =
      (ClothSensitivities **) d->studies->pdata + begin;
  g_autoptr (GPtrArray) copies =
      g_ptr_array_new_with_free_func ((GDestroyNotify)
      cloth_sensitivities_free);
  g_autoptr (ClothModel) likeliest = NULL;
  g_autoptr (ClothModel) nearest = NULL;
  gdouble squares[2];
  gboolean even;

  if (!m) {
    d->model = cloth_model_copy (model);
    return TRUE;
  }
  for (guint i = 0; i < m; i++) {
    gdouble prior = cloth_candidates_direction (d->candidates, i)->prior;

    precisions[i] = 1. / (prior * prior);
  }
  /* both begin at the same model: its derivatives are found once */
  for (guint i = 0; i < n; i++) {
    if (!cloth_sensitivities_linearise (studies[i], d->candidates, model,
            d->all, m, &d->study, error))
      return FALSE;
    g_ptr_array_add (copies, cloth_sensitivities_copy (studies[i], &d->study));
  }
  likeliest = cloth_gauss_newton_fit (studies, n, d->candidates, model, d->all,
      precisions, m, NULL, FALSE, TRUE, N_FIT, &d->study, sigmas, error);
  nearest =
      likeliest ? cloth_gauss_newton_fit ((ClothSensitivities **) copies->pdata,
      n, d->candidates, model, d->all, precisions, m, NULL, TRUE, TRUE, N_FIT,
      &d->study, sigmas + m, error) : NULL;
  if (!nearest
      || !cloth_diagnosis_find_gaps (d, begin, begin + n,
          (const ClothModel *[]) { likeliest, nearest }, 2, squares, error))
    return FALSE;
  even = squares[1] < NEARER * squares[0];
  d->model = even ? g_steal_pointer (&nearest) : g_steal_pointer (&likeliest);
  note_ends (d);
  for (guint i = 0; i < m; i++) {
    gdouble sigma = FROZEN_SHARE * sigmas[even * m + i];

    d->precisions[i] = precisions[i];
    if (!d->options->n_baselines)
      continue;
    if (sigma > 0.)
      d->precisions[i] = MAX (precisions[i], 1. / (sigma * sigma));
    cloth_candidates_bound (d->candidates, d->model, i,
        FROZEN_REACH / sqrt (d->precisions[i]));
  }
  return TRUE;
}

ClothModel *
cloth_diagnosis_other_model (const ClothDiagnosis * d)
{
  ClothModel *other = cloth_model_copy (d->model);

  other->force_model = other->force_model == CLOTH_FORCE_MEMBRANE ?
      CLOTH_FORCE_MASS_SPRING : CLOTH_FORCE_MEMBRANE;
  return other;
}

static void
note_nulls (ClothDiagnosis * d, const GArray * scores, gdouble share,
    gdouble margin)
{
  for (guint i = 0; i < scores->len; i++) {
    const ClothGapScore *s = &g_array_index (scores, ClothGapScore, i);

    for (guint c = 0; c < d->candidates->list->len; c++)
      if (g_array_index (d->candidates->list, ClothCandidate, c).effect ==
          cloth_diagnosis_candidate (d, s)->effect)
        d->null_evidence[c] = share * MAX (s->evidence, 0.);
    d->least_evidence = MAX (d->least_evidence, CLOTH_DIAGNOSIS_LEAST_EVIDENCE +
        margin * MAX (s->evidence, 0.));
  }
}

/* What baselines ask for. Where it is taken off the takes themselves, an effect must ask
 * for more than that once more: another motion has more or less of the simulator's own
 * error. */
static gboolean
study_baselines (ClothDiagnosis * d, GError ** error)
{
  g_autoptr (GArray) scores = NULL;
  ClothGapTest test = { {NULL} };

  if (!cloth_diagnosis_linearise (d, d->n_takes, d->studies->len, d->model, 0.2,
          0.3, error))
    return FALSE;
  cloth_diagnosis_make_test (d, d->n_takes, d->studies->len, &test);
  scores = cloth_gap_test_run (&test);
  if (cloth_diagnosis_has_discrepancies (d))
    note_nulls (d, scores, 1., 0.);
  else
    note_nulls (d, scores, NULL_SHARE, NULL_MARGIN);
  return TRUE;
}

/* Without a baseline: what the difference of the two force models asks for. */
static gboolean
study_other_model (ClothDiagnosis * d, GError ** error)
{
  g_autoptr (ClothModel) other = cloth_diagnosis_other_model (d);
  g_autoptr (GPtrArray) studies = g_ptr_array_new_with_free_func (
      (GDestroyNotify) cloth_sensitivities_free);
  g_autoptr (GArray) scores = NULL;
  ClothGapTest test = { {NULL} };

  cloth_diagnosis_begin_part (d, 0.4, 0.42, 1., "the other force model");
  for (guint i = 0; i < d->n_takes; i++) {
    g_autoptr (GError) diverged = NULL;
    ClothSensitivities *s =
        cloth_sensitivities_new (cloth_diagnosis_recording (d, i),
        &d->study);

    g_ptr_array_add (studies, s);
    if (cloth_sensitivities_linearise (s, d->candidates, other, d->all,
            d->candidates->n_free, &d->study, &diverged))
      continue;
    /* one that these numbers make no cloth of tells nothing */
    if (g_error_matches (diverged, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_MODEL))
      return TRUE;
    g_propagate_error (error, g_steal_pointer (&diverged));
    return FALSE;
  }
  for (guint i = 0; i < d->n_takes; i++)
    cloth_diagnosis_study (d, i)->discrepancy = g_ptr_array_index (studies, i);
  cloth_diagnosis_make_test (d, 0, d->n_takes, &test);
  for (guint i = 0; i < d->n_takes; i++)
    cloth_diagnosis_study (d, i)->discrepancy = NULL;
  scores = cloth_gap_test_run (&test);
  note_nulls (d, scores, NULL_SHARE, NULL_MARGIN);
  return TRUE;
}

static gboolean
diagnose (ClothDiagnosis * d, const ClothModel * model, GError ** error)
{
  gchar *doubt;
  guint n_all;

  if (!load (d, error) || !check_steps (d, model, error))
    return FALSE;
  d->result->reason = cloth_diagnosis_find_doubt (d, model);
  if (d->result->reason)
    return TRUE;
  cloth_diagnosis_find_faults (d);
  d->candidates =
      cloth_candidates_new (model, cloth_diagnosis_recording (d, 0),
      d->options->effects, d->options->n_baselines > 0, skip, d, error);
  if (!d->candidates)
    return FALSE;
  n_all = d->candidates->directions->len;
  d->all = g_new (guint, n_all + 1);
  for (guint i = 0; i < n_all; i++)
    d->all[i] = i;
  d->precisions = g_new (gdouble, d->candidates->n_free + 1);
  d->sound = g_new (gboolean, n_all + 1);
  d->null_evidence = g_new0 (gdouble, d->candidates->list->len + 1);
  cloth_diagnosis_begin_part (d, 0., 0.2, 0.2, "the model's free numbers");
  if (!fit_free (d, model, error))
    return FALSE;
  cloth_diagnosis_find_discrepancies (d);
  if (d->options->n_baselines && !study_baselines (d, error))
    return FALSE;
  if (!cloth_diagnosis_linearise (d, 0, d->n_takes, d->model, 0.3, 0.4, error))
    return FALSE;
  if (!d->options->n_baselines && !study_other_model (d, error))
    return FALSE;
  if (!cloth_diagnosis_select (d, error))
    return FALSE;
  cloth_diagnosis_note_untested (d);
  if (!cloth_diagnosis_measure (d, error))
    return FALSE;
  cloth_diagnosis_locate (d);
  cloth_diagnosis_decide (d);
  doubt = cloth_diagnosis_doubt_result (d, model);
  if (doubt) {
    g_free (d->result->reason);
    d->result->reason = doubt;
    d->result->verdict = CLOTH_GAP_UNDECIDABLE;
  }
  cloth_diagnosis_fill_null (d);
  return cloth_diagnosis_propose (d, error);
}

/* @takes: (array length=n_takes): what was recorded
 * @n_takes: how many, at least one; of the same cloth
 * @model: what the simulator knows
 * @options: what else is given
 * @error: #ClothFitError, #ClothSimError, or what reading a take says
 *
 * Runs the simulation with weak springs to what was recorded, tests by its score which
 * effect the residual asks for once the model's free numbers and the simulator's own
 * error are taken off, adds those that are asked for one by one, and measures the gap
 * without and with them.
 *
 * Returns: (transfer full) (nullable): what was found
 */
ClothGapResult *
cloth_gap_diagnose (ClothTake ** takes, guint n_takes,
    const ClothModel * model, const ClothGapOptions * options, GError ** error)
{
  g_auto (ClothDiagnosis) d = { takes, n_takes, options };
  gint64 start = g_get_monotonic_time ();

  d.least_evidence = CLOTH_DIAGNOSIS_LEAST_EVIDENCE;
  cloth_estimate_options_init (&d.study);
  d.study.rollout.seed = options->seed;
  d.study.rollout.threads = options->threads;
  d.study.rollout.progress = frame_done;
  d.study.rollout.failed = cloth_diagnosis_note_failure;
  d.study.rollout.data = &d;
  d.result = cloth_gap_result_new ();
  d.recordings = g_ptr_array_new_with_free_func (
      (GDestroyNotify) cloth_recording_free);
  d.studies = g_ptr_array_new_with_free_func (
      (GDestroyNotify) cloth_sensitivities_free);
  if (!diagnose (&d, model, error))
    return NULL;
  if (d.model)
    d.result->model = d.n_chosen ? g_steal_pointer (&d.with[d.n_chosen - 1]) :
        g_steal_pointer (&d.model);
  d.result->seed = options->seed;
  d.result->simulations = d.study.simulations;
  d.result->seconds = (g_get_monotonic_time () - start) * 1e-6;
  cloth_gap_result_add_version (d.result, PACKAGE, PACKAGE_VERSION);
  cloth_gap_result_add_version (d.result, "priors", PRIORS);
  cloth_gap_result_add_threshold (d.result, "least evidence (logarithm of the "
      "Bayes factor)", d.least_evidence, "1");
  cloth_gap_result_add_threshold (d.result, "least share of the gap's variance",
      CLOTH_DIAGNOSIS_LEAST_SHRINK, "1");
  cloth_gap_result_add_threshold (d.result,
      "largest rest over the floor, of variance", CLOTH_DIAGNOSIS_BAND, "1");
  return g_steal_pointer (&d.result);
}
