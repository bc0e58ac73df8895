/* All that evidence is drawn from, as arrays: the features of all takes, one behind the other.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* @size: features of all takes
 * @n_classes: classes of features: of each take bands of frequencies, of waves, and axes
 * @classes: (array length=size): which class each is of
 * @bands: (array length=n_classes): of each class its band of waves: 0 for the longest, growing
 * @n_free: free numbers of the model
 * @n: directions of effects, and behind them winds of parts of the takes
 * @n_winds: how many of these
 * @z: (array length=size): residual: simulated less recorded, noise has the variance 1
 * @free: its derivatives by the free numbers, [n_free][size]
 * @columns: its derivatives by the directions, [n][size]
 * @priors: (array length=n): standard deviations of the directions' priors
 * @precisions: (array length=n_free): of the free numbers' priors
 * @overdispersion: features are not independent: squares count this much less for free numbers
 * @n_members: members of the ensemble
 * @families: (array length=n_members): members of one family have one force model
 * @members: what the residual would be of each member, [n_members][size]
 * @reference: (nullable): of a recording that the model must agree with, at the same features of
 *   the same motion, or of another; 0 where it has none
 * @reference_free: (nullable): its derivatives by the free numbers
 * @reference_members: (nullable): of the members on it
 */
typedef struct {
  gsize size;
  guint n_classes;
  guint *classes;
  guint *bands;
  guint n_free;
  guint n;
  guint n_winds;
  gdouble *z;
  gdouble *free;
  gdouble *columns;
  gdouble *priors;
  gdouble *precisions;
  gdouble overdispersion;
  guint n_members;
  guint *families;
  gdouble *members;
  gdouble *reference;
  gdouble *reference_free;
  gdouble *reference_members;
} ClothGapStack;

static inline gdouble
cloth_gap_dot (const gdouble * a, const gdouble * b, gsize n)
{
  gdouble sum = 0.;

  for (gsize i = 0; i < n; i++)
    sum += a[i] * b[i];
  return sum;
}

G_END_DECLS
