/* Spools: jobs once each, processes that are killed, hosts that fall silent, two managers,
 * what others wrote.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/spool.h"

#include <errno.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <math.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utime.h>

#include "gst/file/json.h"
#include "gst/fit/error.h"
#include "gst/fit/search/evaluate.h"

#define LOST_S 1.5

static const ClothSpoolOptions options = { "test", "0.1", LOST_S };

typedef struct
{
  gchar *folder;
} Fixture;

static void
set_up (Fixture * f, gconstpointer data)
{
  g_autofree gchar *base = g_dir_make_tmp ("cloth-spool-XXXXXX", NULL);

  f->folder = g_build_filename (base, "spool", NULL);
}

static void
remove_all (const gchar * path)
{
  GDir *dir = g_file_test (path, G_FILE_TEST_IS_SYMLINK) ? NULL :
      g_dir_open (path, 0, NULL);
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
tear_down (Fixture * f, gconstpointer data)
{
  g_autofree gchar *base = g_path_get_dirname (f->folder);

  remove_all (base);
  g_free (f->folder);
}

static ClothSpool *
manage (Fixture * f, gboolean resume)
{
  g_autoptr (GError) error = NULL;
  ClothSpool *spool = cloth_spool_manage (f->folder, &options, "p", resume,
      &error);

  g_assert_no_error (error);
  return spool;
}

static ClothSpool *
join (Fixture * f)
{
  g_autoptr (GError) error = NULL;
  ClothSpool *spool = cloth_spool_join (f->folder, &options, 0., &error);

  g_assert_no_error (error);
  return spool;
}

static void
put (ClothSpool * spool, const gchar * id)
{
  g_autofree gchar *json = g_strdup_printf ("{\"do\": \"%s\"}", id);

  g_assert_true (cloth_spool_put (spool, id, json, FALSE, NULL));
}

static gchar *
claim (ClothSpool * worker, ClothSpoolJob ** job)
{
  g_autoptr (GError) error = NULL;

  *job = cloth_spool_claim (worker, &error);
  g_assert_no_error (error);
  return *job ? (*job)->id : NULL;
}

static void
finish (ClothSpool * worker, const ClothSpoolJob * job)
{
  g_autofree gchar *json = g_strdup_printf ("{\"of\": \"%s\"}", job->id);

  g_assert_true (cloth_spool_finish (worker, job, json, FALSE, NULL));
}

/* The id of a result that has come, or NULL. */
static gchar *
take (ClothSpool * spool)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothSpoolJob) job = cloth_spool_take (spool, &error);
  g_autofree gchar *json = NULL;

  g_assert_no_error (error);
  if (!job)
    job = cloth_spool_take (spool, NULL);       /* from the first on */
  if (!job)
    return NULL;
  json = g_strdup_printf ("{\"of\": \"%s\"}", job->id);
  g_assert_cmpstr (job->json, ==, json);
  return g_strdup (job->id);
}

static guint
count_ending (Fixture * f, const gchar * name, const gchar * ending)
{
  g_autofree gchar *path = g_build_filename (f->folder, name, NULL);
  g_autoptr (GDir) dir = g_dir_open (path, 0, NULL);
  const gchar *file;
  guint n = 0;

  while (dir && (file = g_dir_read_name (dir)))
    n += g_str_has_suffix (file, ending);
  return n;
}

static guint
count (Fixture * f, const gchar * name)
{
  return count_ending (f, name, "");
}

static void
write_file (Fixture * f, const gchar * name, const gchar * text)
{
  g_autofree gchar *path = g_build_filename (f->folder, name, NULL);

  g_assert_true (g_file_set_contents (path, text, -1, NULL));
}

/* Looks after the spool until so many were put back; seconds that took. */
static gdouble
wait_for_lost (ClothSpool * spool, guint n)
{
  const gint64 begin = g_get_monotonic_time ();
  g_autoptr (GError) error = NULL;

  while (cloth_spool_get_n_lost (spool) < n &&
      g_get_monotonic_time () - begin < 20 * G_USEC_PER_SEC) {
    g_assert_true (cloth_spool_look_after (spool, &error));
    g_assert_no_error (error);
    cloth_spool_wait (spool);
  }
  g_assert_cmpuint (cloth_spool_get_n_lost (spool), ==, n);
  return (gdouble) (g_get_monotonic_time () - begin) / G_USEC_PER_SEC;
}

/* ---- jobs ---- */

static void
test_jobs (Fixture * f, gconstpointer data)
{
  g_autoptr (ClothSpool) spool = manage (f, FALSE);
  g_autoptr (ClothSpool) a = join (f);
  g_autoptr (ClothSpool) b = join (f);
  g_autoptr (ClothSpoolJob) one = NULL;
  g_autoptr (ClothSpoolJob) two = NULL;
  g_autoptr (ClothSpoolJob) none = NULL;
  g_autofree gchar *first = NULL, *second = NULL;

  g_assert_null (claim (a, &none));
  g_assert_cmpint (cloth_spool_get_state (a), ==, CLOTH_SPOOL_OPEN);
  put (spool, "2");
  put (spool, "1");
  g_assert_cmpstr (claim (a, &one), ==, "1");
  g_assert_cmpstr (one->json, ==, "{\"do\": \"1\"}");
  g_assert_cmpstr (claim (b, &two), ==, "2");
  g_assert_null (claim (a, &none));
  g_assert_null (take (spool));
  finish (b, two);
  first = take (spool);
  g_assert_cmpstr (first, ==, "2");
  g_assert_null (take (spool));
  /* given back, another gets it */
  g_assert_true (cloth_spool_give_back (a, one, NULL));
  g_clear_pointer (&one, cloth_spool_job_free);
  g_assert_cmpstr (claim (b, &one), ==, "1");
  g_assert_true (cloth_spool_finish (b, one, "{\"error\": \"so\"}", TRUE,
          NULL));
  {
    g_autoptr (ClothSpoolJob) result = cloth_spool_take (spool, NULL);

    if (!result)
      result = cloth_spool_take (spool, NULL);
    g_assert_true (result->failed);
    g_assert_cmpstr (result->json, ==, "{\"error\": \"so\"}");
  }
  g_assert_true (cloth_spool_close (spool, NULL));
  g_assert_cmpint (cloth_spool_get_state (a), ==, CLOTH_SPOOL_CLOSED);
  g_assert_cmpuint (count (f, "running") + count (f, "todo"), ==, 0);
}

/* ---- processes ---- */

/* A worker process that claims a job, says so, and works on it for ever. */
static GPid
start_worker (Fixture * f)
{
  const pid_t pid = fork ();

  if (pid == 0) {
    ClothSpool *worker = cloth_spool_join (f->folder, &options, 0., NULL);

    if (!worker || !cloth_spool_claim (worker, NULL))
      _exit (1);
    for (;;)
      g_usleep (G_USEC_PER_SEC);
  }
  while (count (f, "running") == 0)
    g_usleep (1000);
  return pid;
}

static void
test_killed_worker (Fixture * f, gconstpointer data)
{
  g_autoptr (ClothSpool) spool = manage (f, FALSE);
  gdouble took_s;
  GPid pid;

  put (spool, "1");
  pid = start_worker (f);
  g_usleep (G_USEC_PER_SEC * 3 / 2);
  g_assert_true (cloth_spool_look_after (spool, NULL));
  g_assert_cmpuint (cloth_spool_get_n_lost (spool), ==, 0);
  kill (pid, SIGKILL);
  waitpid (pid, NULL, 0);
  took_s = wait_for_lost (spool, 1);
  g_test_message ("put back %.2f s after SIGKILL", took_s);
  /* the lock tells, long before the number has been silent for long */
  g_assert_cmpfloat (took_s, <, LOST_S);
  {
    g_autoptr (ClothSpool) other = join (f);
    g_autoptr (ClothSpoolJob) job = NULL;
    g_autofree gchar *got = NULL;

    g_assert_cmpstr (claim (other, &job), ==, "1");
    finish (other, job);
    got = take (spool);
    g_assert_cmpstr (got, ==, "1");
  }
}

/* Stopped, it gives no sign of life; then it goes on and ends its job, which another has done
 * meanwhile. */
static void
test_late_worker (Fixture * f, gconstpointer data)
{
  g_autoptr (ClothSpool) spool = manage (f, FALSE);
  g_autoptr (ClothSpool) late = NULL;
  g_autoptr (ClothSpool) other = NULL;
  g_autoptr (ClothSpoolJob) its = NULL;
  g_autoptr (ClothSpoolJob) job = NULL;
  g_autofree gchar *got = NULL;
  GPid pid;

  put (spool, "1");
  pid = start_worker (f);
  kill (pid, SIGSTOP);
  g_assert_cmpfloat (wait_for_lost (spool, 1), >=, LOST_S);
  kill (pid, SIGKILL);
  waitpid (pid, NULL, 0);

  /* The same with both at hand: the first result stays. */
  late = join (f);
  g_assert_cmpstr (claim (late, &its), ==, "1");
  {
    g_autofree gchar *todo = g_build_filename (f->folder, "todo/1.json", NULL);

    g_assert_true (g_file_set_contents (todo, its->json, -1, NULL));
  }
  other = join (f);
  g_assert_cmpstr (claim (other, &job), ==, "1");
  finish (other, job);
  g_assert_true (cloth_spool_finish (late, its, "{\"of\": \"late\"}", FALSE,
          NULL));
  got = take (spool);
  g_assert_cmpstr (got, ==, "1");
  g_assert_null (take (spool));
  g_assert_cmpuint (count (f, "running") + count (f, "todo"), ==, 0);
}

static void
test_deadly_job (Fixture * f, gconstpointer data)
{
  g_autoptr (ClothSpool) spool = manage (f, FALSE);
  g_autoptr (ClothSpoolJob) result = NULL;

  put (spool, "1");
  for (guint i = 0; i < CLOTH_SPOOL_MOST_LOST; i++) {
    GPid pid = start_worker (f);

    kill (pid, SIGKILL);
    waitpid (pid, NULL, 0);
    if (i + 1 < CLOTH_SPOOL_MOST_LOST)
      wait_for_lost (spool, i + 1);
  }
  while (!(result = cloth_spool_take (spool, NULL)))
    g_assert_true (cloth_spool_look_after (spool, NULL));
  g_assert_true (result->failed);
  g_assert_nonnull (strstr (result->json, "3 workers were lost"));
}

/* Who waits for the results of many jobs doesn't look for each of them: on a file system of a network that takes longer
 * than the jobs. */
static void
test_many_jobs (Fixture * f, gconstpointer data)
{
  g_autoptr (ClothSpool) spool = manage (f, FALSE);
  g_autoptr (ClothSpool) worker = join (f);
  g_autoptr (ClothSpoolJob) job = NULL;
  g_autofree gchar *first = NULL;
  gint64 begin;

  for (guint i = 0; i < 3000; i++) {
    g_autofree gchar *id = g_strdup_printf ("%04u", i);

    put (spool, id);
  }
  begin = g_get_monotonic_time ();
  for (guint i = 0; i < 1000; i++)
    g_assert_null (cloth_spool_take (spool, NULL));
  g_test_message ("%.2f ms to look for results",
      1e-6 * (gdouble) (g_get_monotonic_time () - begin));
  g_assert_cmpint (g_get_monotonic_time () - begin, <, G_USEC_PER_SEC);
  claim (worker, &job);
  finish (worker, job);
  first = take (spool);
  g_assert_cmpstr (first, ==, "0000");
}

/* The last of many results is found among them, too. */
static void
test_many_results (Fixture * f, gconstpointer data)
{
  g_autoptr (ClothSpool) spool = manage (f, FALSE);
  g_autoptr (ClothSpool) worker = join (f);

  for (guint i = 0; i < 400; i++) {
    g_autofree gchar *id = g_strdup_printf ("%04u", i);

    put (spool, id);
  }
  for (guint i = 0; i < 400; i++) {
    g_autoptr (ClothSpoolJob) job = NULL;
    g_autofree gchar *id = g_strdup_printf ("%04u", i);
    g_autofree gchar *got = NULL;

    g_assert_cmpstr (claim (worker, &job), ==, id);
    finish (worker, job);
    got = take (spool);
    g_assert_cmpstr (got, ==, id);
  }
  g_assert_null (take (spool));
}

/* ---- other hosts ---- */

/* A worker of a host whose locks can't be seen: only its number speaks. Times of files are from
 * another age, as clocks of hosts may be. */
static void
test_other_host (Fixture * f, gconstpointer data)
{
  g_autoptr (ClothSpool) spool = manage (f, FALSE);
  g_autofree gchar *beat = g_build_filename (f->folder, "beats",
      "otherone-7-1", NULL);
  const gint64 begin = g_get_monotonic_time ();
  gdouble took_s;

  put (spool, "1");
  {
    g_autofree gchar *from = g_build_filename (f->folder, "todo/1.json", NULL);
    g_autofree gchar *to = g_build_filename (f->folder, "running",
        "1@otherone-7-1", NULL);

    g_assert_cmpint (g_rename (from, to), ==, 0);
  }
  for (guint i = 0; g_get_monotonic_time () - begin < 3 * LOST_S *
      G_USEC_PER_SEC; i++) {
    const struct utimbuf old = { i % 2 ? 0 : 4000000000, i % 2 ? 0 : 4000000000
    };
    g_autofree gchar *text = g_strdup_printf ("%020u\n", i);

    g_assert_true (g_file_set_contents (beat, text, -1, NULL));
    utime (beat, &old);
    g_assert_true (cloth_spool_look_after (spool, NULL));
    g_usleep (G_USEC_PER_SEC / 5);
  }
  g_assert_cmpuint (cloth_spool_get_n_lost (spool), ==, 0);
  took_s = wait_for_lost (spool, 1);
  g_test_message ("put back %.2f s after the last sign of life", took_s);
  g_assert_cmpfloat (took_s, >=, LOST_S - 1.3);
  g_assert_cmpfloat (took_s, <, LOST_S + 2.5);
}

/* ---- managers ---- */

static void
expect_refused (Fixture * f, const ClothSpoolOptions * its,
    const gchar * problem, gboolean resume, const gchar * text)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothSpool) spool = cloth_spool_manage (f->folder, its, problem,
      resume, &error);

  g_assert_null (spool);
  g_test_message ("%s", error->message);
  g_assert_nonnull (strstr (error->message, text));
}

static void
test_two_managers (Fixture * f, gconstpointer data)
{
  g_autoptr (ClothSpool) spool = manage (f, FALSE);
  g_autofree gchar *self = g_strdup_printf ("process %d on ", (gint) getpid ());

  expect_refused (f, &options, "p", TRUE, self);
  g_assert_true (cloth_spool_look_after (spool, NULL));
  g_clear_pointer (&spool, cloth_spool_free);
  /* let go, it is free at once */
  spool = manage (f, TRUE);
}

static void
test_killed_manager (Fixture * f, gconstpointer data)
{
  const pid_t pid = fork ();
  g_autoptr (ClothSpool) spool = NULL;
  g_autoptr (ClothSpool) worker = NULL;
  g_autoptr (ClothSpoolJob) job = NULL;
  g_autofree gchar *first = NULL, *second = NULL;
  gint64 begin;

  if (pid == 0) {
    ClothSpool *its = cloth_spool_manage (f->folder, &options, "p", FALSE,
        NULL);

    if (!its || !cloth_spool_put (its, "1", "{\"do\": \"1\"}", FALSE, NULL) ||
        !cloth_spool_put (its, "2", "{\"do\": \"2\"}", FALSE, NULL))
      _exit (1);
    for (;;)
      g_usleep (G_USEC_PER_SEC);
  }
  while (count (f, "todo") < 2)
    g_usleep (1000);
  worker = join (f);
  g_assert_cmpstr (claim (worker, &job), ==, "1");
  expect_refused (f, &options, "p", TRUE, "is managed by process");
  kill (pid, SIGKILL);
  waitpid (pid, NULL, 0);
  finish (worker, job);
  begin = g_get_monotonic_time ();
  spool = manage (f, TRUE);
  g_assert_cmpint (g_get_monotonic_time () - begin, <, G_USEC_PER_SEC);
  put (spool, "1");
  put (spool, "2");
  first = take (spool);
  g_assert_cmpstr (first, ==, "1");
  g_clear_pointer (&job, cloth_spool_job_free);
  g_assert_cmpstr (claim (worker, &job), ==, "2");
  finish (worker, job);
  second = take (spool);
  g_assert_cmpstr (second, ==, "2");
}

/* A manager of another host: while its number changes it lives. */
static void
test_other_hosts_manager (Fixture * f, gconstpointer data)
{
  g_autoptr (ClothSpool) spool = NULL;
  pid_t pid;
  gint64 begin;

  g_clear_pointer (&spool, cloth_spool_free);
  spool = manage (f, FALSE);
  g_clear_pointer (&spool, cloth_spool_free);
  write_file (f, "manager.json",
      "{\"name\": \"otherone-7-1\", \"holder\": \"process 7 on far\"}");
  pid = fork ();
  if (pid == 0) {
    for (guint i = 0;; i++) {
      g_autofree gchar *text = g_strdup_printf ("%020u\n", i);

      write_file (f, "beats/otherone-7-1", text);
      g_usleep (G_USEC_PER_SEC / 4);
    }
  }
  g_usleep (G_USEC_PER_SEC / 4);
  expect_refused (f, &options, "p", TRUE, "process 7 on far");
  kill (pid, SIGKILL);
  waitpid (pid, NULL, 0);
  begin = g_get_monotonic_time ();
  spool = manage (f, TRUE);
  g_assert_cmpint (g_get_monotonic_time () - begin, >=,
      (gint64) (LOST_S * G_USEC_PER_SEC));
  /* one that took over unseen is noticed */
  write_file (f, "manager.json",
      "{\"name\": \"otherone-7-1\", \"holder\": \"process 7 on far\"}");
  {
    g_autoptr (GError) error = NULL;

    g_assert_false (cloth_spool_look_after (spool, &error));
    g_assert_error (error, G_IO_ERROR, G_IO_ERROR_BUSY);
  }
}

static void
test_abandoned (Fixture * f, gconstpointer data)
{
  g_autoptr (ClothSpool) spool = manage (f, FALSE);
  g_autoptr (ClothSpool) worker = join (f);
  const gint64 begin = g_get_monotonic_time ();

  g_clear_pointer (&spool, cloth_spool_free);
  while (cloth_spool_get_state (worker) == CLOTH_SPOOL_OPEN)
    cloth_spool_wait (worker);
  g_assert_cmpint (cloth_spool_get_state (worker), !=, CLOTH_SPOOL_CLOSED);
  g_assert_cmpint (g_get_monotonic_time () - begin, >=,
      (gint64) (LOST_S * G_USEC_PER_SEC));
}

/* ---- what others wrote ---- */

static void
test_other_versions (Fixture * f, gconstpointer data)
{
  static const ClothSpoolOptions other = { "fit", "0.1", LOST_S };
  static const ClothSpoolOptions newer = { "test", "0.2", LOST_S };
  static const struct
  {
    const gchar *json, *text;
  } cases[] = {
    {"{\"version\": 2}", "version 2 is another program's"},
    {"{\"version\": 1, \"kind\": 3}", "kind"},
    {"{\"version\": 1, \"colour\": 3}", "colour"},
    {"{", "not JSON"},
    {"", "not JSON"},
    {"{\"version\": 1, \"kind\": \"test\"}", "version none"},
  };
  g_autoptr (ClothSpool) spool = manage (f, FALSE);
  g_autoptr (GError) error = NULL;

  g_clear_pointer (&spool, cloth_spool_free);
  expect_refused (f, &options, "p", FALSE, "a spool already");
  expect_refused (f, &options, "q", TRUE, "other inputs");
  expect_refused (f, &other, "p", TRUE,
      "of the kind “test”, not “fit”");
  expect_refused (f, &newer, "p", TRUE, "version 0.1 of the program");
  g_assert_null (cloth_spool_join (f->folder, &newer, 0., &error));
  g_assert_nonnull (strstr (error->message, "version 0.1 of the program"));
  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (GError) its = NULL;

    write_file (f, "spool.json", cases[i].json);
    expect_refused (f, &options, "p", TRUE, cases[i].text);
    g_assert_null (cloth_spool_join (f->folder, &options, 0., &its));
    g_assert_nonnull (strstr (its->message, cases[i].text));
  }
  {
    g_autofree gchar *nowhere = g_build_filename (f->folder, "none", NULL);
    g_autoptr (GError) its = NULL;

    g_assert_null (cloth_spool_join (nowhere, &options, 0.1, &its));
    g_assert_error (its, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
  }
}

static void
test_hostile_files (Fixture * f, gconstpointer data)
{
  g_autoptr (ClothSpool) spool = manage (f, FALSE);
  g_autoptr (ClothSpool) worker = join (f);
  g_autoptr (ClothSpoolJob) job = NULL;
  g_autoptr (ClothSpoolJob) none = NULL;
  g_autoptr (GError) error = NULL;
  g_autofree gchar *got = NULL;

  put (spool, "1");
  put (spool, "2");
  write_file (f, "todo/1.json", "{\"do\": ");
  write_file (f, "todo/..json", "{}");
  write_file (f, "todo/0 0.json", "{}");
  write_file (f, "todo/0", "{}");
  write_file (f, "running/none", "{}");
  write_file (f, "running/../running/@", "{}");
  write_file (f, "running/a@..", "{}");
  /* the job that nobody can read has failed, and no other is kept from being done */
  g_assert_cmpstr (claim (worker, &job), ==, "2");
  g_assert_null (claim (worker, &none));
  finish (worker, job);
  {
    g_autoptr (ClothSpoolJob) bad = cloth_spool_take (spool, &error);

    g_assert_no_error (error);
    if (!bad)
      bad = cloth_spool_take (spool, NULL);
    g_assert_true (bad->failed);
    g_assert_nonnull (strstr (bad->json, "not JSON"));
  }
  got = take (spool);
  g_assert_cmpstr (got, ==, "2");
  /* left half by a computer that lost its power: the job is there again */
  write_file (f, "done/4.json", "");
  put (spool, "4");
  g_assert_cmpuint (count (f, "done"), ==, 1);
  g_clear_pointer (&job, cloth_spool_job_free);
  g_assert_cmpstr (claim (worker, &job), ==, "4");
  g_assert_cmpstr (job->json, ==, "{\"do\": \"4\"}");
  put (spool, "3");
  write_file (f, "done/3.json", "[]");
  g_assert_null (cloth_spool_take (spool, &error));
  if (!error)
    g_assert_null (cloth_spool_take (spool, &error));
  g_assert_nonnull (strstr (error->message, "remove it"));
  g_assert_true (cloth_spool_look_after (spool, NULL));
}

/* ---- a search over it ---- */

static gdouble
bowl (gpointer data, const gdouble * x, guint worker)
{
  g_usleep (2000);
  return x[0] > 3. ? NAN : pow (x[0] - 1., 2.) + 2. * pow (x[1] + 0.5, 2.) +
      0.5 * x[0] * x[1];
}

static ClothSearch *
new_search (gboolean as_they_come)
{
  static const gdouble start[2] = { 2.5, 2.5 };
  ClothSearchOptions its;

  cloth_search_options_init (&its);
  its.n = 2;
  its.start = start;
  its.tolerance = 1e-3;
  its.least_step = 2e-3;
  its.same = 1e-6;
  its.decrease = 0.;
  its.as_they_come = as_they_come;
  return cloth_search_new (&its, NULL);
}

static pid_t
start_evaluating (Fixture * f, ClothSearchFunc func)
{
  const pid_t pid = fork ();

  if (pid == 0) {
    ClothSpool *worker = cloth_spool_join (f->folder, &options, 5., NULL);
    const gboolean good = worker && cloth_search_work_spool (worker, 2, func,
        NULL, NULL);

    cloth_spool_free (worker);
    _exit (good ? 0 : 1);
  }
  return pid;
}

/* Two workers, of which one is killed, and a manager that is killed and resumed: the same log as
 * that of one thread. What was killed while it wrote may leave its temporary file, which is no result. */
static void
test_search (Fixture * f, gconstpointer data)
{
  g_autoptr (ClothSearch) one = new_search (FALSE);
  g_autoptr (ClothSearch) s = new_search (FALSE);
  g_autoptr (ClothSpool) spool = NULL;
  g_autoptr (GError) error = NULL;
  pid_t manager, workers[2];
  gint status = -1;

  cloth_search_run (one, bowl, NULL, 1);
  manager = fork ();
  if (manager == 0) {
    ClothSpool *its = cloth_spool_manage (f->folder, &options, "p", FALSE,
        NULL);

    cloth_search_run_spool (new_search (FALSE), its, NULL);
    _exit (1);
  }
  for (guint i = 0; i < 2; i++)
    workers[i] = start_evaluating (f, bowl);
  while (count_ending (f, "done", ".json") < 15)
    g_usleep (1000);
  kill (workers[0], SIGKILL);
  kill (manager, SIGKILL);
  waitpid (workers[0], NULL, 0);
  waitpid (manager, NULL, 0);
  g_assert_cmpuint (count_ending (f, "done", ".json"), <,
      cloth_search_get_counts (one).n_decided);
  spool = manage (f, TRUE);
  g_assert_true (cloth_search_run_spool (s, spool, &error));
  g_assert_no_error (error);
  waitpid (workers[1], &status, 0);
  g_assert_cmpint (status, ==, 0);
  g_assert_cmpstr (cloth_search_get_log (s), ==, cloth_search_get_log (one));
  g_assert_cmpuint (count_ending (f, "done", ".json"), ==,
      cloth_search_get_counts (one).n_decided);
}

static gdouble
deadly_start (gpointer data, const gdouble * x, guint worker)
{
  if (x[0] == 2.5 && x[1] == 2.5)
    raise (SIGKILL);
  return bowl (data, x, worker);
}

/* A trial whose workers were all killed is not one without a value: the search says so and, resumed, finds what it
 * would have found. */
static void
test_search_deadly_trial (Fixture * f, gconstpointer data)
{
  g_autoptr (ClothSearch) one = new_search (FALSE);
  g_autoptr (ClothSearch) s = new_search (FALSE);
  g_autoptr (ClothSearch) again = new_search (FALSE);
  g_autoptr (ClothSpool) spool = manage (f, FALSE);
  g_autoptr (GError) error = NULL;
  pid_t worker;

  cloth_search_run (one, bowl, NULL, 1);
  worker = fork ();
  if (worker == 0) {
    for (guint i = 0; i < CLOTH_SPOOL_MOST_LOST; i++)
      waitpid (start_evaluating (f, deadly_start), NULL, 0);
    while (count_ending (f, "failed", ".json") == 0)
      g_usleep (1000);
    worker = start_evaluating (f, bowl);
    waitpid (worker, NULL, 0);
    _exit (0);
  }
  g_assert_false (cloth_search_run_spool (s, spool, &error));
  g_assert_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_SEARCH);
  g_assert_nonnull (strstr (error->message, "3 workers were lost"));
  g_clear_error (&error);
  g_clear_pointer (&spool, cloth_spool_free);
  spool = manage (f, TRUE);
  g_assert_true (cloth_search_run_spool (again, spool, &error));
  g_assert_no_error (error);
  waitpid (worker, NULL, 0);
  g_assert_cmpstr (cloth_search_get_log (again), ==,
      cloth_search_get_log (one));
}

/* Ends @n trials, of those that are there the last one first. */
static void
evaluate_backwards (Fixture * f, guint n)
{
  g_autoptr (ClothSpool) worker = cloth_spool_join (f->folder, &options, 5.,
      NULL);
  g_autoptr (GPtrArray) jobs =
      g_ptr_array_new_with_free_func ((GDestroyNotify) cloth_spool_job_free);

  for (guint i = 0; i < n; i++) {
    gchar number[G_ASCII_DTOSTR_BUF_SIZE], *end;
    g_autofree gchar *json = NULL;
    const ClothSpoolJob *last;
    gdouble point[2];

    /* there are four, as soon as the manager has decided on what came */
    for (guint tries = 0; jobs->len == 0 || (jobs->len < 4 && tries < 300);
        tries++) {
      ClothSpoolJob *job = cloth_spool_claim (worker, NULL);

      if (job)
        g_ptr_array_add (jobs, job);
      else
        g_usleep (1000);
    }
    last = jobs->pdata[jobs->len - 1];
    point[0] = g_ascii_strtod (strchr (last->json, '[') + 1, &end);
    point[1] = g_ascii_strtod (end + 1, NULL);
    g_ascii_dtostr (number, sizeof number, bowl (NULL, point, 0));
    json = g_strdup_printf ("{\"value\": [%s]}", point[0] > 3. ? "" : number);
    g_assert_true (cloth_spool_finish (worker, last, json, FALSE, NULL));
    g_ptr_array_remove_index (jobs, jobs->len - 1);
  }
  for (guint i = 0; i < jobs->len; i++)
    g_assert_true (cloth_spool_give_back (worker, jobs->pdata[i], NULL));
}

/* A search as they come, whose manager is killed and resumed: each value is that of its point, though
 * no one else knows which point had which number. */
static void
test_search_as_they_come (Fixture * f, gconstpointer data)
{
  g_autoptr (ClothSearch) s = new_search (TRUE);
  g_autoptr (ClothSpool) spool = NULL;
  g_autoptr (GError) error = NULL;
  g_auto (GStrv) lines = NULL;
  pid_t manager, worker;

  manager = fork ();
  if (manager == 0) {
    cloth_search_run_spool (new_search (TRUE), cloth_spool_manage (f->folder,
            &options, "p", FALSE, NULL), NULL);
    _exit (1);
  }
  evaluate_backwards (f, 20);
  kill (manager, SIGKILL);
  waitpid (manager, NULL, 0);
  worker = start_evaluating (f, bowl);
  spool = manage (f, TRUE);
  g_assert_true (cloth_search_run_spool (s, spool, &error));
  g_assert_no_error (error);
  waitpid (worker, NULL, 0);
  lines = g_strsplit (cloth_search_get_log (s), "\n", -1);
  for (guint i = 1; *lines[i]; i++) {
    gchar *end;
    const gdouble value = g_ascii_strtod (strchr (lines[i], ' '), &end);
    gdouble point[2];

    point[0] = g_ascii_strtod (end, &end);
    point[1] = g_ascii_strtod (end, &end);
    if (isfinite (value))
      g_assert_cmpfloat (value, ==, bowl (NULL, point, 0));
    else
      g_assert_true (point[0] > 3.);
  }
}

#define ADD(name, function) \
  g_test_add ("/spool/" name, Fixture, NULL, set_up, function, tear_down)

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  ADD ("jobs", test_jobs);
  ADD ("killed-worker", test_killed_worker);
  ADD ("late-worker", test_late_worker);
  ADD ("deadly-job", test_deadly_job);
  ADD ("many-jobs", test_many_jobs);
  ADD ("many-results", test_many_results);
  ADD ("other-host", test_other_host);
  ADD ("two-managers", test_two_managers);
  ADD ("killed-manager", test_killed_manager);
  ADD ("other-hosts-manager", test_other_hosts_manager);
  ADD ("abandoned", test_abandoned);
  ADD ("other-versions", test_other_versions);
  ADD ("hostile-files", test_hostile_files);
  ADD ("search", test_search);
  ADD ("search-deadly-trial", test_search_deadly_trial);
  ADD ("search-as-they-come", test_search_as_they_come);
  return g_test_run ();
}
