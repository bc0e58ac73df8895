/* What the posterior over all explanations says of each effect.
 *
 * Formulas, with p the posterior of an explanation among those of the library:
 *   inclusion probability of an effect = Σ p of the explanations that it is part of;
 *   log Bayes factor of an effect = its posterior log odds − its prior log odds;
 *   P(unknown) = o/(1 + o), o = Σ over the rivals of exp (log BF − log (number of effects − 1)): an
 *     unknown field is taken to be as likely as any one effect;
 *   of all explanations the likeliest that have 95% together are listed, with p (1 − P(unknown)).
 * Accepted is what is in the likeliest explanation, has an inclusion probability above one half, and without
 *   which, with nothing in its place, that explanation has less than 5% against it.
 * Detection limit of a number: an effect of that size shows with a probability of 95%. With I the
 * information on it beside the nuisances an effect θ moves its score by θ√I, chance by one; raised to the
 * power ζ it is likelier than nothing when ζ/2 x² > ½ log (1 + ζ prior² I) + log (number of effects − 1),
 * so
 *   θ√I = 1.645 + √(2/ζ (…)).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/inference/conclude.h"

#include <math.h>
#include <string.h>

#include "gst/gap/inference/clamps.h"
#include "gst/gap/inference/free-numbers.h"
#include "gst/gap/inference/rivals.h"
#include "gst/math/statistics.h"

/* Share of the posterior that the listed explanations have. */
#define LISTED 0.95
/* Probability below which an explanation is refuted. */
#define REFUTED (1. - LISTED)
/* Normal quantile of 95% on one side. */
#define QUANTILE 1.645
/* Most explanations that are listed. */
#define MOST_SETS 12

/* What is known of one effect. */
typedef struct
{
  const ClothEffect *effect;
  gdouble log_in, log_out;      /* of the posterior with and without it */
  const ClothGapHypothesis *best;       /* the likeliest with it */
} Known;

static const ClothCandidate *
candidate_of (const ClothDiagnosis * d, guint i)
{
  return &g_array_index (d->candidates->list, ClothCandidate, i);
}

static gdouble
log_add (gdouble a, gdouble b)
{
  const gdouble most = MAX (a, b);

  return isfinite (most) ? most + log (exp (a - most) + exp (b - most)) : most;
}

static gboolean
includes (const ClothDiagnosis * d, const ClothGapHypothesis * h,
    const ClothEffect * effect)
{
  for (guint c = 0; c < h->n; c++)
    if (candidate_of (d, h->candidates[c])->effect == effect)
      return TRUE;
  return FALSE;
}

static Known
find_known (const ClothDiagnosis * d, const GArray * hypotheses,
    const ClothEffect * effect)
{
  Known known = { effect, -INFINITY, -INFINITY };

  for (guint i = 0; i < hypotheses->len; i++) {
    const ClothGapHypothesis *h = &g_array_index (hypotheses,
        ClothGapHypothesis, i);

    if (!isfinite (h->behind))
      continue;
    if (!includes (d, h, effect)) {
      known.log_out = log_add (known.log_out, -h->behind);
      continue;
    }
    known.log_in = log_add (known.log_in, -h->behind);
    if (!known.best)
      known.best = h;
  }
  return known;
}

static guint
count_effects (const ClothDiagnosis * d)
{
  guint n = 0;

  for (guint i = 0; i < d->candidates->list->len; i++)
    n += i == 0
        || candidate_of (d, i)->effect != candidate_of (d, i - 1)->effect;
  return MAX (n, 2);
}

/* Of gusts: the root of the winds' mean square, and the axis along which most of it blew. */
static void
fill_gusts (const ClothGapHypothesis * h, const ClothEffect * effect,
    ClothGapEffect * e)
{
  const gdouble *winds = h->evidence.values + h->n_directions - h->n_winds;
  gdouble along[3] = { 0. };

  for (guint k = 0; k < effect->n_parameters; k++) {
    e->values[k] = effect->parameters[k].null_value;
    e->sigmas[k] = NAN;
  }
  for (guint k = 0; k + 1 < h->n_winds; k += 2) {
    along[0] += winds[k] * winds[k];
    along[1] += winds[k + 1] * winds[k + 1];
    along[2] += 2. * winds[k] * winds[k + 1];
  }
  e->values[0] = sqrt (2. * (along[0] + along[1]) / h->n_winds);
  e->values[2] = 90. / G_PI * atan2 (along[2], along[0] - along[1]);
}

/* The numbers of an effect in the likeliest explanation with it. A number of the cloth's is known no better
 * than its law holds. */
static void
fill_values (const ClothDiagnosis * d, const Known * known, ClothGapEffect * e)
{
  const ClothGapHypothesis *h = known->best;

  for (guint c = 0, at = 0; c < h->n; c++) {
    const ClothCandidate *candidate = candidate_of (d, h->candidates[c]);

    if (candidate->effect != known->effect) {
      at += candidate->n;
      continue;
    }
    if (cloth_candidate_is_stochastic (candidate)) {
      fill_gusts (h, candidate->effect, e);
      return;
    }
    for (guint k = 0; k < candidate->effect->n_parameters; k++) {
      e->values[k] = candidate->values[k];
      e->sigmas[k] = NAN;
    }
    for (guint k = 0; k < candidate->n; k++, at++) {
      const guint p = candidate->parameters[k];
      const ClothEffectParameter *parameter = &candidate->effect->parameters[p];

      if (cloth_candidates_direction (d->candidates,
              candidate->first + k)->present)
        continue;
      e->values[p] = CLAMP (cloth_candidates_direction (d->candidates,
              candidate->first + k)->centre + h->evidence.values[at],
          parameter->min, parameter->max);
      e->sigmas[p] = sqrt (h->evidence.covariance[at * h->n_directions + at] +
          (candidate->effect->side == CLOTH_EFFECT_PHYSICS ?
              pow (CLOTH_GAP_LAW_ERROR * h->evidence.values[at], 2.) : 0.));
    }
    return;
  }
}

/* Posterior. */
static gdouble
log_odds (const Known * known)
{
  return known->log_in - known->log_out;
}

static gint
compare_known (gconstpointer a, gconstpointer b)
{
  const Known *x = a, *y = b;
  const gdouble first = log_odds (x), second = log_odds (y);

  return first > second ? -1 : first < second;
}

/* The effects, the likeliest first. */
static void
fill_effects (ClothDiagnosis * d, const GArray * hypotheses)
{
  g_autoptr (GArray) all = g_array_new (FALSE, FALSE, sizeof (Known));
  const gdouble prior = -log (count_effects (d) - 1.);

  for (guint i = 0; i < d->candidates->list->len; i++) {
    Known known;

    if (i && candidate_of (d, i)->effect == candidate_of (d, i - 1)->effect)
      continue;
    known = find_known (d, hypotheses, candidate_of (d, i)->effect);
    if (known.best)
      g_array_append_val (all, known);
  }
  g_array_sort (all, compare_known);
  for (guint i = 0; i < all->len; i++) {
    const Known *known = &g_array_index (all, Known, i);
    ClothGapEffect *e = cloth_gap_result_add_effect (d->result,
        known->effect);
    const gdouble odds = log_odds (known);

    e->probability = 1. / (1. + exp (-odds));
    e->log_bayes_factor = odds - prior;
    e->p_value = e->constancy_p_value = NAN;
    e->group = -1;
    for (guint c = 0; c < known->best->n; c++)
      if (candidate_of (d, known->best->candidates[c])->effect == known->effect)
        e->p_value = cloth_gap_hypothesis_find_p_value (d, known->best,
            known->best->candidates[c]);
    fill_values (d, known, e);
  }
}

/* Explanations of the library that have 95% together, whatever acts besides. That nothing is lacking takes that nothing
 * unknown acts. */
static void
fill_sets (ClothDiagnosis * d, const GArray * hypotheses)
{
  gdouble all = -INFINITY, listed = 0.;

  for (guint i = 0; i < hypotheses->len; i++)
    all = log_add (all, -g_array_index (hypotheses, ClothGapHypothesis,
            i).behind);
  for (guint i = 0; i < MIN (hypotheses->len, MOST_SETS) && listed < LISTED;
      i++) {
    const ClothGapHypothesis *h = &g_array_index (hypotheses,
        ClothGapHypothesis, i);
    const gdouble p = exp (-h->behind - all);
    ClothGapSet *set = cloth_gap_result_add_set (d->result,
        CLOTH_GAP_RIVAL_NONE, p);

    for (guint c = 0; c < h->n; c++)
      g_ptr_array_add (set->effects,
          (gpointer) candidate_of (d, h->candidates[c])->effect);
    if (!h->n)
      d->result->rivals.none_acts = p * (1. - d->unknown_probability);
    listed += p;
  }
}

static ClothGapEffect *
find_effect (ClothGapResult * result, const ClothEffect * effect)
{
  for (guint i = 0; i < result->effects->len; i++) {
    ClothGapEffect *e = &g_array_index (result->effects, ClothGapEffect, i);

    if (e->effect == effect)
      return e;
  }
  return NULL;
}

/* Whether an effect of the likeliest set has less than 95% of the posterior: others may act in its place. */
static gboolean
is_exchanged (const ClothGapSet * best, const ClothGapEffect * e)
{
  return e->probability < LISTED
      && g_ptr_array_find (best->effects, (gpointer) e->effect, NULL);
}

/* Whether a set has an effect that the likeliest one has not, and lacks one that others may act in place of. A set
 * that only adds to the likeliest one contradicts nothing. */
static gboolean
is_instead (const ClothGapSet * set, const ClothGapSet * best,
    const GArray * effects, const ClothEffect * effect)
{
  if (!g_ptr_array_find (set->effects, (gpointer) effect, NULL)
      || g_ptr_array_find (best->effects, (gpointer) effect, NULL))
    return FALSE;
  for (guint i = 0; i < effects->len; i++) {
    const ClothGapEffect *e = &g_array_index (effects, ClothGapEffect, i);

    if (is_exchanged (best, e)
        && !g_ptr_array_find (set->effects, (gpointer) e->effect, NULL))
      return TRUE;
  }
  return FALSE;
}

/* Effects that can't be told apart: those of the likeliest set that may be others, and what listed sets have
 * instead; none where no set has anything instead. */
static void
fill_group (ClothDiagnosis * d)
{
  GArray *sets = d->result->sets, *effects = d->result->effects;
  g_autofree gboolean *instead = g_new0 (gboolean, effects->len + 1);
  const ClothGapSet *best;
  gboolean any = FALSE;

  if (!sets->len)
    return;
  best = &g_array_index (sets, ClothGapSet, 0);
  for (guint i = 0; i < effects->len; i++) {
    for (guint k = 1; k < sets->len; k++)
      instead[i] |= is_instead (&g_array_index (sets, ClothGapSet, k), best,
          effects, g_array_index (effects, ClothGapEffect, i).effect);
    any |= instead[i];
  }
  if (!any)
    return;
  for (guint i = 0; i < effects->len; i++) {
    ClothGapEffect *e = &g_array_index (effects, ClothGapEffect, i);

    if (instead[i] || is_exchanged (best, e))
      e->group = 0;
  }
  cloth_gap_result_add_group (d->result, NULL, NAN);
}

/* Those of the likeliest explanation that are likelier than not, and without which it is refuted. */
static void
accept (ClothDiagnosis * d, const GArray * hypotheses)
{
  const ClothGapHypothesis *best = &g_array_index (hypotheses,
      ClothGapHypothesis, 0);

  for (guint c = 0; c < best->n; c++) {
    ClothGapEffect *e = find_effect (d->result, candidate_of (d,
            best->candidates[c])->effect);

    if (!e || !(e->probability > 0.5)
        || cloth_gap_hypotheses_find_without (hypotheses, best, c) > REFUTED)
      continue;
    /* what it did follows from nothing */
    if (cloth_candidate_is_stochastic (candidate_of (d, best->candidates[c]))) {
      d->chance = e->effect;
      continue;
    }
    e->accepted = TRUE;
    d->accepted[d->n_accepted++] = best->candidates[c];
  }
}

/* Sum of squares of a residual of these powers. */
static gdouble
find_power (const ClothGapBasis * basis, const gdouble * powers)
{
  gdouble sum = 0.;

  for (gsize i = 0; i < basis->stack->size; i++)
    sum += powers[basis->stack->classes[i]] *
        basis->discrepancy->variances[basis->stack->classes[i]];
  return sum;
}

/* @d: a diagnosis
 * @basis: what the posterior is found with
 * @z: (array): the residual with the likeliest explanation
 *
 * Fills the result's rivals but that nothing acts, and the probability that something unknown acts.
 */
void
cloth_diagnosis_find_unknown (ClothDiagnosis * d, const ClothGapBasis * basis,
    const gdouble * z)
{
  const ClothGapStack *s = basis->stack;
  const gdouble prior = -log (count_effects (d) - 1.);
  g_autofree gdouble *left = g_new (gdouble, s->size);
  g_autofree gdouble *powers = g_new (gdouble, s->n_classes + 1);
  g_autofree gboolean *is_force = g_new0 (gboolean, s->n + 1);
  ClothGapUnknown unknown = { 0. };
  ClothGapRivals *rivals = &d->result->rivals;
  gdouble force, displacement, odds, power;

  rivals->force_field = rivals->displacement_field = 0.;
  for (guint i = 0; i < d->candidates->list->len; i++)
    for (guint k = 0; k < candidate_of (d, i)->n; k++)
      is_force[candidate_of (d, i)->first + k - s->n_free] =
          candidate_of (d, i)->effect->side == CLOTH_EFFECT_PHYSICS;
  cloth_gap_discrepancy_take_reference_off (basis->discrepancy, s, z, left);
  cloth_gap_likelihood_find_rest (basis->likelihood, left, powers);
  cloth_gap_find_unknown (s, basis->discrepancy, is_force, powers, &unknown);
  force = exp (MIN (unknown.force_field + prior, 300.));
  displacement = exp (MIN (unknown.displacement_field + prior, 300.));
  odds = force + displacement;
  rivals->force_field = force / (1. + odds);
  rivals->displacement_field = displacement / (1. + odds);
  cloth_gap_discrepancy_take_reference_off (basis->discrepancy, s,
      basis->null, left);
  cloth_gap_likelihood_find_rest (basis->likelihood, left, powers);
  power = find_power (basis, powers);
  d->unknown_share = power > 0. ? MIN (unknown.power / power, 1.) : 0.;
  d->unknown_probability = odds / (1. + odds);
}

/* How large each number must be to show. */
static void
fill_limits (ClothDiagnosis * d, const ClothGapBasis * basis)
{
  const gdouble coarsening = cloth_gap_likelihood_get_coarsening ();

  for (guint i = 0; i < d->candidates->list->len; i++) {
    const ClothCandidate *c = candidate_of (d, i);

    if (cloth_candidate_is_stochastic (c)
        || (i && c->effect == candidate_of (d, i - 1)->effect))
      continue;
    for (guint k = 0; k < c->n; k++) {
      const ClothDirection *direction =
          cloth_candidates_direction (d->candidates, c->first + k);
      const gdouble most = MAX (direction->high - direction->centre,
          direction->centre - direction->low);
      gdouble information, needed, value;

      if (direction->present || direction->shapes)
        continue;
      information = cloth_gap_gram_find_information (basis->gram,
          c->first + k - d->candidates->n_free);
      needed = 0.5 * log1p (coarsening * direction->prior *
          direction->prior * information) + log (count_effects (d) - 1.);
      value = (QUANTILE + sqrt (2. * needed / coarsening)) / sqrt (information);
      cloth_gap_result_add_limit (d->result, c->effect, c->parameters[k],
          value <= most ? value : NAN);
    }
  }
}

/* The model's own numbers as they were fitted, and how sure they are. */
static void
fill_free_numbers (ClothDiagnosis * d, const ClothGapBasis * basis)
{
  const guint n = d->candidates->n_free;
  g_autofree gdouble *covariance = g_new (gdouble, n * n + 1);

  if (!n)
    return;
  cloth_gap_likelihood_find_free_covariance (basis->likelihood, covariance);
  d->result->free_correlation = g_new (gdouble, n * n);
  for (guint i = 0; i < n; i++) {
    const ClothDirection *direction = cloth_candidates_direction
        (d->candidates, i);
    ClothGapFreeNumber *f = cloth_gap_result_add_free_number (d->result,
        direction->name, cloth_model_get_unit (direction->name));
    const gdouble sigma = sqrt (covariance[i * n + i]);

    cloth_model_get (d->model, direction->name, &f->value, NULL);
    /* to first order where it is the logarithm that is known */
    f->sigma = direction->logarithmic ? f->value * sigma : sigma;
    f->low = direction->logarithmic ? exp (direction->low) : direction->low;
    f->high = direction->logarithmic ? exp (direction->high) : direction->high;
    f->at_end = cloth_diagnosis_is_at_end (d, i);
    for (guint k = 0; k < n; k++)
      d->result->free_correlation[i * n + k] = covariance[i * n + k] /
          sqrt (covariance[i * n + i] * covariance[k * n + k]);
  }
}

/* Clamps that were elsewhere than logged, unless an effect that acts on clamps or on the recording says so: something
 * unknown has moved them. */
static void
find_clamps (ClothDiagnosis * d, const ClothGapHypothesis * best)
{
  gdouble log_bayes_factor, p;

  for (guint c = 0; c < best->n; c++)
    if (candidate_of (d, best->candidates[c])->effect->side ==
        CLOTH_EFFECT_CLAMP
        || candidate_of (d, best->candidates[c])->effect->side ==
        CLOTH_EFFECT_MEASUREMENT)
      return;
  d->clamps_off = cloth_diagnosis_find_clamps_off (d, &log_bayes_factor);
  p = 1. / (1. + exp (log (count_effects (d) - 1.) - log_bayes_factor));
  d->unknown_probability = 1. - (1. - d->unknown_probability) * (1. - p);
  if (p <= 0.5)
    g_clear_pointer (&d->clamps_off, g_free);
}

/* @d: a diagnosis
 * @basis: what the posterior was found with
 * @hypotheses: (element-type ClothGapHypothesis): all that were compared, the likeliest first
 *
 * Fills the result's effects, explanations, rivals, groups and limits, and accepts effects.
 */
void
cloth_diagnosis_conclude (ClothDiagnosis * d, const ClothGapBasis * basis,
    const GArray * hypotheses)
{
  find_clamps (d, &g_array_index (hypotheses, ClothGapHypothesis, 0));
  d->result->rivals.none_acts = 0.;
  fill_effects (d, hypotheses);
  fill_sets (d, hypotheses);
  fill_group (d);
  accept (d, hypotheses);
  fill_limits (d, basis);
  fill_free_numbers (d, basis);
}
