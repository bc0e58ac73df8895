/* A recording under study.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/study.h"

#include <math.h>
#include <string.h>

#include "gst/gap/diagnose.h"
#include "gst/math/linalg.h"

/* No step of a fit is longer than this many priors. */
#define LONGEST 1.5
/* A fit ends when it gains less than this share. */
#define ENOUGH 2e-3

void
cloth_study_options_init (ClothStudyOptions * options)
{
  *options = (ClothStudyOptions) {
  .gains = { 100., 1600. },.n_waves = 8,.block_s = 0.5,.highest_hz =
        10.,.overdispersion = 5.};
}

/**
 * cloth_study_new:
 * @recording: a recording; must outlive the study
 * @options: how to study it
 *
 * Since: 0.1
 */
ClothStudy *
cloth_study_new (const ClothRecording * recording,
    const ClothStudyOptions * options)
{
  ClothStudy *study = g_new0 (ClothStudy, 1);

  study->recording = recording;
  study->features = cloth_gap_features_new (recording, options->n_waves,
      options->block_s, options->highest_hz);
  return study;
}

static void
forget (ClothStudy * study)
{
  for (guint g = 0; g < CLOTH_STUDY_N_GAINS; g++) {
    g_clear_pointer (&study->z[g], g_free);
    g_clear_pointer (&study->columns[g], g_free);
  }
  g_clear_pointer (&study->sound, g_free);
}

/**
 * cloth_study_free:
 * @study: (nullable) (transfer full): a study
 *
 * Since: 0.1
 */
void
cloth_study_free (ClothStudy * study)
{
  if (!study)
    return;
  forget (study);
  cloth_gap_features_free (study->features);
  g_free (study);
}

typedef struct
{
  const ClothStudy *study;
  gdouble **z;                  /* of each model */
} Collect;

static void
collect (gpointer data, guint model, guint frame, const gdouble * positions)
{
  Collect *c = data;

  cloth_gap_features_add (c->study->features, c->study->recording, frame,
      positions, c->z[model]);
}

/* Features of the models' residuals: z[gain * n + model], each of features->size. */
static gboolean
run (const ClothStudy * study, ClothModel ** models, guint n,
    ClothStudyOptions * options, gdouble ** z, gboolean * sound,
    GError ** error)
{
  guint all = n * CLOTH_STUDY_N_GAINS;
  g_autofree const ClothModel **lanes = g_new (const ClothModel *, all);
  g_autofree gdouble *gains = g_new (gdouble, all);
  g_autofree gboolean *ok = g_new (gboolean, all);
  Collect c = { study, z };

  for (guint i = 0; i < all; i++) {
    lanes[i] = models[i % n];
    gains[i] = options->gains[i / n];
  }
  options->simulations += all;
  if (!cloth_rollout_nudged (study->recording, lanes, gains, all,
          &options->rollout, collect, &c, ok, error))
    return FALSE;
  for (guint i = 0; i < n; i++) {
    sound[i] = TRUE;
    for (guint g = 0; g < CLOTH_STUDY_N_GAINS; g++)
      sound[i] = sound[i] && ok[g * n + i];
  }
  return TRUE;
}

/**
 * cloth_study_linearise:
 * @study: a study
 * @candidates: what directions mean
 * @model: where to take derivatives
 * @directions: (array length=m): with respect to what
 * @m: how many
 * @options: how
 * @error: #ClothSimError, or #ClothGapError when the model itself can't be simulated
 *
 * Fills @study's z, columns and sound. Directions along which the simulation fails have
 * columns of zeros.
 *
 * Since: 0.1
 */
gboolean
cloth_study_linearise (ClothStudy * study,
    const ClothGapCandidates * candidates, const ClothModel * model,
    const guint * directions, guint m, ClothStudyOptions * options,
    GError ** error)
{
  gsize size = study->features->size;
  guint n = m + 1;
  g_autoptr (GPtrArray) models = g_ptr_array_new_with_free_func (
      (GDestroyNotify) cloth_model_free);
  g_autofree gdouble **z = g_new (gdouble *, n * CLOTH_STUDY_N_GAINS);
  g_autofree gboolean *sound = g_new (gboolean, n);

  forget (study);
  study->m = m;
  g_ptr_array_add (models, cloth_model_copy (model));
  for (guint i = 0; i < m; i++) {
    const ClothGapDirection *d = &g_array_index (candidates->directions,
        ClothGapDirection, directions[i]);

    g_ptr_array_add (models, cloth_gap_candidates_move (candidates, model,
            &directions[i], &d->step, 1));
  }
  for (guint g = 0; g < CLOTH_STUDY_N_GAINS; g++) {
    study->z[g] = g_new0 (gdouble, size);
    study->columns[g] = g_new0 (gdouble, m * size + 1);
    for (guint i = 0; i < n; i++)
      z[g * n + i] = i ? study->columns[g] + (i - 1) * size : study->z[g];
  }
  study->sound = g_new0 (gboolean, m + 1);
  if (!run (study, (ClothModel **) models->pdata, n, options, z, sound, error))
    return FALSE;
  if (!sound[0]) {
    g_set_error (error, CLOTH_GAP_ERROR, CLOTH_GAP_ERROR_MODEL, "%s: the "
        "simulation diverges; give the model softer cloth, more damping or a "
        "smaller time_step", study->recording->name);
    return FALSE;
  }
  for (guint i = 0; i < m; i++) {
    const ClothGapDirection *d = &g_array_index (candidates->directions,
        ClothGapDirection, directions[i]);

    study->sound[i] = sound[i + 1];
    for (guint g = 0; g < CLOTH_STUDY_N_GAINS; g++) {
      gdouble *column = study->columns[g] + i * size;

      for (gsize k = 0; k < size; k++)
        column[k] = sound[i + 1] ? (column[k] - study->z[g][k]) / d->step : 0.;
    }
  }
  return TRUE;
}

static gdouble
cost_of (const ClothGapNormal * normal, const gboolean * blocks)
{
  gdouble cost = 0.;

  for (guint b = 0; b < normal->n_blocks; b++)
    if (!blocks || blocks[b])
      cost += normal->r[b];
  return cost;
}

/* Of models along a step; the power that weighs is that of where they come from. */
static gboolean
try_models (ClothStudy * study, ClothGapPower ** powers, ClothModel ** models,
    guint n, const gboolean * blocks, ClothStudyOptions * options,
    gdouble * costs, GError ** error)
{
  gsize size = study->features->size;
  guint all = n * CLOTH_STUDY_N_GAINS;
  g_autofree gdouble *memory = g_new0 (gdouble, all * size);
  g_autofree gdouble **z = g_new (gdouble *, all);
  g_autofree gboolean *sound = g_new (gboolean, n);

  for (guint i = 0; i < all; i++)
    z[i] = memory + i * size;
  if (!run (study, models, n, options, z, sound, error))
    return FALSE;
  for (guint i = 0; i < all; i++) {
    g_autoptr (ClothGapNormal) normal = cloth_gap_normal_new (study->features,
        powers[i / n], 1., z[i], NULL, 0);

    costs[i % n] += sound[i % n] ? cost_of (normal, blocks) : INFINITY;
  }
  return TRUE;
}

/* Adds a study's normal equations to a, b; returns its cost. */
static gdouble
add_study (const ClothStudy * study, ClothGapPower ** powers,
    const gboolean * blocks, gdouble * a, gdouble * b)
{
  guint m = study->m;
  gdouble cost = 0.;

  for (guint g = 0; g < CLOTH_STUDY_N_GAINS; g++) {
    g_autoptr (ClothGapNormal) normal = NULL;

    powers[g] = cloth_gap_power_new (study->features, study->z[g]);
    normal = cloth_gap_normal_new (study->features, powers[g], 1.,
        study->z[g], study->columns[g], m);
    cost += cost_of (normal, blocks);
    for (guint block = 0; block < normal->n_blocks; block++) {
      if (blocks && !blocks[block])
        continue;
      for (guint i = 0; i < m * m; i++)
        a[i] += normal->g[(gsize) block * m * m + i];
      for (guint i = 0; i < m; i++)
        b[i] += normal->s[(gsize) block * m + i];
    }
  }
  return cost;
}

static void
free_powers (gpointer data)
{
  cloth_gap_power_free (data);
}

/* One step of Gauss and Newton; 0 when none makes it better, else the share gained. */
static gboolean
improve (ClothStudy ** studies, guint n_studies,
    const ClothGapCandidates * candidates, ClothModel ** model,
    const guint * directions, const gdouble * precisions, guint m,
    gdouble * moved, const gboolean * blocks, ClothStudyOptions * options,
    gdouble * sigmas, gdouble * gained, GError ** error)
{
  static const gdouble shares[] = { 1., 0.5, 0.2 };
  const guint n_shares = G_N_ELEMENTS (shares);
  g_autofree gdouble *a = g_new0 (gdouble, m * m), *b = g_new0 (gdouble, m);
  g_autofree gdouble *step = g_new (gdouble, m * n_shares);
  g_autoptr (GPtrArray) powers = g_ptr_array_new_with_free_func (free_powers);
  ClothModel *tried[G_N_ELEMENTS (shares)];
  gdouble costs[G_N_ELEMENTS (shares)] = { 0. }, now = 0.;
  guint best = 0;

  *gained = 0.;
  g_ptr_array_set_size (powers, (gint) (n_studies * CLOTH_STUDY_N_GAINS));
  for (guint s = 0; s < n_studies; s++) {
    if (!cloth_study_linearise (studies[s], candidates, *model, directions, m,
            options, error))
      return FALSE;
    now += add_study (studies[s],
        (ClothGapPower **) powers->pdata + s * CLOTH_STUDY_N_GAINS, blocks, a,
        b);
  }
  for (guint i = 0; i < m; i++) {
    for (guint j = 0; j < m; j++)
      a[i * m + j] /= options->overdispersion;
    a[i * m + i] += precisions[i];
    b[i] = -b[i] / options->overdispersion - precisions[i] * moved[i];
    now += options->overdispersion * precisions[i] * moved[i] * moved[i];
  }
  if (!cloth_cholesky_factor (m, a))
    return TRUE;
  cloth_cholesky_solve (m, a, b);
  if (sigmas) {
    g_autofree gdouble *inverse = g_new (gdouble, m * m);

    cloth_cholesky_inverse (m, a, inverse);
    for (guint i = 0; i < m; i++)
      sigmas[i] = sqrt (inverse[i * m + i]);
  }
  for (guint t = 0; t < n_shares; t++) {
    for (guint i = 0; i < m; i++) {
      const ClothGapDirection *d = &g_array_index (candidates->directions,
          ClothGapDirection, directions[i]);

      step[t * m + i] = shares[t] * CLAMP (b[i], -LONGEST * d->prior,
          LONGEST * d->prior);
    }
    tried[t] = cloth_gap_candidates_move (candidates, *model, directions,
        step + t * m, m);
  }
  for (guint s = 0; s < n_studies; s++)
    if (!try_models (studies[s],
            (ClothGapPower **) powers->pdata + s * CLOTH_STUDY_N_GAINS, tried,
            n_shares, blocks, options, costs, error)) {
      for (guint t = 0; t < n_shares; t++)
        cloth_model_free (tried[t]);
      return FALSE;
    }
  for (guint t = 0; t < n_shares; t++) {
    for (guint i = 0; i < m; i++) {
      gdouble at = moved[i] + step[t * m + i];

      costs[t] += options->overdispersion * precisions[i] * at * at;
    }
    if (costs[t] < costs[best])
      best = t;
  }
  if (costs[best] < now) {
    *gained = (now - costs[best]) / now;
    cloth_model_free (*model);
    *model = cloth_model_copy (tried[best]);
    for (guint i = 0; i < m; i++)
      moved[i] += step[best * m + i];
  }
  for (guint t = 0; t < n_shares; t++)
    cloth_model_free (tried[t]);
  return TRUE;
}

/**
 * cloth_study_fit:
 * @studies: (array length=n_studies): recordings that are fitted together
 * @n_studies: how many
 * @candidates: what directions mean
 * @model: where to start
 * @directions: (array length=m): what is fitted
 * @precisions: (array length=m): of their priors, centred at @model
 * @m: how many
 * @blocks: (nullable): which blocks of time count
 * @n_iterations: at most
 * @options: how
 * @sigmas: (out) (nullable) (array length=m): standard deviations
 * @error: #ClothSimError or #ClothGapError
 *
 * Gauss and Newton on the features of both gains, each weighed by the power that is left
 * in its class.
 *
 * Returns: (transfer full) (nullable): the fitted model
 * Since: 0.1
 */
ClothModel *
cloth_study_fit (ClothStudy ** studies, guint n_studies,
    const ClothGapCandidates * candidates, const ClothModel * model,
    const guint * directions, const gdouble * precisions, guint m,
    const gboolean * blocks, guint n_iterations, ClothStudyOptions * options,
    gdouble * sigmas, GError ** error)
{
  g_autoptr (ClothModel) fitted = cloth_model_copy (model);
  g_autofree gdouble *moved = g_new0 (gdouble, m + 1);

  for (guint i = 0; i < n_iterations && m; i++) {
    gdouble gained;

    if (!improve (studies, n_studies, candidates, &fitted, directions,
            precisions, m, moved, blocks, options, sigmas, &gained, error))
      return NULL;
    if (gained < ENOUGH)
      break;
  }
  return g_steal_pointer (&fitted);
}
