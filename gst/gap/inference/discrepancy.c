/* What a simulator is off by although nothing acts that it lacks, from an ensemble of simulators and
 * from a reference: a recording that the model must agree with, a baseline or a twin.
 *
 * Model: features of the residual without any effect are z = β y + d. y is the reference's residual,
 *   d ~ N(0, V), and V is the same within a class of features.
 * Formulas, with Z the members' features on the take and Y those on the reference:
 *   the model's free numbers were fitted on the reference, so each member's are, to first order:
 *     δ = −(FᵀWF/φ + Λ)⁻¹ FᵀWY/φ,  Y ← Y + F δ,  Z ← Z + F_take δ
 *   β = Σ ZY / Σ Y²,  V = mean of (Z − βY)² + (r/5)²,  class by class;
 *   r: what the effects change at which the take is linearised. Their laws hold to a fifth.
 * A reference of the same motion has β near 1 and tells all; another motion says little. That a cloth
 * may be further off than the members are is in the likelihood (likelihood.c).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/inference/discrepancy.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"

/* @stack: features
 * @z: (array): a residual
 * @powers: (out) (array): its mean square in each class
 */
void
cloth_gap_find_powers (const ClothGapStack * stack, const gdouble * z,
    gdouble * powers)
{
  g_autofree guint *counts = g_new0 (guint, stack->n_classes);

  memset (powers, 0, stack->n_classes * sizeof *powers);
  for (gsize i = 0; i < stack->size; i++) {
    powers[stack->classes[i]] += z[i] * z[i];
    counts[stack->classes[i]]++;
  }
  for (guint c = 0; c < stack->n_classes; c++)
    powers[c] /= MAX (counts[c], 1);
}

/* @stack: features
 * @members: (array): of the members, [n_members][size]
 * @mean: (out) (array): mean over them of cloth_gap_find_powers (), [n_classes]
 */
void
cloth_gap_find_mean_powers (const ClothGapStack * stack,
    const gdouble * members, gdouble * mean)
{
  g_autofree gdouble *powers = g_new (gdouble, stack->n_classes);

  memset (mean, 0, stack->n_classes * sizeof *mean);
  for (guint m = 0; m < stack->n_members; m++) {
    cloth_gap_find_powers (stack, members + m * stack->size, powers);
    for (guint c = 0; c < stack->n_classes; c++)
      mean[c] += powers[c] / stack->n_members;
  }
}

static void
add (gdouble * to, const gdouble * columns, const gdouble * changes, guint n,
    gsize size)
{
  for (guint k = 0; k < n; k++)
    for (gsize i = 0; i < size; i++)
      to[i] += changes[k] * columns[k * size + i];
}

/* Each member's free numbers as the reference would have had them fitted. */
static void
refit_members (const ClothGapStack * stack, gdouble * members,
    gdouble * on_reference)
{
  const guint n = stack->n_free;
  const gsize size = stack->size;
  g_autofree gdouble *powers = g_new (gdouble, stack->n_classes);
  g_autofree gdouble *weighted = g_new (gdouble, n * size + 1);
  g_autofree gdouble *factor = g_new0 (gdouble, n * n + 1);
  g_autofree gdouble *changes = g_new (gdouble, n + 1);

  cloth_gap_find_mean_powers (stack, on_reference, powers);
  for (guint k = 0; k < n; k++)
    for (gsize i = 0; i < size; i++)
      weighted[k * size + i] = powers[stack->classes[i]] > 0. ?
          stack->reference_free[k * size + i] /
          (powers[stack->classes[i]] * stack->overdispersion) : 0.;
  for (guint i = 0; i < n; i++)
    for (guint k = 0; k < n; k++)
      factor[i * n + k] = cloth_gap_dot (weighted + i * size,
          stack->reference_free + k * size, size) +
          (i == k ? stack->precisions[i] : 0.);
  if (!n || !cloth_cholesky_factor (n, factor))
    return;
  for (guint m = 0; m < stack->n_members; m++) {
    for (guint k = 0; k < n; k++)
      changes[k] = -cloth_gap_dot (weighted + k * size,
          on_reference + m * size, size);
    cloth_cholesky_solve (n, factor, changes);
    add (on_reference + m * size, stack->reference_free, changes, n, size);
    add (members + m * size, stack->free, changes, n, size);
  }
}

/* β of each class. */
static void
find_slopes (const ClothGapStack * stack, const gdouble * members,
    const gdouble * on_reference, gdouble * slopes)
{
  g_autofree gdouble *squares = g_new0 (gdouble, stack->n_classes);

  memset (slopes, 0, stack->n_classes * sizeof *slopes);
  for (guint m = 0; m < stack->n_members; m++)
    for (gsize i = 0; i < stack->size; i++) {
      const gdouble y = on_reference[m * stack->size + i];

      slopes[stack->classes[i]] += members[m * stack->size + i] * y;
      squares[stack->classes[i]] += y * y;
    }
  for (guint c = 0; c < stack->n_classes; c++)
    slopes[c] = squares[c] > 0. ? slopes[c] / squares[c] : 0.;
}

static void
take_reference_off (const ClothGapStack * stack, ClothGapDiscrepancy * d)
{
  const gsize size = stack->size;
  gdouble before = 0., after = 0.;

  d->on_reference = g_memdup2 (stack->reference_members,
      stack->n_members * size * sizeof (gdouble));
  refit_members (stack, d->members, d->on_reference);
  find_slopes (stack, d->members, d->on_reference, d->slopes);
  for (guint m = 0; m < stack->n_members; m++)
    for (gsize i = 0; i < size; i++) {
      gdouble *z = &d->members[m * size + i];

      before += *z * *z;
      *z -= d->slopes[stack->classes[i]] * d->on_reference[m * size + i];
      after += *z * *z;
    }
  d->shared = before > 0. ? 1. - after / before : 0.;
  for (guint k = 0; k < stack->n_free; k++)
    for (gsize i = 0; i < size; i++)
      d->free[k * size + i] -= d->slopes[stack->classes[i]] *
          stack->reference_free[k * size + i];
  d->reference_variances = g_new (gdouble, stack->n_classes);
  cloth_gap_find_mean_powers (stack, d->on_reference, d->reference_variances);
}

/* @stack: features of takes, of an ensemble, and perhaps of a reference
 * @response: (nullable) (array): what the effects change at which it is linearised; %NULL: none
 *
 * Returns: (transfer full): what the residual would be without any effect
 */
ClothGapDiscrepancy *
cloth_gap_discrepancy_new (const ClothGapStack * stack,
    const gdouble * response)
{
  ClothGapDiscrepancy *d = g_new0 (ClothGapDiscrepancy, 1);
  g_autofree gdouble *powers = g_new (gdouble, stack->n_classes);

  d->slopes = g_new0 (gdouble, stack->n_classes);
  d->free = g_memdup2 (stack->free,
      stack->n_free * stack->size * sizeof (gdouble) + 1);
  d->members = g_memdup2 (stack->members,
      stack->n_members * stack->size * sizeof (gdouble));
  d->variances = g_new (gdouble, stack->n_classes);
  if (stack->reference)
    take_reference_off (stack, d);
  cloth_gap_find_mean_powers (stack, d->members, d->variances);
  if (response) {
    cloth_gap_find_powers (stack, response, powers);
    for (guint c = 0; c < stack->n_classes; c++)
      d->variances[c] += CLOTH_GAP_LAW_ERROR * CLOTH_GAP_LAW_ERROR * powers[c];
  }
  return d;
}

/* @discrepancy: a discrepancy
 * @stack: what it was made of
 * @z: (array): a residual
 * @left: (out) (array): z − βy
 */
void
cloth_gap_discrepancy_take_reference_off (const ClothGapDiscrepancy *
    discrepancy, const ClothGapStack * stack, const gdouble * z, gdouble * left)
{
  for (gsize i = 0; i < stack->size; i++)
    left[i] = z[i] - (stack->reference ?
        discrepancy->slopes[stack->classes[i]] * stack->reference[i] : 0.);
}

/* @discrepancy: (nullable) (transfer full): a discrepancy
 */
void
cloth_gap_discrepancy_free (ClothGapDiscrepancy * discrepancy)
{
  if (!discrepancy)
    return;
  g_free (discrepancy->slopes);
  g_free (discrepancy->free);
  g_free (discrepancy->members);
  g_free (discrepancy->variances);
  g_free (discrepancy->on_reference);
  g_free (discrepancy->reference_variances);
  g_free (discrepancy);
}
