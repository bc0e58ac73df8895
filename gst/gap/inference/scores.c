/* The residual as few numbers: its score along each direction, and what these are by chance.
 *
 * Model: z = β y + d − B θ, with y the reference's residual and θ the effects. The rest of the discrepancy is
 *   d = N c + ε: N = (F U), F the derivatives by the free numbers and U the M members, both beyond
 *   what β y says; ε ~ N(0, V), V diagonal. The reference has the same c: y = N_y c + ε_y. Before
 *   anything is seen c ~ N(0, diag (Λ, M)⁻¹).
 * Formulas: the reference leaves c ~ N(c_y, K_y⁻¹),
 *     K_y = N_yᵀW_yN_y/φ + diag (Λ, M),  c_y = K_y⁻¹N_yᵀW_y y/φ,
 *   so that it tells of another motion what the members that are like it there do here. With W = V⁻¹
 *     K = NᵀWN + K_y,  P = W − W N K⁻¹NᵀW,  offset = β y + N c_y,
 *     scores s = BᵀP (z − offset),  G = BᵀPB.
 *   If nothing acts s ~ N(0, G + C): C is the covariance of the members' own scores. Each member is taken for
 *   the recording, and the members of its family are not in U then: so they tell what a simulator
 *   does that nobody has tried yet. With L₀L₀ᵀ = G, L₀⁻¹C L₀⁻ᵀ is shrunk to a multiple of the
 *   identity (Ledoit and Wolf 2004). Directions are in units of their priors.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/inference/scores.h"

#include <math.h>
#include <string.h>

#include "gst/gap/inference/evidence.h"
#include "gst/math/linalg.h"

/* Directions are told apart down to this share of their variance. */
#define ALIKE 1e-4

/* Nuisances, and what makes them of a residual. */
struct _ClothGapProjector
{
  guint n;
  gsize size;
  const gdouble **columns;
  const gdouble **on_reference; /* without a reference not used */
  gdouble *weights;             /* W, of each feature */
  gdouble *reference_weights;   /* W_y/φ */
  gdouble *prior;               /* factor of K_y */
  gdouble *factor;              /* of K */
};

static void
projector_free (ClothGapProjector * p)
{
  if (!p)
    return;
  g_free (p->columns);
  g_free (p->on_reference);
  g_free (p->weights);
  g_free (p->reference_weights);
  g_free (p->prior);
  g_free (p->factor);
  g_free (p);
}

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothGapProjector, projector_free);
/* Adds NᵀWN. */
static void
add_products (guint n, gsize size, const gdouble ** columns,
    const gdouble * weights, gdouble * to)
{
  g_autofree gdouble *weighted = g_new (gdouble, size);

  for (guint k = 0; k < n; k++) {
    for (gsize i = 0; i < size; i++)
      weighted[i] = weights[i] * columns[k][i];
    for (guint j = 0; j <= k; j++) {
      to[k * n + j] += cloth_gap_dot (weighted, columns[j], size);
      to[j * n + k] = to[k * n + j];
    }
  }
}

static gdouble *
make_weights (const ClothGapStack * stack, const gdouble * variances,
    gdouble overdispersion)
{
  gdouble *weights = g_new (gdouble, stack->size);

  for (gsize i = 0; i < stack->size; i++)
    weights[i] = variances[stack->classes[i]] > 0. ?
        1. / (overdispersion * variances[stack->classes[i]]) : 0.;
  return weights;
}

/* @left_out: the family that is not among the nuisances */
static ClothGapProjector *
projector_new (const ClothGapStack * stack, const ClothGapDiscrepancy * d,
    guint left_out)
{
  const gsize size = stack->size;
  g_autoptr (ClothGapProjector) p = g_new0 (ClothGapProjector, 1);
  guint members = 0;

  p->size = size;
  p->columns = g_new (const gdouble *, stack->n_free + stack->n_members + 1);
  p->on_reference = g_new (const gdouble *,
      stack->n_free + stack->n_members + 1);
  for (; p->n < stack->n_free; p->n++) {
    p->columns[p->n] = d->free + p->n * size;
    p->on_reference[p->n] = stack->reference_free + p->n * size;
  }
  for (guint m = 0; m < stack->n_members; m++) {
    if (stack->families[m] == left_out)
      continue;
    p->columns[p->n] = d->members + m * size;
    p->on_reference[p->n++] = d->on_reference + m * size;
    members++;
  }
  p->weights = make_weights (stack, d->variances, 1.);
  p->prior = g_new0 (gdouble, p->n * p->n + 1);
  for (guint k = 0; k < p->n; k++)
    p->prior[k * p->n + k] = k < stack->n_free ? stack->precisions[k] : members;
  if (stack->reference) {
    p->reference_weights = make_weights (stack, d->reference_variances,
        stack->overdispersion);
    add_products (p->n, size, p->on_reference, p->reference_weights, p->prior);
  }
  p->factor = g_memdup2 (p->prior, p->n * p->n * sizeof (gdouble) + 1);
  add_products (p->n, size, p->columns, p->weights, p->factor);
  return cloth_cholesky_factor (p->n, p->prior)
      && cloth_cholesky_factor (p->n, p->factor) ? g_steal_pointer (&p) : NULL;
}

static void
take_off (const ClothGapProjector * p, const gdouble * share, gdouble * z)
{
  for (guint k = 0; k < p->n; k++)
    for (gsize i = 0; i < p->size; i++)
      z[i] -= share[k] * p->columns[k][i];
}

/* What the nuisances leave of z. */
static void
project (const ClothGapProjector * p, gdouble * z)
{
  g_autofree gdouble *share = g_new (gdouble, p->n + 1);
  g_autofree gdouble *weighted = g_new (gdouble, p->size);

  for (gsize i = 0; i < p->size; i++)
    weighted[i] = p->weights[i] * z[i];
  for (guint k = 0; k < p->n; k++)
    share[k] = cloth_gap_dot (p->columns[k], weighted, p->size);
  cloth_cholesky_solve (p->n, p->factor, share);
  take_off (p, share, z);
}

/* z less what a reference's residual says of the nuisances. */
static void
take_nuisances_off (const ClothGapProjector * p, const gdouble * reference,
    gdouble * z)
{
  g_autofree gdouble *share = g_new (gdouble, p->n + 1);
  g_autofree gdouble *weighted = g_new (gdouble, p->size);

  for (gsize i = 0; i < p->size; i++)
    weighted[i] = p->reference_weights[i] * reference[i];
  for (guint k = 0; k < p->n; k++)
    share[k] = cloth_gap_dot (p->on_reference[k], weighted, p->size);
  cloth_cholesky_solve (p->n, p->prior, share);
  take_off (p, share, z);
}

/* PB with directions in units of their priors, [n][size]. */
static gdouble *
make_templates (const ClothGapStack * stack, const ClothGapProjector * p)
{
  gdouble *templates = g_new (gdouble, stack->n * stack->size + 1);

  for (guint k = 0; k < stack->n; k++) {
    gdouble *to = templates + k * stack->size;

    memcpy (to, stack->columns + k * stack->size, stack->size * sizeof *to);
    project (p, to);
    for (gsize i = 0; i < stack->size; i++)
      to[i] *= p->weights[i] * stack->priors[k];
  }
  return templates;
}

/* x becomes L⁻¹x. */
static void
solve_lower (guint n, const gdouble * l, gdouble * x)
{
  for (guint i = 0; i < n; i++) {
    for (guint k = 0; k < i; k++)
      x[i] -= l[i * n + k] * x[k];
    x[i] /= l[i * n + i];
  }
}

/* The scores of each member by the templates that its family is not in, [n_members][n]; and the
 * powers of what nuisances leave of it. */
static gdouble *
find_member_scores (const ClothGapStack * stack,
    const ClothGapDiscrepancy * d, gdouble * rests)
{
  gdouble *scores = g_new0 (gdouble, stack->n_members * stack->n + 1);
  g_autofree gdouble *rest = g_new (gdouble, stack->size);

  for (guint family = 0; family < 2; family++) {
    g_autoptr (ClothGapProjector) p = projector_new (stack, d, family);
    g_autofree gdouble *templates = p ? make_templates (stack, p) : NULL;

    for (guint m = 0; p && m < stack->n_members; m++) {
      if (stack->families[m] != family)
        continue;
      memcpy (rest, d->members + m * stack->size,
          stack->size * sizeof (gdouble));
      if (stack->reference)
        take_nuisances_off (p, d->on_reference + m * stack->size, rest);
      for (guint k = 0; k < stack->n; k++)
        scores[m * stack->n + k] =
            cloth_gap_dot (templates + k * stack->size, rest, stack->size);
      project (p, rest);
      cloth_gap_find_powers (stack, rest, rests + m * stack->n_classes);
      for (guint c = 0; c < stack->n_classes; c++)
        if (d->variances[c] > 0.)
          rests[m * stack->n_classes + c] /= d->variances[c];
    }
  }
  return scores;
}

/* Their second moments, shrunk to a multiple of the identity. */
static void
find_covariance (guint n_members, guint n, const gdouble * scores,
    gdouble * covariance)
{
  gdouble mean = 0., away = 0., scatter = 0., share;

  memset (covariance, 0, n * n * sizeof *covariance);
  for (guint m = 0; m < n_members; m++)
    for (guint i = 0; i < n; i++)
      for (guint k = 0; k < n; k++)
        covariance[i * n + k] += scores[m * n + i] * scores[m * n + k] /
            n_members;
  for (guint i = 0; i < n; i++)
    mean += covariance[i * n + i] / n;
  for (guint i = 0; i < n; i++)
    for (guint k = 0; k < n; k++)
      away += pow (covariance[i * n + k] - (i == k ? mean : 0.), 2.);
  for (guint m = 0; m < n_members; m++)
    for (guint i = 0; i < n; i++)
      for (guint k = 0; k < n; k++)
        scatter += pow (scores[m * n + i] * scores[m * n + k] -
            covariance[i * n + k], 2.) / ((gdouble) n_members * n_members);
  share = away > 0. ? MIN (scatter / away, 1.) : 1.;
  for (guint i = 0; i < n; i++)
    for (guint k = 0; k < n; k++)
      covariance[i * n + k] = (1. - share) * covariance[i * n + k] +
          (i == k ? share * mean : 0.);
}

/* L of the covariance of scores, from their derivatives G; @member_scores become L₀⁻¹ of them. */
static gboolean
make_whitener (guint n, const gdouble * g, guint n_members,
    gdouble * member_scores, gdouble * whitener)
{
  g_autofree gdouble *inner = g_memdup2 (g, n * n * sizeof *g);
  g_autofree gdouble *covariance = g_new (gdouble, n * n);

  for (guint k = 0; k < n; k++)
    inner[k * n + k] += g[k * n + k] > 0. ? ALIKE * g[k * n + k] : 1.;
  if (!cloth_cholesky_factor (n, inner))
    return FALSE;
  for (guint m = 0; m < n_members; m++)
    solve_lower (n, inner, member_scores + m * n);
  find_covariance (n_members, n, member_scores, covariance);
  for (guint k = 0; k < n; k++)
    covariance[k * n + k] += 1.;
  if (!cloth_cholesky_factor (n, covariance))
    return FALSE;
  /* (L₀L₁)(L₀L₁)ᵀ = L₀ (1 + C) L₀ᵀ */
  memset (whitener, 0, n * n * sizeof *whitener);
  for (guint i = 0; i < n; i++)
    for (guint k = 0; k <= i; k++)
      for (guint j = k; j <= i; j++)
        whitener[i * n + k] += inner[i * n + j] * covariance[j * n + k];
  return TRUE;
}

/* G of templates, in units of priors. */
static gdouble *
make_gram (const ClothGapStack * stack, const gdouble * templates)
{
  const guint n = stack->n;
  gdouble *g = g_new (gdouble, n * n + 1);

  for (guint k = 0; k < n; k++)
    for (guint i = 0; i < n; i++)
      g[k * n + i] = stack->priors[k] * cloth_gap_dot (templates +
          i * stack->size, stack->columns + k * stack->size, stack->size);
  return g;
}

/* Logarithm of the mean Bayes factor of all single directions, against none, of a member's whitened
 * scores. */
static gdouble
find_chance_evidence (guint n, const gdouble * e, const gdouble * derivatives,
    const gdouble * priors)
{
  const gdouble at = 0.;
  ClothGapEvidence evidence;
  gdouble none, sum = 0.;

  if (!cloth_gap_evidence_find (n, e, NULL, NULL, NULL, 0, &evidence))
    return 0.;
  none = evidence.log_evidence;
  for (guint k = 0; k < n; k++) {
    const ClothGapPrior prior = { priors[k], 0., FALSE };

    if (cloth_gap_evidence_find (n, e, derivatives + k * n, &at, &prior, 1,
            &evidence))
      sum += exp (MIN (evidence.log_evidence - none, 300.)) / n;
  }
  return log (sum);
}

/* How far evidence goes by chance: each member is held against what the members of the other family
 * say chance is. */
static gdouble
find_temperature (const ClothGapStack * stack, const ClothGapDiscrepancy * d,
    const gdouble * member_scores)
{
  const guint n = stack->n;
  gdouble sum = 0., count = 0.;

  for (guint family = 0; family < 2; family++) {
    g_autoptr (ClothGapProjector) p = projector_new (stack, d, family);
    g_autofree gdouble *templates = p ? make_templates (stack, p) : NULL;
    g_autofree gdouble *g = p ? make_gram (stack, templates) : NULL;
    g_autofree gdouble *others = g_new (gdouble, stack->n_members * n + 1);
    g_autofree gdouble *whitener = g_new (gdouble, n * n + 1);
    g_autofree gdouble *derivatives = NULL;
    guint n_others = 0;

    for (guint m = 0; m < stack->n_members; m++)
      if (stack->families[m] != family)
        memcpy (others + n_others++ * n, member_scores + m * n,
            n * sizeof *others);
    if (!p || !n_others || !make_whitener (n, g, n_others, others, whitener))
      continue;
    derivatives = g_memdup2 (g, n * n * sizeof *g);
    for (guint k = 0; k < n; k++) {
      for (guint i = 0; i < n; i++)
        derivatives[k * n + i] /= stack->priors[k];
      solve_lower (n, whitener, derivatives + k * n);
    }
    for (guint m = 0; m < stack->n_members; m++) {
      g_autofree gdouble *e = NULL;
      gdouble evidence;

      if (stack->families[m] != family)
        continue;
      e = g_memdup2 (member_scores + m * n, n * sizeof *e);
      solve_lower (n, whitener, e);
      evidence = find_chance_evidence (n, e, derivatives, stack->priors);
      if (evidence > 0.) {
        sum += evidence;
        count++;
      }
    }
  }
  return MAX ((1. + sum) / (1. + count), 1.);
}

/* What the reference says of the residual. */
static gdouble *
make_offset (const ClothGapStack * stack, const ClothGapDiscrepancy * d,
    const ClothGapProjector * p)
{
  gdouble *offset = g_new0 (gdouble, stack->size);

  if (!stack->reference)
    return offset;
  take_nuisances_off (p, stack->reference, offset);
  for (gsize i = 0; i < stack->size; i++)
    offset[i] = d->slopes[stack->classes[i]] * stack->reference[i] - offset[i];
  return offset;
}

static gdouble *
make_free_covariance (const ClothGapStack * stack, const ClothGapProjector * p)
{
  const guint n = stack->n_free;
  g_autofree gdouble *all = g_new (gdouble, p->n * p->n + 1);
  gdouble *covariance = g_new (gdouble, n * n + 1);

  cloth_cholesky_inverse (p->n, p->factor, all);
  for (guint i = 0; i < n; i++)
    for (guint k = 0; k < n; k++)
      covariance[i * n + k] = all[i * p->n + k];
  return covariance;
}

/* @stack: features
 * @discrepancy: what they are off by if nothing acts; must outlive the scores
 *
 * Returns: (transfer full) (nullable): the scores; %NULL when no direction changes anything
 */
ClothGapScores *
cloth_gap_scores_new (const ClothGapStack * stack,
    const ClothGapDiscrepancy * discrepancy)
{
  const guint n = stack->n;
  g_autoptr (ClothGapScores) s = g_new0 (ClothGapScores, 1);
  g_autofree gdouble *g = NULL, *member_scores = NULL;

  s->n = n;
  s->size = stack->size;
  s->whitener = g_new0 (gdouble, n * n + 1);
  s->derivatives = g_new0 (gdouble, n * n + 1);
  s->member_rests = g_new0 (gdouble, stack->n_members * stack->n_classes + 1);
  s->projector = projector_new (stack, discrepancy, G_MAXUINT);
  if (!n || !s->projector)
    return NULL;
  s->offset = make_offset (stack, discrepancy, s->projector);
  s->free_covariance = make_free_covariance (stack, s->projector);
  s->templates = make_templates (stack, s->projector);
  g = make_gram (stack, s->templates);
  member_scores = find_member_scores (stack, discrepancy, s->member_rests);
  s->temperature = find_temperature (stack, discrepancy, member_scores);
  if (!make_whitener (n, g, stack->n_members, member_scores, s->whitener))
    return NULL;
  for (guint k = 0; k < n; k++) {
    for (guint i = 0; i < n; i++)
      s->derivatives[k * n + i] = g[k * n + i] / stack->priors[k];
    solve_lower (n, s->whitener, s->derivatives + k * n);
  }
  return g_steal_pointer (&s);
}

/* @scores: scores
 * @z: (array): a residual
 * @e: (out) (array): its whitened scores
 */
void
cloth_gap_scores_find (const ClothGapScores * scores, const gdouble * z,
    gdouble * e)
{
  g_autofree gdouble *left = g_new (gdouble, scores->size);

  for (gsize i = 0; i < scores->size; i++)
    left[i] = z[i] - scores->offset[i];
  for (guint k = 0; k < scores->n; k++)
    e[k] = cloth_gap_dot (scores->templates + k * scores->size, left,
        scores->size);
  solve_lower (scores->n, scores->whitener, e);
}

/* @scores: scores
 * @z: (array): a residual
 * @rest: (out) (array): what neither the reference nor the nuisances make of it
 */
void
cloth_gap_scores_find_rest (const ClothGapScores * scores, const gdouble * z,
    gdouble * rest)
{
  for (gsize i = 0; i < scores->size; i++)
    rest[i] = z[i] - scores->offset[i];
  project (scores->projector, rest);
}

/* @scores: (nullable) (transfer full): scores
 */
void
cloth_gap_scores_free (ClothGapScores * scores)
{
  if (!scores)
    return;
  g_free (scores->templates);
  g_free (scores->offset);
  g_free (scores->whitener);
  g_free (scores->derivatives);
  g_free (scores->member_rests);
  g_free (scores->free_covariance);
  projector_free (scores->projector);
  g_free (scores);
}
