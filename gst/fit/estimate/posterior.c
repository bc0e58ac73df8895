/* The posterior of a linear Gaussian model: the one place where a prior and normal equations
 * become an estimate with its covariance.
 *
 * Model: the residual is z + B θ = ε with noise ε ~ N(0, φ W⁻¹). So z is what is there at
 *   θ = 0, and θ what would take it away.
 * Assumption: the prior θ ~ N(m, Λ⁻¹) is Gaussian with a diagonal Λ, the derivatives B hold
 *   as far as the posterior reaches, and φ is known.
 * Formula: with G = BᵀWB and s = BᵀWz
 *     A = G/φ + Λ,   b = Λm − s/φ,   θ | z ~ N(A⁻¹b, A⁻¹).
 *   With A = LLᵀ, log |A| = 2 Σ log Lᵢᵢ. The log Bayes factor of the model against θ = m = 0 is
 *     ½ bᵀA⁻¹b − ½ (log |A| − log |Λ|).
 * Reference: Bishop, Pattern Recognition and Machine Learning, 2006, sections 3.3 and 3.4.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/estimate/posterior.h"

#include <math.h>

#include "gst/math/linalg.h"

/* @posterior: (out caller-allocates): nothing is known yet
 * @n: number of unknowns
 */
void
cloth_posterior_init (ClothPosterior * posterior, guint n)
{
  posterior->n = n;
  posterior->precision = g_new0 (gdouble, (gsize) n * n + 1);
  posterior->mean = g_new0 (gdouble, n + 1);
}

/* @posterior: a posterior that is not solved yet
 * @g: BᵀWB, n·n
 * @s: (array): BᵀWz
 * @phi: variance of the noise in units of W⁻¹
 *
 * Adds data that are independent of those before.
 */
void
cloth_posterior_add_data (ClothPosterior * posterior, const gdouble * g,
    const gdouble * s, gdouble phi)
{
  for (gsize i = 0; i < (gsize) posterior->n * posterior->n; i++)
    posterior->precision[i] += g[i] / phi;
  for (guint i = 0; i < posterior->n; i++)
    posterior->mean[i] -= s[i] / phi;
}

/* @posterior: a posterior that is not solved yet
 * @precisions: (array): diagonal of Λ
 * @means: (nullable) (array): of the prior; %NULL: 0
 */
void
cloth_posterior_add_prior (ClothPosterior * posterior,
    const gdouble * precisions, const gdouble * means)
{
  for (guint i = 0; i < posterior->n; i++) {
    posterior->precision[(gsize) i * posterior->n + i] += precisions[i];
    if (means)
      posterior->mean[i] += precisions[i] * means[i];
  }
}

/* @posterior: a posterior with all its data and its prior
 *
 * Returns: whether its precision is positive definite; only then anything else may be asked
 */
gboolean
cloth_posterior_solve (ClothPosterior * posterior)
{
  if (!cloth_cholesky_factor (posterior->n, posterior->precision))
    return FALSE;
  cloth_cholesky_solve (posterior->n, posterior->precision, posterior->mean);
  return TRUE;
}

/* @posterior: a posterior that is solved
 * @x: (inout) (array): a vector; becomes A⁻¹x
 */
void
cloth_posterior_apply (const ClothPosterior * posterior, gdouble * x)
{
  cloth_cholesky_solve (posterior->n, posterior->precision, x);
}

/* @posterior: a posterior that is solved
 *
 * Returns: logarithm of the determinant of its precision
 */
gdouble
cloth_posterior_log_determinant (const ClothPosterior * posterior)
{
  gdouble sum = 0.;

  for (guint i = 0; i < posterior->n; i++)
    sum += 2. * log (posterior->precision[(gsize) i * posterior->n + i]);
  return sum;
}

/* @posterior: a posterior that is solved
 * @covariance: (out) (array): A⁻¹, n·n
 */
void
cloth_posterior_covariance (const ClothPosterior * posterior,
    gdouble * covariance)
{
  cloth_cholesky_inverse (posterior->n, posterior->precision, covariance);
}

/* @posterior: a posterior; gives its memory back
 */
void
cloth_posterior_clear (ClothPosterior * posterior)
{
  g_clear_pointer (&posterior->precision, g_free);
  g_clear_pointer (&posterior->mean, g_free);
}
