/* Something that no effect of the library is: a field of forces, or of displacements, that nothing is
 * known of but that it is smooth: a Gaussian process over waves and blocks of time.
 *
 * Model: pₖ is the power of class k of what the explanation, the reference and the nuisances leave, in
 *   units of its variance Vₖ. If nothing is left log pₖ = u + εₖ about the mean of the members' log
 *   powers, u common to all classes, both normal with the members' variances. An unknown field of
 *   the strength a makes pₖ (1 + a wₖ): a force moves the cloth in a class as the library's forces do
 *   on average, w ∝ Σ (Bₖ)²/Vₖ; a displacement has the same power everywhere, w ∝ 1/Vₖ.
 * Formula: log BF = log of the mean over a (evenly in log a, 0.1 to 1000) of the likelihood ratio. How
 *   far it goes by chance is seen on the members, each against the others: their median is taken
 *   off, and what is above it is divided by their mean excess above it, if that is beyond 1. So an
 *   exponential tail counts as one nat for each factor e in probability.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/inference/rivals.h"

#include <math.h>
#include <string.h>

#include "gst/math/statistics.h"

/* Strengths of a field. */
#define LEAST_STRENGTH 0.1
#define N_STRENGTHS 9
#define STRENGTH_FACTOR 3.1622776601683795
/* A field is smooth: its waves are no shorter than two thirds of the cloth. Shorter ones are wrinkles,
 * which differ from run to run by more than any ensemble does. */
#define SMOOTH_BAND 3
/* Of a variance that few members show. */
#define LEAST_VARIANCE 1e-4

/* What the members leave: mean and variance of log powers less their common part, and the variance
 * of that. */
typedef struct
{
  guint n;                      /* classes that have features */
  guint *classes;
  gdouble *mean, *variance;
  gdouble common;
} Chance;

static void
chance_clear (Chance * c)
{
  g_free (c->classes);
  g_free (c->mean);
  g_free (c->variance);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Chance, chance_clear);

static gdouble
log_power (const gdouble * powers, const Chance * c, guint k)
{
  return log (MAX (powers[c->classes[k]], 1e-12));
}

/* From all members but @left_out. */
static void
find_chance (const ClothGapStack * stack, const gdouble * variances,
    const gdouble * rests, guint left_out, Chance * c)
{
  const guint n = stack->n_classes;
  gdouble count = 0.;

  *c = (Chance) {
  0, g_new (guint, n + 1), g_new0 (gdouble, n + 1), g_new0 (gdouble, n + 1)};
  for (guint k = 0; k < n; k++)
    if (variances[k] > 0. && stack->bands[k] <= SMOOTH_BAND)
      c->classes[c->n++] = k;
  for (guint m = 0; m < stack->n_members; m++)
    count += m != left_out;
  for (guint m = 0; m < stack->n_members; m++)
    for (guint k = 0; k < c->n && m != left_out; k++)
      c->mean[k] += log_power (rests + m * n, c, k) / count;
  for (guint m = 0; m < stack->n_members; m++) {
    gdouble common = 0.;

    if (m == left_out)
      continue;
    for (guint k = 0; k < c->n; k++)
      common += (log_power (rests + m * n, c, k) - c->mean[k]) / c->n;
    c->common += common * common / count;
    for (guint k = 0; k < c->n; k++)
      c->variance[k] += pow (log_power (rests + m * n, c, k) -
          c->mean[k] - common, 2.) / count;
  }
  for (guint k = 0; k < c->n; k++)
    c->variance[k] += LEAST_VARIANCE;
  c->common += LEAST_VARIANCE;
}

/* Logarithm of the density of log powers that differ from chance by @off: independent but for the
 * common part (Sherman and Morrison). */
static gdouble
log_density (const Chance * c, const gdouble * off)
{
  gdouble square = 0., sum = 0., precision = 1. / c->common;

  for (guint k = 0; k < c->n; k++) {
    square += off[k] * off[k] / c->variance[k];
    sum += off[k] / c->variance[k];
    precision += 1. / c->variance[k];
  }
  return -0.5 * (square - sum * sum / precision);
}

/* Logarithm of the Bayes factor for a field of the @shape. */
static gdouble
find_log_bayes_factor (const Chance * c, const gdouble * powers,
    const gdouble * shape)
{
  g_autofree gdouble *off = g_new (gdouble, c->n + 1);
  gdouble strength = LEAST_STRENGTH, sum = 0., none;

  for (guint k = 0; k < c->n; k++)
    off[k] = log_power (powers, c, k) - c->mean[k];
  none = log_density (c, off);
  for (guint i = 0; i < N_STRENGTHS; i++, strength *= STRENGTH_FACTOR) {
    for (guint k = 0; k < c->n; k++)
      off[k] = log_power (powers, c, k) - c->mean[k] - log1p (strength *
          shape[c->classes[k]]);
    sum += exp (MIN (log_density (c, off) - none, 500.)) / N_STRENGTHS;
  }
  return log (sum);
}

/* The same, as far as it is more than chance. */
static gdouble
calibrate (const ClothGapStack * stack, const gdouble * variances,
    const gdouble * rests, const gdouble * powers, const gdouble * shape)
{
  g_autofree gdouble *by_chance = g_new (gdouble, stack->n_members + 1);
  g_auto (Chance) all = { 0 };
  gdouble median, excess = 0.;
  guint above = 0;

  for (guint m = 0; m < stack->n_members; m++) {
    g_auto (Chance) others = { 0 };

    find_chance (stack, variances, rests, m, &others);
    by_chance[m] = find_log_bayes_factor (&others,
        rests + m * stack->n_classes, shape);
  }
  median = cloth_median (by_chance, stack->n_members);
  for (guint m = 0; m < stack->n_members; m++)
    if (by_chance[m] > median) {
      excess += by_chance[m] - median;
      above++;
    }
  find_chance (stack, variances, rests, G_MAXUINT, &all);
  return (find_log_bayes_factor (&all, powers, shape) - median) /
      MAX (1., excess / MAX (above, 1));
}

static void
normalise (const ClothGapStack * stack, gdouble * shape)
{
  gdouble sum = 0.;

  for (guint k = 0; k < stack->n_classes; k++)
    sum += shape[k] / stack->n_classes;
  for (guint k = 0; k < stack->n_classes; k++)
    shape[k] /= sum > 0. ? sum : 1.;
}

/* What the nuisances leave of each member, those of its own family not among them: so they tell what
 * a simulator does that nobody has tried yet; [n_members][n_classes]. */
static gdouble *
find_member_rests (const ClothGapStack * stack, const ClothGapDiscrepancy * d)
{
  gdouble *rests = g_new0 (gdouble, stack->n_members * stack->n_classes + 1);

  for (guint family = 0; family < 2; family++) {
    g_autoptr (ClothGapLikelihood) l = cloth_gap_likelihood_new (stack, d,
        family);

    for (guint m = 0; m < stack->n_members; m++)
      if (stack->families[m] == family)
        cloth_gap_likelihood_find_rest (l, d->members + m * stack->size,
            rests + m * stack->n_classes);
  }
  return rests;
}

/* @stack: features
 * @discrepancy: what they are off by if nothing acts
 * @is_force: (array): which directions are forces of the library
 * @powers: (array): by class, what the explanation, the reference and the nuisances leave of the
 *   residual, in units of the variances
 * @unknown: (out caller-allocates): how likely something else is
 */
void
cloth_gap_find_unknown (const ClothGapStack * stack,
    const ClothGapDiscrepancy * discrepancy, const gboolean * is_force,
    const gdouble * powers, ClothGapUnknown * unknown)
{
  const guint n = stack->n_classes;
  const gdouble *variances = discrepancy->variances;
  g_autofree gdouble *rests = find_member_rests (stack, discrepancy);
  g_autofree gdouble *column = g_new (gdouble, n + 1);
  g_autofree gdouble *force = g_new0 (gdouble, n + 1);
  g_autofree gdouble *displacement = g_new0 (gdouble, n + 1);
  g_autofree guint *counts = g_new0 (guint, n + 1);
  g_auto (Chance) chance = { 0 };
  gdouble more = 0.;

  for (guint k = 0; k < n; k++)
    if (variances[k] > 0.)
      displacement[k] = 1. / variances[k];
  for (guint i = 0; i < stack->n; i++) {
    if (!is_force[i])
      continue;
    cloth_gap_find_powers (stack, stack->columns + i * stack->size, column);
    for (guint k = 0; k < n; k++)
      column[k] /= variances[k] > 0. ? variances[k] : INFINITY;
    normalise (stack, column);
    for (guint k = 0; k < n; k++)
      force[k] += column[k];
  }
  normalise (stack, force);
  normalise (stack, displacement);
  unknown->force_field = calibrate (stack, variances, rests, powers, force);
  unknown->displacement_field =
      calibrate (stack, variances, rests, powers, displacement);
  find_chance (stack, variances, rests, G_MAXUINT, &chance);
  for (gsize i = 0; i < stack->size; i++)
    counts[stack->classes[i]]++;
  for (guint k = 0; k < chance.n; k++) {
    const guint c = chance.classes[k];

    more += counts[c] * variances[c] * MAX (powers[c] - exp (chance.mean[k]),
        0.);
  }
  unknown->power = more;
}
