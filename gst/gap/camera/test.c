/* What is tested, with the nuisances projected out.
 *
 * Model: whitened features z = −B dη − N dν + noise, with derivatives B by the directions that
 * are looked at and N by the nuisances, whose prior precision is Λ. With φ₀ the overdispersion,
 * as features are not independent, Rao's score test (1948) of dη = 0 needs
 *   g = Bᵀ P B,  s = Bᵀ P z,  r = zᵀ P z,  P = I − N (NᵀN + φ₀ Λ)⁻¹ Nᵀ.
 * The variance of the noise is estimated from what is left:
 *   φ = φ₀ · max (r / number of features, 0.1).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/camera/test.h"

/* Features never count as less noisy than this share of what is expected of them. */
#define LEAST_DISPERSION 0.1

static gdouble
count_features (const ClothGapTest * test, const ClothNormalEquations * normal)
{
  gdouble count = 0.;

  for (guint b = 0; b < normal->n_blocks; b++)
    count += test->blocks[b] ? normal->per_block : 0.;
  return count;
}

/* @overdispersion: φ₀
 * @r: sum of the squares of what is left
 * @n_features: of how many features
 *
 * Returns: how much more than the noise a square of the residual counts
 */
gdouble
cloth_gap_dispersion (gdouble overdispersion, gdouble r, gdouble n_features)
{
  return overdispersion * MAX (r / n_features, LEAST_DISPERSION);
}

/* @test: what is tested
 * @normal: normal equations
 * @reduced: what is left of them
 *
 * Returns: how much more than the noise a square of the residual counts
 */
gdouble
cloth_gap_test_dispersion (const ClothGapTest * test,
    const ClothNormalEquations * normal, const ClothReducedEquations * reduced)
{
  return cloth_gap_dispersion (test->overdispersion, reduced->r,
      count_features (test, normal));
}

/* @test: what is tested
 * @normal: normal equations whose nuisances are those of the test
 * @blocks: (array): which blocks count
 * @directions: (array length=n): columns that are looked at, at most
 *   %CLOTH_EFFECT_MAX_PARAMETERS
 * @n: how many
 * @reduced: (out): what is left of them once the nuisances are projected out
 *
 * Returns: whether the nuisances could be solved for
 */
gboolean
cloth_gap_test_reduce (const ClothGapTest * test,
    const ClothNormalEquations * normal, const gboolean * blocks,
    const guint * directions, guint n, ClothReducedEquations * reduced)
{
  g_autofree gdouble *precisions = g_new (gdouble, test->n_nuisances + 1);

  /* the equations are not divided by the noise yet */
  for (guint i = 0; i < test->n_nuisances; i++)
    precisions[i] = test->precisions[i] * test->overdispersion;
  return cloth_normal_equations_reduce (normal, blocks, test->nuisances,
      precisions, test->n_nuisances, directions, n, reduced);
}
