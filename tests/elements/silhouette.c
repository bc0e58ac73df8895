/* silhouette: backgrounds from files and from the film, formats, strides, events, refusals.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/check/check.h>
#include <gst/check/gstharness.h>
#include <gst/cloth/cloth.h>
#include <gst/video/video.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "tests/common/npyfloats.h"
#include "tests/elements/padded.h"
#include "tests/elements/values.h"

#define WIDTH 201
#define HEIGHT 121
#define CLOTH_WIDTH 80
#define CLOTH_HEIGHT 60

static gchar *folder;

static void
setup (void)
{
  folder = g_dir_make_tmp ("silhouette-XXXXXX", NULL);
}

static void
teardown (void)
{
  static const gchar *const names[] = { "background.png", "background.jpg" };

  for (guint i = 0; i < G_N_ELEMENTS (names); i++) {
    g_autofree gchar *path = g_build_filename (folder, names[i], NULL);

    g_remove (path);
  }
  g_rmdir (folder);
  g_clear_pointer (&folder, g_free);
}

/* A wall with a weak pattern; with @cloth_x from 0 on a printed cloth at that column, row 30. */
static guint8
luma (gint x, gint y, gint cloth_x)
{
  if (cloth_x >= 0 && x >= cloth_x && x < cloth_x + CLOTH_WIDTH && y >= 30
      && y < 30 + CLOTH_HEIGHT)
    return (x / 2 + y / 2) % 2 ? 200 : 50;
  return (guint8) (100 + x / 10 + (x / 7 + y / 9) % 3);
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

static GstBuffer *
picture (const GstVideoInfo * info, gint cloth_x, gint padding)
{
  Luma place;
  GstBuffer *buffer = padded_picture (info, padding, 128, &place);
  GstMapInfo map;

  gst_buffer_map (buffer, &map, GST_MAP_WRITE);
  for (gint y = 0; y < GST_VIDEO_INFO_HEIGHT (info); y++)
    for (gint x = 0; x < GST_VIDEO_INFO_WIDTH (info); x++)
      map.data[place.offset + (gsize) (y * place.stride + x)] =
          luma (x, y, cloth_x);
  gst_buffer_unmap (buffer, &map);
  GST_BUFFER_PTS (buffer) = 0;
  return buffer;
}

/* Writes the empty scene to a file. */
static gchar *
write_background (const gchar * format, gint width, gint height)
{
  const GstVideoInfo info = info_of (format, width, height);
  g_autoptr (GstCaps) caps = gst_video_info_to_caps (&info);
  g_autofree gchar *path = g_build_filename (folder, "background.png", NULL);
  GstHarness *h = gst_harness_new_parse ("videoconvert dither=none ! pngenc");
  GstBuffer *out;
  GstMapInfo map;

  gst_harness_set_src_caps (h, g_steal_pointer (&caps));
  out = gst_harness_push_and_pull (h, picture (&info, -1, 0));
  fail_unless (out != NULL);
  gst_buffer_map (out, &map, GST_MAP_READ);
  fail_unless (g_file_set_contents (path, (const gchar *) map.data,
          (gssize) map.size, NULL));
  gst_buffer_unmap (out, &map);
  gst_buffer_unref (out);
  gst_harness_teardown (h);
  return g_steal_pointer (&path);
}

static void
assert_most_of_cloth (GstBuffer * buffer, gint cloth_x, guint most_wrong)
{
  GstClothSilhouette *silhouette = gst_buffer_get_cloth_silhouette (buffer);
  g_autoptr (GBytes) mask = NULL;
  const guint8 *bytes;
  guint n_wrong = 0;

  fail_unless (silhouette != NULL);
  fail_unless_equals_int (gst_cloth_silhouette_get_width (silhouette), WIDTH);
  fail_unless_equals_int (gst_cloth_silhouette_get_height (silhouette), HEIGHT);
  mask = gst_cloth_silhouette_get_mask (silhouette);
  bytes = g_bytes_get_data (mask, NULL);
  for (gint y = 0; y < HEIGHT; y++)
    for (gint x = 0; x < WIDTH; x++)
      n_wrong += (bytes[y * WIDTH + x] == 255) != (cloth_x >= 0 && x >= cloth_x
          && x < cloth_x + CLOTH_WIDTH && y >= 30 && y < 30 + CLOTH_HEIGHT);
  fail_unless (n_wrong <= most_wrong, "%u pixels are wrong", n_wrong);
}

static void
assert_cloth (GstBuffer * buffer, gint cloth_x)
{
  assert_most_of_cloth (buffer, cloth_x, 100);
}

/* The background is loaded as soon as the harness has the element. */
static GstHarness *
harness (const gchar * background)
{
  g_autofree gchar *line = g_strdup_printf ("silhouette camera=left "
      "background=\"%s\"", background);

  return gst_harness_new_parse (line);
}

static void
set_caps (GstHarness * h, const GstVideoInfo * info)
{
  gst_harness_set_src_caps (h, gst_video_info_to_caps (info));
}

GST_START_TEST (test_formats)
{
  static const gchar *const formats[] = { "GRAY8", "I420", "YV12", "NV12",
    "NV21", "Y42B", "NV16", "NV61", "Y444", "NV24", "Y41B", "YUV9", "YVU9",
    "A420"
  };

  for (guint f = 0; f < G_N_ELEMENTS (formats); f++)
    for (gint padding = 0; padding < 60; padding += 29) {
      g_autofree gchar *path = write_background (f ? "I420" : "GRAY8", WIDTH,
          HEIGHT);
      GstHarness *h = harness (path);
      const GstVideoInfo info = info_of (formats[f], WIDTH, HEIGHT);
      GstBuffer *out;

      GST_INFO ("%s, padding %d", formats[f], padding);
      set_caps (h, &info);
      for (gint x = -1; x < 110; x += 37) {
        out = gst_harness_push_and_pull (h, picture (&info, x, padding));
        fail_unless (out != NULL);
        assert_cloth (out, x);
        fail_unless_equals_string (gst_cloth_silhouette_get_camera
            (gst_buffer_get_cloth_silhouette (out)), "left");
        gst_buffer_unref (out);
      }
      gst_harness_teardown (h);
    }
}

GST_END_TEST;

/* Every second picture is a sample; from the third place of the cloth on the wall is known. */
GST_START_TEST (test_learn)
{
  GstHarness *h = gst_harness_new_parse ("silhouette learn=2 threads=2");
  const GstVideoInfo info = info_of ("NV12", WIDTH, HEIGHT);

  set_caps (h, &info);
  for (gint i = 0; i < 12; i++) {
    const gint x = i / 2 % 3 == 0 ? 0 : i / 2 % 3 == 1 ? 120 : -1;
    g_autoptr (GstBuffer) out = gst_harness_push_and_pull (h, picture (&info,
            x, 0));

    fail_unless (out != NULL);
    if (i >= 6)
      assert_cloth (out, x);
  }
  gst_harness_teardown (h);
}

GST_END_TEST;

GST_START_TEST (test_ranges)
{
  GstHarness *h = gst_harness_new_parse ("silhouette luma-min=150 thin=0");
  const GstVideoInfo info = info_of ("I420", WIDTH, HEIGHT);
  g_autoptr (GstBuffer) out = NULL;
  g_autoptr (GstBuffer) next = NULL;

  set_caps (h, &info);
  out = gst_harness_push_and_pull (h, picture (&info, 40, 0));
  /* what is dark of the print is holes, but for what lies at the cloth's border */
  assert_most_of_cloth (out, 40, 2 * (CLOTH_WIDTH + CLOTH_HEIGHT));
  gst_harness_set (h, "silhouette", "luma-max", 160, NULL);
  next = gst_harness_push_and_pull (h, picture (&info, 40, 0));
  assert_cloth (next, -1);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* The background is converted anew for each format; another size is refused. */
GST_START_TEST (test_renegotiation)
{
  static const gchar *const formats[] = { "I420", "GRAY8", "NV12", "I420" };
  g_autofree gchar *path = write_background ("I420", WIDTH, HEIGHT);
  GstHarness *h = harness (path);
  GstVideoInfo info;
  g_autoptr (GstBus) bus = gst_bus_new ();
  g_autoptr (GstMessage) message = NULL;
  g_autoptr (GError) error = NULL;
  g_autofree gchar *remedy = NULL;

  gst_element_set_bus (h->element, bus);
  for (guint i = 0; i < G_N_ELEMENTS (formats); i++) {
    g_autoptr (GstBuffer) out = NULL;

    info = info_of (formats[i], WIDTH, HEIGHT);
    set_caps (h, &info);
    out = gst_harness_push_and_pull (h, picture (&info, 20, 0));
    assert_cloth (out, 20);
  }
  info = info_of ("I420", WIDTH + 1, HEIGHT);
  set_caps (h, &info);
  fail_unless_equals_int (gst_harness_push (h, picture (&info, 20, 0)),
      GST_FLOW_ERROR);
  message = gst_bus_pop_filtered (bus, GST_MESSAGE_ERROR);
  fail_unless (message != NULL);
  gst_message_parse_error (message, &error, &remedy);
  fail_unless (strstr (error->message,
          "201 × 121 pixels, the film 202 × 121"));
  fail_unless (strstr (remedy, "this very camera"));
  gst_element_set_bus (h->element, NULL);
  gst_harness_teardown (h);
}

GST_END_TEST;

GST_START_TEST (test_flush_and_eos)
{
  g_autofree gchar *path = write_background ("I420", WIDTH, HEIGHT);
  GstHarness *h = harness (path);
  const GstVideoInfo info = info_of ("I420", WIDTH, HEIGHT);
  GstSegment segment;
  GstBuffer *out;
  GstEvent *event;
  gboolean eos = FALSE;

  set_caps (h, &info);
  gst_buffer_unref (gst_harness_push_and_pull (h, picture (&info, 3, 0)));
  fail_unless (gst_harness_push_event (h, gst_event_new_flush_start ()));
  fail_unless (gst_harness_push_event (h, gst_event_new_flush_stop (TRUE)));
  gst_segment_init (&segment, GST_FORMAT_TIME);
  fail_unless (gst_harness_push_event (h, gst_event_new_segment (&segment)));
  out = gst_harness_push_and_pull (h, picture (&info, 90, 0));
  assert_cloth (out, 90);
  gst_buffer_unref (out);
  fail_unless (gst_harness_push_event (h, gst_event_new_eos ()));
  while ((event = gst_harness_try_pull_event (h))) {
    eos |= GST_EVENT_TYPE (event) == GST_EVENT_EOS;
    gst_event_unref (event);
  }
  fail_unless (eos);
  fail_unless (gst_harness_push (h, picture (&info, 3, 0)) == GST_FLOW_EOS);
  gst_harness_teardown (h);
}

GST_END_TEST;

GST_START_TEST (test_sizes)
{
  static const gint sizes[][2] =
      { {1, 1}, {1, 50}, {321, 1}, {2, 2}, {96, 65} };
  GstHarness *h = gst_harness_new_parse ("silhouette learn=1");

  for (guint i = 0; i < G_N_ELEMENTS (sizes); i++) {
    const GstVideoInfo info = info_of (i % 2 ? "YUV9" : "GRAY8", sizes[i][0],
        sizes[i][1]);
    g_autoptr (GstBuffer) out = NULL;
    GstClothSilhouette *silhouette;

    set_caps (h, &info);
    out = gst_harness_push_and_pull (h, picture (&info, 0, 0));
    silhouette = gst_buffer_get_cloth_silhouette (out);
    fail_unless_equals_int (gst_cloth_silhouette_get_width (silhouette),
        sizes[i][0]);
    fail_unless_equals_int (gst_cloth_silhouette_get_n_runs (silhouette), 0);
  }
  gst_harness_teardown (h);
}

GST_END_TEST;

GST_START_TEST (test_properties)
{
  static const gchar *const values[][3] = {
    {"learn", "7", "0"}, {"significance", "3", "14"}, {"shadow", "0.5", "0.4"},
    {"glow", "2", "1.15"}, {"radius", "7", "1"}, {"thin", "0", "2"},
    {"least", "9", "400"}, {"hole", "8", "400"}, {"luma-min", "1", "0"},
    {"luma-max", "2", "255"}, {"u-min", "3", "0"}, {"u-max", "4", "255"},
    {"v-min", "5", "0"}, {"v-max", "6", "255"}, {"threads", "3", "0"},
    {"background", "there.png", NULL}
  };

  check_values ("silhouette", values, G_N_ELEMENTS (values));
}

GST_END_TEST;

/* A file that can't be read keeps the element from starting; nothing set at all ends the
 * stream. Both say what to do. */
GST_START_TEST (test_refused)
{
  static const gchar *const files[] = { "/nowhere/background.png", "/" };
  g_autofree gchar *text = g_build_filename (folder, "background.png", NULL);

  fail_unless (g_file_set_contents (text, "no picture", -1, NULL));
  for (guint i = 0; i < 3; i++) {
    GstElement *element = gst_element_factory_make ("silhouette", NULL);
    g_autoptr (GstBus) bus = gst_bus_new ();
    g_autoptr (GstMessage) message = NULL;
    g_autoptr (GError) error = NULL;

    g_object_set (element, "background", i < 2 ? files[i] : text, NULL);
    gst_element_set_bus (element, bus);
    fail_unless_equals_int (gst_element_set_state (element, GST_STATE_PAUSED),
        GST_STATE_CHANGE_FAILURE);
    message = gst_bus_pop_filtered (bus, GST_MESSAGE_ERROR);
    fail_unless (message != NULL);
    gst_message_parse_error (message, &error, NULL);
    fail_unless (g_str_has_prefix (error->message, "Can't read the background"),
        "%s", error->message);
    gst_element_set_state (element, GST_STATE_NULL);
    gst_element_set_bus (element, NULL);
    gst_object_unref (element);
  }
}

GST_END_TEST;

GST_START_TEST (test_nothing_set)
{
  GstHarness *h = gst_harness_new ("silhouette");
  const GstVideoInfo info = info_of ("I420", WIDTH, HEIGHT);
  g_autoptr (GstBus) bus = gst_bus_new ();
  g_autoptr (GstMessage) message = NULL;
  g_autoptr (GError) error = NULL;
  g_autofree gchar *remedy = NULL;

  gst_element_set_bus (h->element, bus);
  set_caps (h, &info);
  fail_unless_equals_int (gst_harness_push (h, picture (&info, 3, 0)),
      GST_FLOW_ERROR);
  message = gst_bus_pop_filtered (bus, GST_MESSAGE_ERROR);
  gst_message_parse_error (message, &error, &remedy);
  fail_unless (strstr (remedy, "luma-min"));
  gst_element_set_bus (h->element, NULL);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* The memory of a picture that others hold stays theirs and as it is. */
GST_START_TEST (test_shared)
{
  GstHarness *h = gst_harness_new_parse ("silhouette learn=1");
  const GstVideoInfo info = info_of ("I420", WIDTH, HEIGHT);
  GstBuffer *in = picture (&info, 50, 0);
  g_autoptr (GstBuffer) copy = gst_buffer_copy_deep (in);
  g_autoptr (GstBuffer) out = NULL;
  GstMapInfo a, b;

  set_caps (h, &info);
  out = gst_harness_push_and_pull (h, gst_buffer_ref (in));
  fail_unless (gst_buffer_get_cloth_silhouette (in) == NULL);
  fail_unless (gst_buffer_get_cloth_silhouette (out) != NULL);
  fail_unless (gst_buffer_peek_memory (in, 0) == gst_buffer_peek_memory (out,
          0));
  gst_buffer_map (copy, &a, GST_MAP_READ);
  gst_buffer_map (out, &b, GST_MAP_READ);
  fail_unless (a.size == b.size && memcmp (a.data, b.data, a.size) == 0);
  gst_buffer_unmap (copy, &a);
  gst_buffer_unmap (out, &b);
  gst_buffer_unref (in);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* Disparities of a box of 10 px before a wall of 5, with a hole in the box. */
static GstClothDisparity *
disparities (guint width, guint height)
{
  static const gdouble normal[3] = { 0, 0, 1 }, move[3];
  static const gdouble turn[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  const guint n = width * height;
  g_autofree gfloat *rays = g_new0 (gfloat, 2 * n);
  g_autofree gfloat *d = g_new (gfloat, n);
  g_autofree guint8 *states = g_malloc (n);
  g_autoptr (GstClothStereo) stereo = gst_cloth_stereo_new (width, height, rays,
      2 * n, normal, 100, turn, move, 2);

  for (guint i = 0; i < n; i++) {
    const guint x = i % width, y = i / width;
    const gboolean box = x >= 50 && x < 130 && y >= 30 && y < 90;
    const gboolean hole = x >= 70 && x < 100 && y >= 40 && y < 70;

    d[i] = hole ? NAN : box ? 10 : 5;
    states[i] = hole ? GST_CLOTH_DISPARITY_HOLE : GST_CLOTH_DISPARITY_MEASURED;
  }
  return gst_cloth_disparity_new ("", 0, stereo, 0.1f, d, n, states, n);
}

/* @carries: whether the picture has disparities. Returns: pixels of the silhouette. */
static guint
area_by_disparity (const gchar * properties, gboolean carries)
{
  g_autofree gchar *launch = g_strdup_printf ("silhouette %s", properties);
  const GstVideoInfo info = info_of ("GRAY8", WIDTH, HEIGHT);
  GstHarness *h = gst_harness_new_parse (launch);
  GstBuffer *buffer = picture (&info, -1, 0), *out;
  guint area;

  gst_harness_set_src_caps (h, gst_video_info_to_caps (&info));
  if (carries)
    gst_buffer_add_cloth_disparity_meta (buffer, disparities (WIDTH, HEIGHT));
  out = gst_harness_push_and_pull (h, buffer);
  fail_unless (out != NULL);
  area = gst_cloth_silhouette_get_area (gst_buffer_get_cloth_silhouette (out));
  gst_buffer_unref (out);
  gst_harness_teardown (h);
  return area;
}

GST_START_TEST (test_disparity)
{
  const guint box = 80 * 60, hole = 30 * 30;

  fail_unless_equals_int (area_by_disparity ("disparity-min=8 thin=0 hole=0",
          TRUE), box - hole);
  fail_unless_equals_int (area_by_disparity
      ("disparity-min=8 disparity-max=12 thin=0 hole=900", TRUE), box);
  fail_unless_equals_int (area_by_disparity ("disparity-max=7 thin=0 hole=0",
          TRUE), WIDTH * HEIGHT - box);
  fail_unless_equals_int (area_by_disparity ("disparity-min=11 thin=0", TRUE),
      0);
  /* luma and disparities both */
  fail_unless_equals_int (area_by_disparity
      ("disparity-min=8 thin=0 luma-min=255", TRUE), 0);
  /* a picture without: nothing tells the cloth, or the luma alone */
  fail_unless_equals_int (area_by_disparity ("disparity-min=8 thin=0", FALSE),
      0);
  fail_unless_equals_int (area_by_disparity
      ("disparity-min=8 thin=0 luma-min=1", FALSE), WIDTH * HEIGHT);
}

GST_END_TEST;

/* Disparities of another size than the picture's. */
GST_START_TEST (test_disparity_of_other_size)
{
  const GstVideoInfo info = info_of ("GRAY8", WIDTH, HEIGHT);
  GstHarness *h = gst_harness_new_parse ("silhouette disparity-min=8");
  GstBuffer *buffer = picture (&info, -1, 0);

  gst_harness_set_src_caps (h, gst_video_info_to_caps (&info));
  gst_buffer_add_cloth_disparity_meta (buffer, disparities (WIDTH / 2, HEIGHT));
  fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_ERROR);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* ---- a path-traced film ---- */

#define FILM TEST_DATA "/lineart_stereo3"
#define FILM_WIDTH 1024
#define FILM_HEIGHT 768
#define COLUMNS 33
#define ROWS 35
/* Of a cell's edge, which is some 20 px long: lines and columns that are walked. */
#define STEPS 40
#define N_FRAMES 4

/* The pixels that a cloth's cells cover: @vertices are those of one frame, world z up. The
 * camera is that of rig.json. */
static guint8 *
draw_truth (const gfloat * vertices)
{
  guint8 *mask = g_malloc0 (FILM_WIDTH * FILM_HEIGHT);

  for (gint j = 0; j < (ROWS - 1) * STEPS; j++)
    for (gint i = 0; i < (COLUMNS - 1) * STEPS; i++) {
      const gfloat *a = vertices + 3 * (j / STEPS * COLUMNS + i / STEPS);
      const gfloat *b = a + 3 * COLUMNS;
      const gdouble s = (i % STEPS + 0.5) / STEPS;
      const gdouble t = (j % STEPS + 0.5) / STEPS;
      gdouble p[3], x, y;

      for (gint c = 0; c < 3; c++)
        p[c] = (1 - t) * ((1 - s) * a[c] + s * a[3 + c])
            + t * ((1 - s) * b[c] + s * b[3 + c]);
      x = floor (512 + 12800 / 9.0 * p[0] / (1.6 + p[1]));
      y = floor (384 + 12800 / 9.0 * (0.85 - p[2]) / (1.6 + p[1]));
      if (x >= 0 && y >= 0 && x < FILM_WIDTH && y < FILM_HEIGHT)
        mask[(gint) y * FILM_WIDTH + (gint) x] = 255;
    }
  return mask;
}

/* Pixels that are both, as a share of those that are either. */
static gdouble
get_overlap (GstClothSilhouette * silhouette, const guint8 * truth)
{
  g_autoptr (GBytes) bytes = gst_cloth_silhouette_get_mask (silhouette);
  const guint8 *mask = g_bytes_get_data (bytes, NULL);
  guint n_both = 0, n_either = 0;

  fail_unless_equals_int (g_bytes_get_size (bytes), FILM_WIDTH * FILM_HEIGHT);
  for (guint i = 0; i < FILM_WIDTH * FILM_HEIGHT; i++) {
    n_both += mask[i] && truth[i];
    n_either += mask[i] || truth[i];
  }
  return (gdouble) n_both / n_either;
}

/* Codes the scene's picture as a camera would. */
static gchar *
write_coded_background (gint quality)
{
  g_autofree gchar *path = g_build_filename (folder, "background.jpg", NULL);
  g_autofree gchar *line = g_strdup_printf ("filesrc location=\"%s\" ! pngdec "
      "! videoconvert ! video/x-raw,format=I420,colorimetry=1:4:0:0 "
      "! jpegenc quality=%d ! filesink location=\"%s\"",
      FILM "/background0.png", quality, path);
  g_autoptr (GError) error = NULL;
  GstElement *pipeline = gst_parse_launch (line, &error);
  g_autoptr (GstBus) bus = NULL;
  g_autoptr (GstMessage) message = NULL;

  fail_unless (error == NULL, "%s", error ? error->message : "");
  bus = gst_element_get_bus (pipeline);
  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  message = gst_bus_timed_pop_filtered (bus, GST_CLOCK_TIME_NONE,
      GST_MESSAGE_EOS | GST_MESSAGE_ERROR);
  fail_unless_equals_int (GST_MESSAGE_TYPE (message), GST_MESSAGE_EOS);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (pipeline);
  return g_steal_pointer (&path);
}

/* Overlaps of the first frames with the truth. */
static void
assert_film (const gchar * background, guint8 * const *truths, gdouble least)
{
  g_autofree gchar *line = g_strdup_printf ("filesrc location=\"" FILM
      "/cam0.mp4\" ! decodebin ! videoconvert ! video/x-raw,format=I420 "
      "! silhouette background=\"%s\" ! appsink name=sink sync=false",
      background);
  g_autoptr (GError) error = NULL;
  GstElement *pipeline = gst_parse_launch (line, &error), *sink;

  fail_unless (error == NULL, "%s", error ? error->message : "");
  sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");
  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  for (guint frame = 0; frame < N_FRAMES; frame++) {
    GstSample *sample = NULL;
    gdouble overlap;

    g_signal_emit_by_name (sink, "pull-sample", &sample);
    fail_unless (sample != NULL);
    overlap = get_overlap (gst_buffer_get_cloth_silhouette
        (gst_sample_get_buffer (sample)), truths[frame]);
    GST_INFO ("%s, frame %u: %.4f", background, frame, overlap);
    fail_unless (overlap >= least, "%s, frame %u: %g", background, frame,
        overlap);
    gst_sample_unref (sample);
  }
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (sink);
  gst_object_unref (pipeline);
}

/* Coding takes the background's noise and fine texture and shifts its colours. */
GST_START_TEST (test_coded_background)
{
  guint8 *truths[N_FRAMES];
  ClothNpyInfo info;
  g_autoptr (GError) error = NULL;
  g_autofree gfloat *vertices = load_npy_floats (FILM "/vertices.npy", &info,
      &error);

  fail_unless (vertices != NULL, "%s", error ? error->message : "");
  for (guint k = 0; k < N_FRAMES; k++)
    truths[k] = draw_truth (vertices + k * 3 * ROWS * COLUMNS);
  assert_film (FILM "/background0.png", truths, 0.985);
  for (gint quality = 50; quality <= 95; quality += 15) {
    g_autofree gchar *path = write_coded_background (quality);

    assert_film (path, truths, 0.985);
  }
  for (guint k = 0; k < N_FRAMES; k++)
    g_free (truths[k]);
}

GST_END_TEST;

static Suite *
silhouette_suite (void)
{
  Suite *suite = suite_create ("silhouette");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (suite, tc);
  tcase_add_checked_fixture (tc, setup, teardown);
  tcase_add_test (tc, test_coded_background);
  tcase_add_test (tc, test_disparity);
  tcase_add_test (tc, test_disparity_of_other_size);
  tcase_add_test (tc, test_formats);
  tcase_add_test (tc, test_learn);
  tcase_add_test (tc, test_ranges);
  tcase_add_test (tc, test_renegotiation);
  tcase_add_test (tc, test_flush_and_eos);
  tcase_add_test (tc, test_sizes);
  tcase_add_test (tc, test_properties);
  tcase_add_test (tc, test_refused);
  tcase_add_test (tc, test_nothing_set);
  tcase_add_test (tc, test_shared);
  return suite;
}

GST_CHECK_MAIN (silhouette);
