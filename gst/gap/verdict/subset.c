/* Which of the accepted effects bring the simulation nearer to the cloth.
 *
 * Model: V_S is the mean square gap of the model with the effects S, fitted with them. Effect e of S helps when
 *   V_{S∖e} − V_S > 0, surely: above 0 in 95% of draws of a paired bootstrap. Where S∖e leaves no more than the
 *   floor, nobody can tell.
 * Method: backward elimination (Draper and Smith, Applied Regression Analysis, 1998, 15.2).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/verdict/subset.h"

#include <math.h>
#include <string.h>

#include "gst/math/statistics.h"

/* Whether a model with one effect more than another is surely nearer to the cloth, or nobody can tell. */
static gboolean
may_help (const gdouble * with, const gdouble * without, guint n_draws)
{
  g_autoptr (GArray) gains = g_array_sized_new (FALSE, FALSE,
      sizeof (gdouble), n_draws);

  for (guint i = 0; i < n_draws; i++) {
    const gdouble gain = without[i] - with[i];

    g_array_append_val (gains, gain);
  }
  g_array_sort (gains, cloth_compare_doubles);
  return g_array_index (gains, gdouble, n_draws / 20) > 0.;
}

/* @squares: (array): mean square gap of the model with each subset of the effects: bit k of the index says that
 *   the k-th acts, [2^n_effects]; NaN: not known
 * @draws: (array): draws of these that belong together, [2^n_effects][n_draws]
 * @n_draws: how many, at least one
 * @n_effects: how many effects there are
 * @floor: what a simulation that lacks nothing is off by, mean square
 *
 * Returns: the subset without what brings the simulation no nearer to the cloth
 */
guint
cloth_gap_choose_subset (const gdouble * squares, const gdouble * draws,
    guint n_draws, guint n_effects, gdouble floor)
{
  guint subset = (1u << n_effects) - 1, next = subset;

  do {
    gdouble least = INFINITY;

    subset = next;
    for (guint k = 0; k < n_effects; k++) {
      const guint without = subset & ~(1u << k);
      const gdouble gain = squares[without] - squares[subset];

      if (without == subset
          || !(squares[without] - floor >
              CLOTH_GAP_LEAST_ABOVE_SHARE * squares[without])
          || !(gain < least)
          || may_help (draws + (gsize) subset * n_draws,
              draws + (gsize) without * n_draws, n_draws))
        continue;
      least = gain;
      next = without;
    }
  } while (next != subset);
  return subset;
}
