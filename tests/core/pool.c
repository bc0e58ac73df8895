/* The thread pool: every item once, the same whatever the number of threads.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/math/pool.h"

typedef struct
{
  guint n_threads;
  guint items[1000];
} Count;

static void
count (gpointer data, guint begin, guint end, guint worker)
{
  Count *self = data;

  g_assert_cmpuint (worker, <, self->n_threads);
  g_assert_cmpuint (begin, <, end);
  for (guint i = begin; i < end; i++)
    self->items[i] += i + 1;
}

static void
test_each_once (void)
{
  static const guint sizes[] = { 0, 1, 2, 3, 7, 64, 999, 1000 };

  for (guint threads = 0; threads <= 9; threads++) {
    g_autoptr (ClothPool) pool = cloth_pool_new (threads);
    Count self = { cloth_pool_get_n_threads (pool) };

    if (threads > 0)
      g_assert_cmpuint (self.n_threads, ==, threads);
    else
      g_assert_cmpuint (self.n_threads, ==, g_get_num_processors ());
    for (guint k = 0; k < G_N_ELEMENTS (sizes); k++)
      for (guint repeat = 0; repeat < 50; repeat++) {
        for (guint i = 0; i < 1000; i++)
          self.items[i] = 0;
        cloth_pool_run (pool, count, &self, sizes[k]);
        for (guint i = 0; i < 1000; i++)
          g_assert_cmpuint (self.items[i], ==, i < sizes[k] ? i + 1 : 0);
      }
  }
}

typedef struct
{
  gint order[100], n;
  GMutex lock;
} Order;

static void
take (gpointer data, guint begin, guint end, guint worker)
{
  Order *self = data;

  for (guint i = begin; i < end; i++) {
    /* of the first, all others' time */
    while (i == 0 && g_atomic_int_get (&self->n) < 99)
      g_thread_yield ();
    g_mutex_lock (&self->lock);
    self->order[self->n] = (gint) i;
    g_atomic_int_inc (&self->n);
    g_mutex_unlock (&self->lock);
  }
}

/* Nobody waits for the one that takes long, and each is done once. */
static void
test_one_by_one (void)
{
  g_autoptr (ClothPool) pool = cloth_pool_new (2);
  Count self = { 2 };
  Order order = { 0 };

  for (guint repeat = 0; repeat < 50; repeat++)
    cloth_pool_run_one_by_one (pool, count, &self, 1000);
  for (guint i = 0; i < 1000; i++)
    g_assert_cmpuint (self.items[i], ==, 50 * (i + 1));
  cloth_pool_run_one_by_one (NULL, count, &self, 10);
  g_assert_cmpuint (self.items[9], ==, 510);
  cloth_pool_run_one_by_one (pool, take, &order, 100);
  for (gint i = 0; i < 99; i++)
    g_assert_cmpint (order.order[i], ==, i + 1);
  g_assert_cmpint (order.order[99], ==, 0);
  cloth_pool_run_one_by_one (pool, count, &self, 0);
}

static void
test_without (void)
{
  Count self = { 1 };

  cloth_pool_run (NULL, count, &self, 10);
  g_assert_cmpuint (self.items[9], ==, 10);
  g_assert_cmpuint (self.items[10], ==, 0);
  g_assert_cmpuint (cloth_pool_get_n_threads (NULL), ==, 1);
  cloth_pool_free (NULL);
}

typedef struct
{
  ClothPool *pool;
  Count count;
} Caller;

static gpointer
caller_main (gpointer data)
{
  Caller *self = data;

  for (guint i = 0; i < 200; i++)
    cloth_pool_run (self->pool, count, &self->count, 1000);
  return NULL;
}

static void
test_two_callers (void)
{
  g_autoptr (ClothPool) pool = cloth_pool_new (3);
  Caller callers[2] = { {pool, {3}}, {pool, {3}} };
  GThread *threads[2];

  for (guint i = 0; i < 2; i++)
    threads[i] = g_thread_new ("caller", caller_main, &callers[i]);
  for (guint i = 0; i < 2; i++)
    g_thread_join (threads[i]);
  for (guint i = 0; i < 2; i++)
    for (guint k = 0; k < 1000; k++)
      g_assert_cmpuint (callers[i].count.items[k], ==, 200 * (k + 1));
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/pool/each-once", test_each_once);
  g_test_add_func ("/pool/one-by-one", test_one_by_one);
  g_test_add_func ("/pool/without", test_without);
  g_test_add_func ("/pool/two-callers", test_two_callers);
  return g_test_run ();
}
