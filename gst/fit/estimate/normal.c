/* The normal equations of a linearised residual, block by block of time.
 *
 * Model: features of the residual z = −B θ − N ν + ε, where B are derivatives with respect to
 *   what is looked at and N with respect to nuisances that are fitted along.
 * Assumption: features are independent and Gaussian. Their variance is that of noise, 1, plus
 *   that of the simulator's own error, its discrepancy, which is the same within a class of
 *   features: a band of frequencies, a band of wave lengths and an axis. So
 *   W = diag (1 / (1 + discrepancy)). Nuisances have the prior precision Λ.
 * Formula: with the nuisances projected out (Schur complement; Frisch and Waugh)
 *     g = Bᵀ P B,  s = Bᵀ P z,  r = zᵀ P z,  P = W − W N (NᵀWN + Λ)⁻¹ NᵀW.
 * Reference: Kennedy and O'Hagan, Bayesian calibration of computer models, 2001 (discrepancy);
 *   Frisch and Waugh, Econometrica 1, 1933 (projection).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/estimate/normal.h"

#include <math.h>
#include <string.h>

#include "gst/fit/estimate/posterior.h"

/* Bands of cosines: 0, 1, 2, 3–4, 5–8 … */
static guint
cosine_band (guint c)
{
  guint band = MIN (c, 2);

  for (guint edge = 3; c >= edge; edge = 2 * edge - 1)
    band++;
  return band;
}

static guint
class_of (const ClothFeatures * f, guint cosine, guint wave, guint k)
{
  return 3 * (cosine_band (cosine) * f->n_bands + f->bands[wave]) + k;
}

static guint
count_classes (const ClothFeatures * f)
{
  return 3 * (cosine_band (f->n_cosines - 1) + 1) * f->n_bands;
}

/* @features: features
 * @n_classes: (out): how many classes there are
 *
 * Returns: (transfer full) (array): which class each feature is of
 */
guint *
cloth_features_list_classes (const ClothFeatures * features, guint * n_classes)
{
  guint *classes = g_new (guint, features->size), *to = classes;

  for (guint b = 0; b < features->n_blocks; b++)
    for (guint c = 0; c < features->n_cosines; c++)
      for (guint w = 0; w < features->n_waves; w++)
        for (guint k = 0; k < 3; k++)
          *to++ = class_of (features, c, w, k);
  *n_classes = count_classes (features);
  return classes;
}

/* @features: what @z is of
 * @z: features
 *
 * Returns: (transfer full): their mean squares, class by class
 */
ClothPowerSpectrum *
cloth_power_spectrum_new (const ClothFeatures * features, const gdouble * z)
{
  ClothPowerSpectrum *power = g_new0 (ClothPowerSpectrum, 1);
  g_autofree guint *counts = NULL;

  power->n = count_classes (features);
  power->values = g_new0 (gdouble, power->n);
  counts = g_new0 (guint, power->n);
  for (guint b = 0; b < features->n_blocks; b++)
    for (guint c = 0; c < features->n_cosines; c++)
      for (guint w = 0; w < features->n_waves; w++)
        for (guint k = 0; k < 3; k++, z++) {
          guint class = class_of (features, c, w, k);

          power->values[class] += *z * *z;
          counts[class]++;
        }
  for (guint i = 0; i < power->n; i++)
    if (counts[i])
      power->values[i] /= counts[i];
  return power;
}

/* @power: mean squares
 *
 * Returns: (transfer full): the same
 */
ClothPowerSpectrum *
cloth_power_spectrum_copy (const ClothPowerSpectrum * power)
{
  ClothPowerSpectrum *copy = g_memdup2 (power, sizeof *power);

  copy->values = g_memdup2 (power->values, power->n * sizeof (gdouble));
  return copy;
}

/* @power: variance beside that of noise, class by class
 * @features: features
 * @weights: (out) (array): 1 / (1 + @power) of each feature of a block
 */
void
cloth_power_spectrum_get_weights (const ClothPowerSpectrum * power,
    const ClothFeatures * features, gdouble * weights)
{
  for (guint c = 0; c < features->n_cosines; c++)
    for (guint w = 0; w < features->n_waves; w++)
      for (guint k = 0; k < 3; k++)
        *weights++ = 1. / (1. + power->values[class_of (features, c, w, k)]);
}

/* @power: (nullable) (transfer full): mean squares
 */
void
cloth_power_spectrum_free (ClothPowerSpectrum * power)
{
  if (!power)
    return;
  g_free (power->values);
  g_free (power);
}

/* @features: what @z and @columns are of
 * @discrepancy: variance of the simulator's own error, class by class
 * @z: features of the residual
 * @columns: [m][features], their derivatives
 * @m: how many
 *
 * Weights are 1 / (1 + discrepancy): noise has the variance 1.
 *
 * Returns: (transfer full): the normal equations of each block
 */
ClothNormalEquations *
cloth_normal_equations_new (const ClothFeatures * features,
    const ClothPowerSpectrum * discrepancy, const gdouble * z,
    const gdouble * columns, guint m)
{
  ClothNormalEquations *n = g_new0 (ClothNormalEquations, 1);
  gsize size = features->size / features->n_blocks;
  g_autofree gdouble *weighted = g_new (gdouble, size);
  g_autofree gdouble *weights = g_new (gdouble, size);
  gsize i;

  n->m = m;
  n->n_blocks = features->n_blocks;
  n->per_block = (gdouble) size;
  n->g = g_new0 (gdouble, (gsize) n->n_blocks * m * m);
  n->s = g_new0 (gdouble, (gsize) n->n_blocks * m);
  n->r = g_new0 (gdouble, n->n_blocks);
  cloth_power_spectrum_get_weights (discrepancy, features, weights);
  for (guint b = 0; b < n->n_blocks; b++) {
    const gdouble *zb = z + b * size;

    for (i = 0; i < size; i++)
      n->r[b] += weights[i] * zb[i] * zb[i];
    for (guint p = 0; p < m; p++) {
      const gdouble *cp = columns + p * features->size + b * size;

      for (i = 0; i < size; i++)
        weighted[i] = weights[i] * cp[i];
      for (i = 0; i < size; i++)
        n->s[(gsize) b * m + p] += weighted[i] * zb[i];
      for (guint q = 0; q <= p; q++) {
        const gdouble *cq = columns + q * features->size + b * size;
        gdouble sum = 0.;

        for (i = 0; i < size; i++)
          sum += weighted[i] * cq[i];
        n->g[((gsize) b * m + p) * m + q] = sum;
        n->g[((gsize) b * m + q) * m + p] = sum;
      }
    }
  }
  return n;
}

/* @normal: (nullable) (transfer full): normal equations
 */
void
cloth_normal_equations_free (ClothNormalEquations * normal)
{
  if (!normal)
    return;
  g_free (normal->g);
  g_free (normal->s);
  g_free (normal->r);
  g_free (normal);
}

/* @to: (nullable) (transfer full): normal equations
 * @from: (transfer full): others with the same columns
 *
 * Returns: (transfer full): the blocks of both, those of @to first
 */
ClothNormalEquations *
cloth_normal_equations_append (ClothNormalEquations * to,
    ClothNormalEquations * from)
{
  gsize square = (gsize) from->m * from->m;

  if (!to)
    return from;
  to->g = g_renew (gdouble, to->g, (to->n_blocks + from->n_blocks) * square);
  to->s = g_renew (gdouble, to->s, (to->n_blocks + from->n_blocks) * from->m);
  to->r = g_renew (gdouble, to->r, to->n_blocks + from->n_blocks);
  memcpy (to->g + to->n_blocks * square, from->g,
      from->n_blocks * square * sizeof (gdouble));
  memcpy (to->s + (gsize) to->n_blocks * from->m, from->s,
      (gsize) from->n_blocks * from->m * sizeof (gdouble));
  memcpy (to->r + to->n_blocks, from->r, from->n_blocks * sizeof (gdouble));
  to->n_blocks += from->n_blocks;
  cloth_normal_equations_free (from);
  return to;
}

/* @normal: normal equations
 * @blocks: (nullable): which blocks count
 * @columns: (array length=n): columns
 * @n: how many
 * @g: (out) (array): BᵀWB of these columns, n·n
 * @s: (out) (array length=n): BᵀWz
 *
 * Returns: zᵀWz
 */
gdouble
cloth_normal_equations_sum (const ClothNormalEquations * normal,
    const gboolean * blocks, const guint * columns, guint n, gdouble * g,
    gdouble * s)
{
  const guint m = normal->m;
  gdouble r = 0.;

  memset (g, 0, (gsize) n * n * sizeof *g);
  memset (s, 0, n * sizeof *s);
  for (guint block = 0; block < normal->n_blocks; block++) {
    const gdouble *from = m ? normal->g + (gsize) block * m * m : NULL;

    if (blocks && !blocks[block])
      continue;
    r += normal->r[block];
    for (guint i = 0; i < n; i++) {
      for (guint j = 0; j < n; j++)
        g[(gsize) i * n + j] += from[(gsize) columns[i] * m + columns[j]];
      s[i] += normal->s[(gsize) block * m + columns[i]];
    }
  }
  return r;
}

/* Sums @g, @s and @r of the directions over the blocks that count (all, if @blocks is NULL) and
 * projects the nuisances out of them. Returns whether these could be solved for; if not, the
 * sums are there as they are. @kept: (nullable): as #ClothReducedEquations has it. */
static gboolean
sum_and_project (const ClothNormalEquations * normal, const gboolean * blocks,
    const guint * nuisances, const gdouble * precisions, guint n_nuisances,
    const guint * directions, guint n, gdouble * g, gdouble * s, gdouble * r,
    gdouble * kept)
{
  const guint m = normal->m, q = n_nuisances;
  g_auto (ClothPosterior) posterior = { 0 };
  g_autofree gdouble *b = g_new0 (gdouble, (gsize) q * (n + 1) + 1);
  g_autofree gdouble *x = NULL;

  *r = cloth_normal_equations_sum (normal, blocks, directions, n, g, s);
  cloth_posterior_init (&posterior, q);
  cloth_posterior_add_prior (&posterior, precisions, NULL);
  for (guint block = 0; block < normal->n_blocks; block++) {
    const gdouble *from = m ? normal->g + (gsize) block * m * m : NULL;
    const gdouble *score = m ? normal->s + (gsize) block * m : NULL;

    if (blocks && !blocks[block])
      continue;
    for (guint i = 0; i < q; i++) {
      const gdouble *row = from + (gsize) nuisances[i] * m;

      for (guint j = 0; j < q; j++)
        posterior.precision[(gsize) i * q + j] += row[nuisances[j]];
      for (guint j = 0; j < n; j++)
        b[(gsize) j * q + i] += row[directions[j]];
      b[(gsize) n * q + i] += score[nuisances[i]];
    }
  }
  for (guint i = 0; kept && i < n; i++)
    kept[i] = g[(gsize) i * n + i];
  if (!cloth_posterior_solve (&posterior))
    return FALSE;
  x = g_memdup2 (b, sizeof (gdouble) * q * (n + 1) + sizeof (gdouble));
  for (guint j = 0; j <= n; j++)
    cloth_posterior_apply (&posterior, x + (gsize) j * q);
  for (guint k = 0; k < q; k++) {
    const gdouble last = x[(gsize) n * q + k];

    for (guint i = 0; i < n; i++) {
      const gdouble across = b[(gsize) i * q + k];

      for (guint j = 0; j < n; j++)
        g[(gsize) i * n + j] -= across * x[(gsize) j * q + k];
      s[i] -= across * last;
    }
    *r -= b[(gsize) n * q + k] * last;
  }
  for (guint i = 0; kept && i < n; i++)
    kept[i] = kept[i] > 0. ? g[(gsize) i * n + i] / kept[i] : 0.;
  return TRUE;
}

/* @normal: normal equations
 * @blocks: (nullable): which blocks count
 * @nuisances: (array length=n_nuisances): columns that are fitted along
 * @precisions: (array length=n_nuisances): of their priors
 * @n_nuisances: how many
 * @directions: (array length=n): columns that are looked at
 * @n: how many, at most CLOTH_EFFECT_MAX_PARAMETERS
 * @reduced: (out): what remains of them once the nuisances are projected out
 *
 * Returns: whether the nuisances could be solved for
 */
gboolean
cloth_normal_equations_reduce (const ClothNormalEquations * normal,
    const gboolean * blocks, const guint * nuisances,
    const gdouble * precisions, guint n_nuisances, const guint * directions,
    guint n, ClothReducedEquations * reduced)
{
  reduced->n = n;
  return sum_and_project (normal, blocks, nuisances, precisions, n_nuisances,
      directions, n, reduced->g, reduced->s, &reduced->r, reduced->kept);
}

/* @normal: normal equations
 * @blocks: (nullable): which blocks count
 * @m: how many of the columns are kept: the first ones
 * @precisions: (array): of the priors of the others
 * @g: (out) (array): the kept ones' normal matrix with the others projected out, m·m
 * @s: (out) (array length=m): and their score
 *
 * Projects the last columns out.
 *
 * Returns: zᵀWz with the others fitted; without, and @g and @s of the kept ones as they are,
 *   when the others can't be solved for
 */
gdouble
cloth_normal_equations_project (const ClothNormalEquations * normal,
    const gboolean * blocks, guint m, const gdouble * precisions, gdouble * g,
    gdouble * s)
{
  g_autofree guint *columns = g_new (guint, normal->m + 1);
  gdouble r;

  for (guint i = 0; i < normal->m; i++)
    columns[i] = i;
  sum_and_project (normal, blocks, columns + m, precisions, normal->m - m,
      columns, m, g, s, &r, NULL);
  return r;
}

/* @normal: normal equations
 * @block: a block
 * @directions: (array length=n): columns
 * @changes: (array length=n): how far along each
 * @n: how many
 *
 * Returns: by how much the square of the residual in this block changes
 */
gdouble
cloth_normal_equations_change (const ClothNormalEquations * normal, guint block,
    const guint * directions, const gdouble * changes, guint n)
{
  guint m = normal->m;
  const gdouble *g = normal->g + (gsize) block * m * m;
  const gdouble *s = normal->s + (gsize) block * m;
  gdouble change = 0.;

  for (guint i = 0; i < n; i++) {
    change += 2. * s[directions[i]] * changes[i];
    for (guint j = 0; j < n; j++)
      change += g[(gsize) directions[i] * m + directions[j]] * changes[i] *
          changes[j];
  }
  return change;
}
