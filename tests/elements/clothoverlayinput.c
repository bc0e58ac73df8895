/* clothoverlay: changes in the middle of a stream, and input that nobody should send.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/elements/clothoverlayscene.h"
#include "tests/elements/damage.h"

static const gchar second_camera[] =
    ", {\"name\": \"right\", \"size\": [80, 60], "
    "\"K\": [[100, 0, 39.5], [0, 100, 29.5], [0, 0, 1]], "
    "\"distortion\": {\"model\": \"none\", \"coefficients\": []}, "
    "\"R\": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], \"t\": [0.1, 0, 0]}";

GST_START_TEST (test_caps_change)
{
  static const gchar *const of[] = { "I420", "RGBA", "GRAY8" };
  GstHarness *h = overlay ("fill-opacity=0", NULL);
  guint i;

  for (i = 0; i < 3; i++) {
    gint width = 50 + 13 * (gint) i;
    GstClothQuad q = quad_at (5, 6, 25, 1);
    const Line lines[4] = {
      {5, 6, 30, 6}, {30, 6, 30, 31}, {30, 31, 5, 31}, {5, 31, 5, 6}
    };
    GstVideoInfo info;
    GstBuffer *buffer = picture (of[i], width, 40, 0, &info), *out;
    GstCaps *caps;

    GST_BUFFER_PTS (buffer) = i * GST_SECOND;
    add_quads (buffer, &q, 1);
    gst_harness_set_src_caps (h, gst_video_info_to_caps (&info));
    gst_harness_push (h, buffer);
    out = gst_harness_pull (h);
    check_lines (out, &info, lines, 4, 1.5 + EDGES);
    caps = gst_pad_get_current_caps (h->sinkpad);
    fail_unless_equals_string (gst_structure_get_string (gst_caps_get_structure
            (caps, 0), "format"), of[i]);
    gst_caps_unref (caps);
    gst_buffer_unref (out);
  }
  gst_harness_teardown (h);
}

GST_END_TEST;

/* Upstream learns what downstream takes. */
GST_START_TEST (test_caps_query)
{
  GstHarness *h = overlay ("", NULL);
  GstCaps *caps;

  gst_harness_set_sink_caps_str (h, "video/x-raw,format=NV12,width=320");
  caps = gst_pad_peer_query_caps (h->srcpad, NULL);
  fail_unless_equals_string (gst_structure_get_string (gst_caps_get_structure
          (caps, 0), "format"), "NV12");
  gst_caps_unref (caps);
  gst_harness_teardown (h);
}

GST_END_TEST;

static void
push_title (GstHarness * h, const gchar * title)
{
  gst_harness_push_event (h, gst_event_new_tag (gst_tag_list_new
          (GST_TAG_TITLE, title, NULL)));
}

/* The title that comes before the next picture, or before the end. */
static void
expect_title (GstHarness * h, const gchar * title)
{
  GstEventType before = GST_EVENT_UNKNOWN;
  gboolean found = FALSE;

  while (!found) {
    g_autoptr (GstEvent) event = gst_harness_pull_event (h);
    g_autofree gchar *is = NULL;
    GstTagList *tags;

    fail_unless (event != NULL);
    found = GST_EVENT_TYPE (event) == GST_EVENT_TAG;
    if (found) {
      gst_event_parse_tag (event, &tags);
      fail_unless (gst_tag_list_get_string (tags, GST_TAG_TITLE, &is));
      fail_unless_equals_string (is, title);
      fail_unless_equals_int (before, before == GST_EVENT_UNKNOWN ?
          GST_EVENT_UNKNOWN : GST_EVENT_SEGMENT);
    }
    before = GST_EVENT_TYPE (event);
    fail_if (before == GST_EVENT_EOS);
  }
}

/* What is said of the pictures goes on in its place; of meshes nothing does. */
GST_START_TEST (test_tags)
{
  GstElement *element =
      gst_object_ref_sink (gst_element_factory_make ("clothoverlay", NULL));
  GstHarness *h = gst_harness_new_with_element (element, "sink", "src");
  GstHarness *mesh = gst_harness_new_with_element (element, "mesh", NULL);
  GstVideoInfo info;
  GstEvent *event;

  /* no mesh will come */
  gst_harness_push_event (mesh, gst_event_new_stream_start ("mesh"));
  push_title (mesh, "of the mesh");
  gst_harness_push_event (mesh, gst_event_new_eos ());
  gst_buffer_unref (picture ("GRAY8", 50, 40, 0, &info));
  gst_harness_set_src_caps (h, gst_video_info_to_caps (&info));
  push_title (h, "first");
  for (guint i = 0; i < 2; i++) {
    GstBuffer *buffer = picture ("GRAY8", 50, 40, 0, &info);

    GST_BUFFER_PTS (buffer) = i * GST_SECOND;
    gst_harness_push (h, buffer);
    gst_buffer_unref (gst_harness_pull (h));
    expect_title (h, i == 0 ? "first" : "second");
    push_title (h, i == 0 ? "second" : "third");
  }
  gst_harness_push_event (h, gst_event_new_eos ());
  expect_title (h, "third");
  event = gst_harness_pull_event (h);
  fail_unless_equals_int (GST_EVENT_TYPE (event), GST_EVENT_EOS);
  gst_event_unref (event);
  gst_harness_teardown (mesh);
  gst_harness_teardown (h);
  gst_object_unref (element);
}

GST_END_TEST;

/* A flushing seek in a real pipeline: the frame asked for comes next, and the film goes
 * on to its end. */
GST_START_TEST (test_seek)
{
  GstElement *pipeline =
      gst_parse_launch ("videotestsrc num-buffers=300 ! "
      "video/x-raw,format=I420,width=32,height=32,framerate=30/1 ! clothoverlay ! "
      "fakesink name=sink sync=false", NULL);
  GstElement *sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");
  GstBus *bus = gst_element_get_bus (pipeline);
  GstSample *sample = NULL;
  GstMessage *message;

  gst_element_set_state (pipeline, GST_STATE_PAUSED);
  fail_unless_equals_int (gst_element_get_state (pipeline, NULL, NULL,
          GST_CLOCK_TIME_NONE), GST_STATE_CHANGE_SUCCESS);
  fail_unless (gst_element_seek_simple (pipeline, GST_FORMAT_TIME,
          GST_SEEK_FLAG_FLUSH | GST_SEEK_FLAG_ACCURATE, 5 * GST_SECOND));
  fail_unless_equals_int (gst_element_get_state (pipeline, NULL, NULL,
          GST_CLOCK_TIME_NONE), GST_STATE_CHANGE_SUCCESS);
  g_object_get (sink, "last-sample", &sample, NULL);
  fail_unless (sample != NULL);
  fail_unless_equals_uint64 (GST_BUFFER_PTS (gst_sample_get_buffer (sample)),
      5 * GST_SECOND);
  gst_sample_unref (sample);

  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  message = gst_bus_timed_pop_filtered (bus, GST_CLOCK_TIME_NONE,
      GST_MESSAGE_EOS | GST_MESSAGE_ERROR);
  fail_unless_equals_int (GST_MESSAGE_TYPE (message), GST_MESSAGE_EOS);
  gst_message_unref (message);
  g_object_get (sink, "last-sample", &sample, NULL);
  fail_unless (GST_BUFFER_PTS (gst_sample_get_buffer (sample)) >
      9900 * GST_MSECOND);
  gst_sample_unref (sample);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (bus);
  gst_object_unref (sink);
  gst_object_unref (pipeline);
}

GST_END_TEST;

/* ---- bad input ---- */

GST_START_TEST (test_one_pixel)
{
  guint f;

  for (f = 0; f < G_N_ELEMENTS (formats); f++) {
    GstClothQuad q = quad_at (-5, -5, 20, 1);
    GstVideoInfo info;
    GstBuffer *buffer = picture (formats[f], 1, 1, 0, &info), *out;

    add_quads (buffer, &q, 1);
    out = draw ("draw-indices=true", &info, buffer);
    gst_buffer_unref (out);
  }
}

GST_END_TEST;

GST_START_TEST (test_bad_coordinates)
{
  static const gfloat bad[] = {
    NAN, INFINITY, -INFINITY, 1e30f, -1e30f, 3e9f, -3e9f, 1e6f
  };
  GstVideoInfo info;
  guint i, k;

  for (i = 0; i < G_N_ELEMENTS (bad); i++) {
    for (k = 0; k < 4; k++) {
      GstBuffer *buffer = picture ("I420", 64, 48, 7, &info), *out;
      GstClothQuad q = quad_at (10, 10, 20, NAN);
      GstClothSaddle s = { 20, 20, 1, 0, 1, 0, 1 };

      q.x[k] = bad[i];
      q.y[(k + 1) & 3] = bad[i];
      s.x = k & 1 ? bad[i] : 20;
      s.y = k & 1 ? 20 : bad[i];
      s.cov_xx = s.cov_xy = bad[i];
      add_quads (buffer, &q, 1);
      add_saddles (buffer, &s, 1, NULL, 0);
      out = draw ("draw-saddles=true draw-indices=true ellipse-scale=10", &info,
          buffer);
      check_padding (out, &info, 7);
      gst_buffer_unref (out);
    }
  }
}

GST_END_TEST;

/* Indices that no board has, states that there are not: drawn or left out, within the
 * picture. */
GST_START_TEST (test_wild_squares)
{
  static const gint wild[] = { -1, G_MININT, G_MAXINT, 1000000, 65536 };
  GstVideoInfo info;
  GstClothQuad q[3 * G_N_ELEMENTS (wild)];
  GstBuffer *buffer = picture ("NV12", 64, 48, 7, &info), *out;
  guint i;

  for (i = 0; i < G_N_ELEMENTS (q); i++) {
    gint value = wild[i / 3];

    q[i] = quad_at (i % 2 ? 40 : 10, 10, 20, i % 3 ? 1e30f : -1e30f);
    if (i % 3 == 0) {
      q[i].column = value;
    } else if (i % 3 == 1) {
      q[i].row = value;
    } else {
      q[i].state = (GstClothQuadState) value;
    }
  }
  add_quads (buffer, q, G_N_ELEMENTS (q));
  out = draw ("draw-indices=true", &info, buffer);
  check_padding (out, &info, 7);
  gst_buffer_unref (out);
}

GST_END_TEST;

/* A square folded over itself has no inside to fill; degenerate ones are points. */
GST_START_TEST (test_degenerate_squares)
{
  GstClothQuad q[2] = { quad_at (10, 10, 20, 1), quad_at (40, 10, 0, 1) };
  GstVideoInfo info;
  GstBuffer *buffer = picture ("GRAY8", 64, 48, 0, &info), *out;
  const Line lines[5] = {
    {10, 10, 30, 10}, {30, 10, 10, 30}, {10, 30, 30, 30}, {30, 30, 10, 10},
    {40, 10, 40, 10}
  };

  q[0].x[2] = 10;
  q[0].x[3] = 30;
  add_quads (buffer, q, 2);
  out = draw ("line-width=2", &info, buffer);
  check_lines (out, &info, lines, 5, 2 + EDGES);
  gst_buffer_unref (out);
}

GST_END_TEST;

GST_START_TEST (test_unknown_format)
{
  GstHarness *h = overlay ("", NULL);

  gst_harness_set_src_caps_str (h,
      "video/x-raw,format=P010_10LE,width=32,height=32,framerate=30/1");
  fail_unless_equals_int (gst_harness_push (h, gst_buffer_new_allocate (NULL,
              4096, NULL)), GST_FLOW_NOT_NEGOTIATED);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* Each must end in an element error that names the fix. */
static void
expect_error (const gchar * properties, gint width, gint height,
    GstBuffer * mesh, gsize picture_size, const gchar * in_text)
{
  GstVideoInfo info;
  GstBuffer *buffer = picture ("GRAY8", width, height, 0, &info);
  GstHarness *h = overlay (properties, NULL), *m = NULL;
  GstBus *bus = gst_bus_new ();
  GstMessage *message;
  GError *error = NULL;
  gchar *debug = NULL, *all;

  gst_element_set_bus (h->element, bus);
  if (picture_size) {
    GstClothQuad q = quad_at (2, 2, 5, 1);

    gst_buffer_unref (buffer);
    buffer = gst_buffer_new_allocate (NULL, picture_size, NULL);
    GST_BUFFER_PTS (buffer) = 0;
    add_quads (buffer, &q, 1);
  }
  if (mesh) {
    m = mesh_pad (h);
  }
  gst_harness_set_src_caps (h, gst_video_info_to_caps (&info));
  gst_harness_push (h, buffer);
  if (m) {
    gst_harness_push (m, mesh);
  }
  message = gst_bus_timed_pop_filtered (bus, 20 * GST_SECOND,
      GST_MESSAGE_ERROR);
  fail_unless (message != NULL, "%s: no error", properties);
  gst_message_parse_error (message, &error, &debug);
  all = g_strconcat (error->message, " ", debug, NULL);
  fail_unless (strstr (all, in_text) != NULL, "%s", all);
  fail_unless (gst_harness_try_pull (h) == NULL);
  g_free (all);
  g_free (debug);
  g_clear_error (&error);
  gst_message_unref (message);
  if (m) {
    gst_harness_teardown (m);
  }
  gst_element_set_bus (h->element, NULL);
  gst_harness_teardown (h);
  gst_object_unref (bus);
}

GST_START_TEST (test_no_rig)
{
  expect_error ("", 80, 60, mesh_buffer (COLUMNS * ROWS, -1), 0, "rig=");
}

GST_END_TEST;

GST_START_TEST (test_rig_not_there)
{
  expect_error ("rig=/nonexistent/rig.json", 80, 60,
      mesh_buffer (COLUMNS * ROWS, -1), 0, "/nonexistent/rig.json");
}

GST_END_TEST;

GST_START_TEST (test_which_camera)
{
  g_autofree gchar *rig = write_rig ("", second_camera);
  g_autofree gchar *none = g_strdup_printf ("rig=%s", rig);
  g_autofree gchar *wrong = g_strdup_printf ("rig=%s camera=middle", rig);

  expect_error (none, 80, 60, mesh_buffer (COLUMNS * ROWS, -1), 0,
      "left, right");
  expect_error (wrong, 80, 60, mesh_buffer (COLUMNS * ROWS, -1), 0,
      "left, right");
  g_unlink (rig);
}

GST_END_TEST;

GST_START_TEST (test_texture_not_there)
{
  g_autofree gchar *rig = write_rig ("", "");
  g_autofree gchar *absent = g_strdup_printf ("rig=%s mesh-style=shaded "
      "texture=/nonexistent/fabric.png", rig);
  g_autofree gchar *none = g_strdup_printf ("rig=%s mesh-style=shaded "
      "texture=%s", rig, rig);

  expect_error (absent, 80, 60, mesh_buffer (COLUMNS * ROWS, -1), 0,
      "/nonexistent/fabric.png");
  expect_error (none, 80, 60, mesh_buffer (COLUMNS * ROWS, -1), 0, "Can't put");
  g_unlink (rig);
}

GST_END_TEST;

GST_START_TEST (test_other_shape)
{
  g_autofree gchar *rig = write_rig ("", "");
  g_autofree gchar *properties = g_strdup_printf ("rig=%s", rig);

  expect_error (properties, 60, 80, mesh_buffer (COLUMNS * ROWS, -1), 0,
      "80×60");
  g_unlink (rig);
}

GST_END_TEST;

GST_START_TEST (test_bad_mesh)
{
  g_autofree gchar *rig = write_rig ("", "");
  g_autofree gchar *properties = g_strdup_printf ("rig=%s strict=true", rig);
  GstBuffer *garbage = gst_buffer_new_memdup ("garbage", 7);

  GST_BUFFER_PTS (garbage) = 0;
  expect_error (properties, 80, 60, garbage, 0, "The stream is damaged");
  expect_error (properties, 80, 60, mesh_buffer (COLUMNS * ROWS + 1, -1), 0,
      "stream of 12");
  g_unlink (rig);
}

GST_END_TEST;

/* The picture goes on without its mesh. */
GST_START_TEST (test_damaged_mesh)
{
  g_autofree gchar *rig = write_rig ("", "");
  g_autofree gchar *properties = g_strdup_printf ("rig=%s", rig);
  GstVideoInfo info;
  GstBuffer *buffer = picture ("GRAY8", 80, 60, 0, &info);
  GstBuffer *garbage = gst_buffer_new_memdup ("garbage", 7);
  g_autoptr (GstBuffer) before = gst_buffer_copy_deep (buffer);
  g_autoptr (GstBuffer) out = NULL;
  g_autoptr (GstBus) bus = gst_bus_new ();
  GstHarness *h = overlay (properties, NULL), *m = mesh_pad (h);
  GstMapInfo map;

  gst_element_set_bus (h->element, bus);
  gst_harness_set_src_caps (h, gst_video_info_to_caps (&info));
  GST_BUFFER_PTS (garbage) = 0;
  fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_OK);
  fail_unless_equals_int (gst_harness_push (m, garbage), GST_FLOW_OK);
  gst_harness_push_event (m, gst_event_new_eos ());
  gst_harness_push_event (h, gst_event_new_eos ());
  out = gst_harness_pull (h);
  fail_unless (out != NULL);
  fail_unless (gst_buffer_map (before, &map, GST_MAP_READ));
  fail_unless_equals_int (gst_buffer_memcmp (out, 0, map.data, map.size), 0);
  gst_buffer_unmap (before, &map);
  assert_dropped (h->element, bus, 1, "damaged packet");
  gst_harness_teardown (m);
  gst_element_set_bus (h->element, NULL);
  gst_harness_teardown (h);
  g_unlink (rig);
}

GST_END_TEST;

/* 65,536 marks that each cover a picture of 4K, or lie all around it in thousands of dashes.
 * The first ones are there, one warning says that others are not, and the next picture is
 * drawn in full. */
GST_START_TEST (test_crowd)
{
  const guint n = GST_CLOTH_MAX_FEATURES;
  g_autofree GstClothQuad *quads = g_new (GstClothQuad, n);
  g_autofree GstClothSaddle *saddles = g_new0 (GstClothSaddle, n);
  GstVideoInfo info;
  g_autoptr (GstBuffer) empty = picture ("GRAY8", 3840, 2160, 0, &info);
  g_autoptr (GstBus) bus = gst_bus_new ();
  g_autoptr (GstMessage) message = NULL;
  g_autoptr (GError) error = NULL;
  GstHarness *h = overlay ("draw-saddles=true ellipse-scale=1000 "
      "line-width=20", &info);
  guint n_changed[2];

  gst_element_set_bus (h->element, bus);
  for (guint i = 0; i < n; i++) {
    quads[i] = quad_at (-1e4, -1e4, 2e4, 1);
    quads[i].state = (GstClothQuadState) (__i__ % 2);
    saddles[i].x = saddles[i].y = 1000;
    saddles[i].cov_xx = saddles[i].cov_yy = 1;
  }
  for (guint round = 0; round < 2; round++) {
    GstBuffer *buffer = gst_buffer_copy (empty);
    g_autoptr (GstBuffer) out = NULL;
    GstMapInfo map;

    GST_BUFFER_PTS (buffer) = round * GST_BUFFER_DURATION (buffer);
    if (__i__ < 2)
      add_quads (buffer, quads, round ? 1 : n);
    else
      gst_buffer_add_cloth_saddles_meta (buffer, gst_cloth_saddles_new ("cam0",
              0, saddles, round ? 1 : n, NULL, 0));
    fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_OK);
    out = gst_harness_pull (h);
    fail_unless (gst_buffer_map (out, &map, GST_MAP_READ));
    n_changed[round] = 0;
    for (gsize i = 0; i < map.size; i++)
      n_changed[round] += map.data[i] != FILL;
    gst_buffer_unmap (out, &map);
  }
  /* all marks are at the same place, where the faintest samples of an edge add up; the
   * dashes are outside */
  fail_unless (n_changed[0] >= n_changed[1]);
  fail_unless (n_changed[0] <= n_changed[1] + n_changed[1] / 500);
  fail_unless_equals_int (n_changed[0] > 1000, __i__ != 1);
  message = gst_bus_pop_filtered (bus, GST_MESSAGE_WARNING);
  fail_unless (message != NULL);
  gst_message_parse_warning (message, &error, NULL);
  fail_unless (strstr (error->message, "too much for a picture") != NULL);
  fail_unless (gst_bus_pop_filtered (bus, GST_MESSAGE_WARNING
          | GST_MESSAGE_ERROR) == NULL);
  gst_element_set_bus (h->element, NULL);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* As many squares as a packet may hold, side by side with outlines and numbers: none is
 * left out. */
GST_START_TEST (test_many_squares)
{
  g_autofree GstClothQuad *quads = g_new (GstClothQuad, 65536);
  GstVideoInfo info;
  GstBuffer *buffer = picture ("GRAY8", 3840, 3840, 0, &info);
  g_autoptr (GstBuffer) out = NULL;
  g_autoptr (GstBus) bus = gst_bus_new ();
  GstHarness *h = overlay ("draw-indices=true", &info);

  gst_element_set_bus (h->element, bus);
  for (guint i = 0; i < 65536; i++)
    quads[i] = quad_at (15 * (i % 256), 15 * (i / 256), 15, 1);
  add_quads (buffer, quads, 65536);
  fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_OK);
  out = gst_harness_pull (h);
  fail_unless (out != NULL);
  fail_unless (gst_bus_pop_filtered (bus, GST_MESSAGE_WARNING) == NULL);
  gst_element_set_bus (h->element, NULL);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* Flushes before a picture is drawn, from another thread, as a seek does; drawing begins when
 * downstream has heard of it. */
typedef struct
{
  GstControlBinding parent;
  GstHarness *h;
  GThread *thread;
  GMutex lock;
  GCond cond;
  gboolean flushing;
} Interruption;
typedef GstControlBindingClass InterruptionClass;

GType interruption_get_type (void);
G_DEFINE_TYPE (Interruption, interruption, GST_TYPE_CONTROL_BINDING);

static gpointer
flush (gpointer data)
{
  gst_harness_push_event (data, gst_event_new_flush_start ());
  return NULL;
}

static GstPadProbeReturn
hear_of_flush (GstPad * pad, GstPadProbeInfo * info, gpointer data)
{
  Interruption *self = data;

  if (GST_EVENT_TYPE (GST_PAD_PROBE_INFO_EVENT (info)) == GST_EVENT_FLUSH_START) {
    g_mutex_lock (&self->lock);
    self->flushing = TRUE;
    g_cond_broadcast (&self->cond);
    g_mutex_unlock (&self->lock);
  }
  return GST_PAD_PROBE_OK;
}

static gboolean
interruption_sync (GstControlBinding * binding, GstObject * object,
    GstClockTime time, GstClockTime last)
{
  Interruption *self = (Interruption *) binding;

  g_mutex_lock (&self->lock);
  if (!self->thread) {
    self->thread = g_thread_new ("flush", flush, self->h);
    while (!self->flushing)
      g_cond_wait (&self->cond, &self->lock);
    g_cond_broadcast (&self->cond);
  }
  g_mutex_unlock (&self->lock);
  return TRUE;
}

static void
interruption_class_init (InterruptionClass * klass)
{
  klass->sync_values = interruption_sync;
}

static void
interruption_init (Interruption * self)
{
  g_mutex_init (&self->lock);
  g_cond_init (&self->cond);
}

/* A picture whose bytes stay ours, with one square; they say whether it was drawn. */
static gboolean
push_watched (GstHarness * h, GstVideoInfo * info, guint8 * data)
{
  const gsize size = GST_VIDEO_INFO_SIZE (info);
  const GstClothQuad quad = quad_at (5, 5, 50, 1);
  GstBuffer *buffer = gst_buffer_new_wrapped_full (0, data, size, 0, size, NULL,
      NULL);

  memset (data, FILL, size);
  GST_BUFFER_PTS (buffer) = 0;
  GST_BUFFER_DURATION (buffer) = GST_SECOND / 30;
  add_quads (buffer, &quad, 1);
  return gst_harness_push (h, buffer) == GST_FLOW_OK;
}

/* A flush while a picture is drawn: nothing more is drawn. After it all is as before. */
GST_START_TEST (test_interrupted)
{
  GstVideoInfo info;
  GstBuffer *any = picture ("GRAY8", 80, 60, 0, &info);
  g_autofree guint8 *data = g_malloc (GST_VIDEO_INFO_SIZE (&info));
  GstHarness *h = overlay ("", &info);
  Interruption *interruption = g_object_new (interruption_get_type (),
      "object", h->element, "name", "opacity", NULL);
  g_autoptr (GstBuffer) out = NULL;
  GstSegment segment;

  gst_buffer_unref (any);
  interruption->h = h;
  gst_pad_add_probe (h->sinkpad, GST_PAD_PROBE_TYPE_EVENT_FLUSH, hear_of_flush,
      interruption, NULL);
  gst_object_add_control_binding (GST_OBJECT (h->element),
      GST_CONTROL_BINDING (interruption));
  fail_unless (push_watched (h, &info, data));
  g_mutex_lock (&interruption->lock);
  while (!interruption->flushing)
    g_cond_wait (&interruption->cond, &interruption->lock);
  g_mutex_unlock (&interruption->lock);
  /* it waits for the picture */
  g_thread_join (interruption->thread);
  for (gsize i = 0; i < GST_VIDEO_INFO_SIZE (&info); i++)
    fail_unless_equals_int (data[i], FILL);

  gst_harness_push_event (h, gst_event_new_flush_stop (TRUE));
  gst_segment_init (&segment, GST_FORMAT_TIME);
  gst_harness_push_event (h, gst_event_new_segment (&segment));
  fail_unless (push_watched (h, &info, data));
  out = gst_harness_pull (h);
  fail_unless (out != NULL);
  fail_unless (data[30 * 80 + 30] != FILL);
  gst_harness_teardown (h);
}

GST_END_TEST;

GST_START_TEST (test_short_picture)
{
  expect_error ("", 80, 60, NULL, 100, "fit");
}

GST_END_TEST;

GST_START_TEST (test_second_mesh_pad)
{
  GstHarness *h = overlay ("", NULL);
  GstPad *pad = gst_element_request_pad_simple (h->element, "mesh");

  fail_unless (pad != NULL);
  ASSERT_CRITICAL (fail_unless (gst_element_request_pad_simple (h->element,
              "mesh") == NULL));
  gst_element_release_request_pad (h->element, pad);
  gst_object_unref (pad);
  pad = gst_element_request_pad_simple (h->element, "mesh");
  fail_unless (pad != NULL);
  gst_object_unref (pad);
  gst_harness_teardown (h);
}

GST_END_TEST;

static Suite *
clothoverlayinput_suite (void)
{
  Suite *s = suite_create ("clothoverlayinput");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, test_caps_change);
  tcase_add_test (tc, test_caps_query);
  tcase_add_test (tc, test_tags);
  tcase_add_test (tc, test_seek);
  tcase_add_test (tc, test_one_pixel);
  tcase_add_test (tc, test_bad_coordinates);
  tcase_add_test (tc, test_wild_squares);
  tcase_add_test (tc, test_degenerate_squares);
  tcase_add_test (tc, test_unknown_format);
  tcase_add_test (tc, test_no_rig);
  tcase_add_test (tc, test_rig_not_there);
  tcase_add_test (tc, test_which_camera);
  tcase_add_test (tc, test_texture_not_there);
  tcase_add_test (tc, test_other_shape);
  tcase_add_test (tc, test_bad_mesh);
  tcase_add_test (tc, test_damaged_mesh);
  tcase_add_loop_test (tc, test_crowd, 0, 3);
  tcase_add_test (tc, test_many_squares);
  tcase_add_test (tc, test_interrupted);
  tcase_add_test (tc, test_short_picture);
  tcase_add_test (tc, test_second_mesh_pad);
  return s;
}

GST_CHECK_MAIN (clothoverlayinput);
