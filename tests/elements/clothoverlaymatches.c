/* clothoverlay: what is drawn of a print lies where geometry says, and nothing else changes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/elements/clothoverlayscene.h"

#define WIDTH 91
#define HEIGHT 73
#define CHORDS 12

static GstClothMatch
match_at (gfloat x, gfloat y, guint group, gboolean verified)
{
  return (GstClothMatch) {
  .x = x,.y = y,.scale = 2,.group = group,.verified = verified};
}

static GstClothGridPoint
point_at (gint column, gint row, gfloat x, gfloat y)
{
  return (GstClothGridPoint) {
  .column = column,.row = row,.x = x,.y = y,.cov_xx = 1,.cov_yy = 1};
}

static GstBuffer *
draw_matches (const gchar * format, const gchar * properties,
    const GstClothMatch * matches, guint n, const GstClothGridPoint * points,
    guint n_points, GstVideoInfo * info)
{
  GstBuffer *buffer = picture (format, WIDTH, HEIGHT, 5, info);

  gst_buffer_add_cloth_matches_meta (buffer, gst_cloth_matches_new ("cam0", 0,
          33, 35, n, FALSE, matches, n, points, n_points));
  return draw (properties, info, buffer);
}

static void
check_untouched (GstBuffer * out)
{
  GstMapInfo map;

  fail_unless (gst_buffer_map (out, &map, GST_MAP_READ));
  for (gsize i = 0; i < map.size; i++)
    fail_unless_equals_int (map.data[i], FILL);
  gst_buffer_unmap (out, &map);
  gst_buffer_unref (out);
}

/* A cross on what is verified, a dash on what isn't; a ring on each vertex, and links between
 * neighbours of the pattern, in whatever order they come. */
GST_START_TEST (test_groups)
{
  const GstClothMatch matches[2] = { match_at (20, 60, 3, TRUE),
    match_at (70, 60, 3, FALSE)
  };
  const GstClothGridPoint points[4] = { point_at (5, 8, 40, 50),
    point_at (4, 7, 20, 20), point_at (5, 7, 50, 24), point_at (32, 34, 80, 10)
  };
  Line lines[4 * CHORDS + 5];
  GstVideoInfo info;
  guint n = 0;

  for (guint f = 0; f < G_N_ELEMENTS (formats); f++) {
    GstBuffer *out = draw_matches (formats[f], "line-width=2", matches, 2,
        points, 4, &info);

    for (n = 0; n < 4 * CHORDS; n++) {
      const GstClothGridPoint *p = &points[n / CHORDS];
      const gdouble a = 2 * G_PI * n / CHORDS, b = 2 * G_PI * (n + 1) / CHORDS;

      lines[n] = (Line) {
      p->x + 2 * cos (a), p->y + 2 * sin (a), p->x + 2 * cos (b),
            p->y + 2 * sin (b)};
    }
    lines[n++] = (Line) {
    26, 20.8, 44, 23.2};
    lines[n++] = (Line) {
    48, 29.2, 42, 44.8};
    lines[n++] = (Line) {
    18.5, 60, 21.5, 60};
    lines[n++] = (Line) {
    20, 58.5, 20, 61.5};
    lines[n++] = (Line) {
    68.5, 60, 71.5, 60};
    fail_unless (check_lines (out, &info, lines, n, 2) > 100);
    check_padding (out, &info, 5);
    gst_buffer_unref (out);
  }
}

GST_END_TEST;

/* One colour for a group, wherever; others for others. What isn't verified is fainter. */
GST_START_TEST (test_colours)
{
  enum
  { N = 12 };
  GstClothMatch matches[N + 2];
  gint colours[N + 2][3], differ = 0;
  GstVideoInfo info;
  GstVideoFrame frame;
  GstBuffer *out;

  for (guint i = 0; i < N; i++)
    matches[i] = match_at ((gfloat) (10 + 10 * (i % 6)),
        (gfloat) (10 + 10 * (i / 6)), i, TRUE);
  matches[N] = match_at (10, 50, 4, TRUE);
  matches[N + 1] = match_at (30, 50, 4, FALSE);
  out = draw_matches ("RGB", "line-width=3", matches, N + 2, NULL, 0, &info);
  fail_unless (gst_video_frame_map (&frame, &info, out, GST_MAP_READ));
  for (guint i = 0; i < N + 2; i++)
    for (guint c = 0; c < 3; c++)
      colours[i][c] = *pixel (&frame, c, (gint) matches[i].x,
          (gint) matches[i].y) - FILL;
  for (guint i = 0; i < N; i++)
    for (guint k = 0; k < i; k++) {
      gint most = 0;

      for (guint c = 0; c < 3; c++)
        most = MAX (most, ABS (colours[i][c] - colours[k][c]));
      fail_unless (most > 20, "%u and %u look alike", i, k);
      differ++;
    }
  fail_unless_equals_int (differ, N * (N - 1) / 2);
  for (guint c = 0; c < 3; c++) {
    fail_unless_equals_int (colours[N][c], colours[4][c]);
    fail_unless (ABS (colours[N + 1][c]) < ABS (colours[N][c]) / 2);
  }
  gst_video_frame_unmap (&frame);
  gst_buffer_unref (out);
}

GST_END_TEST;

/* Heat where matches are verified, up to a kernel away, the more of them the darker. */
GST_START_TEST (test_density)
{
  GstClothMatch matches[64];
  GstVideoInfo info;
  GstVideoFrame frame;
  GstBuffer *out;
  guint n = 0;

  /* two, and twenty, in the middle of cells */
  for (guint i = 0; i < 22; i++)
    matches[n++] = match_at (i < 2 ? 23.5f : 71.5f, i < 2 ? 23.5f : 55.5f, i,
        TRUE);
  matches[n++] = match_at (23.5f, 55.5f, 0, FALSE);
  matches[n++] = match_at (NAN, 10, 0, TRUE);
  matches[n++] = match_at (-1e30f, INFINITY, 0, TRUE);
  out = draw_matches ("RGB", "draw-matches=density", matches, n, NULL, 0,
      &info);
  fail_unless (gst_video_frame_map (&frame, &info, out, GST_MAP_READ));
  for (gint y = 0; y < HEIGHT; y++)
    for (gint x = 0; x < WIDTH; x++) {
      const gboolean few = x >= 16 && x < 32 && y >= 16 && y < 32;
      const gboolean many = x >= 64 && x < 80 && y >= 48 && y < 64;

      if (!few && !many)
        fail_unless_equals_int (*pixel (&frame, 0, x, y), FILL);
    }
  fail_unless (*pixel (&frame, 1, 20, 20) > 120);
  fail_unless (*pixel (&frame, 1, 70, 50) < 70);
  gst_video_frame_unmap (&frame);
  check_padding (out, &info, 5);
  gst_buffer_unref (out);
}

GST_END_TEST;

GST_START_TEST (test_switch)
{
  const GstClothMatch match = match_at (20, 20, 0, TRUE), not_verified =
      match_at (20, 20, 0, FALSE);
  const GstClothGridPoint outside = point_at (33, 0, 50, 50);
  const GstClothGridPoint negative = point_at (-1, 0, 50, 50);
  GstVideoInfo info;

  check_untouched (draw_matches ("I420", "draw-matches=none", &match, 1, NULL,
          0, &info));
  check_untouched (draw_matches ("I420", "opacity=0", &match, 1, NULL, 0,
          &info));
  check_untouched (draw_matches ("I420", "", NULL, 0, &outside, 1, &info));
  check_untouched (draw_matches ("I420", "", NULL, 0, &negative, 1, &info));
  check_untouched (draw_matches ("I420", "draw-matches=density", &not_verified,
          1, NULL, 0, &info));
}

GST_END_TEST;

/* As many matches and vertices as a packet may hold, each as wide as the picture: the work is
 * bounded, and one warning says so. */
GST_START_TEST (test_too_much)
{
  g_autofree GstClothMatch *matches = g_new (GstClothMatch, 65536);
  g_autofree GstClothGridPoint *points = g_new (GstClothGridPoint, 65536);
  GstVideoInfo info;
  g_autoptr (GstBus) bus = gst_bus_new ();
  GstHarness *h;

  for (guint i = 0; i < 65536; i++) {
    matches[i] = match_at (320, 240, i, i % 2);
    points[i] = point_at ((gint) i % 256, (gint) i / 256,
        (gfloat) ((i * 37) % 640), (gfloat) ((i * 53) % 480));
  }
  gst_buffer_unref (picture ("I420", 640, 480, 0, &info));
  h = overlay ("line-width=100", &info);
  gst_element_set_bus (h->element, bus);
  for (guint k = 0; k < 2; k++) {
    GstBuffer *buffer = picture ("I420", 640, 480, 0, &info);

    GST_BUFFER_PTS (buffer) = k * GST_SECOND / 30;
    gst_buffer_add_cloth_matches_meta (buffer, gst_cloth_matches_new ("cam0", 0,
            256, 256, 65536, FALSE, matches, 65536, points, 65536));
    fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_OK);
    gst_buffer_unref (gst_harness_pull (h));
    {
      g_autoptr (GstMessage) message =
          gst_bus_pop_filtered (bus, GST_MESSAGE_WARNING);

      fail_unless ((message != NULL) == (k == 0));
    }
  }
  gst_element_set_bus (h->element, NULL);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* ---- checks ---- */

/* What a map has at a pixel: 1 mm a pixel from 5 mm left and above of the cloth's corner on; not
 * known in the lower right. */
static void
place_at (gint x, gint y, gfloat uv[2])
{
  const gboolean known = x < 60 || y < 40;

  uv[0] = known ? 0.001f * ((gfloat) x - 5 + 0.5f) : NAN;
  uv[1] = known ? 0.001f * ((gfloat) y - 5 + 0.5f) : NAN;
}

/* On a picture @times as large as that of the camera. */
static GstBuffer *
draw_uv (const gchar * more, const gchar * camera, gint width, gint height,
    gint times, GstVideoInfo * info)
{
  g_autofree gchar *rig = write_rig ("", "");
  g_autofree gchar *properties = g_strdup_printf ("rig=%s draw-mesh=false %s",
      rig, more);
  g_autofree gfloat *uv = g_new (gfloat, 2 * width * height);
  GstBuffer *buffer = picture ("RGB", 80 * times, 60 * times, 3, info), *out;
  GstHarness *h = overlay (properties, info), *m = mesh_pad (h);
  GstBuffer *mesh = mesh_buffer (COLUMNS * ROWS, -1);

  for (gint i = 0; i < width * height; i++)
    place_at (i % width, i / width, uv + 2 * i);
  if (camera)
    gst_buffer_add_cloth_uv_meta (mesh, gst_cloth_uv_new (camera, 0,
            (guint) width, (guint) height, uv, 2 * (guint) (width * height)));
  gst_harness_push (h, buffer);
  gst_harness_push (m, mesh);
  out = gst_harness_pull (h);
  gst_harness_teardown (m);
  gst_harness_teardown (h);
  g_unlink (rig);
  return out;
}

/* Each pixel is lighter or darker by the check that its place lies in, also on a larger
 * picture. */
GST_START_TEST (test_checks)
{
  static const gint edges[] = { 20, 10, 7 };

  for (guint i = 0; i < G_N_ELEMENTS (edges); i++) {
    g_autofree gchar *properties = i ? g_strdup_printf ("check=%d", edges[i]) :
        g_strdup ("");
    const gint times = 1 + (gint) i;
    GstVideoInfo info;
    GstVideoFrame frame;
    GstBuffer *out = draw_uv (properties, "left", 80, 60, times, &info);

    fail_unless (gst_video_frame_map (&frame, &info, out, GST_MAP_READ));
    for (gint k = 0; k < 80 * 60 * times * times; k++) {
      const gint at[2] = { k % (80 * times), k / (80 * times) };
      const gint x = at[0] / times, y = at[1] / times;
      const gint value = *pixel (&frame, 1, at[0], at[1]);
      const gint column = x < 5 ? -1 : (x - 5) / edges[i];
      const gint row = y < 5 ? -1 : (y - 5) / edges[i];

      if (x >= 60 && y >= 40) {
        fail_unless_equals_int (value, FILL);
      } else if ((column + row) % 2) {
        fail_unless (value > FILL + 40, "(%d, %d): %d", x, y, value);
      } else {
        fail_unless (value < FILL - 40, "(%d, %d): %d", x, y, value);
      }
    }
    gst_video_frame_unmap (&frame);
    check_padding (out, &info, 3);
    gst_buffer_unref (out);
  }
}

GST_END_TEST;

/* A map of another camera or of another size, none at all, or switched off. */
GST_START_TEST (test_no_checks)
{
  GstVideoInfo info;

  check_untouched (draw_uv ("", "right", 80, 60, 1, &info));
  check_untouched (draw_uv ("", "left", 40, 30, 1, &info));
  check_untouched (draw_uv ("", "left", 60, 80, 1, &info));
  check_untouched (draw_uv ("", NULL, 80, 60, 1, &info));
  check_untouched (draw_uv ("draw-uv=false", "left", 80, 60, 1, &info));
}

GST_END_TEST;

static Suite *
clothoverlaymatches_suite (void)
{
  Suite *s = suite_create ("clothoverlaymatches");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, test_groups);
  tcase_add_test (tc, test_colours);
  tcase_add_test (tc, test_density);
  tcase_add_test (tc, test_switch);
  tcase_add_test (tc, test_too_much);
  tcase_add_test (tc, test_checks);
  tcase_add_test (tc, test_no_checks);
  return s;
}

GST_CHECK_MAIN (clothoverlaymatches);
