/* A pool of threads that share out a loop.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

typedef struct _ClothPool ClothPool;

/* @data: what cloth_pool_run () was given
 * @begin: first item to do
 * @end: one past the last item to do
 * @worker: 0 … cloth_pool_get_n_threads () − 1, for scratch memory of one's own; what
 *   is written to the results must not depend on it
 *
 * A part of the loop.
 */
typedef void (*ClothPoolFunc) (gpointer data, guint begin, guint end,
    guint worker);

ClothPool *cloth_pool_new (guint threads);
void cloth_pool_free (ClothPool * pool);
guint cloth_pool_get_n_threads (const ClothPool * pool);
void cloth_pool_run (ClothPool * pool, ClothPoolFunc func, gpointer data,
    guint n_items);
void cloth_pool_run_one_by_one (ClothPool * pool, ClothPoolFunc func,
    gpointer data, guint n_items);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothPool, cloth_pool_free)
G_END_DECLS
