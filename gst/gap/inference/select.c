/* Decides which effects are accepted: forward selection with a look ahead, and backward elimination.
 *
 * The likeliest effect is accepted when its log Bayes factor reaches the bound and it improves
 * blocks of time that it was not estimated on. It is fitted by Gauss–Newton together with the
 * free numbers and what is accepted already; then all effects are tested anew.
 * Assumption: where the fit ends, the residual is linear in all accepted effects. There the log
 * Bayes factor of an accepted effect against its absence is the Laplace approximation
 *   ½ aᵀ(g/φ + R⁻¹)a − ½ log det (g R/φ + 1),  a = from the best values to the null,
 * with all others fitted along; one below the bound goes again.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/inference/select.h"

#include <math.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/gap/inference/trial.h"

/* Simulations of a fit with effects. */
#define N_REFIT 3
/* An effect that is less likely by more evidence never goes before another. */
#define HARDLY_LESS 10.
/* Priors of effects in it are so many times as wide. */
#define REFIT_WIDTH 2.

/* Fits what is accepted, from @start on. The free numbers may give a little. */
static gboolean
refit (ClothDiagnosis * d, const ClothModel * start, GError ** error)
{
  const guint now = d->n_accepted - 1, most = d->candidates->directions->len;
  g_autofree guint *directions = g_new (guint, most);
  g_autofree gdouble *precisions = g_new (gdouble, most);
  g_autofree gdouble *sigmas = g_new0 (gdouble, most);
  g_autofree gboolean *blocks = g_new (gboolean, d->n_blocks);
  guint m = cloth_diagnosis_list_accepted (d, REFIT_WIDTH, directions,
      precisions);

  for (guint b = 0; b < d->n_blocks; b++)
    blocks[b] = !cloth_diagnosis_is_held_out (d, b);
  d->with[now] =
      cloth_gauss_newton_fit ((ClothSensitivities **) d->studies->pdata,
      d->n_takes, d->candidates, start, directions, precisions, m, blocks,
      CLOTH_FIT_DEFAULT, N_REFIT, &d->study, sigmas, error);
  m = d->candidates->n_free;
  for (guint c = 0; c <= now; c++)
    for (guint k = 0; k < cloth_diagnosis_accepted (d, c)->n; k++)
      d->sigmas[now][c][k] = sigmas[m++];
  return d->with[now] != NULL;
}

/* The model before the last effect with that effect so far from its null. */
static ClothModel *
move_to (const ClothDiagnosis * d, const gdouble * values)
{
  const ClothCandidate *c = cloth_diagnosis_accepted (d, d->n_accepted - 1);
  guint directions[CLOTH_EFFECT_MAX_PARAMETERS];

  for (guint k = 0; k < c->n; k++)
    directions[k] = c->first + k;
  return cloth_candidates_move (d->candidates,
      d->n_accepted > 1 ? d->with[d->n_accepted - 2] : d->model, directions,
      values, c->n);
}

/* How far each direction of an accepted effect is from its null. */
static void
find_values (const ClothDiagnosis * d, guint accepted, gdouble * values)
{
  const ClothCandidate *c = cloth_diagnosis_accepted (d, accepted);

  for (guint k = 0; k < c->n; k++)
    values[k] = cloth_candidates_place (d->candidates,
        d->with[d->n_accepted - 1], c->first + k) -
        cloth_candidates_direction (d->candidates, c->first + k)->centre;
}

/* How much the residual would support an accepted effect if it were not accepted: the
 * logarithm of its Bayes factor where the fit left the studies, all else fitted along.
 * @first: of its columns there. */
static gdouble
find_need (const ClothDiagnosis * d, const ClothGapTest * test, guint accepted,
    guint first)
{
  const ClothCandidate *c = cloth_diagnosis_accepted (d, accepted);
  const ClothSensitivities *study = cloth_diagnosis_study (d, 0);
  guint n = c->n, m = study->m + d->n_variability, q = 0, others = 0;
  g_autofree guint *nuisances = g_new (guint, m);
  g_autofree gdouble *precisions = g_new (gdouble, m);
  g_autofree guint *taken = g_new (guint, m);
  g_autofree gdouble *of_taken = g_new (gdouble, m);
  ClothReducedEquations r;
  guint directions[CLOTH_EFFECT_MAX_PARAMETERS];
  gdouble values[CLOTH_EFFECT_MAX_PARAMETERS];
  gdouble away[CLOTH_EFFECT_MAX_PARAMETERS];
  gdouble phi, need = -d->null_log_bayes_factors[d->accepted[accepted]];
  g_auto (ClothPosterior) posterior = { 0 };

  cloth_diagnosis_list_accepted (d, 1., taken, of_taken);
  for (guint k = 0; k < m; k++) {
    if (k >= first && k < first + n) {
      directions[k - first] = k;
      continue;
    }
    precisions[q] = test->overdispersion * (k < study->m ? of_taken[k] :
        d->variability_precisions[others++]);
    nuisances[q++] = k;
  }
  if (!cloth_normal_equations_reduce (test->normal, test->blocks, nuisances,
          precisions, q, directions, n, &r))
    return INFINITY;
  phi = cloth_gap_test_dispersion (test, test->normal, &r);
  find_values (d, accepted, values);
  /* changes are counted from where the effect is, its null is at -values */
  for (guint i = 0; i < n; i++) {
    away[i] = -values[i];
    need += 0.5 * log (of_taken[first + i]);
  }
  cloth_posterior_init (&posterior, n);
  cloth_posterior_add_data (&posterior, r.g, r.s, phi);
  cloth_posterior_add_prior (&posterior, of_taken + first, away);
  if (!cloth_posterior_solve (&posterior))
    return INFINITY;
  need -= 0.5 * cloth_posterior_log_determinant (&posterior);
  /* from the most probable place to the null */
  for (guint i = 0; i < n; i++)
    away[i] -= posterior.mean[i];
  for (guint i = 0; i < n; i++)
    for (guint k = 0; k < n; k++)
      need += 0.5 * away[i] * away[k] * (r.g[i * n + k] / phi + (i == k ?
              of_taken[first + i] : 0.));
  return need;
}

/* The effect that is needed least where the last fit left the studies. */
static gdouble
find_least_needed (ClothDiagnosis * d, guint * least)
{
  guint first = d->candidates->n_free;
  gdouble lowest = INFINITY;
  ClothGapTest test = {.blocks = d->blocks,.overdispersion =
        d->study.overdispersion
  };

  cloth_diagnosis_make_normals (d, 0, d->n_takes, &test);
  for (guint c = 0; c < d->n_accepted; c++) {
    gdouble need = find_need (d, &test, c, first);

    if (need < lowest) {
      lowest = need;
      *least = c;
    }
    first += cloth_diagnosis_accepted (d, c)->n;
  }
  return lowest;
}

/* Takes an effect out again and fits those after it without it. */
static gboolean
drop (ClothDiagnosis * d, guint which, GError ** error)
{
  const guint left = d->n_accepted - 1;
  gdouble values[CLOTH_DIAGNOSIS_MAX_ACCEPTED][CLOTH_EFFECT_MAX_PARAMETERS];

  d->dropped[d->n_dropped++] = d->accepted[which];
  for (guint c = which; c < left; c++)
    find_values (d, c + 1, values[c]);
  for (guint c = which; c <= left; c++)
    g_clear_pointer (&d->with[c], cloth_model_free);
  memmove (d->accepted + which, d->accepted + which + 1,
      (left - which) * sizeof *d->accepted);
  memmove (d->probabilities + which, d->probabilities + which + 1,
      (left - which) * sizeof *d->probabilities);
  for (d->n_accepted = which; d->n_accepted < left;) {
    g_autoptr (ClothModel) start = NULL;

    d->n_accepted++;
    start = move_to (d, values[d->n_accepted - 1]);
    if (!refit (d, start, error))
      return FALSE;
  }
  return TRUE;
}

/* Effects that those after them make needless go. */
static gboolean
drop_needless (ClothDiagnosis * d, GError ** error)
{
  guint least = 0;

  while (d->n_accepted > 1 && d->n_dropped < G_N_ELEMENTS (d->dropped)
      && find_least_needed (d, &least) < d->least_log_bayes_factor)
    if (!drop (d, least, error))
      return FALSE;
  return TRUE;
}

/* How likely gusts are; −∞: they were not tested. */
static gdouble
find_gust_log_bayes_factor (const ClothDiagnosis * d, const GArray * scores)
{
  for (guint i = 0; i < scores->len; i++) {
    const ClothGapScore *s = &g_array_index (scores, ClothGapScore, i);

    if (cloth_candidate_is_stochastic (cloth_diagnosis_candidate (d, s)))
      return s->log_bayes_factor;
  }
  return -INFINITY;
}

/* Whether an effect may be accepted: gusts can't, as what they did follows from nothing. */
static gboolean
may_be_accepted (const ClothDiagnosis * d, const ClothGapScore * s,
    gdouble least)
{
  const ClothCandidate *c = cloth_diagnosis_candidate (d, s);

  return !cloth_candidate_is_stochastic (c) && s->log_bayes_factor >= least
      && s->improvement > 0. && !cloth_diagnosis_is_decided (d, c->effect);
}

/* The likeliest effect that is not decided yet, if it is supported; nothing that is less
 * likely than gusts, if @gusts. */
static const ClothGapScore *
find_supported (const ClothDiagnosis * d, const GArray * scores, gboolean gusts)
{
  const gdouble least = MAX (d->least_log_bayes_factor, gusts ?
      find_gust_log_bayes_factor (d, scores) : -INFINITY);

  for (guint i = 0; i < scores->len; i++) {
    const ClothGapScore *s = &g_array_index (scores, ClothGapScore, i);
    const ClothCandidate *c = cloth_diagnosis_candidate (d, s);

    if (!cloth_candidate_is_stochastic (c)
        && !cloth_diagnosis_is_decided (d, c->effect))
      return may_be_accepted (d, s, least) ? s : NULL;
  }
  return NULL;
}

/* What the likeliest effect beside one more would bring by the derivatives at hand, beyond
 * what it must. */
static gdouble
find_next (ClothDiagnosis * d, ClothGapTest * test, const ClothGapScore * one)
{
  g_autoptr (GArray) scores = NULL;
  gdouble next = d->least_log_bayes_factor;

  d->accepted[d->n_accepted++] = one->candidate;
  cloth_diagnosis_list_nuisances (d, test);
  scores = cloth_gap_test_run (test);
  for (guint i = 0; i < scores->len; i++) {
    const ClothGapScore *s = &g_array_index (scores, ClothGapScore, i);

    if (may_be_accepted (d, s, next + d->null_log_bayes_factors[s->candidate]))
      next = s->log_bayes_factor - d->null_log_bayes_factors[s->candidate];
  }
  d->n_accepted--;
  cloth_diagnosis_list_nuisances (d, test);
  return next - d->least_log_bayes_factor;
}

/* An effect may stand for two others, as wind does for drag and tilted gravity: of those
 * hardly less likely than the first one, that beside which the next one brings most goes
 * first. It gets the evidence that it has with the next one. */
static void
look_ahead (ClothDiagnosis * d, ClothGapTest * test, GArray * scores)
{
  const ClothGapScore *first = find_supported (d, scores, TRUE);
  ClothGapScore *best = NULL;
  gdouble least, most = 0., of_first = 0.;

  if (!first)
    return;
  least =
      MAX (first->log_bayes_factor - HARDLY_LESS,
      MAX (d->least_log_bayes_factor, find_gust_log_bayes_factor (d, scores)));
  for (guint i = 0; i < scores->len; i++) {
    ClothGapScore *s = &g_array_index (scores, ClothGapScore, i);
    gdouble all;

    if (!may_be_accepted (d, s, least))
      continue;
    all = s->log_bayes_factor + find_next (d, test, s);
    if (s == first)
      of_first = all;
    if (!best || all > most) {
      most = all;
      best = s;
    }
  }
  best->log_bayes_factor = first->log_bayes_factor + most - of_first;
  g_array_sort (scores, cloth_gap_score_compare);
}

/* Fits with the last effect, from its estimated value, else from its null. */
static gboolean
accept_last (ClothDiagnosis * d, const gdouble * changes, GError ** error)
{
  const gdouble nothing[CLOTH_EFFECT_MAX_PARAMETERS] = { 0. };
  g_autoptr (GError) diverged = NULL;
  g_autoptr (ClothModel) there = move_to (d, changes);
  g_autoptr (ClothModel) null = move_to (d, nothing);

  if (refit (d, there, &diverged))
    return TRUE;
  if (g_error_matches (diverged, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_MODEL))
    return refit (d, null, error);
  g_propagate_error (error, g_steal_pointer (&diverged));
  return FALSE;
}

/* Effects that no simulation is possible with go; those before them stay. */
static gboolean
end_with_sound (ClothDiagnosis * d, GError * failed, GError ** error)
{
  if (!g_error_matches (failed, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_MODEL)) {
    g_propagate_error (error, failed);
    return FALSE;
  }
  g_error_free (failed);
  while (d->n_accepted && !d->with[d->n_accepted - 1])
    d->n_accepted--;
  return TRUE;
}

/* Accepts effects one by one, as long as one is supported: the next one by the same
 * derivatives first, and only then by new ones. */
gboolean
cloth_diagnosis_select (ClothDiagnosis * d, GError ** error)
{
  g_autoptr (GArray) scores = NULL;
  const ClothGapScore *supported;
  ClothGapTest test = { NULL };

  cloth_diagnosis_find_residual_variance (d, NULL);
  cloth_diagnosis_make_test (d, 0, d->n_takes, &test);
  scores = cloth_diagnosis_rank (d, &test);
  cloth_diagnosis_begin_part (d, 0.42, 0.48, 0.5, "the likeliest effects");
  if (!cloth_diagnosis_refine_hypotheses (d, &test, scores, d->model, error))
    return FALSE;
  look_ahead (d, &test, scores);
  cloth_diagnosis_fill_effects (d, &test, scores);
  while ((supported = find_supported (d, scores, TRUE))) {
    GError *failed = NULL;
    const ClothGapScore next = *supported;
    guint done = d->n_accepted + d->n_dropped, dropped = d->n_dropped;
    gdouble from = 0.48 + 0.12 * MIN (done, CLOTH_DIAGNOSIS_MAX_ACCEPTED - 1);

    d->supported = TRUE;
    d->probabilities[d->n_accepted] =
        cloth_diagnosis_find_probability (d, scores, &next);
    d->accepted[d->n_accepted++] = next.candidate;
    cloth_diagnosis_list_nuisances (d, &test);
    g_array_unref (scores);
    scores = cloth_diagnosis_rank (d, &test);
    /* what derivatives elsewhere leave is not steady either */
    supported = find_supported (d, scores, FALSE);
    cloth_diagnosis_begin_part (d, from, from + 0.04, 0.4,
        cloth_diagnosis_candidate (d, &next)->effect->id);
    if (!accept_last (d, next.changes, &failed) || !drop_needless (d, &failed))
      return end_with_sound (d, failed, error);
    /* one that went may leave room for what was not supported beside it */
    if (d->n_accepted == CLOTH_DIAGNOSIS_MAX_ACCEPTED
        || (!supported && d->n_dropped == dropped))
      break;
    if (!cloth_diagnosis_linearise (d, 0, d->n_takes,
            d->with[d->n_accepted - 1], from + 0.04, from + 0.09, &failed))
      return end_with_sound (d, failed, error);
    cloth_diagnosis_make_test (d, 0, d->n_takes, &test);
    g_array_unref (scores);
    scores = cloth_diagnosis_rank (d, &test);
    cloth_diagnosis_begin_part (d, from + 0.09, from + 0.12, 0.5,
        "the likeliest effects");
    if (!cloth_diagnosis_refine_hypotheses (d, &test, scores,
            d->with[d->n_accepted - 1], error))
      return FALSE;
  }
  return TRUE;
}
