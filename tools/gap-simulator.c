/* A user's simulator as a program: writes the folder of a run, runs the command, reads back
 * the take. docs/own-simulator.md is the contract.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tools/gap-simulator.h"

#include <gio/gio.h>
#include <glib/gstdio.h>
#include <math.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

#include "gst/file/jsonwriter.h"
#include "gst/sim/scene.h"
#include "tools/tool.h"

/* Most bytes of capabilities that are read, and those of a log that a message shows. */
#define MAX_CAPABILITIES (1 << 20)
#define LOG_END 800
/* How often an interrupt is looked for, ms. */
#define LOOK_MS 100

struct _GapSimulator
{
  ClothGapSimulator simulator;
  ClothSimulatorCapabilities *capabilities;
  gchar **words;                /* of the command */
  gchar *folder;                /* of all runs */
  guint seconds;
  guint n_folders;
};

static gboolean
G_GNUC_PRINTF (2, 3)
fail (GError ** error, const gchar * format, ...)
{
  g_autofree gchar *text = NULL;
  va_list arguments;

  va_start (arguments, format);
  text = g_strdup_vprintf (format, arguments);
  va_end (arguments);
  g_set_error_literal (error, CLOTH_SIMULATOR_ERROR,
      CLOTH_SIMULATOR_ERROR_RUN, text);
  return FALSE;
}

/* The last lines of a log, as a message may show them. */
static gchar *
read_end (const gchar * path)
{
  g_autofree gchar *text = NULL, *valid = NULL;
  gsize length = 0;

  if (!g_file_get_contents (path, &text, &length, NULL))
    return g_strdup ("");
  valid = g_utf8_make_valid (text + (length > LOG_END ? length - LOG_END : 0),
      -1);
  g_strchomp (valid);
  return *valid ? g_strdup_printf ("; the end of what it printed:\n%s", valid) :
      g_strdup ("; it printed nothing");
}

/* ---- a process ---- */

/* In the child: a group of its own, so that whatever it starts can be ended with it. */
static void
lead_group (gpointer data)
{
  setpgid (0, 0);
}

static void
note_end (GObject * process, GAsyncResult * result, gpointer ended)
{
  g_subprocess_wait_finish (G_SUBPROCESS (process), result, NULL);
  *(gboolean *) ended = TRUE;
}

static gboolean
look_again (gpointer data)
{
  return G_SOURCE_CONTINUE;
}

/* Waits for the end of @process, at most @seconds. */
static gboolean
wait_for (GSubprocess * process, guint seconds)
{
  const gchar *id = g_subprocess_get_identifier (process);
  pid_t group = id ? (pid_t) g_ascii_strtoll (id, NULL, 10) : 0;
  gint64 end = g_get_monotonic_time () + (gint64) seconds * G_USEC_PER_SEC;
  GMainContext *context = g_main_context_new ();
  GSource *timer = g_timeout_source_new (LOOK_MS);
  gboolean ended = FALSE, killed = FALSE;

  g_main_context_push_thread_default (context);
  g_source_set_callback (timer, look_again, NULL, NULL);
  g_source_attach (timer, context);
  g_subprocess_wait_async (process, NULL, note_end, &ended);
  while (!ended) {
    g_main_context_iteration (context, TRUE);
    if (!ended && !killed && (was_interrupted ()
            || g_get_monotonic_time () > end)) {
      killed = TRUE;
      if (group > 0)
        kill (-group, SIGKILL);
      g_subprocess_force_exit (process);
    }
  }
  /* What it started and left behind. */
  if (group > 0)
    kill (-group, SIGKILL);
  g_source_destroy (timer);
  g_source_unref (timer);
  g_main_context_pop_thread_default (context);
  g_main_context_unref (context);
  return !killed;
}

/* Runs the command with one more word. What it prints goes to @out, its errors
 * there too or, unless NULL, to @log. */
static gboolean
run_command (const GapSimulator * s, const gchar * word,
    const gchar * out, const gchar * log, GError ** error)
{
  g_autoptr (GSubprocessLauncher) launcher =
      g_subprocess_launcher_new (log ? G_SUBPROCESS_FLAGS_NONE :
      G_SUBPROCESS_FLAGS_STDERR_MERGE);
  g_autoptr (GStrvBuilder) builder = g_strv_builder_new ();
  g_auto (GStrv) words = NULL;
  g_autoptr (GSubprocess) process = NULL;
  g_autoptr (GError) fault = NULL;
  g_autofree gchar *end = NULL;

  g_strv_builder_addv (builder, (const gchar **) s->words);
  g_strv_builder_add (builder, word);
  words = g_strv_builder_end (builder);
  g_subprocess_launcher_set_child_setup (launcher, lead_group, NULL, NULL);
  g_subprocess_launcher_set_stdout_file_path (launcher, out);
  if (log)
    g_subprocess_launcher_set_stderr_file_path (launcher, log);
  process = g_subprocess_launcher_spawnv (launcher,
      (const gchar * const *) words, &fault);
  if (!process)
    return fail (error, "“%s” can't be started: %s", s->words[0],
        fault->message);
  if (!wait_for (process, s->seconds)) {
    if (was_interrupted ()) {
      g_set_error (error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped");
      return FALSE;
    }
    end = read_end (log ? log : out);
    return fail (error, "it was not done after %u s and was stopped: make it "
        "faster or give it more time by --run-seconds%s", s->seconds, end);
  }
  if (g_subprocess_get_successful (process))
    return TRUE;
  end = read_end (log ? log : out);
  if (g_subprocess_get_if_exited (process))
    return fail (error, "it failed with exit code %d%s",
        g_subprocess_get_exit_status (process), end);
  return fail (error, "it was ended by signal %d%s",
      g_subprocess_get_term_sig (process), end);
}

/* ---- the folder of a run ---- */

/* A take of which only the first frame was seen. */
static gboolean
write_scene (ClothTake * take, const gchar * folder, GError ** error)
{
  g_autoptr (ClothScene) scene = cloth_scene_new_from_take (take, error);
  g_autoptr (ClothTakeInfo) info = NULL;
  g_autoptr (ClothTakeWriter) writer = NULL;
  g_autofree gfloat *places = NULL, *clamps = NULL;
  g_autofree guint8 *states = NULL;
  gsize n, n_held;

  if (!scene || !cloth_scene_check_paths (scene, error))
    return FALSE;
  n = scene->topology->n_vertices;
  n_held = scene->held->len;
  info = cloth_take_info_copy (cloth_take_get_info (take));
  info->noise_sigma_m = 0.;
  writer = cloth_take_writer_new (folder, info, scene->topology, error);
  places = g_new (gfloat, 3 * n);
  clamps = g_new (gfloat, 3 * n_held + 1);
  states = g_malloc (n);
  for (guint frame = 0; writer && frame < scene->n_frames; frame++) {
    memset (states, frame ? CLOTH_VERTEX_UNSEEN : CLOTH_VERTEX_PREDICTED, n);
    for (gsize i = 0; i < 3 * n; i++)
      places[i] = frame ? NAN : (gfloat) scene->positions[i];
    for (gsize i = 0; i < 3 * n_held; i++)
      clamps[i] = (gfloat) scene->clamps[3 * n_held * frame + i];
    if (!cloth_take_writer_append (writer, scene->times[frame], places, states,
            NULL, n_held > 0 ? clamps : NULL, error))
      return FALSE;
  }
  return writer && cloth_take_writer_close (writer, error);
}

static gboolean
write_parameters (const ClothSimulatorCapabilities * capabilities,
    const gdouble * values, const gchar * path, GError ** error)
{
  ClothJsonWriter *writer = cloth_json_writer_new ();
  g_autofree gchar *json = NULL;

  cloth_json_writer_set_exact (writer);
  cloth_json_writer_begin_object (writer, NULL);
  for (guint i = 0; i < capabilities->parameters->len; i++)
    cloth_json_writer_number (writer,
        cloth_simulator_capabilities_get (capabilities, i)->name, values[i]);
  cloth_json_writer_end_object (writer);
  json = cloth_json_writer_finish (writer);
  cloth_json_writer_free (writer);
  return g_file_set_contents (path, json, -1, error);
}

static gchar *
make_folder (GapSimulator * s, GError ** error)
{
  g_autofree gchar *name = g_strdup_printf ("%03u", s->n_folders++);
  g_autofree gchar *folder = g_build_filename (s->folder, name, NULL);

  if (g_mkdir (folder, 0777) == 0)
    return g_steal_pointer (&folder);
  fail (error, "the folder “%s” can't be made: %s", folder,
      g_strerror (errno));
  return NULL;
}

static ClothTake *
run (gpointer data, ClothTake * take, const gdouble * values, GError ** error)
{
  GapSimulator *s = data;
  g_autofree gchar *folder = make_folder (s, error);
  g_autofree gchar *scene = NULL, *parameters = NULL, *log = NULL;
  g_autofree gchar *simulated = NULL, *json = NULL, *end = NULL;
  ClothTake *result;

  if (!folder)
    return NULL;
  scene = g_build_filename (folder, "scene", NULL);
  parameters = g_build_filename (folder, "parameters.json", NULL);
  log = g_build_filename (folder, "log.txt", NULL);
  simulated = g_build_filename (folder, "simulated", NULL);
  json = g_build_filename (simulated, "take.json", NULL);
  if (!write_scene (take, scene, error) || !write_parameters (s->capabilities,
          values, parameters, error) || !run_command (s, folder, log,
          NULL, error))
    return NULL;
  if (g_file_test (json, G_FILE_TEST_EXISTS)) {
    result = cloth_take_open (simulated, error);
    if (!result)
      g_prefix_error (error, "what it wrote to simulated/ is no take: ");
    return result;
  }
  end = read_end (log);
  fail (error, "it ended well, but wrote no take: there is no "
      "simulated/take.json in its folder; copy scene/take.json, "
      "scene/times.npy and scene/clamps.npy there and write "
      "positions.npy beside them%s", end);
  return NULL;
}

/* ---- the simulator ---- */

static gboolean
read_capabilities (GapSimulator * s, GError ** error)
{
  g_autofree gchar *out = g_build_filename (s->folder, "capabilities.json",
      NULL);
  g_autofree gchar *log = g_build_filename (s->folder, "log.txt", NULL);
  g_autofree gchar *text = NULL;
  gsize length;

  if (!run_command (s, "--capabilities", out, log, error)) {
    g_prefix_error (error, "--simulator with --capabilities: ");
    return FALSE;
  }
  if (!g_file_get_contents (out, &text, &length, error))
    return FALSE;
  if (length == 0 || length > MAX_CAPABILITIES)
    return fail (error, "--simulator with --capabilities printed %"
        G_GSIZE_FORMAT " bytes: print the JSON of docs/own-simulator.md and "
        "nothing else", length);
  s->capabilities = cloth_simulator_capabilities_parse (text, length, error);
  if (!s->capabilities)
    g_prefix_error (error, "--simulator: ");
  return s->capabilities != NULL;
}

/* @command: the command of --simulator: words as a shell takes them, without a shell
 * @seconds: that a run may take
 * @error: #ClothSimulatorError, #ClothModelError
 *
 * Asks the simulator what it is.
 *
 * Returns: (transfer full) (nullable): the simulator
 */
GapSimulator *
gap_simulator_new (const gchar * command, guint seconds, GError ** error)
{
  g_autoptr (GapSimulator) s = g_new0 (GapSimulator, 1);
  g_autoptr (GError) fault = NULL;

  s->seconds = seconds;
  if (!g_shell_parse_argv (command, NULL, &s->words, &fault)) {
    fail (error, "--simulator “%s”: %s", command, fault->message);
    return NULL;
  }
  s->folder = g_dir_make_tmp ("gst-cloth-gap-XXXXXX", error);
  if (!s->folder || !read_capabilities (s, error))
    return NULL;
  s->simulator.capabilities = s->capabilities;
  s->simulator.run = run;
  s->simulator.data = s;
  return g_steal_pointer (&s);
}

/* @simulator: a simulator
 *
 * Returns: (transfer none): it as a function. What it simulates can be read as long as
 *   @simulator is there
 */
ClothGapSimulator *
gap_simulator_get (GapSimulator * simulator)
{
  return &simulator->simulator;
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

/* @simulator: (nullable) (transfer full): a simulator
 *
 * The folders of its runs go with it.
 */
void
gap_simulator_free (GapSimulator * simulator)
{
  if (!simulator)
    return;
  if (simulator->folder)
    remove_all (simulator->folder);
  cloth_simulator_capabilities_free (simulator->capabilities);
  g_strfreev (simulator->words);
  g_free (simulator->folder);
  g_free (simulator);
}
