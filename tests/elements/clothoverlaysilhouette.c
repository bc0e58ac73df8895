/* clothoverlay: what is cloth is tinted, its border is drawn, and nothing else changes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/elements/clothoverlayscene.h"

#define WIDTH 91
#define HEIGHT 73

/* An L, a piece with a hole, one pixel, and rows without cloth between them. */
static gboolean
is_cloth (gint x, gint y, gint width, gint height)
{
  if (x < 0 || y < 0 || x >= width || y >= height)
    return FALSE;
  if (y < 20)
    return (x >= 3 && x < 9 && y >= 4) || (x >= 3 && x < 25 && y >= 13);
  if (y >= 24 && y < 33)
    return (x >= 5 && x < 30) && !(x >= 10 && x < 14 && y >= 27 && y < 30);
  return x == width - 1 && y == height - 1;
}

static GstBuffer *
draw_silhouette (const gchar * properties, const gchar * format, gint width,
    gint height, gboolean empty, GstVideoInfo * info)
{
  GstBuffer *buffer = picture (format, WIDTH, HEIGHT, 5, info);
  g_autoptr (GArray) runs = g_array_new (FALSE, FALSE, sizeof (GstClothRun));

  for (gint y = 0; y < height && !empty; y++) {
    for (gint x = 0; x < width; x++) {
      GstClothRun run = { (guint16) y, (guint16) x, 0 };

      if (!is_cloth (x, y, width, height))
        continue;
      while (is_cloth (x, y, width, height))
        x++;
      run.end = (guint16) x;
      g_array_append_val (runs, run);
    }
  }
  gst_buffer_add_cloth_silhouette_meta (buffer,
      gst_cloth_silhouette_new ("cam0", 0, (guint) width, (guint) height,
          (const GstClothRun *) runs->data, runs->len));
  return draw (properties, info, buffer);
}

/* Each sample by the pixels of the silhouette under it and around it. */
static void
check_tint (GstBuffer * buffer, GstVideoInfo * info, gint width, gint height)
{
  GstVideoFrame frame;
  guint n_cloth = 0;

  fail_unless (gst_video_frame_map (&frame, info, buffer, GST_MAP_READ));
  for (gint y = 0; y < HEIGHT; y++) {
    for (gint x = 0; x < WIDTH; x++) {
      const gint value = GST_VIDEO_FRAME_PLANE_DATA (&frame, 0)
          ? ((const guint8 *) GST_VIDEO_FRAME_PLANE_DATA (&frame, 0))
          [y * GST_VIDEO_FRAME_PLANE_STRIDE (&frame, 0) +
          x * GST_VIDEO_FRAME_COMP_PSTRIDE (&frame, 0)] : 0;
      guint n = 0, near = 0;

      /* two px around: the border is one of them wide at most */
      for (gint i = -4; i <= 4; i++) {
        for (gint k = -4; k <= 4; k++) {
          const gint u = (gint) floor ((x + 0.5 + 0.5 * i) * width / WIDTH);
          const gint v = (gint) floor ((y + 0.5 + 0.5 * k) * height / HEIGHT);

          n++;
          near += is_cloth (u, v, width, height);
        }
      }
      if (near == 0)
        fail_unless_equals_int (value, FILL);
      if (near == n) {
        n_cloth++;
        fail_if (value == FILL);
      }
    }
  }
  fail_unless (n_cloth > 20 || width > WIDTH, "%u", n_cloth);
  gst_video_frame_unmap (&frame);
}

GST_START_TEST (test_tint)
{
  static const gint sizes[][2] = { {WIDTH, HEIGHT}, {45, 36}, {182, 146} };

  for (guint i = 0; i < G_N_ELEMENTS (sizes); i++) {
    for (guint k = 0; k < G_N_ELEMENTS (formats); k++) {
      GstVideoInfo info;
      GstBuffer *out = draw_silhouette ("line-width=1", formats[k], sizes[i][0],
          sizes[i][1], FALSE, &info);

      /* Where luma lies apart, or the picture is grey. */
      if (info.finfo->format == GST_VIDEO_FORMAT_GRAY8 ||
          GST_VIDEO_INFO_N_PLANES (&info) > 1)
        check_tint (out, &info, sizes[i][0], sizes[i][1]);
      check_padding (out, &info, 5);
      gst_buffer_unref (out);
    }
  }
}

GST_END_TEST;

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

GST_START_TEST (test_switch)
{
  GstVideoInfo info;

  check_untouched (draw_silhouette ("draw-silhouette=false", "I420", 45, 36,
          FALSE, &info));
  check_untouched (draw_silhouette ("opacity=0", "I420", 45, 36, FALSE, &info));
  check_untouched (draw_silhouette ("", "I420", 45, 36, TRUE, &info));
}

GST_END_TEST;

/* Each pixel is a run of its own, in a large silhouette: the work is bounded. */
GST_START_TEST (test_many_runs)
{
  g_autofree GstClothRun *runs = g_new (GstClothRun, GST_CLOTH_MAX_RUNS);
  GstVideoInfo info;
  GstBuffer *buffer = picture ("I420", WIDTH, HEIGHT, 0, &info);

  for (guint i = 0; i < GST_CLOTH_MAX_RUNS; i++) {
    runs[i].row = (guint16) (i / 8192);
    runs[i].begin = (guint16) (2 * (i % 8192));
    runs[i].end = (guint16) (runs[i].begin + 1);
  }
  gst_buffer_add_cloth_silhouette_meta (buffer,
      gst_cloth_silhouette_new ("cam0", 0, 16384, 16384, runs,
          GST_CLOTH_MAX_RUNS));
  gst_buffer_unref (draw ("", &info, buffer));
}

GST_END_TEST;

static Suite *
clothoverlaysilhouette_suite (void)
{
  Suite *s = suite_create ("clothoverlaysilhouette");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, test_tint);
  tcase_add_test (tc, test_switch);
  tcase_add_test (tc, test_many_runs);
  return s;
}

GST_CHECK_MAIN (clothoverlaysilhouette);
