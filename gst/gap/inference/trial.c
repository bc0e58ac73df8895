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

#include "gst/math/linalg.h"

/* So many effects at most, each for so many steps of Gauss and Newton at most, as long as it
 * moves by this share of a prior and gains so much evidence. */
#define MOST_RIVALS 12
#define N_STEPS 6
#define FAR 0.1
#define MUCH CLOTH_DIAGNOSIS_LEAST_EVIDENCE
/* No effect goes further than so many priors. */
#define LONGEST 3.

/* An effect on trial. */
typedef struct
{
  ClothGapScore *score;
  const ClothCandidate *candidate;
  gdouble at[CLOTH_EFFECT_MAX_PARAMETERS];      /* changes from the null */
  guint first;                  /* of its models */
  gdouble moved, gained;        /* by the last step, in priors and in evidence */
} Rival;

/* Of all rivals: what is the same for each. */
typedef struct
{
  ClothDiagnosis *d;
  const ClothGapTest *test;
  const ClothModel *base;       /* the model without them */
  gdouble **z;                  /* of each take: features by model */
  ClothNormalEquations *null;   /* the equations without any of them */
  gdouble phi;                  /* how much more than noise a square counts */
  gdouble without;              /* logarithm of the probability without any of them */
} Court;

static void
court_clear (Court * court)
{
  for (guint t = 0; t < court->d->n_takes; t++)
    g_free (court->z[t]);
  g_free (court->z);
  cloth_normal_equations_free (court->null);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Court, court_clear);

/* Changes of its directions within their ranges. */
static void
keep_in_range (const ClothDiagnosis * d, Rival * r)
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
step_of (const ClothDiagnosis * d, const Rival * r, guint k)
{
  return 0.5 * cloth_candidates_direction (d->candidates,
      r->candidate->first + k)->step;
}

/* Its model where it is, and there moved along each of its directions to both sides. */
static void
add_models (const Court * court, Rival * r, GPtrArray * models)
{
  const guint n = r->candidate->n;
  guint directions[CLOTH_EFFECT_MAX_PARAMETERS];

  r->first = models->len;
  for (guint k = 0; k < n; k++)
    directions[k] = r->candidate->first + k;
  for (guint i = 0; i <= 2 * n; i++) {
    gdouble at[CLOTH_EFFECT_MAX_PARAMETERS];

    memcpy (at, r->at, sizeof at);
    if (i)
      at[(i - 1) / 2] += (i % 2 ? 1. : -1.) * step_of (court->d, r,
          (i - 1) / 2);
    g_ptr_array_add (models,
        cloth_candidates_move (court->d->candidates, court->base,
            directions, at, n));
  }
}

/* Features of the residual of each model in each take. */
static gboolean
simulate (Court * court, GPtrArray * models, gboolean * sound, GError ** error)
{
  ClothDiagnosis *d = court->d;
  g_autofree gdouble **z = g_new (gdouble *, models->len);
  g_autofree gboolean *here = g_new (gboolean, models->len);

  for (guint i = 0; i < models->len; i++)
    sound[i] = TRUE;
  for (guint t = 0; t < d->n_takes; t++) {
    const ClothSensitivities *study = cloth_diagnosis_study (d, t);
    const gsize size = study->features->size;

    g_free (court->z[t]);
    court->z[t] = g_new0 (gdouble, models->len * size);
    for (guint i = 0; i < models->len; i++)
      z[i] = court->z[t] + i * size;
    if (!cloth_sensitivities_run (study, (ClothModel **) models->pdata,
            models->len, &d->study, z, here, error))
      return FALSE;
    for (guint i = 0; i < models->len; i++)
      sound[i] = sound[i] && here[i];
  }
  return TRUE;
}

/* The normal equations of a take where a rival is: as those of the test at the model without
 * it, and behind them its own directions. Its residual is the mean of its simulations, with
 * less variability. */
static ClothNormalEquations *
normal_of (const Court * court, const Rival * r, guint take, guint before)
{
  const ClothDiagnosis *d = court->d;
  const ClothSensitivities *s = cloth_diagnosis_study (d, take);
  const gsize size = s->features->size;
  const guint n = r->candidate->n, others = s->m + d->n_variability;
  const gdouble *own = court->z[take] + r->first * size;
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
          own[(2 + 2 * i) * size + k]) / (2. * step_of (d, r, i));
  return cloth_normal_equations_new (s->features, weight, z, columns,
      others + n);
}

/* Those of all takes. */
static ClothNormalEquations *
all_normals (const Court * court, const Rival * r)
{
  ClothNormalEquations *normal = NULL;
  guint before = 0;

  for (guint t = 0; t < court->d->n_takes; t++) {
    normal =
        cloth_normal_equations_append (normal, normal_of (court, r, t, before));
    before +=
        cloth_sensitivities_count_variability (cloth_diagnosis_study (court->d,
            t));
  }
  return normal;
}

/* Takes a step from where a rival is; the evidence is that of where it comes to, by the
 * derivatives here. */
static void
step (const Court * court, Rival * r)
{
  const guint n = r->candidate->n;
  g_autoptr (ClothNormalEquations) here = all_normals (court, r);
  ClothReducedEquations reduced;
  guint directions[CLOTH_EFFECT_MAX_PARAMETERS] = { 0 };
  gdouble a[16], inverse[16], by[4], log_det = 0., square, evidence;

  for (guint i = 0; i < n; i++)
    directions[i] = here->m - n + i;
  if (!cloth_gap_test_reduce (court->test, here, court->test->blocks,
          directions, n, &reduced))
    return;
  r->score->improvement = cloth_gap_test_improvement (court->test,
      r->score->candidate, court->null, here, directions, r->at, court->phi);
  for (guint i = 0; i < n; i++) {
    gdouble prior = cloth_candidates_direction (court->d->candidates,
        r->candidate->first + i)->prior;

    for (guint k = 0; k < n; k++)
      a[i * n + k] = reduced.g[i * n + k] / court->phi;
    a[i * n + i] += 1. / (prior * prior);
    log_det += 2. * log (prior);
    by[i] = -reduced.s[i] / court->phi - r->at[i] / (prior * prior);
  }
  if (!cloth_cholesky_factor (n, a))
    return;
  for (guint i = 0; i < n; i++)
    log_det += 2. * log (a[i * n + i]);
  cloth_cholesky_solve (n, a, by);
  cloth_cholesky_inverse (n, a, inverse);
  for (guint i = 0; i < n; i++) {
    gdouble from = r->at[i];

    r->at[i] += by[i];
    by[i] = from;
    r->score->sigmas[i] = sqrt (inverse[i * n + i]);
  }
  keep_in_range (court->d, r);
  square = reduced.r / court->phi;
  for (guint i = 0; i < n; i++) {
    gdouble prior = cloth_candidates_direction (court->d->candidates,
        r->candidate->first + i)->prior;

    by[i] = r->at[i] - by[i];
    r->moved = MAX (r->moved, fabs (by[i]) / prior);
    square += r->at[i] * r->at[i] / (prior * prior) +
        2. * reduced.s[i] / court->phi * by[i];
    for (guint k = 0; k <= i; k++)
      square += (k < i ? 2. : 1.) * by[i] * by[k] * reduced.g[i * n + k] /
          court->phi;
  }
  evidence = -0.5 * (square + log_det) - court->without -
      court->d->null_evidence[r->score->candidate];
  r->gained = evidence - r->score->evidence;
  r->score->evidence = evidence;
  memcpy (r->score->changes, r->at, sizeof r->score->changes);
}

/* The residual without any rival, as that of the rivals freed of variability. */
static gboolean
open_court (Court * court)
{
  ClothDiagnosis *d = court->d;
  const ClothCandidate none = { NULL };
  const Rival nobody = { NULL, &none };
  ClothReducedEquations reduced;

  court->z = g_new0 (gdouble *, d->n_takes);
  for (guint t = 0; t < d->n_takes; t++) {
    const ClothSensitivities *s = cloth_diagnosis_study (d, t);
    const gsize size = s->features->size;

    court->z[t] = g_memdup2 (s->z, size * sizeof (gdouble));
    for (gsize k = 0; s->n_variability && k < size; k++)
      court->z[t][k] -= s->variability[(s->n_variability - 1) * size + k];
  }
  court->null = all_normals (court, &nobody);
  if (!cloth_gap_test_reduce (court->test, court->null, court->test->blocks,
          NULL, 0, &reduced))
    return FALSE;
  court->phi = cloth_gap_test_dispersion (court->test, court->test->normal,
      &reduced);
  court->without = -0.5 * reduced.r / court->phi;
  return TRUE;
}

static void
list_rivals (const Court * court, GArray * scores, gdouble least,
    GArray * rivals)
{
  const ClothDiagnosis *d = court->d;

  for (guint i = 0; i < scores->len && rivals->len < MOST_RIVALS; i++) {
    ClothGapScore *s = &g_array_index (scores, ClothGapScore, i);
    Rival r = { s, cloth_diagnosis_candidate (d, s) };

    if (!(s->evidence > least) || cloth_candidate_is_gust (r.candidate))
      continue;
    memcpy (r.at, s->changes, sizeof s->changes);
    keep_in_range (d, &r);
    g_array_append_val (rivals, r);
  }
}

/* One step of each. */
static gboolean
go (Court * court, GArray * rivals, GError ** error)
{
  g_autoptr (GPtrArray) models =
      g_ptr_array_new_with_free_func ((GDestroyNotify) cloth_model_free);
  g_autofree gboolean *sound = NULL;

  for (guint i = 0; i < rivals->len; i++)
    add_models (court, &g_array_index (rivals, Rival, i), models);
  sound = g_new (gboolean, models->len);
  if (!simulate (court, models, sound, error))
    return FALSE;
  for (guint i = 0; i < rivals->len; i++) {
    Rival *r = &g_array_index (rivals, Rival, i);
    gboolean ok = TRUE;

    for (guint k = 0; k <= 2 * r->candidate->n; k++)
      ok = ok && sound[r->first + k];
    r->moved = r->gained = 0.;
    if (ok)
      step (court, r);
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
 * likeliest of those that are asked for get simulations of their own, and with them new
 * changes and a new evidence, against the same residual without any of them.
 *
 * Returns: whether that could be simulated
 */
gboolean
cloth_diagnosis_try_rivals (ClothDiagnosis * d, const ClothGapTest * test,
    GArray * scores, const ClothModel * base, GError ** error)
{
  g_auto (Court) court = { d, test, base };
  g_autoptr (GArray) rivals = g_array_new (FALSE, FALSE, sizeof (Rival));

  if (!open_court (&court))
    return TRUE;
  /* the first ones are named, later ones only taken in */
  list_rivals (&court, scores, d->n_chosen ? d->least_evidence : 0., rivals);
  for (guint i = 0; i < N_STEPS && rivals->len; i++) {
    if (!go (&court, rivals, error))
      return FALSE;
    for (guint k = rivals->len; k-- > 0;) {
      const Rival *r = &g_array_index (rivals, Rival, k);

      if (r->moved < FAR || r->gained < MUCH)
        g_array_remove_index (rivals, k);
    }
  }
  g_array_sort (scores, cloth_gap_score_compare);
  return TRUE;
}
