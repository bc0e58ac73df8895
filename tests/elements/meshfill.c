/* meshfill: whole meshes, order of frames and events, latency, flushes, bad input.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/cloth/cloth.h>
#include <math.h>

#include "gst/mesh/garment/garment.h"
#include "tests/core/meshpeer.h"
#include "tests/elements/damage.h"

#define COLUMNS 9
#define ROWS 8
#define N (COLUMNS * ROWS)
#define PERIOD (40 * GST_MSECOND)
#define HOLE (3 * COLUMNS + 4)

static GstCaps *
make_caps (guint columns, guint rows, gint fps_n)
{
  g_autoptr (GstClothTopology) topology =
      gst_cloth_topology_new_grid (columns, rows, 0.16f, 0.14f, NULL);

  return gst_cloth_topology_to_caps (topology, fps_n, 1);
}

static GstHarness *
harness (const gchar * line, gint fps_n)
{
  GstHarness *h = gst_harness_new_parse (line);

  gst_harness_set_src_caps (h, make_caps (COLUMNS, ROWS, fps_n));
  return h;
}

/* A bent sheet that rises; @seen 0: nothing, 1: with a hole, 2: all. */
static GstBuffer *
make_frame (guint k, guint seen)
{
  gfloat positions[3 * N];
  guint8 states[N];
  GstBuffer *buffer;

  for (guint v = 0; v < N; v++) {
    gdouble x = 0.02 * (v % COLUMNS);

    positions[3 * v] = (gfloat) x;
    positions[3 * v + 1] = (gfloat) (0.02 * (v / COLUMNS));
    positions[3 * v + 2] = (gfloat) (0.01 * sin (20 * x) + 0.002 * k);
    states[v] = seen == 0 || (seen == 1 && v == HOLE)
        ? GST_CLOTH_VERTEX_UNSEEN : GST_CLOTH_VERTEX_MEASURED;
  }
  {
    g_autoptr (GstClothMesh) mesh = gst_cloth_mesh_new (100 + k, N, positions,
        states, NULL);

    buffer = gst_cloth_mesh_to_buffer (mesh);
  }
  GST_BUFFER_PTS (buffer) = k * PERIOD;
  GST_BUFFER_DURATION (buffer) = PERIOD;
  return buffer;
}

static GstClothMesh *
pull (GstHarness * h, guint k)
{
  g_autoptr (GstBuffer) buffer = gst_harness_pull (h);
  g_autoptr (GError) error = NULL;
  GstClothMesh *mesh = gst_cloth_mesh_from_buffer (buffer, &error);

  g_assert_no_error (error);
  fail_unless_equals_uint64 (GST_BUFFER_PTS (buffer), k * PERIOD);
  fail_unless_equals_uint64 (GST_BUFFER_DURATION (buffer), PERIOD);
  fail_unless_equals_uint64 (gst_cloth_mesh_get_sequence (mesh), 100 + k);
  fail_unless (gst_cloth_mesh_get_covariances (mesh, NULL) != NULL);
  return mesh;
}

static void
count_down (gpointer data, GstMiniObject * gone)
{
  --*(gint *) data;
}

GST_START_TEST (test_filled)
{
  GstHarness *h = harness ("meshfill", 25);

  for (guint k = 0; k < 8; k++) {
    g_autoptr (GstClothMesh) mesh = NULL;
    const gfloat *positions, *covariances;
    const guint8 *states;

    fail_unless_equals_int (gst_harness_push (h, make_frame (k, k < 4 ? 2 : 1)),
        GST_FLOW_OK);
    mesh = pull (h, k);
    positions = gst_cloth_mesh_get_positions (mesh, NULL);
    covariances = gst_cloth_mesh_get_covariances (mesh, NULL);
    states = gst_cloth_mesh_get_states (mesh, NULL);
    for (guint v = 0; v < N; v++)
      fail_unless_equals_int (states[v], k >= 4 && v == HOLE
          ? GST_CLOTH_VERTEX_FILLED : GST_CLOTH_VERTEX_MEASURED);
    /* the sheet is known from before and moves as one */
    fail_unless (fabs (positions[3 * HOLE + 2] - (0.01 * sin (20 * 0.08)
                + 0.002 * k)) < 1e-4);
    fail_unless (fabs (covariances[0] - 0.0005 * 0.0005) < 1e-12);
    fail_unless (k < 4
        || covariances[6 * HOLE] > covariances[0], "frame %u: %g, %g", k,
        covariances[6 * HOLE], covariances[0]);
  }
  gst_harness_teardown (h);
}

GST_END_TEST;

/* No camera sees anything for two seconds. */
GST_START_TEST (test_nothing_seen)
{
  GstHarness *h = harness ("meshfill", 25);
  guint counts[5] = { 0, };

  for (guint k = 0; k < 80; k++) {
    g_autoptr (GstClothMesh) mesh = NULL;
    const guint8 *states;
    const gfloat *positions;

    gst_harness_push (h, make_frame (k, k >= 20 && k < 70 ? 0 : 2));
    mesh = pull (h, k);
    states = gst_cloth_mesh_get_states (mesh, NULL);
    positions = gst_cloth_mesh_get_positions (mesh, NULL);
    for (guint v = 1; v < N; v++)
      fail_unless_equals_int (states[v], states[0]);
    counts[states[0]]++;
    if (states[0] == GST_CLOTH_VERTEX_PREDICTED)
      fail_unless (fabs (positions[2] - 0.002 * k) < 1e-4);
  }
  /* 0.2 s at 25 frames a second are five */
  fail_unless_equals_int (counts[GST_CLOTH_VERTEX_MEASURED], 30);
  fail_unless_equals_int (counts[GST_CLOTH_VERTEX_PREDICTED], 5);
  fail_unless_equals_int (counts[GST_CLOTH_VERTEX_UNSEEN], 45);
  gst_harness_teardown (h);
}

GST_END_TEST;

GST_START_TEST (test_order)
{
  GstHarness *h = harness ("meshfill smooth-time=0.5", 25);
  g_autoptr (GstEvent) event = NULL;

  gst_harness_push (h, make_frame (0, 2));
  fail_unless_equals_int (gst_harness_buffers_received (h), 0);
  gst_harness_push (h, make_frame (1, 1));
  fail_unless_equals_int (gst_harness_buffers_received (h), 1);
  /* an event that follows frame 1 does so downstream */
  gst_harness_push_event (h, gst_event_new_custom
      (GST_EVENT_CUSTOM_DOWNSTREAM, gst_structure_new_empty ("mark")));
  fail_unless_equals_int (gst_harness_buffers_received (h), 2);
  while ((event = gst_harness_try_pull_event (h))
      && GST_EVENT_TYPE (event) != GST_EVENT_CUSTOM_DOWNSTREAM)
    gst_clear_event (&event);
  fail_unless (event != NULL);
  gst_harness_push (h, make_frame (2, 2));
  fail_unless_equals_int (gst_harness_buffers_received (h), 2);
  gst_harness_push_event (h, gst_event_new_eos ());
  fail_unless_equals_int (gst_harness_buffers_received (h), 3);
  for (guint k = 0; k < 3; k++)
    gst_cloth_mesh_unref (pull (h, k));
  gst_harness_teardown (h);
}

GST_END_TEST;

/* Smoothing in time: the frames before and after count as filled, not as smoothed. */
GST_START_TEST (test_smoothed)
{
  GstHarness *h = harness ("meshfill smooth-time=0.5 outlier-threshold=0", 25);
  static const gfloat heights[] = { 0, 0.002f, 0, 0, 0 };
  static const gfloat wanted[] = { 0, 0.001f, 0.0005f, 0, 0 };

  for (guint k = 0; k < G_N_ELEMENTS (heights); k++) {
    g_autoptr (GstBuffer) buffer = make_frame (0, 2);
    g_autoptr (GstClothMesh) mesh = gst_cloth_mesh_from_buffer (buffer, NULL);
    g_autoptr (GstClothMesh) raised = NULL;
    GstBuffer *frame;
    gfloat positions[3 * N];

    memcpy (positions, gst_cloth_mesh_get_positions (mesh, NULL),
        sizeof positions);
    positions[2] = heights[k];
    raised = gst_cloth_mesh_new (100 + k, N, positions,
        gst_cloth_mesh_get_states (mesh, NULL), NULL);
    frame = gst_cloth_mesh_to_buffer (raised);
    GST_BUFFER_PTS (frame) = k * PERIOD;
    GST_BUFFER_DURATION (frame) = PERIOD;
    gst_harness_push (h, frame);
  }
  gst_harness_push_event (h, gst_event_new_eos ());
  for (guint k = 0; k < G_N_ELEMENTS (wanted); k++) {
    g_autoptr (GstClothMesh) mesh = pull (h, k);

    fail_unless (fabs (gst_cloth_mesh_get_positions (mesh, NULL)[2] -
            wanted[k]) < 1e-7, "frame %u", k);
  }
  gst_harness_teardown (h);
}

GST_END_TEST;

/* Frames that were smoothed are let go with whatever makes those that wait leave: compiled at all that GCC does, inlined
 * functions of GStreamer may not be. */
GST_START_TEST (test_lets_go)
{
  GstHarness *h = harness ("meshfill smooth-time=0.5", 25);
  gint left = 0;

  for (guint k = 0; k < 6; k++) {
    GstBuffer *frame = make_frame (k, 2);

    left++;
    gst_mini_object_weak_ref (GST_MINI_OBJECT_CAST (frame), count_down, &left);
    gst_harness_push (h, frame);
    if (k % 3 == 2)
      gst_harness_push_event (h, gst_event_new_tag (gst_tag_list_new_empty ()));
  }
  gst_harness_push_event (h, gst_event_new_eos ());
  fail_unless_equals_int (left, 0);
  gst_harness_teardown (h);
}

GST_END_TEST;

GST_START_TEST (test_latency)
{
  for (guint late = 0; late < 2; late++) {
    GstHarness *h = harness (late ? "meshfill smooth-time=0.1" : "meshfill",
        25);

    gst_harness_set_live (h, TRUE);
    gst_harness_set_upstream_latency (h, 7 * GST_MSECOND);
    fail_unless_equals_uint64 (gst_harness_query_latency (h),
        7 * GST_MSECOND + (late ? PERIOD : 0));
    gst_harness_teardown (h);
  }
}

GST_END_TEST;

GST_START_TEST (test_flush)
{
  GstHarness *h = harness ("meshfill smooth-time=0.5", 25);
  GstSegment segment;

  for (guint k = 10; k < 14; k++)
    gst_harness_push (h, make_frame (k, 2));
  fail_unless_equals_int (gst_harness_buffers_received (h), 3);
  gst_harness_push_event (h, gst_event_new_flush_start ());
  gst_harness_push_event (h, gst_event_new_flush_stop (TRUE));
  gst_segment_init (&segment, GST_FORMAT_TIME);
  gst_harness_push_event (h, gst_event_new_segment (&segment));
  for (guint k = 10; k < 13; k++)
    gst_cloth_mesh_unref (pull (h, k));
  /* nothing is known of the time before */
  gst_harness_push (h, make_frame (0, 0));
  gst_harness_push (h, make_frame (1, 2));
  {
    g_autoptr (GstClothMesh) mesh = pull (h, 0);

    fail_unless_equals_int (gst_cloth_mesh_get_states (mesh, NULL)[0],
        GST_CLOTH_VERTEX_UNSEEN);
  }
  gst_harness_teardown (h);
}

GST_END_TEST;

/* Another mesh in mid-stream, a stream without rate and times. */
GST_START_TEST (test_caps)
{
  GstHarness *h = harness ("meshfill smooth-time=0.5", 0);
  g_autoptr (GstCaps) caps = NULL;
  gint n;

  for (guint k = 0; k < 4; k++) {
    GstBuffer *buffer = gst_buffer_make_writable (make_frame (k, 1));

    GST_BUFFER_PTS (buffer) = GST_CLOCK_TIME_NONE;
    fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_OK);
  }
  gst_harness_set_src_caps (h, make_caps (N / 2, 2, 50));
  fail_unless_equals_int (gst_harness_buffers_received (h), 4);
  fail_unless_equals_int (gst_harness_push (h, make_frame (4, 1)), GST_FLOW_OK);
  gst_harness_set_src_caps (h, make_caps (4, 3, 50));
  caps = gst_pad_get_current_caps (h->sinkpad);
  fail_unless (gst_structure_get_int (gst_caps_get_structure (caps, 0),
          "vertices", &n));
  fail_unless_equals_int (n, 12);
  gst_harness_teardown (h);
}

GST_END_TEST;

static GstBuffer *
make_garbage (void)
{
  GstBuffer *garbage = gst_buffer_new_allocate (NULL, 100, NULL);

  gst_buffer_memset (garbage, 0, 0x5a, 100);
  return garbage;
}

/* What has no time of its own keeps it when a frame before it is dropped. */
GST_START_TEST (test_damaged)
{
  GstHarness *h = harness ("meshfill", 25);
  g_autoptr (GstElement) fill = gst_harness_find_element (h, "meshfill");
  g_autoptr (GstBus) bus = gst_bus_new ();

  gst_element_set_bus (fill, bus);
  for (guint k = 0; k < 8; k++) {
    g_autoptr (GstClothMesh) mesh = NULL;

    fail_unless_equals_int (gst_harness_push (h, k % 2 ? make_garbage () :
            make_frame (k, 1)), GST_FLOW_OK);
    fail_unless_equals_int (gst_harness_buffers_in_queue (h), (k + 1) % 2);
    mesh = k % 2 ? NULL : pull (h, k);
  }
  assert_dropped (fill, bus, 4, "damaged packet");
  gst_harness_push_event (h, gst_event_new_eos ());
  assert_summed_up (bus, 4);
  gst_element_set_bus (fill, NULL);
  gst_harness_teardown (h);
}

GST_END_TEST;

GST_START_TEST (test_bad_frames)
{
  GstHarness *h = harness ("meshfill strict=true", 25);
  g_autoptr (GstElement) fill = gst_harness_find_element (h, "meshfill");
  g_autoptr (GstBus) bus = gst_bus_new ();
  g_autoptr (GstCaps) other = make_caps (4, 3, 25);

  gst_element_set_bus (fill, bus);
  fail_unless_equals_int (gst_harness_push (h, make_garbage ()),
      GST_FLOW_ERROR);
  assert_refused_damage (fill, bus, "mesh");
  /* more vertices than the caps promise */
  gst_harness_set_src_caps (h, gst_caps_ref (other));
  fail_unless_equals_int (gst_harness_push (h, make_frame (0, 1)),
      GST_FLOW_ERROR);
  assert_refused_damage (fill, bus, "in a stream of 12");
  gst_element_set_bus (fill, NULL);
  gst_harness_teardown (h);
  /* caps without topology */
  h = gst_harness_new_parse ("meshfill");
  gst_harness_set_src_caps (h, gst_caps_from_string
      ("application/x-cloth-mesh, version=1, vertices=12, framerate=25/1"));
  fail_if (gst_harness_push (h, make_frame (0, 1)) == GST_FLOW_OK);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* A whole take through files, and from its middle on. */
GST_START_TEST (test_take)
{
  for (guint turn = 0; turn < 2; turn++) {
    g_autoptr (GstElement) pipeline = gst_parse_launch ("meshsrc location="
        TEST_DATA "/take_drop ! meshfill ! appsink name=sink sync=false", NULL);
    g_autoptr (GstElement) sink = gst_bin_get_by_name (GST_BIN (pipeline),
        "sink");
    guint frames = 0, filled = 0, unseen = 0;

    gst_element_set_state (pipeline, GST_STATE_PAUSED);
    gst_element_get_state (pipeline, NULL, NULL, GST_CLOCK_TIME_NONE);
    if (turn == 1)
      fail_unless (gst_element_seek_simple (pipeline, GST_FORMAT_TIME,
              GST_SEEK_FLAG_FLUSH | GST_SEEK_FLAG_ACCURATE,
              20 * 20 * GST_MSECOND));
    gst_element_set_state (pipeline, GST_STATE_PLAYING);
    for (;;) {
      GstSample *sample = NULL;
      g_autoptr (GstClothMesh) mesh = NULL;
      const guint8 *states;

      g_signal_emit_by_name (sink, "pull-sample", &sample);
      if (!sample)
        break;
      mesh = gst_cloth_mesh_from_buffer (gst_sample_get_buffer (sample), NULL);
      states = gst_cloth_mesh_get_states (mesh, NULL);
      for (guint v = 0; v < gst_cloth_mesh_get_n_vertices (mesh); v++) {
        filled += states[v] == GST_CLOTH_VERTEX_FILLED;
        unseen += states[v] == GST_CLOTH_VERTEX_UNSEEN;
      }
      frames++;
      gst_sample_unref (sample);
    }
    fail_unless_equals_int (frames, turn ? 12 : 32);
    fail_unless (filled > 0);
    fail_unless_equals_int (unseen, 0);
    gst_element_set_state (pipeline, GST_STATE_NULL);
  }
}

GST_END_TEST;

/* Panels cut from the print of 9 × 8 dots: the grid comes in, the garment goes out. */
GST_START_TEST (test_garment)
{
  static const gchar drawing[] = "<svg width=\"180mm\" height=\"160mm\" "
      "viewBox=\"0 0 180 160\"><g id=\"a\" class=\"panel\">"
      "<path data-seam=\"s\" d=\"M80,10 V150\"/><path d=\"M80,150 H20 V10 H80\"/>"
      "</g><g id=\"b\" class=\"panel\"><path data-seam=\"s\" d=\"M100,10 V150\"/>"
      "<path d=\"M100,150 H160 V10 H100\"/></g></svg>";
  const ClothDotGrid grid = { COLUMNS, ROWS, 0.02, {0.01, 0.01}, {0.18, 0.16} };
  g_autoptr (ClothGarment) garment = cloth_garment_new_from_svg (drawing,
      sizeof drawing - 1, &grid, NULL);
  g_autofree gchar *path = NULL, *line = NULL;
  guint n;

  fail_unless (garment != NULL);
  n = garment->topology->n_vertices;
  scratch_begin ();
  fail_unless (cloth_garment_save (garment, scratch, NULL));
  path = scratch_path ("garment.json");
  line = g_strdup_printf ("meshfill garment=%s max-sigma=1", path);
  {
    GstHarness *h = harness (line, 25);

    for (guint k = 0; k < 3; k++) {
      g_autoptr (GstClothMesh) mesh = NULL;
      g_autoptr (GstCaps) caps = NULL;
      g_autoptr (GstClothTopology) topology = NULL;
      const gfloat *positions;
      const guint8 *states;

      fail_unless_equals_int (gst_harness_push (h, make_frame (k, 1)),
          GST_FLOW_OK);
      mesh = pull (h, k);
      caps = gst_pad_get_current_caps (h->sinkpad);
      topology = gst_cloth_topology_from_caps (caps, NULL);
      fail_unless_equals_int (gst_cloth_topology_get_n_vertices (topology), n);
      fail_unless_equals_int (gst_cloth_mesh_get_n_vertices (mesh), n);
      positions = gst_cloth_mesh_get_positions (mesh, NULL);
      states = gst_cloth_mesh_get_states (mesh, NULL);
      for (guint v = 0; v < n; v++) {
        gint dot = garment->dots[v];

        fail_unless_equals_int (states[v], dot == CLOTH_NO_DOT || dot == HOLE
            ? GST_CLOTH_VERTEX_FILLED : GST_CLOTH_VERTEX_MEASURED);
        if (dot != CLOTH_NO_DOT && dot != HOLE)
          fail_unless (fabs (positions[3 * v] - 0.02 * (dot % COLUMNS)) < 1e-6);
      }
    }
    gst_harness_teardown (h);
  }
  /* a print of another size */
  {
    GstHarness *h = gst_harness_new_parse (line);

    gst_harness_set_src_caps (h, make_caps (4, 3, 25));
    fail_if (gst_harness_push (h, make_frame (0, 1)) == GST_FLOW_OK);
    gst_harness_teardown (h);
  }
  scratch_end ();
  /* no garment there */
  {
    g_autoptr (GstElement) element =
        gst_element_factory_make ("meshfill", NULL);

    gst_object_ref_sink (element);
    g_object_set (element, "garment", "/no/such/garment.json", NULL);
    fail_unless_equals_int (gst_element_set_state (element, GST_STATE_PAUSED),
        GST_STATE_CHANGE_FAILURE);
    gst_element_set_state (element, GST_STATE_NULL);
  }
}

GST_END_TEST;

static Suite *
meshfill_suite (void)
{
  Suite *suite = suite_create ("meshfill");
  TCase *test = tcase_create ("general");

  suite_add_tcase (suite, test);
  tcase_add_test (test, test_filled);
  tcase_add_test (test, test_nothing_seen);
  tcase_add_test (test, test_order);
  tcase_add_test (test, test_smoothed);
  tcase_add_test (test, test_lets_go);
  tcase_add_test (test, test_latency);
  tcase_add_test (test, test_flush);
  tcase_add_test (test, test_caps);
  tcase_add_test (test, test_damaged);
  tcase_add_test (test, test_bad_frames);
  tcase_add_test (test, test_take);
  tcase_add_test (test, test_garment);
  return suite;
}

GST_CHECK_MAIN (meshfill);
