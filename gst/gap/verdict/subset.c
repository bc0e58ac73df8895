/* Which of the accepted effects bring the simulation nearer to the cloth.
 *
 * Model: V_S is the mean square gap of the model with the effects S, fitted with them. Effect e of S helps when
 *   V_{S∖e} − V_S > 0, surely: above 0 in 95% of draws of a paired bootstrap. Where neither is more than the
 *   floor, nobody can tell.
 * Method: backward elimination, then forward selection among what went (Draper and Smith, Applied Regression
 *   Analysis, 1998, 15).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/verdict/subset.h"

#include <math.h>

#include "gst/math/statistics.h"

/* What is compared. */
typedef struct
{
  const gdouble *squares, *draws;
  guint n_draws;
  gdouble floor;
} Gaps;

static gboolean
is_above (const Gaps * g, guint subset)
{
  return g->squares[subset] - g->floor >
      CLOTH_GAP_LEAST_ABOVE_SHARE * g->squares[subset];
}

/* Whether with an effect or without it more is left than the floor. */
static gboolean
can_tell (const Gaps * g, guint with, guint without)
{
  return is_above (g, with) || is_above (g, without);
}

/* Whether a model with one effect more than another is surely nearer to the cloth. */
static gboolean
helps (const Gaps * g, guint with, guint without)
{
  const gdouble *after = g->draws + (gsize) with * g->n_draws;
  const gdouble *before = g->draws + (gsize) without * g->n_draws;
  g_autoptr (GArray) gains = g_array_sized_new (FALSE, FALSE,
      sizeof (gdouble), g->n_draws);

  for (guint i = 0; i < g->n_draws; i++) {
    const gdouble gain = before[i] - after[i];

    g_array_append_val (gains, gain);
  }
  g_array_sort (gains, cloth_compare_doubles);
  return g_array_index (gains, gdouble, g->n_draws / 20) > 0.;
}

/* The subset without the effect that is missed least, of those that don't help; itself when all do. */
static guint
drop_one (const Gaps * g, guint subset, guint n_effects, guint kept)
{
  gdouble least = INFINITY;
  guint next = subset;

  for (guint k = 0; k < n_effects; k++) {
    const guint without = subset & ~(1u << k);
    const gdouble gain = g->squares[without] - g->squares[subset];

    if (without == subset || (kept >> k & 1)
        || !can_tell (g, subset, without) || !(gain < least)
        || helps (g, subset, without))
      continue;
    least = gain;
    next = without;
  }
  return next;
}

/* The subset with the effect that brings most, of those that help; itself when none does. */
static guint
add_one (const Gaps * g, guint subset, guint n_effects)
{
  gdouble most = 0.;
  guint next = subset;

  for (guint k = 0; k < n_effects; k++) {
    const guint with = subset | 1u << k;
    const gdouble gain = g->squares[subset] - g->squares[with];

    if (with == subset || !can_tell (g, with, subset) || !(gain > most)
        || !helps (g, with, subset))
      continue;
    most = gain;
    next = with;
  }
  return next;
}

/* @squares: (array): mean square gap of the model with each subset of the effects: bit k of the index says that
 *   the k-th acts, [2^n_effects]; NaN: not known
 * @draws: (array): draws of these that belong together, [2^n_effects][n_draws]
 * @n_draws: how many, at least one
 * @n_effects: how many effects there are
 * @kept: those that stay: bit k stands for the k-th
 * @floor: what a simulation that lacks nothing is off by, mean square
 *
 * Returns: the subset without what brings the simulation no nearer to the cloth
 */
guint
cloth_gap_choose_subset (const gdouble * squares, const gdouble * draws,
    guint n_draws, guint n_effects, guint kept, gdouble floor)
{
  const Gaps g = { squares, draws, n_draws, floor };
  guint subset = (1u << n_effects) - 1, next;

  while ((next = drop_one (&g, subset, n_effects, kept)) != subset)
    subset = next;
  /* one went because of another that went after it */
  while ((next = add_one (&g, subset, n_effects)) != subset)
    subset = next;
  return subset;
}
