/* Jobs in a folder that several processes share, on one host or on many.
 *
 *   spool.json          what is in it: version, kind, program, problem
 *   manager.json        who manages it
 *   todo/ID.json        a job
 *   running/ID@WORKER   the same, claimed by a rename, which one worker only brings about
 *   done/ID.json        what came of it, written under a temporary name, then renamed
 *   failed/ID.json      the same when it did not work
 *   beats/NAME          signs of life of a manager or worker
 *   closed              no more jobs
 *   notes               lines of the manager for who resumes the spool
 *
 * Jobs and results are not brought to the disk one by one, which takes longer than a claim: what a
 * computer that loses its power leaves half is none, and is done again by who resumes.
 * A job whose worker is lost is put back. When that worker lives all the same, it ends the job too:
 * the first result stays, and equal jobs give equal bytes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/spool.h"

#include <errno.h>
#include <fcntl.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <string.h>
#include <unistd.h>

#include "gst/file/json.h"
#include "gst/file/jsonwriter.h"
#include "gst/file/life.h"
#include "gst/file/output.h"

#define SPOOL_VERSION 1
/* How often a manager looks after workers, and a worker after its manager. */
#define LOOK_US G_USEC_PER_SEC
#define LEAST_WAIT_US 1000
#define MOST_WAIT_US 250000
/* Lengths of names, and most names of a folder that are looked at: limits on what others
 * wrote. */
#define MAX_ID 64
#define MAX_NAMES 1000000u
/* Names in one answer of a server that lists a folder: NFS's 4 KiB hold so many. A look for one file is an
 * answer, too. */
#define NAMES_AT_ONCE 100u

struct _ClothSpool
{
  gchar *folder;
  ClothLife *life;
  const gchar *name;            /* of this end */
  gchar *host;
  gdouble lost_s;
  gboolean manages;
  GPtrArray *waiting;           /* ids put, whose results were not taken */
  GHashTable *put;              /* the same as a set */
  gboolean listed;              /* whether results were listed at the last look, and */
  GHashTable *there;            /* which of them were there */
  GHashTable *lost;             /* id → how many workers it lost */
  guint n_lost, n_taken;
  guint next;                   /* of waiting: where to look for a result */
  gint64 looked_us, unmanaged_us;
  gint64 wait_us;
  gint notes;                   /* the open file, or -1 */
};

static const ClothJsonFile spool_file = {
  "spool.json", cloth_file_error_quark, CLOTH_FILE_ERROR_INVALID
};

static const gchar *const folders[] = {
  "todo", "running", "done", "failed", "beats"
};

/* ---- names ---- */

static gchar *
path_of (const ClothSpool * s, const gchar * folder, const gchar * id)
{
  g_autofree gchar *name = g_strconcat (id, ".json", NULL);

  return g_build_filename (s->folder, folder, name, NULL);
}

static gchar *
path_of_running (const ClothSpool * s, const gchar * id, const gchar * worker)
{
  g_autofree gchar *name = g_strconcat (id, "@", worker, NULL);

  return g_build_filename (s->folder, "running", name, NULL);
}

static gboolean
is_name (const gchar * text, gsize most)
{
  gsize n = 0;

  while (g_ascii_isalnum (text[n]) || text[n] == '-' || text[n] == '_')
    n++;
  return n > 0 && n <= most && !text[n];
}

/* The id of "ID.json", or NULL. */
static gchar *
id_of (const gchar * name)
{
  g_autofree gchar *id = NULL;

  if (!g_str_has_suffix (name, ".json"))
    return NULL;
  id = g_strndup (name, strlen (name) - strlen (".json"));
  return is_name (id, MAX_ID) ? g_steal_pointer (&id) : NULL;
}

/* Parts "ID@WORKER". */
static gboolean
parse_running (const gchar * name, gchar ** id, gchar ** worker)
{
  const gchar *at = strchr (name, '@');

  *id = *worker = NULL;
  if (!at || !is_name (at + 1, CLOTH_LIFE_MAX_NAME))
    return FALSE;
  *id = g_strndup (name, (gsize) (at - name));
  if (is_name (*id, MAX_ID)) {
    *worker = g_strdup (at + 1);
    return TRUE;
  }
  g_clear_pointer (id, g_free);
  return FALSE;
}

static gint
compare_names (gconstpointer a, gconstpointer b)
{
  return strcmp (*(const gchar * const *) a, *(const gchar * const *) b);
}

static GPtrArray *
list_names (const ClothSpool * s, const gchar * folder, GError ** error)
{
  g_autofree gchar *path = g_build_filename (s->folder, folder, NULL);
  g_autoptr (GDir) dir = g_dir_open (path, 0, error);
  GPtrArray *names;
  const gchar *name;

  if (!dir)
    return NULL;
  names = g_ptr_array_new_with_free_func (g_free);
  while (names->len < MAX_NAMES && (name = g_dir_read_name (dir)))
    if (*name != '.')
      g_ptr_array_add (names, g_strdup (name));
  g_ptr_array_sort (names, compare_names);
  return names;
}

/* A file that appears whole or not at all to whoever looks, though it may not outlive the computer. */
static gboolean
write_quickly (const ClothSpool * s, const gchar * folder, const gchar * id,
    const gchar * text, GError ** error)
{
  g_autofree gchar *path = path_of (s, folder, id);
  g_autofree gchar *name = g_strconcat (".", id, "@", s->name, NULL);
  g_autofree gchar *temporary = g_build_filename (s->folder, folder, name,
      NULL);
  g_autoptr (ClothOutput) output = NULL;

  g_unlink (temporary);         /* of an attempt that failed */
  output = cloth_output_new_at (temporary, path, path, FALSE, error);
  if (output && cloth_output_write (output, text, strlen (text), error) &&
      cloth_output_commit (output, error))
    return TRUE;
  g_unlink (temporary);
  return FALSE;
}

/* ---- signs of life ---- */

static gboolean
begin_life (ClothSpool * s, GError ** error)
{
  g_autofree gchar *beats = g_build_filename (s->folder, "beats", NULL);

  s->life = cloth_life_new (beats, error);
  if (s->life)
    s->name = cloth_life_get_name (s->life);
  return s->life != NULL;
}

static gboolean
is_lost (ClothSpool * s, const gchar * name)
{
  return cloth_life_look (s->life, name, s->lost_s) == CLOTH_LIFE_LOST;
}

/* ---- spool.json, manager.json ---- */

static gchar *
write_description (const ClothSpoolOptions * options, const gchar * problem)
{
  g_autoptr (ClothJsonWriter) writer = cloth_json_writer_new ();

  cloth_json_writer_begin_object (writer, NULL);
  cloth_json_writer_count (writer, "version", SPOOL_VERSION);
  cloth_json_writer_string (writer, "kind", options->kind);
  cloth_json_writer_string (writer, "program", options->version);
  cloth_json_writer_string (writer, "problem", problem);
  cloth_json_writer_end_object (writer);
  return cloth_json_writer_finish (writer);
}

static JsonParser *
load_json (const gchar * path, GError ** error)
{
  gsize length;
  g_autofree gchar *text = cloth_text_file_load (path, &length, error);

  return text ? cloth_json_parse (text, length, error) : NULL;
}

static JsonObject *
get_object (JsonParser * parser)
{
  return json_node_get_object (json_parser_get_root (parser));
}

static gboolean
check_description (const ClothSpool * s, JsonObject * object,
    const ClothSpoolOptions * options, const gchar * problem, GError ** error)
{
  static const gchar *const keys[] = {
    "version", "kind", "program", "problem", NULL
  };
  g_autofree gchar *kind = NULL, *program = NULL, *its = NULL;
  guint version;

  if (!cloth_json_get_count (&spool_file, object, "version", 1, G_MAXUINT16,
          &version, error))
    return FALSE;
  if (version != SPOOL_VERSION)
    return cloth_json_invalid (&spool_file, error, "version %u is another "
        "program's, %d is read here: go on with that program, or name a new "
        "folder", version, SPOOL_VERSION);
  if (!cloth_json_check_keys (&spool_file, object, "the spool", keys, error) ||
      !cloth_json_get_string (&spool_file, object, "kind", &kind, error) ||
      !cloth_json_get_string (&spool_file, object, "program", &program, error)
      || !cloth_json_get_string (&spool_file, object, "problem", &its, error))
    return FALSE;
  if (g_strcmp0 (kind, options->kind))
    return cloth_json_invalid (&spool_file, error, "its jobs are of the kind "
        "“%s”, not “%s”: give what its manager was given, or name another "
        "folder", kind ? kind : "", options->kind);
  if (g_strcmp0 (program, options->version))
    return cloth_json_invalid (&spool_file, error, "version %s of the program "
        "wrote it, this is %s, whose results may differ: go on with that "
        "version, or name a new folder", program ? program : "none",
        options->version);
  if (problem && g_strcmp0 (its, problem))
    return cloth_json_invalid (&spool_file, error, "it is of other inputs or "
        "options: give those, or name a new folder");
  return TRUE;
}

static gboolean
load_description (const ClothSpool * s, const ClothSpoolOptions * options,
    const gchar * problem, GError ** error)
{
  g_autofree gchar *path = g_build_filename (s->folder, "spool.json", NULL);
  g_autoptr (JsonParser) parser = load_json (path, error);

  if (parser && check_description (s, get_object (parser), options, problem,
          error))
    return TRUE;
  g_prefix_error (error, "“%s”: ", s->folder);
  return FALSE;
}

static const ClothJsonFile manager_file = {
  "manager.json", cloth_file_error_quark, CLOTH_FILE_ERROR_INVALID
};

/* Who manages the spool: name, and as people say it. FALSE: nobody, or what nobody can read. */
static gboolean
read_manager (const ClothSpool * s, const gchar * path, gchar ** name, gchar
    ** shown)
{
  g_autoptr (JsonParser) parser = load_json (path, NULL);
  gboolean good = parser && cloth_json_get_string (&manager_file,
      get_object (parser), "name", name, NULL) && *name &&
      is_name (*name, CLOTH_LIFE_MAX_NAME)
      && cloth_json_get_string (&manager_file,
      get_object (parser), "holder", shown, NULL) && *shown;

  if (good)
    return TRUE;
  g_clear_pointer (name, g_free);
  g_clear_pointer (shown, g_free);
  return FALSE;
}

static gboolean
is_mine (const ClothSpool * s, const gchar * path)
{
  g_autofree gchar *name = NULL, *shown = NULL;

  return read_manager (s, path, &name, &shown) && g_str_equal (name, s->name);
}

/* Waits until the manager of before is surely gone. */
static gboolean
outlive (ClothSpool * s, const gchar * path, GError ** error)
{
  g_autofree gchar *name = NULL, *shown = NULL;

  if (!read_manager (s, path, &name, &shown))
    return TRUE;
  for (;;) {
    const ClothLifeSign sign = cloth_life_look (s->life, name, s->lost_s);

    if (sign == CLOTH_LIFE_LOST)
      return TRUE;
    if (sign == CLOTH_LIFE_CHANGED) {
      g_set_error (error, G_IO_ERROR, G_IO_ERROR_BUSY,
          "“%s” is managed by %s "
          "already: let it end, or name another folder", s->folder, shown);
      return FALSE;
    }
    g_usleep (LOOK_US / 4);
  }
}

/* Takes the place of a manager that is gone. Of several that try, one gets its file away;
 * who got away another's puts it back. */
static gboolean
remove_manager (ClothSpool * s, const gchar * path, GError ** error)
{
  g_autofree gchar *aside = g_strconcat (path, ".", s->name, NULL);
  g_autofree gchar *name = NULL, *shown = NULL;
  gint code = cloth_file_rename (path, aside);

  if (code == ENOENT)
    return TRUE;
  if (code)
    return cloth_file_fail (error, code, "replace", path);
  if (read_manager (s, aside, &name, &shown) && !is_lost (s, name))
    link (aside, path);
  g_unlink (aside);
  return TRUE;
}

static gboolean
become_manager (ClothSpool * s, GError ** error)
{
  g_autofree gchar *path = g_build_filename (s->folder, "manager.json", NULL);
  g_autofree gchar *mine = g_strconcat (path, ".", s->name, NULL);
  g_autoptr (ClothJsonWriter) writer = cloth_json_writer_new ();
  g_autofree gchar *holder = g_strdup_printf ("process %d on %s",
      (gint) getpid (), s->host);
  g_autofree gchar *text = NULL;
  gint code = EEXIST;

  cloth_json_writer_begin_object (writer, NULL);
  cloth_json_writer_string (writer, "name", s->name);
  cloth_json_writer_string (writer, "holder", holder);
  cloth_json_writer_end_object (writer);
  text = cloth_json_writer_finish (writer);
  for (guint i = 0; i < CLOTH_MOST_TRIES && code == EEXIST; i++) {
    if (!outlive (s, path, error) || !remove_manager (s, path, error) ||
        !cloth_file_write_text (mine, text, error))
      return FALSE;
    code = link (mine, path) == 0 ? 0 : errno;
    g_unlink (mine);
  }
  return !code || cloth_file_fail (error, code, "write", path);
}

/* ---- both ends ---- */

static ClothSpool *
spool_new (const gchar * folder, const ClothSpoolOptions * options)
{
  ClothSpool *s = g_new0 (ClothSpool, 1);

  s->folder = g_strdup (folder);
  s->host = g_strdup (g_get_host_name ());
  s->lost_s = options->lost_s > 0. ? options->lost_s : CLOTH_SPOOL_LOST_S;
  s->wait_us = LEAST_WAIT_US;
  s->notes = -1;
  s->waiting = g_ptr_array_new_with_free_func (g_free);
  s->put = g_hash_table_new (g_str_hash, g_str_equal);
  s->there = g_hash_table_new_full (g_str_hash, g_str_equal, g_free, NULL);
  s->lost = g_hash_table_new_full (g_str_hash, g_str_equal, g_free, NULL);
  return s;
}

/* @spool: a spool that has nothing to do now
 *
 * Waits, a little longer each time until something is done again: up to a quarter of a
 * second.
 */
void
cloth_spool_wait (ClothSpool * spool)
{
  g_usleep ((gulong) spool->wait_us);
  spool->wait_us = MIN (spool->wait_us * 3 / 2, MOST_WAIT_US);
}

static void
note_work (ClothSpool * s)
{
  s->wait_us = LEAST_WAIT_US;
}

/* @spool: (nullable) (transfer full): a spool
 *
 * A manager lets go of it, whether it is closed or not.
 */
void
cloth_spool_free (ClothSpool * spool)
{
  if (!spool)
    return;
  if (spool->manages) {
    g_autofree gchar *path = g_build_filename (spool->folder, "manager.json",
        NULL);

    if (is_mine (spool, path))
      g_unlink (path);
  }
  if (spool->notes >= 0)
    close (spool->notes);
  cloth_life_free (spool->life);
  g_hash_table_unref (spool->put);
  g_hash_table_unref (spool->there);
  g_hash_table_unref (spool->lost);
  g_ptr_array_unref (spool->waiting);
  g_free (spool->folder);
  g_free (spool->host);
  g_free (spool);
}

/* @job: (nullable) (transfer full): a job
 */
void
cloth_spool_job_free (ClothSpoolJob * job)
{
  if (!job)
    return;
  g_free (job->id);
  g_free (job->json);
  g_free (job);
}

/* ---- the manager ---- */

static gboolean
make_folders (const ClothSpool * s, GError ** error)
{
  for (guint i = 0; i < G_N_ELEMENTS (folders); i++) {
    g_autofree gchar *path = g_build_filename (s->folder, folders[i], NULL);

    if (!cloth_folder_make (path, error))
      return FALSE;
  }
  return TRUE;
}

/* What a spool of before is, or a new one. */
static gboolean
describe (const ClothSpool * s, const ClothSpoolOptions * options,
    const gchar * problem, gboolean resume, GError ** error)
{
  g_autofree gchar *path = g_build_filename (s->folder, "spool.json", NULL);
  g_autofree gchar *text = NULL;

  if (g_file_test (path, G_FILE_TEST_EXISTS)) {
    if (!resume) {
      g_set_error (error, G_IO_ERROR, G_IO_ERROR_EXISTS, "“%s” is a spool "
          "already: resume it, or name another folder", s->folder);
      return FALSE;
    }
    return load_description (s, options, problem, error);
  }
  text = write_description (options, problem);
  return cloth_file_write_text (path, text, error);
}

/* @folder: made when it is not there
 * @options: what the jobs are
 * @problem: what they are made of, such as a hash; a spool of another one is not resumed
 * @resume: go on with a spool that is there
 * @error: #GIOErrorEnum, %G_IO_ERROR_BUSY: another one manages it, %G_IO_ERROR_EXISTS: it is
 *   there; #ClothFileError: another version or problem
 *
 * A manager that was killed is replaced: at once on the same host, else after the time of a
 * lost worker.
 *
 * Returns: (transfer full) (nullable): the manager's end
 */
ClothSpool *
cloth_spool_manage (const gchar * folder, const ClothSpoolOptions * options,
    const gchar * problem, gboolean resume, GError ** error)
{
  g_autoptr (ClothSpool) s = spool_new (folder, options);
  g_autofree gchar *closed = g_build_filename (folder, "closed", NULL);
  g_autofree gchar *path = g_build_filename (folder, "spool.json", NULL);

  /* A stranger's folder is left as it is. */
  if (g_file_test (path, G_FILE_TEST_EXISTS) &&
      !describe (s, options, problem, resume, error))
    return NULL;
  if (!make_folders (s, error) || !begin_life (s, error) ||
      !become_manager (s, error))
    return NULL;
  s->manages = TRUE;
  g_unlink (closed);
  if (!describe (s, options, problem, TRUE, error))
    return NULL;
  return g_steal_pointer (&s);
}

static gboolean
is_running (const ClothSpool * s, const gchar * id, gboolean * running,
    GError ** error)
{
  g_autoptr (GPtrArray) names = list_names (s, "running", error);

  *running = FALSE;
  for (guint i = 0; names && i < names->len; i++) {
    g_autofree gchar *its = NULL, *worker = NULL;

    *running |= parse_running (names->pdata[i], &its, &worker) &&
        g_str_equal (its, id);
  }
  return names != NULL;
}

/* Whether a file is there; one that was left half goes. */
static gboolean
has_whole (const ClothSpool * s, const gchar * folder, const gchar * id)
{
  g_autofree gchar *path = path_of (s, folder, id);
  g_autoptr (JsonParser) parser = NULL;

  if (!g_file_test (path, G_FILE_TEST_EXISTS))
    return FALSE;
  parser = load_json (path, NULL);
  if (!parser)
    g_unlink (path);
  return parser != NULL;
}

/* @spool: a manager's
 * @id: of the job: up to 64 letters, digits, - and _. They are claimed in the order of these
 * @json: what is to be done, an object
 * @again: whether a job that failed before is tried again
 * @error: #GIOErrorEnum
 *
 * A job that is there, runs or is done already stays as it is: so a resumed manager puts all
 * jobs once more. A result that nobody can read is none.
 *
 * Returns: whether it is there
 */
gboolean
cloth_spool_put (ClothSpool * spool, const gchar * id, const gchar * json,
    gboolean again, GError ** error)
{
  g_autofree gchar *failed = path_of (spool, "failed", id);
  gboolean there;
  gchar *copy;

  g_return_val_if_fail (is_name (id, MAX_ID), FALSE);
  g_return_val_if_fail (!g_hash_table_contains (spool->put, id), FALSE);
  if (again)
    g_unlink (failed);
  there = has_whole (spool, "done", id) || has_whole (spool, "failed", id) ||
      has_whole (spool, "todo", id);
  if (!there && !is_running (spool, id, &there, error))
    return FALSE;
  if (!there && !write_quickly (spool, "todo", id, json, error))
    return FALSE;
  copy = g_strdup (id);
  g_ptr_array_add (spool->waiting, copy);
  g_hash_table_add (spool->put, copy);
  note_work (spool);
  return TRUE;
}

/* Lookups see what is new in a folder of a network once that is opened. */
static void
refresh (const ClothSpool * s, const gchar * folder)
{
  g_autofree gchar *path = g_build_filename (s->folder, folder, NULL);
  GDir *dir = g_dir_open (path, 0, NULL);

  if (dir)
    g_dir_close (dir);
}

/* Which of the jobs that are waited for have a result. */
static void
look_for_results (ClothSpool * s)
{
  static const gchar *const of_results[] = { "done", "failed" };

  /* a list has those, too, that were taken; else each is looked for */
  s->listed = s->waiting->len > s->n_taken / NAMES_AT_ONCE;
  g_hash_table_remove_all (s->there);
  for (guint i = 0; i < G_N_ELEMENTS (of_results); i++) {
    g_autoptr (GPtrArray) names = NULL;

    if (!s->listed) {
      refresh (s, of_results[i]);
      continue;
    }
    names = list_names (s, of_results[i], NULL);
    for (guint k = 0; names && k < names->len; k++) {
      gchar *id = id_of (names->pdata[k]);

      if (id && g_hash_table_contains (s->put, id))
        g_hash_table_add (s->there, id);
      else
        g_free (id);
    }
  }
}

static ClothSpoolJob *
load_result (const ClothSpool * s, const gchar * id, GError ** error)
{
  for (guint failed = 0; failed < 2; failed++) {
    g_autofree gchar *path = path_of (s, failed ? "failed" : "done", id);
    g_autoptr (JsonParser) parser = NULL;
    g_autofree gchar *text = NULL;
    ClothSpoolJob *job;
    gsize length;

    if (!g_file_test (path, G_FILE_TEST_EXISTS))
      continue;
    text = cloth_text_file_load (path, &length, error);
    parser = text ? cloth_json_parse (text, length, error) : NULL;
    if (!parser) {
      g_prefix_error (error, "%s: remove it, and its job is done again: ",
          path);
      return NULL;
    }
    job = g_new0 (ClothSpoolJob, 1);
    job->id = g_strdup (id);
    job->json = g_steal_pointer (&text);
    job->failed = failed;
    return job;
  }
  return NULL;
}

/* @spool: a manager's
 * @error: #ClothFileError, #GFileError: a result is there and can't be read
 *
 * Returns: (transfer full) (nullable): a result that has come since; each is given once.
 *   %NULL without an error: none
 */
ClothSpoolJob *
cloth_spool_take (ClothSpool * spool, GError ** error)
{
  const guint n = spool->waiting->len;

  if (spool->next >= n) {
    spool->next = 0;
    look_for_results (spool);
  }
  for (; spool->next < n; spool->next++) {
    g_autofree gchar *id = g_strdup (spool->waiting->pdata[spool->next]);
    g_autofree gchar *todo = NULL;
    GError *fault = NULL;
    ClothSpoolJob *job = !spool->listed
        || g_hash_table_remove (spool->there, id) ? load_result (spool, id,
        &fault) : NULL;

    if (fault) {
      g_propagate_error (error, fault);
      return NULL;
    }
    if (!job)
      continue;
    todo = path_of (spool, "todo", id);
    g_unlink (todo);            /* put back, and its worker lived */
    spool->n_taken++;
    g_hash_table_remove (spool->put, id);
    g_ptr_array_remove_index (spool->waiting, spool->next);
    note_work (spool);
    return job;
  }
  return NULL;
}

static gboolean
fail_job (const ClothSpool * s, const gchar * id, GError ** error)
{
  g_autofree gchar *text = g_strdup_printf ("{\"error\": \"%d workers were "
      "lost at it: killed, out of memory, or on hosts that went away\"}\n",
      CLOTH_SPOOL_MOST_LOST);

  return write_quickly (s, "failed", id, text, error);
}

/* Puts a job back whose worker is lost. */
static gboolean
put_back (ClothSpool * s, const gchar * id, const gchar * worker, GError
    ** error)
{
  g_autofree gchar *from = path_of_running (s, id, worker);
  g_autofree gchar *to = path_of (s, "todo", id);
  g_autofree gchar *done = path_of (s, "done", id);
  const guint n = GPOINTER_TO_UINT (g_hash_table_lookup (s->lost, id)) + 1;
  gint code;

  if (g_file_test (done, G_FILE_TEST_EXISTS)) {
    g_unlink (from);            /* it was lost between the result and this */
    return TRUE;
  }
  g_hash_table_insert (s->lost, g_strdup (id), GUINT_TO_POINTER (n));
  if (n >= CLOTH_SPOOL_MOST_LOST) {
    g_unlink (from);
    return fail_job (s, id, error);
  }
  code = cloth_file_rename (from, to);
  if (code && code != ENOENT)
    return cloth_file_fail (error, code, "put back", to);
  if (!code)
    s->n_lost++;
  return TRUE;
}

/* @spool: a manager's
 * @error: #GIOErrorEnum, %G_IO_ERROR_BUSY: another one has taken over
 *
 * To be called again and again; once a second it does something: jobs of workers that give no
 * sign of life are put back.
 *
 * Returns: whether this still is the manager
 */
gboolean
cloth_spool_look_after (ClothSpool * spool, GError ** error)
{
  const gint64 now_us = g_get_monotonic_time ();
  g_autoptr (GPtrArray) names = NULL;
  g_autofree gchar *path = NULL;

  if (spool->looked_us && now_us - spool->looked_us < LOOK_US)
    return TRUE;
  spool->looked_us = now_us;
  path = g_build_filename (spool->folder, "manager.json", NULL);
  if (!is_mine (spool, path)) {
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_BUSY, "another manager has "
        "taken “%s” over, or its files were removed", spool->folder);
    return FALSE;
  }
  names = list_names (spool, "running", error);
  for (guint i = 0; names && i < names->len; i++) {
    g_autofree gchar *id = NULL, *worker = NULL;

    if (parse_running (names->pdata[i], &id, &worker) &&
        is_lost (spool, worker) && !put_back (spool, id, worker, error))
      return FALSE;
  }
  return names != NULL;
}

/* @spool: a manager's
 *
 * Returns: how many jobs were put back
 */
guint
cloth_spool_get_n_lost (const ClothSpool * spool)
{
  return spool->n_lost;
}

/* @spool: a manager's
 * @error: #GIOErrorEnum
 *
 * Sends the workers home. All else stays.
 *
 * Returns: whether they are told
 */
gboolean
cloth_spool_close (ClothSpool * spool, GError ** error)
{
  g_autofree gchar *path = g_build_filename (spool->folder, "closed", NULL);

  return cloth_file_write_text (path, "no more jobs\n", error);
}

/* @spool: a manager's, which asks once
 * @error: #GIOErrorEnum, #ClothFileError
 *
 * The lines get a file of their own: a manager that this one has replaced may still add to the other.
 *
 * Returns: (transfer full) (nullable): the lines that managers before have noted, without half
 *   a one of who was killed
 */
gchar *
cloth_spool_begin_notes (ClothSpool * spool, GError ** error)
{
  g_autofree gchar *path = g_build_filename (spool->folder, "notes", NULL);
  g_autofree gchar *text = NULL;
  gchar *end;
  gsize length;

  if (!g_file_test (path, G_FILE_TEST_EXISTS))
    text = g_strdup ("");
  else if (!(text = cloth_text_file_load (path, &length, error)))
    return NULL;
  end = strrchr (text, '\n');
  *(end ? end + 1 : text) = 0;
  if (!cloth_file_write_text (path, text, error))
    return NULL;
  spool->notes = g_open (path, O_WRONLY | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0);
  if (spool->notes >= 0)
    return g_steal_pointer (&text);
  cloth_file_fail (error, errno, "write", path);
  return NULL;
}

/* @spool: a manager's that has begun its notes
 * @lines: to add
 * @error: #GIOErrorEnum
 *
 * Returns: whether they are on the disk
 */
gboolean
cloth_spool_note (ClothSpool * spool, const gchar * lines, GError ** error)
{
  gint code = cloth_file_append (spool->notes, lines, strlen (lines));
  g_autofree gchar *path = NULL;

  if (!code && !fsync (spool->notes))
    return TRUE;
  path = g_build_filename (spool->folder, "notes", NULL);
  return cloth_file_fail (error, code ? code : errno, "write", path);
}

/* ---- a worker ---- */

/* @folder: of a spool
 * @options: what the jobs must be
 * @wait_s: seconds to wait for it to appear, as workers may start before their manager
 * @error: #GIOErrorEnum, #ClothFileError
 *
 * Returns: (transfer full) (nullable): a worker's end
 */
ClothSpool *
cloth_spool_join (const gchar * folder, const ClothSpoolOptions * options,
    gdouble wait_s, GError ** error)
{
  g_autoptr (ClothSpool) s = spool_new (folder, options);
  g_autofree gchar *path = g_build_filename (folder, "spool.json", NULL);
  const gint64 end_us = g_get_monotonic_time () +
      (gint64) (wait_s * G_USEC_PER_SEC);

  while (!g_file_test (path, G_FILE_TEST_EXISTS)) {
    if (g_get_monotonic_time () >= end_us) {
      g_set_error (error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND, "“%s” is no "
          "spool: there is no spool.json in it; start its manager first, and "
          "see that both have the same folder", folder);
      return NULL;
    }
    cloth_spool_wait (s);
  }
  note_work (s);
  if (!load_description (s, options, NULL, error) || !begin_life (s, error))
    return NULL;
  return g_steal_pointer (&s);
}

static ClothSpoolJob *
load_job (const ClothSpool * s, const gchar * id, const gchar * path,
    GError ** error)
{
  gsize length;
  g_autofree gchar *text = cloth_text_file_load (path, &length, error);
  g_autoptr (JsonParser) parser = text ? cloth_json_parse (text, length,
      error) : NULL;
  ClothSpoolJob *job;

  if (!parser)
    return NULL;
  job = g_new0 (ClothSpoolJob, 1);
  job->id = g_strdup (id);
  job->json = g_steal_pointer (&text);
  return job;
}

/* What nobody can read has failed: it must not go from worker to worker. */
static gboolean
refuse_job (ClothSpool * s, const gchar * id, const GError * fault, GError
    ** error)
{
  const ClothSpoolJob job = { (gchar *) id, NULL, FALSE };
  g_autoptr (ClothJsonWriter) writer = cloth_json_writer_new ();
  g_autofree gchar *text = NULL;

  cloth_json_writer_begin_object (writer, NULL);
  cloth_json_writer_string (writer, "error", fault->message);
  cloth_json_writer_end_object (writer);
  text = cloth_json_writer_finish (writer);
  return cloth_spool_finish (s, &job, text, TRUE, error);
}

/* Claims one job by renaming it. FALSE without an error: another worker was quicker. */
static gboolean
claim (ClothSpool * s, const gchar * id, ClothSpoolJob ** job, GError ** error)
{
  g_autofree gchar *from = path_of (s, "todo", id);
  g_autofree gchar *to = path_of_running (s, id, s->name);
  g_autofree gchar *done = path_of (s, "done", id);
  g_autoptr (GError) fault = NULL;
  gint code;

  if (g_file_test (done, G_FILE_TEST_EXISTS)) {
    g_unlink (from);
    return FALSE;
  }
  code = cloth_file_rename (from, to);
  if (code && code != ENOENT)
    cloth_file_fail (error, code, "claim", from);
  if (code)
    return FALSE;
  *job = load_job (s, id, to, &fault);
  if (!*job)
    refuse_job (s, id, fault, error);
  return *job != NULL;
}

/* @spool: a worker's
 * @error: #GIOErrorEnum, #GFileError
 *
 * Returns: (transfer full) (nullable): the first job that was still free, now this worker's;
 *   %NULL without an error: there is none now
 */
ClothSpoolJob *
cloth_spool_claim (ClothSpool * spool, GError ** error)
{
  g_autoptr (GPtrArray) names = list_names (spool, "todo", error);
  GError *fault = NULL;

  for (guint i = 0; names && i < names->len; i++) {
    g_autofree gchar *id = id_of (names->pdata[i]);
    ClothSpoolJob *job = NULL;

    if (id && claim (spool, id, &job, &fault)) {
      note_work (spool);
      return job;
    }
    if (fault) {
      g_propagate_error (error, fault);
      return NULL;
    }
  }
  return NULL;
}

/* @spool: a worker's
 * @job: that it has claimed
 * @json: what came of it, an object
 * @failed: it did not work, and @json says why
 * @error: #GIOErrorEnum: the job is still this worker's
 *
 * A result that is there already, because the job was put back, stays.
 *
 * Returns: whether the result is there
 */
gboolean
cloth_spool_finish (ClothSpool * spool, const ClothSpoolJob * job,
    const gchar * json, gboolean failed, GError ** error)
{
  g_autofree gchar *running = path_of_running (spool, job->id, spool->name);
  g_autofree gchar *done = path_of (spool, "done", job->id);

  if (!g_file_test (done, G_FILE_TEST_EXISTS) &&
      !write_quickly (spool, failed ? "failed" : "done", job->id, json, error))
    return FALSE;
  g_unlink (running);
  note_work (spool);
  return TRUE;
}

/* @spool: a worker's
 * @job: that it has claimed and can't do now
 * @error: #GIOErrorEnum
 *
 * Needs no room on the disk.
 *
 * Returns: whether others can claim it
 */
gboolean
cloth_spool_give_back (ClothSpool * spool, const ClothSpoolJob * job, GError
    ** error)
{
  g_autofree gchar *from = path_of_running (spool, job->id, spool->name);
  g_autofree gchar *to = path_of (spool, "todo", job->id);
  const gint code = cloth_file_rename (from, to);

  /* The manager may have been quicker. */
  return !code || code == ENOENT ||
      cloth_file_fail (error, code, "give back", to);
}

/* @spool: a worker's, when it found no job
 *
 * Returns: whether there may be more; a manager that is gone may be resumed for as long as it
 *   takes to be lost
 */
ClothSpoolState
cloth_spool_get_state (ClothSpool * spool)
{
  g_autofree gchar *closed = g_build_filename (spool->folder, "closed", NULL);
  g_autofree gchar *path = g_build_filename (spool->folder, "manager.json",
      NULL);
  g_autofree gchar *name = NULL, *shown = NULL;
  const gint64 now_us = g_get_monotonic_time ();

  if (g_file_test (closed, G_FILE_TEST_EXISTS))
    return CLOTH_SPOOL_CLOSED;
  if (spool->looked_us && now_us - spool->looked_us < LOOK_US)
    return CLOTH_SPOOL_OPEN;
  spool->looked_us = now_us;
  if (read_manager (spool, path, &name, &shown) && !is_lost (spool, name))
    spool->unmanaged_us = 0;
  else if (!spool->unmanaged_us)
    spool->unmanaged_us = now_us;
  return spool->unmanaged_us && (gdouble) (now_us - spool->unmanaged_us) >
      spool->lost_s * G_USEC_PER_SEC ? CLOTH_SPOOL_ABANDONED : CLOTH_SPOOL_OPEN;
}
