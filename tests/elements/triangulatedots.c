/* triangulate: from the dots of an M-array that up to 16 cameras see from both sides to a
 * mesh.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/elements/triangulatebench.h"

#include "gst/pattern/marray.h"

/* A dot for each vertex of the sheet that the other tests film; so small that the sheet is
 * flat inside it. */
#define DOT_COLUMNS (COLUMNS + 1)
#define DOT_ROWS (ROWS + 1)

static void
dots_open (Bench * b, guint n_cameras)
{
  const ClothMArrayCode code = CLOTH_M_ARRAY_CODE_INIT;
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothMArray) array = cloth_m_array_new (DOT_COLUMNS, DOT_ROWS, 5,
      SQUARE, 0.001, 0.03, &code, &error);

  g_assert_no_error (error);
  bench_open (b, n_cameras);
  cloth_m_array_save (array, b->pattern_path, &error);
  g_assert_no_error (error);
}

static void
dots_init (Bench * b, guint n_cameras)
{
  dots_open (b, n_cameras);
  bench_link (b, n_cameras, FALSE, VIDEO);
}

/* What a camera sees of all dots: those beyond a quarter turn see them from behind. */
static void
see_dots (Bench * b, guint camera, guint frame, GstClothDot dots[N_VERTICES])
{
  memset (dots, 0, N_VERTICES * sizeof *dots);
  for (guint i = 0; i < N_VERTICES; i++) {
    gdouble X[3], px[2];

    truth (i, frame, X);
    fail_unless (cloth_camera_project (&b->rig->cameras[camera], X, px, NULL,
            NULL));
    dots[i].column = (gint) (i % DOT_COLUMNS);
    dots[i].row = (gint) (i / DOT_COLUMNS);
    dots[i].mirrored = b->rig->cameras[camera].R[7] < 0;
    dots[i].confidence = 20;
    dots[i].x = (gfloat) px[0];
    dots[i].y = (gfloat) px[1];
    dots[i].cov_xx = dots[i].cov_yy = 0.01f;
  }
}

static void
push_dots (Bench * b, guint pad, const GstClothDot * dots, guint n, guint frame)
{
  GstBuffer *buffer = picture (NULL, frame);

  gst_buffer_add_cloth_dots_meta (buffer, gst_cloth_dots_new (NULL, frame,
          DOT_COLUMNS, DOT_ROWS, 5, dots, n));
  fail_unless_equals_int (gst_harness_push (b->in[pad], buffer), GST_FLOW_OK);
}

static void
push_all_dots (Bench * b, guint frame)
{
  for (guint i = 0; i < b->n_pads; i++) {
    GstClothDot dots[N_VERTICES];

    see_dots (b, i, frame, dots);
    push_dots (b, i, dots, N_VERTICES, frame);
  }
}

/* How far the vertex is from where it was, in metres; NaN when unseen. */
static gdouble
error_of (GstClothMesh * mesh, guint vertex, guint frame)
{
  const gfloat *p = gst_cloth_mesh_get_positions (mesh, NULL) + 3 * vertex;
  gdouble X[3];

  truth (vertex, frame, X);
  return sqrt (pow (p[0] - X[0], 2) + pow (p[1] - X[1], 2) + pow (p[2] - X[2],
          2));
}

static void
expect_dots (Bench * b, guint frame)
{
  g_autoptr (GstClothMesh) mesh = pull (b, frame);
  const guint8 *states = gst_cloth_mesh_get_states (mesh, NULL);

  for (guint i = 0; i < N_VERTICES; i++) {
    fail_unless_equals_int (states[i], GST_CLOTH_VERTEX_MEASURED);
    fail_unless (error_of (mesh, i, frame) < 1e-6, "%g", error_of (mesh, i,
            frame));
  }
}

/* All around the sheet: the cameras of the one side and of the other see the same
 * vertices, which lie at origin + pitch on the flat cloth. */
GST_START_TEST (test_ring)
{
  static const guint n_cameras[] = { 3, 8, 16 };

  for (guint k = 0; k < G_N_ELEMENTS (n_cameras); k++) {
    Bench b;

    dots_init (&b, n_cameras[k]);
    for (guint frame = 0; frame < 3; frame++) {
      push_all_dots (&b, frame);
      expect_dots (&b, frame);
    }
    {
      g_autoptr (GstCaps) caps = gst_pad_get_current_caps (b.src->sinkpad);
      g_autoptr (GError) error = NULL;
      g_autoptr (GstClothTopology) topology =
          gst_cloth_topology_from_caps (caps, &error);
      const gfloat *uv;

      g_assert_no_error (error);
      fail_unless_equals_int (gst_cloth_topology_get_columns (topology),
          DOT_COLUMNS);
      fail_unless_equals_int (gst_cloth_topology_get_rows (topology), DOT_ROWS);
      uv = gst_cloth_topology_get_uv (topology, NULL);
      /* the margin of 30 mm; then the third dot of the second row */
      fail_unless (fabs (uv[0] - 0.03) < 1e-6 && fabs (uv[1] - 0.03) < 1e-6);
      fail_unless (fabs (uv[2 * (DOT_COLUMNS + 2)] - 0.11) < 1e-6);
      fail_unless (fabs (uv[2 * (DOT_COLUMNS + 2) + 1] - 0.07) < 1e-6);
    }
    bench_clear (&b);
  }
}

GST_END_TEST;

/* The same as observation streams, without pixels. */
GST_START_TEST (test_observation_streams)
{
  Bench b;

  dots_open (&b, 8);
  bench_link (&b, 8, FALSE, OBSERVATIONS);
  for (guint i = 0; i < 8; i++) {
    g_autoptr (GstBuffer) buffer = picture (NULL, 0);
    GstClothDot dots[N_VERTICES];

    see_dots (&b, i, 0, dots);
    gst_buffer_add_cloth_dots_meta (buffer, gst_cloth_dots_new (NULL, 0,
            DOT_COLUMNS, DOT_ROWS, 5, dots, N_VERTICES));
    fail_unless_equals_int (gst_harness_push (b.in[i],
            gst_cloth_observations_pack (buffer)), GST_FLOW_OK);
  }
  expect_dots (&b, 0);
  bench_clear (&b);
}

GST_END_TEST;

/* One camera gives two dots each other's label: it is left out there, and nowhere else. */
GST_START_TEST (test_wrong_labels)
{
  Bench b;
  GstClothDot dots[N_VERTICES];

  dots_init (&b, 8);
  for (guint i = 0; i < 8; i++) {
    see_dots (&b, i, 0, dots);
    if (i == 3) {
      dots[9].column++;
      dots[10].column--;
    }
    push_dots (&b, i, dots, N_VERTICES, 0);
  }
  expect_dots (&b, 0);
  bench_clear (&b);
}

GST_END_TEST;

/* A label given to two dots of a picture, dots without one, dots that touch, labels that
 * there are not, places that are not finite: that camera has not seen them. */
GST_START_TEST (test_unusable)
{
  Bench b;
  g_autoptr (GstClothMesh) mesh = NULL;
  const guint8 *states;
  GstClothDot dots[N_VERTICES];

  dots_init (&b, 2);
  see_dots (&b, 0, 0, dots);
  dots[1].column = 0;           /* as dots[0]: both are lost */
  dots[2].column = dots[2].row = -1;
  dots[3].touches = TRUE;
  dots[4].column = DOT_COLUMNS;
  dots[5].row = G_MAXINT;
  dots[6].x = NAN;
  dots[7].cov_xx = -1;
  dots[8].y = INFINITY;
  push_dots (&b, 0, dots, N_VERTICES, 0);
  see_dots (&b, 1, 0, dots);
  push_dots (&b, 1, dots, N_VERTICES, 0);
  mesh = pull (&b, 0);
  states = gst_cloth_mesh_get_states (mesh, NULL);
  for (guint i = 0; i < N_VERTICES; i++)
    fail_unless_equals_int (states[i], i <= 8 ? GST_CLOTH_VERTEX_UNSEEN :
        GST_CLOTH_VERTEX_TWO_VIEWS);
  bench_clear (&b);
}

GST_END_TEST;

/* Two of a dot's neighbours are not seen by one camera, as at a fold's edge: neither is the
 * dot itself, which a fold may partly hide. One missing neighbour is no fold. */
GST_START_TEST (test_fold)
{
  const guint dot = 2 * DOT_COLUMNS + 3;
  Bench b;

  for (guint n_missing = 1; n_missing <= 2; n_missing++) {
    g_autoptr (GstClothMesh) mesh = NULL;
    GstClothDot dots[N_VERTICES];

    dots_init (&b, 2);
    see_dots (&b, 0, 0, dots);
    dots[dot + 1].column = dots[dot + 1].row = -1;
    if (n_missing == 2)
      dots[dot - DOT_COLUMNS].touches = TRUE;
    push_dots (&b, 0, dots, N_VERTICES, 0);
    see_dots (&b, 1, 0, dots);
    push_dots (&b, 1, dots, N_VERTICES, 0);
    mesh = pull (&b, 0);
    fail_unless_equals_int (gst_cloth_mesh_get_states (mesh, NULL)[dot],
        n_missing == 2 ? GST_CLOTH_VERTEX_UNSEEN : GST_CLOTH_VERTEX_TWO_VIEWS);
    bench_clear (&b);
  }
}

GST_END_TEST;

/* A tripod was kicked by 5 cm: said once, with the camera's name, also for programs. The
 * mesh stays where it was. */
GST_START_TEST (test_camera_off)
{
  Bench b;
  g_autoptr (GstMessage) message = NULL;
  g_autoptr (GError) error = NULL;
  const GstStructure *details = NULL;

  dots_init (&b, 8);
  b.rig->cameras[5].t[0] += 0.05;
  for (guint frame = 0; frame < 30; frame++) {
    GstClothDot dots[N_VERTICES];
    g_autoptr (GstClothMesh) mesh = NULL;

    for (guint i = 0; i < 8; i++) {
      see_dots (&b, i, 0, dots);
      push_dots (&b, i, dots, N_VERTICES, frame);
    }
    mesh = pull (&b, frame);
    for (guint i = 0; i < N_VERTICES; i++)
      fail_unless (error_of (mesh, i, 0) < 1e-6);
  }
  message = gst_bus_pop_filtered (b.bus, GST_MESSAGE_WARNING);
  fail_unless (message != NULL);
  gst_message_parse_warning (message, &error, NULL);
  gst_message_parse_warning_details (message, &details);
  fail_unless (strstr (error->message, "Camera \"cam5\"") != NULL);
  fail_unless (details != NULL);
  fail_unless_equals_string (gst_structure_get_string (details, "camera"),
      "cam5");
  fail_unless (gst_bus_pop_filtered (b.bus, GST_MESSAGE_WARNING) == NULL);
  bench_clear (&b);
}

GST_END_TEST;

static void
push_dots_of (Bench * b, guint camera, guint frame)
{
  GstClothDot dots[N_VERTICES];

  see_dots (b, camera, frame % 3, dots);
  push_dots (b, camera, dots, N_VERTICES, frame);
}

/* All vertices where they were; @n_views cameras saw each. */
static void
expect_views (Bench * b, guint frame, guint n_views)
{
  g_autoptr (GstClothMesh) mesh = pull (b, frame);
  const guint8 *states = gst_cloth_mesh_get_states (mesh, NULL);

  for (guint i = 0; i < N_VERTICES; i++) {
    fail_unless_equals_int (states[i], n_views < 2 ? GST_CLOTH_VERTEX_UNSEEN :
        n_views == 2 ? GST_CLOTH_VERTEX_TWO_VIEWS : GST_CLOTH_VERTEX_MEASURED);
    fail_unless (n_views < 2 || error_of (mesh, i, frame % 3) < 2e-6,
        "frame %u, %u views: %g", frame, n_views, error_of (mesh, i,
            frame % 3));
  }
}

/* A camera without pictures for two seconds: the others go on, and one that is left alone
 * sees nothing in space; when it is back all is as before. */
GST_START_TEST (test_missing_camera)
{
  static const guint n_cameras[] = { 2, 4, 8 };

  for (guint k = 0; k < G_N_ELEMENTS (n_cameras); k++) {
    const guint n = n_cameras[k];
    Bench b;

    dots_init (&b, n);
    push_all_dots (&b, 0);
    expect_views (&b, 0, n);
    push_dots_of (&b, 1, 51);   /* its next picture */
    for (guint frame = 1; frame <= 51; frame++) {
      for (guint i = 0; i < n; i++)
        if (i != 1)
          push_dots_of (&b, i, frame);
      expect_views (&b, frame, frame == 51 ? n : n - 1);
    }
    fail_unless (gst_bus_pop_filtered (b.bus, GST_MESSAGE_ERROR) == NULL);
    bench_clear (&b);
  }
}

GST_END_TEST;

/* Films of unequal length: the mesh goes on for as long as any film does. */
GST_START_TEST (test_unequal_length)
{
  static const guint n_cameras[] = { 2, 8 };

  for (guint k = 0; k < G_N_ELEMENTS (n_cameras); k++) {
    const guint n = n_cameras[k];
    Bench b;
    guint n_ended = 0;

    dots_init (&b, n);
    /* camera i has 3 + 2 i pictures */
    for (guint frame = 0; n_ended < n; frame++) {
      for (guint i = n_ended; i < n; i++)
        push_dots_of (&b, i, frame);
      expect_views (&b, frame, n - n_ended);
      if (frame == 2 + 2 * n_ended)
        fail_unless (gst_harness_push_event (b.in[n_ended++],
                gst_event_new_eos ()));
    }
    fail_unless (gst_harness_try_pull (b.src) == NULL);
    {
      gboolean ended = FALSE;
      GstEvent *event;

      while ((event = gst_harness_try_pull_event (b.src))) {
        ended |= GST_EVENT_TYPE (event) == GST_EVENT_EOS;
        gst_event_unref (event);
      }
      for (guint i = 0; i < 200 && !ended; i++) {
        g_usleep (10000);
        event = gst_harness_try_pull_event (b.src);
        ended = event && GST_EVENT_TYPE (event) == GST_EVENT_EOS;
        g_clear_pointer (&event, gst_event_unref);
      }
      fail_unless (ended);
    }
    fail_unless (gst_bus_pop_filtered (b.bus, GST_MESSAGE_ERROR) == NULL);
    bench_clear (&b);
  }
}

GST_END_TEST;

/* One of eight cameras films at half the rate: it takes part in every second mesh. */
GST_START_TEST (test_unequal_rate)
{
  static const gchar slow[] =
      "video/x-raw,format=GRAY8,width=1280,height=720,framerate=25/2";
  static const guint n_cameras[] = { 2, 3, 8 };

  for (guint k = 0; k < G_N_ELEMENTS (n_cameras); k++) {
    const guint n = n_cameras[k];
    Bench b;

    dots_init (&b, n);
    gst_harness_set_src_caps_str (b.in[1], slow);
    push_dots_of (&b, 1, 0);
    for (guint frame = 0; frame < 12; frame++) {
      for (guint i = 0; i < n; i++)
        if (i != 1)
          push_dots_of (&b, i, frame);
      expect_views (&b, frame, frame % 2 == 0 ? n : n - 1);
      if (frame % 2 == 0)
        push_dots_of (&b, 1, frame + 2);        /* the next one */
    }
    fail_unless (gst_bus_pop_filtered (b.bus, GST_MESSAGE_ERROR) == NULL);
    bench_clear (&b);
  }
}

GST_END_TEST;

GST_START_TEST (test_wrong_pattern)
{
  Bench b;
  GstClothDot dots[N_VERTICES];
  GstClothQuad quads[N_QUADS];
  GstBuffer *buffer;

  /* dots of another array */
  dots_init (&b, 2);
  see_dots (&b, 1, 0, dots);
  push_dots (&b, 1, dots, N_VERTICES, 0);
  buffer = picture (NULL, 0);
  gst_buffer_add_cloth_dots_meta (buffer, gst_cloth_dots_new (NULL, 0, 31, 33,
          5, NULL, 0));
  gst_harness_push (b.in[0], buffer);
  expect_error (&b, "31×33");
  bench_clear (&b);

  /* squares, where the pattern is of dots */
  dots_init (&b, 2);
  see_dots (&b, 1, 0, dots);
  push_dots (&b, 1, dots, N_VERTICES, 0);
  see (&b, 0, 0, quads);
  gst_harness_push (b.in[0], picture (gst_cloth_quads_new (NULL, 0, COLUMNS,
              ROWS, quads, N_QUADS), 0));
  expect_error (&b, "sink_0 carry squares, but pattern has dots");
  bench_clear (&b);

  /* dots, where it is a board */
  bench_init (&b, 2);
  see_dots (&b, 1, 0, dots);
  push_dots (&b, 1, dots, N_VERTICES, 0);
  push_dots (&b, 0, dots, N_VERTICES, 0);
  expect_error (&b, "carry dots, but pattern has squares");
  bench_clear (&b);
}

GST_END_TEST;

/* Nobody labels dots: said once, with the element to put there. */
GST_START_TEST (test_no_detector)
{
  Bench b;

  dots_init (&b, 2);
  for (guint frame = 0; frame < 30; frame++) {
    push (&b, 0, NULL, frame);
    push (&b, 1, NULL, frame);
    expect_all (&b, frame, GST_CLOTH_VERTEX_UNSEEN);
  }
  expect_message (&b, GST_MESSAGE_WARNING, "dotlabel");
  bench_clear (&b);
}

GST_END_TEST;

static Suite *
triangulatedots_suite (void)
{
  Suite *s = suite_create ("triangulatedots");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, test_ring);
  tcase_add_test (tc, test_observation_streams);
  tcase_add_test (tc, test_wrong_labels);
  tcase_add_test (tc, test_unusable);
  tcase_add_test (tc, test_fold);
  tcase_add_test (tc, test_camera_off);
  tcase_add_test (tc, test_missing_camera);
  tcase_add_test (tc, test_unequal_length);
  tcase_add_test (tc, test_unequal_rate);
  tcase_add_test (tc, test_wrong_pattern);
  tcase_add_test (tc, test_no_detector);
  return s;
}

GST_CHECK_MAIN (triangulatedots);
