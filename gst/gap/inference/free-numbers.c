/* Decides what the model is that effects are looked for beside: fits its free numbers.
 *
 * They are the most probable ones by Gauss–Newton, fitted on the baselines and twins, else on the
 * takes, with the variance that is left in each class of features as weights. Even weights are
 * tried too, and taken when they leave a much smaller gap.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/inference/free-numbers.h"

#include <math.h>
#include <string.h>

#include "gst/fit/error.h"

/* The nearest numbers are taken when their squared gap is below this share of the likeliest's. */
#define NEARER 0.8
/* Simulations of the fit of the free numbers. */
#define N_FIT 6
/* Free numbers that were fitted on baselines move on the takes by no more than so many of their
 * standard deviations: else they would take the place of what is missing. */
#define FROZEN_REACH 2.
/* A number is at the end of its range when it is this share of it away. */
#define AT_END 1e-3

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

/* @d: a diagnosis whose model is fitted
 * @i: which free number
 *
 * Returns: whether the fit took it to an end of its range, where the cloth may be beyond, and the
 *   floor then higher than it need be. The end of what is possible is no such end
 */
gboolean
cloth_diagnosis_is_at_end (const ClothDiagnosis * d, guint i)
{
  const ClothModelFree *f = &g_array_index (d->model->free, ClothModelFree, i);
  const ClothDirection *direction =
      cloth_candidates_direction (d->candidates, i);
  const gdouble place = cloth_candidates_place (d->candidates, d->model, i);
  const gdouble slack = AT_END * (direction->high - direction->low);
  gdouble possible[2] = { -INFINITY, INFINITY };

  cloth_model_get_range (f->name, possible, NULL);
  return (place - direction->low < slack && f->range[0] > possible[0])
      || (direction->high - place < slack && f->range[1] < possible[1]);
}

/* Notes the numbers that are at an end. */
static void
note_ends (ClothDiagnosis * d)
{
  g_autoptr (GString) names = g_string_new (NULL);

  for (guint i = 0; i < d->candidates->n_free; i++) {
    const gchar *name = cloth_candidates_direction (d->candidates, i)->name;
    gdouble value = 0.;

    if (!cloth_diagnosis_is_at_end (d, i))
      continue;
    cloth_model_get (d->model, name, &value, NULL);
    g_string_append_printf (names, "%s%s (%.3g)", names->len ? ", " : "",
        name, value);
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

  cloth_diagnosis_begin_part (d, 0., 0.2, 0.2, "fitting the fabric's numbers");
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
    gdouble sigma = sigmas[even * m + i];

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
