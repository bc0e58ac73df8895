/* Decides what the model is that effects are tested against, and what each effect must exceed.
 *
 * The model's free numbers are the most probable ones by Gauss–Newton, fitted on the baselines,
 * else on the takes, with the variance that is left in each class of features as weights. Even
 * weights are tried too, and taken when they leave a much smaller gap.
 * Assumption: a baseline lacks no effect, or, without one, the difference of the two force models
 * is like the simulator's own error. What the test of these supports of an effect is by mistake,
 * and the effect's log Bayes factor on the takes must exceed it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/inference/baseline.h"

#include <math.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/gap/inference/name.h"

/* The nearest numbers are taken when their squared gap is below this share of the likeliest's. */
#define NEARER 0.8
/* Simulations of the fit of the free numbers. */
#define N_FIT 6
/* Free numbers that were fitted on baselines get a prior of this share of their standard
 * deviations, and move by no more than so many such shares: else they would take the place of
 * what is missing. */
#define FROZEN_SHARE 0.5
#define FROZEN_REACH 2.
/* A number is at the end of its range when it is this share of it away. */
#define AT_END 1e-3
/* On takes that move otherwise than a baseline, the baseline's log Bayes factor of an
 * effect is taken off so many times; without a baseline, that of the difference of the two
 * force models. */
#define NULL_SHARE 1.5
/* And this many times the largest of them is added to what any effect must have there. */
#define NULL_MARGIN 2.

/* The sums over the recordings from @begin to @end of the squared gap of each of @n models, m²;
 * infinite where a simulation diverges. */
static gboolean
find_gaps (ClothDiagnosis * d, guint begin, guint end,
    const ClothModel * const *models, guint n, gdouble * squares,
    GError ** error)
{
  memset (squares, 0, n * sizeof *squares);
  for (guint i = begin; i < end; i++) {
    ClothWindowedGap **extents =
        cloth_diagnosis_measure_windows (d, cloth_diagnosis_study (d,
            i)->recording, models, n, error);

    if (!extents)
      return FALSE;
    for (guint k = 0; k < n; k++)
      squares[k] += extents[k]->sound ?
          cloth_windowed_gap_square (extents[k], NULL) : INFINITY;
    cloth_windowed_gaps_free (extents, n);
  }
  return TRUE;
}

/* Notes the numbers that a fit took to the end of their ranges in the model: the cloth may be
 * beyond, and the floor then higher than it need be. The end of what is possible is no such
 * end. */
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

/* @d: a diagnosis whose candidates are listed
 * @model: what the simulator knows
 * @error: #ClothSimError or #ClothFitError
 *
 * Fits the model's free numbers on the baselines and the twins, else on the takes. Where the simulator can't
 * make the cloth's wrinkles, the likeliest numbers may stretch the cloth instead; then those
 * that bring it nearest are taken.
 *
 * Returns: whether it could be simulated
 */
gboolean
cloth_diagnosis_fit_free (ClothDiagnosis * d, const ClothModel * model,
    GError ** error)
{
  guint references = cloth_diagnosis_n_references (d);
  guint begin = references ? d->n_takes : 0;
  guint n = references ? references : d->n_takes;
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

  cloth_diagnosis_begin_part (d, 0., 0.2, 0.2, "the model's free numbers");
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
      precisions, m, NULL, CLOTH_FIT_IS_LINEARISED, N_FIT, &d->study,
      sigmas, error);
  nearest =
      likeliest ? cloth_gauss_newton_fit ((ClothSensitivities **) copies->pdata,
      n, d->candidates, model, d->all, precisions, m, NULL,
      CLOTH_FIT_EQUAL_WEIGHTS | CLOTH_FIT_IS_LINEARISED, N_FIT,
      &d->study, sigmas + m, error) : NULL;
  if (!nearest
      || !find_gaps (d, begin, begin + n,
          (const ClothModel *[]) { likeliest, nearest }, 2, squares, error))
    return FALSE;
  even = squares[1] < NEARER * squares[0];
  d->model = even ? g_steal_pointer (&nearest) : g_steal_pointer (&likeliest);
  note_ends (d);
  for (guint i = 0; i < m; i++) {
    gdouble sigma = FROZEN_SHARE * sigmas[even * m + i];

    d->precisions[i] = precisions[i];
    if (!references)
      continue;
    if (sigma > 0.)
      d->precisions[i] = MAX (precisions[i], 1. / (sigma * sigma));
    cloth_candidates_bound (d->candidates, d->model, i,
        FROZEN_REACH / sqrt (d->precisions[i]));
  }
  return TRUE;
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
        d->null_log_bayes_factors[c] = share * MAX (s->log_bayes_factor, 0.);
    d->least_log_bayes_factor =
        MAX (d->least_log_bayes_factor,
        CLOTH_DIAGNOSIS_LEAST_LOG_BAYES_FACTOR +
        margin * MAX (s->log_bayes_factor, 0.));
  }
}

/* @d: a diagnosis whose model is fitted
 * @error: #ClothSimError or #ClothFitError
 *
 * Notes how much the baselines support each effect. On takes that move otherwise, where the
 * discrepancy is not subtracted, more than that is taken off: another motion has more or less
 * of the simulator's own error.
 *
 * Returns: whether the baselines could be simulated
 */
gboolean
cloth_diagnosis_study_baselines (ClothDiagnosis * d, GError ** error)
{
  g_autoptr (GArray) scores = NULL;
  ClothGapTest test = { NULL };

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

/* @d: a diagnosis whose takes are linearised
 * @error: #ClothSimError or #ClothFitError
 *
 * Notes how much the difference of the two force models supports each effect. Nothing is noted
 * when the other one diverges with these numbers.
 *
 * Returns: whether it could be simulated
 */
gboolean
cloth_diagnosis_study_other_model (ClothDiagnosis * d, GError ** error)
{
  g_autoptr (ClothModel) other = cloth_diagnosis_other_model (d->model);
  g_autoptr (GPtrArray) studies = g_ptr_array_new_with_free_func (
      (GDestroyNotify) cloth_sensitivities_free);
  g_autoptr (GArray) scores = NULL;
  ClothGapTest test = { NULL };

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
