/* triangulate: from the grid that several cameras find on any print to a mesh.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/elements/triangulatebench.h"

#include "gst/pattern/picture.h"

/* A grid of as many vertices as the board of the other tests, in cells that are higher than
 * wide. */
#define PRINT_COLUMNS (COLUMNS + 1)
#define PRINT_ROWS (ROWS + 1)
#define ROW 0.052

/* Where vertex i is at a time: on a flat sheet, for triangulate can't know how bending is spread
 * between vertices (test reconstruct). */
static void
print_truth (guint i, guint frame, gdouble X[3])
{
  const gdouble u = (i % PRINT_COLUMNS) * SQUARE, v = (i / PRINT_COLUMNS) * ROW;

  X[0] = u - 0.12 + 0.01 * frame;
  X[1] = 0.01 * frame + 0.25 * u + 0.2 * v;
  X[2] = 1.1 - v;
}

static void
print_open (Bench * b, guint n_cameras)
{
  static const gdouble cloth_m[2] = { COLUMNS * SQUARE, ROWS * ROW };
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothPicturePattern) pattern = NULL;
  g_autofree gchar *reference = NULL;

  bench_open (b, n_cameras);
  reference = g_build_filename (b->folder, "reference.png", NULL);
  /* siftmatch looks at it, triangulate doesn't */
  g_assert_true (g_file_set_contents (reference, "", 0, NULL));
  pattern = cloth_picture_pattern_new (reference, cloth_m, PRINT_COLUMNS,
      PRINT_ROWS, 2, &error);
  g_assert_no_error (error);
  cloth_picture_pattern_save (pattern, b->pattern_path, &error);
  g_assert_no_error (error);
}

static void
print_init (Bench * b, guint n_cameras)
{
  print_open (b, n_cameras);
  bench_link (b, n_cameras, FALSE, VIDEO);
}

static void
print_clear (Bench * b)
{
  g_autofree gchar *reference =
      g_build_filename (b->folder, "reference.png", NULL);

  g_remove (reference);
  bench_clear (b);
}

/* What a camera sees of all vertices: those beyond a quarter turn see them from behind. */
static void
see_points (Bench * b, guint camera, guint frame,
    GstClothGridPoint points[N_VERTICES])
{
  memset (points, 0, N_VERTICES * sizeof *points);
  for (guint i = 0; i < N_VERTICES; i++) {
    gdouble X[3], px[2];

    print_truth (i, frame, X);
    fail_unless (cloth_camera_project (&b->rig->cameras[camera], X, px, NULL,
            NULL));
    points[i].column = (gint) (i % PRINT_COLUMNS);
    points[i].row = (gint) (i / PRINT_COLUMNS);
    points[i].mirrored = b->rig->cameras[camera].R[7] < 0;
    points[i].x = (gfloat) px[0];
    points[i].y = (gfloat) px[1];
    points[i].cov_xx = points[i].cov_yy = 0.01f;
  }
}

static GstBuffer *
carry (const gchar * camera, const GstClothGridPoint * points, guint n,
    guint frame)
{
  /* a match that no vertex comes from */
  const GstClothMatch match = {.x = 3,.y = 4,.u = 0.1f,.v = 0.1f,.scale = 2 };
  GstBuffer *buffer = picture (NULL, frame);

  gst_buffer_add_cloth_matches_meta (buffer, gst_cloth_matches_new (camera,
          frame, PRINT_COLUMNS, PRINT_ROWS, 9, FALSE, &match, 1, points, n));
  return buffer;
}

static void
push_points (Bench * b, guint pad, const GstClothGridPoint * points, guint n,
    guint frame)
{
  fail_unless_equals_int (gst_harness_push (b->in[pad], carry (NULL, points, n,
              frame)), GST_FLOW_OK);
}

/* Each vertex is where it was. */
static void
expect_points (Bench * b, guint frame, GstClothVertexState state)
{
  g_autoptr (GstClothMesh) mesh = pull (b, frame);
  const guint8 *states = gst_cloth_mesh_get_states (mesh, NULL);
  const gfloat *p = gst_cloth_mesh_get_positions (mesh, NULL);

  for (guint i = 0; i < N_VERTICES; i++) {
    gdouble X[3], error;

    print_truth (i, frame, X);
    error = sqrt (pow (p[3 * i] - X[0], 2) + pow (p[3 * i + 1] - X[1], 2)
        + pow (p[3 * i + 2] - X[2], 2));
    fail_unless_equals_int (states[i], state);
    fail_unless (state == GST_CLOTH_VERTEX_UNSEEN || error < 2e-6, "%g", error);
  }
}

/* All around the print: the cameras of the one side and of the other see the same vertices;
 * their uv go from edge to edge of the picture. */
GST_START_TEST (test_ring)
{
  static const guint n_cameras[] = { 2, 3, 8, 16 };

  for (guint k = 0; k < G_N_ELEMENTS (n_cameras); k++) {
    g_autoptr (GstCaps) caps = NULL;
    g_autoptr (GError) error = NULL;
    g_autoptr (GstClothTopology) topology = NULL;
    const gfloat *uv;
    Bench b;

    print_init (&b, n_cameras[k]);
    for (guint frame = 0; frame < 3; frame++) {
      for (guint i = 0; i < n_cameras[k]; i++) {
        GstClothGridPoint points[N_VERTICES];

        see_points (&b, i, frame, points);
        push_points (&b, i, points, N_VERTICES, frame);
      }
      expect_points (&b, frame, n_cameras[k] == 2 ? GST_CLOTH_VERTEX_TWO_VIEWS :
          GST_CLOTH_VERTEX_MEASURED);
    }
    caps = gst_pad_get_current_caps (b.src->sinkpad);
    topology = gst_cloth_topology_from_caps (caps, &error);
    g_assert_no_error (error);
    fail_unless_equals_int (gst_cloth_topology_get_columns (topology),
        PRINT_COLUMNS);
    fail_unless_equals_int (gst_cloth_topology_get_rows (topology), PRINT_ROWS);
    uv = gst_cloth_topology_get_uv (topology, NULL);
    fail_unless (uv[0] == 0 && uv[1] == 0);
    /* the third vertex of the second row, and the last one: 6 by 5 cells */
    fail_unless (fabs (uv[2 * (PRINT_COLUMNS + 2)] - 0.08) < 1e-7);
    fail_unless (fabs (uv[2 * (PRINT_COLUMNS + 2) + 1] - 0.052) < 1e-7);
    fail_unless (fabs (uv[2 * N_VERTICES - 2] - 0.24) < 1e-7);
    fail_unless (fabs (uv[2 * N_VERTICES - 1] - 0.26) < 1e-7);
    print_clear (&b);
  }
}

GST_END_TEST;

/* The same as observation streams, without pixels. */
GST_START_TEST (test_observation_streams)
{
  Bench b;

  print_open (&b, 3);
  bench_link (&b, 3, FALSE, OBSERVATIONS);
  for (guint i = 0; i < 3; i++) {
    g_autoptr (GstBuffer) buffer = NULL;
    GstClothGridPoint points[N_VERTICES];

    see_points (&b, i, 0, points);
    /* in the pads' reverse order: the names count */
    buffer = carry (b.rig->cameras[i].name, points, N_VERTICES, 0);
    fail_unless_equals_int (gst_harness_push (b.in[2 - i],
            gst_cloth_observations_pack (buffer)), GST_FLOW_OK);
  }
  expect_points (&b, 0, GST_CLOTH_VERTEX_MEASURED);
  print_clear (&b);
}

GST_END_TEST;

/* Vertices that there are not or twice, places that are not finite: that camera has not seen
 * them; nor those that it doesn't list. */
GST_START_TEST (test_unusable)
{
  Bench b;
  g_autoptr (GstClothMesh) mesh = NULL;
  const guint8 *states;
  GstClothGridPoint points[N_VERTICES];

  print_init (&b, 2);
  see_points (&b, 0, 0, points);
  points[1].column = 0;         /* as points[0], elsewhere: both are lost */
  points[2].column = points[2].row = -1;
  points[3].column = PRINT_COLUMNS;
  points[4].row = G_MAXINT;
  points[5].x = NAN;
  points[6].cov_xx = -1;
  points[7].y = INFINITY;
  push_points (&b, 0, points, N_VERTICES - 1, 0);
  see_points (&b, 1, 0, points);
  push_points (&b, 1, points, N_VERTICES, 0);
  mesh = pull (&b, 0);
  states = gst_cloth_mesh_get_states (mesh, NULL);
  for (guint i = 0; i < N_VERTICES; i++)
    fail_unless_equals_int (states[i], i <= 7 || i == N_VERTICES - 1 ?
        GST_CLOTH_VERTEX_UNSEEN : GST_CLOTH_VERTEX_TWO_VIEWS);
  print_clear (&b);
}

GST_END_TEST;

/* One camera takes two vertices for each other: it is left out there, and nowhere else. */
GST_START_TEST (test_wrong_places)
{
  Bench b;

  print_init (&b, 8);
  for (guint i = 0; i < 8; i++) {
    GstClothGridPoint points[N_VERTICES];

    see_points (&b, i, 0, points);
    if (i == 3) {
      points[9].column++;
      points[10].column--;
    }
    push_points (&b, i, points, N_VERTICES, 0);
  }
  expect_points (&b, 0, GST_CLOTH_VERTEX_MEASURED);
  print_clear (&b);
}

GST_END_TEST;

/* Matches of which no vertex could be made. */
GST_START_TEST (test_no_points)
{
  Bench b;

  print_init (&b, 2);
  push_points (&b, 0, NULL, 0, 0);
  push_points (&b, 1, NULL, 0, 0);
  expect_points (&b, 0, GST_CLOTH_VERTEX_UNSEEN);
  print_clear (&b);
}

GST_END_TEST;

/* A picture that carries dots too is of the print. */
GST_START_TEST (test_with_dots)
{
  Bench b;

  print_init (&b, 3);
  for (guint i = 0; i < 3; i++) {
    GstClothGridPoint points[N_VERTICES];
    GstBuffer *buffer;

    see_points (&b, i, 0, points);
    buffer = carry (NULL, points, N_VERTICES, 0);
    gst_buffer_add_cloth_dots_meta (buffer, gst_cloth_dots_new ("other", 7, 31,
            33, 5, NULL, 0));
    fail_unless_equals_int (gst_harness_push (b.in[i], buffer), GST_FLOW_OK);
  }
  expect_points (&b, 0, GST_CLOTH_VERTEX_MEASURED);
  print_clear (&b);
}

GST_END_TEST;

/* Kinds and sizes that are not the pattern's: what is there is named, and what to do. */
GST_START_TEST (test_wrong_pattern)
{
  Bench b;
  GstClothGridPoint points[N_VERTICES];
  GstClothQuad quads[N_QUADS];
  GstBuffer *buffer;

  /* matches of another grid */
  print_init (&b, 2);
  see_points (&b, 1, 0, points);
  push_points (&b, 1, points, N_VERTICES, 0);
  buffer = picture (NULL, 0);
  gst_buffer_add_cloth_matches_meta (buffer, gst_cloth_matches_new (NULL, 0, 35,
          33, 0, FALSE, NULL, 0, NULL, 0));
  gst_harness_push (b.in[0], buffer);
  expect_error (&b, "matches on sink_0 are of a pattern of 35×33, but pattern "
      "has 7×6");
  print_clear (&b);

  /* squares, where it is a picture */
  print_init (&b, 2);
  push_points (&b, 1, points, N_VERTICES, 0);
  see (&b, 0, 0, quads);
  gst_harness_push (b.in[0], picture (gst_cloth_quads_new (NULL, 0, COLUMNS,
              ROWS, quads, N_QUADS), 0));
  expect_error (&b, "sink_0 carry squares, but pattern has matches");
  print_clear (&b);

  /* dots, where it is a picture */
  print_init (&b, 2);
  push_points (&b, 1, points, N_VERTICES, 0);
  buffer = picture (NULL, 0);
  gst_buffer_add_cloth_dots_meta (buffer, gst_cloth_dots_new (NULL, 0,
          PRINT_COLUMNS, PRINT_ROWS, 5, NULL, 0));
  gst_harness_push (b.in[0], buffer);
  expect_error (&b, "sink_0 carry dots, but pattern has matches");
  print_clear (&b);

  /* matches, where it is a board */
  bench_init (&b, 2);
  push_points (&b, 1, points, N_VERTICES, 0);
  push_points (&b, 0, points, N_VERTICES, 0);
  expect_error (&b, "carry matches, but pattern has squares");
  bench_clear (&b);
}

GST_END_TEST;

/* Nobody matches features: said once, with the element to put there. */
GST_START_TEST (test_no_detector)
{
  Bench b;

  print_init (&b, 2);
  for (guint frame = 0; frame < 30; frame++) {
    push (&b, 0, NULL, frame);
    push (&b, 1, NULL, frame);
    expect_points (&b, frame, GST_CLOTH_VERTEX_UNSEEN);
  }
  expect_message (&b, GST_MESSAGE_WARNING, "siftmatch");
  print_clear (&b);
}

GST_END_TEST;

/* A pattern whose picture has been left behind, and one of a kind from later. */
GST_START_TEST (test_refuse_to_start)
{
  Bench b;

  print_open (&b, 2);
  g_assert_true (g_file_set_contents (b.pattern_path,
          "{\"pattern\":\"picture\","
          "\"reference\":\"lost.png\",\"cloth_m\":[1,1],\"columns\":5,"
          "\"rows\":5}", -1, NULL));
  fail_unless_equals_int (gst_element_set_state (b.element, GST_STATE_PAUSED),
      GST_STATE_CHANGE_FAILURE);
  expect_message (&b, GST_MESSAGE_ERROR, "lost.png");
  g_assert_true (g_file_set_contents (b.pattern_path,
          "{\"pattern\":\"stripes\"}", -1, NULL));
  fail_unless_equals_int (gst_element_set_state (b.element, GST_STATE_PAUSED),
      GST_STATE_CHANGE_FAILURE);
  expect_message (&b, GST_MESSAGE_ERROR, "\"stripes\"");
  print_clear (&b);
}

GST_END_TEST;

static Suite *
triangulatematches_suite (void)
{
  Suite *s = suite_create ("triangulatematches");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, test_ring);
  tcase_add_test (tc, test_observation_streams);
  tcase_add_test (tc, test_unusable);
  tcase_add_test (tc, test_wrong_places);
  tcase_add_test (tc, test_no_points);
  tcase_add_test (tc, test_with_dots);
  tcase_add_test (tc, test_wrong_pattern);
  tcase_add_test (tc, test_no_detector);
  tcase_add_test (tc, test_refuse_to_start);
  return s;
}

GST_CHECK_MAIN (triangulatematches);
