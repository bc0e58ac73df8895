/* siftmatch: what it finds in a rendered film and in pictures of a known print; formats,
 * masks, surfaces, events, warnings, refusals.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/app/gstappsink.h>
#include <gst/check/check.h>
#include <gst/check/gstharness.h>
#include <gst/cloth/cloth.h>
#include <gst/video/video.h>
#include <glib/gstdio.h>
#include <malloc.h>
#include <math.h>
#include <string.h>

#include "tests/common/npyfloats.h"
#include "tests/elements/padded.h"
#include "tests/elements/values.h"

/* A print of 1 mm pixels, and pictures that show it as it is, at (LEFT, TOP). */
#define PRINT 200
#define GRID 11
#define WIDTH 321
#define HEIGHT 243
#define LEFT 60
#define TOP 20

/* Of the rendered film. */
#define FILM TEST_DATA "/lineart_stereo3"
#define COLUMNS 33
#define ROWS 35

static gchar *folder;
static guint8 *print;

/* Discs of all sizes, from a generator of its own: equal on every machine. */
static void
draw_print (void)
{
  guint32 state = 12345;

  print = g_malloc (PRINT * PRINT);
  memset (print, 120, PRINT * PRINT);
  for (guint k = 0; k < 900; k++) {
    gdouble numbers[4];

    for (guint i = 0; i < 4; i++) {
      state = state * 1664525u + 1013904223u;
      numbers[i] = (state >> 8) / 16777216.;
    }
    for (gint y = 0; y < PRINT; y++)
      for (gint x = 0; x < PRINT; x++)
        if (hypot (x - PRINT * numbers[0], y - PRINT * numbers[1]) <
            2 + 7 * numbers[2] * numbers[2])
          print[y * PRINT + x] = (guint8) (30 + 200 * numbers[3]);
  }
}

static void
setup (void)
{
  folder = g_dir_make_tmp ("siftmatch-XXXXXX", NULL);
  draw_print ();
}

static void
teardown (void)
{
  static const gchar *const names[] = { "print.png", "pattern.json" };

  for (guint i = 0; i < G_N_ELEMENTS (names); i++) {
    g_autofree gchar *path = g_build_filename (folder, names[i], NULL);

    g_remove (path);
  }
  g_rmdir (folder);
  g_clear_pointer (&folder, g_free);
  g_clear_pointer (&print, g_free);
}

static GstVideoInfo
info_of (const gchar * format, gint width, gint height)
{
  GstVideoInfo info;

  gst_video_info_set_format (&info, gst_video_format_from_string (format),
      (guint) width, (guint) height);
  info.fps_n = 25;
  info.fps_d = 1;
  return info;
}

static void
set_caps (GstHarness * h, const GstVideoInfo * info)
{
  gst_harness_set_src_caps (h, gst_video_info_to_caps (info));
}

/* The print at (@left, TOP), as in a mirror when it is seen from @behind. */
static GstBuffer *
picture_of (const GstVideoInfo * info, gint left, gboolean behind, gint padding)
{
  Luma place;
  GstBuffer *buffer = padded_picture (info, padding, 120, &place);
  GstMapInfo map;

  gst_buffer_map (buffer, &map, GST_MAP_WRITE);
  for (gint y = 0; y < GST_VIDEO_INFO_HEIGHT (info); y++)
    for (gint x = 0; x < GST_VIDEO_INFO_WIDTH (info); x++) {
      const gint i = behind ? PRINT - 1 - (x - left) : x - left, j = y - TOP;

      if (i >= 0 && i < PRINT && j >= 0 && j < PRINT)
        map.data[place.offset + (gsize) (y * place.stride + x)] =
            print[j * PRINT + i];
    }
  gst_buffer_unmap (buffer, &map);
  GST_BUFFER_PTS (buffer) = 0;
  return buffer;
}

static GstBuffer *
picture (const GstVideoInfo * info)
{
  return picture_of (info, LEFT, FALSE, 0);
}

/* Writes what @pixels show as the picture of the print. */
static void
write_picture (const guint8 * pixels, guint width, guint height)
{
  g_autofree gchar *path = g_build_filename (folder, "print.png", NULL);
  const GstVideoInfo info = info_of ("GRAY8", (gint) width, (gint) height);
  GstHarness *h = gst_harness_new_parse ("pngenc");
  GstBuffer *in = gst_buffer_new_allocate (NULL, GST_VIDEO_INFO_SIZE (&info),
      NULL), *out;
  GstMapInfo map;

  for (guint y = 0; y < height; y++)
    gst_buffer_fill (in,
        (gsize) y * (gsize) GST_VIDEO_INFO_PLANE_STRIDE (&info, 0),
        pixels + y * width, width);
  set_caps (h, &info);
  out = gst_harness_push_and_pull (h, in);
  gst_buffer_map (out, &map, GST_MAP_READ);
  fail_unless (g_file_set_contents (path, (const gchar *) map.data,
          (gssize) map.size, NULL));
  gst_buffer_unmap (out, &map);
  gst_buffer_unref (out);
  gst_harness_teardown (h);
}

static gchar *
write_text (const gchar * text)
{
  gchar *path = g_build_filename (folder, "pattern.json", NULL);

  fail_unless (g_file_set_contents (path, text, -1, NULL));
  return path;
}

static gchar *
write_pattern (guint sides)
{
  g_autofree gchar *text = g_strdup_printf ("{\"version\": 1, \"pattern\": "
      "\"picture\", \"reference\": \"print.png\", \"cloth_m\": [0.2, 0.2], "
      "\"columns\": %d, \"rows\": %d, \"sides\": %u}", GRID, GRID, sides);

  write_picture (print, PRINT, PRINT);
  return write_text (text);
}

/* An element that has looked at the print; not at its oblique views unless @properties say so,
 * since that takes longer than most tests. @bus: (nullable): what it says from its start on. */
static GstHarness *
harness_on (const gchar * properties, const gchar * path, GstBus * bus)
{
  g_autofree gchar *line = g_strdup_printf ("siftmatch camera=left "
      "oblique=0 pattern=\"%s\" %s", path, properties);
  g_autoptr (GError) error = NULL;
  GstElement *element = gst_parse_launch (line, &error);
  GstHarness *h;

  g_assert_no_error (error);
  gst_element_set_bus (element, bus);
  h = gst_harness_new_with_element (gst_object_ref_sink (element), "sink",
      "src");
  gst_object_unref (element);
  return h;
}

static GstHarness *
harness (const gchar * properties)
{
  g_autofree gchar *path = write_pattern (2);

  return harness_on (properties, path, NULL);
}

static guint
count_warnings (GstBus * bus, const gchar * part)
{
  GstMessage *message;
  guint n = 0;

  while ((message = gst_bus_pop (bus))) {
    if (GST_MESSAGE_TYPE (message) == GST_MESSAGE_WARNING) {
      g_autoptr (GError) warning = NULL;
      g_autofree gchar *remedy = NULL;

      gst_message_parse_warning (message, &warning, &remedy);
      fail_unless (strstr (warning->message, part) != NULL, "%s",
          warning->message);
      fail_unless (remedy && strlen (remedy) > 20);
      n++;
    }
    gst_message_unref (message);
  }
  return n;
}

/* How many matches are verified, of which 98%, but for two, must be within 3 mm of the truth; all
 * vertices must be within 0.3 px. */
static guint
check_matches (GstBuffer * buffer, gint left, gboolean behind)
{
  GstClothMatches *matches = gst_buffer_get_cloth_matches (buffer);
  guint n, n_points, n_verified = 0, n_wrong = 0;
  const GstClothMatch *match;
  const GstClothGridPoint *point;

  fail_unless (matches != NULL);
  match = gst_cloth_matches_get_matches (matches, &n);
  point = gst_cloth_matches_get_points (matches, &n_points);
  fail_unless_equals_string (gst_cloth_matches_get_camera (matches), "left");
  fail_unless_equals_int (gst_cloth_matches_get_columns (matches), GRID);
  fail_unless (n <= gst_cloth_matches_get_n_features (matches));
  for (guint i = 0; i < n; i++) {
    const gdouble u = behind ? 0.001 * (PRINT - (match[i].x + 0.5 - left)) :
        0.001 * (match[i].x + 0.5 - left);

    if (!match[i].verified)
      continue;
    n_verified++;
    fail_unless_equals_int (match[i].mirrored, behind);
    n_wrong += hypot (match[i].u - u, match[i].v - 0.001 * (match[i].y + 0.5
            - TOP)) > 0.003;
  }
  fail_unless (n_wrong <= 2 + n_verified / 50, "%u of %u are wrong", n_wrong,
      n_verified);
  for (guint i = 0; i < n_points; i++) {
    const gdouble across = (gdouble) point[i].column * PRINT / (GRID - 1);
    const gdouble x = left + (behind ? PRINT - across : across) - 0.5;
    const gdouble y = TOP + (gdouble) point[i].row * PRINT / (GRID - 1) - 0.5;

    fail_unless (hypot (point[i].x - x, point[i].y - y) < 0.3, "%g %g",
        point[i].x - x, point[i].y - y);
    fail_unless (point[i].cov_xx > 0 && point[i].cov_yy > 0);
  }
  return n_verified;
}

/* ---- what it finds ---- */

/* Where the film shows a place of the cloth, and how many metres a pixel is there. */
static void
look (const gfloat * vertices, gdouble u, gdouble v, gdouble at[2],
    gdouble * metres)
{
  const gdouble s = u / 0.63 * (COLUMNS - 1), t = v / 0.67 * (ROWS - 1);
  const gint column = CLAMP ((gint) s, 0, COLUMNS - 2);
  const gint row = CLAMP ((gint) t, 0, ROWS - 2);
  const gfloat *a = vertices + 3 * (row * COLUMNS + column);
  const gfloat *b = a + 3 * COLUMNS;
  const gdouble p = s - column, q = t - row;
  gdouble x[3];

  for (gint c = 0; c < 3; c++)
    x[c] = (1 - q) * ((1 - p) * a[c] + p * a[3 + c]) + q * ((1 - p) * b[c]
        + p * b[3 + c]);
  /* the pose in the film's rig.json */
  at[0] = 511.5 + 12800 / 9. * x[0] / (1.6 + x[1]);
  at[1] = 383.5 + 12800 / 9. * (0.85 - x[2]) / (1.6 + x[1]);
  *metres = (1.6 + x[1]) * 9 / 12800;
}

/* The first pictures of the film, in which the cloth begins to fall and is seen from the front. */
GST_START_TEST (test_film)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (GstElement) pipeline = gst_parse_launch ("filesrc location=\""
      FILM "/cam0.mp4\" ! qtdemux ! h264parse ! avdec_h264 max-threads=1 ! "
      "siftmatch camera=cam0 pattern=\"" FILM
      "/pattern.json\" ! " "appsink name=sink sync=false max-buffers=1",
      &error);
  g_autoptr (GstElement) sink = NULL;
  g_autoptr (GstBus) bus = NULL;
  g_autofree gfloat *vertices = NULL;
  ClothNpyInfo npy;
  guint frame = 0;

  g_assert_no_error (error);
  vertices = load_npy_floats (FILM "/vertices.npy", &npy, &error);
  g_assert_no_error (error);
  sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");
  bus = gst_element_get_bus (pipeline);
  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  for (; frame < 3; frame++) {
    g_autoptr (GstSample) sample =
        gst_app_sink_try_pull_sample (GST_APP_SINK (sink), 100 * GST_SECOND);
    const gfloat *of = vertices + (gsize) frame * 3 * COLUMNS * ROWS;
    guint n, n_points, n_verified = 0, n_right = 0, n_near = 0;
    const GstClothMatch *match;
    const GstClothGridPoint *point;
    GstClothMatches *matches;
    gdouble at[2], metres;

    fail_unless (sample != NULL);
    matches = gst_buffer_get_cloth_matches (gst_sample_get_buffer (sample));
    fail_unless (matches != NULL);
    fail_unless_equals_uint64 (gst_cloth_matches_get_sequence (matches), frame);
    fail_unless (!gst_cloth_matches_get_on_surface (matches));
    match = gst_cloth_matches_get_matches (matches, &n);
    for (guint i = 0; i < n; i++)
      if (match[i].verified) {
        look (of, match[i].u, match[i].v, at, &metres);
        n_verified++;
        n_right += metres * hypot (at[0] - match[i].x, at[1] - match[i].y) <
            0.003;
      }
    point = gst_cloth_matches_get_points (matches, &n_points);
    for (guint i = 0; i < n_points; i++) {
      look (of, 0.63 * point[i].column / (COLUMNS - 1),
          0.67 * point[i].row / (ROWS - 1), at, &metres);
      n_near += hypot (at[0] - point[i].x, at[1] - point[i].y) < 1;
    }
    g_print ("frame %u: %u features, %u verified, %u right, %u of %u vertices "
        "within 1 px\n", frame, gst_cloth_matches_get_n_features (matches),
        n_verified, n_right, n_near, n_points);
    fail_unless (n_verified * 2 > gst_cloth_matches_get_n_features (matches));
    fail_unless (n_right >= 0.97 * n_verified);
    fail_unless (n_points >= 1050);
    fail_unless (n_near >= 0.95 * n_points);
  }
  gst_element_set_state (pipeline, GST_STATE_NULL);
  fail_unless_equals_int (count_warnings (bus, ""), 0);
}

GST_END_TEST;

/* Same luma, same matches; whatever lies around it. */
GST_START_TEST (test_formats)
{
  static const gchar *const formats[] = { "GRAY8", "I420", "NV12", "Y444",
    "YUV9", "Y42B"
  };
  GstHarness *h = harness ("");
  g_autoptr (GBytes) first = NULL;

  for (guint i = 0; i < G_N_ELEMENTS (formats); i++)
    for (gint padding = 0; padding <= 5; padding += 5) {
      const GstVideoInfo info = info_of (formats[i], WIDTH, HEIGHT);
      g_autoptr (GstBuffer) out = NULL;
      g_autoptr (GBytes) table = NULL;

      set_caps (h, &info);
      out = gst_harness_push_and_pull (h, picture_of (&info, LEFT, FALSE,
              padding));
      fail_unless (check_matches (out, LEFT, FALSE) > 300);
      table = gst_cloth_matches_get_table (gst_buffer_get_cloth_matches (out));
      if (first)
        fail_unless (g_bytes_equal (first, table));
      else
        first = g_steal_pointer (&table);
    }
  gst_harness_teardown (h);
}

GST_END_TEST;

/* The back shows the print mirrored; both pictures are told apart. */
GST_START_TEST (test_back)
{
  GstHarness *h = harness ("oblique=1");
  const GstVideoInfo info = info_of ("I420", WIDTH, HEIGHT);

  set_caps (h, &info);
  for (gint i = 0; i < 4; i++) {
    g_autoptr (GstBuffer) out = gst_harness_push_and_pull (h,
        picture_of (&info, LEFT + 10 * i, i % 2, 0));

    fail_unless (check_matches (out, LEFT + 10 * i, i % 2) > 300);
  }
  gst_harness_teardown (h);
}

GST_END_TEST;

/* ---- where it looks ---- */

static GstBuffer *
push_masked (GstHarness * h, const GstVideoInfo * info,
    GstClothSilhouette * silhouette)
{
  GstBuffer *in = picture (info);

  if (silhouette)
    gst_buffer_add_cloth_silhouette_meta (in, silhouette);
  return gst_harness_push_and_pull (h, in);
}

/* All of a picture of @width by @height px left of column @end. */
static GstClothSilhouette *
left_of (guint width, guint height, guint end)
{
  g_autofree GstClothRun *runs = g_new (GstClothRun, height);

  for (guint y = 0; y < height; y++)
    runs[y] = (GstClothRun) {
    (guint16) y, 0, (guint16) end};
  return gst_cloth_silhouette_new ("left", 0, width, height, runs,
      end ? height : 0);
}

GST_START_TEST (test_silhouette)
{
  GstHarness *h = harness ("");
  const GstVideoInfo info = info_of ("I420", WIDTH, HEIGHT);
  g_autoptr (GBytes) whole = NULL;

  set_caps (h, &info);
  for (guint i = 0; i < 6; i++) {
    GstClothSilhouette *silhouettes[] = { NULL, left_of (WIDTH, HEIGHT, WIDTH),
      left_of (WIDTH, HEIGHT, 160), left_of (2 * WIDTH, 3 * HEIGHT, 320),
      left_of (WIDTH, HEIGHT, 0), left_of (1, 1, 1)
    };
    g_autoptr (GstBuffer) out = push_masked (h, &info, silhouettes[i]);
    g_autoptr (GBytes) table = NULL;
    GstClothMatches *matches = gst_buffer_get_cloth_matches (out);
    const GstClothMatch *match;
    guint n, n_verified = check_matches (out, LEFT, FALSE);

    for (guint k = 0; k < G_N_ELEMENTS (silhouettes); k++)
      if (k != i && silhouettes[k])
        gst_cloth_silhouette_unref (silhouettes[k]);
    match = gst_cloth_matches_get_matches (matches, &n);
    table = gst_cloth_matches_get_table (matches);
    if (i == 0)
      whole = g_bytes_ref (table);
    else if (i == 1 || i == 5)
      fail_unless (g_bytes_equal (whole, table));
    if (i == 2 || i == 3) {
      fail_unless (n_verified > 100);
      for (guint k = 0; k < n; k++)
        fail_unless (match[k].x < 161);
    }
    if (i == 4) {
      fail_unless_equals_int (n, 0);
      fail_unless_equals_int (gst_cloth_matches_get_n_features (matches), 0);
      fail_unless_equals_int (gst_cloth_matches_get_n_points (matches), 0);
    }
  }
  gst_harness_teardown (h);
}

GST_END_TEST;

/* A flat print 1 m before a camera of 1000 px, seen by pixels of @scale. What is right of the
 * middle is outside, unless all is @whole. */
static GstClothDisparity *
flat (gdouble scale, gboolean whole)
{
  const guint width = (guint) (scale * WIDTH), height =
      (guint) (scale * HEIGHT), n = width * height;
  const gdouble normal[3] = { 0, 0, 1 }, turn[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1
  }, shift[3] = { 0 };
  g_autofree gfloat *rays = g_new (gfloat, 2 * n);
  g_autofree gfloat *disparities = g_new (gfloat, n);
  g_autofree guint8 *states = g_malloc (n);
  g_autoptr (GstClothStereo) stereo = NULL;

  for (guint y = 0; y < height; y++)
    for (guint x = 0; x < width; x++) {
      const guint i = y * width + x;

      rays[2 * i] = (gfloat) (0.001 * ((x + 0.5) / scale - 160));
      rays[2 * i + 1] = (gfloat) (0.001 * ((y + 0.5) / scale - 120));
      disparities[i] = 100;
      states[i] = whole || x < width / 2 ? GST_CLOTH_DISPARITY_MEASURED :
          GST_CLOTH_DISPARITY_OUTSIDE;
    }
  stereo = gst_cloth_stereo_new (width, height, rays, 2 * n, normal, 100, turn,
      shift, 2);
  return gst_cloth_disparity_new ("left", 0, stereo, 0.1f, disparities, n,
      states, n);
}

GST_START_TEST (test_surface)
{
  static const gdouble scales[] = { 1, 2, 0.5 };
  GstHarness *h = harness ("");
  const GstVideoInfo info = info_of ("I420", WIDTH, HEIGHT);

  set_caps (h, &info);
  for (guint i = 0; i < G_N_ELEMENTS (scales); i++) {
    GstBuffer *in = picture (&info);
    g_autoptr (GstBuffer) half = NULL;
    g_autoptr (GstBuffer) out = NULL;
    const GstClothMatch *match;
    guint n;

    gst_buffer_add_cloth_disparity_meta (in, flat (scales[i], FALSE));
    half = gst_harness_push_and_pull (h, in);
    fail_unless (check_matches (half, LEFT, FALSE) > 100);
    match = gst_cloth_matches_get_matches (gst_buffer_get_cloth_matches (half),
        &n);
    for (guint k = 0; k < n; k++)
      fail_unless (match[k].x < WIDTH / 2 + 3);
    fail_unless (gst_cloth_matches_get_on_surface (gst_buffer_get_cloth_matches
            (half)));

    in = picture (&info);
    gst_buffer_add_cloth_disparity_meta (in, flat (scales[i], TRUE));
    gst_buffer_add_cloth_silhouette_meta (in, left_of (WIDTH, HEIGHT, WIDTH));
    out = gst_harness_push_and_pull (h, in);
    fail_unless (check_matches (out, LEFT, FALSE) > 300);
  }
  gst_harness_teardown (h);
}

GST_END_TEST;

GST_START_TEST (test_sizes)
{
  static const gint sizes[][2] =
      { {1, 1}, {1, 50}, {321, 1}, {2, 2}, {7, 5}, {97, 65} };
  GstHarness *h = harness ("steady=3");

  for (guint i = 0; i < G_N_ELEMENTS (sizes); i++) {
    const GstVideoInfo info = info_of (i % 2 ? "YUV9" : "GRAY8", sizes[i][0],
        sizes[i][1]);
    g_autoptr (GstBuffer) out = NULL;

    set_caps (h, &info);
    out = gst_harness_push_and_pull (h, picture (&info));
    fail_unless (gst_buffer_get_cloth_matches (out) != NULL);
  }
  gst_harness_teardown (h);
}

GST_END_TEST;

/* ---- events ---- */

static gfloat
first_variance (GstBuffer * buffer)
{
  GstClothGridPoint point;

  fail_unless (gst_cloth_matches_get_point (gst_buffer_get_cloth_matches
          (buffer), 0, &point));
  return point.cov_xx;
}

/* What stands still is averaged; a flush, other caps and another number begin anew. */
GST_START_TEST (test_steady)
{
  GstHarness *h = harness ("steady=3");
  GstVideoInfo info = info_of ("I420", WIDTH, HEIGHT);
  GstSegment segment;
  gfloat alone = 0;

  for (guint how = 0; how < 4; how++) {
    if (how == 1) {
      fail_unless (gst_harness_push_event (h, gst_event_new_flush_start ()));
      fail_unless (gst_harness_push_event (h, gst_event_new_flush_stop (TRUE)));
      gst_segment_init (&segment, GST_FORMAT_TIME);
      fail_unless (gst_harness_push_event (h,
              gst_event_new_segment (&segment)));
    } else if (how == 2) {
      info = info_of ("NV12", WIDTH, HEIGHT);
    } else if (how == 3) {
      g_object_set (h->element, "steady", 4, NULL);
    }
    if (how != 1 && how != 3)
      set_caps (h, &info);
    for (guint k = 1; k <= 5; k++) {
      g_autoptr (GstBuffer) out =
          gst_harness_push_and_pull (h, picture (&info));
      const gfloat variance = first_variance (out);

      check_matches (out, LEFT, FALSE);
      if (how == 0 && k == 1)
        alone = variance;
      fail_unless (fabsf (variance * (gfloat) MIN (k, how == 3 ? 4 : 3) / alone
              - 1) < 1e-4f, "%u %u: %g %g", how, k, variance, alone);
    }
  }
  gst_harness_teardown (h);
}

GST_END_TEST;

GST_START_TEST (test_flush_and_eos)
{
  GstHarness *h = harness ("");
  GstVideoInfo info = info_of ("I420", WIDTH, HEIGHT);
  GstSegment segment;
  GstBuffer *out;
  GstEvent *event;
  gboolean eos = FALSE;

  set_caps (h, &info);
  gst_buffer_unref (gst_harness_push_and_pull (h, picture (&info)));
  fail_unless (gst_harness_push_event (h, gst_event_new_flush_start ()));
  fail_unless (gst_harness_push_event (h, gst_event_new_flush_stop (TRUE)));
  gst_segment_init (&segment, GST_FORMAT_TIME);
  fail_unless (gst_harness_push_event (h, gst_event_new_segment (&segment)));
  info = info_of ("GRAY8", WIDTH + 30, HEIGHT + 1);
  set_caps (h, &info);
  out = gst_harness_push_and_pull (h, picture_of (&info, 100, FALSE, 0));
  fail_unless (check_matches (out, 100, FALSE) > 300);
  gst_buffer_unref (out);
  fail_unless (gst_harness_push_event (h, gst_event_new_eos ()));
  while ((event = gst_harness_try_pull_event (h))) {
    eos |= GST_EVENT_TYPE (event) == GST_EVENT_EOS;
    gst_event_unref (event);
  }
  fail_unless (eos);
  fail_unless (gst_harness_push (h, picture (&info)) == GST_FLOW_EOS);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* The memory of a picture that others hold stays theirs and as it is. */
GST_START_TEST (test_shared)
{
  GstHarness *h = harness ("");
  const GstVideoInfo info = info_of ("I420", WIDTH, HEIGHT);
  GstBuffer *in = picture (&info);
  g_autoptr (GstBuffer) copy = gst_buffer_copy_deep (in);
  g_autoptr (GstBuffer) out = NULL;
  GstMapInfo map;

  set_caps (h, &info);
  out = gst_harness_push_and_pull (h, gst_buffer_ref (in));
  fail_unless (gst_buffer_get_cloth_matches (in) == NULL);
  fail_unless (gst_buffer_get_cloth_matches (out) != NULL);
  fail_unless (gst_buffer_peek_memory (in, 0) == gst_buffer_peek_memory (out,
          0));
  gst_buffer_map (copy, &map, GST_MAP_READ);
  fail_unless (gst_buffer_memcmp (out, 0, map.data, map.size) == 0);
  gst_buffer_unmap (copy, &map);
  gst_buffer_unref (in);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* Threads share the work, and nothing of it changes; nor does it from one picture to the next.
 * The observation of a picture is what goes over the wire. */
GST_START_TEST (test_same_bytes)
{
  static const gchar *const properties[] = { "threads=1 oblique=1",
    "threads=3 oblique=1", "threads=0 oblique=1"
  };
  const GstVideoInfo info = info_of ("I420", WIDTH, HEIGHT);
  g_autoptr (GstBuffer) first = NULL;

  for (guint i = 0; i < G_N_ELEMENTS (properties); i++) {
    GstHarness *h = harness (properties[i]);

    set_caps (h, &info);
    for (guint k = 0; k < 2; k++) {
      g_autoptr (GstBuffer) out =
          gst_harness_push_and_pull (h, picture (&info));
      GstBuffer *packed = gst_cloth_observations_pack (out);
      GstMapInfo map;

      if (!first) {
        first = packed;
        continue;
      }
      gst_buffer_map (packed, &map, GST_MAP_READ);
      fail_unless (gst_buffer_get_size (first) == map.size);
      fail_unless (gst_buffer_memcmp (first, 0, map.data, map.size) == 0);
      gst_buffer_unmap (packed, &map);
      gst_buffer_unref (packed);
    }
    gst_harness_teardown (h);
  }
}

GST_END_TEST;

/* Once pictures have come, more of them take no more memory. */
GST_START_TEST (test_memory)
{
  GstHarness *h = harness ("threads=1 steady=3");
  const GstVideoInfo info = info_of ("I420", WIDTH, HEIGHT);
  gsize before = 0;

  set_caps (h, &info);
  for (guint k = 0; k < 30; k++) {
    GstBuffer *in = picture_of (&info, LEFT + (gint) k % 5, k % 2, 0);

    gst_buffer_add_cloth_disparity_meta (in, flat (k % 3 ? 1 : 2, TRUE));
    gst_buffer_unref (gst_harness_push_and_pull (h, in));
    if (k == 9)
      before = mallinfo2 ().uordblks;
  }
  g_print ("%" G_GSSIZE_FORMAT " bytes more\n",
      (gssize) (mallinfo2 ().uordblks - before));
  fail_unless (mallinfo2 ().uordblks < before + 100000);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* ---- what it says ---- */

/* The right print, and pictures in which there is nothing, give no warning. */
GST_START_TEST (test_silent)
{
  g_autofree gchar *path = write_pattern (1);
  g_autoptr (GstBus) bus = gst_bus_new ();
  GstHarness *h = harness_on ("", path, bus);
  const GstVideoInfo info = info_of ("I420", WIDTH, HEIGHT);

  set_caps (h, &info);
  for (guint k = 0; k < 60; k++) {
    GstBuffer *in = k < 2 ? picture (&info) :
        gst_buffer_new_allocate (NULL, GST_VIDEO_INFO_SIZE (&info), NULL);

    if (k >= 2)
      gst_buffer_memset (in, 0, 100, -1);
    gst_buffer_unref (gst_harness_push_and_pull (h, in));
  }
  gst_harness_push_event (h, gst_event_new_eos ());
  fail_unless_equals_int (count_warnings (bus, ""), 0);
  gst_element_set_bus (h->element, NULL);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* A film that never shows anything is told at its end, once. */
GST_START_TEST (test_bare_film)
{
  g_autofree gchar *path = write_pattern (1);
  g_autoptr (GstBus) bus = gst_bus_new ();
  GstHarness *h = harness_on ("", path, bus);
  const GstVideoInfo info = info_of ("GRAY8", WIDTH, HEIGHT);

  set_caps (h, &info);
  for (guint k = 0; k < 3; k++) {
    GstBuffer *in =
        gst_buffer_new_allocate (NULL, GST_VIDEO_INFO_SIZE (&info), NULL);

    gst_buffer_memset (in, 0, 100, -1);
    gst_buffer_unref (gst_harness_push_and_pull (h, in));
  }
  fail_unless_equals_int (count_warnings (bus, ""), 0);
  gst_harness_push_event (h, gst_event_new_eos ());
  fail_unless_equals_int (count_warnings (bus, "more than 0 features"), 1);
  gst_element_set_bus (h->element, NULL);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* A print of one side that is filmed from behind; another print: one warning after 25
 * pictures, or at the end of a shorter film. */
GST_START_TEST (test_wrong_print)
{
  for (guint how = 0; how < 4; how++) {
    const gboolean other = how % 2, brief = how / 2;
    g_autofree gchar *path = write_pattern (1);
    g_autoptr (GstBus) bus = gst_bus_new ();
    g_autofree guint8 *turned = NULL;
    const GstVideoInfo info = info_of ("I420", WIDTH, HEIGHT);
    GstHarness *h;

    if (other) {
      turned = g_malloc (PRINT * PRINT);
      for (guint i = 0; i < PRINT * PRINT; i++)
        turned[i] = (guint8) (255 - print[i / PRINT + i % PRINT * PRINT]);
      write_picture (turned, PRINT, PRINT);
    }
    h = harness_on ("", path, bus);
    set_caps (h, &info);
    for (guint k = 0; k < (brief ? 2 : 24); k++)
      gst_buffer_unref (gst_harness_push_and_pull (h, picture_of (&info, LEFT,
                  !other, 0)));
    fail_unless_equals_int (count_warnings (bus, "Hardly"), 0);
    if (brief) {
      gst_harness_push_event (h, gst_event_new_eos ());
      fail_unless_equals_int (count_warnings (bus, "Hardly"), 1);
    } else {
      for (guint k = 0; k < 3; k++)
        gst_buffer_unref (gst_harness_push_and_pull (h, picture_of (&info, LEFT,
                    !other, 0)));
      gst_harness_push_event (h, gst_event_new_eos ());
      fail_unless_equals_int (count_warnings (bus, "Hardly"), 1);
    }
    gst_element_set_bus (h->element, NULL);
    gst_harness_teardown (h);
  }
}

GST_END_TEST;

/* A print that repeats itself is said at the start. */
GST_START_TEST (test_repeated_print)
{
  g_autofree gchar *path = write_pattern (1);
  g_autoptr (GstBus) bus = gst_bus_new ();
  g_autofree guint8 *tiles = g_malloc (PRINT * PRINT);
  const GstVideoInfo info = info_of ("I420", WIDTH, HEIGHT);
  GstHarness *h;

  for (guint y = 0; y < PRINT; y++)
    for (guint x = 0; x < PRINT; x++)
      tiles[y * PRINT + x] = print[y % 50 * PRINT + x % 50];
  write_picture (tiles, PRINT, PRINT);
  h = harness_on ("", path, bus);
  fail_unless_equals_int (count_warnings (bus, "repeat themselves"), 1);
  set_caps (h, &info);
  gst_buffer_unref (gst_harness_push_and_pull (h, picture (&info)));
  gst_element_set_bus (h->element, NULL);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* A print on which there is nothing keeps the element from starting. */
GST_START_TEST (test_blank_print)
{
  GstElement *element = gst_element_factory_make ("siftmatch", NULL);
  g_autofree gchar *path = write_pattern (1);
  g_autofree guint8 *blank = g_malloc0 (PRINT * PRINT);
  g_autoptr (GstBus) bus = gst_bus_new ();
  g_autoptr (GstMessage) message = NULL;
  g_autoptr (GError) error = NULL;

  write_picture (blank, PRINT, PRINT);
  g_object_set (element, "pattern", path, NULL);
  gst_element_set_bus (element, bus);
  fail_unless_equals_int (gst_element_set_state (element, GST_STATE_PAUSED),
      GST_STATE_CHANGE_FAILURE);
  message = gst_bus_pop_filtered (bus, GST_MESSAGE_ERROR);
  fail_unless (message != NULL);
  gst_message_parse_error (message, &error, NULL);
  fail_unless (strstr (error->message, "no feature"), "%s", error->message);
  gst_element_set_state (element, GST_STATE_NULL);
  gst_element_set_bus (element, NULL);
  gst_object_unref (element);
}

GST_END_TEST;

/* ---- properties and refusals ---- */

GST_START_TEST (test_properties)
{
  static const gchar *const values[][3] = {
    {"threads", "3", "0"}, {"steady", "7", "0"}, {"contrast", "0.1", "0.04"},
    {"reference-contrast", "0.1", "0.04"}, {"layers", "4", "3"},
    {"edge", "20", "10"}, {"blur", "1.2", "1.6"}, {"oblique", "2", "1"},
    {"reference-scale", "1", "1.4"}, {"reference-seed-scale", "3", "2.5"},
    {"noise", "4", "2"}, {"radius", "30", "20"}, {"distance", "250", "320"},
    {"seed-distance", "200", "280"}, {"first-group", "16", "32"},
    {"seed-scale", "3", "2"}, {"least", "6", "4"}, {"tries", "8", "4"},
    {"zoom", "3", "2"}, {"stretch", "0.2", "0.1"}, {"slack", "2", "1"},
    {"depth-step", "0.02", "0.01"}, {"hidden", "0.05", "0.03"},
    {"metres-per-pixel", "0.001", "0"}, {"foreshortening", "3", "2"},
    {"verify-stretch", "0.2", "0.08"}, {"verify-slack", "2", "0.5"},
    {"vote", "0.5", "0.75"}, {"group-vote", "0.6", "0.5"},
    {"support", "5", "3"}, {"reach", "80", "60"}, {"grid-reach", "30", "60"},
    {"grid-beyond", "5", "20"}, {"grid-radius", "15", "30"},
    {"grid-most", "12", "24"}, {"grid-least", "4", "5"},
    {"grid-noise", "0.5", "0.4"}, {"grid-bend", "0.01", "0.004"},
    {"grid-outlier", "2", "1"}, {"grid-rival", "0.6", "0.5"},
    {"grid-uncertain", "1", "2"}, {"pattern", "there.json", NULL}
  };

  check_values ("siftmatch", values, G_N_ELEMENTS (values));
}

GST_END_TEST;

/* Each property does what it is named for, while pictures come or from the start. */
GST_START_TEST (test_effects)
{
  static const gchar *const tighter[] = { "radius=2", "distance=20",
    "seed-distance=0", "seed-scale=50", "least=1000", "vote=1 support=100",
    "reference-scale=4", "contrast=0.1", "reference-contrast=0.1"
  };
  const GstVideoInfo info = info_of ("I420", WIDTH, HEIGHT);
  guint as_is = 0;

  for (guint i = 0; i <= G_N_ELEMENTS (tighter); i++) {
    GstHarness *h = harness (i ? tighter[i - 1] : "");
    g_autoptr (GstBuffer) out = NULL;
    guint n;

    set_caps (h, &info);
    out = gst_harness_push_and_pull (h, picture (&info));
    n = check_matches (out, LEFT, FALSE);
    if (i == 0)
      as_is = n;
    else
      fail_unless (n < as_is, "%s: %u of %u", tighter[i - 1], n, as_is);
    gst_harness_teardown (h);
  }
}

GST_END_TEST;

#define JSON(reference, size, columns) "{\"version\": 1, \"pattern\": " \
    "\"picture\", \"reference\": \"" reference "\"" size ", \"columns\": " \
    columns ", \"rows\": 300}"

/* What keeps the element from starting is said, with what to do. */
GST_START_TEST (test_refused)
{
  static const gchar *const texts[][3] = {
    {NULL, "is not set", "reference.png"},
    {"{}", "Can't read the pattern", "dotlabel"},
    {"nonsense", "Can't read the pattern", "dotlabel"},
    {"{\"version\": 1, \"pattern\": \"checkerboard\", \"columns\": 8, "
          "\"rows\": 8, \"square_m\": 0.1}", "checkerboard", "quadtrack"},
    {JSON ("print.png", "", "9"), "cloth_m", "picture"},
    {JSON ("print.png", ", \"cloth_m\": [0, 1]", "9"), "cloth_m", "picture"},
    {JSON ("nowhere.png", ", \"cloth_m\": [0.2, 0.2]", "9"), "nowhere.png",
        "picture"},
    {JSON ("pattern.json", ", \"cloth_m\": [0.2, 0.2]", "9"),
        "picture of the print", "scan"},
    {JSON ("print.png", ", \"cloth_m\": [0.2, 0.4]", "9"), "a pixel would be",
        "scan"},
    {JSON ("print.png", ", \"cloth_m\": [0.2, 0.2]", "300"), "65536 in all",
        "picture"}
  };

  for (guint i = 0; i < G_N_ELEMENTS (texts); i++) {
    GstElement *element = gst_element_factory_make ("siftmatch", NULL);
    g_autofree gchar *path = write_pattern (2);
    g_autoptr (GstBus) bus = gst_bus_new ();
    g_autoptr (GstMessage) message = NULL;
    g_autoptr (GError) error = NULL;
    g_autofree gchar *remedy = NULL;

    if (texts[i][0]) {
      g_autofree gchar *again = write_text (texts[i][0]);

      g_object_set (element, "pattern", again, NULL);
    }
    gst_element_set_bus (element, bus);
    fail_unless_equals_int (gst_element_set_state (element, GST_STATE_PAUSED),
        GST_STATE_CHANGE_FAILURE);
    message = gst_bus_pop_filtered (bus, GST_MESSAGE_ERROR);
    fail_unless (message != NULL);
    gst_message_parse_error (message, &error, &remedy);
    g_print ("%s | %s\n", error->message, remedy);
    fail_unless (strstr (error->message, texts[i][1]) != NULL, "%s",
        error->message);
    fail_unless (i == 0 || strstr (remedy, texts[i][2]) != NULL, "%s", remedy);
    gst_element_set_state (element, GST_STATE_NULL);
    gst_element_set_bus (element, NULL);
    gst_object_unref (element);
  }
}

GST_END_TEST;

/* A picture so large that its features would fill the memory ends the stream. */
GST_START_TEST (test_too_large)
{
  GstHarness *h = harness ("");
  const GstVideoInfo info = info_of ("GRAY8", 4097, 4096);
  GstBuffer *in = gst_buffer_new_allocate (NULL, GST_VIDEO_INFO_SIZE (&info),
      NULL);
  g_autoptr (GstBus) bus = gst_bus_new ();
  g_autoptr (GstMessage) message = NULL;
  g_autoptr (GError) error = NULL;
  g_autofree gchar *remedy = NULL;

  gst_buffer_memset (in, 0, 0, -1);
  gst_element_set_bus (h->element, bus);
  set_caps (h, &info);
  fail_unless_equals_int (gst_harness_push (h, in), GST_FLOW_ERROR);
  message = gst_bus_pop_filtered (bus, GST_MESSAGE_ERROR);
  fail_unless (message != NULL);
  gst_message_parse_error (message, &error, &remedy);
  fail_unless (strstr (error->message, "4097 × 4096"));
  fail_unless (strstr (remedy, "videoscale"));
  gst_element_set_bus (h->element, NULL);
  gst_harness_teardown (h);
}

GST_END_TEST;

static Suite *
siftmatch_suite (void)
{
  Suite *s = suite_create ("siftmatch");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_add_checked_fixture (tc, setup, teardown);
  tcase_add_test (tc, test_film);
  tcase_add_test (tc, test_formats);
  tcase_add_test (tc, test_back);
  tcase_add_test (tc, test_silhouette);
  tcase_add_test (tc, test_surface);
  tcase_add_test (tc, test_sizes);
  tcase_add_test (tc, test_steady);
  tcase_add_test (tc, test_flush_and_eos);
  tcase_add_test (tc, test_shared);
  tcase_add_test (tc, test_same_bytes);
  tcase_add_test (tc, test_memory);
  tcase_add_test (tc, test_silent);
  tcase_add_test (tc, test_bare_film);
  tcase_add_test (tc, test_wrong_print);
  tcase_add_test (tc, test_repeated_print);
  tcase_add_test (tc, test_blank_print);
  tcase_add_test (tc, test_properties);
  tcase_add_test (tc, test_effects);
  tcase_add_test (tc, test_refused);
  tcase_add_test (tc, test_too_large);
  return s;
}

GST_CHECK_MAIN (siftmatch);
