/* The Gauss–Newton fit of numbers whose residual is dear, and whose derivatives are known about
 * only, as those of another simulator.
 *
 * Model: residual z (x) of variance 1.
 * Assumption: the derivatives B at the start are about right; the prior is x ~ N(x₀, Λ⁻¹).
 * Formula: each step goes from the best place to the mean of the posterior of the linearised model,
 *     δ = (BᵀB + Λ)⁻¹ (−Bᵀz − Λ (x − x₀)).
 *   It must lower zᵀz + (x − x₀)ᵀ Λ (x − x₀); when it does not, or leads to where there is no
 *   residual, the next one is shorter. Either way the derivatives are mended, so that they say what
 *   the step did (Broyden's update):
 *     B ← B + (z (x + δ) − z (x) − B δ) δᵀ/δᵀδ.
 *   In units in which unknowns are about equally sure, this is the least change that does.
 *   How far from the start the best place is, is known worst: effects saturate, and rough residuals
 *   end short steps early. So it is searched at last along the ray from the start: longer by a
 *   share, or shorter, as long as that helps, then where the parabola through the last three has
 *   its least value.
 * Reference: Broyden, Math. Comp. 19, 1965; Nocedal and Wright, Numerical Optimization, 2006,
 *   chapter 4 and section 11.1.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/estimate/broyden.h"

#include <math.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/fit/estimate/posterior.h"

/* A fit ends when a step gains less than this share, as gauss-newton.c does. */
#define LEAST_GAIN 4e-3
/* After a step that made things worse the next one is no longer than this share of it. */
#define CUT 0.4
/* Along the ray from the start places are this many times as far from it, each. */
#define STRETCH 1.25

typedef struct
{
  ClothBroydenResidual residual;
  gpointer data;
  const ClothBroydenOptions *options;
  gdouble *start;
  gdouble *x, *z;               /* the best so far */
  gdouble *columns;
  gdouble *step, *there;        /* from it, and the residual where it leads */
  gdouble cost;                 /* of the best */
  guint n_calls;
} Fit;

static gdouble
find_cost (const Fit * fit, const gdouble * step, const gdouble * z)
{
  gdouble cost = 0.;

  for (gsize k = 0; k < fit->options->size; k++)
    cost += z[k] * z[k];
  for (guint i = 0; i < fit->options->n; i++)
    cost += fit->options->precisions[i] * pow (fit->x[i] + step[i] -
        fit->start[i], 2.);
  return cost;
}

/* From the best place to where the derivatives and the prior say it should be, within bounds and no
 * further than @longest; FALSE when that is where it is already. */
static gboolean
find_step (const Fit * fit, gdouble longest)
{
  const ClothBroydenOptions *o = fit->options;
  const gsize size = o->size;
  g_autofree gdouble *g = g_new0 (gdouble, (gsize) o->n * o->n + 1);
  g_autofree gdouble *s = g_new0 (gdouble, o->n + 1);
  g_autofree gdouble *back = g_new (gdouble, o->n + 1);
  g_auto (ClothPosterior) posterior = { 0 };
  gdouble largest = 0., square = 0.;

  for (guint i = 0; i < o->n; i++) {
    const gdouble *column = fit->columns + i * size;

    back[i] = fit->start[i] - fit->x[i];
    for (gsize k = 0; k < size; k++)
      s[i] += column[k] * fit->z[k];
    for (guint j = 0; j < o->n; j++)
      for (gsize k = 0; k < size; k++)
        g[i * o->n + j] += column[k] * fit->columns[j * size + k];
  }
  cloth_posterior_init (&posterior, o->n);
  cloth_posterior_add_data (&posterior, g, s, 1.);
  cloth_posterior_add_prior (&posterior, o->precisions, back);
  if (!cloth_posterior_solve (&posterior))
    return FALSE;
  for (guint i = 0; i < o->n; i++)
    largest = fmax (largest, fabs (posterior.mean[i]));
  for (guint i = 0; i < o->n; i++) {
    gdouble to = fit->x[i] + posterior.mean[i] * (largest > longest ?
        longest / largest : 1.);

    fit->step[i] = CLAMP (to, o->low[i], o->high[i]) - fit->x[i];
    square += fit->step[i] * fit->step[i];
  }
  return square > 0.;
}

/* To where somebody thinks it should be. */
static void
guess_step (const Fit * fit)
{
  const ClothBroydenOptions *o = fit->options;

  for (guint i = 0; i < o->n; i++)
    fit->step[i] = CLAMP (o->guess[i], o->low[i], o->high[i]) - fit->x[i];
}

/* What the step did, the derivatives say from now on. */
static void
mend (Fit * fit)
{
  const guint n = fit->options->n;
  const gsize size = fit->options->size;
  gdouble square = 0.;

  for (guint i = 0; i < n; i++)
    square += fit->step[i] * fit->step[i];
  for (gsize k = 0; k < size; k++) {
    gdouble off = fit->there[k] - fit->z[k];

    for (guint i = 0; i < n; i++)
      off -= fit->columns[i * size + k] * fit->step[i];
    for (guint i = 0; i < n; i++)
      fit->columns[i * size + k] += off * fit->step[i] / square;
  }
}

static gdouble
find_length (const Fit * fit)
{
  gdouble length = 0.;

  for (guint i = 0; i < fit->options->n; i++)
    length = fmax (length, fabs (fit->step[i]));
  return length;
}

/* Takes the step, and stays where it leads if that is better. FALSE: something failed. */
static gboolean
take_step (Fit * fit, gdouble * cost, GError ** error)
{
  const guint n = fit->options->n;
  g_autofree gdouble *at = g_new (gdouble, n);
  g_autoptr (GError) failed = NULL;

  *cost = INFINITY;
  fit->n_calls++;
  for (guint i = 0; i < n; i++)
    at[i] = fit->x[i] + fit->step[i];
  if (fit->residual (fit->data, at, fit->there, &failed)) {
    *cost = find_cost (fit, fit->step, fit->there);
    mend (fit);
  } else if (!g_error_matches (failed, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_MODEL)) {
    g_propagate_error (error, g_steal_pointer (&failed));
    return FALSE;
  }
  if (*cost < fit->cost) {
    memcpy (fit->x, at, n * sizeof *at);
    memcpy (fit->z, fit->there, fit->options->size * sizeof *fit->z);
    fit->cost = *cost;
  }
  return TRUE;
}

static gboolean
has_calls (const Fit * fit)
{
  return fit->n_calls < fit->options->n_calls;
}

/* Gauss–Newton steps, until they bring nothing. */
static gboolean
descend (Fit * fit, GError ** error)
{
  gdouble longest = fit->options->longest;

  while (has_calls (fit)) {
    const gdouble before = fit->cost;
    gdouble cost;

    if (fit->n_calls == 0 && fit->options->guess)
      guess_step (fit);
    else if (!find_step (fit, longest))
      break;
    if (find_length (fit) < fit->options->shortest)
      break;
    if (!take_step (fit, &cost, error))
      return FALSE;
    if (!(cost < before)) {
      longest = CUT * find_length (fit);
      continue;
    }
    longest = MIN (fit->options->longest,
        MAX (longest, find_length (fit) / CUT));
    if (before - cost < LEAST_GAIN * before)
      break;
  }
  return TRUE;
}

/* To so many times the distance of @from from the start. */
static gboolean
stretch (Fit * fit, const gdouble * from, gdouble factor, gdouble * cost,
    GError ** error)
{
  const ClothBroydenOptions *o = fit->options;

  for (guint i = 0; i < o->n; i++)
    fit->step[i] = CLAMP (fit->start[i] + factor * (from[i] - fit->start[i]),
        o->low[i], o->high[i]) - fit->x[i];
  *cost = INFINITY;
  return find_length (fit) < o->shortest || take_step (fit, cost, error);
}

/* Along the ray from the start. @costs: of the shorter, the best and the longer place. */
static gboolean
search_ray (Fit * fit, GError ** error)
{
  g_autofree gdouble *from = g_memdup2 (fit->x,
      fit->options->n * sizeof *fit->x);
  gdouble costs[3] = { INFINITY, fit->cost, INFINITY }, factor = 1.;
  gdouble bend;

  while (has_calls (fit) && costs[2] == INFINITY) {
    gdouble cost;

    if (!stretch (fit, from, factor * STRETCH, &cost, error))
      return FALSE;
    if (!(cost < costs[1])) {
      costs[2] = cost;
      break;
    }
    costs[0] = costs[1];
    costs[1] = cost;
    factor *= STRETCH;
  }
  while (has_calls (fit) && costs[0] == INFINITY) {
    gdouble cost;

    if (!stretch (fit, from, factor / STRETCH, &cost, error))
      return FALSE;
    if (!(cost < costs[1])) {
      costs[0] = cost;
      break;
    }
    costs[2] = costs[1];
    costs[1] = cost;
    factor /= STRETCH;
  }
  bend = costs[0] + costs[2] - 2. * costs[1];
  if (!has_calls (fit) || !(bend > 0.) || !isfinite (bend))
    return TRUE;
  factor *= pow (STRETCH, 0.5 * (costs[0] - costs[2]) / bend);
  return stretch (fit, from, factor, &costs[1], error);
}

/* @residual: finds the residual
 * @data: for @residual
 * @options: how
 * @x: (inout) (array): where to start; the best place that was found
 * @z: (inout) (array): the residual at @x
 * @columns: (inout) (array): [n][size], about its derivatives; as they were mended
 * @error: as @residual has it
 *
 * Returns: whether nothing failed but at places that have no residual
 */
gboolean
cloth_broyden_run (ClothBroydenResidual residual, gpointer data,
    const ClothBroydenOptions * options, gdouble * x, gdouble * z,
    gdouble * columns, GError ** error)
{
  const guint n = options->n;
  g_autofree gdouble *start = g_memdup2 (x, n * sizeof *x);
  g_autofree gdouble *step = g_new0 (gdouble, n + 1);
  g_autofree gdouble *there = g_new (gdouble, options->size);
  Fit fit = { residual, data, options, start, x, z, columns, step, there };

  fit.cost = find_cost (&fit, step, z);
  return descend (&fit, error) && search_ray (&fit, error);
}
