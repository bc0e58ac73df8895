/* A pool of threads that share out a loop.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/math/pool.h"

typedef struct
{
  ClothPool *pool;
  guint index;
  GThread *thread;
} Worker;

struct _ClothPool
{
  /* one run at a time */
  GMutex run_lock;

  GMutex lock;
  GCond start, done;
  guint generation;
  guint pending;
  gboolean quit;
  ClothPoolFunc func;
  gpointer data;
  guint n_items;
  gboolean one_by_one;
  gint next;                    /* item that nobody has taken */

  guint n_threads;
  Worker workers[];
};

/* Worker i does items [n·i/w, n·(i+1)/w): contiguous, and a function of n and w only; or
 * one item after the other, as long as there are any. */
static void
do_part (ClothPool * pool, guint index)
{
  guint n = pool->n_items;

  if (pool->one_by_one) {
    guint item;

    while ((item = (guint) g_atomic_int_add (&pool->next, 1)) < n)
      pool->func (pool->data, item, item + 1, index);
  } else {
    guint begin = (guint) ((guint64) n * index / pool->n_threads);
    guint end = (guint) ((guint64) n * (index + 1) / pool->n_threads);

    if (begin < end)
      pool->func (pool->data, begin, end, index);
  }
}

static gpointer
worker_main (gpointer user_data)
{
  Worker *self = user_data;
  ClothPool *pool = self->pool;
  guint generation = 0;

  g_mutex_lock (&pool->lock);
  while (TRUE) {
    while (pool->generation == generation && !pool->quit)
      g_cond_wait (&pool->start, &pool->lock);
    if (pool->quit)
      break;
    generation = pool->generation;
    /* the run does not end, nor the next begin, before this worker is done */
    g_mutex_unlock (&pool->lock);

    do_part (pool, self->index);

    g_mutex_lock (&pool->lock);
    if (--pool->pending == 0)
      g_cond_signal (&pool->done);
  }
  g_mutex_unlock (&pool->lock);
  return NULL;
}

/* @threads: threads that work on a loop, the calling one included; 0: as many as the
 *   machine has processors
 *
 * Returns: (transfer full): a pool whose threads wait for cloth_pool_run ()
 */
ClothPool *
cloth_pool_new (guint threads)
{
  ClothPool *pool;

  if (threads == 0)
    threads = g_get_num_processors ();
  threads = CLAMP (threads, 1, 1024);
  pool = g_malloc0 (sizeof (*pool) + threads * sizeof (Worker));
  g_mutex_init (&pool->run_lock);
  g_mutex_init (&pool->lock);
  g_cond_init (&pool->start);
  g_cond_init (&pool->done);
  pool->n_threads = threads;
  for (guint i = 1; i < threads; i++) {
    pool->workers[i].pool = pool;
    pool->workers[i].index = i;
    pool->workers[i].thread = g_thread_new ("cloth-pool", worker_main,
        &pool->workers[i]);
  }
  return pool;
}

/* @pool: (nullable) (transfer full): pool with no run under way
 */
void
cloth_pool_free (ClothPool * pool)
{
  if (pool == NULL)
    return;
  g_mutex_lock (&pool->lock);
  pool->quit = TRUE;
  g_cond_broadcast (&pool->start);
  g_mutex_unlock (&pool->lock);
  for (guint i = 1; i < pool->n_threads; i++)
    g_thread_join (pool->workers[i].thread);
  g_mutex_clear (&pool->run_lock);
  g_mutex_clear (&pool->lock);
  g_cond_clear (&pool->start);
  g_cond_clear (&pool->done);
  g_free (pool);
}

/* @pool: (nullable): pool
 *
 * Returns: how many workers there are; 1 for %NULL
 */
guint
cloth_pool_get_n_threads (const ClothPool * pool)
{
  return pool != NULL ? pool->n_threads : 1;
}

static void
run (ClothPool * pool, ClothPoolFunc func, gpointer data, guint n_items,
    gboolean one_by_one)
{
  if (n_items == 0)
    return;
  if (pool == NULL || pool->n_threads == 1 || n_items == 1) {
    func (data, 0, n_items, 0);
    return;
  }
  g_mutex_lock (&pool->run_lock);
  g_mutex_lock (&pool->lock);
  pool->func = func;
  pool->data = data;
  pool->n_items = n_items;
  pool->one_by_one = one_by_one;
  pool->next = 0;
  pool->pending = pool->n_threads - 1;
  pool->generation++;
  g_cond_broadcast (&pool->start);
  g_mutex_unlock (&pool->lock);

  do_part (pool, 0);

  g_mutex_lock (&pool->lock);
  while (pool->pending > 0)
    g_cond_wait (&pool->done, &pool->lock);
  g_mutex_unlock (&pool->lock);
  g_mutex_unlock (&pool->run_lock);
}

/* @pool: (nullable): pool; %NULL does everything in the calling thread
 * @func: does a range of items
 * @data: for @func
 * @n_items: items 0 … @n_items − 1 are shared out in contiguous ranges of nearly equal
 *   length
 *
 * Returns when all is done. It allocates nothing. @func must do each item so that the
 * result does not depend on the range it came in; then it does not depend on the number
 * of threads either. Calls from several threads take turns; @func must not call it on
 * the same pool.
 */
void
cloth_pool_run (ClothPool * pool, ClothPoolFunc func, gpointer data,
    guint n_items)
{
  run (pool, func, data, n_items, FALSE);
}

/* @pool: (nullable): pool; %NULL does everything in the calling thread
 * @func: does a range of items
 * @data: for @func
 * @n_items: items 0 … @n_items − 1 are begun in this order, each by the next thread that
 *   has nothing to do
 *
 * As cloth_pool_run (), for items that take unlike times: no thread waits while there is
 * an item left. The longest ones should come first.
 */
void
cloth_pool_run_one_by_one (ClothPool * pool, ClothPoolFunc func, gpointer data,
    guint n_items)
{
  run (pool, func, data, n_items, TRUE);
}
