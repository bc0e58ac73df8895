/* clothgap on meshes that carry what their cameras saw: lone rays against closed forms, what becomes of the
 * recording, what goes wrong.
 *
 * The mesh has two of the sheet's three rows; all are seen from the front.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/elements/clothgaplook.h"
#include "tests/elements/damage.h"

/* Vertices that the mesh has. */
#define N_MESH (2 * COLUMNS)

typedef struct
{
  const gchar *camera;          /* in the rig */
  Look look;
} Camera;

static const Camera all_from_front = { "front", {.dots = TRUE,.name =
        "",.acceleration = ACCELERATION,.missing = -1}
};

static const Camera some_from_above = { "above", {.above = TRUE,.dots =
        TRUE,.name = "above",.acceleration = ACCELERATION,.missing =
        -1,.n_seen = N_MESH}
};

static void
add_view (GstBuffer * mesh, const Camera * camera, guint frame)
{
  gst_buffer_add_cloth_view_meta (mesh, gst_cloth_view_new (camera->camera,
          frame, see (&camera->look, frame)));
}

/* The mesh without views. */
static GstBuffer *
make_rows (guint frame)
{
  gfloat places[3 * N];
  guint8 states[N];
  g_autoptr (GstClothMesh) mesh = NULL;
  GstBuffer *buffer;

  find_places (frame, ACCELERATION, places);
  for (guint i = 0; i < N; i++)
    states[i] = i < N_MESH ? GST_CLOTH_VERTEX_TWO_VIEWS :
        GST_CLOTH_VERTEX_UNSEEN;
  mesh = gst_cloth_mesh_new (frame, N, places, states, NULL);
  buffer = gst_cloth_mesh_to_buffer (mesh);
  GST_BUFFER_PTS (buffer) = gst_util_uint64_scale (frame, GST_SECOND, FPS);
  GST_BUFFER_DURATION (buffer) = GST_SECOND / FPS;
  return buffer;
}

static GstBuffer *
make_seen (guint frame)
{
  GstBuffer *buffer = make_rows (frame);

  add_view (buffer, &all_from_front, frame);
  add_view (buffer, &some_from_above, frame);
  return buffer;
}

static void
push_views (Setup * setup, guint from, guint to)
{
  for (guint frame = from; frame < to; frame++)
    fail_unless_equals_int (gst_harness_push (setup->h, make_seen (frame)),
        GST_FLOW_OK);
}

/* @rig: of this test, or NULL: the one in the take's folder */
static Setup
set_up_mesh (const gchar * take, const gchar * rig, const gchar * more)
{
  g_autofree gchar *text = g_strdup_printf ("%s%s%s %s", rig ? "rig=" : "",
      rig ? folder : "", rig ? rig : "", more);
  Setup setup = set_up ("/model.json", take, text);

  gst_harness_set_src_caps (setup.h, make_caps (COLUMNS, ROWS, 0.1f, FPS));
  return setup;
}

static void
expect_no_message (Setup * setup)
{
  fail_unless (find_message (setup, GST_MESSAGE_ERROR, NULL) == NULL);
  fail_unless (find_message (setup, GST_MESSAGE_WARNING, NULL) == NULL);
}

/* Takes what came out, so many in all: all falls alike, the lone rays in what they show of it. */
static void
expect_fall (Setup * setup, guint first, guint n)
{
  guint n_out = 0;
  GstBuffer *buffer;

  while ((buffer = gst_harness_try_pull (setup->h))) {
    GstClothGap *gap = gst_buffer_get_cloth_gap (buffer);
    const gfloat *r = gst_cloth_gap_get_residuals (gap, NULL);
    const gfloat *sigmas = gst_cloth_gap_get_sigmas (gap, NULL);

    for (guint i = 0; n_out >= first && i < N; i++) {
      const gdouble e = oscillator ((gdouble) (n_out - first) / FPS);

      fail_unless (fabs (r[3 * i + 2] - e) < 0.0005, "%.3f mm, not %.3f",
          1e3 * r[3 * i + 2], 1e3 * e);
      fail_unless (fabs (sigmas[i] - (i < N_MESH ? 0.0004 : SIGMA_PX * 0.01)) <
          1e-5, "sigma %g", sigmas[i]);
      /* all that a ray shows is across it, which is tilted by up to 6% */
      fail_unless (fabsf (r[3 * i + 1]) < 0.06 * 0.02);
    }
    fail_unless (gst_buffer_get_cloth_view (buffer, "above") != NULL);
    n_out++;
    gst_buffer_unref (buffer);
  }
  fail_unless_equals_int (n_out, n);
}

/* Takes what came out: what the mesh has not, no residual has. */
static void
expect_rows_only (Setup * setup, guint n)
{
  guint n_out = 0;
  GstBuffer *buffer;

  while ((buffer = gst_harness_try_pull (setup->h))) {
    const gfloat *r =
        gst_cloth_gap_get_residuals (gst_buffer_get_cloth_gap (buffer), NULL);

    for (guint i = 0; i < N; i++)
      fail_unless_equals_int (isnan (r[3 * i]), i >= N_MESH);
    n_out++;
    gst_buffer_unref (buffer);
  }
  fail_unless_equals_int (n_out, n);
}

/* ---- positive ---- */

/* The rig is that of the take or that of the property. At the end the recording is one of observations. */
GST_START_TEST (test_rays)
{
  Setup setup = set_up_mesh (__i__ ? "/take" : "/seen",
      __i__ ? "/seen/rig.json" : NULL, "");
  g_autoptr (GstMessage) score = NULL;
  g_autoptr (GstMessage) verdict = NULL;
  const gchar *json;
  gdouble coverage;

  push_views (&setup, 0, N_FRAMES);
  gst_harness_push_event (setup.h, gst_event_new_eos ());
  expect_fall (&setup, 0, N_FRAMES);
  score = find_message (&setup, GST_MESSAGE_ELEMENT, "clothgap/score");
  fail_unless (gst_structure_get_double (gst_message_get_structure (score),
          "coverage", &coverage) && coverage == 1);
  verdict = find_message (&setup, GST_MESSAGE_ELEMENT, "clothgap/verdict");
  json = gst_structure_get_string (gst_message_get_structure (verdict), "json");
  fail_unless (strstr (json, "67% of its places are where rays meet") != NULL
      && strstr (json, "33% lie on one camera's ray") != NULL);
  expect_no_message (&setup);
  tear_down (&setup);
}

GST_END_TEST;

/* Times: none at all; or of a camera whose clock is 2 frames ahead. */
GST_START_TEST (test_times)
{
  Setup setup = set_up_mesh ("/seen", __i__ ? "/late.json" : NULL, "");
  g_autoptr (GstMessage) verdict = NULL;

  for (guint frame = 0; frame < 60; frame++) {
    GstBuffer *buffer = make_rows (frame);
    GstBuffer *observation = see (&all_from_front.look, frame);

    GST_BUFFER_PTS (observation) = __i__ ? (frame + 2) * GST_SECOND / FPS :
        GST_CLOCK_TIME_NONE;
    if (!__i__)
      GST_BUFFER_PTS (buffer) = GST_CLOCK_TIME_NONE;
    gst_buffer_add_cloth_view_meta (buffer, gst_cloth_view_new ("front", frame,
            observation));
    fail_unless_equals_int (gst_harness_push (setup.h, buffer), GST_FLOW_OK);
  }
  gst_harness_push_event (setup.h, gst_event_new_eos ());
  verdict = find_message (&setup, GST_MESSAGE_ELEMENT, "clothgap/verdict");
  fail_unless (verdict != NULL
      && strstr (gst_structure_get_string (gst_message_get_structure (verdict),
              "json"), "100% lie on one camera's ray") != NULL);
  expect_no_message (&setup);
  tear_down (&setup);
}

GST_END_TEST;

/* The same cloth as a mesh that is no grid. */
static ClothTopology *
sew (void)
{
  ClothTopology *topology = cloth_topology_new_grid (COLUMNS, ROWS,
      0.1f * (COLUMNS - 1), 0.1f * (ROWS - 1));

  topology->columns = topology->rows = 0;
  for (guint i = 0, k = topology->n_faces - 1; i < k; i++, k--) {
    guint32 face[4];

    memcpy (face, topology->faces + 4 * i, sizeof face);
    memcpy (topology->faces + 4 * i, topology->faces + 4 * k, sizeof face);
    memcpy (topology->faces + 4 * k, face, sizeof face);
  }
  return topology;
}

static GstCaps *
make_sewn_caps (void)
{
  g_autoptr (ClothTopology) t = sew ();
  g_autoptr (GstClothTopology) topology = gst_cloth_topology_new (t->n_vertices,
      0, 0, t->uv, t->faces, t->n_faces, NULL);

  return gst_cloth_topology_to_caps (topology, FPS, 1);
}

/* Without a rig views are as good as none; and so they are when the mesh is no grid. */
GST_START_TEST (test_no_rig)
{
  g_autofree gchar *rig = g_strconcat ("rig=", folder, "/seen/rig.json", NULL);
  Setup setup = set_up ("/model.json", __i__ ? "/sewn" : "/take",
      __i__ ? rig : "");

  gst_harness_set_src_caps (setup.h, __i__ ? make_sewn_caps () :
      make_caps (COLUMNS, ROWS, 0.1f, FPS));
  push_views (&setup, 0, 20);
  expect_rows_only (&setup, 20 - LATENCY);
  expect_no_message (&setup);
  tear_down (&setup);
}

GST_END_TEST;

/* What two cameras saw and the mesh has not they contradict each other about. */
GST_START_TEST (test_contradicted)
{
  Setup setup = set_up_mesh ("/seen", NULL, "");

  for (guint frame = 0; frame < 20; frame++) {
    Camera above = some_from_above;
    GstBuffer *buffer = make_rows (frame);

    above.look.n_seen = 0;
    add_view (buffer, &all_from_front, frame);
    add_view (buffer, &above, frame);
    fail_unless_equals_int (gst_harness_push (setup.h, buffer), GST_FLOW_OK);
  }
  expect_rows_only (&setup, 20 - LATENCY);
  expect_no_message (&setup);
  tear_down (&setup);
}

GST_END_TEST;

/* After a flush, and when a segment goes back, it starts anew; another rate changes nothing; after a flush one
 * camera's own stream may follow, and a mesh again. */
GST_START_TEST (test_again)
{
  Setup setup = set_up_mesh ("/seen", NULL, "");

  push_views (&setup, 0, 12);
  flush (&setup);
  begin_segment (&setup);
  push_views (&setup, 0, 12);
  begin_segment (&setup);
  push_views (&setup, 0, 12);
  expect_fall (&setup, 21, 30);
  gst_harness_set_src_caps (setup.h, make_caps (COLUMNS, ROWS, 0.1f, 2 * FPS));
  push_views (&setup, 12, 20);
  flush (&setup);
  gst_harness_set_src_caps (setup.h, make_camera_caps (SIZE, FPS));
  begin_segment (&setup);
  for (guint frame = 0; frame < 12; frame++)
    fail_unless_equals_int (gst_harness_push (setup.h, see (&front, frame)),
        GST_FLOW_OK);
  flush (&setup);
  while (gst_harness_buffers_in_queue (setup.h))
    gst_buffer_unref (gst_harness_pull (setup.h));
  gst_harness_set_src_caps (setup.h, make_caps (COLUMNS, ROWS, 0.1f, FPS));
  begin_segment (&setup);
  push_views (&setup, 0, 12);
  expect_fall (&setup, 0, 12 - LATENCY);
  expect_no_message (&setup);
  tear_down (&setup);
}

GST_END_TEST;

/* ---- what goes wrong ---- */

GST_START_TEST (test_refused)
{
  static const struct
  {
    const gchar *take, *rig, *camera, *name;
    guint columns;
    const gchar *text;
  } cases[] = {
    {"/seen", NULL, "left", "left", 0, "“left” saw, which"},
    {"/take", "/one.json", "front", "front", 0, "Set rig= to the one of "
          "triangulate"},
    {"/take", "/broken.json", "front", "front", 0, "Can't use the rig"},
    {"/take", "/none.json", "front", "front", 0, "none.json"},
    {"/seen", NULL, "front", "above", 0, "says that it is of “above”"},
    {"/seen", NULL, "front", "front", COLUMNS + 1, "5×3 vertices, but the "
          "take's grid has 4×3"},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    Setup setup = set_up_mesh (cases[i].take, cases[i].rig, "");
    Camera camera = { cases[i].camera, front };
    GstBuffer *buffer = make_rows (0);

    camera.look.name = cases[i].name;
    camera.look.columns = cases[i].columns;
    add_view (buffer, &camera, 0);
    fail_unless_equals_int (gst_harness_push (setup.h, buffer), GST_FLOW_ERROR);
    expect (&setup, GST_MESSAGE_ERROR, cases[i].text);
    fail_unless (find_message (&setup, GST_MESSAGE_ERROR, NULL) == NULL);
    tear_down (&setup);
  }
}

GST_END_TEST;

/* Meshes in between that have lost what the cameras saw: told once, and they count as they are. */
GST_START_TEST (test_lost_midway)
{
  Setup setup = set_up_mesh ("/seen", NULL, "");
  g_autoptr (GstMessage) verdict = NULL;

  push_views (&setup, 0, 20);
  for (guint frame = 20; frame < 30; frame++)
    fail_unless_equals_int (gst_harness_push (setup.h, make_rows (frame)),
        GST_FLOW_OK);
  expect (&setup, GST_MESSAGE_WARNING, "without what its cameras saw");
  push_views (&setup, 30, 60);
  expect_no_message (&setup);
  for (guint frame = 0; frame < 60 - LATENCY; frame++) {
    GstBuffer *buffer = gst_harness_pull (setup.h);
    const gfloat *r =
        gst_cloth_gap_get_residuals (gst_buffer_get_cloth_gap (buffer), NULL);

    fail_unless_equals_int (isnan (r[3 * N_MESH]), frame >= 20 && frame < 30);
    fail_if (isnan (r[0]));
    gst_buffer_unref (buffer);
  }
  gst_harness_push_event (setup.h, gst_event_new_eos ());
  verdict = find_message (&setup, GST_MESSAGE_ELEMENT, "clothgap/verdict");
  fail_unless (verdict != NULL);
  expect_no_message (&setup);
  tear_down (&setup);
}

GST_END_TEST;

/* A view that can't be read, or is of another pattern, costs its mesh. */
GST_START_TEST (test_damaged)
{
  for (guint i = 0; i < 2; i++) {
    Setup setup = set_up_mesh ("/seen", NULL, "");

    push_views (&setup, 0, 5);
    for (guint strict = 0; strict < 2; strict++) {
      GstBuffer *buffer = make_seen (5);
      Camera other = all_from_front;

      other.look.columns = COLUMNS + 1;
      if (i)
        add_view (buffer, &other, 5);
      else
        gst_buffer_add_cloth_view_meta (buffer, gst_cloth_view_new ("front", 5,
                gst_buffer_new_memdup ("nonsense", 8)));
      g_object_set (setup.h->element, "strict", strict == 1, NULL);
      fail_unless_equals_int (gst_harness_push (setup.h, buffer),
          strict ? GST_FLOW_ERROR : GST_FLOW_OK);
      if (!strict)
        assert_dropped (setup.h->element, setup.bus, 1, "damaged packet");
      push_views (&setup, 5 + strict, 6 + strict);
    }
    expect_fall (&setup, 0, 7 - LATENCY);
    tear_down (&setup);
  }
}

GST_END_TEST;

/* Cameras that saw nothing: as a mesh without views, also at its end. */
GST_START_TEST (test_saw_nothing)
{
  Setup setup = set_up_mesh ("/seen", NULL, "");
  g_autoptr (GstMessage) verdict = NULL;

  for (guint frame = 0; frame < N_FRAMES; frame++) {
    GstBuffer *buffer = make_rows (frame);

    gst_buffer_add_cloth_view_meta (buffer, gst_cloth_view_new ("front", frame,
            see_nothing (frame)));
    fail_unless_equals_int (gst_harness_push (setup.h, buffer), GST_FLOW_OK);
  }
  gst_harness_push_event (setup.h, gst_event_new_eos ());
  expect_rows_only (&setup, N_FRAMES);
  verdict = find_message (&setup, GST_MESSAGE_ELEMENT, "clothgap/verdict");
  fail_unless (verdict != NULL
      && !strstr (gst_structure_get_string (gst_message_get_structure
              (verdict), "json"), "has no positions"));
  expect_no_message (&setup);
  tear_down (&setup);
}

GST_END_TEST;

static Suite *
clothgapcameras_suite (void)
{
  Suite *suite = suite_create ("clothgapcameras");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (suite, tc);
  tcase_set_timeout (tc, 60);
  tcase_add_loop_test (tc, test_rays, 0, 2);
  tcase_add_loop_test (tc, test_times, 0, 2);
  tcase_add_loop_test (tc, test_no_rig, 0, 2);
  tcase_add_test (tc, test_contradicted);
  tcase_add_test (tc, test_again);
  tcase_add_test (tc, test_refused);
  tcase_add_test (tc, test_lost_midway);
  tcase_add_test (tc, test_damaged);
  tcase_add_test (tc, test_saw_nothing);
  return suite;
}

static void
put_sewn (void)
{
  g_autofree gchar *path = in_folder ("/sewn");
  g_autoptr (ClothTakeInfo) info = cloth_take_info_new ("sewn");
  g_autoptr (ClothTopology) topology = sew ();
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothTakeWriter) writer = NULL;
  gfloat places[3 * N];
  guint8 states[N];

  info->fps = FPS;
  info->mesh = g_strdup ("cloth.obj");
  writer = cloth_take_writer_new (path, info, topology, &error);
  g_assert_no_error (error);
  find_places (0, 0, places);
  memset (states, CLOTH_VERTEX_MEASURED, N);
  cloth_take_writer_append (writer, 0, places, states, NULL, NULL, &error);
  g_assert_no_error (error);
  cloth_take_writer_close (writer, &error);
  g_assert_no_error (error);
}

/* Recordings are kept where nothing else is, and nothing of them may stay. */
int
main (int argc, char **argv)
{
  gchar own[] = "/tmp/clothgapcameras-XXXXXX";
  int failed;

  g_assert_nonnull (g_mkdtemp (own));
  g_assert_true (g_setenv ("TMPDIR", own, TRUE));
  gst_check_init (&argc, &argv);
  make_files ();
  make_rigs ();
  put_sewn ();
  failed = gst_check_run_suite (clothgapcameras_suite (), "clothgapcameras",
      __FILE__);
  remove_all (folder);
  g_free (folder);
  if (g_rmdir (own) != 0) {
    g_printerr ("%s is not empty\n", own);
    remove_all (own);
    failed++;
  }
  return failed;
}
