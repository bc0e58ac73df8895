/* Recordings whose program was killed: what is kept, what is refused, what is left alone.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "gst/mesh/garment/garment.h"
#include "gst/take/recover.h"
#include "gst/take/take.h"
#include "tests/core/meshpeer.h"

#define COLUMNS 4
#define ROWS 3
#define N (COLUMNS * ROWS)

static ClothTopology *
make_topology (void)
{
  return cloth_topology_new_grid (COLUMNS, ROWS, 0.75f, 0.5f);
}

static gfloat
value_of (guint round, guint frame, guint i)
{
  return (gfloat) (1000 * round + 100 * frame + i) + 0.5f;
}

static gboolean
append (ClothMeshWriter * writer, guint round, guint frame,
    gboolean with_covariances)
{
  gfloat positions[3 * N], covariances[6 * N];
  guint8 states[N];
  ClothMeshFrame contents = { positions, states,
    with_covariances ? covariances : NULL
  };

  for (guint i = 0; i < 3 * N; i++)
    positions[i] = value_of (round, frame, i);
  for (guint i = 0; i < 6 * N; i++)
    covariances[i] = i % 6 == 0 || i % 6 == 3 || i % 6 == 5 ? 4e-6f : 0;
  memset (states, CLOTH_VERTEX_TWO_VIEWS, sizeof states);
  return cloth_mesh_writer_append (writer, frame / 25., &contents, NULL);
}

static ClothMeshWriter *
start (const gchar * path)
{
  g_autoptr (ClothTopology) topology = make_topology ();
  g_autoptr (GError) error = NULL;
  ClothMeshWriter *writer = cloth_mesh_writer_new (path, CLOTH_MESH_FORMAT_AUTO,
      NULL, topology, 25, 1, &error);

  g_assert_no_error (error);
  return writer;
}

/* A whole recording. */
static void
record (const gchar * path, guint round, guint n_frames)
{
  g_autoptr (ClothMeshWriter) writer = start (path);
  g_autoptr (GError) error = NULL;

  for (guint f = 0; f < n_frames; f++)
    g_assert_true (append (writer, round, f, FALSE));
  g_assert_true (cloth_mesh_writer_close (writer, &error));
  g_assert_no_error (error);
}

/* A program that is killed when it has @n_frames; from @covariances on with these. */
static void
be_killed (const gchar * path, guint round, guint n_frames, guint covariances)
{
  gint status;
  pid_t child = fork ();

  g_assert_cmpint (child, >=, 0);
  if (child == 0) {
    ClothMeshWriter *writer = start (path);

    for (guint f = 0; f < n_frames; f++)
      if (!append (writer, round, f, f >= covariances))
        _exit (1);
    kill (getpid (), SIGKILL);
  }
  g_assert_cmpint (waitpid (child, &status, 0), ==, child);
  g_assert_true (WIFSIGNALED (status));
}

/* The only remains at @path. */
static gchar *
find_one (const gchar * path)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (GPtrArray) found = cloth_recover_find (path, &error);

  g_assert_no_error (error);
  g_assert_cmpuint (found->len, ==, 1);
  return g_strdup (found->pdata[0]);
}

static void
assert_nothing_left (const gchar * path)
{
  g_autoptr (GPtrArray) found = cloth_recover_find (path, NULL);

  g_assert_cmpuint (found ? found->len : 0, ==, 0);
}

static void
assert_frames (const gchar * path, guint round, guint n_frames)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothMeshReader) reader =
      cloth_mesh_reader_open (path, CLOTH_MESH_FORMAT_AUTO, &error);
  ClothMeshFrame frame;

  g_assert_no_error (error);
  g_assert_cmpuint (cloth_mesh_reader_get_n_frames (reader), ==, n_frames);
  g_assert_cmpfloat (cloth_mesh_reader_get_fps (reader), ==, 25);
  for (guint f = 0; f < n_frames; f++) {
    g_assert_true (cloth_mesh_reader_read (reader, f, &frame, &error));
    for (guint i = 0; i < 3 * N; i++)
      g_assert_cmpfloat (frame.positions[i], ==, value_of (round, f, i));
    for (guint i = 0; i < N; i++)
      g_assert_cmpuint (frame.states[i], ==, CLOTH_VERTEX_TWO_VIEWS);
  }
}

static const gchar *const readable[] = { "c.obj", "c.ply", "c.take" };

static void
test_kept (void)
{
  scratch_begin ();
  for (guint i = 0; i < G_N_ELEMENTS (readable); i++) {
    g_autofree gchar *path = scratch_path (readable[i]);
    g_autofree gchar *left = NULL;
    g_autofree gchar *target = NULL;
    g_autoptr (GError) error = NULL;
    ClothRecovered recovered;

    be_killed (path, 1, 7, G_MAXUINT);
    /* Nothing can be read before. */
    g_assert_null (cloth_mesh_reader_open (path, CLOTH_MESH_FORMAT_AUTO, NULL));
    g_assert_cmpint (cloth_recover_look (path, CLOTH_MESH_FORMAT_AUTO), ==,
        CLOTH_LEFT_FRAMES);
    left = find_one (path);
    target = cloth_recover_get_target (left);
    g_assert_cmpstr (target, ==, path);
    g_assert_true (cloth_recover (left, FALSE, &recovered, &error));
    g_assert_no_error (error);
    g_assert_cmpuint (recovered.n_frames, ==, 7);
    g_assert_cmpuint (recovered.n_left_out, ==, 0);
    g_assert_false (recovered.placed);
    g_assert_null (recovered.dropped);
    assert_frames (path, 1, 7);
    assert_nothing_left (path);
    g_assert_cmpint (cloth_recover_look (path, CLOTH_MESH_FORMAT_AUTO), ==,
        CLOTH_LEFT_NOTHING);
  }
  scratch_end ();
}

/* By the folder, in which there may be several. */
static void
test_folder (void)
{
  g_autoptr (GPtrArray) found = NULL;
  g_autofree gchar *obj = NULL;
  g_autofree gchar *ply = NULL;

  scratch_begin ();
  obj = scratch_path ("a.obj");
  ply = scratch_path ("b.ply");
  be_killed (obj, 0, 2, G_MAXUINT);
  be_killed (ply, 0, 3, G_MAXUINT);
  found = cloth_recover_find (scratch, NULL);
  g_assert_cmpuint (found->len, ==, 2);
  for (guint i = 0; i < 2; i++) {
    ClothRecovered recovered;

    g_assert_true (cloth_recover (found->pdata[i], FALSE, &recovered, NULL));
  }
  assert_frames (obj, 0, 2);
  assert_frames (ply, 0, 3);
  scratch_end ();
}

static void
cut (const gchar * left, const gchar * name, gint64 bytes)
{
  g_autofree gchar *path = g_build_filename (left, name, NULL);
  GStatBuf info;

  g_assert_cmpint (g_stat (path, &info), ==, 0);
  g_assert_cmpint (truncate (path, info.st_size - bytes), ==, 0);
}

/* One frame more was begun. */
static void
test_last_frame_cut (void)
{
  static const struct
  {
    const gchar *name, *file;
    gint64 bytes;
    guint n_frames;
  } cases[] = {
    {"c.obj", "c.pc2", 1, 4}, {"c.obj", "c.states.npy", 1, 4},
    {"c.obj", "c.pc2", 12 * N, 4}, {"c.obj", "c.pc2", 2 * 12 * N + 4, 2},
    {"c.take", "positions.npy", 5, 4}, {"c.take", "states.npy", N, 4},
    {"c.take", "times.npy", 8 + 1, 3}, {"c.take", "covariance.npy", 1, 4}
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autofree gchar *path = NULL;
    g_autofree gchar *left = NULL;
    g_autoptr (GError) error = NULL;
    ClothRecovered recovered;

    scratch_begin ();
    path = scratch_path (cases[i].name);
    be_killed (path, 2, 5, 0);
    left = find_one (path);
    cut (left, cases[i].file, cases[i].bytes);
    g_assert_true (cloth_recover (left, FALSE, &recovered, &error));
    g_assert_no_error (error);
    g_assert_cmpuint (recovered.n_frames, ==, cases[i].n_frames);
    g_assert_cmpuint (recovered.n_left_out, ==, 5 - cases[i].n_frames);
    assert_frames (path, 2, cases[i].n_frames);
    assert_nothing_left (path);
    scratch_end ();
  }
}

/* A table has the lines of whole frames only. */
static void
test_csv (void)
{
  for (gint64 bytes = 0; bytes < 3; bytes++) {
    g_autofree gchar *path = NULL;
    g_autofree gchar *left = NULL;
    g_autofree gchar *text = NULL;
    g_auto (GStrv) lines = NULL;
    ClothRecovered recovered;

    scratch_begin ();
    path = scratch_path ("c.csv");
    be_killed (path, 0, 1 + (guint) bytes, 0);
    left = find_one (path);
    cut (left, "c.csv", bytes);
    g_assert_true (cloth_recover (left, FALSE, &recovered, NULL));
    /* one frame alone, then without the last one */
    g_assert_cmpuint (recovered.n_frames, ==, bytes == 0 ? 1 : bytes);
    g_assert_cmpuint (recovered.n_left_out, ==, bytes > 0);
    g_assert_true (g_file_get_contents (path, &text, NULL, NULL));
    lines = g_strsplit (text, "\n", -1);
    g_assert_cmpuint (g_strv_length (lines), ==, 1 + N * recovered.n_frames +
        1);
    scratch_end ();
  }
}

/* Covariances that begin late are filled up; a kill may come in between. */
static void
test_dropped (void)
{
  g_autofree gchar *path = NULL;
  g_autofree gchar *left = NULL;
  g_autofree gchar *stale = NULL;
  ClothRecovered recovered;

  scratch_begin ();
  path = scratch_path ("c.take");
  be_killed (path, 0, 5, 4);
  left = find_one (path);
  cut (left, "covariance.npy", 3 * 24 * N);
  g_assert_true (cloth_recover (left, FALSE, &recovered, NULL));
  g_assert_cmpuint (recovered.n_frames, ==, 5);
  g_assert_cmpstr (recovered.dropped, ==, "covariance.npy");
  assert_frames (path, 0, 5);
  stale = g_build_filename (path, "covariance.npy", NULL);
  g_assert_false (g_file_test (stale, G_FILE_TEST_EXISTS));
  scratch_end ();
}

static void
test_no_frame (void)
{
  static const gchar *const names[] = { "c.obj", "c.ply", "c.pvd", "c.csv",
    "c.take"
  };

  for (guint i = 0; i < G_N_ELEMENTS (names); i++) {
    g_autofree gchar *path = NULL;
    g_autofree gchar *left = NULL;
    ClothRecovered recovered;

    scratch_begin ();
    path = scratch_path (names[i]);
    be_killed (path, 0, 0, G_MAXUINT);
    left = find_one (path);
    g_assert_true (cloth_recover (left, FALSE, &recovered, NULL));
    g_assert_cmpuint (recovered.n_frames, ==, 0);
    assert_nothing_left (path);
    g_assert_null (cloth_mesh_reader_open (path, CLOTH_MESH_FORMAT_AUTO, NULL));
    scratch_end ();
  }
}

/* Formats that end at their beginning say that they are lost, and stay. */
static void
test_lost (void)
{
  static const gchar *const names[] = { "c.glb", "c.usda", "c.c3d" };

  for (guint i = 0; i < G_N_ELEMENTS (names); i++) {
    g_autofree gchar *path = NULL;
    g_autofree gchar *left = NULL;
    g_autoptr (GError) error = NULL;
    ClothRecovered recovered;

    scratch_begin ();
    path = scratch_path (names[i]);
    be_killed (path, 0, 3, G_MAXUINT);
    g_assert_cmpint (cloth_recover_look (path, CLOTH_MESH_FORMAT_AUTO), ==,
        CLOTH_LEFT_LOST);
    left = find_one (path);
    g_assert_false (cloth_recover (left, FALSE, &recovered, &error));
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_UNSUPPORTED);
    g_assert_nonnull (strstr (error->message, "Record a take"));
    g_assert_true (g_file_test (left, G_FILE_TEST_IS_DIR));
    /* until the next one is whole */
    record (path, 0, 2);
    assert_nothing_left (path);
    scratch_end ();
  }
}

static void
test_never_overwrites (void)
{
  scratch_begin ();
  for (guint i = 0; i < G_N_ELEMENTS (readable); i++) {
    g_autofree gchar *path = scratch_path (readable[i]);
    g_autofree gchar *left = NULL;
    g_autoptr (GError) error = NULL;
    ClothRecovered recovered;

    record (path, 0, 6);
    be_killed (path, 3, 4, G_MAXUINT);
    left = find_one (path);
    g_assert_false (cloth_recover (left, FALSE, &recovered, &error));
    g_assert_error (error, G_IO_ERROR, G_IO_ERROR_EXISTS);
    assert_frames (path, 0, 6);
    /* told to, it does, and nothing of the longer one stays */
    g_clear_error (&error);
    g_assert_true (cloth_recover (left, TRUE, &recovered, &error));
    g_assert_no_error (error);
    assert_frames (path, 3, 4);
  }
  scratch_end ();
}

/* Frames that a longer recording has under the next numbers would be read with these. */
static void
test_longer (void)
{
  g_autofree gchar *path = NULL;
  g_autofree gchar *left = NULL;
  g_autofree gchar *next = NULL;
  g_autoptr (GError) error = NULL;
  ClothRecovered recovered;

  scratch_begin ();
  path = scratch_path ("c.ply");
  next = scratch_path ("c_00003.ply");
  be_killed (path, 1, 3, G_MAXUINT);
  left = find_one (path);
  g_assert_true (g_file_set_contents (next, "mine", -1, NULL));
  g_assert_false (cloth_recover (left, FALSE, &recovered, &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_EXISTS);
  g_assert_true (g_file_test (next, G_FILE_TEST_EXISTS));
  g_clear_error (&error);
  g_assert_true (cloth_recover (left, TRUE, &recovered, &error));
  g_assert_false (g_file_test (next, G_FILE_TEST_EXISTS));
  assert_frames (path, 1, 3);
  scratch_end ();
}

/* A living writer keeps its parts, and others don't clear them. */
static void
test_living (void)
{
  scratch_begin ();
  for (guint i = 0; i < G_N_ELEMENTS (readable); i++) {
    g_autofree gchar *path = scratch_path (readable[i]);
    g_autoptr (ClothMeshWriter) writer = start (path);
    g_autofree gchar *left = NULL;
    g_autoptr (GError) error = NULL;
    ClothRecovered recovered;

    g_assert_true (append (writer, 1, 0, FALSE));
    left = find_one (path);
    g_assert_cmpint (cloth_recover_look (path, CLOTH_MESH_FORMAT_AUTO), ==,
        CLOTH_LEFT_NOTHING);
    g_assert_false (cloth_recover (left, TRUE, &recovered, &error));
    g_assert_error (error, G_IO_ERROR, G_IO_ERROR_BUSY);
    record (path, 0, 3);
    assert_frames (path, 0, 3);
    g_assert_true (append (writer, 1, 1, FALSE));
    g_clear_error (&error);
    g_assert_true (cloth_mesh_writer_close (writer, &error));
    g_assert_no_error (error);
    assert_frames (path, 1, 2);
  }
  scratch_end ();
}

static gchar *
find_lone (const gchar * folder)
{
  g_autoptr (GDir) dir = g_dir_open (folder, 0, NULL);
  const gchar *name = g_dir_read_name (dir);

  g_assert_nonnull (name);
  return g_build_filename (folder, name, NULL);
}

static void
test_living_lone_file (void)
{
  g_autoptr (GPtrArray) named = NULL;
  g_autofree gchar *path = NULL;
  g_autofree gchar *left = NULL;
  g_autofree gchar *dead = NULL;
  g_autoptr (ClothOutput) output = NULL;
  g_autoptr (GError) error = NULL;
  ClothRecovered recovered;

  scratch_begin ();
  path = scratch_path ("rig.json");
  output = cloth_output_new (path, &error);
  g_assert_no_error (error);
  /* It is found when it is named itself. */
  assert_nothing_left (scratch);
  left = find_lone (scratch);
  named = cloth_recover_find (left, &error);
  g_assert_cmpuint (named->len, ==, 1);
  g_assert_cmpstr (named->pdata[0], ==, left);
  g_assert_false (cloth_recover (left, TRUE, &recovered, &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_BUSY);
  g_clear_error (&error);
  g_assert_true (cloth_output_commit (output, &error));
  g_assert_no_error (error);
  /* that of a program that is gone goes */
  dead = scratch_path (".rig.json.part-abcdef");
  g_assert_true (g_file_set_contents (dead, "{", 1, NULL));
  g_assert_true (cloth_recover (dead, FALSE, &recovered, &error));
  g_assert_false (g_file_test (dead, G_FILE_TEST_EXISTS));
  g_assert_true (g_file_test (path, G_FILE_TEST_EXISTS));
  scratch_end ();
}

/* The next recording leaves the interrupted one where it can be finished. */
static void
test_next (void)
{
  scratch_begin ();
  for (guint i = 0; i < G_N_ELEMENTS (readable); i++) {
    g_autofree gchar *path = scratch_path (readable[i]);
    g_autofree gchar *left = NULL;
    g_autofree gchar *empty = NULL;
    g_autofree gchar *other = NULL;
    g_autofree gchar *lock = NULL;
    g_autofree gchar *lone = NULL;
    g_autoptr (GPtrArray) found = NULL;
    g_autoptr (GError) error = NULL;
    ClothMeshWriter *writer;
    ClothRecovered recovered;

    be_killed (path, 1, 7, G_MAXUINT);
    left = find_one (path);
    be_killed (path, 1, 0, G_MAXUINT);
    found = cloth_recover_find (path, NULL);
    g_assert_cmpuint (found->len, ==, 2);
    other = i == 2 ? g_build_filename (path, ".take.json.part-other0", NULL) :
        g_strdup_printf ("%s/.%s.part-other0", scratch, readable[i]);
    lock = g_build_filename (other, "recording", NULL);
    g_assert_cmpint (g_mkdir (other, 0777), ==, 0);
    g_assert_true (g_file_set_contents (lock, "mine", -1, NULL));
    lone = g_strdup (other);
    lone[strlen (lone) - 1] = '1';
    g_assert_true (g_file_set_contents (lone, "mine", -1, NULL));
    writer = start (path);
    g_assert_true (append (writer, 2, 0, FALSE));
    cloth_mesh_writer_free (writer);
    record (path, 2, 3);
    /* The one without a frame is gone, somebody else's is not. */
    scratch_remove (other);
    g_assert_cmpint (g_unlink (lone), ==, 0);
    empty = find_one (path);
    g_assert_cmpstr (empty, ==, left);
    g_assert_cmpint (cloth_recover_look (path, CLOTH_MESH_FORMAT_AUTO), ==,
        CLOTH_LEFT_FRAMES);
    assert_frames (path, 2, 3);
    g_assert_true (cloth_recover (left, TRUE, &recovered, &error));
    g_assert_no_error (error);
    assert_nothing_left (path);
    assert_frames (path, 1, 7);
  }
  scratch_end ();
}

/* An error ends a recording: its frames wait, where there are some that can be read. */
static void
test_left (void)
{
  static const struct
  {
    const gchar *name;
    guint n_frames;
    gboolean stays;
  } cases[] = {
    {"c.obj", 3, TRUE}, {"c.ply", 1, TRUE}, {"c.take", 3, TRUE},
    {"c.pvd", 2, TRUE}, {"c.csv", 2, TRUE}, {"d.obj", 0, FALSE},
    {"d.take", 0, FALSE}, {"c.glb", 3, FALSE}, {"c.usda", 3, FALSE},
    {"c.c3d", 3, FALSE}
  };

  scratch_begin ();
  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autofree gchar *path = scratch_path (cases[i].name);
    g_autofree gchar *left = NULL;
    g_autoptr (GError) error = NULL;
    ClothMeshWriter *writer = start (path);
    ClothRecovered recovered;

    for (guint f = 0; f < cases[i].n_frames; f++)
      g_assert_true (append (writer, 1, f, FALSE));
    g_assert_true (cloth_mesh_writer_leave (writer) == cases[i].stays);
    cloth_mesh_writer_free (writer);
    if (!cases[i].stays) {
      assert_nothing_left (path);
      continue;
    }
    left = find_one (path);
    g_assert_true (cloth_recover (left, FALSE, &recovered, &error));
    g_assert_no_error (error);
    g_assert_cmpuint (recovered.n_frames, ==, cases[i].n_frames);
    g_assert_cmpuint (recovered.n_left_out, ==, 0);
    assert_nothing_left (path);
    if (i < G_N_ELEMENTS (readable))
      assert_frames (path, 1, cases[i].n_frames);
  }
  scratch_end ();
}

/* Another program gives its files the same names just now. */
static void
test_concurrent (void)
{
  static const gchar *const subs[] = { "old", "placing" };

  for (guint k = 0; k < G_N_ELEMENTS (subs); k++) {
    g_autofree gchar *path = NULL;
    g_autofree gchar *other = NULL;
    g_autofree gchar *sub = NULL;
    g_autoptr (ClothMeshWriter) first = NULL;
    g_autoptr (ClothMeshWriter) second = NULL;
    g_autoptr (GError) error = NULL;

    scratch_begin ();
    path = scratch_path ("c.obj");
    record (path, 0, 2);
    first = start (path);
    other = find_one (path);
    sub = g_build_filename (other, subs[k], NULL);
    g_assert_cmpint (g_mkdir (sub, 0777), ==, 0);
    second = start (path);
    g_assert_true (append (second, 2, 0, FALSE));
    g_assert_false (cloth_mesh_writer_close (second, &error));
    g_assert_error (error, G_IO_ERROR, G_IO_ERROR_BUSY);
    g_assert_true (cloth_mesh_writer_leave (second));
    g_assert_cmpint (g_rmdir (sub), ==, 0);
    assert_frames (path, 0, 2);
    scratch_end ();
  }
}

/* A reader has opened one file of a recording when another one takes the names. */
static void
test_replaced_meanwhile (void)
{
  g_autofree gchar *path = NULL;
  g_autofree gchar *sub = NULL;
  g_autoptr (GError) error = NULL;
  ClothPlaced placed;

  scratch_begin ();
  path = scratch_path ("c.obj");
  record (path, 0, 2);
  g_assert_true (cloth_parts_begin_reading (path, &placed, &error));
  g_assert_true (cloth_parts_end_reading (path, &placed, &error));
  record (path, 1, 2);
  g_assert_false (cloth_parts_end_reading (path, &placed, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
  g_assert_nonnull (strstr (error->message, "try again"));
  g_clear_error (&error);
  /* just now */
  g_assert_true (cloth_parts_begin_reading (path, &placed, &error));
  sub = scratch_path (".c.obj.part-abcdef/placing");
  g_assert_cmpint (g_mkdir_with_parents (sub, 0777), ==, 0);
  g_assert_false (cloth_parts_end_reading (path, &placed, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
  g_assert_nonnull (strstr (error->message, "only a part"));
  scratch_end ();
}

/* When the computer loses its power, files that had been written to may be empty. */
static void
test_power (void)
{
  static const gchar *const names[] = { "c.ply", "c.pvd", "c.ply" };

  for (guint i = 0; i < G_N_ELEMENTS (names); i++) {
    const gchar *ending = i == 1 ? ".vtp" : ".ply";
    g_autofree gchar *path = NULL;
    g_autofree gchar *left = NULL;
    g_autofree gchar *empty = NULL;
    g_autofree gchar *last = NULL;
    g_autofree gchar *next = NULL;
    g_autoptr (GError) error = NULL;
    ClothRecovered recovered;

    scratch_begin ();
    path = scratch_path (names[i]);
    be_killed (path, 1, 5, G_MAXUINT);
    left = find_one (path);
    empty = g_strconcat (left, "/new/c_00003", ending, NULL);
    last = g_strconcat (left, "/new/c_00004", ending, NULL);
    g_assert_cmpint (truncate (empty, 0), ==, 0);
    /* a whole one behind it is not thrown away */
    g_assert_false (cloth_recover (left, FALSE, &recovered, &error));
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
    g_assert_nonnull (strstr (error->message, "c_00003"));
    g_clear_error (&error);
    g_assert_cmpint (truncate (last, 0), ==, 0);
    if (i == 2) {
      g_assert_cmpint (g_unlink (last), ==, 0);
      g_assert_cmpint (mkfifo (last, 0600), ==, 0);
    }
    /* nor is a pipe whole */
    if (i == 2) {
      g_assert_cmpint (g_unlink (empty), ==, 0);
      g_assert_cmpint (mkfifo (empty, 0600), ==, 0);
    }
    g_assert_true (cloth_recover (left, FALSE, &recovered, &error));
    g_assert_no_error (error);
    g_assert_cmpuint (recovered.n_frames, ==, 3);
    next = g_strconcat (scratch, "/c_00003", ending, NULL);
    g_assert_false (g_file_test (next, G_FILE_TEST_EXISTS));
    if (i != 1)
      assert_frames (path, 1, 3);
    g_assert_cmpuint (scratch_count (), ==, i == 1 ? 4 : 3);
    scratch_end ();
  }
}

/* A garment has two files that belong together. */
static void
test_garment (void)
{
  g_autofree gchar *path = NULL;
  g_autofree gchar *sub = NULL;
  g_autoptr (ClothGarment) garment = cloth_garment_new ();
  g_autoptr (ClothGarment) again = NULL;
  g_autoptr (GError) error = NULL;

  scratch_begin ();
  path = scratch_path ("garment.json");
  garment->topology = make_topology ();
  garment->dots = g_new (gint, N);
  garment->columns = COLUMNS;
  garment->rows = ROWS;
  for (gint v = 0; v < N; v++)
    garment->dots[v] = v;
  g_assert_true (cloth_garment_save (garment, scratch, &error));
  sub = scratch_path (".garment.json.part-abcdef/placing");
  g_assert_cmpint (g_mkdir_with_parents (sub, 0777), ==, 0);
  g_assert_null (cloth_garment_load (path, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
  g_assert_nonnull (strstr (error->message, "only a part"));
  g_clear_error (&error);
  g_assert_cmpint (g_rmdir (sub), ==, 0);
  again = cloth_garment_load (path, &error);
  g_assert_no_error (error);
  g_assert_cmpuint (again->topology->n_vertices, ==, N);
  scratch_end ();
}

/* A folder and all that is in it was last written to at a time. */
static void
set_age (const gchar * path, const struct timespec times[2])
{
  g_autoptr (GDir) dir = g_dir_open (path, 0, NULL);
  const gchar *name;

  while (dir && (name = g_dir_read_name (dir))) {
    g_autofree gchar *file = g_build_filename (path, name, NULL);

    g_assert_cmpint (utimensat (AT_FDCWD, file, times, 0), ==, 0);
  }
  g_assert_cmpint (utimensat (AT_FDCWD, path, times, 0), ==, 0);
}

/* The newest comes first, and the older one stays. A folder is as new as what is in it. */
static void
test_several (void)
{
  g_autofree gchar *path = NULL;
  g_autoptr (GPtrArray) found = NULL;
  g_autoptr (GError) error = NULL;
  struct timespec times[2] = { {1000, 0}, {1000, 0} };
  g_autofree gchar *lone = NULL;
  g_autofree gchar *other = NULL;
  ClothRecovered recovered;

  scratch_begin ();
  path = scratch_path ("c.obj");
  be_killed (path, 1, 2, G_MAXUINT);
  {
    g_autofree gchar *older = find_one (path);

    set_age (older, times);
  }
  be_killed (path, 2, 3, G_MAXUINT);
  found = cloth_recover_find (path, NULL);
  g_assert_cmpuint (found->len, ==, 2);
  g_assert_true (cloth_recover (found->pdata[0], FALSE, &recovered, &error));
  assert_frames (path, 2, 3);
  g_assert_false (cloth_recover (found->pdata[1], FALSE, &recovered, &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_EXISTS);
  g_assert_true (g_file_test (found->pdata[1], G_FILE_TEST_IS_DIR));
  /* of the same age: by their names */
  lone = scratch_path (".c.obj.part-000000");
  g_assert_cmpint (g_mkdir (lone, 0777), ==, 0);
  g_assert_cmpint (utimensat (AT_FDCWD, lone, times, 0), ==, 0);
  set_age (found->pdata[1], times);
  g_ptr_array_unref (found);
  found = cloth_recover_find (path, NULL);
  g_assert_cmpuint (found->len, ==, 2);
  g_assert_cmpstr (found->pdata[0], ==, lone);
  g_assert_cmpint (cloth_recover_look (path, CLOTH_MESH_FORMAT_AUTO), ==,
      CLOTH_LEFT_FRAMES);
  g_assert_true (cloth_recover (found->pdata[1], TRUE, &recovered, &error));
  g_assert_cmpint (cloth_recover_look (path, CLOTH_MESH_FORMAT_AUTO), ==,
      CLOTH_LEFT_NOTHING);
  /* of many ages: the newest first */
  for (guint i = 0; i < 10; i++) {
    g_autofree gchar *path_i = g_strdup_printf ("%s/.d.obj.part-00000%u",
        scratch, i);

    times[1].tv_sec = 2000 + (i * 7) % 10;
    g_assert_cmpint (g_mkdir (path_i, 0777), ==, 0);
    g_assert_cmpint (utimensat (AT_FDCWD, path_i, times, 0), ==, 0);
  }
  g_ptr_array_unref (found);
  other = scratch_path ("d.obj");
  found = cloth_recover_find (other, NULL);
  g_assert_cmpuint (found->len, ==, 10);
  for (guint i = 0; i < 10; i++) {
    const gchar *path_i = found->pdata[i];

    g_assert_cmpuint ((guint) (path_i[strlen (path_i) - 1] - '0') * 7 % 10, ==,
        9 - i);
  }
  scratch_end ();
}

/* While files of two recordings have the same names, none of them is read. */
static void
test_half_placed (void)
{
  static const gchar *const subs[] = { "old", "placing" };

  for (guint i = 0; i < G_N_ELEMENTS (readable); i++) {
    for (guint k = 0; k < G_N_ELEMENTS (subs); k++) {
      g_autofree gchar *path = NULL;
      g_autofree gchar *hidden = NULL;
      g_autofree gchar *sub = NULL;
      g_autoptr (GError) error = NULL;

      scratch_begin ();
      path = scratch_path (readable[i]);
      record (path, 0, 2);
      hidden = g_strdup_printf ("%s/%s.%s.part-abcdef", i == 2 ? path : scratch,
          "", i == 2 ? "take.json" : readable[i]);
      sub = g_build_filename (hidden, subs[k], NULL);
      g_assert_cmpint (g_mkdir_with_parents (sub, 0777), ==, 0);
      g_assert_null (cloth_mesh_reader_open (path, CLOTH_MESH_FORMAT_AUTO,
              &error));
      g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
      g_assert_nonnull (strstr (error->message, "gst-cloth-take-1.0 recover"));
      g_assert_cmpint (g_rmdir (sub), ==, 0);
      assert_frames (path, 0, 2);
      scratch_end ();
    }
  }
}

/* Somebody recorded anew where a commit was cut off: that stays, unless told. */
static void
test_half_placed_taken (void)
{
  static const gchar *const subs[] = { "old", "placing" };

  for (guint k = 0; k < G_N_ELEMENTS (subs); k++) {
    g_autofree gchar *path = NULL;
    g_autofree gchar *hidden = NULL;
    g_autofree gchar *sub = NULL;
    g_autofree gchar *waiting = NULL;
    g_autofree gchar *lock = NULL;
    g_autofree gchar *bytes = NULL;
    g_autoptr (GError) error = NULL;
    ClothRecovered recovered;

    scratch_begin ();
    path = scratch_path ("c.csv");
    hidden = scratch_path (".c.csv.part-abcdef");
    sub = g_build_filename (hidden, subs[k], NULL);
    waiting = g_build_filename (sub, "c.csv", NULL);
    g_assert_cmpint (g_mkdir_with_parents (sub, 0777), ==, 0);
    g_assert_true (g_file_set_contents (waiting, "waiting", -1, NULL));
    g_assert_true (g_file_set_contents (path, "mine", -1, NULL));
    /* no writer's mark, no part of ours */
    g_assert_false (cloth_recover (hidden, TRUE, &recovered, NULL));
    g_assert_true (g_file_test (waiting, G_FILE_TEST_EXISTS));
    lock = g_build_filename (hidden, "recording", NULL);
    g_assert_true (g_file_set_contents (lock, "gst-cloth recording 2\n\n", -1,
            NULL));
    g_assert_false (cloth_recover (hidden, TRUE, &recovered, &error));
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
    g_clear_error (&error);
    g_assert_true (g_file_test (waiting, G_FILE_TEST_EXISTS));
    g_assert_true (g_file_set_contents (lock, "gst-cloth recording 1\n\n", -1,
            NULL));
    g_assert_false (cloth_recover (hidden, FALSE, &recovered, &error));
    g_assert_error (error, G_IO_ERROR, G_IO_ERROR_EXISTS);
    g_clear_error (&error);
    g_assert_true (g_file_get_contents (path, &bytes, NULL, NULL));
    g_assert_cmpstr (bytes, ==, "mine");
    g_clear_pointer (&bytes, g_free);
    g_assert_true (cloth_recover (hidden, TRUE, &recovered, &error));
    g_assert_true (g_file_get_contents (path, &bytes, NULL, NULL));
    g_assert_cmpstr (bytes, ==, "waiting");
    g_assert_cmpuint (scratch_count (), ==, 1);
    scratch_end ();
  }
}

/* What is no recording, what somebody may know what to do with, and what is another user's. */
static void
test_left_alone (void)
{
  static const struct
  {
    const gchar *hidden, *recording, *file;
    gsize size;
    gint code;                  /* −1: it is removed */
    const gchar *message;
  } cases[] = {
    {".garment.json.part-abcdef", "gst-cloth recording 1\n\n", "garment.obj", 3,
        CLOTH_FILE_ERROR_UNSUPPORTED, "no recording"},
    {".c.obj.part-abcdef", "gst-cloth recording 1\n6\nframe\n", "c.obj", 3,
        CLOTH_FILE_ERROR_INVALID, "no whole frame is found"},
    {".c.obj.part-abcdef", "gst-cloth recording 1\n6\nfra", "c.obj", 3, -1,
        NULL},
    {".c.obj.part-abcdef", "6", "c.obj", 3, CLOTH_FILE_ERROR_INVALID,
        "not what a recording leaves"},
    {".c.obj.part-abcdef", "", "c.obj", 3, CLOTH_FILE_ERROR_INVALID,
        "not what a recording leaves"},
    {".c.obj.part-abcdef", "gst-cloth rec", "c.obj", 3,
        CLOTH_FILE_ERROR_INVALID, "not what a recording leaves"},
    /* the note was not written yet */
    {".c.obj.part-abcdef", "gst-cloth rec", NULL, 0, -1, NULL},
    {".c.obj.part-abcdef", "gst-cloth recording 1\n", NULL, 0, -1, NULL},
    /* nor is it of ours */
    {".c.obj.part-abcdef", "gst-cloth recording one\n", NULL, 0,
        CLOTH_FILE_ERROR_INVALID, "not what a recording leaves"},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autofree gchar *hidden = NULL;
    g_autofree gchar *whole = NULL;
    g_autofree gchar *lock = NULL;
    g_autofree gchar *bytes = g_strnfill (cases[i].size, 'x');
    g_autoptr (GError) error = NULL;
    ClothRecovered recovered;
    gboolean done;

    scratch_begin ();
    hidden = scratch_path (cases[i].hidden);
    whole = g_build_filename (hidden, "new", NULL);
    lock = g_build_filename (hidden, "recording", NULL);
    g_assert_cmpint (g_mkdir_with_parents (whole, 0777), ==, 0);
    if (!cases[i].file)
      g_assert_cmpint (g_rmdir (whole), ==, 0);
    g_assert_true (g_file_set_contents (lock, cases[i].recording, -1, NULL));
    if (cases[i].file) {
      g_autofree gchar *file = g_build_filename (hidden, cases[i].file, NULL);

      g_assert_true (g_file_set_contents (file, bytes, (gssize) cases[i].size,
              NULL));
    }
    done = cloth_recover (hidden, TRUE, &recovered, &error);
    g_assert_true (g_file_test (hidden, G_FILE_TEST_IS_DIR) == !done);
    if (cases[i].code < 0) {
      g_assert_no_error (error);
      scratch_end ();
      continue;
    }
    g_assert_error (error, CLOTH_FILE_ERROR, cases[i].code);
    g_assert_nonnull (strstr (error->message, cases[i].message));
    /* another user's, and a link to one's own */
    if (geteuid () == 0 && chown (hidden, 1, 1) == 0) {
      g_autoptr (GPtrArray) found = cloth_recover_find (scratch, NULL);

      g_assert_cmpuint (found->len, ==, 1);
      g_assert_true (cloth_parts_is_foreign (found->pdata[0]));
    }
    {
      g_autofree gchar *link = scratch_path (".d.obj.part-abcdef");

      g_clear_error (&error);
      g_assert_cmpint (symlink (hidden, link), ==, 0);
      g_assert_false (cloth_recover (link, TRUE, &recovered, &error));
      g_assert_nonnull (error);
      g_assert_true (g_file_test (hidden, G_FILE_TEST_IS_DIR));
    }
    scratch_end ();
  }
}

/* A program was killed while its files got their names: that is ended first. */
static void
test_committing (void)
{
  static const gchar *const subs[] = { "old", "placing" };
  g_autoptr (ClothTopology) topology = make_topology ();

  for (guint k = 0; k < G_N_ELEMENTS (subs); k++) {
    g_autofree gchar *path = NULL;
    g_autofree gchar *left = NULL;
    g_autofree gchar *sub = NULL;
    g_autoptr (GError) error = NULL;
    ClothRecovered recovered;

    scratch_begin ();
    path = scratch_path ("c.obj");
    be_killed (path, 1, 4, G_MAXUINT);
    left = find_one (path);
    sub = g_build_filename (left, subs[k], NULL);
    if (k == 1) {
      g_autofree gchar *whole = g_build_filename (left, "new", NULL);

      g_assert_cmpint (g_rename (whole, sub), ==, 0);
    } else {
      g_assert_cmpint (g_mkdir (sub, 0777), ==, 0);
    }
    g_assert_null (cloth_mesh_writer_new (path, CLOTH_MESH_FORMAT_AUTO, NULL,
            topology, 25, 1, &error));
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
    g_assert_nonnull (strstr (error->message, "gst-cloth-take-1.0 recover"));
    g_clear_error (&error);
    g_assert_true (cloth_recover (left, FALSE, &recovered, &error));
    g_assert_no_error (error);
    g_assert_true (recovered.placed == (k == 1));
    if (k == 0)
      assert_frames (path, 1, 4);
    record (path, 2, 3);
    assert_frames (path, 2, 3);
    assert_nothing_left (path);
    scratch_end ();
  }
}

/* Another program gives its files the names while a commit that was cut off is ended. */
static void
test_resume_alone (void)
{
  g_autofree gchar *path = NULL;
  g_autofree gchar *left = NULL;
  g_autofree gchar *whole = NULL;
  g_autofree gchar *placing = NULL;
  g_autofree gchar *other = NULL;
  g_autoptr (GError) error = NULL;
  ClothRecovered recovered;

  scratch_begin ();
  path = scratch_path ("c.obj");
  be_killed (path, 1, 4, G_MAXUINT);
  left = find_one (path);
  whole = g_build_filename (left, "new", NULL);
  placing = g_build_filename (left, "placing", NULL);
  other = scratch_path (".c.obj.part-other0/old");
  g_assert_cmpint (g_rename (whole, placing), ==, 0);
  g_assert_cmpint (g_mkdir_with_parents (other, 0777), ==, 0);
  g_assert_false (cloth_recover (left, TRUE, &recovered, &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_BUSY);
  g_assert_true (g_file_test (placing, G_FILE_TEST_IS_DIR));
  g_assert_false (g_file_test (path, G_FILE_TEST_EXISTS));
  scratch_end ();
}

/* A program is killed while its files get the names, when another one records already. */
static void
test_ended_first (void)
{
  g_autofree gchar *path = NULL;
  g_autofree gchar *other = NULL;
  g_autofree gchar *lock = NULL;
  g_autofree gchar *placing = NULL;
  g_autoptr (ClothMeshWriter) writer = NULL;
  g_autoptr (GError) error = NULL;

  scratch_begin ();
  path = scratch_path ("c.obj");
  writer = start (path);
  g_assert_true (append (writer, 1, 0, FALSE));
  other = scratch_path (".c.obj.part-other0");
  lock = g_build_filename (other, "recording", NULL);
  placing = g_build_filename (other, "placing", NULL);
  g_assert_cmpint (g_mkdir_with_parents (placing, 0777), ==, 0);
  g_assert_true (g_file_set_contents (lock, "gst-cloth recording 1\n12\n", -1,
          NULL));
  g_assert_false (cloth_mesh_writer_close (writer, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
  g_assert_nonnull (strstr (error->message, "gst-cloth-take-1.0 recover"));
  g_assert_true (cloth_mesh_writer_leave (writer));
  scratch_end ();
}

/* Where nobody may replace another's files nobody is hindered by another's remains; where
 * they may, these count. */
static void
test_other_user (void)
{
  for (guint sticky = 0; geteuid () == 0 && sticky < 2; sticky++) {
    g_autofree gchar *path = NULL;
    g_autofree gchar *other = NULL;
    g_autofree gchar *old = NULL;
    g_autofree gchar *lock = NULL;
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothMeshReader) reader = NULL;

    scratch_begin ();
    path = scratch_path ("c.obj");
    record (path, 1, 2);
    other = scratch_path (".c.obj.part-other0");
    old = g_build_filename (other, "old", NULL);
    lock = g_build_filename (other, "recording", NULL);
    g_assert_cmpint (g_mkdir_with_parents (old, 0777), ==, 0);
    g_assert_true (g_file_set_contents (lock, "gst-cloth recording 1\n12\n", -1,
            NULL));
    g_assert_cmpint (g_chmod (scratch, sticky ? 01777 : 0777), ==, 0);
    g_assert_null (cloth_mesh_reader_open (path, CLOTH_MESH_FORMAT_AUTO, NULL));
    g_assert_cmpint (chown (other, 1, 1), ==, 0);
    reader = cloth_mesh_reader_open (path, CLOTH_MESH_FORMAT_AUTO, &error);
    g_assert_true ((reader != NULL) == sticky);
    if (sticky)
      record (path, 2, 3);
    /* and they are not ours to remove */
    g_assert_true (g_file_test (other, G_FILE_TEST_IS_DIR));
    scratch_end ();
  }
}

/* What a take has below a folder is found from there. */
static void
test_below (void)
{
  g_autofree gchar *path = NULL;
  g_autofree gchar *link = NULL;
  g_autoptr (GPtrArray) found = NULL;
  g_autoptr (GError) error = NULL;
  ClothRecovered recovered;

  scratch_begin ();
  path = scratch_path ("t.take");
  link = scratch_path ("link");
  be_killed (path, 1, 4, G_MAXUINT);
  g_assert_cmpint (symlink ("t.take", link), ==, 0);
  found = cloth_recover_find (scratch, &error);
  g_assert_no_error (error);
  g_assert_cmpuint (found->len, ==, 1);
  g_assert_true (cloth_recover (found->pdata[0], FALSE, &recovered, &error));
  assert_frames (path, 1, 4);
  scratch_end ();
}

/* What can only be read whole, and is whole but for its name. */
static void
test_whole (void)
{
  static const gchar *const names[] = { "c.glb", "c.usda", "c.c3d" };

  for (guint i = 0; i < G_N_ELEMENTS (names); i++) {
    g_autofree gchar *path = NULL;
    g_autofree gchar *left = NULL;
    g_autofree gchar *whole = NULL;
    g_autofree gchar *begun = NULL;
    g_autoptr (GError) error = NULL;
    ClothRecovered recovered;

    scratch_begin ();
    path = scratch_path (names[i]);
    be_killed (path, 1, 1, G_MAXUINT);
    left = find_one (path);
    begun = g_build_filename (left, names[i], NULL);
    whole = g_build_filename (left, "new", names[i], NULL);
    g_assert_cmpint (g_rename (begun, whole), ==, 0);
    g_assert_true (cloth_recover (left, FALSE, &recovered, &error));
    g_assert_no_error (error);
    g_assert_true (recovered.placed);
    g_assert_true (g_file_test (path, G_FILE_TEST_IS_REGULAR));
    assert_nothing_left (path);
    scratch_end ();
  }
}

/* Numbers of six digits come after those of five. */
static void
test_many_numbers (void)
{
  g_autofree gchar *path = NULL;
  g_autoptr (ClothParts) parts = NULL;
  g_autoptr (GError) error = NULL;

  scratch_begin ();
  path = scratch_path ("c.ply");
  parts = cloth_parts_new (path, "", &error);
  for (guint i = 99998; i < 100002; i++) {
    g_autoptr (ClothOutput) output =
        cloth_parts_open_numbered (parts, "c", i, ".ply", &error);

    g_assert_true (cloth_output_commit (output, &error));
  }
  g_assert_true (cloth_parts_commit (parts, &error));
  g_assert_no_error (error);
  g_assert_cmpuint (scratch_count (), ==, 4);
  scratch_end ();
}

/* A reader of numbered files reads them one by one: they may be replaced meanwhile. */
static void
test_ply_replaced (void)
{
  g_autofree gchar *path = NULL;
  g_autoptr (ClothMeshReader) reader = NULL;
  g_autoptr (GError) error = NULL;
  ClothMeshFrame frame;

  scratch_begin ();
  path = scratch_path ("c.ply");
  record (path, 0, 4);
  reader = cloth_mesh_reader_open (path, CLOTH_MESH_FORMAT_AUTO, &error);
  g_assert_no_error (error);
  g_assert_true (cloth_mesh_reader_read (reader, 1, &frame, &error));
  record (path, 1, 4);
  g_assert_false (cloth_mesh_reader_read (reader, 2, &frame, &error));
  g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID);
  g_assert_nonnull (strstr (error->message, "try again"));
  scratch_end ();
}

/* The end of a take is zeros, as after a loss of power. */
static void
test_zeros (void)
{
  g_autofree gchar *path = NULL;
  g_autofree gchar *left = NULL;
  g_autofree gchar *times = NULL;
  g_autofree gchar *bytes = NULL;
  g_autoptr (GError) error = NULL;
  ClothRecovered recovered;
  gsize size;

  scratch_begin ();
  path = scratch_path ("c.take");
  be_killed (path, 1, 9, G_MAXUINT);
  left = find_one (path);
  times = g_build_filename (left, "times.npy", NULL);
  g_assert_true (g_file_get_contents (times, &bytes, &size, NULL));
  memset (bytes + size - 4 * 8, 0, 4 * 8);
  g_assert_true (g_file_set_contents (times, bytes, (gssize) size, NULL));
  g_assert_true (cloth_recover (left, FALSE, &recovered, &error));
  g_assert_no_error (error);
  g_assert_cmpuint (recovered.n_frames, ==, 5);
  g_assert_cmpuint (recovered.n_left_out, ==, 4);
  assert_frames (path, 1, 5);
  scratch_end ();
}

/* Somebody records while an older one is recovered: between the first look whether its
 * names are free, and the commit. */
static void
test_taken_meanwhile (void)
{
  g_autofree gchar *path = NULL;
  g_autofree gchar *left = NULL;
  g_autoptr (ClothParts) parts = NULL;
  g_autoptr (GError) error = NULL;
  ClothRecovered recovered = { 0 };
  ClothRemains remains;

  scratch_begin ();
  path = scratch_path ("c.obj");
  be_killed (path, 1, 4, G_MAXUINT);
  left = find_one (path);
  parts = cloth_parts_reopen (left, FALSE, &remains, &error);
  g_assert_no_error (error);
  g_assert_true (cloth_obj_pc2_recover (parts, "c", &recovered, &error));
  record (path, 2, 3);
  g_assert_false (cloth_parts_commit (parts, &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_EXISTS);
  assert_frames (path, 2, 3);
  g_clear_pointer (&parts, cloth_parts_free);
  g_clear_error (&error);
  g_assert_true (cloth_recover (left, TRUE, &recovered, &error));
  assert_frames (path, 1, 4);
  scratch_end ();
}

/* What is left can be named itself. */
static void
test_by_its_path (void)
{
  static const gchar *const ends[] = { "", "/", "//" };

  for (guint i = 0; i < G_N_ELEMENTS (ends); i++) {
    g_autofree gchar *path = NULL;
    g_autofree gchar *left = NULL;
    g_autofree gchar *named = NULL;
    g_autoptr (GPtrArray) found = NULL;
    g_autoptr (GPtrArray) none = NULL;
    g_autoptr (GError) error = NULL;
    ClothRecovered recovered;

    scratch_begin ();
    path = scratch_path ("c.take");
    be_killed (path, 1, 4, G_MAXUINT);
    left = find_one (path);
    named = g_strconcat (left, ends[i], NULL);
    found = cloth_recover_find (named, &error);
    g_assert_no_error (error);
    g_assert_cmpuint (found->len, ==, 1);
    g_assert_cmpstr (found->pdata[0], ==, left);
    g_assert_true (cloth_recover (found->pdata[0], FALSE, &recovered, &error));
    assert_frames (path, 1, 4);
    assert_nothing_left (path);
    none = cloth_recover_find (left, NULL);
    g_assert_true (!none || none->len == 0);
    scratch_end ();
  }
}

/* What nobody vouches for: links that lead elsewhere, arrays that are none. */
static void
test_hostile (void)
{
  static const gchar *const bad_headers[] =
      { "", "\x93NUMPY", "no array at all",
    "\x93NUMPY\x01\x00\x06\x00{'a':1"
  };
  g_autofree gchar *outside = NULL;
  g_autofree gchar *kept = NULL;

  scratch_begin ();
  outside = scratch_path ("outside");
  kept = g_build_filename (outside, "positions.npy", NULL);
  g_assert_cmpint (g_mkdir (outside, 0777), ==, 0);
  g_assert_true (g_file_set_contents (kept, "mine", 4, NULL));
  for (guint i = 0; i < 4; i++) {
    static const gchar *const links[] = { "new", "old", "placing",
      "positions.npy"
    };
    g_autofree gchar *folder = g_strdup_printf ("%s/t%u", scratch, i);
    g_autofree gchar *hidden = g_build_filename (folder,
        ".take.json.part-abcdef", NULL);
    g_autofree gchar *lock = g_build_filename (hidden, "recording", NULL);
    g_autofree gchar *link = g_build_filename (hidden, links[i], NULL);
    g_autofree gchar *bytes = NULL;
    ClothRecovered recovered;

    g_assert_cmpint (g_mkdir_with_parents (hidden, 0777), ==, 0);
    g_assert_true (g_file_set_contents (lock, "", 0, NULL));
    g_assert_cmpint (symlink (i == 3 ? kept : outside, link), ==, 0);
    cloth_recover (hidden, TRUE, &recovered, NULL);
    g_assert_cmpuint (recovered.n_frames, ==, 0);
    g_assert_true (g_file_get_contents (kept, &bytes, NULL, NULL));
    g_assert_cmpstr (bytes, ==, "mine");
  }
  for (guint i = 0; i < G_N_ELEMENTS (bad_headers); i++) {
    g_autofree gchar *path = g_strdup_printf ("%s/h%u.obj", scratch, i);
    g_autofree gchar *left = NULL;
    g_autofree gchar *states = NULL;
    g_autofree gchar *name = g_strdup_printf ("h%u.states.npy", i);
    ClothRecovered recovered;

    be_killed (path, 0, 2, G_MAXUINT);
    left = find_one (path);
    states = g_build_filename (left, name, NULL);
    g_assert_true (g_file_set_contents (states, bad_headers[i], i == 3 ? 16 :
            -1, NULL));
    cloth_recover (left, FALSE, &recovered, NULL);
    g_assert_cmpuint (recovered.n_frames, ==, 0);
    g_assert_false (g_file_test (path, G_FILE_TEST_EXISTS));
  }
  scratch_end ();
}

/* Devices and pipes are not replaced, and no file appears beside them. */
static void
test_no_regular_file (void)
{
  static const gchar *const endings[] = { "", ".obj", ".pc2", ".states.npy",
    ".ply", ".glb", ".usda", ".pvd", ".c3d", ".csv", "_00000.vtp", "_00001.ply"
  };
  g_autoptr (ClothTopology) topology = make_topology ();

  for (guint i = 0; i < G_N_ELEMENTS (endings); i++) {
    g_autofree gchar *pipe = NULL;
    g_autofree gchar *location = NULL;
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothMeshWriter) writer = NULL;
    const gchar *ending = strrchr (endings[i], '.');
    struct stat info;
    gboolean good;

    scratch_begin ();
    pipe = g_strconcat (scratch, "/p", endings[i], NULL);
    location = g_strconcat (scratch, "/p", !ending ? "" :
        g_str_equal (ending, ".vtp") ? ".pvd" : g_str_equal (ending, ".npy") ?
        ".obj" : ending, NULL);
    g_assert_cmpint (mkfifo (pipe, 0600), ==, 0);
    writer = cloth_mesh_writer_new (location, CLOTH_MESH_FORMAT_AUTO, NULL,
        topology, 25, 1, &error);
    good = writer != NULL;
    for (guint f = 0; good && f < 3; f++)
      good = append (writer, 0, f, FALSE);
    good = good && cloth_mesh_writer_close (writer, &error);
    g_assert_false (good);
    if (error)
      g_assert_error (error, G_IO_ERROR, G_IO_ERROR_NOT_REGULAR_FILE);
    g_clear_pointer (&writer, cloth_mesh_writer_free);
    g_assert_cmpint (lstat (pipe, &info), ==, 0);
    g_assert_true (S_ISFIFO (info.st_mode));
    g_assert_cmpuint (scratch_count (), ==, 1);
    scratch_end ();
  }
}

/* For root nothing but this stands between a report and the device. */
static void
test_device (void)
{
  static const gchar *const devices[] = { "/dev/null", "/dev/zero",
    "/dev/stdout"
  };
  g_autoptr (ClothTopology) topology = make_topology ();

  for (guint i = 0; i < G_N_ELEMENTS (devices); i++) {
    g_autofree gchar *beside = g_strconcat (devices[i], ".obj", NULL);
    g_autoptr (GError) error = NULL;
    struct stat info;

    if (stat (devices[i], &info) != 0 || S_ISREG (info.st_mode))
      continue;
    g_assert_false (cloth_file_write_text (devices[i], "x", &error));
    g_assert_error (error, G_IO_ERROR, G_IO_ERROR_NOT_REGULAR_FILE);
    g_clear_error (&error);
    g_assert_null (cloth_mesh_writer_new (devices[i], CLOTH_MESH_FORMAT_AUTO,
            NULL, topology, 25, 1, &error));
    g_assert_error (error, G_IO_ERROR, G_IO_ERROR_NOT_REGULAR_FILE);
    g_clear_error (&error);
    g_assert_null (cloth_mesh_writer_new (devices[i], CLOTH_MESH_FORMAT_TAKE,
            NULL, topology, 25, 1, &error));
    g_assert_nonnull (error);
    g_assert_false (g_file_test (beside, G_FILE_TEST_EXISTS));
  }
}

/* The device may come later, too. */
static void
test_device_meanwhile (void)
{
  g_autoptr (ClothOutput) output = NULL;
  g_autoptr (ClothMeshWriter) writer = NULL;
  g_autoptr (GError) error = NULL;
  g_autofree gchar *path = NULL;
  g_autofree gchar *pc2 = NULL;

  scratch_begin ();
  path = scratch_path ("c.obj");
  pc2 = scratch_path ("c.pc2");
  output = cloth_output_new (pc2, &error);
  writer = start (path);
  g_assert_true (append (writer, 0, 0, FALSE));
  g_assert_cmpint (mkfifo (pc2, 0600), ==, 0);
  g_assert_false (cloth_output_commit (output, &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_NOT_REGULAR_FILE);
  g_clear_error (&error);
  g_assert_false (cloth_mesh_writer_close (writer, &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_NOT_REGULAR_FILE);
  g_clear_pointer (&output, cloth_output_free);
  g_clear_pointer (&writer, cloth_mesh_writer_free);
  g_assert_cmpuint (scratch_count (), ==, 1);
  scratch_end ();
}

/* Names that are like those of parts, parts of other things, parts without a lock. */
static void
test_names (void)
{
  static const gchar *const others[] = { ".x", ".part-abcdef", "c.part-abcdef",
    ".c.obj.part-abcdefg", ".c.obj.part_abcdef", ".a-long-name-without-it"
  };
  g_autofree gchar *garment = NULL;
  g_autofree gchar *whole = NULL;
  g_autofree gchar *unlocked = NULL;
  g_autofree gchar *link = NULL;
  g_autofree gchar *target = NULL;
  g_autofree gchar *path = NULL;
  g_autofree gchar *table = NULL;
  g_autoptr (GPtrArray) found = NULL;
  ClothRecovered recovered;

  scratch_begin ();
  for (guint i = 0; i < G_N_ELEMENTS (others); i++) {
    g_autofree gchar *other = scratch_path (others[i]);

    g_assert_true (g_file_set_contents (other, "mine", 4, NULL));
  }
  assert_nothing_left (scratch);
  garment = scratch_path (".garment.json.part-abcdef");
  whole = g_build_filename (garment, "new", NULL);
  unlocked = scratch_path (".c.obj.part-abcdef");
  link = scratch_path (".c.csv.part-abcdef");
  g_assert_cmpint (g_mkdir_with_parents (whole, 0777), ==, 0);
  g_assert_cmpint (g_mkdir (unlocked, 0777), ==, 0);
  g_assert_cmpint (symlink (others[0], link), ==, 0);
  path = scratch_path ("c.obj");
  table = scratch_path ("c.csv");
  g_assert_cmpint (cloth_recover_look (path, CLOTH_MESH_FORMAT_AUTO), ==,
      CLOTH_LEFT_NOTHING);
  g_assert_cmpint (cloth_recover_look (table, CLOTH_MESH_FORMAT_AUTO), ==,
      CLOTH_LEFT_NOTHING);
  g_assert_cmpint (cloth_recover_look ("/nonexistent/c.obj",
          CLOTH_MESH_FORMAT_AUTO), ==, CLOTH_LEFT_NOTHING);
  g_assert_true (cloth_recover (garment, FALSE, &recovered, NULL));
  g_assert_true (cloth_recover (unlocked, FALSE, &recovered, NULL));
  g_assert_false (cloth_recover (link, FALSE, &recovered, NULL));
  /* links are nobody's parts */
  found = cloth_recover_find (scratch, NULL);
  g_assert_cmpuint (found->len, ==, 0);
  g_assert_cmpuint (scratch_count (), ==, G_N_ELEMENTS (others) + 1);
  target = cloth_recover_get_target ("./.c.obj.part-abcdef");
  g_assert_cmpstr (target, ==, "c.obj");
  scratch_end ();
}

/* A folder where a file is meant, a file where a folder is meant. */
static void
test_wrong_kind (void)
{
  g_autoptr (ClothTopology) topology = make_topology ();
  g_autoptr (GError) error = NULL;
  g_autofree gchar *folder = NULL;
  g_autofree gchar *file = NULL;
  g_autofree gchar *long_name = NULL;
  gchar name[247] = "";

  scratch_begin ();
  folder = scratch_path ("f.csv");
  file = scratch_path ("t.take");
  g_assert_cmpint (g_mkdir (folder, 0777), ==, 0);
  g_assert_true (g_file_set_contents (file, "mine", 4, NULL));
  g_assert_null (cloth_mesh_writer_new (folder, CLOTH_MESH_FORMAT_CSV, NULL,
          topology, 25, 1, &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_IS_DIRECTORY);
  g_clear_error (&error);
  g_assert_false (cloth_file_write_text (folder, "x", &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_IS_DIRECTORY);
  g_clear_error (&error);
  g_assert_null (cloth_mesh_writer_new (file, CLOTH_MESH_FORMAT_TAKE, NULL,
          topology, 25, 1, &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_NOT_DIRECTORY);
  g_clear_error (&error);
  /* a name that the hidden one has no room for is named itself */
  memset (name, 'n', sizeof name - 1);
  long_name = g_strconcat (scratch, "/", name, ".csv", NULL);
  g_assert_null (cloth_mesh_writer_new (long_name, CLOTH_MESH_FORMAT_AUTO, NULL,
          topology, 25, 1, &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_FILENAME_TOO_LONG);
  g_assert_nonnull (strstr (error->message, long_name));
  g_assert_cmpuint (scratch_count (), ==, 2);
  scratch_end ();
}

/* Of a link the file is written that it leads to. A recording, which is several files in
 * one folder, refuses it. */
static void
test_link (void)
{
  g_autoptr (ClothTopology) topology = make_topology ();
  g_autoptr (ClothMeshWriter) writer = NULL;
  g_autoptr (GError) error = NULL;
  g_autofree gchar *path = NULL;
  g_autofree gchar *folder = NULL;
  g_autofree gchar *elsewhere = NULL;
  g_autofree gchar *nowhere = NULL;
  g_autofree gchar *bytes = NULL;
  struct stat info;

  scratch_begin ();
  path = scratch_path ("c.obj");
  folder = scratch_path ("folder");
  elsewhere = scratch_path ("folder/elsewhere");
  nowhere = scratch_path ("nowhere");
  g_assert_cmpint (g_mkdir (folder, 0777), ==, 0);
  g_assert_true (g_file_set_contents (elsewhere, "mine", 4, NULL));
  g_assert_cmpint (symlink ("folder/elsewhere", path), ==, 0);
  g_assert_cmpint (symlink ("missing", nowhere), ==, 0);
  writer = cloth_mesh_writer_new (path, CLOTH_MESH_FORMAT_AUTO, NULL, topology,
      25, 1, &error);
  g_assert_null (writer);
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_NOT_REGULAR_FILE);
  g_clear_error (&error);
  g_assert_true (g_file_get_contents (elsewhere, &bytes, NULL, NULL));
  g_assert_cmpstr (bytes, ==, "mine");
  g_clear_pointer (&bytes, g_free);
  g_assert_true (cloth_file_write_text (path, "yours", &error));
  g_assert_no_error (error);
  g_assert_true (g_file_get_contents (elsewhere, &bytes, NULL, NULL));
  g_assert_cmpstr (bytes, ==, "yours");
  g_assert_cmpint (lstat (path, &info), ==, 0);
  g_assert_true (S_ISLNK (info.st_mode));
  g_assert_false (cloth_file_write_text (nowhere, "yours", &error));
  g_assert_error (error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
  g_assert_cmpuint (scratch_count (), ==, 3);
  scratch_end ();
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/recover/kept", test_kept);
  g_test_add_func ("/recover/folder", test_folder);
  g_test_add_func ("/recover/last-frame-cut", test_last_frame_cut);
  g_test_add_func ("/recover/csv", test_csv);
  g_test_add_func ("/recover/dropped", test_dropped);
  g_test_add_func ("/recover/no-frame", test_no_frame);
  g_test_add_func ("/recover/lost", test_lost);
  g_test_add_func ("/recover/never-overwrites", test_never_overwrites);
  g_test_add_func ("/recover/longer", test_longer);
  g_test_add_func ("/recover/living", test_living);
  g_test_add_func ("/recover/living-lone-file", test_living_lone_file);
  g_test_add_func ("/recover/next", test_next);
  g_test_add_func ("/recover/left", test_left);
  g_test_add_func ("/recover/concurrent", test_concurrent);
  g_test_add_func ("/recover/replaced-meanwhile", test_replaced_meanwhile);
  g_test_add_func ("/recover/power", test_power);
  g_test_add_func ("/recover/garment", test_garment);
  g_test_add_func ("/recover/several", test_several);
  g_test_add_func ("/recover/half-placed", test_half_placed);
  g_test_add_func ("/recover/half-placed-taken", test_half_placed_taken);
  g_test_add_func ("/recover/left-alone", test_left_alone);
  g_test_add_func ("/recover/committing", test_committing);
  g_test_add_func ("/recover/resume-alone", test_resume_alone);
  g_test_add_func ("/recover/ended-first", test_ended_first);
  g_test_add_func ("/recover/other-user", test_other_user);
  g_test_add_func ("/recover/below", test_below);
  g_test_add_func ("/recover/whole", test_whole);
  g_test_add_func ("/recover/many-numbers", test_many_numbers);
  g_test_add_func ("/recover/ply-replaced", test_ply_replaced);
  g_test_add_func ("/recover/zeros", test_zeros);
  g_test_add_func ("/recover/taken-meanwhile", test_taken_meanwhile);
  g_test_add_func ("/recover/by-its-path", test_by_its_path);
  g_test_add_func ("/recover/hostile", test_hostile);
  g_test_add_func ("/recover/no-regular-file", test_no_regular_file);
  g_test_add_func ("/recover/device", test_device);
  g_test_add_func ("/recover/device-meanwhile", test_device_meanwhile);
  g_test_add_func ("/recover/names", test_names);
  g_test_add_func ("/recover/wrong-kind", test_wrong_kind);
  g_test_add_func ("/recover/link", test_link);
  return g_test_run ();
}
