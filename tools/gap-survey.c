/* gst-cloth-gap-1.0 survey: many takes diagnosed by the workers of a spool, one table.
 *
 * Each job is a child process that diagnoses, so that what ends one ends no worker. A job names
 * inputs only; what is run and where it writes is not in it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "config.h"

#include "tools/gap-tool.h"

#include <gio/gio.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>

#include "gst/file/file.h"
#include "gst/file/hash.h"
#include "gst/file/json.h"
#include "gst/file/jsonwriter.h"
#include "gst/file/output.h"
#include "gst/file/spool.h"
#include "gst/gap/inputs.h"
#include "gst/gap/survey/survey.h"
#include "tools/gap-survey-list.h"

/* Seconds that a worker waits for its manager, who may start later. */
#define JOIN_S 120.
#define MAX_PATHS 1000u

static const ClothSpoolOptions spool_options = {
  "survey", PACKAGE_VERSION, CLOTH_SPOOL_LOST_S
};

static const ClothJsonFile job_file = {
  "the job", cloth_file_error_quark, CLOTH_FILE_ERROR_INVALID
};

/* In a child: it ends with its parent, which is what @data says. */
static void
end_with_parent (gpointer data)
{
  prctl (PR_SET_PDEATHSIG, GPOINTER_TO_INT (data));
}

static gchar *
find_program (GError ** error)
{
  return g_file_read_link ("/proc/self/exe", error);
}

/* ---- a worker ---- */

static gboolean
add_paths (JsonObject * job, const gchar * key, const gchar * option,
    GPtrArray * words, GError ** error)
{
  gboolean bad;
  JsonArray *list = cloth_json_get_list (&job_file, job, key, MAX_PATHS, &bad,
      error);

  for (guint i = 0; !bad && list && i < json_array_get_length (list); i++) {
    JsonNode *node = json_array_get_element (list, i);
    const gchar *path = JSON_NODE_HOLDS_VALUE (node) &&
        json_node_get_value_type (node) == G_TYPE_STRING ?
        json_node_get_string (node) : "";

    /* So it can be no option either. */
    if (!g_path_is_absolute (path))
      return cloth_json_invalid (&job_file, error, "“%s” must be absolute "
          "paths", key);
    if (*option)
      g_ptr_array_add (words, g_strdup (option));
    g_ptr_array_add (words, g_strdup (path));
  }
  return !bad;
}

/* The command line of a job. */
static GPtrArray *
make_words (const gchar * json, const gchar * output, gint threads,
    GError ** error)
{
  static const gchar *const lists[][2] = {
    {"take", ""}, {"model", "--model"}, {"baselines", "--baseline"},
    {"hold_outs", "--hold-out"}, {"simulated", "--simulated"},
    {"after", "--after"}
  };
  g_autoptr (GPtrArray) words = g_ptr_array_new_with_free_func (g_free);
  g_autoptr (JsonParser) parser = cloth_json_parse (json, strlen (json), error);
  g_autofree gchar *effects = NULL, *seed = NULL, *program = NULL;
  JsonObject *job;

  if (!parser || !(program = find_program (error)))
    return NULL;
  job = json_node_get_object (json_parser_get_root (parser));
  g_ptr_array_add (words, g_steal_pointer (&program));
  g_ptr_array_add (words, g_strdup ("diagnose"));
  for (guint i = 0; i < G_N_ELEMENTS (lists); i++)
    if (!add_paths (job, lists[i][0], lists[i][1], words, error))
      return NULL;
  if (!cloth_json_get_string (&job_file, job, "effects", &effects, error) ||
      !cloth_json_get_string (&job_file, job, "seed", &seed, error))
    return NULL;
  if (effects)
    g_ptr_array_add (words, g_strconcat ("--effects=", effects, NULL));
  g_ptr_array_add (words, g_strconcat ("--seed=", seed ? seed : "0", NULL));
  g_ptr_array_add (words, g_strdup_printf ("--threads=%d", threads));
  g_ptr_array_add (words, g_strconcat ("--output=", output, NULL));
  g_ptr_array_add (words, NULL);
  return g_steal_pointer (&words);
}

/* What a diagnosis says that failed, without its progress and without how commands are used. */
static gchar *
find_complaint (gchar * text)
{
  g_autofree gchar *valid = g_utf8_make_valid (text ? text : "", -1);
  const gchar *at = g_strrstr (valid, PROGRAM ": ");
  gchar *complaint = g_strdup (at ? at + strlen (PROGRAM ": ") : valid);
  gchar *usage = g_strrstr (complaint, "\nTry \"" PROGRAM);

  if (usage)
    *usage = 0;

  g_strdelimit (g_strstrip (complaint), "\n", ' ');
  return complaint;
}

/* Whether the disk is full, as far as a message tells: then the job is not to blame. */
static gboolean
tells_full (const gchar * message)
{
  return strstr (message, g_strerror (ENOSPC)) ||
      strstr (message, g_strerror (EDQUOT));
}

/* Runs the diagnosis. FALSE without an error: it failed, and @result says why. */
static gboolean
run_job (const ClothSpoolJob * job, const gchar * folder, gint threads,
    gchar ** result, GError ** error)
{
  g_autofree gchar *output = g_build_filename (folder, job->id, NULL);
  g_autofree gchar *path = g_build_filename (output, "gap.json", NULL);
  g_autoptr (GSubprocessLauncher) launcher =
      g_subprocess_launcher_new (G_SUBPROCESS_FLAGS_STDOUT_SILENCE |
      G_SUBPROCESS_FLAGS_STDERR_PIPE);
  g_autoptr (GPtrArray) words = make_words (job->json, output, threads, error);
  g_autoptr (GSubprocess) process = NULL;
  g_autofree gchar *told = NULL, *text = NULL;
  g_autoptr (GBytes) bytes = NULL;
  gsize length;

  g_subprocess_launcher_set_child_setup (launcher, end_with_parent,
      GINT_TO_POINTER (SIGKILL), NULL);
  process = words ? g_subprocess_launcher_spawnv (launcher,
      (const gchar * const *) words->pdata, error) : NULL;
  if (!process || !g_subprocess_communicate (process, NULL, NULL, NULL, &bytes,
          error))
    return FALSE;
  told = g_strndup (g_bytes_get_data (bytes, NULL), g_bytes_get_size (bytes));
  if (!g_subprocess_get_successful (process)) {
    g_autofree gchar *complaint = find_complaint (told);

    if (tells_full (complaint)) {
      g_set_error (error, G_IO_ERROR, G_IO_ERROR_NO_SPACE, "%s", complaint);
      return FALSE;
    }
    if (g_subprocess_get_if_signaled (process))
      *result = g_strdup_printf ("the diagnosis was ended by signal %d",
          g_subprocess_get_term_sig (process));
    else
      *result = g_steal_pointer (&complaint);
    return FALSE;
  }
  text = cloth_text_file_load (path, &length, error);
  *result = text ? cloth_survey_summarise (text, length, error) : NULL;
  return *result != NULL;
}

static gchar *
write_failure (const gchar * message)
{
  g_autoptr (ClothJsonWriter) writer = cloth_json_writer_new ();

  cloth_json_writer_begin_object (writer, NULL);
  cloth_json_writer_string (writer, "error", message);
  cloth_json_writer_end_object (writer);
  return cloth_json_writer_finish (writer);
}

/* Does a job. When the disk is full others may do it. */
static gboolean
do_job (ClothSpool * spool, const ClothSpoolJob * job, const gchar * folder,
    gint threads, GError ** error)
{
  g_autoptr (GError) fault = NULL;
  g_autofree gchar *result = NULL, *failure = NULL;
  gboolean good = run_job (job, folder, threads, &result, &fault);

  if (g_error_matches (fault, G_IO_ERROR, G_IO_ERROR_NO_SPACE)) {
    cloth_spool_give_back (spool, job, NULL);
    g_propagate_prefixed_error (error, g_steal_pointer (&fault),
        "job %s is given back: ", job->id);
    return FALSE;
  }
  if (!good)
    failure = write_failure (fault ? fault->message : result);
  if (cloth_spool_finish (spool, job, good ? result : failure, !good, error))
    return TRUE;
  cloth_spool_give_back (spool, job, NULL);
  g_prefix_error (error, "job %s is given back: ", job->id);
  return FALSE;
}

static gint
work (const Arguments * arguments)
{
  g_autofree gchar *folder = g_build_filename (arguments->spool, "reports",
      NULL);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothSpool) spool = cloth_spool_join (arguments->spool,
      &spool_options, JOIN_S, &error);

  while (spool && !error) {
    g_autoptr (ClothSpoolJob) job = cloth_spool_claim (spool, &error);

    if (job)
      do_job (spool, job, folder, MAX (arguments->threads, 1), &error);
    else if (error || cloth_spool_get_state (spool) != CLOTH_SPOOL_OPEN)
      break;
    else
      cloth_spool_wait (spool);
  }
  return error ? complain (FAILED, "%s", error->message) : DONE;
}

/* ---- the manager ---- */

typedef struct
{
  const Arguments *arguments;
  gchar *spool_folder;
  GPtrArray *lines;             /* GapSurveyLine */
  GPtrArray *jobs;              /* their texts */
  gchar *problem;
  ClothSpool *spool;
  GPtrArray *results;           /* ClothSpoolJob, by line; NULL: not yet */
  guint n_done, n_replaced;
  GPtrArray *workers;           /* GSubprocess */
} Survey;

static void
put_paths (ClothJsonWriter * writer, const gchar * key, GPtrArray * paths)
{
  cloth_json_writer_begin_array (writer, key);
  for (guint i = 0; i < paths->len; i++)
    cloth_json_writer_string (writer, NULL, paths->pdata[i]);
  cloth_json_writer_end_array (writer);
}

static gchar *
write_job (const GapSurveyLine * line, const Arguments * arguments)
{
  g_autoptr (ClothJsonWriter) writer = cloth_json_writer_new ();
  g_autofree gchar *cwd = g_get_current_dir ();
  g_autofree gchar *model = line->model ? g_strdup (line->model) :
      g_canonicalize_filename (arguments->model, cwd);
  g_autofree gchar *seed = g_strdup_printf ("%" G_GINT64_FORMAT,
      arguments->seed);
  const gchar *effects = line->effects ? line->effects : arguments->effects;

  cloth_json_writer_begin_object (writer, NULL);
  cloth_json_writer_begin_array (writer, "take");
  cloth_json_writer_string (writer, NULL, line->take);
  cloth_json_writer_end_array (writer);
  cloth_json_writer_begin_array (writer, "model");
  cloth_json_writer_string (writer, NULL, model);
  cloth_json_writer_end_array (writer);
  put_paths (writer, "baselines", line->baselines);
  put_paths (writer, "hold_outs", line->hold_outs);
  put_paths (writer, "simulated", line->simulated);
  put_paths (writer, "after", line->after);
  if (effects)
    cloth_json_writer_string (writer, "effects", effects);
  cloth_json_writer_string (writer, "seed", seed);
  cloth_json_writer_end_object (writer);
  return cloth_json_writer_finish (writer);
}

/* A line's model must be there, and its effects known: that is better known before the work. */
static gboolean
check_line (const Survey * s, const GapSurveyLine * line, GChecksum * sum,
    GError ** error)
{
  const gchar *model = line->model ? line->model : s->arguments->model;
  g_auto (GStrv) effects = NULL;
  g_autofree gchar *hash = NULL;
  GError *fault = NULL;

  if (!model)
    return cloth_file_invalid (error,
        "“%s” has no model: give --model, here " "or on its line",
        line->name);
  hash = cloth_file_sha256 (model, error);
  if (!hash)
    return FALSE;
  g_checksum_update (sum, (const guchar *) hash, -1);
  effects = cloth_gap_effects_parse (line->effects, &fault);
  if (fault)
    g_propagate_prefixed_error (error, fault, "“%s”: --effects: ",
        line->name);
  return fault == NULL;
}

/* Jobs, and the hash of all that makes them: list, models, options. */
static gboolean
make_jobs (Survey * s, const gchar * list, GError ** error)
{
  g_autoptr (GChecksum) sum = g_checksum_new (G_CHECKSUM_SHA256);

  g_checksum_update (sum, (const guchar *) list, -1);
  for (guint i = 0; i < s->lines->len; i++) {
    gchar *job;

    if (!check_line (s, s->lines->pdata[i], sum, error))
      return FALSE;
    job = write_job (s->lines->pdata[i], s->arguments);
    g_checksum_update (sum, (const guchar *) job, -1);
    g_ptr_array_add (s->jobs, job);
  }
  s->problem = g_strdup (g_checksum_get_string (sum));
  return TRUE;
}

static gboolean
load_list (Survey * s, GError ** error)
{
  const gchar *path = s->arguments->rest[1];
  g_autofree gchar *cwd = g_get_current_dir ();
  g_autofree gchar *absolute = g_canonicalize_filename (path, cwd);
  g_autofree gchar *folder = g_path_get_dirname (absolute);
  gsize length;
  g_autofree gchar *text = cloth_text_file_load (path, &length, error);

  if (!text)
    return FALSE;
  s->lines = gap_survey_list_parse (text, folder, error);
  if (!s->lines) {
    g_prefix_error (error, "%s: ", path);
    return FALSE;
  }
  return make_jobs (s, text, error);
}

static gchar *
job_id (guint line)
{
  return g_strdup_printf ("%05u", line + 1);
}

static gboolean
put_jobs (Survey * s, GError ** error)
{
  for (guint i = 0; i < s->jobs->len; i++) {
    g_autofree gchar *id = job_id (i);

    if (!cloth_spool_put (s->spool, id, s->jobs->pdata[i],
            s->arguments->resume, error))
      return FALSE;
    g_ptr_array_add (s->results, NULL);
  }
  return TRUE;
}

static gboolean
start_worker (Survey * s, GError ** error)
{
  g_autofree gchar *program = find_program (error);
  g_autofree gchar *threads = g_strdup_printf ("--threads=%d",
      s->arguments->threads);
  g_autoptr (GSubprocessLauncher) launcher =
      g_subprocess_launcher_new (G_SUBPROCESS_FLAGS_STDOUT_SILENCE);
  GSubprocess *process;

  if (!program)
    return FALSE;
  g_subprocess_launcher_set_child_setup (launcher, end_with_parent,
      GINT_TO_POINTER (SIGTERM), NULL);
  process = g_subprocess_launcher_spawn (launcher, error, program, "survey",
      "--worker", threads, "--spool", s->spool_folder, NULL);
  if (process)
    g_ptr_array_add (s->workers, process);
  return process != NULL;
}

static guint
count_workers (const Survey * s)
{
  if (s->arguments->workers >= 0)
    return (guint) s->arguments->workers;
  return MIN (g_get_num_processors (), s->lines->len);
}

/* Whether a worker was killed and another may take its place: the spool says when a job has ended
 * too many. */
static gboolean
may_replace (Survey * s, GSubprocess * process)
{
  return g_subprocess_get_if_signaled (process) && !was_interrupted () &&
      s->n_replaced++ < CLOTH_SPOOL_MOST_LOST * s->lines->len;
}

/* GLib collects the ends of children in a thread of its own. */
static gboolean
look_after_workers (Survey * s, GError ** error)
{
  const guint n = s->workers->len;

  for (guint i = n; i-- > 0;) {
    GSubprocess *process = s->workers->pdata[i];

    if (g_subprocess_get_identifier (process))
      continue;
    if (may_replace (s, process) && !start_worker (s, error))
      return FALSE;
    g_ptr_array_remove_index (s->workers, i);
  }
  if (n == 0 || s->workers->len > 0)
    return TRUE;
  g_set_error (error, G_IO_ERROR, G_IO_ERROR_FAILED, "all workers here have "
      "ended, as they say above; mend that and go on with --resume");
  return FALSE;
}

static void
end_workers (Survey * s, gboolean at_once)
{
  for (guint i = 0; i < s->workers->len; i++) {
    if (at_once)
      g_subprocess_send_signal (s->workers->pdata[i], SIGTERM);
    g_subprocess_wait (s->workers->pdata[i], NULL, NULL);
  }
}

static void
take_result (Survey * s, ClothSpoolJob * job)
{
  const guint line = (guint) g_ascii_strtoull (job->id, NULL, 10) - 1;
  g_autofree gchar *what = NULL;

  s->results->pdata[line] = job;
  s->n_done++;
  what = g_strdup_printf ("%u of %u takes", s->n_done, s->lines->len);
  tell_progress ((gdouble) s->n_done / s->lines->len, what);
}

static gboolean
wait_for_all (Survey * s, GError ** error)
{
  while (s->n_done < s->lines->len) {
    GError *fault = NULL;
    ClothSpoolJob *job = cloth_spool_take (s->spool, &fault);

    if (job)
      take_result (s, job);
    if (!fault && was_interrupted ())
      g_set_error (&fault, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped; what "
          "was done is kept: go on with --resume");
    if (fault)
      g_propagate_error (error, fault);
    if (fault || !cloth_spool_look_after (s->spool, error) ||
        !look_after_workers (s, error))
      return FALSE;
    if (!job)
      cloth_spool_wait (s->spool);
  }
  return cloth_spool_close (s->spool, error);
}

static gboolean
run_survey (Survey * s, GError ** error)
{
  const guint n = count_workers (s);
  gboolean good;

  s->spool = cloth_spool_manage (s->spool_folder, &spool_options, s->problem,
      s->arguments->resume, error);
  if (!s->spool || !put_jobs (s, error))
    return FALSE;
  tell_progress (0., n ? "diagnosing" : "waiting for workers");
  for (guint i = 0; i < n; i++)
    if (!start_worker (s, error)) {
      end_workers (s, TRUE);
      return FALSE;
    }
  good = wait_for_all (s, error);
  end_workers (s, !good);
  return good;
}

static gchar *
read_failure (const ClothSpoolJob * job)
{
  g_autoptr (JsonParser) parser = cloth_json_parse (job->json,
      strlen (job->json), NULL);
  gchar *text = NULL;

  if (parser)
    cloth_json_get_string (&job_file,
        json_node_get_object (json_parser_get_root (parser)), "error", &text,
        NULL);
  return text ? text : g_strdup ("nobody says why");
}

/* survey.json and the tables. */
static gint
conclude (const Survey * s, GError ** error)
{
  g_autoptr (ClothSurvey) table = cloth_survey_new (PACKAGE_VERSION,
      (guint64) s->arguments->seed);
  g_autofree gchar *path = g_build_filename (s->arguments->output,
      "survey.json", NULL);
  g_autofree gchar *json = NULL, *text = NULL;
  guint n_failed;

  for (guint i = 0; i < s->lines->len; i++) {
    const GapSurveyLine *line = s->lines->pdata[i];
    const ClothSpoolJob *job = s->results->pdata[i];
    g_autofree gchar *report = g_strdup_printf ("reports/%s/report.html",
        job->id);
    g_autofree gchar *failure = job->failed ? read_failure (job) : NULL;

    if (failure)
      cloth_survey_add_failure (table, line->name, failure);
    else if (!cloth_survey_add (table, line->name, report, job->json, error))
      return FAILED;
  }
  json = cloth_survey_to_json (table);
  if (!cloth_file_write_text (path, json, error))
    return FAILED;
  text = cloth_survey_to_text (table);
  g_print ("%s\n%s\n", text, path);
  n_failed = cloth_survey_get_n_failures (table);
  if (n_failed)
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_FAILED, "%u of %u takes could "
        "not be diagnosed; mend them and try these again with --resume",
        n_failed, s->lines->len);
  return n_failed ? FAILED : DONE;
}

static gint
manage (const Arguments * arguments)
{
  Survey s = {.arguments = arguments };
  g_autoptr (GError) error = NULL;
  gint code = FAILED;

  s.jobs = g_ptr_array_new_with_free_func (g_free);
  s.results =
      g_ptr_array_new_with_free_func ((GDestroyNotify) cloth_spool_job_free);
  s.workers = g_ptr_array_new_with_free_func (g_object_unref);
  s.spool_folder = arguments->spool ? g_strdup (arguments->spool) :
      g_build_filename (arguments->output, "spool", NULL);
  catch_interrupts ();
  if (load_list (&s, &error)) {
    if (cloth_folder_make (arguments->output, &error)
        && run_survey (&s, &error))
      code = conclude (&s, &error);
  }
  cloth_spool_free (s.spool);
  g_clear_pointer (&s.lines, g_ptr_array_unref);
  g_ptr_array_unref (s.jobs);
  g_ptr_array_unref (s.results);
  g_ptr_array_unref (s.workers);
  g_free (s.problem);
  g_free (s.spool_folder);
  return error ? complain (FAILED, "%s", error->message) : code;
}

static gint
check_usage (const Arguments * arguments)
{
  g_auto (GStrv) effects = NULL;
  g_autoptr (GError) error = NULL;

  if (arguments->format || arguments->scene || arguments->simulator ||
      arguments->baselines || arguments->hold_outs || arguments->simulated ||
      arguments->after)
    return complain (BAD_USAGE, "survey takes no --baseline, --hold-out, "
        "--simulated, --after, --simulator, --format or --scene; the first "
        "four may stand behind a take on its line of the list");
  if (arguments->threads < 0)
    return complain (BAD_USAGE, "--threads: give 0 or a number");
  if (arguments->worker) {
    if (arguments->rest[1] || arguments->model || arguments->effects ||
        arguments->output || arguments->resume || arguments->workers >= 0)
      return complain (BAD_USAGE, "--worker takes --spool and --threads only: "
          "all else is in the spool");
    if (!arguments->spool)
      return complain (BAD_USAGE, "name the spool to work on: --spool DIR");
    return DONE;
  }
  if (!arguments->rest[1] || arguments->rest[2])
    return complain (BAD_USAGE, "name one list of takes: survey LIST --model "
        "MODEL --output DIR");
  if (!arguments->output)
    return complain (BAD_USAGE, "name the folder of the table: --output DIR");
  effects = cloth_gap_effects_parse (arguments->effects, &error);
  if (error)
    return complain (BAD_USAGE, "--effects: %s", error->message);
  return DONE;
}

gint
survey (const Arguments * arguments)
{
  const gint code = check_usage (arguments);

  if (code != DONE)
    return code;
  return arguments->worker ? work (arguments) : manage (arguments);
}
