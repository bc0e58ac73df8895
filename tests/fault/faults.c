/* Every program part that writes files, with every fault at every call: the old files stay
 * or the new ones are there, whole. Then the same with a kill at every call.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <dlfcn.h>
#include <errno.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "gst/file/spool.h"
#include "gst/gap/report/report.h"
#include "gst/mesh/garment/garment.h"
#include "gst/pattern/marray.h"
#include "gst/pattern/pattern.h"
#include "gst/rig/rigfile.h"
#include "gst/take/recover.h"
#include "gst/take/take.h"
#include "tests/core/meshpeer.h"
#include "tests/fault/fault.h"

#define COLUMNS 3
#define ROWS 2
#define N (COLUMNS * ROWS)
/* The old recording is longer: what is left of it would be read with the new one. */
#define OLD_FRAMES 5u
#define NEW_FRAMES 3u

/* What is written: @round 0 are the old files, 1 the new ones. */
typedef struct
{
  const gchar *name;            /* what it is to be called in the scratch folder */
    gboolean (*write) (const gchar * path, guint round, GError ** error);
  gboolean each;                /* several commits, one after the other */
} Writer;

/* Whether a fault must be noticed. One may stay unnoticed when it strikes the cleaning, or
 * the making of a folder that is there. */
typedef enum
{ FATAL, MAYBE, HARMLESS } Weight;

typedef struct
{
  const gchar *call;
  gint code;
  Weight weight;
} Fault;

static const Fault faults[] = {
  {"write", ENOSPC}, {"write", EIO}, {"write", EINTR, HARMLESS},
  {"write", CLOTH_FAULT_SHORT, HARMLESS},
  {"pwrite", ENOSPC}, {"pwrite", EIO}, {"pwrite", EINTR, HARMLESS},
  {"pwrite", CLOTH_FAULT_SHORT, HARMLESS},
  {"pread", EIO}, {"pread", EINTR, HARMLESS}, {"pread", CLOTH_FAULT_SHORT,
      HARMLESS},
  {"fsync", EIO}, {"fsync", ENOSPC}, {"fsync", EINVAL, MAYBE}, {"fsync", EINTR,
      HARMLESS},
  {"syncfs", EIO}, {"syncfs", EINTR, HARMLESS},
  {"rename", EIO}, {"rename", ENOSPC}, {"rename", EINTR, HARMLESS},
  {"open", EIO, MAYBE}, {"open", ENOSPC, MAYBE}, {"open", EMFILE, MAYBE},
  {"open", ENOENT, MAYBE}, {"open", EACCES, MAYBE},
  {"open", EINTR, HARMLESS}, {"fstat", EIO, MAYBE}, {"lstat", EIO, MAYBE},
  {"close", EIO, MAYBE}, {"close", EINTR, HARMLESS},
  {"ftruncate", EIO}, {"ftruncate", EINTR, HARMLESS},
  {"lseek", EIO}, {"mkdir", ENOSPC, MAYBE}, {"mkdir", EIO, MAYBE}, {"opendir",
      EMFILE, MAYBE},
  {"flock", EINTR, HARMLESS}, {"flock", ENOLCK, HARMLESS}, {"flock",
      EWOULDBLOCK, HARMLESS},
  {"flock", CLOTH_FAULT_CLEARED, HARMLESS},
  {"unlink", EIO, MAYBE}, {"rmdir", EIO, MAYBE}
};

static ClothFaultArm arm;
static ClothFaultFired fired;
static guint n_faults, n_kills, n_left;
/* read before anything fails */
static ClothRig *rigs[2];
static ClothModel *model;

static gfloat
value_of (guint round, guint frame, guint i)
{
  return (gfloat) (1000 * round + 100 * frame + i);
}

static void
fill_frame (guint round, guint frame, gfloat * positions, guint8 * states)
{
  for (guint i = 0; i < 3 * N; i++)
    positions[i] = value_of (round, frame, i);
  for (guint i = 0; i < N; i++)
    states[i] = (guint8) (1 + (i + round) % 4);
}

static gboolean
write_mesh (const gchar * path, guint round, GError ** error)
{
  g_autoptr (ClothTopology) topology =
      cloth_topology_new_grid (COLUMNS, ROWS, 0.5f, 0.25f);
  g_autoptr (ClothMeshWriter) writer = cloth_mesh_writer_new (path,
      CLOTH_MESH_FORMAT_AUTO, NULL, topology, 25, 1, error);
  const guint n_frames = round == 0 ? OLD_FRAMES : NEW_FRAMES;
  gfloat positions[3 * N], covariances[6 * N];
  guint8 states[N];
  /* Only the old recording has covariances: they must not outlive it. */
  ClothMeshFrame frame = { positions, states, round == 0 ? covariances : NULL };

  for (guint i = 0; i < 6 * N; i++)
    covariances[i] = i % 6 == 0 || i % 6 == 3 || i % 6 == 5 ? 1e-6f : 0;
  if (!writer)
    return FALSE;
  for (guint f = 0; f < n_frames; f++) {
    fill_frame (round, f, positions, states);
    if (!cloth_mesh_writer_append (writer, f / 25., &frame, error)) {
      cloth_mesh_writer_leave (writer);
      return FALSE;
    }
  }
  if (cloth_mesh_writer_close (writer, error))
    return TRUE;
  cloth_mesh_writer_leave (writer);
  return FALSE;
}

/* A take with a mesh of its own, clamps, and covariances that begin late. */
static gboolean
write_take (const gchar * path, guint round, GError ** error)
{
  g_autoptr (ClothTopology) topology =
      cloth_topology_new_grid (COLUMNS, ROWS, 0.5f, 0.25f);
  g_autoptr (ClothTakeInfo) info = cloth_take_info_new ("t");
  g_autoptr (ClothTakeWriter) writer = NULL;
  const guint n_frames = round == 0 ? OLD_FRAMES : NEW_FRAMES;
  ClothHeld held = { 0, -1, 9 };
  gfloat positions[3 * N], clamps[3] = { 1, 2, 3 }, covariances[6 * N] = { 0 };
  guint8 states[N];

  info->fps = 25;
  info->mesh = g_strdup (round == 0 ? "old.obj" : "new.obj");
  g_array_append_val (info->held, held);
  writer = cloth_take_writer_new (path, info, topology, error);
  if (!writer)
    return FALSE;
  for (guint f = 0; f < n_frames; f++) {
    fill_frame (round, f, positions, states);
    if (!cloth_take_writer_append (writer, f / 25., positions, states,
            round == 1 && f > 0 ? covariances : NULL, round == 0 ? clamps :
            NULL, error)) {
      cloth_take_writer_leave (writer);
      return FALSE;
    }
  }
  if (cloth_take_writer_close (writer, error))
    return TRUE;
  cloth_take_writer_leave (writer);
  return FALSE;
}

static gboolean
write_rig (const gchar * path, guint round, GError ** error)
{
  return cloth_rig_save (rigs[round], path, error);
}

static gboolean
write_pattern (const gchar * path, guint round, GError ** error)
{
  g_autoptr (ClothPattern) pattern =
      cloth_pattern_new_checker (4 + round, 4, 0.05, 0, TRUE, NULL);

  return cloth_pattern_save (pattern, path, error);
}

static gboolean
write_report (const gchar * path, guint round, GError ** error)
{
  g_autoptr (ClothGapResult) result = cloth_gap_result_new ();

  result->verdict = round == 0 ? CLOTH_GAP_NO_GAP : CLOTH_GAP_UNEXPLAINED;
  result->model = cloth_model_copy (model);
  return cloth_gap_result_write (result, path, error);
}

static gboolean
write_garment (const gchar * path, guint round, GError ** error)
{
  g_autofree gchar *folder = g_path_get_dirname (path);
  g_autoptr (ClothGarment) garment = cloth_garment_new ();

  garment->topology = cloth_topology_new_grid (COLUMNS + round, ROWS, 0.5f,
      0.25f);
  garment->dots = g_new0 (gint, garment->topology->n_vertices);
  return cloth_garment_save (garment, folder, error);
}

static gboolean
write_file (const gchar * path, guint round, GError ** error)
{
  /* Longer than what is held back. */
  const gsize size = 700000;
  g_autofree gchar *bytes = g_malloc (size);
  g_autoptr (ClothOutput) output = NULL;
  g_autoptr (ClothOutput) held = NULL;

  memset (bytes, round == 0 ? 'o' : 'n', size);
  held = cloth_output_new (path, error);
  output = held ? cloth_output_new (path, error) : NULL;
  return output && cloth_output_write (held, bytes, size, error) &&
      cloth_output_write (output, bytes, 10, error) &&
      cloth_output_write (output, NULL, 0, error) &&
      cloth_output_copy (held, output, error) &&
      cloth_output_write (output, bytes, size, error) &&
      cloth_output_printf (output, error, "%u", round) &&
      cloth_output_write_at (output, 5, "five", 4, error) &&
      cloth_output_commit (output, error);
}

static gboolean
write_at_once (const gchar * path, guint round, GError ** error)
{
  g_autofree gchar *bytes = g_strnfill (300000, round == 0 ? 'o' : 'n');

  return cloth_file_write_text (path, bytes, error);
}

static const Writer writers[] = {
  {"c.obj", write_mesh}, {"c.ply", write_mesh}, {"c.take", write_mesh},
  {"c.glb", write_mesh}, {"c.usda", write_mesh}, {"c.pvd", write_mesh},
  {"c.c3d", write_mesh}, {"c.csv", write_mesh}, {"t.take", write_take},
  {"file", write_file}, {"text", write_at_once}, {"rig.json", write_rig},
  {"pattern.json", write_pattern}, {"garment.json", write_garment},
  {"report", write_report, TRUE}
};

/* ---- what is in the scratch folder ---- */

static void
collect (const gchar * folder, const gchar * below, gboolean hidden,
    GHashTable * files)
{
  g_autoptr (GDir) dir = g_dir_open (folder, 0, NULL);
  const gchar *name;

  while (dir && (name = g_dir_read_name (dir))) {
    g_autofree gchar *path = g_build_filename (folder, name, NULL);
    g_autofree gchar *shown = g_strconcat (below, "/", name, NULL);
    gchar *bytes = NULL;
    gsize size = 0;

    if (*name == '.' && !hidden)
      continue;
    if (g_file_test (path, G_FILE_TEST_IS_DIR))
      collect (path, shown, hidden, files);
    else
      g_assert_true (g_file_get_contents (path, &bytes, &size, NULL));
    g_hash_table_insert (files, g_steal_pointer (&shown),
        g_bytes_new_take (bytes, size));
  }
}

static GHashTable *
look (gboolean hidden)
{
  GHashTable *files = g_hash_table_new_full (g_str_hash, g_str_equal, g_free,
      (GDestroyNotify) g_bytes_unref);

  collect (scratch, "", hidden, files);
  return files;
}

static gboolean
is_same (GHashTable * a, GHashTable * b)
{
  GHashTableIter iter;
  gpointer name, bytes;

  if (g_hash_table_size (a) != g_hash_table_size (b))
    return FALSE;
  g_hash_table_iter_init (&iter, a);
  while (g_hash_table_iter_next (&iter, &name, &bytes)) {
    GBytes *other = g_hash_table_lookup (b, name);

    if (!other || !g_bytes_equal (bytes, other))
      return FALSE;
  }
  return TRUE;
}

/* Each file is as it was or as it shall be. */
static gboolean
is_mixture (GHashTable * a, GHashTable * old, GHashTable * new)
{
  GHashTableIter iter;
  gpointer name, bytes;

  g_hash_table_iter_init (&iter, a);
  while (g_hash_table_iter_next (&iter, &name, &bytes)) {
    GBytes *one = g_hash_table_lookup (old, name);
    GBytes *other = g_hash_table_lookup (new, name);

    if ((!one || !g_bytes_equal (bytes, one)) &&
        (!other || !g_bytes_equal (bytes, other)))
      return FALSE;
  }
  return TRUE;
}

static void
list_into (GString * text, GHashTable * files)
{
  g_autoptr (GList) names = g_list_sort (g_hash_table_get_keys (files),
      (GCompareFunc) strcmp);

  for (GList * l = names; l; l = l->next)
    g_string_append_printf (text, " %s(%" G_GSIZE_FORMAT ")",
        (const gchar *) l->data,
        g_bytes_get_size (g_hash_table_lookup (files, l->data)));
}

static void
empty_scratch (void)
{
  scratch_remove (scratch);
  g_assert_cmpint (g_mkdir (scratch, 0777), ==, 0);
}

static void
begin (const Writer * writer, gboolean with_old, guint round)
{
  g_autofree gchar *path = scratch_path (writer->name);
  g_autoptr (GError) error = NULL;

  empty_scratch ();
  if (with_old)
    writer->write (path, 0, &error);
  g_assert_no_error (error);
  if (round > 0)
    writer->write (path, 1, &error);
  g_assert_no_error (error);
}

/* What is there when nothing fails. */
static GHashTable *
write_well (const Writer * writer, gboolean with_old, guint round)
{
  arm ("", 0, 0, FALSE);
  begin (writer, with_old, round);
  return look (TRUE);
}

/* ---- what readers and recovery see ---- */

/* The frames that a reader sees: all of one round, in their order. −1: it refuses. */
static gint
read_round (const gchar * path, guint * n_frames)
{
  g_autoptr (ClothMeshReader) reader =
      cloth_mesh_reader_open (path, CLOTH_MESH_FORMAT_AUTO, NULL);
  gint round = -1;

  *n_frames = reader ? cloth_mesh_reader_get_n_frames (reader) : 0;
  for (guint f = 0; f < *n_frames; f++) {
    ClothMeshFrame frame;
    gfloat positions[3 * N];
    guint8 states[N];

    g_assert_true (cloth_mesh_reader_read (reader, f, &frame, NULL));
    if (f == 0)
      round = frame.positions[0] >= value_of (1, 0, 0);
    fill_frame ((guint) round, f, positions, states);
    g_assert_cmpmem (frame.positions, sizeof positions, positions,
        sizeof positions);
    g_assert_cmpmem (frame.states, sizeof states, states, sizeof states);
  }
  return round;
}

/* How many lines of a file begin with @prefix; 0 when it isn't there. */
static guint
count_lines (const gchar * path, const gchar * prefix)
{
  g_autofree gchar *text = NULL;
  g_auto (GStrv) lines = NULL;
  guint n = 0;

  if (!g_file_get_contents (path, &text, NULL, NULL))
    return 0;
  lines = g_strsplit (text, "\n", -1);
  for (guint i = 0; lines[i]; i++)
    n += g_str_has_prefix (lines[i], prefix);
  return n;
}

/* A recovered recording has the first frames of the new one. */
static void
check_recovered (const gchar * path, GHashTable * new, guint n_frames)
{
  guint n;

  if (g_str_has_suffix (path, ".csv")) {
    g_autofree gchar *text = NULL;

    g_assert_true (g_file_get_contents (path, &text, NULL, NULL));
    g_assert_true (g_str_has_prefix (g_bytes_get_data (g_hash_table_lookup (new,
                    "/c.csv"), NULL), text));
    for (guint f = 0; f < NEW_FRAMES; f++) {
      g_autofree gchar *prefix = g_strdup_printf ("%u,", f);

      g_assert_cmpuint (count_lines (path, prefix), ==, f < n_frames ? N : 0);
    }
  } else if (g_str_has_suffix (path, ".pvd")) {
    g_autoptr (GHashTable) files = look (TRUE);

    g_assert_cmpuint (count_lines (path, "    <DataSet "), ==, n_frames);
    g_assert_cmpuint (count_lines (path, "</VTKFile>"), ==, 1);
    g_assert_cmpuint (g_hash_table_size (files), ==, n_frames + 1);
    for (guint f = 0; f < n_frames; f++) {
      g_autofree gchar *name = g_strdup_printf ("/c_%05u.vtp", f);

      g_assert_true (g_bytes_equal (g_hash_table_lookup (files, name),
              g_hash_table_lookup (new, name)));
    }
  } else {
    g_assert_cmpint (read_round (path, &n), ==, 1);
    g_assert_cmpuint (n, ==, n_frames);
  }
}

/* FALSE: nothing was left there. */
static gboolean
recover (const gchar * path, gboolean overwrite, ClothRecovered * recovered,
    GError ** error)
{
  g_autoptr (GPtrArray) found = cloth_recover_find (path, NULL);

  if (!found || found->len == 0)
    return FALSE;
  g_assert_cmpuint (found->len, ==, 1);
  cloth_recover (found->pdata[0], overwrite, recovered, error);
  return TRUE;
}

static gboolean
is_visible (GHashTable * wanted)
{
  g_autoptr (GHashTable) files = look (TRUE);

  return is_same (files, wanted);
}

static void
check_killed (const gchar * path, gboolean with_old, gboolean readable,
    GHashTable * old, GHashTable * new)
{
  g_autoptr (GError) error = NULL;
  ClothRecovered recovered;
  guint n;
  const gint round = readable ? read_round (path, &n) : -1;

  /* Never a mixture, and never less than was whole. */
  if (round >= 0)
    g_assert_cmpuint (n, ==, round == 0 ? OLD_FRAMES : NEW_FRAMES);
  if (!recover (path, FALSE, &recovered, &error)) {
    g_assert_true (is_visible (old) || is_visible (new) || !with_old);
    return;
  }
  if (g_error_matches (error, G_IO_ERROR, G_IO_ERROR_EXISTS)) {
    g_autoptr (GHashTable) files = look (FALSE);

    g_assert_true (with_old && is_same (files, old));
    g_clear_error (&error);
    g_assert_true (recover (path, TRUE, &recovered, &error));
  }
  if (g_error_matches (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_UNSUPPORTED)) {
    g_autoptr (GHashTable) files = look (FALSE);

    g_assert_true (is_same (files, old) || !with_old);
    return;
  }
  g_assert_no_error (error);
  if (recovered.placed)
    g_assert_true (is_visible (new));
  else if (recovered.n_frames > 0)
    check_recovered (path, new, (guint) recovered.n_frames);
  else
    g_assert_true (is_visible (old) || is_visible (new) || !with_old);
}

static gboolean
is_recording (const Writer * writer)
{
  return writer->write == write_mesh || writer->write == write_take;
}

static gboolean
leaves_remains (const gchar * path)
{
  g_autoptr (GPtrArray) found = cloth_recover_find (path, NULL);

  return found && found->len > 0;
}

static gboolean
lasts (const Writer * writer)
{
  return is_recording (writer) && !g_str_has_suffix (writer->name, ".glb") &&
      !g_str_has_suffix (writer->name, ".usda") &&
      !g_str_has_suffix (writer->name, ".c3d");
}

static gboolean
is_readable (const Writer * writer)
{
  return g_str_has_suffix (writer->name, ".obj") ||
      g_str_has_suffix (writer->name, ".ply") ||
      g_str_has_suffix (writer->name, ".take");
}

/* ---- faults ---- */

static void
check (const Writer * writer, const Fault * fault, guint nth, gboolean done,
    gboolean with_old, const GError * error, GHashTable * old, GHashTable * new)
{
  /* What can't be listed or removed stays; it is hidden. */
  const gboolean stays = g_str_equal (fault->call, "unlink") ||
      g_str_equal (fault->call, "rmdir") ||
      g_str_equal (fault->call, "lstat") ||
      g_str_equal (fault->call, "opendir");
  g_autoptr (GHashTable) files = look (!stays);
  gboolean good = is_same (files, new);
  g_autofree gchar *path = scratch_path (writer->name);

  /* What was recorded until then waits. */
  if (!done && is_recording (writer) && leaves_remains (path)) {
    g_assert_true (fault->weight != HARMLESS && error && *error->message);
    check_killed (path, with_old, is_readable (writer), old, new);
    n_left++;
    return;
  }

  if (done)
    good = good && fault->weight != FATAL;
  else
    good = fault->weight != HARMLESS && error && *error->message && (good ||
        is_same (files, old) || (writer->each && is_mixture (files, old, new)));
  if (!good) {
    g_autoptr (GString) text = g_string_new (NULL);

    list_into (text, files);
    g_error ("%s: %s %d, call %u: %s; there are%s", writer->name, fault->call,
        fault->code, nth, done ? "done" : error->message, text->str);
  }
}

static void
test_writer (gconstpointer data)
{
  const Writer *writer = data;
  const guint before = n_faults, left_before = n_left;

  scratch_begin ();
  for (guint with_old = 0; with_old < 2; with_old++) {
    g_autofree gchar *path = scratch_path (writer->name);
    g_autoptr (GHashTable) old = write_well (writer, with_old, 0);
    g_autoptr (GHashTable) new = write_well (writer, with_old, 1);

    for (guint i = 0; i < G_N_ELEMENTS (faults); i++) {
      for (guint nth = 1;; nth++) {
        g_autoptr (GError) error = NULL;
        gboolean done;

        begin (writer, with_old, 0);
        arm (faults[i].call, nth, faults[i].code, FALSE);
        done = writer->write (path, 1, &error);
        if (!fired ()) {
          g_assert_no_error (error);
          break;
        }
        n_faults++;
        check (writer, &faults[i], nth, done, with_old, error, old, new);
        g_assert_true (done == !error);
      }
    }
  }
  g_assert_cmpuint (n_faults, >, before + 20);
  g_assert_true (!lasts (writer) || n_left > left_before + 5);
  g_test_message ("%s: %u faults, %u recovered", writer->name,
      n_faults - before, n_left - left_before);
  scratch_end ();
}

/* ---- kills ---- */

/* A child is killed at each of its calls in turn. */
static void
test_kill (gconstpointer data)
{
  const Writer *writer = data;
  const guint before = n_kills;

  scratch_begin ();
  for (guint with_old = 0; with_old < 2; with_old++) {
    g_autofree gchar *path = scratch_path (writer->name);
    g_autoptr (GHashTable) old = write_well (writer, with_old, 0);
    g_autoptr (GHashTable) new = write_well (writer, with_old, 1);
    gint status = 0;

    for (guint nth = 1; nth == 1 || WIFSIGNALED (status); nth++) {
      pid_t child;

      begin (writer, with_old, 0);
      child = fork ();
      g_assert_cmpint (child, >=, 0);
      if (child == 0) {
        arm ("*", nth, CLOTH_FAULT_KILL, FALSE);
        writer->write (path, 1, NULL);
        _exit (0);
      }
      g_assert_cmpint (waitpid (child, &status, 0), ==, child);
      if (!WIFSIGNALED (status))
        break;
      g_assert_cmpint (WTERMSIG (status), ==, SIGKILL);
      n_kills++;
      check_killed (path, with_old, is_readable (writer), old, new);
    }
  }
  g_assert_cmpuint (n_kills, >, before + 20);
  g_test_message ("%s: %u kills", writer->name, n_kills - before);
  scratch_end ();
}

/* From some call on the disk is dead: putting back fails, too. What is there when it lives
 * again can be told and ended. */
static void
test_dead (gconstpointer data)
{
  static const gchar *const calls[] = { "*", "rename", "rmdir", "fsync" };
  const Writer *writer = data;
  const guint before = n_faults;

  scratch_begin ();
  for (guint with_old = 0; with_old < 2; with_old++) {
    g_autofree gchar *path = scratch_path (writer->name);
    g_autoptr (GHashTable) old = write_well (writer, with_old, 0);
    g_autoptr (GHashTable) new = write_well (writer, with_old, 1);

    for (guint i = 0; i < G_N_ELEMENTS (calls); i++) {
      for (guint nth = 1;; nth++) {
        g_autoptr (GError) error = NULL;
        gboolean done;

        begin (writer, with_old, 0);
        arm (calls[i], nth, EIO, TRUE);
        done = writer->write (path, 1, &error);
        if (!fired ())
          break;
        n_faults++;
        g_assert_true (done == !error);
        check_killed (path, with_old, is_readable (writer), old, new);
      }
    }
  }
  g_test_message ("%s: %u dead disks", writer->name, n_faults - before);
  scratch_end ();
}

/* What can't be removed is told. */
static void
test_lone (void)
{
  g_autofree gchar *path = NULL;
  g_autoptr (GError) error = NULL;
  ClothRecovered recovered;

  scratch_begin ();
  path = scratch_path (".rig.json.part-abcdef");
  g_assert_true (g_file_set_contents (path, "{", 1, NULL));
  arm ("unlink", 1, EACCES, FALSE);
  g_assert_false (cloth_recover (path, FALSE, &recovered, &error));
  g_assert_true (fired ());
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_PERMISSION_DENIED);
  g_clear_error (&error);
  g_assert_true (cloth_recover (path, FALSE, &recovered, &error));
  g_assert_cmpuint (scratch_count (), ==, 0);
  scratch_end ();
}

/* What is left is looked for while calls fail: nothing is made up, and nothing happens to
 * it. */
static void
test_look (void)
{
  static const gchar *const calls[] = { "open", "lstat", "opendir", "flock",
    "pread", "fstat"
  };
  g_autofree gchar *path = NULL;
  g_autoptr (GError) error = NULL;
  ClothMeshWriter *writer;
  g_autoptr (ClothTopology) topology =
      cloth_topology_new_grid (COLUMNS, ROWS, 0.5f, 0.25f);
  gfloat positions[3 * N] = { 0 };
  guint8 states[N] = { 0 };
  ClothMeshFrame frame = { positions, states, NULL };

  scratch_begin ();
  path = scratch_path ("c.obj");
  writer = cloth_mesh_writer_new (path, CLOTH_MESH_FORMAT_AUTO, NULL, topology,
      25, 1, &error);
  g_assert_true (cloth_mesh_writer_append (writer, 0, &frame, &error));
  g_assert_true (cloth_mesh_writer_leave (writer));
  cloth_mesh_writer_free (writer);
  for (guint i = 0; i < G_N_ELEMENTS (calls); i++) {
    for (guint nth = 1;; nth++) {
      ClothLeft left;

      arm (calls[i], nth, EIO, FALSE);
      left = cloth_recover_look (path, CLOTH_MESH_FORMAT_AUTO);
      if (!fired ()) {
        g_assert_cmpint (left, ==, CLOTH_LEFT_FRAMES);
        break;
      }
      n_faults++;
    }
  }
  scratch_end ();
}

/* What is older can't be looked at: it stays, or goes, and the new ones are there. */
static void
test_clear (void)
{
  static const gchar *const calls[] = { "lstat", "open", "opendir", "pread",
    "flock", "unlink", "rmdir"
  };
  g_autofree gchar *path = NULL;
  g_autofree gchar *older = NULL;
  g_autofree gchar *whole = NULL;
  g_autofree gchar *lock = NULL;

  scratch_begin ();
  path = scratch_path ("c.obj");
  older = scratch_path (".c.obj.part-older0");
  whole = g_build_filename (older, "new", NULL);
  lock = g_build_filename (older, "recording", NULL);
  for (guint i = 0; i < G_N_ELEMENTS (calls); i++) {
    gboolean struck = TRUE;

    for (guint nth = 1; struck; nth++) {
      g_autoptr (GError) error = NULL;
      gboolean done;
      guint n;

      arm ("", 0, 0, FALSE);
      empty_scratch ();
      g_assert_cmpint (g_mkdir_with_parents (whole, 0777), ==, 0);
      g_assert_true (g_file_set_contents (lock, "gst-cloth recording 1\n6\n",
              -1, NULL));
      arm (calls[i], nth, EIO, FALSE);
      done = write_mesh (path, 1, &error);
      struck = fired ();
      n_faults += struck;
      g_assert_true (done == !error);
      if (done)
        g_assert_cmpint (read_round (path, &n), ==, 1);
      g_assert_true (struck || !g_file_test (older, G_FILE_TEST_IS_DIR));
    }
  }
  scratch_end ();
}

/* However often a cleaner is quicker, it ends. */
static void
test_cleaner (void)
{
  static const gint codes[] = { EWOULDBLOCK, CLOTH_FAULT_CLEARED };

  scratch_begin ();
  for (guint i = 0; i < G_N_ELEMENTS (codes); i++) {
    g_autofree gchar *path = scratch_path ("c.obj");
    g_autoptr (GError) error = NULL;

    arm ("flock", 1, codes[i], TRUE);
    g_assert_null (cloth_output_new (path, &error));
    g_assert_true (fired ());
    g_assert_nonnull (error);
    g_clear_error (&error);
    arm ("flock", 1, codes[i], TRUE);
    g_assert_null (cloth_parts_new (path, "", &error));
    g_assert_true (fired ());
    g_assert_nonnull (error);
    g_assert_cmpuint (scratch_count (), ==, 0);
  }
  scratch_end ();
}

/* Recovering fails as well as writing does: what can be recovered stays so. */
static void
test_recover (gconstpointer data)
{
  const Writer *writer = data;
  g_autofree gchar *path = NULL;
  guint n_calls = 0, at, before = n_faults;
  gint status;

  scratch_begin ();
  path = scratch_path (writer->name);
  for (at = 1;; at++) {
    pid_t child = fork ();

    if (child == 0) {
      arm ("*", at, CLOTH_FAULT_KILL, FALSE);
      writer->write (path, 1, NULL);
      _exit (0);
    }
    g_assert_cmpint (waitpid (child, &status, 0), ==, child);
    empty_scratch ();
    if (!WIFSIGNALED (status))
      break;
  }
  n_calls = at - 1;
  /* The first ones make the folder. */
  for (at = 1; at < n_calls; at += at < 24 ? 1 : MAX (n_calls / 8, 1)) {
    for (guint i = 0; i < G_N_ELEMENTS (faults); i++) {
      for (guint nth = 1;; nth++) {
        g_autoptr (GError) error = NULL;
        ClothRecovered recovered;
        gboolean found, struck;
        pid_t child;

        empty_scratch ();
        child = fork ();
        if (child == 0) {
          arm ("*", at, CLOTH_FAULT_KILL, FALSE);
          writer->write (path, 1, NULL);
          _exit (0);
        }
        g_assert_cmpint (waitpid (child, &status, 0), ==, child);
        arm (faults[i].call, nth, faults[i].code, FALSE);
        found = recover (path, FALSE, &recovered, &error);
        struck = fired ();
        if (struck) {
          n_faults++;
          /* Another one was quicker, and nothing would be there any more. */
          if (faults[i].code == CLOTH_FAULT_CLEARED) {
            g_assert_error (error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
            continue;
          }
          /* EWOULDBLOCK is the lock of a living writer. */
          if (faults[i].weight == HARMLESS
              && !g_str_equal (faults[i].call, "flock"))
            g_assert_no_error (error);
          g_clear_error (&error);
          memset (&recovered, 0, sizeof recovered);
          found = recover (path, TRUE, &recovered, &error) || found;
        }
        g_assert_no_error (error);
        if (found && (recovered.placed || recovered.n_frames > 0)) {
          guint n;

          g_assert_cmpint (read_round (path, &n), ==, 1);
          if (!recovered.placed)
            g_assert_cmpuint (n, ==, recovered.n_frames);
        }
        if (!struck)
          break;
      }
    }
  }
  g_test_message ("recovering %s: %u faults", writer->name, n_faults - before);
  scratch_end ();
}

/* ---- spools ---- */

static const ClothSpoolOptions spool_options = { "test", "0", 60. };

/* A manager puts two jobs, a worker does them, the manager takes the results. Two rounds over the
 * results are enough. */
static gboolean
run_spool (const gchar * path, gboolean resume, guint * n_results,
    GError ** error)
{
  g_autoptr (ClothSpool) manager = cloth_spool_manage (path, &spool_options,
      "p", resume, error);
  g_autoptr (ClothSpool) worker = NULL;
  GError *fault = NULL;

  *n_results = 0;
  if (!manager || !cloth_spool_put (manager, "1", "{\"n\": 1}", TRUE, error) ||
      !cloth_spool_put (manager, "2", "{\"n\": 2}", TRUE, error) ||
      !(worker = cloth_spool_join (path, &spool_options, 0., error)) ||
      !cloth_spool_look_after (manager, error))
    return FALSE;
  for (;;) {
    g_autoptr (ClothSpoolJob) job = cloth_spool_claim (worker, &fault);

    if (!job)
      break;
    if (!cloth_spool_finish (worker, job, job->json, FALSE, error)) {
      cloth_spool_give_back (worker, job, NULL);
      return FALSE;
    }
  }
  for (guint i = 0; !fault && i < 6; i++) {
    g_autoptr (ClothSpoolJob) result = cloth_spool_take (manager, &fault);
    g_autofree gchar *expected = result ?
        g_strdup_printf ("{\"n\": %s}", result->id) : NULL;

    *n_results += result && !result->failed &&
        g_str_equal (result->json, expected);
  }
  if (!fault && *n_results == 2)
    return cloth_spool_close (manager, error);
  if (fault)
    g_propagate_error (error, fault);
  return FALSE;
}

/* Whatever failed, a resumed manager gets every result. A job that could not be read has failed,
 * and is tried again. */
static void
check_spool (const gchar * path, const gchar * what, guint nth)
{
  g_autoptr (GError) error = NULL;
  guint n = 0;

  if (!run_spool (path, TRUE, &n, &error) || n != 2)
    g_error ("spool: %s, call %u: %u of 2 results, %s", what, nth, n,
        error ? error->message : "no error");
}

static void
test_spool (void)
{
  const guint before = n_faults, kills_before = n_kills;
  g_autofree gchar *path = NULL;
  gint status = 0;

  scratch_begin ();
  path = scratch_path ("spool");
  for (guint i = 0; i < G_N_ELEMENTS (faults); i++) {
    for (guint nth = 1;; nth++) {
      g_autoptr (GError) error = NULL;
      gboolean done;
      guint n;

      empty_scratch ();
      arm (faults[i].call, nth, faults[i].code, FALSE);
      done = run_spool (path, FALSE, &n, &error);
      if (!fired ()) {
        g_assert_no_error (error);
        g_assert_true (done);
        break;
      }
      n_faults++;
      check_spool (path, faults[i].call, nth);
    }
  }
  for (guint nth = 1; nth == 1 || WIFSIGNALED (status); nth++) {
    pid_t child;
    guint n;

    empty_scratch ();
    child = fork ();
    g_assert_cmpint (child, >=, 0);
    if (child == 0) {
      arm ("*", nth, CLOTH_FAULT_KILL, FALSE);
      run_spool (path, FALSE, &n, NULL);
      _exit (0);
    }
    g_assert_cmpint (waitpid (child, &status, 0), ==, child);
    if (!WIFSIGNALED (status))
      break;
    n_kills++;
    check_spool (path, "killed", nth);
  }
  g_assert_cmpuint (n_faults, >, before + 100);
  g_assert_cmpuint (n_kills, >, kills_before + 50);
  g_test_message ("spool: %u faults, %u kills", n_faults - before,
      n_kills - kills_before);
  scratch_end ();
}

int
main (int argc, char **argv)
{
  g_autoptr (GError) error = NULL;
  gint failed;

  /* In memory where that can be had: there are ten thousands of recordings. */
  if (g_access ("/dev/shm", W_OK | X_OK) == 0)
    g_setenv ("TMPDIR", "/dev/shm", TRUE);
  g_test_init (&argc, &argv, NULL);
  *(void **) &arm = dlsym (RTLD_DEFAULT, "cloth_fault_arm");
  *(void **) &fired = dlsym (RTLD_DEFAULT, "cloth_fault_fired");
  if (!arm || !fired)
    g_error ("run this by meson: it needs the library of faults preloaded");
  for (guint i = 0; i < G_N_ELEMENTS (writers); i++) {
    g_autofree gchar *fault = g_strconcat ("/fault/", writers[i].name, NULL);
    g_autofree gchar *killed = g_strconcat ("/kill/", writers[i].name, NULL);
    g_autofree gchar *dead = g_strconcat ("/dead/", writers[i].name, NULL);
    g_autofree gchar *again = g_strconcat ("/recover/", writers[i].name, NULL);

    g_test_add_data_func (fault, &writers[i], test_writer);
    if (is_recording (&writers[i])) {
      g_test_add_data_func (killed, &writers[i], test_kill);
      g_test_add_data_func (dead, &writers[i], test_dead);
    }
    if (i < 3)
      g_test_add_data_func (again, &writers[i], test_recover);
  }
  g_test_add_func ("/spool", test_spool);
  g_test_add_func ("/lone", test_lone);
  g_test_add_func ("/look", test_look);
  g_test_add_func ("/clear", test_clear);
  g_test_add_func ("/cleaner", test_cleaner);
  rigs[0] = cloth_rig_load (TEST_DATA "/checker_pair/rig.json", &error);
  g_assert_no_error (error);
  rigs[1] = cloth_rig_load (TEST_DATA "/dots_ring8/rig.json", &error);
  g_assert_no_error (error);
  model = cloth_model_load (TEST_DATA "/arcsim/model.json", &error);
  g_assert_no_error (error);
  failed = g_test_run ();
  cloth_rig_free (rigs[0]);
  cloth_rig_free (rigs[1]);
  cloth_model_free (model);
  g_print ("# %u faults and %u kills in all\n", n_faults, n_kills);
  return failed;
}
