/* clothgap on meshes: residuals against the closed form of a damped oscillator (see
 * clothgapbench.h), what travels in which order, refusals.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <json-glib/json-glib.h>

#include "clothgapbench.h"
#include "tests/elements/damage.h"

/* ---- positive ---- */

GST_START_TEST (test_closed_form)
{
  Setup setup = set_up_good ("");
  g_autoptr (GstMessage) message = NULL;
  gdouble worst = 0, want = 0, rms = 0, from = 0;
  guint n_scores = 0;

  for (guint frame = 0; frame < N_FRAMES; frame++) {
    push (&setup, frame, frame + 1);
    fail_unless_equals_int (gst_harness_buffers_received (setup.h),
        frame < LATENCY ? 0 : frame - LATENCY + 1);
  }
  gst_harness_push_event (setup.h, gst_event_new_eos ());
  fail_unless_equals_int (gst_harness_buffers_received (setup.h), N_FRAMES);
  for (guint frame = 0; frame < N_FRAMES; frame++) {
    GstBuffer *buffer = gst_harness_pull (setup.h);
    gdouble error = mean_residual (buffer, 2) - oscillator ((gdouble) frame /
        FPS);

    fail_unless_equals_uint64 (GST_BUFFER_PTS (buffer),
        gst_util_uint64_scale (frame, GST_SECOND, FPS));
    fail_unless_equals_uint64 (gst_cloth_gap_get_sequence
        (gst_buffer_get_cloth_gap (buffer)), frame);
    fail_unless (fabs (mean_residual (buffer, 0)) < 1e-5);
    worst = MAX (worst, fabs (error));
    gst_buffer_unref (buffer);
  }
  GST_INFO ("worst distance from the closed form: %.4f mm", 1000 * worst);
  fail_unless (worst < 0.0002, "%.3f mm from the closed form", 1000 * worst);

  /* A window's simulation starts with the oscillator's e, e′ and then e″ = ACCELERATION. */
  while ((message = find_message (&setup, GST_MESSAGE_ELEMENT,
              "clothgap/score"))) {
    const GstStructure *s = gst_message_get_structure (message);
    guint64 time, duration;
    gdouble coverage, sum = 0, e, slope;

    fail_unless (gst_structure_get (s, "time", G_TYPE_UINT64, &time,
            "duration", G_TYPE_UINT64, &duration, "rms", G_TYPE_DOUBLE, &rms,
            "coverage", G_TYPE_DOUBLE, &coverage, NULL));
    fail_unless_equals_float (coverage, 1);
    fail_unless_equals_uint64 (duration, n_scores < 3 ? 300 * GST_MSECOND :
        295 * GST_MSECOND);
    fail_unless_equals_uint64 (time, n_scores * 300 * GST_MSECOND);
    from = (gdouble) time / GST_SECOND;
    e = oscillator (from);
    slope = (oscillator (from + 1e-5) - oscillator (from - 1e-5)) / 2e-5;
    for (guint i = 1; i <= (n_scores < 3 ? PER_WINDOW : PER_WINDOW - 1); i++) {
      gdouble t = (gdouble) i / FPS;

      sum += pow (e + slope * t + 0.5 * ACCELERATION * t * t, 2);
    }
    want = sqrt (sum / (n_scores < 3 ? PER_WINDOW : PER_WINDOW - 1));
    fail_unless (fabs (rms - want) < 0.03 * want,
        "window %u: %.2f mm, not %.2f", n_scores, 1000 * rms, 1000 * want);
    n_scores++;
    g_clear_pointer (&message, gst_message_unref);
  }
  fail_unless_equals_int (n_scores, 4);
  tear_down (&setup);
}

GST_END_TEST;

/* A stream that ends twice: nothing came since. */
GST_START_TEST (test_ends_twice)
{
  Setup setup = set_up_good ("");
  g_autoptr (GstMessage) first = NULL;

  push (&setup, 0, N_FRAMES);
  gst_harness_push_event (setup.h, gst_event_new_eos ());
  first = find_message (&setup, GST_MESSAGE_ERROR, NULL);
  fail_unless (first == NULL);
  gst_harness_push_event (setup.h, gst_event_new_stream_start ("again"));
  begin_segment (&setup);
  gst_harness_push_event (setup.h, gst_event_new_eos ());
  expect (&setup, GST_MESSAGE_ERROR, "ended without a mesh");
  tear_down (&setup);
}

GST_END_TEST;

/* The meshes themselves are as they were. */
GST_START_TEST (test_same_bytes)
{
  Setup setup = set_up_good ("");

  push (&setup, 0, 5);
  for (guint frame = 0; frame < 2; frame++)
    expect_same (&setup, make_frame (frame, -1, NULL));
  tear_down (&setup);
}

GST_END_TEST;

GST_START_TEST (test_threads)
{
  gfloat all[2][3 * N];

  for (guint run = 0; run < 2; run++) {
    Setup setup = set_up_good (run ? "threads=1" : "threads=2");
    GstBuffer *buffer = NULL;

    push (&setup, 0, 20);
    for (guint i = 0; i < 17; i++) {
      gst_clear_buffer (&buffer);
      buffer = gst_harness_pull (setup.h);
    }
    memcpy (all[run], gst_cloth_gap_get_residuals (gst_buffer_get_cloth_gap
            (buffer), NULL), sizeof all[run]);
    gst_buffer_unref (buffer);
    tear_down (&setup);
  }
  fail_unless_equals_int (memcmp (all[0], all[1], sizeof all[0]), 0);
}

GST_END_TEST;

/* A vertex that is not seen for a while has no residual then; the others' go on, and so
 * does the vertex's once it is back. */
GST_START_TEST (test_missing)
{
  Setup setup = set_up_good ("");
  g_autoptr (GstMessage) message = NULL;
  gdouble coverage;

  for (guint frame = 0; frame < 70; frame++)
    gst_harness_push (setup.h, make_frame (frame, frame >= 5 && frame < 20 ? 6 :
            -1, NULL));
  for (guint frame = 0; frame < 67; frame++) {
    GstBuffer *buffer = gst_harness_pull (setup.h);
    const gfloat *r =
        gst_cloth_gap_get_residuals (gst_buffer_get_cloth_gap (buffer), NULL);

    fail_unless_equals_int (isnan (r[18]), frame >= 5 && frame < 20);
    fail_unless (fabs (mean_residual (buffer, 2) - oscillator ((gdouble) frame /
                FPS)) < 0.002);
    gst_buffer_unref (buffer);
  }
  message = find_message (&setup, GST_MESSAGE_ELEMENT, "clothgap/score");
  fail_unless (gst_structure_get_double (gst_message_get_structure (message),
          "coverage", &coverage));
  /* 15 of the window's 60 frames lack one of 12 vertices */
  fail_unless (fabs (coverage - (1 - 15. / PER_WINDOW / N)) < 1e-9, "%g",
      coverage);
  tear_down (&setup);
}

GST_END_TEST;

/* Of the scene's take; of the mesh where it knows better. */
GST_START_TEST (test_sigmas)
{
  Setup setup = set_up_good ("");
  gfloat covariances[6 * N];
  GstBuffer *buffer;

  for (guint i = 0; i < N; i++) {
    const gfloat one[6] = { 1e-6f, 0, 0, 4e-6f, 0, i == 2 ? NAN : 7e-6f };

    memcpy (covariances + 6 * i, one, sizeof one);
  }
  gst_harness_push (setup.h, make_frame (0, -1, NULL));
  gst_harness_push (setup.h, make_frame (1, -1, covariances));
  push (&setup, 2, 5);
  for (guint frame = 0; frame < 2; frame++) {
    const gfloat *s;

    buffer = gst_harness_pull (setup.h);
    s = gst_cloth_gap_get_sigmas (gst_buffer_get_cloth_gap (buffer), NULL);
    fail_unless (fabs (s[0] - (frame ? 0.002 : 0.0004)) < 1e-8);
    fail_unless_equals_int (isnan (s[2]), frame == 1);
    gst_buffer_unref (buffer);
  }
  tear_down (&setup);
}

GST_END_TEST;

GST_START_TEST (test_latency)
{
  Setup setup = set_up_good ("");

  gst_harness_set_upstream_latency (setup.h, 7 * GST_MSECOND);
  fail_unless_equals_uint64 (gst_harness_query_latency (setup.h),
      22 * GST_MSECOND);
  /* another rate, the same mesh */
  gst_harness_set_src_caps (setup.h, make_caps (COLUMNS, ROWS, 0.1f, 100));
  fail_unless_equals_uint64 (gst_harness_query_latency (setup.h),
      37 * GST_MSECOND);
  tear_down (&setup);
}

GST_END_TEST;

/* What comes between two meshes stays there. */
GST_START_TEST (test_event_order)
{
  Setup setup = set_up_good ("");

  pull_events (&setup, NULL);
  push (&setup, 0, 2);
  gst_harness_push_event (setup.h,
      gst_event_new_custom (GST_EVENT_CUSTOM_DOWNSTREAM,
          gst_structure_new_empty ("between")));
  fail_unless_equals_int (gst_harness_events_in_queue (setup.h), 0);
  push (&setup, 2, 4);
  fail_unless_equals_int (gst_harness_buffers_received (setup.h), 1);
  fail_unless_equals_int (gst_harness_events_in_queue (setup.h), 0);
  push (&setup, 4, 5);
  fail_unless_equals_int (gst_harness_buffers_received (setup.h), 2);
  fail_unless (pull_events (&setup, "between"));
  tear_down (&setup);
}

GST_END_TEST;

/* A flush takes the meshes, not what is known of the stream. */
GST_START_TEST (test_tags_survive_flush)
{
  Setup setup = set_up_good ("");
  GstEvent *tags;

  push (&setup, 0, 2);
  gst_harness_push_event (setup.h,
      gst_event_new_tag (gst_tag_list_new (GST_TAG_TITLE, "a cloth", NULL)));
  flush (&setup);
  begin_segment (&setup);
  push (&setup, 0, 5);
  tags = gst_pad_get_sticky_event (setup.h->sinkpad, GST_EVENT_TAG, 0);
  fail_unless (tags != NULL);
  gst_event_unref (tags);
  expect_meshes (&setup, 2, 2);
  tear_down (&setup);
}

GST_END_TEST;

/* What the message says of detection limits is what the JSON says. */
static void
check_limits (const GstStructure * s, JsonArray * expected)
{
  const GValue *limits = gst_structure_get_value (s, "detection-limits");

  fail_unless (GST_VALUE_HOLDS_ARRAY (limits));
  fail_unless_equals_int (gst_value_array_get_size (limits),
      json_array_get_length (expected));
  for (guint i = 0; i < gst_value_array_get_size (limits); i++) {
    const GstStructure *limit =
        gst_value_get_structure (gst_value_array_get_value (limits, i));
    JsonObject *item = json_array_get_object_element (expected, i);
    gdouble value;

    fail_unless_equals_string (gst_structure_get_string (limit, "effect"),
        json_object_get_string_member (item, "effect"));
    fail_unless_equals_string (gst_structure_get_string (limit, "parameter"),
        json_object_get_string_member (item, "parameter"));
    fail_unless_equals_string (gst_structure_get_string (limit, "unit"),
        json_object_get_string_member (item, "unit"));
    fail_unless_equals_string (gst_structure_get_string (limit, "text"),
        json_object_get_string_member (item, "text"));
    fail_unless_equals_int (gst_structure_get_double (limit, "value", &value),
        !json_object_get_null_member (item, "value"));
  }
}

/* The verdict comes before EOS, as the same JSON in message and file. */
GST_START_TEST (test_verdict)
{
  g_autofree gchar *output = in_folder ("made/gap");
  g_autofree gchar *more = g_strdup_printf ("output=%s", output);
  g_autofree gchar *report = g_build_filename (output, "report.html", NULL);
  g_autofree gchar *json = g_build_filename (output, "gap.json", NULL);
  g_autofree gchar *contents = NULL;
  Setup setup = set_up_good (more);
  g_autoptr (GstMessage) message = NULL;
  g_autoptr (JsonParser) parser = json_parser_new ();
  const GstStructure *s;
  JsonObject *root;

  push (&setup, 0, N_FRAMES);
  fail_unless (find_message (&setup, GST_MESSAGE_ELEMENT, "clothgap/verdict")
      == NULL);
  gst_harness_push_event (setup.h, gst_event_new_eos ());
  message = find_message (&setup, GST_MESSAGE_ELEMENT, "clothgap/verdict");
  fail_unless (message != NULL);
  s = gst_message_get_structure (message);
  fail_unless (json_parser_load_from_data (parser, gst_structure_get_string (s,
              "json"), -1, NULL));
  root = json_node_get_object (json_parser_get_root (parser));
  fail_unless_equals_string (json_object_get_string_member (root, "verdict"),
      gst_structure_get_string (s, "verdict"));
  check_limits (s, json_object_get_array_member (root, "detection_limits"));
  fail_unless (strlen (gst_structure_get_string (s, "summary")) > 10);
  fail_unless_equals_string (gst_structure_get_string (s, "report"), report);
  fail_unless (g_file_test (report, G_FILE_TEST_IS_REGULAR));
  fail_unless (g_file_get_contents (json, &contents, NULL, NULL));
  fail_unless_equals_string (contents, gst_structure_get_string (s, "json"));
  fail_unless (pull_events (&setup, NULL));
  tear_down (&setup);
}

GST_END_TEST;

/* What another simulator made of the scene is compared with at the end, and must be of it. */
GST_START_TEST (test_simulated)
{
  static const gchar *const folders[] = { "simulated", "other", "take" };

  for (guint i = 0; i < G_N_ELEMENTS (folders); i++) {
    g_autofree gchar *more = g_strdup_printf ("effects=wind simulated=%s/%s",
        folder, folders[i]);
    Setup setup = set_up_good (more);
    g_autoptr (GstMessage) message = NULL;

    push (&setup, 0, N_FRAMES);
    gst_harness_push_event (setup.h, gst_event_new_eos ());
    if (i == 0) {
      message = find_message (&setup, GST_MESSAGE_ELEMENT, "clothgap/verdict");
      fail_unless (message != NULL);
      fail_unless (strstr (gst_structure_get_string (gst_message_get_structure
                  (message), "json"), "\"has_simulated\": true") != NULL);
    } else {
      expect (&setup, GST_MESSAGE_ERROR, i == 1 ? "is no simulation of" :
          "the same positions");
    }
    pull_events (&setup, NULL);
    tear_down (&setup);
  }
}

GST_END_TEST;

/* After a flush it starts anew; so it does, without one, when a segment goes back. */
GST_START_TEST (test_again)
{
  for (guint way = 0; way < 2; way++) {
    Setup setup = set_up_good ("");

    push (&setup, 0, 12);
    if (way == 0)
      flush (&setup);
    begin_segment (&setup);
    push (&setup, 0, 12);
    /* 9 of the first run, its last 3 unless they were flushed, 9 of the second */
    expect_oscillator (&setup, way ? 12 : 9, way ? 21 : 18);
    tear_down (&setup);
  }
}

GST_END_TEST;

/* ---- what can't be scored passes ---- */

GST_START_TEST (test_times)
{
  Setup setup = set_up_good ("");

  push (&setup, 0, 5);
  gst_harness_push (setup.h, make_frame (4, -1, NULL));
  gst_harness_push (setup.h, make_frame (2, -1, NULL));
  push (&setup, 5, 8);
  expect (&setup, GST_MESSAGE_WARNING, "times must rise");
  fail_unless (find_message (&setup, GST_MESSAGE_WARNING, NULL) == NULL);
  expect_meshes (&setup, 7, 5);
  tear_down (&setup);
}

GST_END_TEST;

/* Behind the end of what the clamps' paths say. None waits for a mesh to come: what is
 * behind the end may go on for ever. */
GST_START_TEST (test_outside_scene)
{
  Setup setup = set_up ("/model.json", "/held", "");

  gst_harness_set_src_caps (setup.h, make_caps (COLUMNS, ROWS, 0.1f, FPS));
  push (&setup, N_FRAMES - 4, N_FRAMES + 3);
  expect (&setup, GST_MESSAGE_WARNING, "outside the scene");
  fail_unless_equals_int (gst_harness_buffers_received (setup.h), 7);
  gst_harness_push_event (setup.h, gst_event_new_eos ());
  expect_meshes (&setup, 7, 4);
  tear_down (&setup);
}

GST_END_TEST;

static GstPadProbeReturn
refuse_buffer (GstPad * pad, GstPadProbeInfo * info, gpointer data)
{
  gst_buffer_unref (GST_PAD_PROBE_INFO_BUFFER (info));
  GST_PAD_PROBE_INFO_FLOW_RETURN (info) = GST_FLOW_EOS;
  return GST_PAD_PROBE_HANDLED;
}

/* What waits keeps its order when downstream wants no more, with a mesh without a gap and
 * an event among it. */
GST_START_TEST (test_downstream_ends)
{
  Setup setup = set_up_good ("");

  push (&setup, 0, 5);
  gst_harness_push (setup.h, make_frame (4, -1, NULL));
  gst_harness_push_event (setup.h,
      gst_event_new_custom (GST_EVENT_CUSTOM_DOWNSTREAM,
          gst_structure_new_empty ("between")));
  gst_pad_add_probe (setup.h->sinkpad, GST_PAD_PROBE_TYPE_BUFFER,
      refuse_buffer, NULL, NULL);
  for (guint frame = 5; frame < 12; frame++)
    fail_unless_equals_int (gst_harness_push (setup.h, make_frame (frame, -1,
                NULL)), GST_FLOW_EOS);
  gst_harness_push_event (setup.h, gst_event_new_eos ());
  fail_unless_equals_int (gst_harness_buffers_received (setup.h), 2);
  tear_down (&setup);
}

GST_END_TEST;

/* ---- refusals ---- */

GST_START_TEST (test_cannot_start)
{
  static const struct
  {
    const gchar *model, *take, *more, *text;
  } cases[] = {
    {NULL, "/take", "", "“model”"},
    {"/model.json", NULL, "", "“location”"},
    {"/none.json", "/take", "", "none.json"},
    {"/bad.json", "/take", "", "“shear” is -4"},
    {"/model.json", "/none", "", "none"},
    {"/model.json", "/model.json", "", "take.json"},
    {"/model.json", "/blind", "", "no rig.json"},
    {"/model.json", "/take", "effects=air_drg", "“air_drag”"},
    {"/model.json", "/take", "effects=drag",
        "“air_drag”, “air_drag_linear”"},
    {"/model.json", "/take", "effects=qqqq", "lists them all"},
    {"/model.json", "/take", "baseline=/none", "baseline"},
    {"/model.json", "/take", "simulated=/none", "simulated"},
  };

  /* takes that do as location, but not as baseline */
  static const struct
  {
    const gchar *baseline, *text;
  } baselines[] = {
    {"other", "5×3"}, {"blind", "no rig.json"}
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases) + G_N_ELEMENTS (baselines); i++) {
    gboolean last = i >= G_N_ELEMENTS (cases);
    guint k = last ? i - (guint) G_N_ELEMENTS (cases) : 0;
    g_autofree gchar *other = g_strdup_printf ("baseline=%s/%s", folder,
        baselines[k].baseline);
    GstElement *element = make_element (last ? "/model.json" : cases[i].model,
        last ? "/take" : cases[i].take, last ? other : cases[i].more);
    Setup setup = { NULL, gst_bus_new () };

    gst_element_set_bus (element, setup.bus);
    fail_unless_equals_int (gst_element_set_state (element, GST_STATE_PAUSED),
        GST_STATE_CHANGE_FAILURE);
    expect (&setup, GST_MESSAGE_ERROR, last ? baselines[k].text :
        cases[i].text);
    gst_element_set_bus (element, NULL);
    gst_element_set_state (element, GST_STATE_NULL);
    gst_object_unref (element);
    gst_object_unref (setup.bus);
  }
}

GST_END_TEST;

GST_START_TEST (test_other_mesh)
{
  static const struct
  {
    guint columns;
    gfloat step;
    const gchar *text;
  } cases[] = {
    {COLUMNS + 1, 0.1f, "5×3"}, {COLUMNS, 100, "metres in both"}
  };

  for (guint i = 0; i < 2 * G_N_ELEMENTS (cases); i++) {
    Setup setup = set_up ("/model.json", "/take", "");

    /* from the beginning, and in the middle of a stream */
    if (i >= G_N_ELEMENTS (cases)) {
      gst_harness_set_src_caps (setup.h, make_caps (COLUMNS, ROWS, 0.1f, FPS));
      push (&setup, 0, 5);
    }
    gst_harness_set_src_caps (setup.h, make_caps (cases[i % 2].columns, ROWS,
            cases[i % 2].step, FPS));
    expect (&setup, GST_MESSAGE_ERROR, cases[i % 2].text);
    tear_down (&setup);
  }
}

GST_END_TEST;

GST_START_TEST (test_bad_buffers)
{
  Setup setup = set_up_good ("");
  const gfloat places[3] = { 0 };
  const guint8 states[1] = { 1 };
  g_autoptr (GstClothMesh) mesh = gst_cloth_mesh_new (0, 1, places, states,
      NULL);
  GstBuffer *buffer;

  fail_unless_equals_int (gst_harness_push (setup.h, gst_buffer_new_memdup
          ("GCMB", 4)), GST_FLOW_OK);
  fail_unless_equals_int (gst_harness_push (setup.h,
          gst_cloth_mesh_to_buffer (mesh)), GST_FLOW_OK);
  assert_dropped (setup.h->element, setup.bus, 2, "mesh");
  g_object_set (setup.h->element, "strict", TRUE, NULL);
  fail_unless_equals_int (gst_harness_push (setup.h,
          gst_cloth_mesh_to_buffer (mesh)), GST_FLOW_ERROR);
  expect (&setup, GST_MESSAGE_ERROR, "1 vertices in a stream of 12");
  /* neither time nor rate */
  gst_harness_set_src_caps (setup.h, make_caps (COLUMNS, ROWS, 0.1f, 0));
  buffer = make_frame (0, -1, NULL);
  GST_BUFFER_PTS (buffer) = GST_CLOCK_TIME_NONE;
  fail_unless_equals_int (gst_harness_push (setup.h, buffer), GST_FLOW_ERROR);
  expect (&setup, GST_MESSAGE_ERROR, "framerate");
  tear_down (&setup);
}

GST_END_TEST;

GST_START_TEST (test_before_caps)
{
  Setup setup = set_up ("/model.json", "/take", "");

  gst_harness_play (setup.h);
  gst_harness_push_event (setup.h, gst_event_new_stream_start ("meshes"));
  begin_segment (&setup);
  fail_unless_equals_int (gst_harness_push (setup.h, make_frame (0, -1, NULL)),
      GST_FLOW_NOT_NEGOTIATED);
  tear_down (&setup);
}

GST_END_TEST;

GST_START_TEST (test_blows_up)
{
  Setup setup = set_up ("/wild.json", "/take", "");
  GstFlowReturn flow = GST_FLOW_OK;

  gst_harness_set_src_caps (setup.h, make_caps (COLUMNS, ROWS, 0.1f, FPS));
  for (guint frame = 0; frame < N_FRAMES && flow == GST_FLOW_OK; frame++) {
    gfloat places[3 * N];
    guint8 states[N];
    g_autoptr (GstClothMesh) mesh = NULL;
    GstBuffer *buffer;

    find_places (frame, 0, places);
    memset (states, GST_CLOTH_VERTEX_MEASURED, N);
    /* strain, which the large step does not survive */
    places[18] += 0.05f;
    mesh = gst_cloth_mesh_new (frame, N, places, states, NULL);
    buffer = gst_cloth_mesh_to_buffer (mesh);
    GST_BUFFER_PTS (buffer) = gst_util_uint64_scale (frame, GST_SECOND, FPS);
    flow = gst_harness_push (setup.h, buffer);
  }
  fail_unless_equals_int (flow, GST_FLOW_ERROR);
  expect (&setup, GST_MESSAGE_ERROR, "“time_step”");
  tear_down (&setup);
}

GST_END_TEST;

GST_START_TEST (test_backwards)
{
  Setup setup = set_up_good ("");
  GstSegment segment;

  gst_segment_init (&segment, GST_FORMAT_TIME);
  segment.rate = -1;
  segment.stop = GST_SECOND;
  gst_harness_push_event (setup.h, gst_event_new_segment (&segment));
  expect (&setup, GST_MESSAGE_ERROR, "backwards");
  tear_down (&setup);
}

GST_END_TEST;

GST_START_TEST (test_nothing)
{
  Setup setup = set_up_good ("");

  gst_harness_push_event (setup.h, gst_event_new_eos ());
  expect (&setup, GST_MESSAGE_ERROR, "without a mesh");
  fail_unless (pull_events (&setup, NULL));
  tear_down (&setup);
}

GST_END_TEST;

GST_START_TEST (test_cannot_write)
{
  Setup setup = set_up_good ("output=/proc/gap");

  push (&setup, 0, N_FRAMES);
  gst_harness_push_event (setup.h, gst_event_new_eos ());
  expect (&setup, GST_MESSAGE_ERROR, "/proc/gap");
  tear_down (&setup);
}

GST_END_TEST;

static Suite *
clothgap_suite (void)
{
  Suite *s = suite_create ("clothgap");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, test_closed_form);
  tcase_add_test (tc, test_same_bytes);
  tcase_add_test (tc, test_ends_twice);
  tcase_add_test (tc, test_threads);
  tcase_add_test (tc, test_missing);
  tcase_add_test (tc, test_sigmas);
  tcase_add_test (tc, test_latency);
  tcase_add_test (tc, test_event_order);
  tcase_add_test (tc, test_tags_survive_flush);
  tcase_add_test (tc, test_verdict);
  tcase_add_test (tc, test_simulated);
  tcase_add_test (tc, test_again);
  tcase_add_test (tc, test_times);
  tcase_add_test (tc, test_outside_scene);
  tcase_add_test (tc, test_downstream_ends);
  tcase_add_test (tc, test_cannot_start);
  tcase_add_test (tc, test_other_mesh);
  tcase_add_test (tc, test_bad_buffers);
  tcase_add_test (tc, test_before_caps);
  tcase_add_test (tc, test_blows_up);
  tcase_add_test (tc, test_backwards);
  tcase_add_test (tc, test_nothing);
  tcase_add_test (tc, test_cannot_write);
  return s;
}

int
main (int argc, char **argv)
{
  int failed;

  gst_check_init (&argc, &argv);
  make_files ();
  failed = gst_check_run_suite (clothgap_suite (), "clothgap", __FILE__);
  remove_all (folder);
  g_free (folder);
  return failed;
}
