/* The linear part of the diagnosis.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/estimate/normal.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"

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

  power->n = 3 * (cosine_band (features->n_cosines - 1) + 1) *
      features->n_bands;
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
  gsize i = 0;

  n->m = m;
  n->n_blocks = features->n_blocks;
  n->per_block = (gdouble) size;
  n->g = g_new0 (gdouble, (gsize) n->n_blocks * m * m);
  n->s = g_new0 (gdouble, (gsize) n->n_blocks * m);
  n->r = g_new0 (gdouble, n->n_blocks);
  for (guint c = 0; c < features->n_cosines; c++)
    for (guint w = 0; w < features->n_waves; w++)
      for (guint k = 0; k < 3; k++)
        weights[i++] =
            1. / (1. + discrepancy->values[class_of (features, c, w, k)]);
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
 * @blocks: (array): which blocks count
 * @nuisances: (array length=n_nuisances): columns that are fitted along
 * @precisions: (array length=n_nuisances): of their priors
 * @n_nuisances: how many
 * @directions: (array length=n): columns that are looked at, at most
 *   %CLOTH_EFFECT_MAX_PARAMETERS
 * @n: how many
 * @reduced: (out): what is left of them
 *
 * Projects the nuisances out: the Schur complement of the normal equations.
 *
 * Returns: whether the nuisances could be solved for
 */
gboolean
cloth_normal_equations_reduce (const ClothNormalEquations * normal,
    const gboolean * blocks, const guint * nuisances,
    const gdouble * precisions, guint n_nuisances, const guint * directions,
    guint n, ClothReducedEquations * reduced)
{
  guint m = normal->m, q = n_nuisances;
  g_autofree gdouble *a = g_new0 (gdouble, (gsize) q * q + 1);
  g_autofree gdouble *b = g_new0 (gdouble, (gsize) q * (n + 1) + 1);
  g_autofree gdouble *x = NULL;

  *reduced = (ClothReducedEquations) {
  n};
  for (guint i = 0; i < q; i++)
    a[(gsize) i * q + i] = precisions[i];
  for (guint block = 0; block < normal->n_blocks; block++) {
    const gdouble *g = normal->g + (gsize) block * m * m;
    const gdouble *s = normal->s + (gsize) block * m;

    if (!blocks[block])
      continue;
    reduced->r += normal->r[block];
    for (guint i = 0; i < q; i++) {
      for (guint j = 0; j < q; j++)
        a[(gsize) i * q + j] += g[(gsize) nuisances[i] * m + nuisances[j]];
      for (guint j = 0; j < n; j++)
        b[(gsize) j * q + i] += g[(gsize) nuisances[i] * m + directions[j]];
      b[(gsize) n * q + i] += s[nuisances[i]];
    }
    for (guint i = 0; i < n; i++) {
      for (guint j = 0; j < n; j++)
        reduced->g[i * n + j] += g[(gsize) directions[i] * m + directions[j]];
      reduced->s[i] += s[directions[i]];
    }
  }
  for (guint i = 0; i < n; i++)
    reduced->kept[i] = reduced->g[i * n + i];
  if (q) {
    if (!cloth_cholesky_factor (q, a))
      return FALSE;
    x = g_memdup2 (b, sizeof (gdouble) * q * (n + 1));
    for (guint j = 0; j <= n; j++)
      cloth_cholesky_solve (q, a, x + (gsize) j * q);
    for (guint k = 0; k < q; k++) {
      for (guint i = 0; i < n; i++) {
        for (guint j = 0; j < n; j++)
          reduced->g[i * n + j] -= b[(gsize) i * q + k] * x[(gsize) j * q + k];
        reduced->s[i] -= b[(gsize) i * q + k] * x[(gsize) n * q + k];
      }
      reduced->r -= b[(gsize) n * q + k] * x[(gsize) n * q + k];
    }
  }
  for (guint i = 0; i < n; i++)
    reduced->kept[i] = reduced->kept[i] > 0. ?
        reduced->g[i * n + i] / reduced->kept[i] : 0.;
  return TRUE;
}

/* @normal: normal equations
 * @blocks: (nullable): which blocks count
 * @m: how many of the columns are kept: the first ones
 * @precisions: (array): of the priors of the others
 * @g: (out) (array): what is left of the kept ones' normal matrix, m·m
 * @s: (out) (array length=m): and of their score
 *
 * Projects the last columns out.
 *
 * Returns: what is left of the residual's square; all of it, and @g and @s as they are,
 *   when the others can't be solved for
 */
gdouble
cloth_normal_equations_project (const ClothNormalEquations * normal,
    const gboolean * blocks, guint m, const gdouble * precisions, gdouble * g,
    gdouble * s)
{
  guint all = normal->m, q = all - m;
  g_autofree gdouble *a = g_new0 (gdouble, (gsize) q * q + 1);
  g_autofree gdouble *b = g_new0 (gdouble, (gsize) (m + 1) * q + 1);
  g_autofree gdouble *x = NULL;
  gdouble r = 0.;

  memset (g, 0, (gsize) m * m * sizeof *g);
  memset (s, 0, m * sizeof *s);
  for (guint i = 0; i < q; i++)
    a[(gsize) i * q + i] = precisions[i];
  for (guint block = 0; block < normal->n_blocks; block++) {
    const gdouble *from = normal->g + (gsize) block * all * all;
    const gdouble *score = normal->s + (gsize) block * all;

    if (blocks && !blocks[block])
      continue;
    r += normal->r[block];
    for (guint i = 0; i < m; i++) {
      s[i] += score[i];
      for (guint k = 0; k < m; k++)
        g[(gsize) i * m + k] += from[(gsize) i * all + k];
    }
    for (guint i = 0; i < q; i++) {
      b[(gsize) m * q + i] += score[m + i];
      for (guint k = 0; k < m; k++)
        b[(gsize) k * q + i] += from[(gsize) k * all + m + i];
      for (guint k = 0; k < q; k++)
        a[(gsize) i * q + k] += from[(gsize) (m + i) * all + m + k];
    }
  }
  if (!q || !cloth_cholesky_factor (q, a))
    return r;
  x = g_memdup2 (b, sizeof (gdouble) * q * (m + 1));
  for (guint k = 0; k <= m; k++)
    cloth_cholesky_solve (q, a, x + (gsize) k * q);
  for (guint i = 0; i < q; i++) {
    const gdouble last = x[(gsize) m * q + i];

    r -= b[(gsize) m * q + i] * last;
    for (guint k = 0; k < m; k++) {
      s[k] -= b[(gsize) k * q + i] * last;
      for (guint l = 0; l < m; l++)
        g[(gsize) k * m + l] -= b[(gsize) k * q + i] * x[(gsize) l * q + i];
    }
  }
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
