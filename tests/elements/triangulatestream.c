/* triangulate: changes, live cameras, rates and times.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/elements/clockwait.h"
#include "tests/elements/triangulatebench.h"

/* In mid-stream: another frame rate, a moved camera with a new rig.json, a rig.json that
 * can't be read. */
GST_START_TEST (test_changes)
{
  Bench b;
  g_autoptr (GError) error = NULL;
  guint i;

  bench_init (&b, 3);
  push_all (&b, 0);
  expect_all (&b, 0, GST_CLOTH_VERTEX_MEASURED);

  for (i = 0; i < 3; i++) {
    gst_harness_set_src_caps_str (b.in[i],
        "video/x-raw,format=I420,width=1280,height=720,framerate=50/1");
  }
  push_all (&b, 1);
  expect_all (&b, 1, GST_CLOTH_VERTEX_MEASURED);
  {
    g_autoptr (GstCaps) caps = gst_pad_get_current_caps (b.src->sinkpad);
    gint n, d;

    fail_unless (gst_structure_get_fraction (gst_caps_get_structure (caps, 0),
            "framerate", &n, &d));
    fail_unless_equals_int (n, 50);
  }

  b.rig->cameras[1].t[0] += 0.1;
  b.rig->cameras[2].K[2] -= 20.;
  cloth_rig_save (b.rig, b.rig_path, &error);
  g_assert_no_error (error);
  g_object_set (b.element, "rig", b.rig_path, NULL);
  push_all (&b, 2);
  expect_all (&b, 2, GST_CLOTH_VERTEX_MEASURED);

  g_object_set (b.element, "rig", "/nonexistent/rig.json", NULL);
  push_all (&b, 3);
  expect_error (&b, "/nonexistent/rig.json");
  bench_clear (&b);
}

GST_END_TEST;

/* A board of other size in mid-stream: new caps, then meshes of the new size. */
GST_START_TEST (test_other_pattern)
{
  Bench b;
  g_autoptr (ClothPattern) pattern = NULL;
  g_autoptr (GError) error = NULL;
  GstClothQuad quads[N_QUADS];
  guint i;

  bench_init (&b, 2);
  push_all (&b, 0);
  expect_all (&b, 0, GST_CLOTH_VERTEX_TWO_VIEWS);
  pattern = cloth_pattern_new_checker (COLUMNS, ROWS - 1, SQUARE, 0.05, TRUE,
      &error);
  g_assert_no_error (error);
  cloth_pattern_save (pattern, b.pattern_path, &error);
  g_assert_no_error (error);
  g_object_set (b.element, "pattern", b.pattern_path, NULL);
  for (i = 0; i < 2; i++) {
    see (&b, i, 1, quads);
    push (&b, i, gst_cloth_quads_new (NULL, 1, COLUMNS, ROWS - 1, quads,
            COLUMNS * (ROWS - 1)), 1);
  }
  {
    g_autoptr (GstBuffer) buffer = gst_harness_pull (b.src);
    g_autoptr (GstClothMesh) mesh = gst_cloth_mesh_from_buffer (buffer, &error);
    g_autoptr (GstCaps) caps = gst_pad_get_current_caps (b.src->sinkpad);
    gint n;

    g_assert_no_error (error);
    fail_unless_equals_int (gst_cloth_mesh_get_n_vertices (mesh),
        (COLUMNS + 1) * ROWS);
    fail_unless (gst_structure_get_int (gst_caps_get_structure (caps, 0),
            "vertices", &n));
    fail_unless_equals_int (n, (COLUMNS + 1) * ROWS);
  }
  bench_clear (&b);
}

GST_END_TEST;

/* A camera that falls silent is named, and so is its return; sets without it count as
 * incomplete though min-views lets them go. */
GST_START_TEST (test_live_camera_silent)
{
  static const gchar *const names[] = { "triangulate/silent", "triangulate/back"
  };
  static const gdouble spans[] = { 25 * 0.04, 27 * 0.04 };
  g_autoptr (GstStructure) stats = NULL;
  const GstStructure *pad;
  GstTestClock *clock;
  guint64 incomplete, missing;
  guint frame, i;
  Bench b;

  bench_open (&b, 3);
  bench_link (&b, 3, TRUE, VIDEO);
  clock = gst_harness_get_testclock (b.src);
  push_all (&b, 0);
  expect_all (&b, 0, GST_CLOTH_VERTEX_MEASURED);
  for (frame = 1; frame < 27; frame++) {
    push_seen (&b, 0, 0, frame, ALL, NULL);
    push_seen (&b, 2, 2, frame, ALL, NULL);
    wait_for_deadline (clock, frame * PERIOD + PERIOD / 2 + 200 * GST_MSECOND);
    fail_unless (gst_test_clock_crank (clock));
    expect_all (&b, frame, GST_CLOTH_VERTEX_TWO_VIEWS);
  }
  push_all (&b, 27);
  expect_all (&b, 27, GST_CLOTH_VERTEX_MEASURED);
  for (i = 0; i < 2; i++) {
    g_autoptr (GstMessage) message =
        gst_bus_timed_pop_filtered (b.bus, 10 * GST_SECOND,
        GST_MESSAGE_ELEMENT);
    const GstStructure *s;
    gdouble seconds;

    fail_unless (message != NULL);
    s = gst_message_get_structure (message);
    fail_unless_equals_string (gst_structure_get_name (s), names[i]);
    fail_unless_equals_string (gst_structure_get_string (s, "camera"), "cam1");
    fail_unless (gst_structure_get_double (s, "seconds", &seconds));
    fail_unless_equals_float (seconds, spans[i]);
  }
  fail_unless (gst_bus_pop_filtered (b.bus,
          GST_MESSAGE_ELEMENT | GST_MESSAGE_WARNING) == NULL);
  g_object_get (b.element, "stats", &stats, NULL);
  fail_unless (gst_structure_get_uint64 (stats, "incomplete", &incomplete));
  fail_unless_equals_uint64 (incomplete, 26);
  pad = gst_value_get_structure (gst_structure_get_value (stats, "sink_1"));
  fail_unless_equals_string (gst_structure_get_string (pad, "camera"), "cam1");
  fail_unless (gst_structure_get_uint64 (pad, "missing", &missing));
  fail_unless_equals_uint64 (missing, 26);
  gst_object_unref (clock);
  bench_clear (&b);
}

GST_END_TEST;

/* Live, one camera silent: at the deadline the mesh is made of what is there. */
GST_START_TEST (test_live)
{
  Bench b;
  GstTestClock *clock;

  bench_open (&b, 3);
  bench_link (&b, 3, TRUE, VIDEO);
  clock = gst_harness_get_testclock (b.src);
  push_all (&b, 0);
  expect_all (&b, 0, GST_CLOTH_VERTEX_MEASURED);
  push_seen (&b, 0, 0, 1, ALL, NULL);
  push_seen (&b, 2, 2, 1, ALL, NULL);
  wait_for_deadline (clock, PERIOD + PERIOD / 2 + 200 * GST_MSECOND);
  fail_unless (gst_harness_try_pull (b.src) == NULL);
  fail_unless (gst_test_clock_crank (clock));
  expect_all (&b, 1, GST_CLOTH_VERTEX_TWO_VIEWS);
  push_all (&b, 2);
  expect_all (&b, 2, GST_CLOTH_VERTEX_MEASURED);
  gst_object_unref (clock);
  bench_clear (&b);
}

GST_END_TEST;

static void
expect_rate (Bench * b, gint n, gint d)
{
  g_autoptr (GstCaps) caps = gst_pad_get_current_caps (b->src->sinkpad);
  gint have_n, have_d;

  fail_unless (gst_structure_get_fraction (gst_caps_get_structure (caps, 0),
          "framerate", &have_n, &have_d));
  fail_unless (have_n == n && have_d == d, "%d/%d instead of %d/%d", have_n,
      have_d, n, d);
}

/* Cameras of different rates: variable when that is known from the start; one that joins
 * a running stream late changes nothing, for a recording can't change its rate. */
GST_START_TEST (test_rates_differ)
{
  static const gchar other[] =
      "video/x-raw,format=GRAY8,width=1280,height=720,framerate=20/1";
  Bench b;

  bench_open (&b, 2);
  bench_link (&b, 2, FALSE, VIDEO);
  gst_harness_set_src_caps_str (b.in[1], other);
  push_all (&b, 0);
  expect_all (&b, 0, GST_CLOTH_VERTEX_TWO_VIEWS);
  expect_rate (&b, 0, 1);
  /* once they agree there is a rate */
  gst_harness_set_src_caps_str (b.in[1], VIDEO);
  push_all (&b, 1);
  expect_all (&b, 1, GST_CLOTH_VERTEX_TWO_VIEWS);
  expect_rate (&b, 25, 1);
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_late_camera_of_other_rate)
{
  static const gchar other[] =
      "video/x-raw,format=GRAY8,width=1280,height=720,framerate=20/1";
  g_autoptr (GstTestClock) clock = NULL;
  GstEvent *event;
  guint n_caps = 0;
  Bench b;

  bench_open (&b, 2);
  b.n_pads = 2;
  b.src = gst_harness_new_with_element (b.element, NULL, "src");
  b.in[0] = gst_harness_new_with_element (b.element, "sink_0", NULL);
  b.in[1] = gst_harness_new_with_element (b.element, "sink_1", NULL);
  gst_harness_set_live (b.in[0], TRUE);
  gst_harness_set_live (b.in[1], TRUE);
  gst_harness_use_testclock (b.src);
  gst_harness_set_live (b.src, TRUE);
  clock = gst_harness_get_testclock (b.src);
  gst_harness_set_src_caps_str (b.in[0], VIDEO);
  push_seen (&b, 0, 0, 0, ALL, NULL);
  {
    GstClockID id;

    gst_test_clock_wait_for_next_pending_id (clock, &id);
    gst_clock_id_unref (id);
  }
  fail_unless (gst_test_clock_crank (clock));
  expect_all (&b, 0, GST_CLOTH_VERTEX_UNSEEN);
  expect_rate (&b, 25, 1);

  gst_harness_set_src_caps_str (b.in[1], other);
  push_all (&b, 1);
  expect_all (&b, 1, GST_CLOTH_VERTEX_TWO_VIEWS);
  expect_rate (&b, 25, 1);
  push_all (&b, 2);
  expect_all (&b, 2, GST_CLOTH_VERTEX_TWO_VIEWS);
  while ((event = gst_harness_try_pull_event (b.src))) {
    n_caps += GST_EVENT_TYPE (event) == GST_EVENT_CAPS;
    gst_event_unref (event);
  }
  fail_unless_equals_int ((gint) n_caps, 1);
  bench_clear (&b);
}

GST_END_TEST;

/* The first camera's capture time and number go on with the mesh, also when only its
 * observations came. */
static void
check_capture_time (gboolean observations)
{
  Bench b;
  g_autoptr (GstCaps) reference =
      gst_caps_new_empty_simple ("timestamp/x-unix");
  g_autoptr (GstBuffer) out = NULL;
  g_autoptr (GstClothMesh) mesh = NULL;
  g_autoptr (GError) error = NULL;
  GstReferenceTimestampMeta *stamp;
  GstClothQuad quads[N_QUADS];
  guint i;

  bench_open (&b, 2);
  bench_link (&b, 2, FALSE, observations ? OBSERVATIONS : VIDEO);
  for (i = 0; i < 2; i++) {
    GstBuffer *buffer;

    see (&b, i, 0, quads);
    buffer = picture (gst_cloth_quads_new (NULL, 1234 + i, COLUMNS, ROWS, quads,
            N_QUADS), 0);
    gst_buffer_add_reference_timestamp_meta (buffer, reference,
        100 * GST_SECOND + i, GST_CLOCK_TIME_NONE);
    if (observations) {
      GstBuffer *packed = gst_cloth_observations_pack (buffer);

      gst_buffer_unref (buffer);
      buffer = packed;
    }
    fail_unless_equals_int (gst_harness_push (b.in[i], buffer), GST_FLOW_OK);
  }
  out = gst_harness_pull (b.src);
  stamp = gst_buffer_get_reference_timestamp_meta (out, NULL);
  fail_unless (stamp != NULL);
  fail_unless_equals_uint64 (stamp->timestamp, 100 * GST_SECOND);
  mesh = gst_cloth_mesh_from_buffer (out, &error);
  g_assert_no_error (error);
  fail_unless_equals_uint64 (gst_cloth_mesh_get_sequence (mesh), 1234);
  bench_clear (&b);
}

GST_START_TEST (test_capture_time)
{
  check_capture_time (FALSE);
  check_capture_time (TRUE);
}

GST_END_TEST;

/* A time stamp years ahead costs its frame, and the message names the camera. */
GST_START_TEST (test_wild_time)
{
  Bench b;

  bench_init (&b, 3);
  push_all (&b, 0);
  expect_all (&b, 0, GST_CLOTH_VERTEX_MEASURED);
  push (&b, 1, NULL, G_MAXINT);
  push_seen (&b, 0, 0, 1, ALL, NULL);
  push_seen (&b, 2, 2, 1, ALL, NULL);
  push_seen (&b, 1, 1, 1, ALL, NULL);
  expect_all (&b, 1, GST_CLOTH_VERTEX_MEASURED);
  expect_message (&b, GST_MESSAGE_WARNING,
      "camera \"cam1\" (pad sink_1) was dropped: its time stamp, 85899345.880 s");
  push_all (&b, 2);
  expect_all (&b, 2, GST_CLOTH_VERTEX_MEASURED);
  bench_clear (&b);
}

GST_END_TEST;

/* Flush, end, and back to NULL and PLAYING again. */
GST_START_TEST (test_flush_and_restart)
{
  Bench b;
  guint32 seqnum;
  guint i;

  bench_init (&b, 2);
  push_all (&b, 0);
  expect_all (&b, 0, GST_CLOTH_VERTEX_TWO_VIEWS);
  /* one seek, so one sequence number, reaches all pads */
  seqnum = gst_util_seqnum_next ();
  for (i = 0; i < 2; i++) {
    GstEvent *event = gst_event_new_flush_start ();

    gst_event_set_seqnum (event, seqnum);
    fail_unless (gst_harness_push_event (b.in[i], event));
  }
  for (i = 0; i < 2; i++) {
    GstEvent *event = gst_event_new_flush_stop (TRUE);
    GstSegment segment;

    gst_event_set_seqnum (event, seqnum);
    fail_unless (gst_harness_push_event (b.in[i], event));
    gst_segment_init (&segment, GST_FORMAT_TIME);
    fail_unless (gst_harness_push_event (b.in[i],
            gst_event_new_segment (&segment)));
  }
  push_all (&b, 0);
  expect_all (&b, 0, GST_CLOTH_VERTEX_TWO_VIEWS);
  for (i = 0; i < 2; i++) {
    fail_unless (gst_harness_push_event (b.in[i], gst_event_new_eos ()));
  }
  fail_unless (gst_bus_pop_filtered (b.bus, GST_MESSAGE_ERROR) == NULL);
  for (i = 0; i < 3; i++) {
    fail_unless (gst_element_set_state (b.element, GST_STATE_NULL) ==
        GST_STATE_CHANGE_SUCCESS);
    fail_if (gst_element_set_state (b.element, GST_STATE_PLAYING) ==
        GST_STATE_CHANGE_FAILURE);
  }
  bench_clear (&b);
}

GST_END_TEST;

static Suite *
triangulatestream_suite (void)
{
  Suite *s = suite_create ("triangulatestream");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, test_changes);
  tcase_add_test (tc, test_other_pattern);
  tcase_add_test (tc, test_live_camera_silent);
  tcase_add_test (tc, test_live);
  tcase_add_test (tc, test_rates_differ);
  tcase_add_test (tc, test_late_camera_of_other_rate);
  tcase_add_test (tc, test_capture_time);
  tcase_add_test (tc, test_wild_time);
  tcase_add_test (tc, test_flush_and_restart);
  return s;
}

GST_CHECK_MAIN (triangulatestream);
