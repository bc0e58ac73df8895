/* clothoverlay: what is drawn of dots lies where geometry says, and nothing else changes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/elements/clothoverlayscene.h"

#define WIDTH 91
#define HEIGHT 73
#define CHORDS 12

static GstClothDot
dot_at (gint column, gint row, gfloat x, gfloat y)
{
  return (GstClothDot) {
  .column = column,.row = row,.confidence = 12,.x = x,.y = y};
}

static GstBuffer *
draw_dots (const gchar * properties, const GstClothDot * dots, guint n,
    GstVideoInfo * info)
{
  GstBuffer *buffer = picture ("GRAY8", WIDTH, HEIGHT, 5, info);

  gst_buffer_add_cloth_dots_meta (buffer, gst_cloth_dots_new ("cam0", 0, 31,
          33, 5, dots, n));
  return draw (properties, info, buffer);
}

/* The mark of a labelled dot: a ring of radius 2 px. */
static guint
ring (Line * lines, gfloat x, gfloat y)
{
  for (guint i = 0; i < CHORDS; i++) {
    const gdouble a = 2 * G_PI * i / CHORDS, b = 2 * G_PI * (i + 1) / CHORDS;

    lines[i] = (Line) {
    x + 2 * cos (a), y + 2 * sin (a), x + 2 * cos (b), y + 2 * sin (b)};
  }
  return CHORDS;
}

static Line
link_of (const GstClothDot * a, const GstClothDot * b)
{
  const gdouble dx = b->x - a->x, dy = b->y - a->y;

  return (Line) {
  a->x + 0.2 * dx, a->y + 0.2 * dy, b->x - 0.2 * dx, b->y - 0.2 * dy};
}

/* Neighbours of the pattern are linked, in whatever order they come; others are not, and
 * one without a label is crossed out. */
GST_START_TEST (test_links)
{
  const GstClothDot dots[6] = { dot_at (4, 8, 40, 50), dot_at (3, 7, 20, 20),
    dot_at (4, 7, 50, 24), dot_at (-1, -1, 70, 60), dot_at (6, 7, 78, 12),
    dot_at (30, 32, 10, 60)
  };
  Line lines[5 * CHORDS + 4];
  GstVideoInfo info;
  GstBuffer *out = draw_dots ("line-width=2", dots, 6, &info);
  guint n = 0;

  for (guint i = 0; i < 6; i++)
    if (i != 3)
      n += ring (lines + n, dots[i].x, dots[i].y);
  lines[n++] = link_of (&dots[1], &dots[2]);
  lines[n++] = link_of (&dots[2], &dots[0]);
  lines[n++] = (Line) {
  67, 57, 73, 63};
  lines[n++] = (Line) {
  67, 63, 73, 57};
  fail_unless (check_lines (out, &info, lines, n, 2 + EDGES) > 150);
  check_padding (out, &info, 5);
  gst_buffer_unref (out);
}

GST_END_TEST;

/* Every picture is drawn as if it were the only one: nothing is linked to where a dot was,
 * nor to what has its place in the list now, with another label or one there is not. */
GST_START_TEST (test_next_picture)
{
  const GstClothDot before[3] = { dot_at (5, 5, 20, 20), dot_at (30, 5, 50, 20),
    dot_at (0, 6, 20, 50)
  };
  const GstClothDot after[3] = { dot_at (30, 5, 20, 20), dot_at (9, 9, 50, 24),
    dot_at (31, 5, 60, 60)
  };
  GstVideoInfo info;
  GstBuffer *early = picture ("GRAY8", WIDTH, HEIGHT, 5, &info);
  GstBuffer *late = gst_buffer_copy_deep (early), *out;
  GstHarness *h = overlay ("", &info);

  gst_buffer_add_cloth_dots_meta (early, gst_cloth_dots_new ("cam0", 0, 31, 33,
          5, before, 3));
  gst_buffer_add_cloth_dots_meta (late, gst_cloth_dots_new ("cam0", 1, 31, 33,
          5, after, 3));
  GST_BUFFER_PTS (late) = GST_SECOND / 30;
  fail_unless_equals_int (gst_harness_push (h, early), GST_FLOW_OK);
  fail_unless_equals_int (gst_harness_push (h, late), GST_FLOW_OK);
  gst_buffer_unref (gst_harness_pull (h));
  out = gst_harness_pull (h);
  {
    GstBuffer *alone = draw_dots ("", after, 3, &info);
    GstMapInfo a, b;

    gst_buffer_map (out, &a, GST_MAP_READ);
    gst_buffer_map (alone, &b, GST_MAP_READ);
    fail_unless (a.size == b.size && memcmp (a.data, b.data, a.size) == 0);
    gst_buffer_unmap (out, &a);
    gst_buffer_unmap (alone, &b);
    gst_buffer_unref (alone);
  }
  gst_buffer_unref (out);
  gst_harness_teardown (h);
}

GST_END_TEST;

static guint8
grey_at (GstBuffer * buffer, const GstVideoInfo * info, gint x, gint y)
{
  GstVideoFrame frame;
  guint8 value;

  fail_unless (gst_video_frame_map (&frame, info, buffer, GST_MAP_READ));
  value = ((guint8 *) GST_VIDEO_FRAME_PLANE_DATA (&frame, 0))
      [y * GST_VIDEO_FRAME_PLANE_STRIDE (&frame, 0) + x];
  gst_video_frame_unmap (&frame);
  return value;
}

/* Surer labels are brighter; links seen from behind are of one colour. */
GST_START_TEST (test_colours)
{
  guint8 greys[3];

  for (guint k = 0; k < 3; k++) {
    GstClothDot dots[2] = { dot_at (0, 0, 20, 30), dot_at (1, 0, 70, 30) };
    GstVideoInfo info;
    GstBuffer *out;

    dots[0].confidence = dots[1].confidence = k == 0 ? 0.1f : 30;
    dots[0].mirrored = dots[1].mirrored = k == 2;
    out = draw_dots ("line-width=3", dots, 2, &info);
    greys[k] = grey_at (out, &info, 45, 30);
    gst_buffer_unref (out);
  }
  fail_unless (greys[0] < FILL && greys[1] > FILL + 60, "%u %u", greys[0],
      greys[1]);
  fail_unless (greys[2] != greys[1] && greys[2] != FILL, "%u", greys[2]);
}

GST_END_TEST;

GST_START_TEST (test_switches)
{
  GstClothDot dots[2] = { dot_at (12, 3, 30, 36), dot_at (13, 3, 62, 36) };
  GstVideoInfo info;
  GstBuffer *out = draw_dots ("draw-dots=false", dots, 2, &info);
  Line box = { 14, 36, 78, 36 };

  fail_unless_equals_int (check_lines (out, &info, NULL, 0, 1), 0);
  gst_buffer_unref (out);
  /* numbers on both dots, near them and nowhere else */
  out = draw_dots ("draw-dots=false draw-indices=true", dots, 2, &info);
  {
    guint changed = 0;

    for (gint y = 0; y < HEIGHT; y++) {
      for (gint x = 0; x < WIDTH; x++) {
        if (grey_at (out, &info, x, y) != FILL) {
          changed++;
          fail_unless (distance (x, y, box.x0, box.y0, box.x1, box.y1) < 16);
        }
      }
    }
    fail_unless (changed > 40, "%u", changed);
  }
  gst_buffer_unref (out);
}

GST_END_TEST;

/* Labels that no pattern has, one label for several dots, places far away or not finite:
 * nothing is written outside the picture. */
GST_START_TEST (test_wild_dots)
{
  static const gint wild[] = { -2, -1, 0, 30, 31, 65535, G_MAXINT, G_MININT };
  static const gfloat places[] = { NAN, INFINITY, -INFINITY, 1e30f, -40, 30 };
  GstClothDot dots[8 * 8 * 6];
  GstVideoInfo info;
  GstBuffer *out;
  guint n = 0;

  for (guint i = 0; i < 8; i++)
    for (guint j = 0; j < 8; j++)
      for (guint k = 0; k < 6; k++, n++) {
        dots[n] = dot_at (wild[i], wild[j], places[k], places[(k + j) % 6]);
        dots[n].confidence = places[(k + i) % 6];
      }
  out = draw_dots ("draw-indices=true", dots, n, &info);
  check_padding (out, &info, 5);
  gst_buffer_unref (out);
}

GST_END_TEST;

static Suite *
clothoverlaydots_suite (void)
{
  Suite *s = suite_create ("clothoverlaydots");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, test_links);
  tcase_add_test (tc, test_next_picture);
  tcase_add_test (tc, test_colours);
  tcase_add_test (tc, test_switches);
  tcase_add_test (tc, test_wild_dots);
  return s;
}

GST_CHECK_MAIN (clothoverlaydots);
