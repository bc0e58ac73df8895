/* Decides in which order the effects are named: assembles the normal equations of the takes, tests
 * all candidates, and turns their log Bayes factors into probabilities.
 *
 * Model: z = simulated − recorded − discrepancy (Kennedy and O'Hagan 2001). Where a baseline moves
 * alike, the discrepancy is its residual; else it is only a variance, class by class of features.
 * A feature's weight is 1/(1 + d), with noise as the unit of variance and d the discrepancy's
 * variance or, once a leading effect is known, the variance of the residual that it leaves.
 * Directions of run-to-run variability are nuisances with the variance of their samples.
 * Formulas:
 *   probability = softmax of log Bayes factor/1.5 against none, then calibrated (Platt 1999)
 *   effects of like probability, or of derivatives with a cosine over 0.9, form a group
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/inference/name.h"

#include <math.h>
#include <string.h>

#include "gst/gap/camera/candidates.h"
#include "gst/gap/inference/gust.h"

/* Clamps that are never further apart than this move alike, m. */
#define SAME_PATH 1e-3
/* What two takes of one motion share of the simulator's own error is taken off; this
 * part of its power stays. */
#define LEAST_DISCREPANCY 0.1
/* So often what a leading effect leaves in a take is what weighs, and all are tested
 * anew. */
#define N_SHARPEN 2
/* Evidence is divided by this before it becomes a probability. */
#define TEMPERATURE 1.5
/* Then it still says too much: what evidence of simulators that are off by other things, too,
 * is worth comes from 634 blind cases (logistic calibration of the log-odds: Platt 1999). */
#define ODDS_SHIFT -0.9
#define ODDS_SLOPE_AGAINST 0.6
#define ODDS_SLOPE_FOR 0.22
#define LARGEST_LOG_ODDS 16.
/* Effects this likely beside the best are reported together with it, and much less likely
 * ones with derivatives this alike: then priors alone part them. */
#define AMBIGUOUS_SHARE 0.3
#define ALIKE_SHARE 0.005
#define ALIKE_COSINE 0.9
/* Most effects that are reported together. */
#define MOST_AMBIGUOUS 4

/* Notes why an effect is no candidate. Camera effects are tested elsewhere. */
static void
skip (gpointer data, const ClothEffect * effect, const gchar * reason)
{
  ClothDiagnosis *d = data;

  if (effect->side == CLOTH_EFFECT_CAMERA || effect->side == CLOTH_EFFECT_IMAGE) {
    const gchar *blind = effect->untested;

    if (d->has_camera_errors && !blind)
      return;
    if (cloth_diagnosis_has_observations (d))
      reason = blind ? blind : "No point was seen by two cameras at a time.";
  }
  cloth_gap_result_add_untested (d->result, effect, reason);
}

/* @d: a diagnosis whose recordings are loaded and whose cameras are checked
 * @model: what the simulator knows
 * @error: #ClothFitError
 *
 * Lists the model's free numbers and the effects to test, as directions.
 *
 * Returns: whether that is possible
 */
gboolean
cloth_diagnosis_list_candidates (ClothDiagnosis * d, const ClothModel * model,
    GError ** error)
{
  guint n;

  d->candidates =
      cloth_candidates_new (model, cloth_diagnosis_recording (d, 0),
      d->options->effects, cloth_diagnosis_n_references (d) > 0, skip, d,
      error);
  if (!d->candidates)
    return FALSE;
  n = d->candidates->directions->len;
  d->all = g_new (guint, n + 1);
  for (guint i = 0; i < n; i++)
    d->all[i] = i;
  d->precisions = g_new (gdouble, d->candidates->n_free + 1);
  d->sound = g_new (gboolean, n + 1);
  d->null_log_bayes_factors = g_new0 (gdouble, d->candidates->list->len + 1);
  return TRUE;
}

static gboolean
moves_alike (const ClothRecording * a, const ClothRecording * b)
{
  const ClothScene *s = a->scene, *t = b->scene;

  if (a->n_frames != b->n_frames || s->held->len != t->held->len
      || a->times[a->n_frames - 1] != b->times[b->n_frames - 1])
    return FALSE;
  for (guint i = 0; i < s->held->len; i++) {
    const ClothHeld *p = &g_array_index (s->held, ClothHeld, i);
    const ClothHeld *q = &g_array_index (t->held, ClothHeld, i);

    if (p->vertex != q->vertex || p->from_s != q->from_s
        || p->until_s != q->until_s)
      return FALSE;
  }
  for (gsize i = 0; i < 3 * (gsize) a->n_frames * s->held->len; i++)
    if (!(fabs (s->clamps[i] - t->clamps[i]) < SAME_PATH))
      return FALSE;
  return TRUE;
}

/* What one of them did not see counts in neither: what is taken off must be what is there. */
static void
see_alike (ClothRecording * a, ClothRecording * b)
{
  gsize all = (gsize) a->n_frames * a->n;

  for (gsize i = 0; i < all; i++)
    a->seen[i] = b->seen[i] = a->seen[i] * b->seen[i];
}

/* Each study's discrepancy: that of its twin, else that of the baseline that moves alike, if
 * there is one. A twin is what it is. */
void
cloth_diagnosis_find_discrepancies (ClothDiagnosis * d)
{
  const guint end = d->n_takes + d->options->n_baselines;

  for (guint i = 0; i < end; i++) {
    ClothSensitivities *study = cloth_diagnosis_study (d, i);

    if (cloth_diagnosis_twin (d, i))
      study->discrepancy = cloth_diagnosis_study (d, end + i);
    for (guint k = d->n_takes; k < end && !study->discrepancy; k++)
      if (i != k && moves_alike (study->recording,
              cloth_diagnosis_study (d, k)->recording))
        study->discrepancy = cloth_diagnosis_study (d, k);
  }
  /* twice, for those that share a baseline */
  for (guint i = 0; i < 2 * end; i++) {
    const ClothSensitivities *study = cloth_diagnosis_study (d, i % end);

    for (guint k = d->n_takes; study->discrepancy && k < end; k++)
      if (cloth_diagnosis_study (d, k) == study->discrepancy)
        see_alike (cloth_diagnosis_recording (d, i % end),
            cloth_diagnosis_recording (d, k));
  }
}

/* Mean square that the simulator itself is off by, in the noise of a take: of the
 * baselines, else of the takes with the model fitted to them. */
ClothPowerSpectrum *
cloth_diagnosis_find_discrepancy_variance (const ClothDiagnosis * d, guint take)
{
  gdouble unit = cloth_diagnosis_study (d, take)->features->sigma;
  guint references = cloth_diagnosis_n_references (d);
  guint begin = references ? d->n_takes : 0;
  guint n = references ? references : d->n_takes;
  ClothPowerSpectrum *mean = NULL;

  for (guint i = begin; i < begin + n; i++) {
    const ClothSensitivities *study = cloth_diagnosis_study (d, i);
    gdouble scale = study->features->sigma / unit;
    ClothPowerSpectrum *power = cloth_power_spectrum_new (study->features,
        study->z);

    for (guint k = 0; k < power->n; k++)
      power->values[k] *= scale * scale;
    if (!mean) {
      mean = power;
      continue;
    }
    for (guint k = 0; k < mean->n; k++)
      mean->values[k] += (power->values[k] - mean->values[k]) / (i - begin + 1);
    cloth_power_spectrum_free (power);
  }
  return mean;
}

/* What weighs in a take: the power that is left to doubt, else the mismatch. */
ClothPowerSpectrum *
cloth_diagnosis_find_weight (const ClothDiagnosis * d, guint take)
{
  const ClothSensitivities *s = cloth_diagnosis_study (d, take);

  return s->
      residual_variance ? cloth_power_spectrum_copy (s->residual_variance) :
      cloth_diagnosis_find_discrepancy_variance (d, take);
}

/* Gusts, if they are looked for in a study, else NULL. */
static const ClothCandidate *
find_gusts (const ClothDiagnosis * d, const ClothSensitivities * study)
{
  const GArray *list = d->candidates->list;

  /* fits have derivatives of their own only */
  for (guint i = 0; study->m == d->candidates->directions->len && i < list->len;
      i++) {
    const ClothCandidate *c = &g_array_index (list, ClothCandidate, i);

    if (cloth_candidate_is_stochastic (c) && d->sound[c->first]
        && d->sound[c->first + 1])
      return c;
  }
  return NULL;
}

/* The columns of the directions and behind them, where no other take has any, those of the
 * variability: as many are @before it; last room for @more. */
gdouble *
cloth_diagnosis_list_columns (const ClothDiagnosis * d, guint take,
    guint before, guint more)
{
  const ClothSensitivities *s = cloth_diagnosis_study (d, take);
  gsize size = s->features->size;
  gdouble *columns =
      g_new0 (gdouble, (s->m + d->n_variability + more) * size + 1);

  memcpy (columns, s->columns, s->m * size * sizeof (gdouble));
  cloth_sensitivities_get_variability (s, columns + (s->m + before) * size);
  return columns;
}

/* The discrepancy of the simulator's own error in a take is that of a baseline that moves
 * alike: taken off, a tenth of its power is left to doubt. The wind in the parts of the
 * blocks comes last, if gusts are looked for. */
static ClothNormalEquations *
normal_of (const ClothDiagnosis * d, guint take, guint before)
{
  const ClothSensitivities *s = cloth_diagnosis_study (d, take);
  const ClothCandidate *gusts = find_gusts (d, s);
  const guint more = gusts ? CLOTH_GAP_GUST_COLUMNS : 0;
  const guint n = s->m + d->n_variability;
  const gsize size = s->features->size;
  g_autofree gdouble *z = cloth_sensitivities_residual (s);
  g_autofree gdouble *columns =
      cloth_diagnosis_list_columns (d, take, before, more);
  g_autoptr (ClothPowerSpectrum) weight = cloth_diagnosis_find_weight (d, take);

  for (guint i = 0; i < more; i++)
    cloth_features_window (s->features, columns + (gusts->first +
            i % CLOTH_GAP_GUST_WAYS) * size, i / CLOTH_GAP_GUST_WAYS,
        CLOTH_GAP_GUST_PARTS, columns + (n + i) * size);
  return cloth_normal_equations_new (s->features, weight, z, columns, n + more);
}

/* The power left in the takes that a baseline's discrepancy is taken off, once @score's
 * changes (NULL: none) are made: a tenth of the mismatch at least is left to doubt. */
void
cloth_diagnosis_find_residual_variance (ClothDiagnosis * d,
    const ClothGapScore * score)
{
  for (guint i = 0; i < d->n_takes; i++) {
    g_autoptr (ClothPowerSpectrum) discrepancy_variance =
        cloth_diagnosis_find_discrepancy_variance (d, i);
    ClothSensitivities *s = cloth_diagnosis_study (d, i);
    g_autofree gdouble *z = cloth_sensitivities_residual (s);
    gsize size = s->features->size;
    ClothPowerSpectrum *left;

    if (!s->discrepancy)
      continue;
    for (guint c = 0; score && c < cloth_diagnosis_candidate (d, score)->n; c++) {
      const gdouble *column = s->columns + (cloth_diagnosis_candidate (d,
              score)->first + c) * size;

      for (gsize k = 0; k < size; k++)
        z[k] += score->changes[c] * column[k];
    }
    left = cloth_power_spectrum_new (s->features, z);
    for (guint k = 0; k < left->n; k++)
      left->values[k] = MIN (score ? s->residual_variance->values[k] :
          discrepancy_variance->values[k], MAX (left->values[k],
              LEAST_DISCREPANCY * discrepancy_variance->values[k]));
    cloth_power_spectrum_free (s->residual_variance);
    s->residual_variance = left;
  }
}

gboolean
cloth_diagnosis_linearise (ClothDiagnosis * d, guint first, guint end,
    const ClothModel * model, gdouble from, gdouble to, GError ** error)
{
  for (guint i = first; i < end; i++) {
    g_autofree gchar *what = g_strdup_printf ("effects on %s",
        cloth_diagnosis_study (d, i)->recording->name);
    gdouble part = (to - from) / (end - first);

    cloth_diagnosis_begin_part (d, from + part * (i - first),
        from + part * (i - first + 1), 1., what);
    if (!cloth_sensitivities_linearise (cloth_diagnosis_study (d, i),
            d->candidates, model, d->all, d->candidates->directions->len,
            &d->study, error))
      return FALSE;
  }
  return TRUE;
}

/* The precisions of the variability in the studies from begin to end. */
static void
list_variability (ClothDiagnosis * d, guint begin, guint end)
{
  guint k = 0;

  d->n_variability = 0;
  for (guint i = begin; i < end; i++)
    d->n_variability +=
        cloth_sensitivities_count_variability (cloth_diagnosis_study (d, i));
  g_free (d->variability_precisions);
  d->variability_precisions = g_new (gdouble, d->n_variability + 1);
  for (guint i = begin; i < end; i++) {
    const ClothSensitivities *s = cloth_diagnosis_study (d, i);

    for (guint c = 0; c < cloth_sensitivities_count_variability (s); c++)
      d->variability_precisions[k++] =
          cloth_sensitivities_get_variability_precision (s,
          c) / d->study.overdispersion;
  }
}

/* The normal equations of the studies from begin to end, as they weigh now. */
void
cloth_diagnosis_make_normals (ClothDiagnosis * d, guint begin, guint end,
    ClothGapTest * test)
{
  list_variability (d, begin, end);
  g_clear_pointer (&d->normal, cloth_normal_equations_free);
  for (guint i = begin, before = 0; i < end; i++) {
    d->normal =
        cloth_normal_equations_append (d->normal, normal_of (d, i, before));
    before +=
        cloth_sensitivities_count_variability (cloth_diagnosis_study (d, i));
  }
  test->normal = d->normal;
  test->gusts = find_gusts (d, cloth_diagnosis_study (d, begin)) ?
      d->candidates->directions->len + d->n_variability : 0;
}

/* The free numbers and the directions of what is accepted, with the precisions of their
 * priors; those of effects count @width times as wide. Returns how many. */
guint
cloth_diagnosis_list_accepted (const ClothDiagnosis * d, gdouble width,
    guint * directions, gdouble * precisions)
{
  guint m = d->candidates->n_free;

  memcpy (directions, d->all, m * sizeof *directions);
  memcpy (precisions, d->precisions, m * sizeof *precisions);
  for (guint c = 0; c < d->n_accepted; c++)
    for (guint k = 0; k < cloth_diagnosis_accepted (d, c)->n; k++, m++) {
      gdouble prior;

      directions[m] = cloth_diagnosis_accepted (d, c)->first + k;
      prior = cloth_candidates_direction (d->candidates, directions[m])->prior;
      precisions[m] = 1. / (width * width * prior * prior);
    }
  return m;
}

/* The free numbers, what is accepted, and variability are fitted along when effects are tested. */
void
cloth_diagnosis_list_nuisances (ClothDiagnosis * d, ClothGapTest * test)
{
  guint n = d->candidates->directions->len;

  g_free (d->nuisances);
  g_free (d->nuisance_precisions);
  d->nuisances = g_new (guint, n + d->n_variability + 1);
  d->nuisance_precisions = g_new (gdouble, n + d->n_variability + 1);
  test->nuisances = d->nuisances;
  test->precisions = d->nuisance_precisions;
  test->n_nuisances = cloth_diagnosis_list_accepted (d, 1.,
      d->nuisances, d->nuisance_precisions);
  test->n_numbers = test->n_nuisances;
  for (guint k = 0; k < d->n_variability; k++) {
    d->nuisances[test->n_nuisances] = n + k;
    d->nuisance_precisions[test->n_nuisances++] = d->variability_precisions[k];
  }
}

/* Test of the blocks of the studies from begin to end. */
void
cloth_diagnosis_make_test (ClothDiagnosis * d, guint begin, guint end,
    ClothGapTest * test)
{
  guint m = d->candidates->directions->len;

  for (guint k = 0; k < m; k++) {
    d->sound[k] = TRUE;
    for (guint i = begin; i < end; i++)
      d->sound[k] = d->sound[k] && cloth_diagnosis_study (d, i)->sound[k];
  }
  cloth_diagnosis_make_normals (d, begin, end, test);
  d->n_blocks = d->normal->n_blocks;
  g_free (d->blocks);
  d->blocks = g_new (gboolean, d->n_blocks);
  for (guint b = 0; b < d->n_blocks; b++)
    d->blocks[b] = TRUE;
  test->candidates = d->candidates;
  test->blocks = d->blocks;
  test->overdispersion = d->study.overdispersion;
  test->block_s = d->study.block_s;
  test->sound = d->sound;
  cloth_diagnosis_list_nuisances (d, test);
}

static gdouble
calibrate (gdouble probability)
{
  gdouble odds = log (probability / (1. - probability));

  odds *= odds < 0. ? ODDS_SLOPE_AGAINST : ODDS_SLOPE_FOR;
  return 1. / (1. + exp (-(ODDS_SHIFT + MIN (odds,
                  ODDS_SLOPE_FOR * LARGEST_LOG_ODDS))));
}

/* The softmax of one score among those of the effects that are not decided yet, and of none,
 * whose log Bayes factor is 0. */
static gdouble
softmax (const ClothDiagnosis * d, const GArray * scores,
    const ClothGapScore * which)
{
  gdouble total = exp (-which->log_bayes_factor / TEMPERATURE);

  for (guint i = 0; i < scores->len; i++) {
    const ClothGapScore *s = &g_array_index (scores, ClothGapScore, i);

    if (!cloth_diagnosis_is_decided (d, cloth_diagnosis_candidate (d,
                s)->effect))
      total +=
          exp ((s->log_bayes_factor - which->log_bayes_factor) / TEMPERATURE);
  }
  return 1. / total;
}

/* @d: a diagnosis
 * @scores: (element-type ClothGapScore): of all effects
 * @which: one of them
 *
 * Returns: the calibrated probability that it is this effect, of those that are not decided
 *   yet, rather than another or none
 */
gdouble
cloth_diagnosis_find_probability (const ClothDiagnosis * d,
    const GArray * scores, const ClothGapScore * which)
{
  return calibrate (softmax (d, scores, which));
}

void
cloth_diagnosis_fill_effects (ClothDiagnosis * d, const ClothGapTest * test,
    const GArray * scores)
{
  g_autofree const ClothGapScore **of = g_new (const ClothGapScore *,
      scores->len + 1);
  GArray *effects = d->result->effects;

  for (guint i = 0; i < scores->len; i++) {
    const ClothGapScore *s = &g_array_index (scores, ClothGapScore, i);
    const ClothCandidate *c = cloth_diagnosis_candidate (d, s);
    ClothGapEffect *e;

    if (s->kept < CLOTH_GAP_IDENTIFIABLE) {
      cloth_gap_result_add_untested (d->result, c->effect, "In this motion it "
          "can't be told from the model's free numbers.");
      continue;
    }
    of[effects->len] = s;
    e = cloth_gap_result_add_effect (d->result, c->effect);
    e->probability = softmax (d, scores, s);
    e->p_value = s->p_value;
    e->constancy_p_value = s->constancy_p_value;
    e->group = -1;
    for (guint k = 0; k < c->effect->n_parameters; k++) {
      e->values[k] = c->values[k];
      e->sigmas[k] = NAN;
    }
    for (guint k = 0; k < c->n; k++) {
      e->values[c->parameters[k]] += s->changes[k];
      e->sigmas[c->parameters[k]] = CLOTH_DIAGNOSIS_SIGMA_WIDTH * s->sigmas[k];
    }
    if (cloth_candidate_is_stochastic (c)) {
      e->values[0] = s->changes[0];
      e->values[2] = s->changes[1];
    }
  }
  /* the best, and those that can't be told from it */
  for (guint i = 1, n = 1; i < effects->len && n < MOST_AMBIGUOUS; i++) {
    ClothGapEffect *best = &g_array_index (effects, ClothGapEffect, 0);
    ClothGapEffect *e = &g_array_index (effects, ClothGapEffect, i);

    if (e->probability < AMBIGUOUS_SHARE * best->probability
        && !(e->probability > ALIKE_SHARE * best->probability
            && cloth_gap_test_cosine (test, of[0]->candidate,
                of[i]->candidate) > ALIKE_COSINE))
      continue;
    n++;
    if (best->group < 0)
      cloth_gap_result_add_group (d->result, NULL, NAN);
    best->group = e->group = 0;
  }
  for (guint i = 0; i < effects->len; i++) {
    ClothGapEffect *e = &g_array_index (effects, ClothGapEffect, i);

    e->probability = calibrate (e->probability);
  }
}

/* The effects, the likeliest first. What the leading one leaves shows better than what
 * was there before how much the simulator is off by in this take. */
GArray *
cloth_diagnosis_rank (ClothDiagnosis * d, ClothGapTest * test)
{
  GArray *scores = cloth_gap_test_run (test);

  for (guint k = 0; k < N_SHARPEN && scores->len; k++) {
    cloth_diagnosis_find_residual_variance (d, &g_array_index (scores,
            ClothGapScore, 0));
    cloth_diagnosis_make_normals (d, 0, d->n_takes, test);
    g_array_unref (scores);
    scores = cloth_gap_test_run (test);
  }
  for (guint i = 0; i < scores->len; i++) {
    ClothGapScore *s = &g_array_index (scores, ClothGapScore, i);

    s->log_bayes_factor -= d->null_log_bayes_factors[s->candidate];
  }
  g_array_sort (scores, cloth_gap_score_compare);
  return scores;
}
