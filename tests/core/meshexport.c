/* Formats that are only written: what they refuse, and that nothing half-written stays.
 * What they contain is read by tests/generic/meshexports.py.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/file/file.h"
#include "gst/mesh/formats/export.h"
#include "gst/take/sequence.h"
#include "tests/core/meshpeer.h"

#include <math.h>
#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#define COLUMNS 3
#define ROWS 2
#define N (COLUMNS * ROWS)

static const struct
{
  const gchar *name;
  ClothMeshFormat format;
  guint n_files;                /* of two frames */
  gboolean has_times;
} formats[] = {
  {"c.glb", CLOTH_MESH_FORMAT_GLTF, 1, TRUE},
  {"c.usda", CLOTH_MESH_FORMAT_USD, 1, TRUE},
  {"c.pvd", CLOTH_MESH_FORMAT_VTP, 3, TRUE},
  {"c.c3d", CLOTH_MESH_FORMAT_C3D, 1, FALSE},
  {"c.csv", CLOTH_MESH_FORMAT_CSV, 1, TRUE},
};

static ClothMeshWriter *
open_writer (const gchar * name, const ClothTopology * topology, gint fps,
    GError ** error)
{
  g_autofree gchar *path = scratch_path (name);

  return cloth_mesh_writer_new (path, CLOTH_MESH_FORMAT_AUTO, NULL, topology,
      fps, 1, error);
}

static gboolean
append (ClothMeshWriter * writer, guint n, gdouble time_s, GError ** error)
{
  g_autofree gfloat *positions = g_new0 (gfloat, 3 * (gsize) n);
  g_autofree guint8 *states = g_malloc0 (n);
  const ClothMeshFrame frame = { positions, states, NULL };

  memset (states, CLOTH_VERTEX_MEASURED, n);
  for (gsize i = 0; i < n; i++)
    positions[3 * i] = (gfloat) i + (isnan (time_s) ? 0 : (gfloat) time_s);
  return cloth_mesh_writer_append (writer, time_s, &frame, error);
}

static void
write_frames (const gchar * name, const ClothTopology * topology,
    guint n_frames)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothMeshWriter) writer = open_writer (name, topology, 25, &error);

  g_assert_no_error (error);
  for (guint i = 0; i < n_frames; i++)
    g_assert_true (append (writer, topology->n_vertices, i, &error));
  g_assert_true (cloth_mesh_writer_close (writer, &error));
  g_assert_no_error (error);
}

static void
write_two (const gchar * name, const ClothTopology * topology)
{
  write_frames (name, topology, 2);
}

static void
expect (GError ** error, gint code, const gchar * text)
{
  g_assert_error (*error, CLOTH_FILE_ERROR, code);
  if (!strstr ((*error)->message, text))
    g_error ("“%s” does not say “%s”", (*error)->message, text);
  g_clear_error (error);
}

/* Endings are told in any case, and the same name is used with and without them. */
static void
test_names (void)
{
  static const gchar *const names[] = { "c.GLB", "c.Usda", "c.PVD", "c.vtp",
    "c.C3d", "c.CSV"
  };

  for (guint i = 0; i < G_N_ELEMENTS (names); i++) {
    const ClothMeshFormat format = cloth_mesh_format_guess (names[i]);
    g_autofree gchar *stem = cloth_mesh_format_stem (names[i], format);
    g_autofree gchar *bare = cloth_mesh_format_stem ("c", format);

    g_assert_cmpint (format, >=, CLOTH_MESH_FORMAT_GLTF);
    g_assert_cmpstr (stem, ==, "c");
    g_assert_cmpstr (bare, ==, "c");
  }
}

static void
test_whole_or_not_at_all (void)
{
  g_autoptr (ClothTopology) topology =
      cloth_topology_new_grid (COLUMNS, ROWS, 0.5f, 0.25f);

  for (guint i = 0; i < G_N_ELEMENTS (formats); i++) {
    g_autoptr (GError) error = NULL;
    ClothMeshWriter *writer;

    scratch_begin ();
    writer = open_writer (formats[i].name, topology, 25, &error);
    g_assert_no_error (error);
    g_assert_true (append (writer, N, 0, &error));
    /* none without a frame, none when it isn't closed */
    cloth_mesh_writer_free (writer);
    g_assert_cmpuint (scratch_count (), ==, 0);
    writer = open_writer (formats[i].name, topology, 25, &error);
    g_assert_false (cloth_mesh_writer_close (writer, &error));
    expect (&error, CLOTH_FILE_ERROR_INVALID, "no frame");
    cloth_mesh_writer_free (writer);
    g_assert_cmpuint (scratch_count (), ==, 0);
    write_two (formats[i].name, topology);
    g_assert_cmpuint (scratch_count (), ==, formats[i].n_files);
    scratch_end ();
  }
}

static void
test_times_must_rise (void)
{
  g_autoptr (ClothTopology) topology =
      cloth_topology_new_grid (COLUMNS, ROWS, 0.5f, 0.25f);

  for (guint i = 0; i < G_N_ELEMENTS (formats); i++) {
    g_autoptr (GError) error = NULL;
    g_autoptr (ClothMeshWriter) writer = NULL;

    scratch_begin ();
    writer = open_writer (formats[i].name, topology, 25, &error);
    g_assert_true (append (writer, N, 3, &error));
    if (formats[i].has_times) {
      g_assert_false (append (writer, N, 3, &error));
      expect (&error, CLOTH_FILE_ERROR_INVALID, "not later");
      g_assert_false (append (writer, N, NAN, &error));
      expect (&error, CLOTH_FILE_ERROR_INVALID, "not later");
    }
    scratch_end ();
  }
}

static void
test_unwritable (void)
{
  static const gchar *const endings[] = { "glb", "usda", "pvd", "c3d", "csv" };
  g_autoptr (ClothTopology) topology =
      cloth_topology_new_grid (COLUMNS, ROWS, 0.5f, 0.25f);

  for (guint i = 0; i < G_N_ELEMENTS (endings); i++) {
    g_autoptr (GError) error = NULL;
    g_autofree gchar *path = g_strconcat ("/nonexistent/c.", endings[i], NULL);

    g_assert_null (cloth_mesh_writer_new (path, CLOTH_MESH_FORMAT_AUTO, NULL,
            topology, 25, 1, &error));
    g_assert_error (error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
  }
}

static void
test_not_read (void)
{
  g_autoptr (ClothTopology) topology =
      cloth_topology_new_grid (COLUMNS, ROWS, 0.5f, 0.25f);

  scratch_begin ();
  for (guint i = 0; i < G_N_ELEMENTS (formats); i++) {
    g_autofree gchar *path = scratch_path (formats[i].name);
    g_autoptr (GError) error = NULL;

    write_two (formats[i].name, topology);
    g_assert_null (cloth_mesh_reader_open (path, CLOTH_MESH_FORMAT_AUTO,
            &error));
    expect (&error, CLOTH_FILE_ERROR_UNSUPPORTED, "written, not read");
  }
  scratch_end ();
}

/* A clip that is too long says so at the frame that is too many. */
static void
test_gltf_too_long (void)
{
  g_autoptr (ClothTopology) small =
      cloth_topology_new_grid (COLUMNS, ROWS, 0.5f, 0.25f);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothMeshWriter) writer = NULL;

  scratch_begin ();
  writer = open_writer ("c.glb", small, 25, &error);
  for (guint i = 0; i < 1000; i++)
    g_assert_true (append (writer, N, i, &error));
  g_assert_false (append (writer, N, 1000, &error));
  expect (&error, CLOTH_FILE_ERROR_LIMIT, "at most 1000 frames; write OBJ");
  /* those that fit may still be kept */
  g_assert_true (cloth_mesh_writer_close (writer, &error));
  peer_run ("import json\n"
      "d=open('c.glb','rb').read()\n"
      "n,=struct.unpack_from('<I',d,12)\n"
      "j=json.loads(d[20:20+n])\n"
      "assert len(j['meshes'][0]['primitives'][0]['targets'])==999\n"
      "assert j['buffers'][0]['byteLength']+28+n==len(d)\n");
  scratch_end ();
}

/* One frame is a still mesh, and points without faces are points. */
static void
test_gltf_still (void)
{
  g_autoptr (ClothTopology) points = cloth_topology_new (5, 0);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothMeshWriter) writer = NULL;

  scratch_begin ();
  writer = open_writer ("c.glb", points, 0, &error);
  g_assert_no_error (error);
  g_assert_true (append (writer, 5, 0, &error));
  g_assert_true (cloth_mesh_writer_close (writer, &error));
  peer_run ("import json\n"
      "d=open('c.glb','rb').read()\n"
      "n,=struct.unpack_from('<I',d,12)\n"
      "j=json.loads(d[20:20+n])\n"
      "p,=j['meshes'][0]['primitives']\n"
      "assert p['mode']==0 and 'indices' not in p and 'targets' not in p\n"
      "assert 'animations' not in j and len(j['bufferViews'])==2\n"
      "b=np.frombuffer(d[28+n:],'<f4')\n"
      "assert (b[10:].reshape(5,3)[:,0]==np.arange(5)).all()\n");
  scratch_end ();
}

/* A mesh that doesn't know its uv has no strain: none is made up. */
static void
test_no_strain (void)
{
  g_autoptr (ClothTopology) topology =
      cloth_topology_new_grid (COLUMNS, ROWS, 0.5f, 0.25f);

  memset (topology->uv, 0, 2 * N * sizeof *topology->uv);
  scratch_begin ();
  write_two ("c.ply", topology);
  write_two ("c.pvd", topology);
  write_two ("c.csv", topology);
  peer_run ("assert b'strain' not in open('c_00000.ply','rb').read()\n"
      "d=open('c_00000.vtp','rb').read()\n"
      "assert b'strain' not in d and b'CellData' not in d\n"
      "l=open('c.csv').read().splitlines()\n"
      "assert l[0].endswith(',state,strain_warp,strain_weft,strain_shear')\n"
      "assert all(x.endswith(',1,,,') for x in l[1:])\n");
  scratch_end ();
}

static void
test_c3d_limits (void)
{
  g_autoptr (ClothTopology) small =
      cloth_topology_new_grid (COLUMNS, ROWS, 0.5f, 0.25f);
  g_autoptr (ClothTopology) many = cloth_topology_new (20000, 0);
  g_autoptr (ClothTopology) more = cloth_topology_new (30000, 0);
  g_autoptr (ClothTopology) most = cloth_topology_new (70000, 0);
  g_autoptr (ClothMeshWriter) writer = NULL;
  g_autoptr (GError) error = NULL;

  scratch_begin ();
  g_assert_null (open_writer ("c.c3d", small, 0, &error));
  expect (&error, CLOTH_FILE_ERROR_UNSUPPORTED, "format=csv");
  g_assert_null (open_writer ("c.c3d", more, 25, &error));
  expect (&error, CLOTH_FILE_ERROR_LIMIT, "30000 vertices");
  g_assert_null (open_writer ("c.c3d", most, 25, &error));
  expect (&error, CLOTH_FILE_ERROR_LIMIT, "format=csv");
  g_assert_cmpuint (scratch_count (), ==, 0);
  write_two ("many.c3d", many);
  peer_run ("d=open('many.c3d','rb').read()\n"
      "assert d.count(b'LABELS')==79 and b'v19999' in d\n"
      "assert struct.unpack_from('<H',d,2)==(20000,)\n");
  writer = open_writer ("c.c3d", small, 25, &error);
  for (guint i = 0; i < 65535; i++)
    g_assert_true (append (writer, N, i, &error));
  g_assert_false (append (writer, N, 65535, &error));
  expect (&error, CLOTH_FILE_ERROR_LIMIT, "65535 frames");
  scratch_end ();
}

/* A new sequence replaces a longer one of its name, whole. */
static void
test_vtp_stale (void)
{
  g_autoptr (ClothTopology) topology =
      cloth_topology_new_grid (COLUMNS, ROWS, 0.5f, 0.25f);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothMeshWriter) writer = NULL;

  scratch_begin ();
  writer = open_writer ("c.pvd", topology, 25, &error);
  for (guint i = 0; i < 6; i++)
    g_assert_true (append (writer, N, i, &error));
  g_assert_true (cloth_mesh_writer_close (writer, &error));
  g_clear_pointer (&writer, cloth_mesh_writer_free);
  g_assert_cmpuint (scratch_count (), ==, 7);
  write_two ("c.pvd", topology);
  g_assert_cmpuint (scratch_count (), ==, 3);
  scratch_end ();
}

/* What a killed program left of a collection: the frames count that are listed and there. */
static void
test_vtp_left (void)
{
  static const struct
  {
    guint n_files, n_listed, n_frames, n_left_out;
  } cases[] = { {3, 4, 3, 1}, {4, 3, 3, 1}, {3, 3, 3, 0}, {0, 3, 0, 3},
  {0, 0, 0, 0}
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (GString) text = g_string_new ("<Collection>\n");
    g_autofree gchar *head = NULL, *path = NULL;
    g_autoptr (ClothParts) parts = NULL;
    g_autoptr (GError) error = NULL;
    ClothRecovered recovered = { 0 };
    guint64 n_files;

    scratch_begin ();
    head = scratch_path ("c.pvd");
    parts = cloth_parts_new (head, "", &error);
    g_assert_no_error (error);
    for (guint k = 0; k < cases[i].n_files; k++) {
      g_autoptr (ClothOutput) output =
          cloth_parts_open_numbered (parts, "c", k, ".vtp", &error);

      g_assert_true (cloth_output_write (output, "x", 1, &error));
      g_assert_true (cloth_output_commit (output, &error));
    }
    for (guint k = 0; k < cases[i].n_listed; k++)
      g_string_append_printf (text, "    <DataSet file=\"c_%05u.vtp\"/>\n", k);
    g_string_append (text, "    <DataSet fi");
    path = cloth_parts_get_path (parts, "c.pvd");
    g_assert_true (g_file_set_contents (path, text->str, -1, NULL));
    g_assert_true (cloth_vtp_recover (parts, "c", &recovered, &error));
    g_assert_no_error (error);
    g_assert_cmpuint (recovered.n_frames, ==, cases[i].n_frames);
    g_assert_cmpuint (recovered.n_left_out, ==, cases[i].n_left_out);
    g_assert_true (cloth_parts_count_numbered (parts, "c", ".vtp", &n_files,
            &error));
    g_assert_cmpuint (n_files, ==, cases[i].n_frames);
    g_clear_pointer (&path, g_free);
    path = cloth_parts_get_path (parts, "c.pvd");
    g_assert_cmpint (truncate (path, (off_t) CLOTH_MAX_BUFFER + 1), ==, 0);
    g_assert_false (cloth_vtp_recover (parts, "c", &recovered, &error));
    g_assert_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT);
    scratch_end ();
  }
}

static gsize
largest_file (const gchar * folder)
{
  g_autoptr (GDir) dir = g_dir_open (folder, 0, NULL);
  const gchar *name;
  gsize largest = 0;

  while ((name = g_dir_read_name (dir))) {
    g_autofree gchar *path = g_build_filename (folder, name, NULL);
    GStatBuf st;

    g_assert_cmpint (g_stat (path, &st), ==, 0);
    largest = MAX (largest, S_ISDIR (st.st_mode) ? largest_file (path) :
        (gsize) st.st_size);
  }
  return largest;
}

/* Files that the system stops at a size: in each of the arrays that a frame is written as, most
 * of which are larger than the buffer. Nothing of them stays. */
static void
test_no_room (void)
{
  static const struct
  {
    const gchar *name;
    guint side, n_frames;       /* text takes longer */
    gboolean grid;
  } cases[] = {
    /* The cache of points is larger than the mesh, here. */
    {"c.obj", 150, 8, FALSE}, {"c.ply", 250, 1, FALSE},
    {"c.take", 100, 2, FALSE}, {"c.take", 250, 2, TRUE},
    {"c.pvd", 250, 1, FALSE}, {"c.csv", 100, 2, FALSE},
    {"c.usda", 100, 2, FALSE}, {"c.glb", 250, 2, FALSE},
  };
  static const gdouble shares[] =
      { 1 / 80., 1 / 5., 2 / 5., 7 / 10., 19 / 20. };
  struct rlimit before;

  g_assert_cmpint (getrlimit (RLIMIT_FSIZE, &before), ==, 0);
  signal (SIGXFSZ, SIG_IGN);
  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    const guint side = cases[i].side;
    g_autoptr (ClothTopology) topology =
        cloth_topology_new_grid (side, side, 1, 1);
    gsize whole;

    if (!cases[i].grid)
      topology->columns = topology->rows = 0;
    scratch_begin ();
    write_frames (cases[i].name, topology, cases[i].n_frames);
    whole = largest_file (scratch);
    scratch_end ();
    for (guint k = 0; k < G_N_ELEMENTS (shares); k++) {
      struct rlimit limit = before;
      g_autoptr (GError) error = NULL;
      ClothMeshWriter *writer;

      scratch_begin ();
      limit.rlim_cur = (rlim_t) (shares[k] * (gdouble) whole);
      g_assert_cmpint (setrlimit (RLIMIT_FSIZE, &limit), ==, 0);
      writer = open_writer (cases[i].name, topology, 25, &error);
      for (guint frame = 0; frame < cases[i].n_frames && !error; frame++)
        append (writer, topology->n_vertices, frame, &error);
      if (!error)
        cloth_mesh_writer_close (writer, &error);
      cloth_mesh_writer_free (writer);
      g_assert_cmpint (setrlimit (RLIMIT_FSIZE, &before), ==, 0);
      g_assert_nonnull (error);
      g_test_message ("%s, %g: %s", cases[i].name, shares[k], error->message);
      g_assert_cmpint (error->domain, ==, G_IO_ERROR);
      g_assert_cmpuint (scratch_count (), ==, 0);
      scratch_end ();
    }
  }
  signal (SIGXFSZ, SIG_DFL);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/meshexport/names", test_names);
  g_test_add_func ("/meshexport/whole-or-not-at-all", test_whole_or_not_at_all);
  g_test_add_func ("/meshexport/times-must-rise", test_times_must_rise);
  g_test_add_func ("/meshexport/unwritable", test_unwritable);
  g_test_add_func ("/meshexport/vtp-left", test_vtp_left);
  g_test_add_func ("/meshexport/no-room", test_no_room);
  g_test_add_func ("/meshexport/not-read", test_not_read);
  g_test_add_func ("/meshexport/gltf-too-long", test_gltf_too_long);
  g_test_add_func ("/meshexport/gltf-still", test_gltf_still);
  g_test_add_func ("/meshexport/no-strain", test_no_strain);
  g_test_add_func ("/meshexport/c3d-limits", test_c3d_limits);
  g_test_add_func ("/meshexport/vtp-stale", test_vtp_stale);
  return g_test_run ();
}
