/* How well data agree with some directions of change, and how far to go along them.
 *
 * Model: e (θ) ≈ e + J (θ − θ₀) are n numbers, independent and of variance s², if θ is right. The
 *   ensemble knows s² = 1 only so well: ν/s² ~ χ² with ν degrees of freedom. With s² integrated out
 *     log p (e | θ) = −½ (ν + n) log (1 + e (θ)ᵀe (θ)/ν) + constant.
 *   θ ~ N(m, Λ⁻¹); of one that can't be negative the half above 0 has all the probability.
 * Formulas: the most probable θ by reweighted least squares, w = (ν + n)/(ν + eᵀe),
 *     A = w JᵀJ + Λ,  θ = A⁻¹ (w Jᵀ(Jθ₀ − e) + Λm);
 *   log evidence = log p (e | θ) − ½ (θ − m)ᵀΛ(θ − m) − ½ log det (A Λ⁻¹)   (Laplace)
 *     + log 2Φ(θ/σ) of each that can't be negative, whose value is then the mean of that half.
 * References: Lange, Little and Taylor, Robust statistical modeling using the t distribution,
 *   1989 (weights); MacKay, Bayesian interpolation, 1992 (evidence).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/inference/evidence.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"

/* Reweighting converges in a few steps. */
#define N_WEIGHTINGS 20

/* @n: how many numbers
 * @square: sum of their squares
 *
 * Returns: the logarithm of their likelihood, less that of zeros
 */
gdouble
cloth_gap_log_likelihood (guint n, gdouble square)
{
  return -0.5 * (CLOTH_GAP_FREEDOM + n) * log1p (square / CLOTH_GAP_FREEDOM);
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

/* Logarithm of Φ(x), sound far below 0 too. */
static gdouble
log_normal_cdf (gdouble x)
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
      log_normal_cdf (x));
}

/* What does not change while the weights are found: JᵀJ, Jᵀ(e − Jθ₀) and the square of that. */
typedef struct
{
  guint d;
  gdouble g[CLOTH_GAP_MAX_DIRECTIONS * CLOTH_GAP_MAX_DIRECTIONS];
  gdouble s[CLOTH_GAP_MAX_DIRECTIONS];
  gdouble square;
} Sums;

static void
find_sums (guint n, const gdouble * e, const gdouble * derivatives,
    const gdouble * at, guint d, Sums * sums)
{
  g_autofree gdouble *start = g_memdup2 (e, n * sizeof *e);

  sums->d = d;
  for (guint k = 0; k < d; k++)
    for (guint i = 0; i < n; i++)
      start[i] -= derivatives[k * n + i] * at[k];
  sums->square = 0.;
  for (guint i = 0; i < n; i++)
    sums->square += start[i] * start[i];
  for (guint k = 0; k < d; k++) {
    const gdouble *column = derivatives + k * n;

    sums->s[k] = 0.;
    for (guint i = 0; i < n; i++)
      sums->s[k] += column[i] * start[i];
    for (guint j = 0; j <= k; j++) {
      gdouble sum = 0.;

      for (guint i = 0; i < n; i++)
        sum += column[i] * derivatives[j * n + i];
      sums->g[k * d + j] = sums->g[j * d + k] = sum;
    }
  }
}

static gdouble
square_at (const Sums * sums, const gdouble * values)
{
  gdouble square = sums->square;

  for (guint k = 0; k < sums->d; k++) {
    square += 2. * sums->s[k] * values[k];
    for (guint j = 0; j < sums->d; j++)
      square += sums->g[k * sums->d + j] * values[k] * values[j];
  }
  return MAX (square, 0.);
}

/* @n: how many numbers
 * @e: (array length=n): what they are where they were found
 * @derivatives: their derivatives, [n_directions][n]
 * @at: (array length=n_directions): where
 * @priors: (array length=n_directions): of the directions
 * @n_directions: how many, at most %CLOTH_GAP_MAX_DIRECTIONS; 0: nothing changes
 * @evidence: (out caller-allocates): what was found
 *
 * Returns: whether the numbers are finite
 */
gboolean
cloth_gap_evidence_find (guint n, const gdouble * e,
    const gdouble * derivatives, const gdouble * at,
    const ClothGapPrior * priors, guint n_directions,
    ClothGapEvidence * evidence)
{
  const guint d = n_directions;
  gdouble factor[CLOTH_GAP_MAX_DIRECTIONS * CLOTH_GAP_MAX_DIRECTIONS];
  gdouble weight, last = 0.;
  Sums sums;

  find_sums (n, e, derivatives, at, d, &sums);
  weight = (CLOTH_GAP_FREEDOM + n) / (CLOTH_GAP_FREEDOM + sums.square);
  memcpy (evidence->values, at, d * sizeof *at);
  if (!isfinite (sums.square))
    return FALSE;
  for (guint pass = 0; pass < N_WEIGHTINGS && d; pass++) {
    gdouble *values = evidence->values;

    for (guint k = 0; k < d; k++) {
      const gdouble precision = 1. / (priors[k].prior * priors[k].prior);

      for (guint j = 0; j < d; j++)
        factor[k * d + j] = weight * sums.g[k * d + j] +
            (k == j ? precision : 0.);
      values[k] = precision * priors[k].mean - weight * sums.s[k];
    }
    if (!cloth_cholesky_factor (d, factor))
      return FALSE;
    cloth_cholesky_solve (d, factor, values);
    last = weight;
    weight = (CLOTH_GAP_FREEDOM + n) / (CLOTH_GAP_FREEDOM +
        square_at (&sums, values));
    if (fabs (weight - last) < 1e-6 * last)
      break;
  }
  evidence->log_evidence = cloth_gap_log_likelihood (n, square_at (&sums,
          evidence->values)) + cloth_gap_log_prior (priors, evidence->values,
      d);
  evidence->log_volume = 0.;
  if (d)
    cloth_cholesky_inverse (d, factor, evidence->covariance);
  for (guint k = 0; k < d; k++)
    evidence->log_volume -= log (factor[k * d + k] * priors[k].prior);
  for (guint k = 0; k < d; k++) {
    const gdouble sigma = sqrt (evidence->covariance[k * d + k]);

    if (!priors[k].one_sided)
      continue;
    evidence->log_volume += G_LN2 + log_normal_cdf (evidence->values[k] /
        sigma);
    evidence->values[k] = mean_above_zero (evidence->values[k], sigma);
  }
  evidence->log_evidence += evidence->log_volume;
  return isfinite (evidence->log_evidence);
}
