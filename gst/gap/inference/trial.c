/* Decides where the likeliest effects act, and how likely they are there.
 *
 * At its null an effect may have another derivative than where the residual asks it to be. Each of
 * the likeliest effects is simulated there and takes Gauss–Newton steps in its own directions.
 * Model: that of score.c, linearised at the effect's present values η instead of its null.
 * Formula, with g, s, r at η and the step dη = −(g/φ + R⁻¹)⁻¹ (s/φ + R⁻¹η):
 *   2 log p = −(r + 2 sᵀdη + dηᵀ g dη)/φ − (η + dη)ᵀR⁻¹(η + dη) − log det (g R/φ + 1)
 *   log Bayes factor = log p − log p without any effect
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/inference/trial.h"

#include <math.h>
#include <string.h>

/* So many effects at most, each for so many Gauss–Newton steps at most, as long as it
 * moves by this share of a prior and gains so much in its log Bayes factor. */
#define MOST_HYPOTHESES 12
#define N_STEPS 6
#define FAR 0.1
#define MUCH CLOTH_DIAGNOSIS_LEAST_LOG_BAYES_FACTOR
/* No effect goes further than so many priors. */
#define LONGEST 3.

#define MOST CLOTH_EFFECT_MAX_PARAMETERS

/* The hypothesis that an effect acts, with its present values. */
typedef struct
{
  ClothGapScore *score;
  const ClothCandidate *candidate;
  gdouble at[MOST];             /* changes from the null */
  guint first;                  /* of its models */
  gdouble moved, gained;        /* by the last step, in priors and in evidence */
} Hypothesis;

/* What is the same for all hypotheses. */
typedef struct
{
  ClothDiagnosis *d;
  const ClothGapTest *test;
  const ClothModel *base;       /* the model without them */
  gdouble **z;                  /* of each take: features by model */
  ClothNormalEquations *null;   /* the equations without any of them */
  gdouble phi;                  /* how much more than noise a square counts */
  gdouble without;              /* logarithm of the probability without any of them */
} Refinement;

static void
refinement_clear (Refinement * refinement)
{
  for (guint t = 0; t < refinement->d->n_takes; t++)
    g_free (refinement->z[t]);
  g_free (refinement->z);
  cloth_normal_equations_free (refinement->null);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Refinement, refinement_clear);

/* Changes of its directions within their ranges. */
static void
keep_in_range (const ClothDiagnosis * d, Hypothesis * r)
{
  for (guint k = 0; k < r->candidate->n; k++) {
    const ClothDirection *direction =
        cloth_candidates_direction (d->candidates, r->candidate->first + k);
    const gdouble most = LONGEST * direction->prior;

    r->at[k] = CLAMP (r->at[k], MAX (-most, direction->low - direction->centre),
        MIN (most, direction->high - direction->centre));
    if (direction->one_sided && r->candidate->n == 1)
      r->at[k] = MAX (r->at[k], 0.);
  }
}

/* Half of a direction's step, as at the null the way to both sides is a whole one. */
static gdouble
difference_step (const ClothDiagnosis * d, const Hypothesis * r, guint k)
{
  return 0.5 * cloth_candidates_direction (d->candidates,
      r->candidate->first + k)->step;
}

/* Its model where it is, and there moved along each of its directions to both sides. */
static void
add_models (const Refinement * refinement, Hypothesis * r, GPtrArray * models)
{
  const guint n = r->candidate->n;
  guint directions[MOST];

  r->first = models->len;
  for (guint k = 0; k < n; k++)
    directions[k] = r->candidate->first + k;
  for (guint i = 0; i <= 2 * n; i++) {
    gdouble at[MOST];

    memcpy (at, r->at, sizeof at);
    if (i)
      at[(i - 1) / 2] += (i % 2 ? 1. : -1.) * difference_step (refinement->d, r,
          (i - 1) / 2);
    g_ptr_array_add (models,
        cloth_candidates_move (refinement->d->candidates, refinement->base,
            directions, at, n));
  }
}

/* Features of the residual of each model in each take. */
static gboolean
simulate (Refinement * refinement, GPtrArray * models, gboolean * sound,
    GError ** error)
{
  ClothDiagnosis *d = refinement->d;
  g_autofree gdouble **z = g_new (gdouble *, models->len);
  g_autofree gboolean *here = g_new (gboolean, models->len);

  for (guint i = 0; i < models->len; i++)
    sound[i] = TRUE;
  for (guint t = 0; t < d->n_takes; t++) {
    const ClothSensitivities *study = cloth_diagnosis_study (d, t);
    const gsize size = study->features->size;

    g_free (refinement->z[t]);
    refinement->z[t] = g_new0 (gdouble, models->len * size);
    for (guint i = 0; i < models->len; i++)
      z[i] = refinement->z[t] + i * size;
    if (!cloth_sensitivities_run (study, (ClothModel **) models->pdata,
            models->len, &d->study, z, here, error))
      return FALSE;
    for (guint i = 0; i < models->len; i++)
      sound[i] = sound[i] && here[i];
  }
  return TRUE;
}

/* The normal equations of a take at a hypothesis: as those of the test at the model without
 * it, and behind them its own directions. Its residual is the mean of its simulations, with
 * less variability. */
static ClothNormalEquations *
normal_of (const Refinement * refinement, const Hypothesis * r, guint take,
    guint before)
{
  const ClothDiagnosis *d = refinement->d;
  const ClothSensitivities *s = cloth_diagnosis_study (d, take);
  const gsize size = s->features->size;
  const guint n = r->candidate->n, others = s->m + d->n_variability;
  const gdouble *own = refinement->z[take] + r->first * size;
  g_autofree gdouble *columns =
      cloth_diagnosis_list_columns (d, take, before, n);
  g_autofree gdouble *z = g_new0 (gdouble, size);
  g_autoptr (ClothPowerSpectrum) weight = cloth_diagnosis_find_weight (d, take);

  for (guint i = 0; i <= 2 * n; i++)
    for (gsize k = 0; k < size; k++)
      z[k] += own[i * size + k] / (2 * n + 1);
  cloth_sensitivities_take_off_discrepancy (s, z);
  for (guint i = 0; i < n; i++)
    for (gsize k = 0; k < size; k++)
      columns[(others + i) * size + k] = (own[(1 + 2 * i) * size + k] -
          own[(2 + 2 * i) * size + k]) / (2. * difference_step (d, r, i));
  return cloth_normal_equations_new (s->features, weight, z, columns,
      others + n);
}

/* Those of all takes. */
static ClothNormalEquations *
sum_normals (const Refinement * refinement, const Hypothesis * r)
{
  ClothNormalEquations *normal = NULL;
  guint before = 0;

  for (guint t = 0; t < refinement->d->n_takes; t++) {
    normal =
        cloth_normal_equations_append (normal, normal_of (refinement, r, t,
            before));
    before +=
        cloth_sensitivities_count_variability (cloth_diagnosis_study
        (refinement->d, t));
  }
  return normal;
}

/* Takes a step from where a hypothesis is; the evidence is that of where it comes to, by the
 * derivatives here. */
static void
step (const Refinement * refinement, Hypothesis * r)
{
  const guint n = r->candidate->n;
  g_autoptr (ClothNormalEquations) here = sum_normals (refinement, r);
  ClothReducedEquations reduced;
  guint directions[MOST] = { 0 };
  gdouble by[MOST], precisions[MOST], means[MOST], covariance[MOST * MOST];
  gdouble log_det, square, log_bayes_factor;
  g_auto (ClothPosterior) posterior = { 0 };

  for (guint i = 0; i < n; i++)
    directions[i] = here->m - n + i;
  if (!cloth_gap_test_reduce (refinement->test, here, refinement->test->blocks,
          directions, n, &reduced))
    return;
  r->score->improvement = cloth_gap_test_improvement (refinement->test,
      r->score->candidate, refinement->null, here, directions, r->at,
      refinement->phi);
  for (guint i = 0; i < n; i++) {
    gdouble prior = cloth_candidates_direction (refinement->d->candidates,
        r->candidate->first + i)->prior;

    precisions[i] = 1. / (prior * prior);
    means[i] = -r->at[i];
  }
  cloth_posterior_init (&posterior, n);
  cloth_posterior_add_data (&posterior, reduced.g, reduced.s, refinement->phi);
  cloth_posterior_add_prior (&posterior, precisions, means);
  if (!cloth_posterior_solve (&posterior))
    return;
  log_det = cloth_posterior_log_determinant (&posterior);
  cloth_posterior_covariance (&posterior, covariance);
  for (guint i = 0; i < n; i++) {
    log_det -= log (precisions[i]);
    by[i] = r->at[i];
    r->at[i] += posterior.mean[i];
    r->score->sigmas[i] = sqrt (covariance[i * n + i]);
  }
  keep_in_range (refinement->d, r);
  square = reduced.r / refinement->phi;
  for (guint i = 0; i < n; i++) {
    gdouble prior = cloth_candidates_direction (refinement->d->candidates,
        r->candidate->first + i)->prior;

    by[i] = r->at[i] - by[i];
    r->moved = MAX (r->moved, fabs (by[i]) / prior);
    square += r->at[i] * r->at[i] * precisions[i] +
        2. * reduced.s[i] / refinement->phi * by[i];
    for (guint k = 0; k <= i; k++)
      square += (k < i ? 2. : 1.) * by[i] * by[k] * reduced.g[i * n + k] /
          refinement->phi;
  }
  log_bayes_factor = -0.5 * (square + log_det) - refinement->without -
      refinement->d->null_log_bayes_factors[r->score->candidate];
  r->gained = log_bayes_factor - r->score->log_bayes_factor;
  r->score->log_bayes_factor = log_bayes_factor;
  memcpy (r->score->changes, r->at, sizeof r->score->changes);
}

/* The residual without any effect, as that of the hypotheses freed of variability. */
static gboolean
start (Refinement * refinement)
{
  ClothDiagnosis *d = refinement->d;
  const ClothCandidate no_candidate = { NULL };
  const Hypothesis none = { NULL, &no_candidate };
  ClothReducedEquations reduced;

  refinement->z = g_new0 (gdouble *, d->n_takes);
  for (guint t = 0; t < d->n_takes; t++) {
    const ClothSensitivities *s = cloth_diagnosis_study (d, t);
    const gsize size = s->features->size;

    refinement->z[t] = g_memdup2 (s->z, size * sizeof (gdouble));
    for (gsize k = 0; s->n_variability && k < size; k++)
      refinement->z[t][k] -= s->variability[(s->n_variability - 1) * size + k];
  }
  refinement->null = sum_normals (refinement, &none);
  if (!cloth_gap_test_reduce (refinement->test, refinement->null,
          refinement->test->blocks, NULL, 0, &reduced))
    return FALSE;
  refinement->phi =
      cloth_gap_test_dispersion (refinement->test, refinement->test->normal,
      &reduced);
  refinement->without = -0.5 * reduced.r / refinement->phi;
  return TRUE;
}

static void
list_hypotheses (const Refinement * refinement, GArray * scores, gdouble least,
    GArray * hypotheses)
{
  const ClothDiagnosis *d = refinement->d;

  for (guint i = 0; i < scores->len && hypotheses->len < MOST_HYPOTHESES; i++) {
    ClothGapScore *s = &g_array_index (scores, ClothGapScore, i);
    Hypothesis r = { s, cloth_diagnosis_candidate (d, s) };

    if (!(s->log_bayes_factor > least)
        || cloth_candidate_is_stochastic (r.candidate))
      continue;
    memcpy (r.at, s->changes, sizeof s->changes);
    keep_in_range (d, &r);
    g_array_append_val (hypotheses, r);
  }
}

/* One step of each. */
static gboolean
step_all (Refinement * refinement, GArray * hypotheses, GError ** error)
{
  g_autoptr (GPtrArray) models =
      g_ptr_array_new_with_free_func ((GDestroyNotify) cloth_model_free);
  g_autofree gboolean *sound = NULL;

  for (guint i = 0; i < hypotheses->len; i++)
    add_models (refinement, &g_array_index (hypotheses, Hypothesis, i), models);
  sound = g_new (gboolean, models->len);
  if (!simulate (refinement, models, sound, error))
    return FALSE;
  for (guint i = 0; i < hypotheses->len; i++) {
    Hypothesis *r = &g_array_index (hypotheses, Hypothesis, i);
    gboolean ok = TRUE;

    for (guint k = 0; k <= 2 * r->candidate->n; k++)
      ok = ok && sound[r->first + k];
    r->moved = r->gained = 0.;
    if (ok)
      step (refinement, r);
  }
  return TRUE;
}

/* @d: a diagnosis whose takes are linearised at @base
 * @test: the test that @scores are of
 * @scores: (element-type ClothGapScore): the effects, the likeliest first
 * @base: the model without them
 * @error: #ClothSimError
 *
 * Derivatives at the null may not hold where the residual asks an effect to be. The
 * likeliest of those that are supported get simulations of their own, and with them new
 * changes and a new evidence, against the same residual without any of them.
 *
 * Returns: whether that could be simulated
 */
gboolean
cloth_diagnosis_refine_hypotheses (ClothDiagnosis * d,
    const ClothGapTest * test, GArray * scores, const ClothModel * base,
    GError ** error)
{
  g_auto (Refinement) refinement = { d, test, base };
  g_autoptr (GArray) hypotheses =
      g_array_new (FALSE, FALSE, sizeof (Hypothesis));

  if (!start (&refinement))
    return TRUE;
  /* the first ones are named, later ones only accepted */
  list_hypotheses (&refinement, scores,
      d->n_accepted ? d->least_log_bayes_factor : 0., hypotheses);
  for (guint i = 0; i < N_STEPS && hypotheses->len; i++) {
    if (!step_all (&refinement, hypotheses, error))
      return FALSE;
    for (guint k = hypotheses->len; k-- > 0;) {
      const Hypothesis *r = &g_array_index (hypotheses, Hypothesis, k);

      if (r->moved < FAR || r->gained < MUCH)
        g_array_remove_index (hypotheses, k);
    }
  }
  g_array_sort (scores, cloth_gap_score_compare);
  return TRUE;
}
