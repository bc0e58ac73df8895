/* meshsink: files appear whole or not at all.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/cloth/cloth.h>
#include <math.h>
#include <sys/stat.h>

#include "gst/take/recover.h"
#include "gst/take/sequence.h"
#include "tests/core/meshpeer.h"

#define COLUMNS 3
#define ROWS 2
#define N (COLUMNS * ROWS)

typedef struct
{
  GstHarness *harness;
  GstBus *bus;
} Sink;

static GstCaps *
make_caps (guint columns, gint fps_n)
{
  g_autoptr (GstClothTopology) topology =
      gst_cloth_topology_new_grid (columns, ROWS, 0.5f, 0.25f, NULL);

  return gst_cloth_topology_to_caps (topology, fps_n, 1);
}

static GstBuffer *
make_buffer (guint frame, guint n)
{
  gfloat positions[3 * 32], covariances[6 * 32];
  guint8 states[32];
  g_autoptr (GstClothMesh) mesh = NULL;
  GstBuffer *buffer;

  for (guint i = 0; i < n; i++) {
    for (guint k = 0; k < 3; k++)
      positions[3 * i + k] = (gfloat) (frame + i);
    for (guint k = 0; k < 6; k++)
      covariances[6 * i + k] = 1e-6f;
    states[i] = i == 1 ? GST_CLOTH_VERTEX_UNSEEN : GST_CLOTH_VERTEX_TWO_VIEWS;
  }
  mesh = gst_cloth_mesh_new (frame, n, positions, states, covariances);
  buffer = gst_cloth_mesh_to_buffer (mesh);
  GST_BUFFER_PTS (buffer) = frame * GST_SECOND / 25;
  GST_BUFFER_DURATION (buffer) = GST_SECOND / 25;
  return buffer;
}

static Sink
open_sink (const gchar * location, const gchar * format)
{
  GstElement *element = gst_element_factory_make ("meshsink", NULL);
  Sink sink;

  fail_unless (element != NULL);
  if (location) {
    g_autofree gchar *path = *location == '/' ? g_strdup (location) :
        scratch_path (location);

    g_object_set (element, "location", path, NULL);
  }
  gst_util_set_object_arg (G_OBJECT (element), "format", format);
  sink.bus = gst_bus_new ();
  gst_element_set_bus (element, sink.bus);
  sink.harness = gst_harness_new_with_element (element, "sink", NULL);
  gst_harness_set_src_caps (sink.harness, make_caps (COLUMNS, 25));
  gst_object_unref (element);
  return sink;
}

static void
push_frames (Sink * sink, guint begin, guint n)
{
  for (guint i = 0; i < n; i++)
    fail_unless_equals_int (gst_harness_push (sink->harness,
            make_buffer (begin + i, N)), GST_FLOW_OK);
}

static void
close_sink (Sink * sink)
{
  gst_element_set_bus (sink->harness->element, NULL);
  gst_harness_teardown (sink->harness);
  gst_object_unref (sink->bus);
}

/* The error that was posted must be the one expected and say @text. */
static void
expect_error (Sink * sink, GQuark domain, gint code, const gchar * text)
{
  g_autoptr (GstMessage) message = gst_bus_pop_filtered (sink->bus,
      GST_MESSAGE_ERROR);
  g_autoptr (GError) error = NULL;
  g_autofree gchar *debug = NULL;

  fail_unless (message != NULL, "no error was posted");
  gst_message_parse_error (message, &error, &debug);
  /* what to do stands on a line of its own */
  fail_unless (strstr (debug, ":\n") != NULL, "%s: %s", error->message, debug);
  GST_INFO ("%s", error->message);
  fail_unless (g_error_matches (error, domain, code), "%s", error->message);
  fail_unless (strstr (error->message, text) != NULL, "%s", error->message);
  /* a file is named once */
  fail_unless (*text != '/' || !strstr (strstr (error->message, text) + 1,
          text), "%s", error->message);
}

static void
expect_no_error (Sink * sink)
{
  g_autoptr (GstMessage) message = gst_bus_pop_filtered (sink->bus,
      GST_MESSAGE_ERROR);

  fail_unless (message == NULL);
}

/* After an error was seen no second one is posted, at the end neither. */
static void
close_sink_quietly (Sink * sink)
{
  gst_element_set_state (sink->harness->element, GST_STATE_NULL);
  expect_no_error (sink);
  close_sink (sink);
}

static void
expect_frames (const gchar * location, guint begin, guint n, gdouble fps)
{
  g_autofree gchar *path = scratch_path (location);
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothMeshReader) reader =
      cloth_mesh_reader_open (path, CLOTH_MESH_FORMAT_AUTO, &error);
  ClothMeshFrame frame;

  g_assert_no_error (error);
  fail_unless_equals_int (cloth_mesh_reader_get_n_frames (reader), n);
  fail_unless_equals_float (cloth_mesh_reader_get_fps (reader), fps);
  for (guint i = 0; i < n; i++) {
    fail_unless (cloth_mesh_reader_read (reader, i, &frame, &error));
    fail_unless_equals_float (frame.positions[15], begin + i + 5);
    fail_unless (isnan (frame.positions[3]));
    fail_unless_equals_int (frame.states[1], GST_CLOTH_VERTEX_UNSEEN);
    fail_unless_equals_int (frame.states[2], GST_CLOTH_VERTEX_TWO_VIEWS);
  }
}

static void
expect_warning (Sink * sink, const gchar * text)
{
  g_autoptr (GstMessage) message = gst_bus_pop_filtered (sink->bus,
      GST_MESSAGE_WARNING);
  g_autoptr (GError) error = NULL;

  if (!text) {
    fail_unless (message == NULL);
    return;
  }
  fail_unless (message != NULL, "no warning was posted");
  gst_message_parse_warning (message, &error, NULL);
  fail_unless (g_error_matches (error, GST_RESOURCE_ERROR,
          GST_RESOURCE_ERROR_FAILED));
  fail_unless (strstr (error->message, text) != NULL, "%s", error->message);
}

/* What an error left can be finished, and is nothing but these frames. */
static void
expect_kept (const gchar * name, guint first, guint n_frames)
{
  g_autofree gchar *path = scratch_path (name);
  g_autoptr (GPtrArray) found = cloth_recover_find (path, NULL);
  g_autoptr (GError) error = NULL;
  ClothRecovered recovered;

  fail_unless (found != NULL && found->len == 1);
  fail_unless (cloth_recover (found->pdata[0], FALSE, &recovered, &error));
  fail_unless (error == NULL);
  fail_unless_equals_int (recovered.n_frames, n_frames);
  expect_frames (name, first, n_frames, 25);
}

static const gchar *const names[] = { "c.obj", "c.ply", "c.take" };

/* The property says what an ending would; there is nothing before EOS. */
GST_START_TEST (test_writes_at_eos)
{
  static const gchar *const odd[] = { "a", "b", "d" };
  static const gchar *const formats[] = { "obj-pc2", "ply", "take" };
  static const gchar *const read_as[] = { "a.obj", "b.ply", "d" };

  for (guint i = 0; i < 6; i++) {
    const gchar *name = i < 3 ? names[i] : odd[i - 3];
    Sink sink;

    scratch_begin ();
    sink = open_sink (name, i < 3 ? "auto" : formats[i - 3]);
    push_frames (&sink, 0, 4);
    {
      g_autofree gchar *path = scratch_path (i < 3 ? name : read_as[i - 3]);
      g_autoptr (ClothMeshReader) reader =
          cloth_mesh_reader_open (path, CLOTH_MESH_FORMAT_AUTO, NULL);

      fail_unless (reader == NULL);
    }
    fail_unless (gst_harness_push_event (sink.harness, gst_event_new_eos ()));
    expect_no_error (&sink);
    expect_frames (i < 3 ? name : read_as[i - 3], 0, 4, 25);
    close_sink (&sink);
    expect_frames (i < 3 ? name : read_as[i - 3], 0, 4, 25);
    scratch_end ();
  }
}

GST_END_TEST;

GST_START_TEST (test_writes_at_stop)
{
  for (guint i = 0; i < G_N_ELEMENTS (names); i++) {
    Sink sink;

    scratch_begin ();
    sink = open_sink (names[i], "auto");
    push_frames (&sink, 0, 3);
    close_sink (&sink);
    expect_frames (names[i], 0, 3, 25);
    scratch_end ();
  }
}

GST_END_TEST;

GST_START_TEST (test_times_of_take)
{
  Sink sink;

  scratch_begin ();
  sink = open_sink ("c.take", "auto");
  push_frames (&sink, 3, 2);
  push_frames (&sink, 9, 1);
  fail_unless (gst_harness_push_event (sink.harness, gst_event_new_eos ()));
  close_sink (&sink);
  peer_run ("t=np.load('c.take/times.npy')\n"
      "assert np.allclose(t,[.12,.16,.36],atol=1e-12),t\n"
      "c=np.load('c.take/covariance.npy')\n"
      "assert np.isnan(c[:,1]).all() and np.allclose(c[:,[0,2,5]],1e-6)\n");
  scratch_end ();
}

GST_END_TEST;

/* As filesink does, a flush starts anew. */
GST_START_TEST (test_flush)
{
  for (guint i = 0; i < G_N_ELEMENTS (names); i++) {
    Sink sink;
    GstSegment segment;

    scratch_begin ();
    sink = open_sink (names[i], "auto");
    push_frames (&sink, 0, 5);
    fail_unless (gst_harness_push_event (sink.harness,
            gst_event_new_flush_start ()));
    fail_unless (gst_harness_push_event (sink.harness,
            gst_event_new_flush_stop (TRUE)));
    gst_segment_init (&segment, GST_FORMAT_TIME);
    fail_unless (gst_harness_push_event (sink.harness,
            gst_event_new_segment (&segment)));
    push_frames (&sink, 1, 2);
    fail_unless (gst_harness_push_event (sink.harness, gst_event_new_eos ()));
    expect_no_error (&sink);
    close_sink (&sink);
    expect_frames (names[i], 1, 2, 25);
    scratch_end ();
  }
}

GST_END_TEST;

GST_START_TEST (test_renegotiation)
{
  for (guint i = 0; i < G_N_ELEMENTS (names); i++) {
    for (guint rate = 0; rate < 2; rate++) {
      Sink sink;

      scratch_begin ();
      sink = open_sink (names[i], "auto");
      push_frames (&sink, 0, 2);
      /* The same again is nothing new. */
      gst_harness_set_src_caps (sink.harness, make_caps (COLUMNS, 25));
      push_frames (&sink, 2, 2);
      expect_no_error (&sink);
      gst_harness_set_src_caps (sink.harness,
          make_caps (rate ? COLUMNS : 4, rate ? 30 : 25));
      expect_error (&sink, GST_STREAM_ERROR, GST_STREAM_ERROR_FORMAT,
          "changed in the middle");
      close_sink (&sink);
      expect_kept (names[i], 0, 4);
      scratch_end ();
    }
  }
}

GST_END_TEST;

GST_START_TEST (test_bad_buffers)
{
  for (guint i = 0; i < 3; i++) {
    Sink sink;
    GstBuffer *buffer = i == 0 ? make_buffer (3, 8) :
        i == 1 ? gst_buffer_new_wrapped (g_strdup ("garbage"), 7) :
        gst_buffer_new ();

    scratch_begin ();
    sink = open_sink ("c.obj", "auto");
    push_frames (&sink, 0, 3);
    fail_unless_equals_int (gst_harness_push (sink.harness, buffer),
        GST_FLOW_ERROR);
    expect_error (&sink, GST_STREAM_ERROR, GST_STREAM_ERROR_DECODE, "mesh");
    expect_warning (&sink,
        "3 frames are kept: “gst-cloth-take-1.0 recover /");
    fail_unless_equals_int (scratch_count (), 1);
    /* It stays an error: nothing half appears at EOS or stop. */
    fail_unless_equals_int (gst_harness_push (sink.harness, make_buffer (4,
                N)), GST_FLOW_ERROR);
    gst_harness_push_event (sink.harness, gst_event_new_eos ());
    close_sink (&sink);
    fail_unless_equals_int (scratch_count (), 1);
    expect_kept ("c.obj", 0, 3);
    scratch_end ();
  }
}

GST_END_TEST;

GST_START_TEST (test_time_that_does_not_rise)
{
  Sink sink;

  scratch_begin ();
  sink = open_sink ("c.take", "auto");
  push_frames (&sink, 2, 1);
  fail_unless_equals_int (gst_harness_push (sink.harness, make_buffer (2, N)),
      GST_FLOW_ERROR);
  expect_error (&sink, GST_STREAM_ERROR, GST_STREAM_ERROR_FORMAT, "later");
  fail_unless_equals_int (gst_harness_push (sink.harness, make_buffer (3, N)),
      GST_FLOW_ERROR);
  fail_if (gst_harness_push_event (sink.harness, gst_event_new_eos ()));
  close_sink_quietly (&sink);
  expect_kept ("c.take", 2, 1);
  scratch_end ();
}

GST_END_TEST;

GST_START_TEST (test_no_mesh)
{
  Sink sink;

  scratch_begin ();
  sink = open_sink ("c.obj", "auto");
  fail_if (gst_harness_push_event (sink.harness, gst_event_new_eos ()));
  expect_error (&sink, GST_STREAM_ERROR, GST_STREAM_ERROR_FAILED,
      "single mesh");
  close_sink (&sink);
  fail_unless_equals_int (scratch_count (), 0);
  scratch_end ();
}

GST_END_TEST;

GST_START_TEST (test_unwritable)
{
  static const gchar *const places[] = { "/nonexistent/c.obj",
    "/nonexistent/c.ply", "/nonexistent/c.take", "/dev/null/c.take"
  };

  for (guint i = 0; i < G_N_ELEMENTS (places); i++) {
    Sink sink = open_sink (places[i], "auto");

    fail_unless_equals_int (gst_harness_push (sink.harness, make_buffer (0,
                N)), GST_FLOW_ERROR);
    expect_error (&sink, GST_RESOURCE_ERROR,
        i < 3 ? GST_RESOURCE_ERROR_OPEN_WRITE : GST_RESOURCE_ERROR_WRITE,
        places[i]);
    close_sink (&sink);
  }
}

GST_END_TEST;

/* What is no regular file stays; /dev/null.obj is not made either. */
GST_START_TEST (test_device)
{
  static const gchar *const formats[] = { "auto", "obj-pc2", "csv" };

  for (guint i = 0; i < G_N_ELEMENTS (formats); i++) {
    Sink sink = open_sink ("/dev/null", formats[i]);
    GStatBuf info;

    fail_unless_equals_int (gst_harness_push (sink.harness, make_buffer (0,
                N)), GST_FLOW_ERROR);
    expect_error (&sink, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_WRITE,
        "name a regular file");
    close_sink (&sink);
    fail_unless_equals_int (g_stat ("/dev/null", &info), 0);
    fail_unless (S_ISCHR (info.st_mode));
    fail_if (g_file_test ("/dev/null.obj", G_FILE_TEST_EXISTS));
  }
}

GST_END_TEST;

/* What a program that is gone left of @name. */
static gchar *
leave_remains (const gchar * name, gboolean frame)
{
  g_autofree gchar *head = scratch_path (name);
  g_autofree gchar *hidden = g_str_has_suffix (name, ".take") ?
      g_strdup_printf ("%s/.take.json.part-abcdef", head) :
      g_strdup_printf ("%s/.%s.part-abcdef", scratch, name);
  g_autofree gchar *whole = g_build_filename (hidden, "new", NULL);
  g_autofree gchar *lock = g_build_filename (hidden, "recording", NULL);

  fail_unless_equals_int (g_mkdir_with_parents (whole, 0777), 0);
  fail_unless (g_file_set_contents (lock, frame ?
          "gst-cloth recording 1\n6\nframe\n" : "gst-cloth recording 1\n6\n",
          -1, NULL));
  return g_steal_pointer (&hidden);
}

/* An interrupted recording is told of. When the next one is whole, it goes unless it can be
 * recovered. */
GST_START_TEST (test_remains)
{
  static const struct
  {
    const gchar *name, *text;
    gboolean frame;
  } cases[] = {
    {"c.obj", "gst-cloth-take-1.0 recover /", TRUE},
    {"c.ply", "gst-cloth-take-1.0 recover /", TRUE},
    {"c.take", "gst-cloth-take-1.0 recover /", TRUE},
    {"c.csv", "gst-cloth-take-1.0 recover /", TRUE},
    {"c.obj", "can't be finished"}, {"c.take", "can't be finished"},
    {"c.usda", "can't be finished"}, {"c.glb", "can't be finished"}
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autofree gchar *left = NULL;
    Sink sink;

    scratch_begin ();
    left = leave_remains (cases[i].name, cases[i].frame);
    sink = open_sink (cases[i].name, "auto");
    expect_warning (&sink, cases[i].text);
    expect_warning (&sink, NULL);
    push_frames (&sink, 0, 2);
    fail_unless (g_file_test (left, G_FILE_TEST_IS_DIR));
    fail_unless (gst_harness_push_event (sink.harness, gst_event_new_eos ()));
    expect_no_error (&sink);
    fail_unless (g_file_test (left, G_FILE_TEST_IS_DIR) == cases[i].frame);
    close_sink (&sink);
    scratch_end ();
  }
}

GST_END_TEST;

static void
copy_take (const gchar * name)
{
  static const gchar *const files[] = { "take.json", "positions.npy",
    "clamps.npy"
  };
  g_autofree gchar *path = scratch_path (name);

  g_assert_cmpint (g_mkdir (path, 0777), ==, 0);
  for (guint i = 0; i < G_N_ELEMENTS (files); i++) {
    g_autofree gchar *from = g_build_filename (TEST_DATA, "take_drag",
        files[i], NULL);
    g_autofree gchar *to = g_build_filename (path, files[i], NULL);
    g_autofree gchar *bytes = NULL;
    gsize size;

    g_assert_true (g_file_get_contents (from, &bytes, &size, NULL));
    g_assert_true (g_file_set_contents (to, bytes, (gssize) size, NULL));
  }
}

/* A stream has no clamps: a take that had some is not replaced without a word. */
GST_START_TEST (test_scene_lost)
{
  Sink sink;

  scratch_begin ();
  copy_take ("c.take");
  for (guint again = 0; again < 2; again++) {
    sink = open_sink ("c.take", again == 1 ? "take" : "auto");
    push_frames (&sink, 0, 2);
    if (!again)
      expect_warning (&sink, "has clamps, obstacles or seams");
    expect_warning (&sink, NULL);
    fail_unless (gst_harness_push_event (sink.harness, gst_event_new_eos ()));
    expect_no_error (&sink);
    close_sink (&sink);
  }
  scratch_end ();
}

GST_END_TEST;

/* Nothing is told of another location, nor of a program that lives. */
/* Files that count frames keep nothing of when these came; that is said once, of a still not at all. */
GST_START_TEST (test_times_lost)
{
  static const struct
  {
    const gchar *location;
    gint fps;
    guint n;
    gboolean warns;
  } cases[] = {
    {"c.obj", 0, 3, TRUE}, {"c.ply", 0, 3, TRUE}, {"c.obj", 0, 1, FALSE},
    {"c.obj", 25, 3, FALSE}, {"c.take", 0, 3, FALSE}, {"c.csv", 0, 3, FALSE},
    {"c.glb", 0, 3, FALSE}, {"c.usda", 0, 3, FALSE}, {"c.pvd", 0, 3, FALSE},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    Sink sink;

    scratch_begin ();
    sink = open_sink (cases[i].location, "auto");
    gst_harness_set_src_caps (sink.harness, make_caps (COLUMNS, cases[i].fps));
    push_frames (&sink, 0, cases[i].n);
    gst_harness_push_event (sink.harness, gst_event_new_eos ());
    if (cases[i].warns)
      expect_warning (&sink, "have no frame rate");
    expect_warning (&sink, NULL);
    close_sink (&sink);
    scratch_end ();
  }
}

GST_END_TEST;

GST_START_TEST (test_no_remains)
{
  g_autofree gchar *left = NULL;
  Sink first, second, other;

  scratch_begin ();
  left = leave_remains ("other.obj", TRUE);
  first = open_sink ("c.obj", "auto");
  push_frames (&first, 0, 1);
  second = open_sink ("c.obj", "auto");
  other = open_sink ("c", "ply");
  expect_warning (&first, NULL);
  expect_warning (&second, NULL);
  expect_warning (&other, NULL);
  push_frames (&first, 1, 1);
  fail_unless (gst_harness_push_event (first.harness, gst_event_new_eos ()));
  expect_frames ("c.obj", 0, 2, 25);
  fail_unless (g_file_test (left, G_FILE_TEST_IS_DIR));
  close_sink (&first);
  close_sink (&second);
  close_sink (&other);
  scratch_end ();
}

GST_END_TEST;

GST_START_TEST (test_no_location)
{
  g_autoptr (GstElement) element =
      gst_object_ref_sink (gst_element_factory_make ("meshsink", NULL));
  GstBus *bus = gst_bus_new ();
  Sink sink = { NULL, bus };

  gst_element_set_bus (element, bus);
  fail_unless_equals_int (gst_element_set_state (element, GST_STATE_PAUSED),
      GST_STATE_CHANGE_FAILURE);
  expect_error (&sink, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_NOT_FOUND,
      "location");
  gst_element_set_bus (element, NULL);
  gst_element_set_state (element, GST_STATE_NULL);
  gst_object_unref (bus);
}

GST_END_TEST;

/* Names whose ending is of no format, or of another one, make no files of other names; the
 * error lists the endings that there are. */
GST_START_TEST (test_wrong_endings)
{
  static const struct
  {
    const gchar *location, *format, *text;
  } cases[] = {
    {"m.usd", "auto", "the ending .usd is not known; give .obj"},
    {"m.gltf", "auto", ".glb (glTF)"},
    {"m.fbx", "auto", ".usda (USD)"},
    {"m.abc", "auto", ".pvd (VTK)"},
    {"m.npy", "auto", ".take for a folder of NumPy arrays"},
    {"m.npy", "ply", "the ending .npy is not known"},
    {"m.ply", "obj-pc2", "not of the format that is set; give .obj"},
    {"m.obj", "take", "the ending .obj is not of the format"},
    {"m.glb", "usd", "the ending .glb is not of the format"},
  };

  scratch_begin ();
  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autofree gchar *path = scratch_path (cases[i].location);
    g_autoptr (GstElement) element =
        gst_object_ref_sink (gst_element_factory_make ("meshsink", NULL));
    g_autoptr (GstBus) bus = gst_bus_new ();
    Sink sink = { NULL, bus };

    g_object_set (element, "location", path, NULL);
    gst_util_set_object_arg (G_OBJECT (element), "format", cases[i].format);
    gst_element_set_bus (element, bus);
    fail_unless_equals_int (gst_element_set_state (element, GST_STATE_PAUSED),
        GST_STATE_CHANGE_FAILURE);
    expect_error (&sink, GST_STREAM_ERROR, GST_STREAM_ERROR_FORMAT,
        cases[i].text);
    gst_element_set_state (element, GST_STATE_NULL);
    expect_no_error (&sink);    /* one is enough */
    gst_element_set_bus (element, NULL);
  }
  fail_unless_equals_int (scratch_count (), 0);
  scratch_end ();
}

GST_END_TEST;

/* A dot need not begin an ending, and a format set by name needs none. */
GST_START_TEST (test_names_without_ending)
{
  static const gchar *const cases[][3] = {
    {"trial.1", "auto", "trial.1.obj"}, {"bare", "ply", "bare_00000.ply"},
    {"day.monday", "take", "day.monday/take.json"},
    {"M.OBJ", "auto", "M.obj"},
  };

  scratch_begin ();
  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autofree gchar *path = scratch_path (cases[i][2]);
    Sink sink = open_sink (cases[i][0], cases[i][1]);

    push_frames (&sink, 0, 1);
    fail_unless (gst_harness_push_event (sink.harness, gst_event_new_eos ()));
    expect_no_error (&sink);
    close_sink (&sink);
    fail_unless (g_file_test (path, G_FILE_TEST_IS_REGULAR), "%s", path);
  }
  scratch_end ();
}

GST_END_TEST;

GST_START_TEST (test_bad_caps)
{
  Sink sink;
  GstCaps *caps;

  scratch_begin ();
  sink = open_sink ("c.obj", "auto");
  caps = gst_caps_from_string ("application/x-cloth-mesh, version=1, "
      "vertices=6, framerate=25/1");
  gst_harness_push_event (sink.harness, gst_event_new_caps (caps));
  gst_caps_unref (caps);
  expect_error (&sink, GST_STREAM_ERROR, GST_STREAM_ERROR_FORMAT, "caps");
  /* What goes wrong after that is told by the first message. */
  fail_if (gst_harness_push_event (sink.harness, gst_event_new_eos ()));
  close_sink_quietly (&sink);
  scratch_end ();
}

GST_END_TEST;

static Suite *
meshsink_suite (void)
{
  Suite *suite = suite_create ("meshsink");
  TCase *tests = tcase_create ("general");

  suite_add_tcase (suite, tests);
  tcase_add_test (tests, test_writes_at_eos);
  tcase_add_test (tests, test_writes_at_stop);
  tcase_add_test (tests, test_times_of_take);
  tcase_add_test (tests, test_flush);
  tcase_add_test (tests, test_renegotiation);
  tcase_add_test (tests, test_bad_buffers);
  tcase_add_test (tests, test_time_that_does_not_rise);
  tcase_add_test (tests, test_no_mesh);
  tcase_add_test (tests, test_unwritable);
  tcase_add_test (tests, test_device);
  tcase_add_test (tests, test_remains);
  tcase_add_test (tests, test_scene_lost);
  tcase_add_test (tests, test_times_lost);
  tcase_add_test (tests, test_no_remains);
  tcase_add_test (tests, test_no_location);
  tcase_add_test (tests, test_wrong_endings);
  tcase_add_test (tests, test_names_without_ending);
  tcase_add_test (tests, test_bad_caps);
  return suite;
}

GST_CHECK_MAIN (meshsink);
