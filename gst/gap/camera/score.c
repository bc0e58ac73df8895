/* Decides how much the residual supports each effect: the score test of each candidate at its
 * null (Rao 1948; as Lagrange multiplier test Silvey 1959).
 *
 * Model: z = −B dη − N dν + e, with the whitened features z of the residual, their derivatives B
 * by the effect's directions and N by the nuisances, and e normal with the variance φ. The change
 * dη has the normal prior of the effect, with precision R⁻¹ = diag(1/prior²).
 * Assumption: the features are linear in dη as far as the prior reaches.
 * Formulas, with g, s, r and φ of test.c:
 *   A = g/φ + R⁻¹,  η̂ = −A⁻¹ s/φ,  covariance A⁻¹
 *   log Bayes factor = ½ sᵀA⁻¹s/φ² − ½ log det (A R)
 *   LM = sᵀA⁻¹s/φ², of which the p-value is the tail of χ², that of the best of n 1 − (1 − p)ⁿ
 *   improvement = share of zᵀz that is removed from each block by estimates from the others
 *   constancy: Σ over blocks of ρᵀ g⁻¹ ρ/φ with ρ = s + g η̂ of the block is χ² about the common η̂
 * A one-sided effect has η̂ ≥ 0.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/camera/score.h"

#include <math.h>
#include <string.h>

#include "gst/math/statistics.h"

#define MOST CLOTH_EFFECT_MAX_PARAMETERS

typedef struct
{
  const ClothGapTest *test;
  const ClothCandidate *candidate;
  guint directions[MOST];
  gdouble precisions[MOST];
  gboolean one_sided;
} Trial;

static gboolean
trial_init (Trial * trial, const ClothGapTest * test, guint candidate)
{
  const ClothCandidates *c = test->candidates;

  trial->test = test;
  trial->candidate = &g_array_index (c->list, ClothCandidate, candidate);
  for (guint i = 0; i < trial->candidate->n; i++) {
    const ClothDirection *d = cloth_candidates_direction (c,
        trial->candidate->first + i);

    trial->directions[i] = trial->candidate->first + i;
    trial->precisions[i] = 1. / (d->prior * d->prior);
    trial->one_sided = trial->candidate->n == 1 && d->one_sided;
    if (!test->sound[trial->directions[i]])
      return FALSE;
  }
  return trial->candidate->n > 0;
}

/* The most probable changes from reduced equations of noise @phi: 0 where only growth is
 * allowed. @inverse: their covariance. */
static gboolean
estimate (const Trial * trial, const ClothReducedEquations * reduced,
    gdouble phi, gdouble * changes, gdouble * inverse, gdouble * log_det)
{
  g_auto (ClothPosterior) posterior = { 0 };

  cloth_posterior_init (&posterior, reduced->n);
  cloth_posterior_add_data (&posterior, reduced->g, reduced->s, phi);
  cloth_posterior_add_prior (&posterior, trial->precisions, NULL);
  if (!cloth_posterior_solve (&posterior))
    return FALSE;
  *log_det = cloth_posterior_log_determinant (&posterior);
  for (guint i = 0; i < reduced->n; i++)
    *log_det -= log (trial->precisions[i]);
  memcpy (changes, posterior.mean, reduced->n * sizeof *changes);
  cloth_posterior_covariance (&posterior, inverse);
  if (trial->one_sided && changes[0] < 0.)
    changes[0] = 0.;
  return TRUE;
}

static gboolean
reduce (const Trial * trial, const ClothNormalEquations * normal,
    const gboolean * blocks, ClothReducedEquations * reduced)
{
  return cloth_gap_test_reduce (trial->test, normal, blocks, trial->directions,
      trial->candidate->n, reduced);
}

/* The nuisances, and with them the effect's @n directions, estimated from @blocks: changes
 * of @columns, which lists them, from where the effect is @at. */
static gboolean
estimate_all (const Trial * trial, const ClothNormalEquations * normal,
    const gdouble * at, const gboolean * blocks, gdouble phi, guint n,
    const guint * columns, gdouble * changes)
{
  const ClothGapTest *t = trial->test;
  const guint q = t->n_nuisances + n;
  g_auto (ClothPosterior) posterior = { 0 };
  g_autofree gdouble *g = g_new (gdouble, (gsize) q * q + 1);
  g_autofree gdouble *s = g_new (gdouble, q + 1);
  g_autofree gdouble *precisions = g_new (gdouble, q + 1);
  g_autofree gdouble *means = g_new0 (gdouble, q + 1);

  for (guint i = 0; i < t->n_nuisances; i++)
    precisions[i] = t->precisions[i] * t->overdispersion;
  for (guint k = 0; k < n; k++) {
    precisions[t->n_nuisances + k] = trial->precisions[k] * phi;
    means[t->n_nuisances + k] = -at[k];
  }
  cloth_normal_equations_sum (normal, blocks, columns, q, g, s);
  cloth_posterior_init (&posterior, q);
  cloth_posterior_add_data (&posterior, g, s, 1.);
  cloth_posterior_add_prior (&posterior, precisions, means);
  if (!cloth_posterior_solve (&posterior))
    return FALSE;
  memcpy (changes, posterior.mean, q * sizeof *changes);
  return !(n && trial->one_sided && at[0] + changes[t->n_nuisances] < 0.);
}

/* What the effect, which was simulated @at some place, makes better there in each block
 * when it and the nuisances are estimated from the others, beyond what the nuisances do
 * @without it. */
static gdouble
cross_validate (const Trial * trial, const ClothNormalEquations * without,
    const ClothNormalEquations * with, const gdouble * at, gdouble phi,
    gdouble * total)
{
  const ClothGapTest *t = trial->test;
  guint n = trial->candidate->n, q = t->n_nuisances;
  g_autofree gboolean *others = g_memdup2 (t->blocks,
      with->n_blocks * sizeof *others);
  g_autofree guint *columns = g_new (guint, q + n);
  g_autofree gdouble *alone = g_new (gdouble, q + n);
  g_autofree gdouble *both = g_new (gdouble, q + n);
  gdouble gained = 0.;

  for (guint i = 0; i < q + n; i++)
    columns[i] = i < q ? t->nuisances[i] : trial->directions[i - q];
  for (guint b = 0; b < with->n_blocks; b++) {
    if (!t->blocks[b])
      continue;
    others[b] = FALSE;
    *total += without->r[b];
    if (estimate_all (trial, without, at, others, phi, 0, columns, alone)
        && estimate_all (trial, with, at, others, phi, n, columns, both))
      gained += without->r[b] - with->r[b] +
          cloth_normal_equations_change (without, b, columns, alone, q) -
          cloth_normal_equations_change (with, b, columns, both, q + n);
    others[b] = TRUE;
  }
  return gained;
}

/* @test: what is tested
 * @candidate: a candidate
 * @without: normal equations without it
 * @with: normal equations where it was simulated
 * @directions: (array): columns of its directions in them
 * @at: (array): how far each is from its null there
 * @phi: how much more than the noise a square counts
 *
 * Returns: as #ClothGapScore.improvement, by the derivatives there
 */
gdouble
cloth_gap_test_improvement (const ClothGapTest * test, guint candidate,
    const ClothNormalEquations * without, const ClothNormalEquations * with,
    const guint * directions, const gdouble * at, gdouble phi)
{
  Trial trial;
  gdouble total = 0., gained;

  if (!trial_init (&trial, test, candidate))
    return 0.;
  memcpy (trial.directions, directions,
      trial.candidate->n * sizeof *directions);
  gained = cross_validate (&trial, without, with, at, phi, &total);
  return total > 0. ? gained / total : 0.;
}

/* χ² of the blocks' own estimates about the common one, and its degrees of freedom. */
static gdouble
heterogeneity (const Trial * trial, const ClothNormalEquations * normal,
    gdouble phi, const gdouble * common, guint * freedom)
{
  guint n = trial->candidate->n;
  g_autofree gboolean *one = g_new0 (gboolean, normal->n_blocks);
  gdouble sum = 0.;

  for (guint b = 0; b < normal->n_blocks; b++) {
    ClothReducedEquations reduced;
    gdouble rest[MOST];
    g_auto (ClothPosterior) own = { 0 };

    if (!trial->test->blocks[b])
      continue;
    one[b] = TRUE;
    if (reduce (trial, normal, one, &reduced)) {
      for (guint i = 0; i < n; i++) {
        rest[i] = reduced.s[i];
        for (guint j = 0; j < n; j++)
          rest[i] += reduced.g[i * n + j] * common[j];
      }
      /* what this block's own estimate is beyond the common one */
      cloth_posterior_init (&own, n);
      cloth_posterior_add_data (&own, reduced.g, rest, 1.);
      if (cloth_posterior_solve (&own)) {
        for (guint i = 0; i < n; i++)
          sum -= rest[i] * own.mean[i] / phi;
        *freedom += n;
      }
    }
    one[b] = FALSE;
  }
  return sum;
}

static gboolean
run_trial (const Trial * trial, ClothGapScore * score)
{
  guint n = trial->candidate->n, freedom = 0;
  const ClothNormalEquations *normal = trial->test->normal;
  gdouble gained, total = 0., spread;
  ClothReducedEquations reduced, plain;
  gdouble phi, changes[MOST], inverse[MOST * MOST], log_det, fit = 0.;
  const gdouble null[MOST] = { 0. };
  ClothGapTest numbers = *trial->test;  /* without variability */

  numbers.n_nuisances = numbers.n_numbers;
  score->kept = 1.;
  if (!reduce (trial, normal, trial->test->blocks, &reduced)
      || !cloth_gap_test_reduce (&numbers, normal, numbers.blocks,
          trial->directions, n, &plain))
    return FALSE;
  phi = cloth_gap_test_dispersion (trial->test, normal, &reduced);
  if (!estimate (trial, &reduced, phi, changes, inverse, &log_det))
    return FALSE;
  for (guint i = 0; i < n; i++) {
    fit -= 0.5 * reduced.s[i] / phi * changes[i];
    score->kept = MIN (score->kept, plain.kept[i]);
    score->changes[i] = changes[i];
    score->sigmas[i] = sqrt (inverse[i * n + i]);
  }
  score->log_bayes_factor = fit - 0.5 * log_det;
  gained = cross_validate (trial, normal, normal, null, phi, &total);
  spread = heterogeneity (trial, normal, phi, changes, &freedom);
  score->improvement = total > 0. ? gained / total : 0.;
  score->p_value = cloth_chi_square_tail (2. * fit, n);
  /* each direction's common value was fitted */
  score->constancy_p_value = freedom > n ?
      cloth_chi_square_tail (spread, freedom - n) : NAN;
  return TRUE;
}

/* @a: a #ClothGapScore
 * @b: another
 *
 * Returns: which is likelier, for g_array_sort (): the likeliest first
 */
gint
cloth_gap_score_compare (gconstpointer a, gconstpointer b)
{
  const ClothGapScore *x = a, *y = b;

  if (x->log_bayes_factor != y->log_bayes_factor)
    return x->log_bayes_factor > y->log_bayes_factor ? -1 : 1;
  return x->candidate < y->candidate ? -1 : x->candidate > y->candidate;
}

/* @test: what is tested
 *
 * Returns: (transfer full) (element-type ClothGapScore): the best candidate of each
 *   effect, the likeliest first; an effect of several candidates pays for the choice, one
 *   that the nuisances can stand in for has no evidence: −∞
 */
GArray *
cloth_gap_test_run (const ClothGapTest * test)
{
  GArray *best = g_array_new (FALSE, FALSE, sizeof (ClothGapScore));
  const GArray *list = test->candidates->list;

  for (guint i = 0; i < list->len;) {
    const ClothEffect *effect = g_array_index (list, ClothCandidate, i).effect;
    ClothGapScore most = {.log_bayes_factor = -INFINITY };
    guint n = 0;

    for (; i < list->len
        && g_array_index (list, ClothCandidate, i).effect == effect; i++) {
      ClothGapScore score = {.candidate = i };

      Trial trial;

      if (!trial_init (&trial, test, i) || !run_trial (&trial, &score))
        continue;
      n++;
      if (score.log_bayes_factor > most.log_bayes_factor)
        most = score;
    }
    if (!n)
      continue;
    most.log_bayes_factor = most.kept < CLOTH_GAP_IDENTIFIABLE ? -INFINITY :
        most.log_bayes_factor - log (n);
    /* that none of so many would be as large: 1 − (1 − p)ⁿ */
    most.p_value = -expm1 (n * log1p (-most.p_value));
    g_array_append_val (best, most);
  }
  g_array_sort (best, cloth_gap_score_compare);
  return best;
}

/* @test: what is tested
 * @one: a candidate
 * @other: another
 *
 * Returns: largest cosine between a derivative of the one and one of the other once the
 *   nuisances are projected out
 */
gdouble
cloth_gap_test_cosine (const ClothGapTest * test, guint one, guint other)
{
  const GArray *list = test->candidates->list;
  const ClothCandidate *a = &g_array_index (list, ClothCandidate, one);
  const ClothCandidate *b = &g_array_index (list, ClothCandidate, other);
  gdouble most = 0.;

  for (guint i = 0; i < a->n; i++)
    for (guint j = 0; j < b->n; j++) {
      const guint directions[2] = { a->first + i, b->first + j };
      ClothReducedEquations r;

      if (cloth_gap_test_reduce (test, test->normal, test->blocks, directions,
              2, &r) && r.g[0] > 0. && r.g[3] > 0.)
        most = MAX (most, fabs (r.g[1]) / sqrt (r.g[0] * r.g[3]));
    }
  return most;
}
