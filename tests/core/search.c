/* Asynchronous parallel pattern search: minima in closed form, another library's search,
 * equal searches whatever the order of values, replays, hostile logs.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <nlopt.h>
#include <string.h>

#include "gst/fit/error.h"
#include "gst/fit/search/evaluate.h"
#include "gst/math/random.h"

typedef gdouble (*Function) (const gdouble * x);

/* The least value, 3, at (1, −2, 0.5); the matrix is positive definite. */
static gdouble
quadratic (const gdouble * x)
{
  const gdouble d[3] = { x[0] - 1., x[1] + 2., x[2] - 0.5 };

  return 3. + 2. * d[0] * d[0] + d[1] * d[1] + 1.5 * d[2] * d[2] +
      1.2 * d[0] * d[1] - 0.8 * d[1] * d[2];
}

static gdouble
rosenbrock (const gdouble * x)
{
  return 100. * pow (x[1] - x[0] * x[0], 2.) + pow (1. - x[0], 2.);
}

/* Of f = (x − 2)² + (y + 1)² + x y the least value within [0, 1] × [0, 1] is on the edge:
 * ∂f/∂x = 2x − 4 + y < 0 there, so x = 1; f (1, y) = 1 + (y + 1)² + y grows with y, so y = 0. */
static gdouble
at_corner (const gdouble * x)
{
  return pow (x[0] - 2., 2.) + pow (x[1] + 1., 2.) + x[0] * x[1];
}

/* The bowl of least value 0 at (0.3, −0.2), without values in stripes and where x > 2. */
static gdouble
patchy (const gdouble * x)
{
  if (x[0] > 2. || (fmod (fabs (x[1]) * 10., 3.) > 2.5 && fabs (x[1]) > 0.3))
    return x[0] > 0. ? NAN : INFINITY;
  return pow (x[0] - 0.3, 2.) + pow (x[1] + 0.2, 2.);
}

static gdouble
nowhere (const gdouble * x)
{
  return NAN;
}

static void
prepare (ClothSearchOptions * options, guint n, const gdouble * start)
{
  cloth_search_options_init (options);
  options->n = n;
  options->start = start;
  options->tolerance = 1e-5;
  options->least_step = 2e-5;
  options->same = 1e-8;
  options->decrease = 1e-4;
  options->most_evaluations = 100000;
}

/* Values come in the order of trials. */
static ClothSearch *
search (Function function, const ClothSearchOptions * options, gdouble * best,
    gdouble * value)
{
  g_autoptr (GError) error = NULL;
  ClothSearch *s = cloth_search_new (options, &error);
  g_autofree gdouble *point = g_new (gdouble, options->n);
  guint id;

  g_assert_no_error (error);
  while (cloth_search_next (s, &id, point))
    g_assert_true (cloth_search_tell (s, id, function (point)));
  *value = cloth_search_get_best (s, best);
  return s;
}

static void
expect_near (const gdouble * got, const gdouble * expected, guint n,
    gdouble tolerance)
{
  for (guint k = 0; k < n; k++)
    g_assert_cmpfloat_with_epsilon (got[k], expected[k], tolerance);
}

static void
test_closed_forms (void)
{
  static const gdouble bottom[3] = { 1., -2., 0.5 };
  const gdouble start[3] = { 5., 4., -3. };
  const gdouble low[2] = { 0., 0. }, high[2] = { 1., 1. };
  const gdouble inside[2] = { 0.2, 0.7 }, corner[2] = { 1., 0. };
  ClothSearchOptions options;
  g_autoptr (ClothSearch) a = NULL;
  g_autoptr (ClothSearch) b = NULL;
  gdouble best[3], value;

  prepare (&options, 3, start);
  a = search (quadratic, &options, best, &value);
  g_assert_cmpint (cloth_search_get_state (a), ==, CLOTH_SEARCH_CONVERGED);
  expect_near (best, bottom, 3, 5e-5);
  g_assert_cmpfloat_with_epsilon (value, 3., 1e-8);

  prepare (&options, 2, inside);
  options.low = low;
  options.high = high;
  b = search (at_corner, &options, best, &value);
  g_assert_cmpint (cloth_search_get_state (b), ==, CLOTH_SEARCH_CONVERGED);
  /* Exactly: steps are cut at the bounds. */
  g_assert_cmpmem (best, sizeof corner, corner, sizeof corner);
  g_assert_cmpfloat (value, ==, 2.);
}

static double
of_nlopt (unsigned n, const double *x, double *gradient, void *data)
{
  (*(guint *) data)++;
  return rosenbrock (x);
}

/* A direct search of another library from the same start to the same precision. */
static guint
run_peer (gdouble * x, gdouble * value)
{
  nlopt_opt peer = nlopt_create (NLOPT_LN_SBPLX, 2);
  guint n = 0;

  nlopt_set_min_objective (peer, of_nlopt, &n);
  nlopt_set_initial_step1 (peer, 1.);
  nlopt_set_xtol_abs1 (peer, 1e-5);
  g_assert_cmpint (nlopt_optimize (peer, x, value), >, 0);
  nlopt_destroy (peer);
  return n;
}

static void
test_rosenbrock (void)
{
  const gdouble start[2] = { -1.2, 1. }, bottom[2] = { 1., 1. };
  ClothSearchOptions options;
  g_autoptr (ClothSearch) s = NULL;
  gdouble best[2], value, peer[2] = { -1.2, 1. }, its;
  guint n;

  prepare (&options, 2, start);
  options.decrease = 1e-6;
  s = search (rosenbrock, &options, best, &value);
  n = run_peer (peer, &its);
  g_test_message ("pattern search: %g at (%g, %g), %u evaluations; Subplex of "
      "NLopt: %g at (%g, %g), %u evaluations", value, best[0], best[1],
      cloth_search_get_counts (s).n_decided, its, peer[0], peer[1], n);
  expect_near (best, bottom, 2, 0.02);
  expect_near (best, peer, 2, 0.02);
  g_assert_cmpfloat (value, <, 1e-4);
}

static void
test_no_values (void)
{
  const gdouble start[2] = { 1.9, 1.3 }, bottom[2] = { 0.3, -0.2 };
  ClothSearchOptions options;
  g_autoptr (ClothSearch) s = NULL;
  g_autoptr (ClothSearch) none = NULL;
  gdouble best[2], value;

  prepare (&options, 2, start);
  s = search (patchy, &options, best, &value);
  g_assert_cmpint (cloth_search_get_state (s), ==, CLOTH_SEARCH_CONVERGED);
  expect_near (best, bottom, 2, 1e-4);
  g_assert_cmpuint (cloth_search_get_counts (s).n_failed, >, 0);

  none = search (nowhere, &options, best, &value);
  g_assert_cmpint (cloth_search_get_state (none), ==, CLOTH_SEARCH_NOWHERE);
  g_assert_true (isinf (value));
  g_assert_cmpuint (cloth_search_get_counts (none).n_failed, ==,
      cloth_search_get_counts (none).n_decided);
}

/* ---- orders ---- */

typedef struct
{
  guint id;
  gdouble point[2];
} Given;

/* Up to @workers trials are out at any time, and a random one of them is told. */
static ClothSearch *
search_shuffled (const ClothSearchOptions * options, guint workers,
    guint64 seed, guint most)
{
  ClothSearch *s = cloth_search_new (options, NULL);
  g_autoptr (GArray) given = g_array_new (FALSE, FALSE, sizeof (Given));
  ClothRandom random;
  Given one;

  cloth_random_init (&random, seed);
  for (guint told = 0; told < most; told++) {
    guint at;

    while (given->len < workers && cloth_search_next (s, &one.id, one.point))
      g_array_append_val (given, one);
    if (given->len == 0)
      break;
    at = cloth_random_below (&random, given->len);
    one = g_array_index (given, Given, at);
    g_array_remove_index (given, at);
    cloth_search_tell (s, one.id, patchy (one.point));
    /* once more, late, and of nobody */
    g_assert_false (cloth_search_tell (s, one.id, -1e9));
    g_assert_false (cloth_search_tell (s, 4000000000u, -1e9));
  }
  return s;
}

static void
test_orders (void)
{
  const gdouble start[2] = { 1.9, 1.3 };
  ClothSearchOptions options;
  g_autoptr (ClothSearch) one = NULL;
  guint n_other = 0;

  prepare (&options, 2, start);
  options.in_flight = 6;
  one = search_shuffled (&options, 1, 0, G_MAXUINT);
  g_assert_cmpint (cloth_search_get_state (one), ==, CLOTH_SEARCH_CONVERGED);
  for (guint64 seed = 1; seed <= 20; seed++) {
    g_autoptr (ClothSearch) s = search_shuffled (&options,
        1 + (guint) seed % 9, seed, G_MAXUINT);

    g_assert_cmpstr (cloth_search_get_log (s), ==, cloth_search_get_log (one));
  }
  options.as_they_come = TRUE;
  for (guint64 seed = 1; seed <= 20; seed++) {
    g_autoptr (ClothSearch) s = search_shuffled (&options, 5, seed, G_MAXUINT);
    g_autoptr (ClothSearch) again = cloth_search_new (&options, NULL);
    g_autoptr (GError) error = NULL;
    gdouble best[2];

    n_other += strchr (cloth_search_get_log (s), '\n')[1] != '0';
    g_assert_cmpfloat_with_epsilon (cloth_search_get_best (s, best), 0., 1e-8);
    g_assert_true (cloth_search_replay (again, cloth_search_get_log (s),
            &error));
    g_assert_no_error (error);
    g_assert_cmpstr (cloth_search_get_log (s), ==,
        cloth_search_get_log (again));
    g_assert_cmpint (cloth_search_get_state (again), ==,
        CLOTH_SEARCH_CONVERGED);
  }
  /* They did come in other orders. */
  g_assert_cmpuint (n_other, >, 5);
}

/* Cut off anywhere, with half a line behind, a search in order goes on to the same bytes. */
static void
test_resume (void)
{
  const gdouble start[2] = { 1.9, 1.3 };
  ClothSearchOptions options;
  g_autoptr (ClothSearch) whole = NULL;

  prepare (&options, 2, start);
  whole = search_shuffled (&options, 3, 7, G_MAXUINT);
  for (guint most = 0; most < 40; most += 3) {
    g_autoptr (ClothSearch) part = search_shuffled (&options, 3, most, most);
    g_autoptr (ClothSearch) s = cloth_search_new (&options, NULL);
    g_autoptr (ClothSearch) again = cloth_search_new (&options, NULL);
    g_autofree gchar *log = g_strconcat (cloth_search_get_log (part), "12 0.",
        NULL);
    gdouble point[2];
    guint id;

    g_assert_true (cloth_search_replay (s, log, NULL));
    while (cloth_search_next (s, &id, point))
      cloth_search_tell (s, id, patchy (point));
    g_assert_cmpstr (cloth_search_get_log (s), ==,
        cloth_search_get_log (whole));
    /* a log that goes on where the search is, and one that begins otherwise */
    g_assert_true (cloth_search_replay (again, cloth_search_get_log (part),
            NULL));
    g_assert_true (cloth_search_replay (again, cloth_search_get_log (whole),
            NULL));
    g_assert_cmpstr (cloth_search_get_log (again), ==,
        cloth_search_get_log (whole));
    g_assert_false (cloth_search_replay (again, cloth_search_get_log (part),
            NULL));
  }
}

/* Workers that wait for each other once: behind the start, alone, come four points at a time. */
typedef struct
{
  GMutex lock;
  GCond all_here;
  guint threads, n_calls, n_here;
  gboolean here[4];
} Workers;

static gdouble
patchy_together (gpointer data, const gdouble * point, guint worker)
{
  Workers *w = data;

  g_mutex_lock (&w->lock);
  if (w->n_calls++ > 0 && !w->here[worker]) {
    w->here[worker] = TRUE;
    if (++w->n_here == w->threads)
      g_cond_broadcast (&w->all_here);
  }
  while (w->n_calls > 1 && w->n_here < w->threads)
    g_cond_wait (&w->all_here, &w->lock);
  g_mutex_unlock (&w->lock);
  g_usleep ((gulong) (fabs (point[0]) * 300.));
  return patchy (point);
}

static void
test_threads (void)
{
  const gdouble start[2] = { 1.9, 1.3 };
  ClothSearchOptions options;
  g_autofree gchar *log = NULL;

  prepare (&options, 2, start);
  for (guint threads = 1; threads <= 4; threads++) {
    g_autoptr (ClothSearch) s = cloth_search_new (&options, NULL);
    Workers workers = {.threads = threads };

    g_mutex_init (&workers.lock);
    g_cond_init (&workers.all_here);
    cloth_search_run (s, patchy_together, &workers, threads);
    g_assert_cmpuint (workers.n_here, ==, threads);
    g_cond_clear (&workers.all_here);
    g_mutex_clear (&workers.lock);
    if (log)
      g_assert_cmpstr (cloth_search_get_log (s), ==, log);
    else
      log = g_strdup (cloth_search_get_log (s));
  }
}

static void
test_limits (void)
{
  const gdouble start[2] = { -1.2, 1. };
  ClothSearchOptions options;
  gdouble best[2], value;

  prepare (&options, 2, start);
  for (guint most = 1; most < 12; most++) {
    g_autoptr (ClothSearch) s = NULL;

    options.most_evaluations = most;
    s = search (rosenbrock, &options, best, &value);
    g_assert_cmpint (cloth_search_get_state (s), ==, CLOTH_SEARCH_LIMIT);
    g_assert_cmpuint (cloth_search_get_counts (s).n_decided, ==, most);
  }
  /* Points that are asked for again are not evaluated again. */
  prepare (&options, 2, start);
  {
    g_autoptr (ClothSearch) s = search (rosenbrock, &options, best, &value);
    g_auto (GStrv) lines = g_strsplit (cloth_search_get_log (s), "\n", -1);
    g_autoptr (GHashTable) seen = g_hash_table_new (g_str_hash, g_str_equal);

    g_assert_cmpuint (cloth_search_get_counts (s).n_reused, >, 0);
    for (guint i = 1; lines[i] && *lines[i]; i++)
      g_assert_true (g_hash_table_add (seen, strchr (strchr (lines[i], ' ') + 1,
                  ' ')));
  }
}

/* ---- what is refused ---- */

static void
expect_refused (const ClothSearchOptions * options, const gchar * text)
{
  g_autoptr (GError) error = NULL;

  g_assert_null (cloth_search_new (options, &error));
  g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_SEARCH);
  g_assert_nonnull (strstr (error->message, text));
}

static void
test_bad_options (void)
{
  const gdouble start[2] = { 0.5, NAN }, good[2] = { 0.5, 0.5 };
  const gdouble low[2] = { 0., 0.6 }, scale[2] = { 1., 0. };
  ClothSearchOptions options;

  prepare (&options, 0, good);
  expect_refused (&options, "unknowns");
  prepare (&options, 2, start);
  expect_refused (&options, "finite");
  prepare (&options, 2, good);
  options.low = low;
  expect_refused (&options, "within the bounds");
  options.low = NULL;
  options.scale = scale;
  expect_refused (&options, "scale");
  prepare (&options, 2, good);
  options.contraction = 1.;
  expect_refused (&options, "contraction");
  prepare (&options, 2, good);
  options.tolerance = 0.;
  expect_refused (&options, "tolerance");
  prepare (&options, 2, good);
  options.first_step = NAN;
  expect_refused (&options, "steps");
  prepare (&options, 2, good);
  options.same = options.tolerance;
  expect_refused (&options, "nearer");
  prepare (&options, 2, good);
  options.most_evaluations = 0;
  expect_refused (&options, "evaluations");
  prepare (&options, 2, good);
  options.decrease = -1.;
  expect_refused (&options, "decrease");
}

static void
test_bad_logs (void)
{
  static const gchar *const tails[] = {
    "0 1 1.9\n", "0 nan 1.9 1.3\n", "1 5 1.9 1.3\n", "0 5 1.9 1.4\n",
    "0 5 1.9 1.3 7\n", "x\n", "99999999999999999999 5 1.9 1.3\n", "\n",
    "0 5 1.9 1.3\n0 5 1.9 1.3\n"
  };
  const gdouble start[2] = { 1.9, 1.3 };
  ClothSearchOptions options;
  g_autoptr (ClothSearch) fresh = NULL;

  prepare (&options, 2, start);
  fresh = cloth_search_new (&options, NULL);
  for (guint i = 0; i < G_N_ELEMENTS (tails); i++) {
    g_autoptr (ClothSearch) s = cloth_search_new (&options, NULL);
    g_autofree gchar *log = g_strconcat (cloth_search_get_log (fresh),
        tails[i], NULL);
    g_autoptr (GError) error = NULL;

    g_assert_false (cloth_search_replay (s, log, &error));
    g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_SEARCH);
  }
  {
    g_autoptr (ClothSearch) s = NULL;
    g_autoptr (GError) error = NULL;

    options.in_flight = 3;
    s = cloth_search_new (&options, NULL);
    g_assert_false (cloth_search_replay (s, cloth_search_get_log (fresh),
            &error));
    g_assert_nonnull (strstr (error->message, "other options"));
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/search/closed-forms", test_closed_forms);
  g_test_add_func ("/search/rosenbrock", test_rosenbrock);
  g_test_add_func ("/search/no-values", test_no_values);
  g_test_add_func ("/search/orders", test_orders);
  g_test_add_func ("/search/resume", test_resume);
  g_test_add_func ("/search/threads", test_threads);
  g_test_add_func ("/search/limits", test_limits);
  g_test_add_func ("/search/bad-options", test_bad_options);
  g_test_add_func ("/search/bad-logs", test_bad_logs);
  return g_test_run ();
}
