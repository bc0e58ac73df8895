/* clothsim: every frame of the scene at its time, seeks, live, errors.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/check/gsttestclock.h>
#include <gst/cloth/cloth.h>

#include "tests/core/meshpeer.h"

#define TAKE TEST_DATA "/take_drop"
#define FRAMES 32
#define N 1155
#define PERIOD (20 * GST_MSECOND)

static const gchar knit[] = "{\"version\":1,\"areal_density\":0.187}";

static GstHarness *
harness (const gchar * model, const gchar * more)
{
  g_autofree gchar *path = scratch_path ("model.json");
  g_autofree gchar *line = g_strdup_printf ("clothsim model=%s location=%s %s",
      path, TAKE, more);

  scratch_write ("model.json", model, -1);
  return gst_harness_new_parse (line);
}

static void
pull_place (GstHarness * h, guint frame, guint vertex, gfloat place[3])
{
  g_autoptr (GstBuffer) buffer = gst_harness_pull (h);
  g_autoptr (GstClothMesh) mesh = NULL;
  g_autoptr (GError) error = NULL;
  const gfloat *positions;

  fail_unless (buffer != NULL);
  mesh = gst_cloth_mesh_from_buffer (buffer, &error);
  g_assert_no_error (error);
  fail_unless_equals_uint64 (GST_BUFFER_PTS (buffer), frame * PERIOD);
  fail_unless_equals_uint64 (GST_BUFFER_DURATION (buffer), PERIOD);
  fail_unless_equals_uint64 (gst_cloth_mesh_get_sequence (mesh), frame);
  fail_unless_equals_int (gst_cloth_mesh_get_n_vertices (mesh), N);
  positions = gst_cloth_mesh_get_positions (mesh, NULL);
  memcpy (place, positions + 3 * vertex, 3 * sizeof *place);
}

GST_START_TEST (test_whole_scene)
{
  GstHarness *h;
  gfloat place[3], first = 0;
  g_autoptr (GstCaps) caps = NULL;
  gint fps_n, fps_d, n;

  scratch_begin ();
  h = harness (knit, "");
  gst_harness_play (h);
  for (guint frame = 0; frame < FRAMES; frame++) {
    pull_place (h, frame, 32, place);
    fail_unless (place[0] == place[0]);
    if (frame == 0)
      first = place[2];
  }
  /* The right corner is let go at 0.32 s and falls. */
  fail_unless (place[2] < first - 0.1f, "from %g to %g", first, place[2]);
  caps = gst_pad_get_current_caps (h->sinkpad);
  fail_unless (gst_structure_get_int (gst_caps_get_structure (caps, 0),
          "vertices", &n));
  fail_unless_equals_int (n, N);
  fail_unless (gst_structure_get_fraction (gst_caps_get_structure (caps, 0),
          "framerate", &fps_n, &fps_d));
  fail_unless_equals_int (fps_n, 50 * fps_d);
  fail_unless (gst_harness_try_pull (h) == NULL);
  gst_harness_teardown (h);
  scratch_end ();
}

GST_END_TEST;

static void
play (GstElement * pipeline, GstMessageType wanted)
{
  g_autoptr (GstBus) bus = gst_element_get_bus (pipeline);
  g_autoptr (GstMessage) message = NULL;

  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  message = gst_bus_timed_pop_filtered (bus, GST_CLOCK_TIME_NONE,
      GST_MESSAGE_EOS | GST_MESSAGE_ERROR);
  fail_unless_equals_int (GST_MESSAGE_TYPE (message), wanted);
}

/* What can't be sought is refused before anything is flushed: the stream goes on as it was. */
GST_START_TEST (test_refused_seeks)
{
  static const struct
  {
    gdouble rate;
    GstFormat format;
    gint64 start, stop;
  } cases[] = {
    {-1, GST_FORMAT_TIME, 0, 10 * PERIOD},
    {1, GST_FORMAT_TIME, 10 * PERIOD, 5 * PERIOD},
    {1, GST_FORMAT_BYTES, 0, -1},
    {1, GST_FORMAT_DEFAULT, 3, -1},
    {1, GST_FORMAT_PERCENT, GST_FORMAT_PERCENT_MAX / 2, -1},
  };
  GstHarness *h;

  scratch_begin ();
  h = harness (knit, "");
  gst_harness_play (h);
  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (GstBuffer) buffer = gst_harness_pull (h);
    GstEvent *event;

    fail_unless_equals_uint64 (GST_BUFFER_OFFSET (buffer), i);
    fail_if (gst_harness_push_upstream_event (h, gst_event_new_seek
            (cases[i].rate, cases[i].format, GST_SEEK_FLAG_FLUSH,
                GST_SEEK_TYPE_SET, cases[i].start, GST_SEEK_TYPE_SET,
                cases[i].stop)), "case %u", i);
    while ((event = gst_harness_try_pull_event (h))) {
      fail_if (GST_EVENT_TYPE (event) == GST_EVENT_FLUSH_START
          || GST_EVENT_TYPE (event) == GST_EVENT_FLUSH_STOP, "case %u", i);
      gst_event_unref (event);
    }
    event = gst_pad_get_sticky_event (h->sinkpad, GST_EVENT_SEGMENT, 0);
    fail_unless (event != NULL);
    gst_event_unref (event);
  }
  gst_harness_teardown (h);
  scratch_end ();
}

GST_END_TEST;

static void
note_buffer (GstElement * sink, GstBuffer * buffer, GstPad * pad,
    GPtrArray * buffers)
{
  g_ptr_array_add (buffers, gst_buffer_ref (buffer));
}

static void
seek (GstElement * pipeline, guint frame)
{
  fail_unless (gst_element_seek_simple (pipeline, GST_FORMAT_TIME,
          GST_SEEK_FLAG_FLUSH | GST_SEEK_FLAG_ACCURATE, frame * PERIOD));
}

/* After a seek forwards or back the bytes are those of a run without one. */
GST_START_TEST (test_seeks)
{
  g_autoptr (GPtrArray) whole =
      g_ptr_array_new_with_free_func ((GDestroyNotify) gst_buffer_unref);
  static const guint targets[] = { 20, 0, 7 };

  scratch_begin ();
  for (guint turn = 0; turn <= G_N_ELEMENTS (targets); turn++) {
    g_autofree gchar *path = scratch_path ("model.json");
    g_autofree gchar *line = g_strdup_printf ("clothsim model=%s location=%s ! "
        "fakesink name=sink signal-handoffs=true", path, TAKE);
    g_autoptr (GstElement) pipeline = NULL, sink = NULL;
    g_autoptr (GPtrArray) buffers =
        g_ptr_array_new_with_free_func ((GDestroyNotify) gst_buffer_unref);
    guint from = turn ? targets[turn - 1] : 0;
    gint64 duration;

    scratch_write ("model.json", knit, -1);
    pipeline = gst_parse_launch (line, NULL);
    sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");
    g_signal_connect (sink, "handoff", G_CALLBACK (note_buffer),
        turn ? buffers : whole);
    gst_element_set_state (pipeline, GST_STATE_PAUSED);
    gst_element_get_state (pipeline, NULL, NULL, GST_CLOCK_TIME_NONE);
    fail_unless (gst_element_query_duration (pipeline, GST_FORMAT_TIME,
            &duration));
    fail_unless_equals_int64 (duration, FRAMES * PERIOD);
    if (turn) {
      /* First on, so that the second one goes back. */
      seek (pipeline, 25);
      gst_element_get_state (pipeline, NULL, NULL, GST_CLOCK_TIME_NONE);
      seek (pipeline, from);
    }
    play (pipeline, GST_MESSAGE_EOS);
    gst_element_set_state (pipeline, GST_STATE_NULL);
    if (turn == 0)
      continue;
    fail_unless_equals_int (buffers->len, FRAMES - from);
    for (guint i = 0; i < buffers->len; i++) {
      GstMapInfo map;

      gst_buffer_map (buffers->pdata[i], &map, GST_MAP_READ);
      fail_unless (gst_buffer_memcmp (whole->pdata[from + i], 0, map.data,
              map.size) == 0, "frame %u", from + i);
      gst_buffer_unmap (buffers->pdata[i], &map);
    }
  }
  scratch_end ();
}

GST_END_TEST;

/* Live: no frame before its time. */
GST_START_TEST (test_live)
{
  GstHarness *h;
  GstTestClock *clock;
  GstClockTime latency;

  scratch_begin ();
  h = harness (knit, "live=true");
  gst_harness_use_testclock (h);
  clock = gst_harness_get_testclock (h);
  gst_harness_play (h);
  for (guint frame = 0; frame < 3; frame++) {
    gfloat place[3];
    GstClockID id;

    gst_test_clock_wait_for_next_pending_id (clock, &id);
    fail_unless_equals_uint64 (gst_clock_id_get_time (id), frame * PERIOD);
    gst_clock_id_unref (id);
    fail_unless_equals_int (gst_harness_buffers_in_queue (h), 0);
    gst_harness_crank_single_clock_wait (h);
    pull_place (h, frame, 0, place);
  }
  latency = gst_harness_query_latency (h);
  fail_unless (GST_CLOCK_TIME_IS_VALID (latency));
  gst_object_unref (clock);
  gst_harness_teardown (h);
  scratch_end ();
}

GST_END_TEST;

/* A computer that can't keep pace: while frame 1 is computed the clock goes on to 5.5
 * periods. Frames 1 to 5 come without waiting, all of them, each with the time that it is
 * of, so a sink sees that they are late; then the source waits again. */
GST_START_TEST (test_live_late)
{
  GstHarness *h;
  GstTestClock *clock;
  GstClockID id;
  gfloat place[3];

  scratch_begin ();
  h = harness (knit, "live=true");
  gst_harness_use_testclock (h);
  clock = gst_harness_get_testclock (h);
  gst_harness_play (h);
  gst_harness_crank_single_clock_wait (h);
  pull_place (h, 0, 0, place);
  gst_test_clock_wait_for_next_pending_id (clock, &id);
  fail_unless_equals_uint64 (gst_clock_id_get_time (id), PERIOD);
  gst_clock_id_unref (id);
  gst_test_clock_set_time (clock, 5 * PERIOD + PERIOD / 2);
  for (guint frame = 1; frame < 6; frame++) {
    /* a test clock holds back waits for the past too; time stands still */
    gst_test_clock_wait_for_next_pending_id (clock, &id);
    fail_unless_equals_uint64 (gst_clock_id_get_time (id), frame * PERIOD);
    gst_clock_id_unref (id);
    id = gst_test_clock_process_next_clock_id (clock);
    fail_unless (id != NULL);
    gst_clock_id_unref (id);
    pull_place (h, frame, 0, place);
  }
  gst_test_clock_wait_for_next_pending_id (clock, &id);
  fail_unless_equals_uint64 (gst_clock_id_get_time (id), 6 * PERIOD);
  gst_clock_id_unref (id);
  fail_unless_equals_int (gst_harness_buffers_in_queue (h), 0);
  gst_object_unref (clock);
  gst_harness_teardown (h);
  scratch_end ();
}

GST_END_TEST;

static void
count_frames (GstDebugCategory * category, GstDebugLevel level,
    const gchar * file, const gchar * function, gint line, GObject * object,
    GstDebugMessage * message, gpointer n)
{
  if (g_str_equal (gst_debug_category_get_name (category), "clothsim")
      && g_str_has_prefix (gst_debug_message_get (message), "simulated frame"))
    g_atomic_int_inc ((gint *) n);
}

/* A stop does not wait until a simulation has come to where a seek wants it: at 1000
 * steps a frame that would be long. */
GST_START_TEST (test_stop_after_seek)
{
  g_autofree gchar *path = NULL, *line = NULL;
  g_autoptr (GstElement) pipeline = NULL;
  static gint n = 0;

  scratch_begin ();
  path = scratch_path ("model.json");
  scratch_write ("model.json", "{\"version\":1,\"areal_density\":0.187,"
      "\"time_step\":2e-5}", -1);
  line = g_strdup_printf ("clothsim model=%s location=%s ! fakesink", path,
      TAKE);
  pipeline = gst_parse_launch (line, NULL);
  gst_element_set_state (pipeline, GST_STATE_PAUSED);
  gst_element_get_state (pipeline, NULL, NULL, GST_CLOCK_TIME_NONE);
  gst_debug_set_threshold_for_name ("clothsim", GST_LEVEL_LOG);
  gst_debug_add_log_function (count_frames, &n, NULL);
  seek (pipeline, FRAMES - 1);
  while (g_atomic_int_get (&n) < 1)
    g_usleep (1000);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_debug_remove_log_function (count_frames);
  GST_INFO ("%d frames were simulated", n);
  fail_unless (n < FRAMES - 1);
  /* and it starts again */
  scratch_write ("model.json", knit, -1);
  play (pipeline, GST_MESSAGE_EOS);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  scratch_end ();
}

GST_END_TEST;

GST_START_TEST (test_errors)
{
  static const struct
  {
    const gchar *model, *properties, *text;
  } cases[] = {
    {NULL, "", "“model”"},
    {NULL, "location=" TAKE, "“model”"},
    {knit, "", "“location”"},
    {NULL, "model=/nonexistent/m.json location=" TAKE, "/nonexistent/m.json"},
    {"{\"version\":1,\"shear\":-4}", "location=" TAKE, "“shear” is -4"},
    {"{\"version\":1,\"effects\":{\"breeze\":{}}}", "location=" TAKE,
        "breeze"},
    {"[]", "location=" TAKE, "not JSON"},
    {knit, "location=/nonexistent", "/nonexistent"},
    {knit, "location=" TEST_DATA "/checker_pair", "take.json"},
    {"{\"version\":1,\"stretch\":{\"warp\":4000,\"weft\":4000},"
          "\"time_step\":0.02}", "location=" TAKE, "blew up at"},
  };

  scratch_begin ();
  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autofree gchar *path = scratch_path ("model.json");
    g_autofree gchar *line = g_strdup_printf ("clothsim %s%s %s ! fakesink",
        cases[i].model ? "model=" : "", cases[i].model ? path : "",
        cases[i].properties);
    g_autoptr (GstElement) pipeline = gst_parse_launch (line, NULL);
    g_autoptr (GstBus) bus = gst_element_get_bus (pipeline);
    g_autoptr (GstMessage) message = NULL;
    g_autoptr (GError) error = NULL;

    if (cases[i].model)
      scratch_write ("model.json", cases[i].model, -1);
    gst_element_set_state (pipeline, GST_STATE_PLAYING);
    message = gst_bus_timed_pop_filtered (bus, GST_CLOCK_TIME_NONE,
        GST_MESSAGE_EOS | GST_MESSAGE_ERROR);
    fail_unless_equals_int (GST_MESSAGE_TYPE (message), GST_MESSAGE_ERROR);
    gst_message_parse_error (message, &error, NULL);
    GST_INFO ("%s", error->message);
    fail_unless (strstr (error->message, cases[i].text) != NULL, "%s",
        error->message);
    gst_element_set_state (pipeline, GST_STATE_NULL);
  }
  scratch_end ();
}

GST_END_TEST;

static Suite *
clothsim_suite (void)
{
  Suite *suite = suite_create ("clothsim");
  TCase *tests = tcase_create ("all");

  suite_add_tcase (suite, tests);
  tcase_add_test (tests, test_whole_scene);
  tcase_add_test (tests, test_refused_seeks);
  tcase_add_test (tests, test_seeks);
  tcase_add_test (tests, test_live);
  tcase_add_test (tests, test_live_late);
  tcase_add_test (tests, test_stop_after_seek);
  tcase_add_test (tests, test_errors);
  return suite;
}

GST_CHECK_MAIN (clothsim);
