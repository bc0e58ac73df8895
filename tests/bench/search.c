/* Pattern search: evaluations a second by threads, by processes that share a spool, by ranks of MPI; of
 * evaluations that compute, and of such that only last, as on processors of their own.
 *
 *   bench-search                     all of these
 *   bench-search manage SPOOL N      a manager whose N workers are started elsewhere
 *   bench-search work SPOOL KIND     such a worker; KIND is computes or lasts
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "gst/fit/search/evaluate.h"
#include "tests/bench/clock.h"

#define N 4
#define EVALUATIONS 300
/* An evaluation takes from half to one and a half of this, ms: simulations end early or late. */
#define TYPICAL_MS 20.

static const ClothSpoolOptions spool_options = { "bench", "0", 0. };

/* The same for equal points. */
static gdouble
duration_ms (const gdouble * x)
{
  gdouble whole;

  return TYPICAL_MS * (0.5 + modf (fabs (x[0] * 97. + x[1] * 31. + x[2] * 7. +
              x[3] * 3.), &whole));
}

static gdouble
evaluate (gpointer data, const gdouble * x, guint worker)
{
  const gdouble ms = duration_ms (x);
  gdouble value = 0.;

  if (*(gboolean *) data) {
    const gdouble begin = cpu_ms ();

    while (cpu_ms () - begin < ms)
      continue;
  } else {
    g_usleep ((gulong) (1000. * ms));
  }
  for (guint k = 0; k < N; k++)
    value += (1. + k) * pow (x[k] - 0.3 * (k + 1.), 2.) +
        0.5 * (x[k] - 1.) * (x[(k + 1) % N] + 1.);
  return value;
}

static ClothSearch *
new_search (gboolean as_they_come)
{
  static const gdouble start[N] = { 2., -3., 1., 4. };
  ClothSearchOptions options;

  cloth_search_options_init (&options);
  options.n = N;
  options.start = start;
  options.tolerance = 1e-4;
  options.least_step = 2e-4;
  options.same = 1e-7;
  options.decrease = 0.;
  options.most_evaluations = EVALUATIONS;
  options.as_they_come = as_they_come;
  return cloth_search_new (&options, NULL);
}

static gdouble
tell (const gchar * what, const ClothSearch * search, gint64 begin_us,
    gdouble one)
{
  const gdouble s = (gdouble) (g_get_monotonic_time () - begin_us) / 1e6;
  const guint n = cloth_search_get_counts (search).n_decided;
  gdouble best[N];

  printf ("%-42s %7.1f evaluations/s  × %.2f  best %.6f\n", what, n / s,
      one > 0. ? n / s / one : 1., cloth_search_get_best (search, best));
  fflush (stdout);
  return n / s;
}

static gdouble
run_threads (guint threads, gboolean as_they_come, gboolean computes,
    gdouble one)
{
  g_autoptr (ClothSearch) search = new_search (as_they_come);
  g_autofree gchar *what = g_strdup_printf ("%u thread%s, %s", threads,
      threads > 1 ? "s" : "", as_they_come ? "as they come" : "in order");
  const gint64 begin_us = g_get_monotonic_time ();

  cloth_search_run (search, evaluate, &computes, threads);
  return tell (what, search, begin_us, one);
}

static void
remove_all (const gchar * path)
{
  GDir *dir = g_dir_open (path, 0, NULL);
  const gchar *name;

  while (dir && (name = g_dir_read_name (dir))) {
    g_autofree gchar *inside = g_build_filename (path, name, NULL);

    remove_all (inside);
  }
  if (dir)
    g_dir_close (dir);
  g_remove (path);
}

static void
fail (const GError * error)
{
  if (error)
    g_error ("%s", error->message);
}

/* The time counts once all workers are there: starting processes is no part of a search. */
static void
manage (const gchar * folder, guint workers, const gchar * what, gdouble one)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothSearch) search = new_search (FALSE);
  g_autoptr (ClothSpool) spool = cloth_spool_manage (folder, &spool_options,
      "p", FALSE, &error);
  g_autofree gchar *beats = g_build_filename (folder, "beats", NULL);
  guint n = 0;
  gint64 begin_us;

  fail (error);
  while (n < 1 + workers) {     /* the manager's own is among them */
    g_autoptr (GDir) dir = g_dir_open (beats, 0, NULL);

    for (n = 0; g_dir_read_name (dir);)
      n++;
    g_usleep (1000);
  }
  begin_us = g_get_monotonic_time ();
  cloth_search_run_spool (search, spool, &error);
  fail (error);
  tell (what, search, begin_us, one);
}

static int
work (const gchar * folder, gboolean computes)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothSpool) spool = cloth_spool_join (folder, &spool_options, 60.,
      &error);

  fail (error);
  cloth_search_work_spool (spool, N, evaluate, &computes, &error);
  fail (error);
  return 0;
}

/* Two workers that @prefix starts; without one, two that are started here. */
static void
run_spool (const gchar * const *prefix, const gchar * what, gboolean computes,
    gdouble one)
{
  g_autofree gchar *base = g_dir_make_tmp ("cloth-bench-XXXXXX", NULL);
  g_autofree gchar *folder = g_build_filename (base, "spool", NULL);
  g_autofree gchar *self = g_file_read_link ("/proc/self/exe", NULL);
  g_autoptr (GPtrArray) words = g_ptr_array_new ();
  GSubprocess *processes[2] = { NULL, NULL };
  g_autoptr (GError) error = NULL;

  for (; prefix && *prefix; prefix++)
    g_ptr_array_add (words, (gpointer) * prefix);
  g_ptr_array_add (words, self);
  g_ptr_array_add (words, (gpointer) "work");
  g_ptr_array_add (words, folder);
  g_ptr_array_add (words, (gpointer) (computes ? "computes" : "lasts"));
  g_ptr_array_add (words, NULL);
  for (guint i = 0; i < (prefix ? 1 : 2); i++) {
    processes[i] = g_subprocess_newv ((const gchar * const *) words->pdata,
        G_SUBPROCESS_FLAGS_NONE, &error);
    fail (error);
  }
  manage (folder, 2, what, one);
  for (guint i = 0; i < 2 && processes[i]; i++) {
    g_subprocess_wait (processes[i], NULL, NULL);
    g_object_unref (processes[i]);
  }
  remove_all (base);
}

int
main (int argc, char **argv)
{
  static const gchar *const ranks[] = {
    "mpirun", "--oversubscribe", "--mca", "btl", "tcp,self", "-n", "2", NULL
  };
  g_autofree gchar *mpirun = g_find_program_in_path ("mpirun");

  if (argc == 4 && !strcmp (argv[1], "work"))
    return work (argv[2], !strcmp (argv[3], "computes"));
  if (argc == 4 && !strcmp (argv[1], "manage")) {
    manage (argv[2], (guint) g_ascii_strtoull (argv[3], NULL, 10),
        "workers from elsewhere", 0.);
    return 0;
  }
  g_setenv ("OMPI_ALLOW_RUN_AS_ROOT", "1", FALSE);
  g_setenv ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", FALSE);
  for (guint computes = 0; computes < 2; computes++) {
    gdouble one;

    printf ("evaluations that %s %g to %g ms, %u of them\n",
        computes ? "compute" : "last", 0.5 * TYPICAL_MS, 1.5 * TYPICAL_MS,
        EVALUATIONS);
    one = run_threads (1, FALSE, computes, 0.);
    run_threads (2, FALSE, computes, one);
    run_threads (2, TRUE, computes, one);
    run_threads (4, FALSE, computes, one);
    run_threads (4, TRUE, computes, one);
    run_spool (NULL, "2 processes with a spool, in order", computes, one);
    if (mpirun)
      run_spool (ranks, "2 ranks of MPI with a spool, in order", computes, one);
  }
  return 0;
}
