/* How likely a residual is: class by class of features, with nuisances integrated out.
 * SPDX-License-Identifier: LGPL-2.1-or-later
 *
 * Model: z = β y + N c + J (θ − θ₀) + ε. y is the reference's residual. The nuisances N are F, the
 *   derivatives by the model's free numbers, and the members D of the ensemble: simulators differ in
 *   directions in which members differ. Both are what remains beyond the reference (discrepancy.c).
 *   c ~ N(0, K⁻¹): K has the free numbers' posterior on the reference, and M for each of the M
 *   members. θ are the effects, each with its prior. Within class k the n features of ε are
 *   exchangeable with variance s_k V_k; V_k is what members show, and s_k, how much larger this
 *   cloth's is, is unknown: ν/s_k ~ χ²(ν).
 * Features of a class are not independent. They count as d_k independent ones, found from the M
 *   members by the participation ratio of their covariance, with unbiased moments:
 *     d = (mean |D_m|²)² / mean over m ≠ l of (D_m·D_l)².
 *   Between classes they depend on each other, too, and V itself is known from M members only. So the
 *   likelihood is coarsened: raised to the power ζ = ½.
 * Formulas: with q_k = ζ d_k × mean over the class of r²/V_k and r the residual,
 *     log p (z | θ, c) = −½ Σ_k (ν + ζ d_k) log (1 + q_k/ν) + constant  (multivariate t),
 *   whose mode is found by reweighted least squares, w_k = (ν + ζ d_k)/(ν + q_k),
 *     A = Σ_k w_k X_kᵀX_k + Λ,  X = (N J), Λ the precisions of all priors;
 *   log evidence = log p at the mode + log prior − ½ log det (A Λ⁻¹)  (Laplace's method, with A for the
 *     Hessian)
 *     + log 2Φ(θ/σ) of each direction that can't be negative; its value is then the mean of that half. Of
 *     several such directions this is an approximation, as if they were independent.
 * References: Lange, Little and Taylor, Robust statistical modeling using the t distribution, 1989;
 *   Miller and Dunson, Robust Bayesian inference via coarsening, 2019; MacKay, Bayesian interpolation,
 *   1992 (evidence); Kennedy and O'Hagan 2001 (discrepancy).
 */
#include "gst/gap/inference/likelihood.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"

/* ν: how well a class's size is known from the members' others. */
#define SIZE_FREEDOM 10.
/* ζ */
#define COARSENING 0.5
/* Reweighting converges in a few steps. */
#define N_WEIGHTINGS 30
#define CONVERGED 1e-3

/* Features are sorted by class and in units in which q is the sum of squares. */
struct _ClothGapLikelihood
{
  gsize size;
  guint n_classes;
  gsize *order;                 /* feature at each sorted place */
  gsize *begin;                 /* [n_classes + 1] */
  gdouble *scales;              /* of each sorted feature */
  gdouble *freedoms;            /* ζ d of each class */
  guint n_free, n;              /* nuisances: free numbers first */
  gdouble *columns;             /* N, [n][size], sorted and scaled */
  gdouble *products;            /* NᵀN of each class, [n_classes][n][n] */
  gdouble *precision;           /* K, [n][n] */
  const ClothGapStack *stack;
  const ClothGapDiscrepancy *discrepancy;
};

/* Products, class by class, of a residual and of columns: with each other and with the nuisances. */
struct _ClothGapGram
{
  const ClothGapLikelihood *likelihood;
  guint n;                      /* columns, the residual is one more before them */
  gdouble *own;                 /* [n_classes][1 + n][1 + n] */
  gdouble *nuisances;           /* [n_classes][1 + n][nuisances] */
};

/* Returns: the power that likelihoods are raised to */
gdouble
cloth_gap_likelihood_get_coarsening (void)
{
  return COARSENING;
}

/* @likelihood: a likelihood
 *
 * Likelihoods of one residual with different V are compared by their evidence with this. The unit is
 * what members vary by without a reference.
 *
 * Returns: the constant that evidence is up to, −½ Σ ζ d_k log V_k
 */
gdouble
cloth_gap_likelihood_find_constant (const ClothGapLikelihood * likelihood)
{
  const ClothGapLikelihood *l = likelihood;
  g_autofree gdouble *units = g_new0 (gdouble, l->n_classes);
  gdouble sum = 0.;

  cloth_gap_find_mean_powers (l->stack, l->stack->members, units);
  for (guint c = 0; c < l->n_classes; c++)
    if (l->freedoms[c] > 0. && l->discrepancy->variances[c] > 0.)
      sum -= 0.5 * l->freedoms[c] * log (l->discrepancy->variances[c] /
          units[c]);
  return sum;
}

/* @priors: (array length=n): priors
 * @values: (array length=n): values
 * @n: how many
 *
 * Returns: the logarithm of their prior density, less that of the most probable ones
 */
gdouble
cloth_gap_log_prior (const ClothGapPrior * priors, const gdouble * values,
    guint n)
{
  gdouble sum = 0.;

  for (guint k = 0; k < n; k++)
    sum -= 0.5 * pow ((values[k] - priors[k].mean) / priors[k].prior, 2.);
  return sum;
}

static void
sort_features (const ClothGapStack * stack, ClothGapLikelihood * l)
{
  g_autofree gsize *next = g_new (gsize, l->n_classes + 1);

  l->order = g_new (gsize, l->size);
  l->begin = g_new0 (gsize, l->n_classes + 1);
  for (gsize i = 0; i < l->size; i++)
    l->begin[stack->classes[i] + 1]++;
  for (guint c = 0; c < l->n_classes; c++)
    l->begin[c + 1] += l->begin[c];
  memcpy (next, l->begin, (l->n_classes + 1) * sizeof *next);
  for (gsize i = 0; i < l->size; i++)
    l->order[next[stack->classes[i]]++] = i;
}

static void
sort_and_scale (const ClothGapLikelihood * l, const gdouble * from,
    gdouble * to)
{
  for (gsize i = 0; i < l->size; i++)
    to[i] = l->scales[i] * from[l->order[i]];
}

/* How many independent features n members' sorted ones of a class are like, by their products. */
static gdouble
find_freedom (const ClothGapLikelihood * l, guint class,
    const gdouble * members, guint n)
{
  const gsize begin = l->begin[class], count = l->begin[class + 1] - begin;
  gdouble mean = 0., square = 0.;

  for (guint m = 0; m < n; m++) {
    const gdouble *x = members + m * l->size + begin;

    mean += cloth_gap_dot (x, x, count) / n;
    for (guint k = 0; k < m; k++)
      square += pow (cloth_gap_dot (x, members + k * l->size + begin, count),
          2.);
  }
  square /= 0.5 * n * (n - 1.);
  return mean * mean < count * square ? mean * mean / square :
      mean > 0. ? (gdouble) count : 0.;
}

/* Scales and degrees of freedom of all classes. */
static void
weigh (const ClothGapStack * stack, const ClothGapDiscrepancy * d,
    ClothGapLikelihood * l)
{
  g_autofree gdouble *members = g_new (gdouble,
      stack->n_members * l->size + 1);

  l->scales = g_new (gdouble, l->size);
  l->freedoms = g_new0 (gdouble, l->n_classes);
  for (guint c = 0; c < l->n_classes; c++)
    for (gsize i = l->begin[c]; i < l->begin[c + 1]; i++)
      l->scales[i] = d->variances[c] > 0. ? 1. / sqrt (d->variances[c]) : 0.;
  for (guint m = 0; m < stack->n_members; m++)
    sort_and_scale (l, d->members + m * l->size, members + m * l->size);
  for (guint c = 0; c < l->n_classes; c++) {
    const gdouble count = (gdouble) (l->begin[c + 1] - l->begin[c]);

    l->freedoms[c] = COARSENING * find_freedom (l, c, members,
        stack->n_members);
    for (gsize i = l->begin[c]; i < l->begin[c + 1]; i++)
      l->scales[i] *= sqrt (l->freedoms[c] / count);
  }
}

/* Products of each of @n columns at @x with each of @m at @y in a class. */
static void
find_products (const ClothGapLikelihood * l, guint class, const gdouble * x,
    guint n, const gdouble * y, guint m, gdouble * products)
{
  const gsize begin = l->begin[class], count = l->begin[class + 1] - begin;

  for (guint i = 0; i < n; i++)
    for (guint k = 0; k < m; k++)
      products[i * m + k] = cloth_gap_dot (x + i * l->size + begin,
          y + k * l->size + begin, count);
}

/* K: the free numbers were fitted on the reference, and are known as well as it tells. */
static void
find_precision (const ClothGapStack * stack, const ClothGapDiscrepancy * d,
    ClothGapLikelihood * l)
{
  g_autofree gdouble *weighted = g_new (gdouble, l->size);

  l->precision = g_new0 (gdouble, l->n * l->n + 1);
  for (guint k = 0; k < l->n; k++)
    l->precision[k * l->n + k] = k < l->n_free ? stack->precisions[k] : 1.;
  for (guint k = 0; k < l->n_free && stack->reference; k++) {
    const gdouble *column = stack->reference_free + k * l->size;

    for (gsize i = 0; i < l->size; i++) {
      const gdouble variance = d->reference_variances[stack->classes[i]];

      weighted[i] = variance > 0. ?
          column[i] / (variance * stack->overdispersion) : 0.;
    }
    for (guint j = 0; j < l->n_free; j++)
      l->precision[k * l->n + j] += cloth_gap_dot (weighted,
          stack->reference_free + j * l->size, l->size);
  }
}

/* @stack: features of takes, of an ensemble, and perhaps of a reference; has to outlive the likelihood
 * @discrepancy: what they are off by if nothing acts; so has this
 * @left_out: family of members that are no nuisances, so that these can be judged;
 *   %CLOTH_GAP_ALL_FAMILIES: none is left out
 *
 * Returns: (transfer full): the likelihood of residuals
 */
ClothGapLikelihood *
cloth_gap_likelihood_new (const ClothGapStack * stack,
    const ClothGapDiscrepancy * discrepancy, guint left_out)
{
  ClothGapLikelihood *l = g_new0 (ClothGapLikelihood, 1);
  const gsize size = stack->size;
  guint n_members = 0;

  l->stack = stack;
  l->discrepancy = discrepancy;
  l->size = size;
  l->n_classes = stack->n_classes;
  l->n_free = stack->n_free;
  sort_features (stack, l);
  weigh (stack, discrepancy, l);
  for (guint m = 0; m < stack->n_members; m++)
    n_members += stack->families[m] != left_out;
  l->n = l->n_free + n_members;
  l->columns = g_new (gdouble, l->n * size + 1);
  for (guint k = 0; k < l->n_free; k++)
    sort_and_scale (l, discrepancy->free + k * size, l->columns + k * size);
  for (guint m = 0, k = l->n_free; m < stack->n_members; m++) {
    gdouble *to = l->columns + k * size;

    if (stack->families[m] == left_out)
      continue;
    sort_and_scale (l, discrepancy->members + m * size, to);
    for (gsize i = 0; i < size; i++)
      to[i] /= sqrt (n_members);
    k++;
  }
  l->products = g_new (gdouble, (gsize) l->n_classes * l->n * l->n + 1);
  for (guint c = 0; c < l->n_classes; c++)
    find_products (l, c, l->columns, l->n, l->columns, l->n,
        l->products + (gsize) c * l->n * l->n);
  find_precision (stack, discrepancy, l);
  return l;
}

/* @likelihood: (nullable) (transfer full): a likelihood
 */
void
cloth_gap_likelihood_free (ClothGapLikelihood * likelihood)
{
  if (!likelihood)
    return;
  g_free (likelihood->order);
  g_free (likelihood->begin);
  g_free (likelihood->scales);
  g_free (likelihood->freedoms);
  g_free (likelihood->columns);
  g_free (likelihood->products);
  g_free (likelihood->precision);
  g_free (likelihood);
}

/* @left: residual less what the reference says of it */
static ClothGapGram *
gram_new (const ClothGapLikelihood * l, const gdouble * left,
    const gdouble * columns, guint n)
{
  const guint m = n + 1;
  ClothGapGram *g = g_new (ClothGapGram, 1);
  g_autofree gdouble *sorted = g_new (gdouble, m * l->size + 1);

  *g = (ClothGapGram) {
  l, n, g_new (gdouble, (gsize) l->n_classes * m * m),
        g_new (gdouble, (gsize) l->n_classes * m * l->n + 1)};
  sort_and_scale (l, left, sorted);
  for (guint k = 0; k < n; k++)
    sort_and_scale (l, columns + k * l->size, sorted + (k + 1) * l->size);
  for (guint c = 0; c < l->n_classes; c++) {
    find_products (l, c, sorted, m, sorted, m, g->own + (gsize) c * m * m);
    find_products (l, c, sorted, m, l->columns, l->n,
        g->nuisances + (gsize) c * m * l->n);
  }
  return g;
}

/* @likelihood: a likelihood, which has to outlive what is returned
 * @z: (array): a residual
 * @columns: its derivatives, [n][size]
 * @n: how many
 *
 * Returns: (transfer full): what evidence of any of the columns is found from
 */
ClothGapGram *
cloth_gap_gram_new (const ClothGapLikelihood * likelihood, const gdouble * z,
    const gdouble * columns, guint n)
{
  g_autofree gdouble *left = g_new (gdouble, likelihood->size + 1);

  cloth_gap_discrepancy_take_reference_off (likelihood->discrepancy,
      likelihood->stack, z, left);
  return gram_new (likelihood, left, columns, n);
}

/* @gram: (nullable) (transfer full): products
 */
void
cloth_gap_gram_free (ClothGapGram * gram)
{
  if (!gram)
    return;
  g_free (gram->own);
  g_free (gram->nuisances);
  g_free (gram);
}

/* The least-squares problem of some columns beside the nuisances: q of a class is
 * square + 2 slopeᵀx + xᵀ curvature x. */
typedef struct
{
  guint n;                      /* nuisances, then directions */
  guint n_classes;
  gdouble *square, *slope, *curvature;
  gdouble *precision, *mean;
} Problem;

static void
problem_clear (Problem * p)
{
  g_free (p->square);
  g_free (p->slope);
  g_free (p->curvature);
  g_free (p->precision);
  g_free (p->mean);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Problem, problem_clear);

/* Of one class; what was found at @at is carried back to 0. */
static void
fill_class (const ClothGapGram * g, const guint * list, const gdouble * at,
    guint n, guint class, Problem * p)
{
  const ClothGapLikelihood *l = g->likelihood;
  const guint m = g->n + 1;
  const gdouble *own = g->own + (gsize) class * m * m;
  const gdouble *nuisances = g->nuisances + (gsize) class * m * l->n;
  gdouble *slope = p->slope + (gsize) class * p->n;
  gdouble *curvature = p->curvature + (gsize) class * p->n * p->n;

  for (guint i = 0; i < l->n; i++)
    memcpy (curvature + i * p->n, l->products + ((gsize) class * l->n +
            i) * l->n, l->n * sizeof *curvature);
  memcpy (slope, nuisances, l->n * sizeof *slope);
  p->square[class] = own[0];
  for (guint k = 0; k < n; k++) {
    const guint a = list[k] + 1;

    slope[l->n + k] = own[a];
    for (guint i = 0; i < l->n; i++)
      curvature[i * p->n + l->n + k] = curvature[(l->n + k) * p->n + i] =
          nuisances[a * l->n + i];
    for (guint j = 0; j < n; j++)
      curvature[(l->n + k) * p->n + l->n + j] = own[a * m + list[j] + 1];
  }
  for (guint k = 0; k < n; k++) {
    const gdouble *row = curvature + (l->n + k) * p->n;

    p->square[class] -= 2. * at[k] * own[list[k] + 1];
    for (guint j = 0; j < n; j++)
      p->square[class] += at[k] * at[j] * row[l->n + j];
    for (guint i = 0; i < p->n; i++)
      slope[i] -= at[k] * row[i];
  }
}

static void
problem_fill (const ClothGapGram * g, const guint * list, const gdouble * at,
    const ClothGapPrior * priors, guint n, Problem * p)
{
  const ClothGapLikelihood *l = g->likelihood;
  const guint all = l->n + n;

  *p = (Problem) {
  all, l->n_classes, g_new (gdouble, l->n_classes),
        g_new (gdouble, (gsize) l->n_classes * all + 1),
        g_new (gdouble, (gsize) l->n_classes * all * all + 1),
        g_new0 (gdouble, all * all + 1), g_new0 (gdouble, all + 1)};
  for (guint i = 0; i < l->n; i++)
    memcpy (p->precision + i * all, l->precision + i * l->n,
        l->n * sizeof (gdouble));
  for (guint k = 0; k < n; k++) {
    p->precision[(l->n + k) * all + l->n + k] =
        1. / (priors[k].prior * priors[k].prior);
    p->mean[l->n + k] = priors[k].mean;
  }
  for (guint c = 0; c < l->n_classes; c++)
    fill_class (g, list, at, n, c, p);
}

static gdouble
square_at (const Problem * p, guint class, const gdouble * x)
{
  const gdouble *slope = p->slope + (gsize) class * p->n;
  const gdouble *curvature = p->curvature + (gsize) class * p->n * p->n;
  gdouble square = p->square[class];

  for (guint i = 0; i < p->n; i++)
    square += x[i] * (2. * slope[i] + cloth_gap_dot (curvature + i * p->n, x,
            p->n));
  /* not MAX, which takes NaN for 0 */
  return square < 0. ? 0. : square;
}

/* A, and the step's right-hand side, with the weights at x. */
static void
accumulate (const Problem * p, const gdouble * freedoms, const gdouble * x,
    gdouble * a, gdouble * to)
{
  const guint n = p->n;

  memcpy (a, p->precision, n * n * sizeof *a);
  for (guint i = 0; i < n; i++)
    to[i] = cloth_gap_dot (p->precision + i * n, p->mean, n);
  for (guint c = 0; c < p->n_classes; c++) {
    const gdouble *slope = p->slope + (gsize) c * n;
    const gdouble *curvature = p->curvature + (gsize) c * n * n;
    const gdouble weight = (SIZE_FREEDOM + freedoms[c]) / (SIZE_FREEDOM +
        square_at (p, c, x));

    for (guint i = 0; i < n * n; i++)
      a[i] += weight * curvature[i];
    for (guint i = 0; i < n; i++)
      to[i] -= weight * slope[i];
  }
}

/* The mode x and the factor of A there. */
static gboolean
find_mode (const Problem * p, const gdouble * freedoms, gdouble * x,
    gdouble * factor)
{
  g_autofree gdouble *next = g_new (gdouble, p->n + 1);

  memcpy (x, p->mean, p->n * sizeof *x);
  for (guint pass = 0; pass < N_WEIGHTINGS; pass++) {
    gdouble farthest = 0.;

    accumulate (p, freedoms, x, factor, next);
    for (guint i = 0; i < p->n; i++)
      if (!isfinite (next[i]))
        return FALSE;
    if (!cloth_cholesky_factor (p->n, factor))
      return FALSE;
    cloth_cholesky_solve (p->n, factor, next);
    for (guint i = 0; i < p->n; i++)
      farthest = MAX (farthest, fabs (next[i] - x[i]) * factor[i * p->n + i]);
    memcpy (x, next, p->n * sizeof *x);
    if (farthest < CONVERGED)
      break;
  }
  return TRUE;
}

/* @x: a number
 *
 * Returns: log Φ(x), accurate far below 0 too
 */
gdouble
cloth_gap_log_normal_cdf (gdouble x)
{
  if (x > -20.)
    return log (0.5 * erfc (-x / G_SQRT2));
  return -0.5 * x * x - log (-x * sqrt (2. * G_PI));
}

/* Mean of a normal variable that is above 0. */
static gdouble
mean_above_zero (gdouble mean, gdouble sigma)
{
  const gdouble x = mean / sigma;

  return mean + sigma * exp (-0.5 * x * x - 0.5 * log (2. * G_PI) -
      cloth_gap_log_normal_cdf (x));
}

/* log det of the factor's matrix, from row @from on: of what is left when the rows before are
 * integrated out. */
static gdouble
log_determinant (const gdouble * factor, guint n, guint from)
{
  gdouble sum = 0.;

  for (guint i = from; i < n; i++)
    sum += 2. * log (factor[i * n + i]);
  return sum;
}

/* @gram: products
 * @list: (array length=n): which of its columns
 * @at: (array length=n): values of the directions where the residual was found
 * @priors: (array length=n): of the directions
 * @n: how many, at most %CLOTH_GAP_MAX_DIRECTIONS; 0: nothing but nuisances
 * @evidence: (out caller-allocates): what was found
 *
 * Returns: whether the numbers are finite
 */
gboolean
cloth_gap_gram_find_evidence (const ClothGapGram * gram, const guint * list,
    const gdouble * at, const ClothGapPrior * priors, guint n,
    ClothGapEvidence * evidence)
{
  const ClothGapLikelihood *l = gram->likelihood;
  g_auto (Problem) p = { 0 };
  g_autofree gdouble *x = NULL, *factor = NULL, *prior = NULL, *off = NULL;
  g_autofree gdouble *covariance = NULL;

  problem_fill (gram, list, at, priors, n, &p);
  x = g_new (gdouble, p.n + 1);
  off = g_new (gdouble, p.n + 1);
  factor = g_new (gdouble, p.n * p.n + 1);
  if (!find_mode (&p, l->freedoms, x, factor))
    return FALSE;
  prior = g_memdup2 (p.precision, (p.n * p.n + 1) * sizeof *prior);
  if (!cloth_cholesky_factor (p.n, prior))
    return FALSE;
  evidence->log_evidence = 0.5 * (log_determinant (prior, p.n, 0) -
      log_determinant (factor, p.n, 0));
  evidence->log_volume = 0.5 * (log_determinant (prior, p.n, l->n) -
      log_determinant (factor, p.n, l->n));
  for (guint c = 0; c < p.n_classes; c++) {
    const gdouble q = square_at (&p, c, x);

    evidence->log_evidence -= 0.5 * (SIZE_FREEDOM + l->freedoms[c]) *
        log1p (q / SIZE_FREEDOM);
  }
  for (guint i = 0; i < p.n; i++)
    off[i] = x[i] - p.mean[i];
  for (guint i = 0; i < p.n; i++)
    evidence->log_evidence -= 0.5 * off[i] * cloth_gap_dot (p.precision +
        i * p.n, off, p.n);
  covariance = g_new (gdouble, p.n * p.n + 1);
  cloth_cholesky_inverse (p.n, factor, covariance);
  for (guint k = 0; k < n; k++) {
    gdouble sigma;

    for (guint j = 0; j < n; j++)
      evidence->covariance[k * n + j] = covariance[(l->n + k) * p.n + l->n + j];
    sigma = sqrt (evidence->covariance[k * n + k]);
    evidence->modes[k] = evidence->values[k] = x[l->n + k];
    if (priors[k].one_sided) {
      const gdouble half =
          G_LN2 + cloth_gap_log_normal_cdf (x[l->n + k] / sigma);

      evidence->log_evidence += half;
      evidence->log_volume += half;
      evidence->values[k] = mean_above_zero (x[l->n + k], sigma);
    }
  }
  return isfinite (evidence->log_evidence);
}

/* @gram: products
 * @direction: one of its columns
 *
 * Returns: the Fisher information on the direction beside the nuisances where the residual is no larger
 *   than expected, without the coarsening
 */
gdouble
cloth_gap_gram_find_information (const ClothGapGram * gram, guint direction)
{
  const ClothGapLikelihood *l = gram->likelihood;
  const ClothGapPrior flat = { 1., 0., FALSE };
  const gdouble at = 0.;
  g_auto (Problem) p = { 0 };
  g_autofree gdouble *a = NULL;

  problem_fill (gram, &direction, &at, &flat, 1, &p);
  a = g_memdup2 (p.precision, (p.n * p.n + 1) * sizeof *a);
  for (guint c = 0; c < p.n_classes; c++)
    for (guint i = 0; i < p.n * p.n; i++)
      a[i] += p.curvature[(gsize) c * p.n * p.n + i];
  if (!cloth_cholesky_factor (p.n, a))
    return 0.;
  return MAX (expm1 (log_determinant (a, p.n, l->n)), 0.) / COARSENING;
}

/* @likelihood: a likelihood
 * @left: (array): a residual less what the reference says of it
 * @powers: (out) (array): mean square, class by class, of what the nuisances leave of it, in units of
 *   the variances; 0 where nothing is known of a class
 */
void
cloth_gap_likelihood_find_rest (const ClothGapLikelihood * likelihood,
    const gdouble * left, gdouble * powers)
{
  const ClothGapLikelihood *l = likelihood;
  g_autoptr (ClothGapGram) g = gram_new (l, left, NULL, 0);
  g_auto (Problem) p = { 0 };
  g_autofree gdouble *x = NULL, *factor = NULL;
  gboolean found;

  problem_fill (g, NULL, NULL, NULL, 0, &p);
  x = g_new0 (gdouble, p.n + 1);
  factor = g_new (gdouble, p.n * p.n + 1);
  found = find_mode (&p, l->freedoms, x, factor);
  for (guint c = 0; c < p.n_classes; c++)
    powers[c] = found && l->freedoms[c] > 0. ?
        square_at (&p, c, x) / l->freedoms[c] : 0.;
}

/* @likelihood: a likelihood
 * @covariance: (out) (array): of the free numbers where the residual is as expected, [n_free][n_free]
 */
void
cloth_gap_likelihood_find_free_covariance (const ClothGapLikelihood *
    likelihood, gdouble * covariance)
{
  const ClothGapLikelihood *l = likelihood;
  g_autofree gdouble *a = g_memdup2 (l->precision,
      (l->n * l->n + 1) * sizeof *a);
  g_autofree gdouble *all = g_new (gdouble, l->n * l->n + 1);

  for (guint c = 0; c < l->n_classes; c++)
    for (guint i = 0; i < l->n * l->n; i++)
      a[i] += l->products[(gsize) c * l->n * l->n + i];
  memset (covariance, 0, l->n_free * l->n_free * sizeof *covariance);
  if (!l->n || !cloth_cholesky_factor (l->n, a))
    return;
  cloth_cholesky_inverse (l->n, a, all);
  for (guint i = 0; i < l->n_free; i++)
    for (guint k = 0; k < l->n_free; k++)
      covariance[i * l->n_free + k] = all[i * l->n + k];
}
