/* clothoverlay: what is drawn of squares and saddles lies where geometry says, and nothing
 * else changes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/elements/clothoverlayscene.h"

/* ---- positive ---- */

/* All formats, an odd size, padded rows, a square that is turned and cut by the edge. */
GST_START_TEST (test_formats)
{
  const gchar *format = formats[__i__];
  GstClothQuad q[2] = { quad_at (10.3f, 7.8f, 20, 1), quad_at (0, 0, 0, 0.8f) };
  const gfloat x[4] = { 50, 75.5f, 68, 42 }, y[4] = { 10, 18, 44, 33.3f };
  Line lines[8];
  GstVideoInfo info;
  GstBuffer *buffer, *out;
  guint i, changed;

  memcpy (q[1].x, x, sizeof (x));
  memcpy (q[1].y, y, sizeof (y));
  for (i = 0; i < 8; i++) {
    guint k = i & 3, l = (k + 1) & 3;

    lines[i].x0 = q[i / 4].x[k];
    lines[i].y0 = q[i / 4].y[k];
    lines[i].x1 = q[i / 4].x[l];
    lines[i].y1 = q[i / 4].y[l];
  }
  buffer = picture (format, 71, 47, 13, &info);
  add_quads (buffer, q, 2);
  out = draw ("fill-opacity=0 line-width=2", &info, buffer);
  changed = check_lines (out, &info, lines, 8, 2 + EDGES);
  fail_unless (changed > 300, "%u", changed);
  check_padding (out, &info, 13);
  gst_buffer_unref (out);
}

GST_END_TEST;

/* Who does not know of strides gets pictures as their caps mean them, drawn on or not, with
 * all that is on them. */
GST_START_TEST (test_plain_layout)
{
  guint k;

  for (k = 0; k < 2; k++) {
    GstClothQuad q = quad_at (10, 10, 20, 1);
    const Line lines[4] = { {10, 10, 30, 10}, {30, 10, 30, 30},
    {30, 30, 10, 30}, {10, 30, 10, 10}
    };
    GstHarness *h;
    GstVideoInfo info;
    GstBuffer *buffer = picture ("I420", 71, 47, 13, &info), *out;

    add_quads (buffer, &q, 1);
    h = gst_harness_new_parse (k ? "clothoverlay draw-quads=false" :
        "clothoverlay fill-opacity=0 line-width=2");
    gst_harness_set_src_caps (h, gst_video_info_to_caps (&info));
    out = gst_harness_push_and_pull (h, buffer);
    fail_unless (gst_buffer_get_video_meta (out) == NULL);
    fail_unless_equals_int (gst_buffer_get_size (out),
        GST_VIDEO_INFO_SIZE (&info));
    fail_unless (gst_buffer_get_cloth_quads (out) != NULL);
    fail_unless (GST_BUFFER_PTS (out) == 0);
    fail_unless ((check_lines (out, &info, lines, k ? 0 : 4,
                2 + EDGES) > 0) == !k);
    gst_buffer_unref (out);
    gst_harness_teardown (h);
  }
}

GST_END_TEST;

GST_START_TEST (test_nothing_to_draw)
{
  GstVideoInfo info;
  GstBuffer *buffer = picture ("I420", 33, 21, 0, &info), *out;

  /* the very same buffer */
  out = draw ("", &info, buffer);
  fail_unless (out == buffer);
  check_lines (out, &info, NULL, 0, 1);
  gst_buffer_unref (out);

  /* neither does what is switched off change anything */
  buffer = picture ("I420", 33, 21, 0, &info);
  {
    GstClothQuad q = quad_at (3, 3, 12, 1);

    add_quads (buffer, &q, 1);
  }
  out = draw ("draw-quads=false", &info, buffer);
  fail_unless (out == buffer);
  check_lines (out, &info, NULL, 0, 1);
  gst_buffer_unref (out);
}

GST_END_TEST;

/* Another branch of a tee keeps its picture. */
GST_START_TEST (test_shared_buffer)
{
  GstClothQuad q = quad_at (5, 5, 15, 1);
  GstVideoInfo info;
  GstBuffer *buffer = picture ("I420", 40, 30, 0, &info), *out;

  add_quads (buffer, &q, 1);
  out = draw ("", &info, gst_buffer_ref (buffer));
  fail_unless (out != buffer);
  check_lines (buffer, &info, NULL, 0, 1);
  fail_unless (gst_buffer_get_cloth_quads (out) != NULL);
  gst_buffer_unref (out);
  gst_buffer_unref (buffer);
}

GST_END_TEST;

/* The ends of the colour map, through GStreamer's own converter for YUV. */
GST_START_TEST (test_confidence_colours)
{
  static const struct
  {
    gfloat confidence;
    guint8 rgb[3];
  } ends[] = {
    {1.0f, {255, 237, 38}}, {0.62f, {128, 33, 199}}, {0.1f, {128, 33, 199}}
  };
  static const gchar *const of[] = { "RGBA", "BGRx", "Y444", "AYUV", "I420" };
  guint e, f, c;

  for (e = 0; e < G_N_ELEMENTS (ends); e++) {
    for (f = 0; f < G_N_ELEMENTS (of); f++) {
      GstClothQuad q = quad_at (8, 8, 32, ends[e].confidence);
      GstVideoInfo info, rgb;
      GstBuffer *buffer = picture (of[f], 48, 48, 0, &info), *out, *converted;
      GstVideoConverter *converter;
      GstVideoFrame from, to;

      add_quads (buffer, &q, 1);
      out = draw ("fill-opacity=1", &info, buffer);
      converted = picture ("RGBA", 48, 48, 0, &rgb);
      converter = gst_video_converter_new (&info, &rgb, NULL);
      fail_unless (gst_video_frame_map (&from, &info, out, GST_MAP_READ));
      fail_unless (gst_video_frame_map (&to, &rgb, converted, GST_MAP_WRITE));
      gst_video_converter_frame (converter, &from, &to);
      for (c = 0; c < 3; c++) {
        gint got = *pixel (&to, c, 24, 24);

        /* the converter's fast paths are a few levels off */
        fail_unless (ABS (got - ends[e].rgb[c]) <= (f < 2 ? 1 : 5),
            "%s confidence %.2f component %u: %d, not %d", of[f],
            ends[e].confidence, c, got, ends[e].rgb[c]);
      }
      gst_video_frame_unmap (&from);
      gst_video_frame_unmap (&to);
      gst_video_converter_free (converter);
      gst_buffer_unref (converted);
      gst_buffer_unref (out);
    }
  }
}

GST_END_TEST;

/* Half opacity is half way, and alpha rises towards opaque. */
GST_START_TEST (test_opacity)
{
  GstClothQuad q = quad_at (8, 8, 32, 1);
  GstVideoInfo info;
  GstBuffer *buffer = picture ("RGBA", 48, 48, 0, &info), *out;
  GstVideoFrame frame;

  add_quads (buffer, &q, 1);
  out = draw ("fill-opacity=0.5", &info, buffer);
  fail_unless (gst_video_frame_map (&frame, &info, out, GST_MAP_READ));
  fail_unless (ABS (*pixel (&frame, 0, 24, 24) - (128 + 255) / 2) <= 1);
  fail_unless (ABS (*pixel (&frame, 1, 24, 24) - (128 + 237) / 2) <= 1);
  fail_unless (ABS (*pixel (&frame, 2, 24, 24) - (128 + 38) / 2) <= 1);
  fail_unless (ABS (*pixel (&frame, 3, 24, 24) - (128 + 255) / 2) <= 1);
  fail_unless_equals_int (*pixel (&frame, 0, 2, 2), FILL);
  gst_video_frame_unmap (&frame);
  gst_buffer_unref (out);
}

GST_END_TEST;

/* A predicted square is dashed and hollow, a lost one is not there. All around it would be more
 * than 200 bright samples. */
GST_START_TEST (test_states)
{
  GstClothQuad q[3] = {
    quad_at (5, 5, 30, 0.9f), quad_at (45, 5, 30, 0.9f), quad_at (85, 5, 30,
        0.9f)
  };
  guint drawn[3] = { 0 }, bright[3] = { 0 };
  GstVideoInfo info;
  GstBuffer *buffer = picture ("GRAY8", 120, 40, 0, &info), *out;
  GstVideoFrame frame;
  gint x, y;

  q[1].state = GST_CLOTH_QUAD_PREDICTED;
  q[2].state = GST_CLOTH_QUAD_LOST;
  add_quads (buffer, q, 3);
  out = draw ("", &info, buffer);
  fail_unless (gst_video_frame_map (&frame, &info, out, GST_MAP_READ));
  for (y = 0; y < 40; y++) {
    for (x = 0; x < 120; x++) {
      drawn[x / 40] += *pixel (&frame, 0, x, y) != FILL;
      bright[x / 40] += *pixel (&frame, 0, x, y) > FILL + 20;
    }
  }
  fail_unless (*pixel (&frame, 0, 20, 20) != FILL);
  fail_unless_equals_int (*pixel (&frame, 0, 60, 20), FILL);
  gst_video_frame_unmap (&frame);
  GST_INFO ("samples drawn: tracked %u, predicted %u, lost %u", drawn[0],
      drawn[1], drawn[2]);
  fail_unless (drawn[0] > 900);
  /* dashes, whose dark edges touch */
  fail_unless (bright[1] > 60 && bright[1] < 200, "%u", bright[1]);
  fail_unless (drawn[1] < 600);
  fail_unless_equals_int (drawn[2], 0);
  gst_buffer_unref (out);
}

GST_END_TEST;

GST_START_TEST (test_saddles)
{
  const GstClothSaddle s[2] = {
    {12.5f, 20.25f, 1, 0, 1e-4f, 0, 1e-4f}, {40, 9, 1, 0, 1e-4f, 0, 1e-4f}
  };
  const GstClothCandidate c[2] = { {25, 30, 1}, {26, 30, 1} };
  const Line crosses[4] = {
    {8.5, 20.25, 16.5, 20.25}, {12.5, 16.25, 12.5, 24.25},
    {36, 9, 44, 9}, {40, 5, 40, 13}
  };
  const Line dots[2] = { {25, 30, 25, 30}, {26, 30, 26, 30} };
  GstVideoInfo info;
  GstBuffer *buffer = picture ("NV12", 61, 43, 5, &info), *out;

  add_saddles (buffer, s, 2, c, 2);
  out = draw ("draw-saddles=true line-width=1", &info, buffer);
  fail_unless (check_lines (out, &info, crosses, 4, 1 + EDGES) > 60);
  gst_buffer_unref (out);

  buffer = picture ("NV12", 61, 43, 5, &info);
  add_saddles (buffer, NULL, 0, c, 2);
  out = draw ("draw-saddles=true line-width=1", &info, buffer);
  fail_unless (check_lines (out, &info, dots, 2, 1 + EDGES) >= 2);
  gst_buffer_unref (out);

  buffer = picture ("NV12", 61, 43, 5, &info);
  add_saddles (buffer, s, 2, c, 2);
  out = draw ("", &info, buffer);
  fail_unless (out == buffer);
  gst_buffer_unref (out);
}

GST_END_TEST;

/* The ellipse p' C^-1 p = scale², C with sigmas 0.1 and 0.05 px turned by 30 degrees. */
GST_START_TEST (test_covariance_ellipse)
{
  const gdouble a = 10, b = 5, angle = G_PI / 6;
  GstClothSaddle s = { 30, 25, 1, 0, 0, 0, 0 };
  gdouble ca = cos (angle), sa = sin (angle);
  Line lines[722];
  GstVideoInfo info;
  GstBuffer *buffer = picture ("GRAY8", 60, 50, 0, &info), *out;
  guint i;

  s.cov_xx = (gfloat) (1e-4 * (a * a * ca * ca + b * b * sa * sa));
  s.cov_xy = (gfloat) (1e-4 * (a * a - b * b) * ca * sa);
  s.cov_yy = (gfloat) (1e-4 * (a * a * sa * sa + b * b * ca * ca));
  for (i = 0; i < 720; i++) {
    gdouble t = G_PI * i / 360, u = G_PI * (i + 1) / 360;

    lines[i].x0 = 30 + a * cos (t) * ca - b * sin (t) * sa;
    lines[i].y0 = 25 + a * cos (t) * sa + b * sin (t) * ca;
    lines[i].x1 = 30 + a * cos (u) * ca - b * sin (u) * sa;
    lines[i].y1 = 25 + a * cos (u) * sa + b * sin (u) * ca;
  }
  lines[720] = (Line) {
  26, 25, 34, 25};
  lines[721] = (Line) {
  30, 21, 30, 29};
  add_saddles (buffer, &s, 1, NULL, 0);
  out =
      draw ("draw-saddles=true line-width=1.5 ellipse-scale=100", &info,
      buffer);
  /* chords of the drawn polygon stay within 0.35 px of the curve */
  fail_unless (check_lines (out, &info, lines, 722, 2.2 + EDGES) > 100);
  gst_buffer_unref (out);
}

GST_END_TEST;

/* The index is written inside its square and differs from square to square. */
GST_START_TEST (test_indices)
{
  GstVideoInfo info;
  GstBuffer *first = NULL;
  gint round;

  for (round = 0; round < 2; round++) {
    GstClothQuad q = quad_at (8, 8, 40, 1);
    GstBuffer *buffer = picture ("GRAY8", 56, 56, 0, &info), *out;
    GstVideoFrame frame;
    guint inside = 0;
    gint x, y;

    q.column += round;
    add_quads (buffer, &q, 1);
    out = draw ("draw-quads=false draw-indices=true", &info, buffer);
    fail_unless (gst_video_frame_map (&frame, &info, out, GST_MAP_READ));
    for (y = 0; y < 56; y++) {
      for (x = 0; x < 56; x++) {
        gboolean is_inside = x > 8 && x < 48 && y > 8 && y < 48;

        fail_unless (is_inside || *pixel (&frame, 0, x, y) == FILL);
        inside += *pixel (&frame, 0, x, y) != FILL;
      }
    }
    gst_video_frame_unmap (&frame);
    fail_unless (inside > 60, "%u", inside);
    if (first) {
      GstMapInfo map;

      gst_buffer_map (first, &map, GST_MAP_READ);
      fail_unless (gst_buffer_memcmp (out, 0, map.data, map.size) != 0);
      gst_buffer_unmap (first, &map);
      gst_buffer_unref (out);
    } else {
      first = out;
    }
  }
  gst_buffer_unref (first);
}

GST_END_TEST;

static Suite *
clothoverlay_suite (void)
{
  Suite *s = suite_create ("clothoverlay");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_add_loop_test (tc, test_formats, 0, G_N_ELEMENTS (formats));
  tcase_add_test (tc, test_plain_layout);
  tcase_add_test (tc, test_nothing_to_draw);
  tcase_add_test (tc, test_shared_buffer);
  tcase_add_test (tc, test_confidence_colours);
  tcase_add_test (tc, test_opacity);
  tcase_add_test (tc, test_states);
  tcase_add_test (tc, test_saddles);
  tcase_add_test (tc, test_covariance_ellipse);
  tcase_add_test (tc, test_indices);
  return s;
}

GST_CHECK_MAIN (clothoverlay);
