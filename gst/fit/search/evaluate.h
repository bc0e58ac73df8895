/* Who evaluates the trials of a pattern search: threads, or the workers of a spool.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/file/spool.h"
#include "gst/fit/search/search.h"

G_BEGIN_DECLS

/* @data: the caller's
 * @point: (array): where, as many numbers as the search has unknowns
 * @worker: 0 … threads − 1, for scratch memory of one's own
 *
 * Called by several threads at once. Equal points must give equal values.
 *
 * Returns: the value; not finite: there is none
 */
typedef gdouble (*ClothSearchFunc) (gpointer data, const gdouble * point,
    guint worker);

void cloth_search_run (ClothSearch * search, ClothSearchFunc func,
    gpointer data, guint threads);
gboolean cloth_search_run_spool (ClothSearch * search, ClothSpool * spool,
    GError ** error);
gboolean cloth_search_work_spool (ClothSpool * spool, guint n,
    ClothSearchFunc func, gpointer data, GError ** error);

G_END_DECLS
