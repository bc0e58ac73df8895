/* clothoverlay: meshes and gaps over the film, frame by frame.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/elements/clothoverlayscene.h"

static guint
grid_lines (Line * lines, gdouble scale, gint missing)
{
  guint n = 0;
  gint r, c, d;

  for (r = 0; r < ROWS; r++) {
    for (c = 0; c < COLUMNS; c++) {
      for (d = 0; d < 2; d++) {
        gint r2 = r + d, c2 = c + 1 - d;

        if (r2 >= ROWS || c2 >= COLUMNS || r * COLUMNS + c == missing
            || r2 * COLUMNS + c2 == missing) {
          continue;
        }
        lines[n].x0 = (15 + 15 * c + 0.5) * scale - 0.5;
        lines[n].y0 = (15 + 15 * r + 0.5) * scale - 0.5;
        lines[n].x1 = (15 + 15 * c2 + 0.5) * scale - 0.5;
        lines[n].y1 = (15 + 15 * r2 + 0.5) * scale - 0.5;
        n++;
      }
    }
  }
  return n;
}

/* Also with a picture three times as large as the calibration's. */
GST_START_TEST (test_mesh)
{
  g_autofree gchar *rig = write_rig ("", "");
  gint pass;

  for (pass = 0; pass < 3; pass++) {
    g_autofree gchar *properties =
        g_strdup_printf ("rig=%s line-width=1.5 %s", rig,
        pass ? "camera=left" : "");
    gint missing = pass == 2 ? 5 : -1;
    gdouble scale = pass == 1 ? 3 : 1;
    GstVideoInfo info;
    GstBuffer *buffer =
        picture ("I420", (gint) (80 * scale), (gint) (60 * scale), 3, &info);
    GstHarness *h = overlay (properties, &info), *m = mesh_pad (h);
    Line lines[40];
    guint n = grid_lines (lines, scale, missing);
    GstBuffer *out;

    fail_unless_equals_int (n, pass == 2 ? 13 : 17);
    gst_harness_push (h, buffer);
    gst_harness_push (m, mesh_buffer (COLUMNS * ROWS, missing));
    out = gst_harness_pull (h);
    fail_unless (check_lines (out, &info, lines, n, 1.5) > 400);
    gst_buffer_unref (out);
    gst_harness_teardown (m);
    gst_harness_teardown (h);
  }
  g_unlink (rig);
}

GST_END_TEST;

/* ---- heat map ---- */

/* The flat grid, every vertex @mm millimetres off; one vertex not seen. */
static GstBuffer *
gap_buffer (gfloat mm, guint n_gap, gint missing)
{
  GstBuffer *buffer = mesh_buffer (COLUMNS * ROWS, missing);
  g_autofree gfloat *residuals = g_new (gfloat, 3 * n_gap);
  guint i;

  for (i = 0; i < n_gap; i++) {
    /* 2² + 3² + 6² = 7² */
    residuals[3 * i] = -2e-3f * mm / 7;
    residuals[3 * i + 1] = 3e-3f * mm / 7;
    residuals[3 * i + 2] = (gint) i == missing ? NAN : 6e-3f * mm / 7;
  }
  gst_buffer_add_cloth_gap_meta (buffer, gst_cloth_gap_new (0, n_gap, residuals,
          NULL));
  return buffer;
}

static GstBuffer *
draw_gap (const gchar * properties, gint width, gint height,
    GstVideoInfo * info, GstBuffer * mesh)
{
  g_autofree gchar *rig = write_rig ("", "");
  g_autofree gchar *all = g_strdup_printf ("rig=%s %s", rig, properties);
  GstBuffer *buffer = picture ("RGB", width, height, 3, info), *out;
  GstHarness *h = overlay (all, info), *m = mesh_pad (h);

  gst_harness_push (h, buffer);
  gst_harness_push (m, mesh);
  out = gst_harness_pull (h);
  fail_unless (out != NULL);
  gst_harness_teardown (m);
  gst_harness_teardown (h);
  g_unlink (rig);
  return out;
}

static void
check_rgb (GstBuffer * buffer, GstVideoInfo * info, gint x, gint y,
    const gdouble rgb[3], gdouble most, const gchar * what)
{
  GstVideoFrame frame;
  guint c;

  fail_unless (gst_video_frame_map (&frame, info, buffer, GST_MAP_READ));
  for (c = 0; c < 3; c++) {
    gint got = *pixel (&frame, c, x, y);

    fail_unless (fabs (got - rgb[c]) <= most, "%s (%d, %d) component %u: %d, "
        "not %.1f", what, x, y, c, got, rgb[c]);
  }
  gst_video_frame_unmap (&frame);
}

/* The ends of the report's scale, 60% over the film's 128, in the middle of a cell; the
 * full colour on the line between two cells. */
GST_START_TEST (test_gap_colours)
{
  static const struct
  {
    gfloat mm;
    const gchar *properties;
    gdouble rgb[3];
  } cases[] = {
    {0, "", {240, 234, 222}}, {10, "", {104, 10, 62}},
    {4000, "", {104, 10, 62}}, {9, "gap-scale=20", {244, 150, 70}},
    {0.45f, "gap-scale=1", {244, 150, 70}}, {14, "gap-scale=20", {214, 62, 52}}
  };
  guint i, c;

  for (i = 0; i < G_N_ELEMENTS (cases); i++) {
    GstVideoInfo info;
    GstBuffer *out = draw_gap (cases[i].properties, 80, 60, &info,
        gap_buffer (cases[i].mm, COLUMNS * ROWS, -1));
    gdouble face[3];

    for (c = 0; c < 3; c++) {
      face[c] = FILL + 0.6 * (cases[i].rgb[c] - FILL);
    }
    check_rgb (out, &info, 22, 22, face, 4, cases[i].properties);
    check_rgb (out, &info, 22, 30, cases[i].rgb, 5, "line");
    gst_buffer_unref (out);
  }
}

GST_END_TEST;

/* A face with an unseen corner is not filled, nor is anything when it is switched off
 * or when the gap is of another mesh. */
GST_START_TEST (test_gap_not_drawn)
{
  const gdouble film[3] = { FILL, FILL, FILL };
  GstVideoInfo info;
  GstBuffer *out;

  out = draw_gap ("", 80, 60, &info, gap_buffer (10, COLUMNS * ROWS, 5));
  check_rgb (out, &info, 22, 22, film, 1, "unseen corner");
  gst_buffer_unref (out);

  out = draw_gap ("draw-gap=false", 80, 60, &info, gap_buffer (10,
          COLUMNS * ROWS, -1));
  check_rgb (out, &info, 22, 22, film, 1, "switched off");
  gst_buffer_unref (out);

  out = draw_gap ("", 80, 60, &info, gap_buffer (10, COLUMNS * ROWS - 1, -1));
  check_rgb (out, &info, 22, 22, film, 1, "another mesh");
  gst_buffer_unref (out);

  out = draw_gap ("draw-mesh=false", 80, 60, &info, gap_buffer (10,
          COLUMNS * ROWS, -1));
  check_rgb (out, &info, 22, 22, film, 1, "no mesh");
  gst_buffer_unref (out);
}

GST_END_TEST;

/* The scale: its first colour below, its last above, and only in pictures with room. */
GST_START_TEST (test_gap_scale)
{
  const gdouble low[3] = { 240, 234, 222 }, high[3] = { 104, 10, 62 };
  const gdouble film[3] = { FILL, FILL, FILL };
  GstVideoInfo info;
  GstBuffer *out = draw_gap ("", 640, 480, &info, gap_buffer (0, COLUMNS * ROWS,
          -1));

  check_rgb (out, &info, 17, 467, low, 1, "low end");
  check_rgb (out, &info, 17, 373, high, 1, "high end");
  check_rgb (out, &info, 17, 370, film, 1, "above");
  gst_buffer_unref (out);
  out = draw_gap ("", 160, 120, &info, gap_buffer (0, COLUMNS * ROWS, -1));
  check_rgb (out, &info, 4, 115, film, 1, "thumbnail");
  gst_buffer_unref (out);
}

GST_END_TEST;

/* Pictures without a mesh pass, meshes without a picture are dropped. */
GST_START_TEST (test_mesh_pairing)
{
  g_autofree gchar *rig = write_rig ("", "");
  g_autofree gchar *properties = g_strdup_printf ("rig=%s", rig);
  GstVideoInfo info;
  GstBuffer *buffer = picture ("I420", 80, 60, 0, &info), *out;
  GstHarness *h = overlay (properties, &info), *m = mesh_pad (h);

  GST_BUFFER_PTS (buffer) = 1 * GST_SECOND;
  gst_harness_push (h, buffer);
  gst_harness_push (m, mesh_buffer (COLUMNS * ROWS, -1));       /* at 0 s */
  buffer = mesh_buffer (COLUMNS * ROWS, -1);
  GST_BUFFER_PTS (buffer) = 2 * GST_SECOND;
  gst_harness_push (m, buffer);
  out = gst_harness_pull (h);
  fail_unless_equals_uint64 (GST_BUFFER_PTS (out), 1 * GST_SECOND);
  check_lines (out, &info, NULL, 0, 1);
  gst_buffer_unref (out);

  /* the mesh stream ends early: the film goes on */
  gst_harness_push_event (m, gst_event_new_eos ());
  buffer = picture ("I420", 80, 60, 0, &info);
  GST_BUFFER_PTS (buffer) = 3 * GST_SECOND;
  gst_harness_push (h, buffer);
  out = gst_harness_pull (h);
  fail_unless_equals_uint64 (GST_BUFFER_PTS (out), 3 * GST_SECOND);
  gst_buffer_unref (out);
  gst_harness_teardown (m);
  gst_harness_teardown (h);
  g_unlink (rig);
}

GST_END_TEST;

/* When the pictures end the film ends, however long the meshes go on. */
GST_START_TEST (test_film_ends)
{
  g_autofree gchar *rig = write_rig ("", "");
  g_autofree gchar *properties = g_strdup_printf ("rig=%s", rig);
  GstVideoInfo info;
  GstBuffer *buffer = picture ("I420", 80, 60, 0, &info);
  GstHarness *h = overlay (properties, &info), *m = mesh_pad (h);
  GstEventType type = GST_EVENT_UNKNOWN;

  gst_harness_push (h, buffer);
  gst_harness_push (m, mesh_buffer (COLUMNS * ROWS, -1));
  gst_buffer_unref (gst_harness_pull (h));
  gst_harness_push_event (h, gst_event_new_eos ());
  buffer = mesh_buffer (COLUMNS * ROWS, -1);
  GST_BUFFER_PTS (buffer) = 1 * GST_SECOND;
  gst_harness_push (m, buffer);
  while (type != GST_EVENT_EOS) {
    GstEvent *event = gst_harness_pull_event (h);

    fail_unless (event != NULL);
    type = GST_EVENT_TYPE (event);
    gst_event_unref (event);
  }
  gst_harness_teardown (m);
  gst_harness_teardown (h);
  g_unlink (rig);
}

GST_END_TEST;

/* Meshes are in the rig's time; this camera's clock is half a second ahead of it. */
GST_START_TEST (test_camera_offset)
{
  g_autofree gchar *rig = write_rig (", \"offset_s\": 0.5", "");
  g_autofree gchar *properties = g_strdup_printf ("rig=%s", rig);
  GstVideoInfo info;
  GstBuffer *buffer = picture ("I420", 80, 60, 0, &info), *out;
  GstHarness *h = overlay (properties, &info), *m = mesh_pad (h);
  Line lines[40];
  guint n = grid_lines (lines, 1, -1);

  GST_BUFFER_PTS (buffer) = 500 * GST_MSECOND;
  gst_harness_push (h, buffer);
  gst_harness_push (m, mesh_buffer (COLUMNS * ROWS, -1));       /* at 0 s */
  out = gst_harness_pull (h);
  fail_unless_equals_uint64 (GST_BUFFER_PTS (out), 500 * GST_MSECOND);
  fail_unless (check_lines (out, &info, lines, n, 1.5) > 400);
  gst_buffer_unref (out);
  gst_harness_teardown (m);
  gst_harness_teardown (h);
  g_unlink (rig);
}

GST_END_TEST;

/* ---- strain ---- */

/* The flat grid, every vertex moved to F (x, y). */
static GstBuffer *
strained_buffer (const gdouble F[4], gint missing)
{
  GstBuffer *buffer = mesh_buffer (COLUMNS * ROWS, missing);
  g_autoptr (GstClothMesh) flat = gst_cloth_mesh_from_buffer (buffer, NULL);
  g_autoptr (GstClothMesh) mesh = NULL;
  const gfloat *positions = gst_cloth_mesh_get_positions (flat, NULL);
  gfloat moved[3 * COLUMNS * ROWS];
  guint i;

  memcpy (moved, positions, sizeof moved);
  for (i = 0; i < COLUMNS * ROWS; i++) {
    moved[3 * i] = (gfloat) (F[0] * positions[3 * i] +
        F[1] * positions[3 * i + 1]);
    moved[3 * i + 1] = (gfloat) (F[2] * positions[3 * i] +
        F[3] * positions[3 * i + 1]);
  }
  mesh = gst_cloth_mesh_new (0, COLUMNS * ROWS, moved,
      gst_cloth_mesh_get_states (flat, NULL), NULL);
  gst_buffer_unref (buffer);
  buffer = gst_cloth_mesh_to_buffer (mesh);
  GST_BUFFER_PTS (buffer) = 0;
  GST_BUFFER_DURATION (buffer) = GST_SECOND / 30;
  return buffer;
}

/* The face in the middle of the picture in the colour of its strain, 60% over the film. */
GST_START_TEST (test_strain)
{
  static const gdouble none[3] = { 240, 234, 222 }, red[3] = { 104, 10, 62 };
  static const gdouble blue[3] = { 22, 32, 110 }, pink[3] = { 214, 62, 52 };
  /* sqrt (1 + 2 E) times as long has the strain E */
  static const struct
  {
    gdouble F[4];
    const gchar *properties;
    const gdouble *rgb;
  } cases[] = {
    {{1, 0, 0, 1}, "mesh-style=strain-warp", none},
    {{1, 0, 0, 1}, "mesh-style=strain-shear strain-scale=1", none},
    {{1.4, 0, 0, 1}, "mesh-style=strain-warp", red},
    {{1.4, 0, 0, 1}, "mesh-style=strain-weft", none},
    {{1.4, 0, 0, 1}, "mesh-style=strain-shear", none},
    /* 0.07 and 0.28 */
    {{1.0677078, 0, 0, 1}, "mesh-style=strain-warp", pink},
    {{1, 0, 0, 1.2489996}, "mesh-style=strain-weft strain-scale=40", pink},
    {{1, 0, 0, 0.8}, "mesh-style=strain-weft", blue},
    /* shear 0.07, without stretch */
    {{1, 0.14, 0, 0.9901515}, "mesh-style=strain-shear", pink},
    {{1, -0.3, 0, 0.9539392}, "mesh-style=strain-shear", blue},
    {{1, 0.14, 0, 0.9901515}, "mesh-style=strain-weft", none},
    /* a turn of 0.3 */
    {{0.9553365, -0.2955202, 0.2955202, 0.9553365}, "mesh-style=strain-warp",
        none},
  };
  guint i, c;

  for (i = 0; i < G_N_ELEMENTS (cases); i++) {
    GstVideoInfo info;
    GstBuffer *out = draw_gap (cases[i].properties, 80, 60, &info,
        strained_buffer (cases[i].F, -1));
    gdouble face[3];

    for (c = 0; c < 3; c++) {
      face[c] = FILL + 0.6 * (cases[i].rgb[c] - FILL);
    }
    check_rgb (out, &info, 37, 24, face, 4, cases[i].properties);
    gst_buffer_unref (out);
  }
}

GST_END_TEST;

/* It is drawn instead of the gap, and not where a corner is unseen; its scale has both
 * ends. */
GST_START_TEST (test_strain_drawn)
{
  static const gdouble same[4] = { 1, 0, 0, 1 }, film[3] = { FILL, FILL, FILL };
  static const gdouble low[3] = { 22, 32, 110 }, high[3] = { 104, 10, 62 };
  static const gdouble none[3] = { FILL + 0.6 * (240 - FILL),
    FILL + 0.6 * (234 - FILL), FILL + 0.6 * (222 - FILL)
  };
  GstVideoInfo info;
  GstBuffer *out;

  out = draw_gap ("mesh-style=strain-warp", 80, 60, &info,
      gap_buffer (10, COLUMNS * ROWS, -1));
  check_rgb (out, &info, 22, 22, none, 4, "instead of the gap");
  gst_buffer_unref (out);
  out = draw_gap ("mesh-style=strain-warp", 80, 60, &info,
      strained_buffer (same, 5));
  check_rgb (out, &info, 22, 22, film, 1, "unseen corner");
  gst_buffer_unref (out);
  out = draw_gap ("mesh-style=strain-weft", 640, 480, &info,
      strained_buffer (same, -1));
  check_rgb (out, &info, 17, 467, low, 1, "low end");
  check_rgb (out, &info, 17, 373, high, 1, "high end");
  gst_buffer_unref (out);
}

GST_END_TEST;

/* A mesh that doesn't know its uv is grey, and that is said once. */
GST_START_TEST (test_strain_without_uv)
{
  static const gdouble grey[3] = { 128, 134, 145 };
  static const gfloat no_uv[2 * COLUMNS * ROWS] = { 0 };
  static const guint32 faces[] = { 0, 4, 5, 1, 1, 5, 6, 2, 2, 6, 7, 3 };
  g_autofree gchar *rig = write_rig ("", "");
  g_autofree gchar *properties =
      g_strdup_printf ("rig=%s mesh-style=strain-warp", rig);
  g_autoptr (GstClothTopology) topology = NULL;
  g_autoptr (GstBus) bus = gst_bus_new ();
  GstVideoInfo info;
  GstBuffer *buffer = picture ("RGB", 80, 60, 3, &info), *out;
  GstHarness *h = overlay (properties, &info), *m;
  guint k, n_warnings = 0;

  topology = gst_cloth_topology_new (COLUMNS * ROWS, COLUMNS, ROWS, no_uv,
      faces, G_N_ELEMENTS (faces) / 4, NULL);
  fail_unless (topology != NULL);
  m = gst_harness_new_with_element (h->element, "mesh", NULL);
  gst_harness_set_src_caps (m, gst_cloth_topology_to_caps (topology, 30, 1));
  gst_element_set_bus (h->element, bus);
  for (k = 0; k < 2; k++) {
    if (k) {
      buffer = picture ("RGB", 80, 60, 3, &info);
      GST_BUFFER_PTS (buffer) = GST_SECOND / 30;
    }
    gst_harness_push (h, buffer);
    buffer = mesh_buffer (COLUMNS * ROWS, -1);
    GST_BUFFER_PTS (buffer) = k * GST_SECOND / 30;
    gst_harness_push (m, buffer);
    out = gst_harness_pull (h);
    check_rgb (out, &info, 22, 30, grey, 3, "line");
    gst_buffer_unref (out);
  }
  for (;;) {
    g_autoptr (GstMessage) message = gst_bus_pop_filtered (bus,
        GST_MESSAGE_WARNING | GST_MESSAGE_ERROR);

    if (!message) {
      break;
    }
    fail_unless_equals_int (GST_MESSAGE_TYPE (message), GST_MESSAGE_WARNING);
    n_warnings++;
  }
  fail_unless_equals_int (n_warnings, 1);
  gst_element_set_bus (h->element, NULL);
  gst_harness_teardown (m);
  gst_harness_teardown (h);
  g_unlink (rig);
}

GST_END_TEST;

/* ---- surface ---- */

/* A picture that is red all over, by stock elements. */
static gchar *
write_red_picture (void)
{
  gchar *path = NULL;
  gint fd = g_file_open_tmp ("cloth-overlay-XXXXXX.png", &path, NULL);
  g_autofree gchar *launch =
      g_strdup_printf ("videotestsrc num-buffers=1 pattern=red ! "
      "video/x-raw,format=RGB,width=8,height=8 ! pngenc ! filesink location=%s",
      path);
  g_autoptr (GstElement) pipeline = gst_parse_launch (launch, NULL);
  g_autoptr (GstBus) bus = gst_element_get_bus (pipeline);
  g_autoptr (GstMessage) message = NULL;

  fail_unless (fd >= 0);
  g_close (fd, NULL);
  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  message = gst_bus_timed_pop_filtered (bus, 20 * GST_SECOND,
      GST_MESSAGE_EOS | GST_MESSAGE_ERROR);
  fail_unless (message && GST_MESSAGE_TYPE (message) == GST_MESSAGE_EOS);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  return path;
}

/* The cloth faces the camera; the lamp stands at acos (0.5 / |(-0.4, -0.8, 0.5)|) to it:
 * 0.35 + 0.6 · 0.488 of the light is 0.818 of the encoded value. */
GST_START_TEST (test_surface)
{
  static const gdouble film[3] = { FILL, FILL, FILL };
  static const gdouble red[3] = { 209, 0, 0 }, half[3] = { 168, 64, 64 };
  g_autofree gchar *texture = write_red_picture ();
  g_autofree gchar *textured =
      g_strdup_printf ("mesh-style=shaded texture=%s", texture);
  g_autofree gchar *faint = g_strconcat (textured, " opacity=0.5", NULL);
  GstVideoInfo info;
  GstBuffer *out = draw_gap (textured, 80, 60, &info,
      mesh_buffer (COLUMNS * ROWS, -1));

  check_rgb (out, &info, 37, 30, red, 2, "red");
  check_rgb (out, &info, 16, 16, red, 2, "red");
  check_rgb (out, &info, 59, 44, red, 2, "red");
  check_rgb (out, &info, 10, 30, film, 0, "film");
  check_rgb (out, &info, 37, 48, film, 0, "film");
  check_padding (out, &info, 3);
  gst_buffer_unref (out);
  out = draw_gap (faint, 80, 60, &info, mesh_buffer (COLUMNS * ROWS, -1));
  check_rgb (out, &info, 37, 30, half, 3, "half red");
  gst_buffer_unref (out);
  /* a place that nobody has seen shows the film */
  out = draw_gap (textured, 80, 60, &info, mesh_buffer (COLUMNS * ROWS, 5));
  check_rgb (out, &info, 31, 31, film, 0, "film");
  check_rgb (out, &info, 55, 25, red, 2, "red");
  gst_buffer_unref (out);
  g_unlink (texture);
}

GST_END_TEST;

/* Without a picture it is white, in every format; nothing between the rows changes. */
GST_START_TEST (test_surface_formats)
{
  g_autofree gchar *rig = write_rig ("", "");
  g_autofree gchar *properties =
      g_strdup_printf ("rig=%s mesh-style=shaded", rig);
  guint i;

  for (i = 0; i < G_N_ELEMENTS (formats); i++) {
    GstVideoInfo info;
    GstBuffer *buffer = picture (formats[i], 81, 61, 5, &info), *out;
    GstHarness *h = overlay (properties, &info), *m = mesh_pad (h);
    GstVideoFrame frame;

    gst_harness_push (h, buffer);
    gst_harness_push (m, mesh_buffer (COLUMNS * ROWS, -1));
    out = gst_harness_pull (h);
    check_padding (out, &info, 5);
    fail_unless (gst_video_frame_map (&frame, &info, out, GST_MAP_READ));
    fail_unless (*pixel (&frame, 0, 37, 30) > FILL + 20, "%s", formats[i]);
    fail_unless_equals_int (*pixel (&frame, 0, 5, 5), FILL);
    gst_video_frame_unmap (&frame);
    gst_buffer_unref (out);
    gst_harness_teardown (m);
    gst_harness_teardown (h);
  }
  g_unlink (rig);
}

GST_END_TEST;

static Suite *
clothoverlaymesh_suite (void)
{
  Suite *s = suite_create ("clothoverlaymesh");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, test_mesh);
  tcase_add_test (tc, test_gap_colours);
  tcase_add_test (tc, test_gap_not_drawn);
  tcase_add_test (tc, test_gap_scale);
  tcase_add_test (tc, test_strain);
  tcase_add_test (tc, test_strain_drawn);
  tcase_add_test (tc, test_strain_without_uv);
  tcase_add_test (tc, test_surface);
  tcase_add_test (tc, test_surface_formats);
  tcase_add_test (tc, test_mesh_pairing);
  tcase_add_test (tc, test_film_ends);
  tcase_add_test (tc, test_camera_offset);
  return s;
}

GST_CHECK_MAIN (clothoverlaymesh);
