/* Who evaluates the trials of a pattern search: threads, or the workers of a spool.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/search/evaluate.h"

#include <math.h>
#include <string.h>

#include "gst/file/json.h"
#include "gst/file/jsonwriter.h"
#include "gst/fit/error.h"

/* ---- threads ---- */

typedef struct
{
  ClothSearch *search;
  ClothSearchFunc func;
  gpointer data;
  GMutex mutex;                 /* of the search */
  GCond told;
  gint n_workers;
} Shared;

static gpointer
evaluate_trials (gpointer data)
{
  Shared *shared = data;
  const guint worker = (guint) g_atomic_int_add (&shared->n_workers, 1);
  g_autofree gdouble *point = g_new (gdouble,
      cloth_search_get_n (shared->search));
  guint id;

  g_mutex_lock (&shared->mutex);
  while (cloth_search_get_state (shared->search) == CLOTH_SEARCH_RUNS) {
    gdouble value;

    if (!cloth_search_next (shared->search, &id, point)) {
      g_cond_wait (&shared->told, &shared->mutex);
      continue;
    }
    g_mutex_unlock (&shared->mutex);
    value = shared->func (shared->data, point, worker);
    g_mutex_lock (&shared->mutex);
    cloth_search_tell (shared->search, id, value);
    g_cond_broadcast (&shared->told);
  }
  g_mutex_unlock (&shared->mutex);
  return NULL;
}

/* @search: a search; it has ended then
 * @func: what is searched
 * @data: for @func
 * @threads: how many evaluate at once, 1 or more
 */
void
cloth_search_run (ClothSearch * search, ClothSearchFunc func, gpointer data,
    guint threads)
{
  Shared shared = {.search = search,.func = func,.data = data };
  g_autofree GThread **others = g_new0 (GThread *, threads);

  g_mutex_init (&shared.mutex);
  g_cond_init (&shared.told);
  for (guint i = 1; i < threads; i++)
    others[i] = g_thread_new ("search", evaluate_trials, &shared);
  evaluate_trials (&shared);
  for (guint i = 1; i < threads; i++)
    g_thread_join (others[i]);
  g_mutex_clear (&shared.mutex);
  g_cond_clear (&shared.told);
}

/* ---- a spool ---- */

static const ClothJsonFile job_file = {
  "a trial", cloth_fit_error_quark, CLOTH_FIT_ERROR_SEARCH
};

static gchar *
write_numbers (const gchar * key, const gdouble * values, guint n)
{
  g_autoptr (ClothJsonWriter) writer = cloth_json_writer_new ();

  cloth_json_writer_set_exact (writer);
  cloth_json_writer_set_one_line (writer, TRUE);
  cloth_json_writer_begin_object (writer, NULL);
  cloth_json_writer_numbers (writer, key, values, n);
  cloth_json_writer_end_object (writer);
  return cloth_json_writer_finish (writer);
}

/* A list of @n numbers, or of none. */
static gboolean
read_numbers (const gchar * json, const gchar * key, guint n, gdouble * values,
    gboolean * empty, GError ** error)
{
  g_autoptr (JsonParser) parser = cloth_json_parse (json, strlen (json), error);
  JsonArray *list;
  gboolean bad = FALSE;

  if (!parser)
    return FALSE;
  list = cloth_json_get_list (&job_file,
      json_node_get_object (json_parser_get_root (parser)), key, n, &bad,
      error);
  if (bad)
    return FALSE;
  *empty = list && json_array_get_length (list) == 0;
  if (!list || (!*empty && json_array_get_length (list) != n))
    return cloth_json_invalid (&job_file, error, "“%s” must be %u numbers",
        key, n);
  for (guint i = 0; i < n && !*empty; i++)
    if (!cloth_json_number (json_array_get_element (list, i), &values[i]))
      return cloth_json_invalid (&job_file, error, "“%s” must be numbers",
          key);
  return TRUE;
}

static gboolean
put_trials (ClothSearch * search, ClothSpool * spool, gdouble * point,
    GError ** error)
{
  guint id;

  while (cloth_search_next (search, &id, point)) {
    g_autofree gchar *name = g_strdup_printf ("%07u", id);
    g_autofree gchar *json = write_numbers ("point", point,
        cloth_search_get_n (search));

    if (!cloth_spool_put (spool, name, json, TRUE, error))
      return FALSE;
  }
  return TRUE;
}

/* Which trial has which number follows from the order of decisions, which results don't tell: who
 * resumes a search that decides as values come needs its log. It is noted before jobs are put that
 * follow from it.
 * @noted: (inout): bytes of the log that are noted */
static gboolean
note_decisions (const ClothSearch * search, ClothSpool * spool, gsize * noted,
    GError ** error)
{
  const gchar *lines = cloth_search_get_log (search) + *noted;

  *noted += strlen (lines);
  return !cloth_search_is_as_they_come (search) || !*lines
      || cloth_spool_note (spool, lines, error);
}

static gboolean
go_on_from_notes (ClothSearch * search, ClothSpool * spool, gsize * noted,
    GError ** error)
{
  g_autofree gchar *log = NULL;

  *noted = 0;
  if (!cloth_search_is_as_they_come (search))
    return TRUE;
  log = cloth_spool_begin_notes (spool, error);
  if (!log || (*log && !cloth_search_replay (search, log, error)))
    return FALSE;
  *noted = strlen (log);
  return TRUE;
}

static gboolean
tell_failure (const ClothSpoolJob * job, GError ** error)
{
  g_autoptr (JsonParser) parser = cloth_json_parse (job->json,
      strlen (job->json), NULL);
  g_autofree gchar *why = NULL;

  if (parser)
    cloth_json_get_string (&job_file,
        json_node_get_object (json_parser_get_root (parser)), "error", &why,
        NULL);
  g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_SEARCH,
      "pattern search: point %s was not evaluated: %s; resume the search to "
      "try it again", job->id, why ? why : "nobody says why");
  return FALSE;
}

/* @search: a search; it has ended then
 * @spool: a manager's, whose workers call cloth_search_work_spool ()
 * @error: of the spool; %CLOTH_FIT_ERROR_SEARCH: a result is none, or a trial ended its workers
 *
 * A resumed spool has the values of trials that were evaluated before the manager was killed, and, of a search
 * as they come, its log: the search takes them without more ado.
 *
 * Returns: whether it could be done
 */
gboolean
cloth_search_run_spool (ClothSearch * search, ClothSpool * spool,
    GError ** error)
{
  g_autofree gdouble *point = g_new (gdouble, cloth_search_get_n (search));
  gsize noted;

  if (!go_on_from_notes (search, spool, &noted, error))
    return FALSE;
  while (cloth_search_get_state (search) == CLOTH_SEARCH_RUNS) {
    g_autoptr (ClothSpoolJob) job = NULL;
    GError *fault = NULL;
    gdouble value = NAN;
    gboolean empty = TRUE;

    if (!note_decisions (search, spool, &noted, error) ||
        !put_trials (search, spool, point, error) ||
        !cloth_spool_look_after (spool, error))
      return FALSE;
    job = cloth_spool_take (spool, &fault);
    if (fault) {
      g_propagate_error (error, fault);
      return FALSE;
    }
    if (!job) {
      cloth_spool_wait (spool);
      continue;
    }
    /* Whether a worker is killed must not change what is found: a trial that none could end is
     * not one without a value, which has an empty list. */
    if (job->failed)
      return tell_failure (job, error);
    if (!read_numbers (job->json, "value", 1, &value, &empty, error))
      return FALSE;
    cloth_search_tell (search,
        (guint) g_ascii_strtoull (job->id, NULL, 10), empty ? NAN : value);
  }
  return note_decisions (search, spool, &noted, error)
      && cloth_spool_close (spool, error);
}

static gboolean
evaluate_job (ClothSpool * spool, const ClothSpoolJob * job, guint n,
    ClothSearchFunc func, gpointer data, GError ** error)
{
  g_autofree gdouble *point = g_new (gdouble, n);
  g_autofree gchar *json = NULL;
  gdouble value;
  gboolean empty;

  if (!read_numbers (job->json, "point", n, point, &empty, error))
    return FALSE;
  if (empty)
    return cloth_json_invalid (&job_file, error, "“point” is empty");
  value = func (data, point, 0);
  json = write_numbers ("value", &value, isfinite (value) ? 1 : 0);
  return cloth_spool_finish (spool, job, json, FALSE, error);
}

/* @spool: a worker's
 * @n: number of unknowns
 * @func: what is searched, called by one thread
 * @data: for @func
 * @error: of the spool: what was claimed is given back
 *
 * Evaluates trials until there are no more.
 *
 * Returns: whether it could
 */
gboolean
cloth_search_work_spool (ClothSpool * spool, guint n, ClothSearchFunc func,
    gpointer data, GError ** error)
{
  for (;;) {
    GError *fault = NULL;
    g_autoptr (ClothSpoolJob) job = cloth_spool_claim (spool, &fault);

    if (fault) {
      g_propagate_error (error, fault);
      return FALSE;
    }
    if (job && !evaluate_job (spool, job, n, func, data, error)) {
      cloth_spool_give_back (spool, job, NULL);
      return FALSE;
    }
    if (!job && cloth_spool_get_state (spool) != CLOTH_SPOOL_OPEN)
      return TRUE;
    if (!job)
      cloth_spool_wait (spool);
  }
}
