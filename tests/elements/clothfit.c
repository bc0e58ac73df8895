/* clothfit: the simulated cloth against the closed form of a damped oscillator (see
 * clothgapbench.h), what it makes of holes, what it fits, refusals. Of pictures see
 * tests/pipelines/chains.py.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#define ELEMENT "clothfit gain=100"
#include "clothgapbench.h"

/* How far the mesh that left is behind the recording, on the mean, m. */
static gdouble
lag (GstBuffer * buffer, guint frame)
{
  g_autoptr (GstClothMesh) mesh = gst_cloth_mesh_from_buffer (buffer, NULL);
  const gfloat *p = gst_cloth_mesh_get_positions (mesh, NULL);
  gfloat places[3 * N];
  gdouble sum = 0;

  fail_unless_equals_uint64 (gst_cloth_mesh_get_sequence (mesh), frame);
  find_places (frame, ACCELERATION, places);
  for (guint i = 0; i < N; i++)
    sum += (gdouble) places[3 * i + 2] - p[3 * i + 2];
  return sum / N;
}

GST_START_TEST (test_closed_form)
{
  Setup setup = set_up_good ("");
  g_autoptr (GstMessage) message = NULL;
  g_autoptr (GstCaps) caps = NULL;
  gdouble rms;

  push (&setup, 0, N_FRAMES);
  gst_harness_push_event (setup.h, gst_event_new_eos ());
  fail_unless_equals_int (gst_harness_buffers_received (setup.h), N_FRAMES);
  for (guint frame = 0; frame < N_FRAMES; frame++) {
    GstBuffer *buffer = gst_harness_pull (setup.h);

    fail_unless_equals_uint64 (GST_BUFFER_PTS (buffer),
        gst_util_uint64_scale (frame, GST_SECOND, FPS));
    fail_unless_equals_uint64 (GST_BUFFER_DURATION (buffer), GST_SECOND / FPS);
    fail_unless (fabs (lag (buffer, frame) - oscillator ((gdouble) frame /
                FPS)) < 0.0002);
    gst_buffer_unref (buffer);
  }
  caps = gst_pad_get_current_caps (GST_PAD_PEER (setup.h->sinkpad));
  fail_unless (gst_structure_has_name (gst_caps_get_structure (caps, 0),
          GST_CLOTH_MESH_MEDIA_TYPE));
  message = find_message (&setup, GST_MESSAGE_ELEMENT, "clothfit/score");
  fail_unless (message
      && gst_structure_get_double (gst_message_get_structure (message), "rms",
          &rms) && rms > 0.005 && rms < 0.05);
  tear_down (&setup);
}

GST_END_TEST;

/* Stiffer springs lag less, by a / g once they have settled. */
GST_START_TEST (test_gain)
{
  Setup setup = set_up_good ("gain=1600");
  GstBuffer *buffer = NULL;

  push (&setup, 0, N_FRAMES);
  for (guint frame = 0; frame < N_FRAMES - LATENCY; frame++) {
    gst_clear_buffer (&buffer);
    buffer = gst_harness_pull (setup.h);
  }
  fail_unless (fabs (lag (buffer, N_FRAMES - LATENCY - 1) -
          ACCELERATION / 1600) < 2e-5);
  gst_buffer_unref (buffer);
  tear_down (&setup);
}

GST_END_TEST;

/* A vertex that is not seen is where the cloth has it. */
GST_START_TEST (test_hole)
{
  Setup setup = set_up_good ("");

  for (guint frame = 0; frame < 60; frame++)
    gst_harness_push (setup.h, make_frame (frame, frame < 40 ? 6 : -1, NULL));
  for (guint frame = 0; frame < 60 - LATENCY; frame++) {
    GstBuffer *buffer = gst_harness_pull (setup.h);
    g_autoptr (GstClothMesh) mesh = gst_cloth_mesh_from_buffer (buffer, NULL);
    const gfloat *p = gst_cloth_mesh_get_positions (mesh, NULL);
    const guint8 *s = gst_cloth_mesh_get_states (mesh, NULL);

    fail_unless_equals_int (s[6], frame < 40 ? GST_CLOTH_VERTEX_PREDICTED :
        GST_CLOTH_VERTEX_MEASURED);
    fail_unless_equals_int (s[5], GST_CLOTH_VERTEX_MEASURED);
    /* between its neighbours, and no lower than it would fall by itself */
    fail_unless (fabs (p[18] - 0.2) < 0.01 && fabs (p[19] - 0.1) < 0.01);
    fail_unless (p[20] < p[17] + 1e-3 && p[20] > p[17] - 0.05);
    gst_buffer_unref (buffer);
  }
  tear_down (&setup);
}

GST_END_TEST;

/* Times outside of the scene have no cloth: left out, and told once. */
GST_START_TEST (test_outside)
{
  Setup setup = set_up ("/model.json", "/held", "");

  gst_harness_set_src_caps (setup.h, make_caps (COLUMNS, ROWS, 0.1f, FPS));
  push (&setup, 0, N_FRAMES);
  for (guint frame = N_FRAMES + 5; frame < N_FRAMES + 9; frame++)
    gst_harness_push (setup.h, make_frame (frame, -1, NULL));
  expect (&setup, GST_MESSAGE_WARNING, "is left out");
  fail_unless (find_message (&setup, GST_MESSAGE_WARNING, NULL) == NULL);
  gst_harness_push_event (setup.h, gst_event_new_eos ());
  fail_unless_equals_int (gst_harness_buffers_received (setup.h), N_FRAMES);
  tear_down (&setup);
}

GST_END_TEST;

/* The recording falls as if the air held it back; a model that may be damped finds that it
 * is. */
GST_START_TEST (test_fitted)
{
  g_autofree gchar *path = in_folder ("/fitted.json");
  g_autofree gchar *more = g_strconcat ("fitted=", path, NULL);
  g_autoptr (GstMessage) message = NULL;
  const GstStructure *s, *number;
  const GValue *numbers;
  gdouble before, after, value, sigma;
  Setup setup;

  put_model ("free.json", ", \"time_step\": 0.0002, \"free\": "
      "[{\"name\": \"damping.mass\", \"range\": [0, 5]}]");
  setup = set_up ("/free.json", "/take", more);
  gst_harness_set_src_caps (setup.h, make_caps (COLUMNS, ROWS, 0.1f, FPS));
  push (&setup, 0, N_FRAMES);
  gst_harness_push_event (setup.h, gst_event_new_eos ());
  message = find_message (&setup, GST_MESSAGE_ELEMENT, "clothfit/fitted");
  fail_unless (message != NULL);
  s = gst_message_get_structure (message);
  fail_unless (gst_structure_get (s, "windows-before", G_TYPE_DOUBLE, &before,
          "windows-after", G_TYPE_DOUBLE, &after, NULL));
  fail_unless (after < 0.6 * before, "%.2f → %.2f mm", 1e3 * before,
      1e3 * after);
  numbers = gst_structure_get_value (s, "numbers");
  fail_unless_equals_int (gst_value_array_get_size (numbers), 1);
  number = gst_value_get_structure (gst_value_array_get_value (numbers, 0));
  fail_unless_equals_string (gst_structure_get_string (number, "name"),
      "damping.mass");
  fail_unless (gst_structure_get (number, "value", G_TYPE_DOUBLE, &value,
          "sigma", G_TYPE_DOUBLE, &sigma, NULL));
  fail_unless (value > 0.02 && sigma > 0 && sigma < value, "%g ± %g", value,
      sigma);
  fail_unless (g_file_test (path, G_FILE_TEST_EXISTS));
  tear_down (&setup);
}

GST_END_TEST;

/* After a flush a new recording begins, from rest. */
GST_START_TEST (test_flush)
{
  Setup setup = set_up_good ("");
  GstBuffer *buffer;

  push (&setup, 0, 50);
  flush (&setup);
  begin_segment (&setup);
  while ((buffer = gst_harness_try_pull (setup.h)))
    gst_buffer_unref (buffer);
  push (&setup, 0, 20);
  for (guint frame = 0; frame < 20 - LATENCY; frame++) {
    buffer = gst_harness_pull (setup.h);
    fail_unless (fabs (lag (buffer, frame) - oscillator ((gdouble) frame /
                FPS)) < 0.0005);
    gst_buffer_unref (buffer);
  }
  tear_down (&setup);
}

GST_END_TEST;

static const struct
{
  const gchar *model, *take, *more, *text;
} refusals[] = {
  {NULL, "/take", "", "model"},
  {"/model.json", NULL, "", "location"},
  {"/none.json", "/take", "", "none.json"},
  {"/bad.json", "/take", "", "shear"},
  {"/model.json", "/none", "", "none"},
  {"/model.json", "/take", "fitted=/tmp/fitted.json", "no free numbers"},
  {"/model.json", "/take", "fitted=/nowhere/fitted.json", "can be written"},
  {"/model.json", "/take", "fitted=/", "is a folder"},
};

GST_START_TEST (test_refused)
{
  GstElement *element = make_element (refusals[__i__].model,
      refusals[__i__].take, refusals[__i__].more);
  g_autoptr (GstBus) bus = gst_bus_new ();
  Setup setup = { NULL, bus };

  gst_element_set_bus (element, bus);
  fail_unless_equals_int (gst_element_set_state (element, GST_STATE_PAUSED),
      GST_STATE_CHANGE_FAILURE);
  expect (&setup, GST_MESSAGE_ERROR, refusals[__i__].text);
  fail_unless (find_message (&setup, GST_MESSAGE_ERROR, NULL) == NULL);
  gst_element_set_state (element, GST_STATE_NULL);
  gst_element_set_bus (element, NULL);
  gst_object_unref (element);
}

GST_END_TEST;

static GstBuffer *
make_unseen (guint frame)
{
  gfloat places[3 * N];
  guint8 states[N] = { GST_CLOTH_VERTEX_UNSEEN };
  g_autoptr (GstClothMesh) mesh = NULL;
  GstBuffer *buffer;

  for (guint i = 0; i < 3 * N; i++)
    places[i] = NAN;
  mesh = gst_cloth_mesh_new (frame, N, places, states, NULL);
  buffer = gst_cloth_mesh_to_buffer (mesh);
  GST_BUFFER_PTS (buffer) = gst_util_uint64_scale (frame, GST_SECOND, FPS);
  return buffer;
}

/* Another cloth than the scene's, a stream that ends twice, one that shows nothing. */
GST_START_TEST (test_goes_wrong)
{
  g_autofree gchar *path = in_folder ("/fitted.json");
  g_autofree gchar *more = g_strconcat ("fitted=", path, NULL);
  GstBuffer *buffer;
  Setup setup = set_up ("/model.json", "/take", "");

  gst_harness_set_src_caps (setup.h, make_caps (COLUMNS + 1, ROWS, 0.1f, FPS));
  expect (&setup, GST_MESSAGE_ERROR, "not of the scene's cloth");
  /* once, though the caps come again before each of these */
  begin_segment (&setup);
  gst_harness_push_event (setup.h, gst_event_new_gap (0, GST_SECOND));
  gst_harness_push_event (setup.h, gst_event_new_eos ());
  fail_unless (find_message (&setup, GST_MESSAGE_ERROR, NULL) == NULL);
  tear_down (&setup);

  put_model ("free.json", ", \"free\": "
      "[{\"name\": \"damping.mass\", \"range\": [0, 5]}]");
  /* a second end is that of an empty stream */
  setup = set_up ("/free.json", "/take", more);
  gst_harness_set_src_caps (setup.h, make_caps (COLUMNS, ROWS, 0.1f, FPS));
  push (&setup, 0, N_FRAMES);
  gst_harness_push_event (setup.h, gst_event_new_eos ());
  fail_unless (find_message (&setup, GST_MESSAGE_ERROR, NULL) == NULL);
  g_remove (path);
  gst_harness_push_event (setup.h, gst_event_new_stream_start ("again"));
  begin_segment (&setup);
  gst_harness_push_event (setup.h, gst_event_new_eos ());
  expect (&setup, GST_MESSAGE_ERROR, "ended without a mesh");
  fail_unless (!g_file_test (path, G_FILE_TEST_EXISTS));
  tear_down (&setup);

  /* nothing was seen: the cloth is where the scene starts, and there is no fit */
  setup = set_up ("/free.json", "/take", more);
  gst_harness_set_src_caps (setup.h, make_caps (COLUMNS, ROWS, 0.1f, FPS));
  for (guint frame = 0; frame < 60; frame++)
    gst_harness_push (setup.h, make_unseen (frame));
  buffer = gst_harness_pull (setup.h);
  fail_unless (fabs (lag (buffer, 0)) < 1e-6);
  gst_buffer_unref (buffer);
  gst_harness_push_event (setup.h, gst_event_new_eos ());
  expect (&setup, GST_MESSAGE_ERROR, "Can't fit the model");
  fail_unless (!g_file_test (path, G_FILE_TEST_EXISTS));
  tear_down (&setup);
}

GST_END_TEST;

static void
remove_files (void)
{
  remove_all (folder);
  g_free (folder);
}

static Suite *
clothfit_suite (void)
{
  Suite *suite = suite_create ("clothfit");
  TCase *tc = tcase_create ("all");

  suite_add_tcase (suite, tc);
  tcase_add_checked_fixture (tc, make_files, remove_files);
  tcase_set_timeout (tc, 60);
  tcase_add_test (tc, test_closed_form);
  tcase_add_test (tc, test_gain);
  tcase_add_test (tc, test_hole);
  tcase_add_test (tc, test_outside);
  tcase_add_test (tc, test_fitted);
  tcase_add_test (tc, test_flush);
  tcase_add_loop_test (tc, test_refused, 0, G_N_ELEMENTS (refusals));
  tcase_add_test (tc, test_goes_wrong);
  return suite;
}

GST_CHECK_MAIN (clothfit);
