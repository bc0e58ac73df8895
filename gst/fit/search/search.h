/* Asynchronous parallel pattern search: the least value of a function that is dear.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* Most unknowns and evaluations: limits on what a search holds in memory. */
#define CLOTH_SEARCH_MAX_N 1000u
#define CLOTH_SEARCH_MAX_EVALUATIONS 1000000u

/* What asks for points, takes their values and decides where to look next. It evaluates
 * nothing itself. */
typedef struct _ClothSearch ClothSearch;

/* @n: number of unknowns
 * @start: (array length=n): where it begins
 * @low: (nullable) (array length=n): least values; %NULL: none
 * @high: (nullable) (array length=n): greatest values; %NULL: none
 * @scale: (nullable) (array length=n): what a step of 1 is; %NULL: high − low where both
 *   are finite, else 1
 * @first_step: step along each direction at the start, in @scale (1)
 * @tolerance: directions whose steps are shorter have ended, and so has the search when
 *   all have (0.01)
 * @least_step: steps around a new best point are no shorter at first (2 × tolerance)
 * @contraction: a step that leads to nothing better becomes shorter by this (0.5)
 * @decrease: a point is better when its value is lower by this × step² (0.01)
 * @same: points of which no unknown differs by more, in @scale, are evaluated once
 *   (tolerance ÷ 2)
 * @most_evaluations: it ends with so many
 * @in_flight: points that are asked for before their values are known; 0: one for each
 *   direction, 2n. More than there are workers, else these wait
 * @what: (nullable): what is searched, for the log: a log of anything else is refused
 * @as_they_come: decides in the order in which values come, as the papers do, which keeps all
 *   workers busy; else in the order of trials, so that the search is the same for any number of
 *   workers
 *
 * Defaults, which cloth_search_options_init () gives, are those of APPSPACK.
 */
typedef struct {
  guint n;
  const gdouble *start;
  const gdouble *low;
  const gdouble *high;
  const gdouble *scale;
  gdouble first_step;
  gdouble tolerance;
  gdouble least_step;
  gdouble contraction;
  gdouble decrease;
  gdouble same;
  guint most_evaluations;
  guint in_flight;
  const gchar *what;
  gboolean as_they_come;
} ClothSearchOptions;

/* @CLOTH_SEARCH_RUNS: there are values to come
 * @CLOTH_SEARCH_CONVERGED: no step leads to anything better
 * @CLOTH_SEARCH_LIMIT: there were as many evaluations as may be
 * @CLOTH_SEARCH_NOWHERE: no point near the start has a value
 */
typedef enum {
  CLOTH_SEARCH_RUNS,
  CLOTH_SEARCH_CONVERGED,
  CLOTH_SEARCH_LIMIT,
  CLOTH_SEARCH_NOWHERE
} ClothSearchState;

/* @n_decided: values that were looked at
 * @n_failed: those of them that were not finite
 * @n_reused: points that had been asked for already
 * @n_moves: how often a better point was found
 */
typedef struct {
  guint n_decided;
  guint n_failed;
  guint n_reused;
  guint n_moves;
} ClothSearchCounts;

void cloth_search_options_init (ClothSearchOptions * options);
ClothSearch *cloth_search_new (const ClothSearchOptions * options,
    GError ** error);
guint cloth_search_get_n (const ClothSearch * search);
gboolean cloth_search_next (ClothSearch * search, guint * id, gdouble * point);
gboolean cloth_search_tell (ClothSearch * search, guint id, gdouble value);
ClothSearchState cloth_search_get_state (const ClothSearch * search);
ClothSearchCounts cloth_search_get_counts (const ClothSearch * search);
gboolean cloth_search_is_as_they_come (const ClothSearch * search);
gdouble cloth_search_get_best (const ClothSearch * search, gdouble * point);
const gchar *cloth_search_get_log (const ClothSearch * search);
gboolean cloth_search_replay (ClothSearch * search, const gchar * log,
    GError ** error);
void cloth_search_free (ClothSearch * search);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothSearch, cloth_search_free)
G_END_DECLS
