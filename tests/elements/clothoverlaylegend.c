/* clothoverlay: words over the film. What they are can't be read here: the same facts give the
 * same samples, and others give others.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/elements/clothoverlayscene.h"

#include <gst/check/gsttestclock.h>

#define WIDTH 320
#define HEIGHT 240
/* Three lines. */
#define WORDS 72

/* The samples of luma where the words are, and what is below as it was. */
static GBytes *
take_words (GstBuffer * buffer, GstVideoInfo * info)
{
  GByteArray *words = g_byte_array_new ();
  GstVideoFrame frame;

  fail_unless (buffer != NULL);
  fail_unless (gst_video_frame_map (&frame, info, buffer, GST_MAP_READ));
  for (gint y = 0; y < HEIGHT; y++) {
    for (gint x = 0; x < WIDTH; x++) {
      const guint8 value = *pixel (&frame, 0, x, y);

      if (y < WORDS) {
        g_byte_array_append (words, &value, 1);
      } else if (y < 100) {
        fail_unless_equals_int (value, FILL);
      }
    }
  }
  gst_video_frame_unmap (&frame);
  gst_buffer_unref (buffer);
  return g_byte_array_free_to_bytes (words);
}

static guint
count_changed (GBytes * words)
{
  gsize size;
  const guint8 *at = g_bytes_get_data (words, &size);
  guint n = 0;

  for (gsize i = 0; i < size; i++) {
    n += at[i] != FILL;
  }
  return n;
}

/* A picture with @n squares far below the words. */
static GstBuffer *
squares (guint n, guint64 number, const gchar * camera, GstVideoInfo * info)
{
  GstBuffer *buffer = picture ("I420", WIDTH, HEIGHT, 5, info);
  GstClothQuad quads[4];

  for (guint i = 0; i < n; i++) {
    quads[i] = quad_at (20 + 40 * (gfloat) i, 150, 30, 1);
  }
  gst_buffer_add_cloth_quads_meta (buffer, gst_cloth_quads_new (camera, number,
          40, 30, quads, n));
  return buffer;
}

static GBytes *
words_of (const gchar * properties, guint n, guint64 number,
    const gchar * camera)
{
  GstVideoInfo info;
  GstBuffer *buffer = squares (n, number, camera, &info);

  return take_words (draw (properties, &info, buffer), &info);
}

GST_START_TEST (test_facts)
{
  g_autoptr (GBytes) none = words_of ("", 2, 7, "cam0");
  g_autoptr (GBytes) first = words_of ("draw-legend=true", 2, 7, "cam0");
  g_autoptr (GBytes) again = words_of ("draw-legend=true", 2, 7, "cam0");
  g_autoptr (GBytes) more = words_of ("draw-legend=true", 3, 7, "cam0");
  g_autoptr (GBytes) later = words_of ("draw-legend=true", 2, 8, "cam0");
  g_autoptr (GBytes) other = words_of ("draw-legend=true", 2, 7, "cam1");
  g_autoptr (GBytes) faint = words_of ("draw-legend=true opacity=0", 2, 7,
      "cam0");
  g_autoptr (GBytes) hidden = words_of ("draw-legend=true draw-quads=false", 2,
      7, "cam0");

  fail_unless_equals_int (count_changed (none), 0);
  fail_unless (count_changed (first) > 500, "%u", count_changed (first));
  fail_unless (g_bytes_equal (first, again));
  fail_if (g_bytes_equal (first, more));
  fail_if (g_bytes_equal (first, later));
  fail_if (g_bytes_equal (first, other));
  fail_unless_equals_int (count_changed (faint), 0);
  /* what is not drawn is not explained */
  fail_unless (count_changed (hidden) < count_changed (first) / 2);
  fail_unless (count_changed (hidden) > 100);
}

GST_END_TEST;

/* White with a dark edge: both are there, on grey. */
GST_START_TEST (test_legible)
{
  g_autoptr (GBytes) words = words_of ("draw-legend=true", 1, 0, "cam0");
  gsize size;
  const guint8 *at = g_bytes_get_data (words, &size);
  guint n_white = 0, n_dark = 0;

  for (gsize i = 0; i < size; i++) {
    n_white += at[i] > 200;
    n_dark += at[i] < 70;
  }
  fail_unless (n_white > 100 && n_dark > 200, "%u, %u", n_white, n_dark);
}

GST_END_TEST;

/* In every format; nothing between the rows changes. */
GST_START_TEST (test_legend_formats)
{
  GstVideoInfo info;
  GstBuffer *buffer = picture (formats[__i__], 321, 241, 5, &info), *out;
  GstVideoFrame frame;
  guint n_changed = 0;

  out = draw ("draw-legend=true", &info, buffer);
  check_padding (out, &info, 5);
  fail_unless (gst_video_frame_map (&frame, &info, out, GST_MAP_READ));
  for (gint y = 0; y < 100; y++) {
    for (gint x = 0; x < 321; x++) {
      const gboolean changed = *pixel (&frame, 0, x, y) != FILL;

      n_changed += changed;
      fail_if (changed && y > 30);
    }
  }
  gst_video_frame_unmap (&frame);
  fail_unless (n_changed > 100, "%s: %u", formats[__i__], n_changed);
  gst_buffer_unref (out);
}

GST_END_TEST;

static GBytes *
push_at (GstHarness * h, GstClockTime pts)
{
  GstVideoInfo info;
  GstBuffer *buffer = picture ("I420", WIDTH, HEIGHT, 5, &info);

  GST_BUFFER_PTS (buffer) = pts;
  fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_OK);
  return take_words (gst_harness_pull (h), &info);
}

/* Pictures that are missing by their time stamps; how fast they come by the clock. */
GST_START_TEST (test_speed)
{
  const GstClockTime period = GST_SECOND / 30;
  GstVideoInfo info;
  GstHarness *h;
  g_autoptr (GBytes) first = NULL;
  g_autoptr (GBytes) second = NULL;
  g_autoptr (GBytes) third = NULL;
  g_autoptr (GBytes) fourth = NULL;
  g_autoptr (GBytes) fast = NULL;
  g_autoptr (GBytes) slow = NULL;

  gst_buffer_unref (picture ("I420", WIDTH, HEIGHT, 5, &info));
  h = overlay ("draw-speed=true", &info);
  gst_harness_use_testclock (h);
  first = push_at (h, 0);
  second = push_at (h, period);
  /* shaken by less than half a period */
  third = push_at (h, 2 * period + period / 3);
  fail_unless (count_changed (first) > 50);
  fail_unless (g_bytes_equal (first, second));
  fail_unless (g_bytes_equal (first, third));
  fourth = push_at (h, 5 * period);
  fail_if (g_bytes_equal (first, fourth));
  /* five pictures in a second, then one in four */
  fail_unless (gst_harness_set_time (h, GST_SECOND));
  fast = push_at (h, 6 * period);
  fail_unless (count_changed (fast) > count_changed (fourth) + 50);
  fail_unless (gst_harness_set_time (h, 5 * GST_SECOND));
  slow = push_at (h, 7 * period);
  fail_if (g_bytes_equal (fast, slow));
  gst_harness_teardown (h);
}

GST_END_TEST;

/* A mesh's vertices by state, and what its colours mean. */
GST_START_TEST (test_mesh_words)
{
  static const gchar *const styles[] = { "wireframe", "shaded", "strain-warp",
    "strain-weft"
  };
  g_autofree gchar *rig = write_rig ("", "");
  GBytes *words[2 * G_N_ELEMENTS (styles)];

  for (guint i = 0; i < G_N_ELEMENTS (words); i++) {
    g_autofree gchar *properties = g_strdup_printf ("rig=%s draw-legend=true "
        "opacity=1 mesh-style=%s", rig, styles[i / 2]);
    GstVideoInfo info;
    GstBuffer *buffer = picture ("I420", 640, 480, 5, &info), *out;
    GstHarness *h = overlay (properties, &info), *m = mesh_pad (h);
    GstVideoFrame frame;

    gst_harness_push (h, buffer);
    gst_harness_push (m, mesh_buffer (COLUMNS * ROWS, i % 2 ? 5 : -1));
    out = gst_harness_pull (h);
    fail_unless (out != NULL);
    fail_unless (gst_video_frame_map (&frame, &info, out, GST_MAP_READ));
    words[i] = g_bytes_new (pixel (&frame, 0, 0, 0),
        (gsize) (110 * GST_VIDEO_FRAME_COMP_STRIDE (&frame, 0)));
    gst_video_frame_unmap (&frame);
    gst_buffer_unref (out);
    gst_harness_teardown (m);
    gst_harness_teardown (h);
  }
  for (guint i = 0; i < G_N_ELEMENTS (words); i++) {
    for (guint k = 0; k < i; k++) {
      fail_if (g_bytes_equal (words[i], words[k]), "%u, %u", i, k);
    }
  }
  for (guint i = 0; i < G_N_ELEMENTS (words); i++) {
    g_bytes_unref (words[i]);
  }
  g_unlink (rig);
}

GST_END_TEST;

/* Names that no camera has stay within the picture; a thumbnail has no room for words. */
GST_START_TEST (test_no_room)
{
  g_autofree gchar *wide = g_strnfill (2000, 'W');
  g_autoptr (GBytes) words = words_of ("draw-legend=true", 1, 0, wide);
  g_autoptr (GBytes) lines =
      words_of ("draw-legend=true", 1, 0, "a\nb\tc\033[0m");
  GstVideoInfo info;
  GstBuffer *buffer = picture ("I420", 160, 120, 5, &info), *out;

  fail_unless (count_changed (words) > 500);
  fail_unless (count_changed (lines) > 100);
  out = draw ("draw-legend=true draw-speed=true", &info, buffer);
  check_lines (out, &info, NULL, 0, 1);
  gst_buffer_unref (out);
}

GST_END_TEST;

static Suite *
clothoverlaylegend_suite (void)
{
  Suite *s = suite_create ("clothoverlaylegend");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, test_facts);
  tcase_add_test (tc, test_legible);
  tcase_add_loop_test (tc, test_legend_formats, 0, G_N_ELEMENTS (formats));
  tcase_add_test (tc, test_speed);
  tcase_add_test (tc, test_mesh_words);
  tcase_add_test (tc, test_no_room);
  return s;
}

GST_CHECK_MAIN (clothoverlaylegend);
