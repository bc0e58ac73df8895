/* triangulate: what must not become a mesh, and settings that can't be.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/elements/triangulatebench.h"

/* One camera has slipped by a square: the three others outvote it. */
GST_START_TEST (test_slipped_camera)
{
  Bench b;
  GstClothQuad quads[N_QUADS];
  g_autoptr (GstClothMesh) mesh = NULL;
  guint i;

  bench_init (&b, 4);
  for (i = 0; i < 3; i++) {
    push_seen (&b, i, i, 0, ALL, NULL);
  }
  see (&b, 3, 0, quads);
  for (i = 0; i < N_QUADS; i++) {
    quads[i].column = (quads[i].column + 1) % COLUMNS;
  }
  push (&b, 3, gst_cloth_quads_new (NULL, 0, COLUMNS, ROWS, quads, N_QUADS), 0);
  mesh = pull (&b, 0);
  fail_unless (check_all (mesh, 0, GST_CLOTH_VERTEX_MEASURED) < 1e-6);
  bench_clear (&b);
}

GST_END_TEST;

/* Neighbouring squares of one picture that put their common corner 5 px apart: that
 * camera has not seen that corner. */
GST_START_TEST (test_contradictory_corners)
{
  Bench b;
  GstClothQuad quads[N_QUADS];
  g_autoptr (GstClothMesh) mesh = NULL;
  const guint8 *states;
  guint i;

  bench_init (&b, 2);
  see (&b, 0, 0, quads);
  quads[0].x[2] += 5.0f;
  push (&b, 0, gst_cloth_quads_new (NULL, 0, COLUMNS, ROWS, quads, N_QUADS), 0);
  push_seen (&b, 1, 1, 0, ALL, NULL);
  mesh = pull (&b, 0);
  states = gst_cloth_mesh_get_states (mesh, NULL);
  for (i = 0; i < N_VERTICES; i++) {
    fail_unless_equals_int (states[i], i == COLUMNS + 2 ?
        GST_CLOTH_VERTEX_UNSEEN : GST_CLOTH_VERTEX_TWO_VIEWS);
  }
  bench_clear (&b);
}

GST_END_TEST;

/* The corners state 0.01 px²: a floor of 0.03 px² makes four times the covariance that no
 * floor does. */
GST_START_TEST (test_error_floor)
{
  Bench b;
  g_autoptr (GstClothMesh) without = NULL, with = NULL;
  const gfloat *small, *large;
  GstClothQuad quads[N_QUADS];
  guint i, round;

  bench_init (&b, 3);
  for (round = 0; round < 2; round++) {
    g_object_set (b.element, "error-floor", round ? 0.03 : 0.0, NULL);
    for (i = 0; i < 3; i++) {
      /* the same places in both */
      see (&b, i, 0, quads);
      push (&b, i, gst_cloth_quads_new (NULL, round, COLUMNS, ROWS, quads,
              N_QUADS), round);
    }
    *(round ? &with : &without) = pull (&b, round);
  }
  small = gst_cloth_mesh_get_covariances (without, NULL);
  large = gst_cloth_mesh_get_covariances (with, NULL);
  for (i = 0; i < 6 * N_VERTICES; i++) {
    fail_unless (fabsf (large[i] - 4.0f * small[i]) <=
        1e-5f * large[6 * (i / 6)]);
  }
  bench_clear (&b);
}

GST_END_TEST;

/* Places that are not finite and squares off the board do no harm. */
GST_START_TEST (test_bad_quads)
{
  Bench b;
  GstClothQuad quads[N_QUADS];
  g_autoptr (GstClothMesh) mesh = NULL;
  const guint8 *states;
  guint i, n = 0;

  bench_init (&b, 2);
  see (&b, 0, 0, quads);
  for (i = 0; i < N_QUADS; i++) {
    switch (i % 4) {
      case 0:
        quads[i].x[0] = quads[i].y[1] = NAN;
        break;
      case 1:
        quads[i].x[2] = INFINITY;
        break;
      case 2:
        quads[i].cov_xx[0] = -1.0f;
        quads[i].cov_xy[1] = NAN;
        break;
      default:
        break;
    }
  }
  push (&b, 0, gst_cloth_quads_new (NULL, 0, COLUMNS, ROWS, quads, N_QUADS), 0);
  push_seen (&b, 1, 1, 0, ALL, NULL);
  mesh = pull (&b, 0);
  states = gst_cloth_mesh_get_states (mesh, NULL);
  for (i = 0; i < N_VERTICES; i++) {
    n += states[i] == GST_CLOTH_VERTEX_TWO_VIEWS;
  }
  /* most corners are also those of a good square */
  fail_unless (n > N_VERTICES / 2 && n < N_VERTICES, "%u", n);
  bench_clear (&b);
}

GST_END_TEST;

/* Squares that no board has, of states that there are not, are left alone. */
GST_START_TEST (test_wild_quads)
{
  static const gint wild[] = { -1, G_MININT, G_MAXINT, COLUMNS, 65536 };
  enum
  { N_WILD = G_N_ELEMENTS (wild) };
  Bench b;
  GstClothQuad quads[N_QUADS + 3 * N_WILD];
  guint i, k;

  bench_init (&b, 2);
  for (i = 0; i < 2; i++) {
    see (&b, i, 0, quads);
    for (k = 0; k < 3 * N_WILD; k++) {
      GstClothQuad *q = &quads[N_QUADS + k];

      *q = quads[k];
      q->x[0] += 50;
      q->y[2] = 1e30f;
      if (k < N_WILD) {
        q->column = wild[k];
      } else if (k < 2 * N_WILD) {
        q->row = wild[k - N_WILD];
      } else {
        q->state = (GstClothQuadState) (k == 2 * N_WILD ? -1 : 99 + (gint) k);
      }
    }
    push (&b, i, gst_cloth_quads_new (NULL, 0, COLUMNS, ROWS, quads,
            G_N_ELEMENTS (quads)), 0);
  }
  expect_all (&b, 0, GST_CLOTH_VERTEX_TWO_VIEWS);
  bench_clear (&b);
}

GST_END_TEST;

/* Everything that is the user's to mend stops the element, and the error names it. */
static void
refuse_to_start (const gchar * property, const gchar * value,
    const gchar * text)
{
  Bench b;

  bench_open (&b, 2);
  g_object_set (b.element, property, value, NULL);
  fail_unless_equals_int (gst_element_set_state (b.element, GST_STATE_PAUSED),
      GST_STATE_CHANGE_FAILURE);
  expect_message (&b, GST_MESSAGE_ERROR, text);
  bench_clear (&b);
}

GST_START_TEST (test_no_calibration)
{
  refuse_to_start ("rig", NULL, "rig is not set");
  refuse_to_start ("rig", "/nonexistent/rig.json", "rig.json");
  refuse_to_start ("pattern", NULL, "pattern is not set");
  refuse_to_start ("pattern", "/nonexistent/pattern.json", "pattern.json");
  /* a file of another kind */
  refuse_to_start ("rig", TEST_DATA "/checker_pair/pattern.json", "cameras");
  refuse_to_start ("pattern", TEST_DATA "/checker_pair/rig.json",
      "pattern could not be read");
}

GST_END_TEST;

GST_START_TEST (test_one_camera)
{
  Bench b;

  bench_open (&b, 1);
  fail_unless_equals_int (gst_element_set_state (b.element, GST_STATE_PAUSED),
      GST_STATE_CHANGE_FAILURE);
  expect_message (&b, GST_MESSAGE_ERROR, "2 to 64 cameras");
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_wrong_camera_count)
{
  Bench b;

  /* fewer pads than cameras and no names */
  bench_open (&b, 3);
  bench_link (&b, 2, FALSE, VIDEO);
  push_all (&b, 0);
  expect_error (&b, "2 sink pads for 3 cameras");
  bench_clear (&b);

  bench_open (&b, 2);
  bench_link (&b, 2, FALSE, VIDEO);
  b.n_pads = 3;
  b.in[2] = gst_harness_new_with_element (b.element, "sink_2", NULL);
  gst_harness_set_src_caps_str (b.in[2], VIDEO);
  {
    guint i;

    for (i = 0; i < 3; i++) {
      push_seen (&b, i, 0, 0, ALL, NULL);
    }
  }
  expect_error (&b, "rig has 2 cameras");
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_unknown_camera)
{
  Bench b;

  bench_init (&b, 2);
  push_seen (&b, 0, 0, 0, ALL, "left");
  push_seen (&b, 1, 1, 0, ALL, "cam1");
  expect_error (&b, "camera \"left\"");
  bench_clear (&b);

  bench_init (&b, 2);
  gst_child_proxy_set (GST_CHILD_PROXY (b.element), "sink_1::camera", "right",
      NULL);
  push_all (&b, 0);
  expect_error (&b, "camera \"right\"");
  bench_clear (&b);

  bench_init (&b, 2);
  push_seen (&b, 0, 0, 0, ALL, "cam1");
  push_seen (&b, 1, 1, 0, ALL, "cam1");
  expect_error (&b, "both of camera \"cam1\"");
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_wrong_size)
{
  Bench b;

  /* each with what helps, and never what would not */
  static const struct
  {
    const gchar *size, *hint;
    gboolean scale;
  } cases[] = {
    {"width=640,height=360", "videoscale after the detector", TRUE},
    {"width=640,height=480", "can't be scaled", FALSE},
    {"width=720,height=1280", "videoflip video-direction=auto before", FALSE}
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autofree gchar *caps = g_strconcat ("video/x-raw,format=GRAY8,",
        cases[i].size, ",framerate=25/1", NULL);
    g_autoptr (GstMessage) message = NULL;
    g_autoptr (GError) error = NULL;
    g_autofree gchar *debug = NULL;

    bench_init (&b, 2);
    gst_harness_set_src_caps_str (b.in[1], caps);
    push_all (&b, 0);
    message = gst_bus_timed_pop_filtered (b.bus, 10 * GST_SECOND,
        GST_MESSAGE_ERROR);
    fail_unless (message != NULL);
    gst_message_parse_error (message, &error, &debug);
    fail_unless (strstr (error->message, "on sink_1 are") && strstr (debug,
            cases[i].hint), "%s (%s)", error->message, debug);
    fail_unless (!strstr (debug, "videoscale") == !cases[i].scale, "%s", debug);
    fail_unless (gst_harness_try_pull (b.src) == NULL);
    bench_clear (&b);
  }
}

GST_END_TEST;

GST_START_TEST (test_wrong_board)
{
  Bench b;
  GstClothQuad quads[N_QUADS];

  bench_init (&b, 2);
  see (&b, 0, 0, quads);
  push (&b, 0, gst_cloth_quads_new (NULL, 0, 8, 8, quads, N_QUADS), 0);
  push_seen (&b, 1, 1, 0, ALL, NULL);
  expect_error (&b, "8×8");
  bench_clear (&b);
}

GST_END_TEST;

static Suite *
triangulateinput_suite (void)
{
  Suite *s = suite_create ("triangulateinput");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, test_slipped_camera);
  tcase_add_test (tc, test_contradictory_corners);
  tcase_add_test (tc, test_error_floor);
  tcase_add_test (tc, test_bad_quads);
  tcase_add_test (tc, test_wild_quads);
  tcase_add_test (tc, test_no_calibration);
  tcase_add_test (tc, test_one_camera);
  tcase_add_test (tc, test_wrong_camera_count);
  tcase_add_test (tc, test_unknown_camera);
  tcase_add_test (tc, test_wrong_size);
  tcase_add_test (tc, test_wrong_board);
  return s;
}

GST_CHECK_MAIN (triangulateinput);
