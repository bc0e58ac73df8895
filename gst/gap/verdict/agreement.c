/* Decides whether takes and hold-outs agree on the accepted effects.
 *
 * Model: at the last model the residual of take t is z = −B δ − N ν + ε, with δ what the effects'
 *   parameters must still change by there, and ν the free numbers and run-to-run variability, which
 *   are the take's own and have their priors.
 * Assumption: ε has the variance that is left, class by class, and counts φ times less often than
 *   there are features.
 * Formula: with g and s the normal equations of δ with ν projected out, each take alone has
 *   δ = −g⁻¹s. All have the same δ but for chance if
 *     χ² = Σ sᵀg⁻¹s/φ − (Σs)ᵀ(Σg)⁻¹(Σs)/φ
 *   is one of (takes − 1) × parameters degrees of freedom.
 * Reference: Cochran, The combination of estimates from different experiments, Biometrics 10, 1954.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/verdict/agreement.h"

#include <math.h>
#include <string.h>

#include "gst/math/statistics.h"

/* Of the mean curvature: what a take says nothing of stays where it is. */
#define RIDGE 1e-9

/* The changes that a take asks for, and all of them together. */
typedef struct
{
  guint n;                      /* directions of accepted effects */
  guint *directions;
  gdouble *precisions;          /* of the free numbers, then those of what is accepted */
  gdouble *g, *s;               /* of a take, then of all: [takes + 1][n][n] and [n] */
  gdouble *changes, *sigmas;    /* the same, [takes + 1][n] */
} Agreement;

static void
agreement_clear (Agreement * a)
{
  g_free (a->directions);
  g_free (a->precisions);
  g_free (a->g);
  g_free (a->s);
  g_free (a->changes);
  g_free (a->sigmas);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Agreement, agreement_clear);

/* Normal equations of the effects' directions in a linearised study. */
static void
find_equations (const ClothDiagnosis * d, const Agreement * a,
    const ClothSensitivities * study, gdouble * g, gdouble * s)
{
  const guint n_free = d->candidates->n_free;
  const guint variability = cloth_sensitivities_count_variability (study);
  const gsize size = study->features->size;
  g_autofree gdouble *z = cloth_sensitivities_residual (study);
  g_autofree gdouble *columns = g_new (gdouble,
      (study->m + variability) * size + 1);
  g_autofree gdouble *precisions = g_new (gdouble, n_free + variability + 1);
  g_autoptr (ClothPowerSpectrum) left =
      cloth_power_spectrum_new (study->features, z);
  g_autoptr (ClothNormalEquations) normal = NULL;

  memcpy (columns, study->columns + n_free * size,
      a->n * size * sizeof *columns);
  memcpy (columns + a->n * size, study->columns,
      n_free * size * sizeof *columns);
  cloth_sensitivities_get_variability (study, columns + study->m * size);
  for (guint k = 0; k < n_free; k++)
    precisions[k] = d->study.overdispersion * a->precisions[k];
  for (guint k = 0; k < variability; k++)
    precisions[n_free + k] =
        cloth_sensitivities_get_variability_precision (study, k);
  normal = cloth_normal_equations_new (study->features, left, z, columns,
      study->m + variability);
  cloth_normal_equations_project (normal, NULL, a->n, precisions, g, s);
}

/* Of a recording at the last model, less what its twin leaves of the model without effects. */
static gboolean
add_recording (ClothDiagnosis * d, Agreement * a, guint i, guint row,
    GError ** error)
{
  const ClothRecording *twin = cloth_diagnosis_twin (d, i);
  g_autoptr (ClothSensitivities) study =
      cloth_sensitivities_new (cloth_diagnosis_recording (d, i), &d->study);
  g_autoptr (ClothSensitivities) own = twin ?
      cloth_sensitivities_new (twin, &d->study) : NULL;

  if (own && !cloth_sensitivities_linearise (own, d->candidates, d->model,
          a->directions, 0, &d->study, error))
    return FALSE;
  if (!cloth_sensitivities_linearise (study, d->candidates,
          d->with, a->directions,
          d->candidates->n_free + a->n, &d->study, error))
    return FALSE;
  study->discrepancy = own ? own : i < d->n_takes ?
      cloth_diagnosis_study (d, i)->discrepancy : NULL;
  find_equations (d, a, study, a->g + (gsize) row * a->n * a->n,
      a->s + (gsize) row * a->n);
  return TRUE;
}

/* sᵀg⁻¹s/φ of a take, or of all. */
static gdouble
solve (const ClothDiagnosis * d, Agreement * a, guint row)
{
  const guint n = a->n;
  const gdouble *g = a->g + (gsize) row * n * n, *s = a->s + (gsize) row *n;
  g_autofree gdouble *ridge = g_new0 (gdouble, n);
  g_autofree gdouble *covariance = g_new (gdouble, (gsize) n * n);
  g_auto (ClothPosterior) posterior = { 0 };
  gdouble square = 0.;

  for (guint k = 0; k < n; k++)
    ridge[k] = RIDGE * g[k * n + k] / d->study.overdispersion + G_MINDOUBLE;
  cloth_posterior_init (&posterior, n);
  cloth_posterior_add_data (&posterior, g, s, d->study.overdispersion);
  cloth_posterior_add_prior (&posterior, ridge, NULL);
  if (!cloth_posterior_solve (&posterior))
    return 0.;
  cloth_posterior_covariance (&posterior, covariance);
  for (guint k = 0; k < n; k++) {
    a->changes[row * n + k] = posterior.mean[k];
    a->sigmas[row * n + k] = sqrt (covariance[k * n + k]);
    square -= posterior.mean[k] * s[k] / d->study.overdispersion;
  }
  return square;
}

/* The number on which the takes differ most, and what each says it is. */
static gchar *
describe (const ClothDiagnosis * d, const Agreement * a, guint n_takes)
{
  g_autoptr (GString) text = g_string_new ("The takes contradict each other: ");
  const ClothModel *model = d->with;
  gdouble most = -1.;
  guint worst = 0;

  for (guint t = 0; t < n_takes; t++)
    for (guint k = 0; k < a->n; k++) {
      gdouble off = fabs (a->changes[t * a->n + k] -
          a->changes[n_takes * a->n + k]) / a->sigmas[t * a->n + k];

      if (off > most) {
        most = off;
        worst = k;
      }
    }
  for (guint i = 0, t = 0; i < d->recordings->len; i++) {
    const guint direction = a->directions[d->candidates->n_free + worst];
    const gchar *name =
        cloth_candidates_direction (d->candidates, direction)->name;
    g_autoptr (ClothModel) there = NULL;
    gdouble value = NAN;

    if (i >= d->n_takes && i < d->n_takes + d->options->n_baselines)
      continue;
    there = cloth_candidates_move (d->candidates, model, &direction,
        &a->changes[t * a->n + worst], 1);
    cloth_model_get (there, name, &value, NULL);
    if (t == 0)
      g_string_append_printf (text, "%s would be ", name);
    g_string_append_printf (text, "%s%.3g on %s", t == 0 ? "" :
        t + 1 == n_takes ? " and " : ", ", value,
        cloth_diagnosis_recording (d, i)->name);
    t++;
  }
  g_string_append_c (text, '.');
  return g_string_free (g_steal_pointer (&text), FALSE);
}

/* @d: a diagnosis that is measured
 * @error: #ClothSimError or #ClothFitError
 *
 * With two takes and hold-outs at least, and accepted effects, finds how likely it is that they
 * are the same in all; where it is not, what each take says goes into the notes.
 *
 * Returns: whether they could be simulated
 */
gboolean
cloth_diagnosis_test_agreement (ClothDiagnosis * d, GError ** error)
{
  const guint n_takes = d->recordings->len - d->options->n_baselines;
  const guint most = d->candidates->directions->len;
  g_auto (Agreement) a = { 0 };
  gdouble chi_square = 0.;
  guint row = 0;

  if (n_takes < 2 || !d->n_accepted)
    return TRUE;
  a.directions = g_new (guint, most);
  a.precisions = g_new (gdouble, most);
  a.n = cloth_diagnosis_list_accepted (d, CLOTH_DIAGNOSIS_N_SUBSETS - 1,
      a.directions, a.precisions) - d->candidates->n_free;
  a.g = g_new0 (gdouble, (gsize) (n_takes + 1) * a.n * a.n);
  a.s = g_new0 (gdouble, (gsize) (n_takes + 1) * a.n);
  a.changes = g_new0 (gdouble, (gsize) (n_takes + 1) * a.n);
  a.sigmas = g_new0 (gdouble, (gsize) (n_takes + 1) * a.n);
  cloth_diagnosis_begin_part (d, 0.97, 0.99, 0.5,
      "checking whether takes agree");
  for (guint i = 0; i < d->recordings->len; i++) {
    if (i >= d->n_takes && i < d->n_takes + d->options->n_baselines)
      continue;
    if (!add_recording (d, &a, i, row, error))
      return FALSE;
    for (gsize k = 0; k < (gsize) a.n * a.n; k++)
      a.g[(gsize) n_takes * a.n * a.n + k] += a.g[(gsize) row * a.n * a.n + k];
    for (guint k = 0; k < a.n; k++)
      a.s[n_takes * a.n + k] += a.s[row * a.n + k];
    chi_square += solve (d, &a, row++);
  }
  chi_square -= solve (d, &a, n_takes);
  d->result->takes_agree_p_value =
      cloth_chi_square_tail (fmax (chi_square, 0.), (n_takes - 1) * a.n);
  if (d->result->takes_agree_p_value < CLOTH_DIAGNOSIS_CONTRADICTION) {
    g_autofree gchar *note = describe (d, &a, n_takes);

    cloth_gap_result_add_note (d->result, note);
  }
  return TRUE;
}
