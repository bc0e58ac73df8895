/* The Gauss–Newton fit of a model's numbers to recordings.
 *
 * Model: features of the residual z (θ) at the model with the numbers θ, of all recordings.
 * Assumption: z (θ + δ) ≈ z + B δ within a step; z ~ N(0, φ₀ W⁻¹), with φ₀ the overdispersion
 *   and 1/W the power of z where the step begins; θ ~ N(θ₀, Λ⁻¹), with θ₀ the start.
 * Formula: each step goes to the mean of the posterior of the linearised model,
 *     δ = (BᵀWB/φ₀ + Λ)⁻¹ (−BᵀWz/φ₀ − Λ (θ − θ₀)),
 *   and the cost that it must lower is zᵀWz + φ₀ (θ − θ₀)ᵀ Λ (θ − θ₀). A step that raises it,
 *   or leads to a model that can't be simulated, is cut (damped Gauss–Newton). The covariance
 *   is the inverse of the last precision. What run-to-run variability does is projected out.
 * Reference: Björck, Numerical Methods for Least Squares Problems, 1996, section 9.2.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/estimate/gauss-newton.h"

#include <math.h>
#include <string.h>

#include "gst/fit/error.h"

/* A fit ends when it gains less than this share. */
#define LEAST_GAIN 4e-3

/* Cost of the place at hand, and its posterior when one is given. */
static gdouble
find_cost (const ClothGaussNewtonProblem * problem, gpointer data,
    const ClothGaussNewtonOptions * o, const gdouble * moved,
    ClothPosterior * posterior)
{
  gdouble cost = problem->add_data (data, posterior);
  g_autofree gdouble *back = g_new (gdouble, o->m);

  for (guint k = 0; k < o->m; k++) {
    cost += o->overdispersion * o->precisions[k] * moved[k] * moved[k];
    back[k] = -moved[k];
  }
  if (posterior)
    cloth_posterior_add_prior (posterior, o->precisions, back);
  return cost;
}

/* @problem: what is fitted
 * @data: for its functions
 * @options: how
 * @sigmas: (out) (nullable) (array): standard deviations of the unknowns
 * @error: as its functions have it
 *
 * The best place found is the one at hand at the end.
 *
 * Returns: whether the residual could be had at the start at least
 */
gboolean
cloth_gauss_newton_run (const ClothGaussNewtonProblem * problem,
    gpointer data, const ClothGaussNewtonOptions * options, gdouble * sigmas,
    GError ** error)
{
  const guint m = options->m;
  g_autofree gdouble *moved = g_new0 (gdouble, m + 1);
  g_autofree gdouble *step = g_new0 (gdouble, m + 1);
  g_autofree gdouble *covariance = g_new (gdouble, (gsize) m * m + 1);
  gdouble before = INFINITY;

  for (guint pass = 0; pass < options->n_passes && m; pass++) {
    g_autoptr (GError) failed = NULL;
    g_auto (ClothPosterior) posterior = { 0 };

    if (!(options->is_linearised && !pass)
        && !problem->linearise (data, &failed) && (!pass
            || !g_error_matches (failed, CLOTH_FIT_ERROR,
                CLOTH_FIT_ERROR_MODEL))) {
      g_propagate_error (error, g_steal_pointer (&failed));
      return FALSE;
    }
    if (pass) {
      gdouble cost = failed ? INFINITY : find_cost (problem, data, options,
          moved, NULL);

      if (!(cost < before)) {
        /* nobody would look at a shorter step */
        if (pass + 1 == options->n_passes) {
          problem->restore (data);
          break;
        }
        /* back, most of the way */
        problem->move (data, step, CLOTH_GAUSS_NEWTON_CUT - 1., moved);
        for (guint i = 0; i < m; i++)
          step[i] *= CLOTH_GAUSS_NEWTON_CUT;
        continue;
      }
      if (before - cost < LEAST_GAIN * before)
        break;
    }
    problem->accept (data);
    cloth_posterior_init (&posterior, m);
    before = find_cost (problem, data, options, moved, &posterior);
    if (!cloth_posterior_solve (&posterior))
      break;
    for (guint i = 0; i < m; i++)
      step[i] = CLAMP (posterior.mean[i], -options->longest[i],
          options->longest[i]);
    if (pass + 1 < options->n_passes)
      problem->move (data, step, 1., moved);
    cloth_posterior_covariance (&posterior, covariance);
    for (guint i = 0; sigmas && i < m; i++)
      sigmas[i] = sqrt (covariance[i * m + i]);
  }
  return TRUE;
}

/* Recordings that are fitted together. Their sensitivities are those of the model at hand. */
typedef struct
{
  ClothSensitivities **sensitivities;
  guint n;
  const ClothCandidates *candidates;
  const guint *directions;
  guint m;
  const gboolean *blocks;
  gboolean equal_weights;
  ClothEstimateOptions *options;
  ClothModel *model;
  ClothModel *accepted;
  GPtrArray *variances;         /* what weighs, of each recording */
} Fit;

static void
fit_clear (Fit * fit)
{
  cloth_model_free (fit->model);
  cloth_model_free (fit->accepted);
  g_clear_pointer (&fit->variances, g_ptr_array_unref);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Fit, fit_clear);

static gboolean
linearise (gpointer data, GError ** error)
{
  Fit *fit = data;

  for (guint i = 0; i < fit->n; i++)
    if (!cloth_sensitivities_linearise (fit->sensitivities[i],
            fit->candidates, fit->model, fit->directions, fit->m,
            fit->options, error))
      return FALSE;
  return TRUE;
}

/* All classes get the mean of them. */
static void
set_equal (ClothPowerSpectrum * power)
{
  gdouble mean = 0.;

  for (guint i = 0; i < power->n; i++)
    mean += power->values[i] / power->n;
  for (guint i = 0; i < power->n; i++)
    power->values[i] = mean;
}

/* Each feature weighs by the power that the model at hand leaves in its class, or in all. */
static void
accept (gpointer data)
{
  Fit *fit = data;

  cloth_model_free (fit->accepted);
  fit->accepted = cloth_model_copy (fit->model);
  g_clear_pointer (&fit->variances, g_ptr_array_unref);
  fit->variances = g_ptr_array_new_with_free_func (
      (GDestroyNotify) cloth_power_spectrum_free);
  for (guint i = 0; i < fit->n; i++) {
    const ClothSensitivities *s = fit->sensitivities[i];
    g_autofree gdouble *z = cloth_sensitivities_residual (s);

    g_ptr_array_add (fit->variances, s->residual_variance ?
        cloth_power_spectrum_copy (s->residual_variance) :
        cloth_power_spectrum_new (s->features, z));
    if (fit->equal_weights)
      set_equal (g_ptr_array_index (fit->variances, i));
  }
}

/* Normal equations of the first @m directions in a recording, with what run-to-run
 * variability does projected out; returns zᵀWz without it. */
static gdouble
find_equations (const Fit * fit, guint i, guint m, gdouble * g, gdouble * s)
{
  const ClothSensitivities *study = fit->sensitivities[i];
  guint n = fit->m > fit->candidates->n_free ?
      cloth_sensitivities_count_variability (study) : 0;
  gsize size = study->features->size;
  g_autofree gdouble *z = cloth_sensitivities_residual (study);
  g_autofree gdouble *columns = g_new (gdouble, (m + n) * size + 1);
  g_autofree gdouble *precisions = g_new0 (gdouble, m + n + 1);
  g_autoptr (ClothNormalEquations) normal = NULL;

  if (m)
    memcpy (columns, study->columns, m * size * sizeof (gdouble));
  if (n)
    cloth_sensitivities_get_variability (study, columns + m * size);
  for (guint k = 0; k < n; k++)
    precisions[k] = cloth_sensitivities_get_variability_precision (study, k);
  normal = cloth_normal_equations_new (study->features,
      g_ptr_array_index (fit->variances, i), z, columns, m + n);
  return cloth_normal_equations_project (normal, fit->blocks, m, precisions, g,
      s);
}

static gdouble
add_data (gpointer data, ClothPosterior * posterior)
{
  const Fit *fit = data;
  const guint m = posterior ? fit->m : 0;
  g_autofree gdouble *g = g_new (gdouble, (gsize) m * m + 1);
  g_autofree gdouble *s = g_new (gdouble, m + 1);
  gdouble cost = 0.;

  for (guint i = 0; i < fit->n; i++) {
    cost += find_equations (fit, i, m, g, s);
    if (posterior)
      cloth_posterior_add_data (posterior, g, s, fit->options->overdispersion);
  }
  return cost;
}

static void
move (gpointer data, const gdouble * step, gdouble share, gdouble * moved)
{
  Fit *fit = data;
  g_autofree gdouble *part = g_new (gdouble, fit->m);
  ClothModel *there;

  for (guint i = 0; i < fit->m; i++) {
    const ClothDirection *d = cloth_candidates_direction
        (fit->candidates, fit->directions[i]);
    gdouble from = cloth_candidates_place (fit->candidates, fit->model,
        fit->directions[i]);

    part[i] = CLAMP (from + share * step[i], d->fit_low, d->fit_high) - from;
    moved[i] += part[i];
  }
  there = cloth_candidates_move (fit->candidates, fit->model,
      fit->directions, part, fit->m);
  cloth_model_free (fit->model);
  fit->model = there;
}

static void
restore (gpointer data)
{
  Fit *fit = data;

  cloth_model_free (fit->model);
  fit->model = g_steal_pointer (&fit->accepted);
}

/* @sensitivities: (array length=n): of the recordings that are fitted together
 * @n: how many
 * @candidates: what directions mean
 * @model: where to start
 * @directions: (array length=m): what is fitted
 * @precisions: (array length=m): of their priors, centred at @model
 * @m: how many
 * @blocks: (nullable): which blocks of time count
 * @flags: how
 * @n_passes: at most so many simulations of all
 * @options: how to simulate
 * @sigmas: (out) (nullable) (array length=m): standard deviations
 * @error: #ClothSimError or #ClothFitError
 *
 * Returns: (transfer full) (nullable): the fitted model
 */
ClothModel *
cloth_gauss_newton_fit (ClothSensitivities ** sensitivities, guint n,
    const ClothCandidates * candidates, const ClothModel * model,
    const guint * directions, const gdouble * precisions, guint m,
    const gboolean * blocks, ClothFitFlags flags, guint n_passes,
    ClothEstimateOptions * options, gdouble * sigmas, GError ** error)
{
  static const ClothGaussNewtonProblem problem = {
    linearise, accept, add_data, move, restore
  };
  g_auto (Fit) fit = { sensitivities, n, candidates, directions, m, blocks,
    flags & CLOTH_FIT_EQUAL_WEIGHTS, options, cloth_model_copy (model)
  };
  g_autofree gdouble *longest = g_new (gdouble, m + 1);
  const ClothGaussNewtonOptions how = {
    m, precisions, longest, options->overdispersion, n_passes,
    flags & CLOTH_FIT_IS_LINEARISED
  };

  for (guint i = 0; i < m; i++)
    longest[i] = CLOTH_GAUSS_NEWTON_LONGEST_STEP *
        cloth_candidates_direction (candidates, directions[i])->prior;
  if (!cloth_gauss_newton_run (&problem, &fit, &how, sigmas, error))
    return NULL;
  return g_steal_pointer (&fit.model);
}
