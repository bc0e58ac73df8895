/* quadtrack: formats, seeds, clicks, absent boards, changes of caps, refusals.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/check/check.h>
#include <gst/cloth/cloth.h>
#include <gst/controller/gstdirectcontrolbinding.h>
#include <gst/controller/gstinterpolationcontrolsource.h>
#include <gst/video/navigation.h>
#include <gst/video/video.h>
#include <math.h>
#include <string.h>

/* 10 × 7 squares: turned by half it has other colours, so it is what it is. */
#define COLUMNS 10
#define ROWS 7
#define SIDE 20
#define WIDTH 321
#define HEIGHT 243
#define LEFT 41
#define TOP 37
#define BOARD " columns=10 rows=7 camera=cam0"

static gchar *
caps_of (const gchar * format, gint width, gint height)
{
  return g_strdup_printf ("video/x-raw,format=%s,width=%d,height=%d,"
      "framerate=25/1", format, width, height);
}

/* A board whose corners lie between pixels, at (left, top) + SIDE·(column, row) − 0.5, or
 * nothing but white.
 * @padding: bytes that each plane's rows have too many, told by a video meta */
static GstBuffer *
picture (const gchar * format, gint width, gint height, gint padding, gint left,
    gint top, gboolean board)
{
  g_autofree gchar *text = caps_of (format, width, height);
  g_autoptr (GstCaps) caps = gst_caps_from_string (text);
  gsize offset[GST_VIDEO_MAX_PLANES] = { 0 }, size = 0;
  gint stride[GST_VIDEO_MAX_PLANES] = { 0 };
  GstVideoInfo info;
  GstBuffer *buffer;
  GstMapInfo map;
  guint8 *luma;

  fail_unless (gst_video_info_from_caps (&info, caps));
  for (guint p = 0; p < GST_VIDEO_INFO_N_PLANES (&info); p++) {
    stride[p] = GST_VIDEO_INFO_PLANE_STRIDE (&info, p) + padding;
    offset[p] = size;
    size += (gsize) stride[p] * (gsize) (height + 1);
  }
  buffer = gst_buffer_new_allocate (NULL, size, NULL);
  gst_buffer_map (buffer, &map, GST_MAP_WRITE);
  memset (map.data, 0x80, map.size);
  luma = map.data + offset[0];
  for (gint y = 0; y < height; y++) {
    for (gint x = 0; x < width; x++) {
      gint column = (x - left) / SIDE, row = (y - top) / SIDE;
      gboolean black = board && x >= left && y >= top && column < COLUMNS
          && row < ROWS && (column + row) % 2 == 0;

      luma[y * stride[0] + x] = black ? 40 : 200;
    }
  }
  gst_buffer_unmap (buffer, &map);
  gst_buffer_add_video_meta_full (buffer, GST_VIDEO_FRAME_FLAG_NONE,
      GST_VIDEO_INFO_FORMAT (&info), (guint) width, (guint) height,
      GST_VIDEO_INFO_N_PLANES (&info), offset, stride);
  GST_BUFFER_DURATION (buffer) = 40 * GST_MSECOND;
  return buffer;
}

static GstBuffer *
at (GstBuffer * buffer, guint frame)
{
  GST_BUFFER_PTS (buffer) = frame * 40 * GST_MSECOND;
  return buffer;
}

/* How many squares are tracked; each must have its own index and lie on its place. */
static guint
tracked (GstBuffer * buffer, gint left, gint top)
{
  GstClothQuads *quads = gst_buffer_get_cloth_quads (buffer);
  guint n = 0;

  fail_unless (quads != NULL);
  fail_unless_equals_int ((gint) gst_cloth_quads_get_columns (quads), COLUMNS);
  fail_unless_equals_int ((gint) gst_cloth_quads_get_rows (quads), ROWS);
  fail_unless_equals_string (gst_cloth_quads_get_camera (quads), "cam0");
  for (guint k = 0; k < gst_cloth_quads_get_n_quads (quads); k++) {
    static const gint corner[4][2] = { {0, 0}, {1, 0}, {1, 1}, {0, 1} };
    GstClothQuad quad;

    fail_unless (gst_cloth_quads_get_quad (quads, k, &quad));
    if (quad.state != GST_CLOTH_QUAD_TRACKED)
      continue;
    n++;
    fail_unless ((quad.column + quad.row) % 2 == (quad.black ? 0 : 1));
    for (guint c = 0; c < 4; c++) {
      gdouble x = left + SIDE * ((gint) quad.column + corner[c][0]) - 0.5;
      gdouble y = top + SIDE * ((gint) quad.row + corner[c][1]) - 0.5;

      fail_unless (hypot (quad.x[c] - x, quad.y[c] - y) < 0.5,
          "square %u, %u, corner %u at %g, %g instead of %g, %g", quad.column,
          quad.row, c, quad.x[c], quad.y[c], x, y);
      fail_unless (quad.cov_xx[c] > 0 && quad.cov_yy[c] > 0);
    }
  }
  return n;
}

static GstHarness *
start (const gchar * launch, const gchar * format, gint width, gint height)
{
  GstHarness *h = gst_harness_new_parse (launch);
  g_autofree gchar *caps = caps_of (format, width, height);

  gst_harness_set_src_caps_str (h, caps);
  return h;
}

/* Pushes one picture and counts what is tracked in it. */
static guint
push (GstHarness * h, GstBuffer * buffer, gint left, gint top)
{
  GstBuffer *out = gst_harness_push_and_pull (h, buffer);
  guint n;

  fail_unless (out != NULL);
  n = tracked (out, left, top);
  gst_buffer_unref (out);
  return n;
}

#define N_BLACK (COLUMNS * ROWS / 2)

/* Every format, odd widths, padded rows; with saddledetect before it and without. */
GST_START_TEST (test_formats)
{
  static const gchar *const formats[] = { "GRAY8", "I420", "YV12", "NV12",
    "NV21", "Y42B", "NV16", "NV61", "Y444", "NV24", "Y41B", "YUV9", "YVU9",
    "A420"
  };
  static const gchar *const chains[] = { "quadtrack" BOARD,
    "saddledetect ! quadtrack" BOARD
  };

  for (guint f = 0; f < G_N_ELEMENTS (formats); f++) {
    for (guint c = 0; c < G_N_ELEMENTS (chains); c++) {
      GstHarness *h = start (chains[c], formats[f], WIDTH, HEIGHT);

      for (guint frame = 0; frame < 2; frame++) {
        guint n = push (h, at (picture (formats[f], WIDTH, HEIGHT,
                    frame * 13, LEFT, TOP, TRUE), frame), LEFT, TOP);

        fail_unless_equals_int ((gint) n, N_BLACK);
      }
      gst_harness_teardown (h);
    }
  }
}

GST_END_TEST;

GST_START_TEST (test_both_colours)
{
  GstHarness *h = start ("quadtrack squares=both" BOARD, "GRAY8", WIDTH,
      HEIGHT);
  guint n = 0;

  for (guint frame = 0; frame < 4; frame++)
    n = push (h, at (picture ("GRAY8", WIDTH, HEIGHT, 0, LEFT, TOP, TRUE),
            frame), LEFT, TOP);
  fail_unless (n > N_BLACK, "%u squares", n);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* Pictures without a board carry a payload that says so, and the bus is told. */
GST_START_TEST (test_board_absent)
{
  GstHarness *h = start ("quadtrack name=track" BOARD, "GRAY8", WIDTH, HEIGHT);
  GstElement *element = gst_harness_find_element (h, "quadtrack");
  GstBus *bus = gst_bus_new ();
  static const gboolean shown[] = { FALSE, TRUE, TRUE, FALSE, FALSE, TRUE };
  static const gchar *const told[] = { NULL, "quadtrack/found", NULL,
    "quadtrack/lost", NULL, "quadtrack/found"
  };

  gst_element_set_bus (element, bus);
  for (guint frame = 0; frame < G_N_ELEMENTS (shown); frame++) {
    guint n = push (h, at (picture ("GRAY8", WIDTH, HEIGHT, 0, LEFT, TOP,
                shown[frame]), frame), LEFT, TOP);
    GstMessage *message = gst_bus_pop_filtered (bus, GST_MESSAGE_ELEMENT);

    fail_unless_equals_int ((gint) n, shown[frame] ? N_BLACK : 0);
    fail_unless ((message != NULL) == (told[frame] != NULL));
    if (message) {
      const GstStructure *structure = gst_message_get_structure (message);
      guint squares;

      fail_unless (gst_structure_has_name (structure, told[frame]));
      fail_unless (gst_structure_get_uint (structure, "squares", &squares));
      fail_unless_equals_int ((gint) squares, (gint) n);
      gst_message_unref (message);
    }
  }
  gst_element_set_bus (element, NULL);
  gst_object_unref (bus);
  gst_object_unref (element);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* A board of other squares than was said is told at the end; so is not one that was only away. */
GST_START_TEST (test_other_board)
{
  for (guint other = 0; other < 2; other++) {
    GstHarness *h = start (other ? "quadtrack columns=9 rows=6" :
        "quadtrack" BOARD, "GRAY8", WIDTH, HEIGHT);
    g_autoptr (GstElement) element = gst_harness_find_element (h, "quadtrack");
    g_autoptr (GstBus) bus = gst_bus_new ();
    g_autoptr (GstMessage) message = NULL;

    gst_element_set_bus (element, bus);
    for (guint frame = 0; frame < 6; frame++)
      gst_buffer_unref (gst_harness_push_and_pull (h,
              at (picture ("GRAY8", WIDTH, HEIGHT, 0, LEFT, TOP, frame > 3),
                  frame)));
    gst_harness_push_event (h, gst_event_new_eos ());
    message = gst_bus_pop_filtered (bus, GST_MESSAGE_WARNING);
    fail_unless ((message != NULL) == (other == 1));
    if (message) {
      g_autoptr (GError) error = NULL;

      gst_message_parse_warning (message, &error, NULL);
      fail_unless (strstr (error->message, "tracked in 0 of the 2 pictures"),
          "%s", error->message);
    }
    gst_element_set_bus (element, NULL);
    gst_harness_teardown (h);
  }
}

GST_END_TEST;

/* The paper's tracker alone: nothing without a seed, the board with one. */
GST_START_TEST (test_seed)
{
  g_autofree gchar *seeded = g_strdup_printf ("quadtrack link=false "
      "seed=%d,%d,%d,%d,%d,%d,%d,%d,4,2" BOARD, LEFT + 4 * SIDE,
      TOP + 2 * SIDE, LEFT + 5 * SIDE, TOP + 2 * SIDE, LEFT + 5 * SIDE,
      TOP + 3 * SIDE, LEFT + 4 * SIDE, TOP + 3 * SIDE);
  const gchar *const launch[] = { "quadtrack link=false" BOARD, seeded };

  for (guint k = 0; k < G_N_ELEMENTS (launch); k++) {
    GstHarness *h = start (launch[k], "GRAY8", WIDTH, HEIGHT);
    guint n = 0;

    for (guint frame = 0; frame < 12; frame++)
      n = push (h, at (picture ("GRAY8", WIDTH, HEIGHT, 0, LEFT, TOP, TRUE),
              frame), LEFT, TOP);
    fail_unless (k == 0 ? n == 0 : n >= 15, "%u squares", n);
    gst_harness_teardown (h);
  }
}

GST_END_TEST;

/* Seeds that can't start anything: one warning, with a word about the remedy. */
GST_START_TEST (test_useless_seed)
{
  static const struct
  {
    const gchar *settings, *word;
  } cases[] = {
    {"link=false", "seed"},
    {"link=false seed=121,77,141,77,141,97,121,97,4,9", "column,row"},
    {"link=true seed=121,77,141,77,141,97,121,97,10,2", "column,row"},
    {"link=false seed=141,77,161,77,161,97,141,97,5,2", "squares"},
    {"link=false squares=white seed=121,77,141,77,141,97,121,97,4,2",
        "squares"},
    {"link=false seed=61,57,71,57,71,67,61,67", "corners"},
    {"link=false seed=121,77,121,77,121,77,121,77,4,2", "corners"},
    {"link=false seed=1121,77,1141,77,1141,97,1121,97,4,2", "corners"},
    {"link=true seed=121,77,121,77,121,77,121,77,4,2", NULL},
    {"link=false seed=121,77,141,77,141,97,121,97,4,2", NULL},
    {"link=true seed=141,77,161,77,161,97,141,97,5,2", NULL},
    {"link=false squares=white seed=141,77,161,77,161,97,141,97,5,2", NULL},
    {"link=true", NULL}
  };

  for (guint k = 0; k < G_N_ELEMENTS (cases); k++) {
    g_autofree gchar *launch = g_strdup_printf ("quadtrack %s" BOARD,
        cases[k].settings);
    GstHarness *h = start (launch, "GRAY8", WIDTH, HEIGHT);
    g_autoptr (GstElement) element = gst_harness_find_element (h, "quadtrack");
    g_autoptr (GstBus) bus = gst_bus_new ();
    GstMessage *message;
    guint n = 0, warnings = 0;

    gst_element_set_bus (element, bus);
    for (guint frame = 0; frame < 4; frame++)
      n = push (h, at (picture ("GRAY8", WIDTH, HEIGHT, 0, LEFT, TOP, TRUE),
              frame), LEFT, TOP);
    while ((message = gst_bus_pop_filtered (bus, GST_MESSAGE_WARNING))) {
      g_autofree gchar *debug = NULL;

      gst_message_parse_warning (message, NULL, &debug);
      fail_unless (cases[k].word && strstr (debug, cases[k].word), "%s: %s",
          cases[k].settings, debug);
      gst_message_unref (message);
      warnings++;
    }
    fail_unless_equals_int ((gint) warnings, cases[k].word ? 1 : 0);
    /* Linking finds the board all the same. */
    fail_unless ((n == 0) == (cases[k].word && !strstr (cases[k].settings,
                "true")), "%s: %u squares", cases[k].settings, n);
    gst_element_set_bus (element, NULL);
    gst_harness_teardown (h);
  }
}

GST_END_TEST;

static void
click (GstHarness * h, gint button, gdouble x, gdouble y)
{
  gst_harness_push_upstream_event (h,
      gst_navigation_event_new_mouse_button_press (button, x, y,
          GST_NAVIGATION_MODIFIER_NONE));
}

/* Four clicks are a seed; another button takes back those made so far. They come from
 * a video sink, so through the overlay. */
GST_START_TEST (test_clicks)
{
  GstHarness *h = start ("quadtrack link=false" BOARD " ! clothoverlay",
      "GRAY8", WIDTH, HEIGHT);
  static const gint corner[4][2] = { {0, 0}, {1, 0}, {1, 1}, {0, 1} };
  guint frame = 0, n = 0;

  click (h, 1, 5, 5);
  click (h, 1, 300, 5);
  click (h, 3, 0, 0);
  for (guint c = 0; c < 4; c++) {
    n = push (h, at (picture ("GRAY8", WIDTH, HEIGHT, 0, LEFT, TOP, TRUE),
            frame++), LEFT, TOP);
    fail_unless_equals_int ((gint) n, 0);
    click (h, 1, LEFT + SIDE * (4 + corner[c][0]) + 0.6,
        TOP + SIDE * (2 + corner[c][1]) - 0.8);
  }
  for (guint k = 0; k < 3; k++) {
    GstBuffer *out = gst_harness_push_and_pull (h,
        at (picture ("GRAY8", WIDTH, HEIGHT, 0, LEFT, TOP, TRUE), frame++));
    GstClothQuads *quads = gst_buffer_get_cloth_quads (out);

    n = gst_cloth_quads_get_n_quads (quads);
    gst_buffer_unref (out);
  }
  fail_unless (n > 0);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* What was tracked in pictures of another size, or before a flush, is forgotten. */
GST_START_TEST (test_changes)
{
  GstHarness *h = start ("quadtrack" BOARD, "GRAY8", WIDTH, HEIGHT);
  g_autofree gchar *larger = caps_of ("I420", WIDTH + 99, HEIGHT + 54);

  fail_unless_equals_int ((gint) push (h, at (picture ("GRAY8", WIDTH, HEIGHT,
                  0, LEFT, TOP, TRUE), 0), LEFT, TOP), N_BLACK);
  gst_harness_set_src_caps_str (h, larger);
  fail_unless_equals_int ((gint) push (h, at (picture ("I420", WIDTH + 99,
                  HEIGHT + 54, 3, LEFT + 33, TOP + 44, TRUE), 1), LEFT + 33,
          TOP + 44), N_BLACK);
  fail_unless (gst_harness_push_event (h, gst_event_new_flush_start ()));
  fail_unless (gst_harness_push_event (h, gst_event_new_flush_stop (TRUE)));
  {
    GstSegment segment;
    GstBuffer *out;

    gst_segment_init (&segment, GST_FORMAT_TIME);
    fail_unless (gst_harness_push_event (h, gst_event_new_segment (&segment)));
    out = gst_harness_push_and_pull (h, at (picture ("I420", WIDTH + 99,
                HEIGHT + 54, 0, LEFT, TOP, FALSE), 0));
    fail_unless_equals_int ((gint) gst_cloth_quads_get_n_quads
        (gst_buffer_get_cloth_quads (out)), 0);
    gst_buffer_unref (out);
  }
  fail_unless (gst_harness_push_event (h, gst_event_new_eos ()));
  gst_harness_teardown (h);
}

GST_END_TEST;

/* Pictures in which no board fits. */
GST_START_TEST (test_tiny)
{
  static const gint sizes[][2] = { {1, 1}, {1, 64}, {3, 2}, {7, 7}, {17, 5} };

  for (guint s = 0; s < G_N_ELEMENTS (sizes); s++) {
    GstHarness *h = start ("saddledetect ! quadtrack" BOARD, "GRAY8",
        sizes[s][0], sizes[s][1]);

    for (guint frame = 0; frame < 2; frame++)
      fail_unless_equals_int ((gint) push (h, at (picture ("GRAY8",
                      sizes[s][0], sizes[s][1], 0, 0, 0, TRUE), frame), 0, 0),
          0);
    gst_harness_teardown (h);
  }
}

GST_END_TEST;

/* Two runs give the same bytes. */
GST_START_TEST (test_deterministic)
{
  GBytes *points[2];

  for (guint k = 0; k < 2; k++) {
    GstHarness *h = start ("saddledetect ! quadtrack" BOARD, "GRAY8", WIDTH,
        HEIGHT);
    GstBuffer *out = NULL;

    for (guint frame = 0; frame < 3; frame++) {
      gst_clear_buffer (&out);
      out = gst_harness_push_and_pull (h, at (picture ("GRAY8", WIDTH, HEIGHT,
                  0, LEFT + (gint) frame, TOP, TRUE), frame));
    }
    points[k] = gst_cloth_quads_get_points (gst_buffer_get_cloth_quads (out));
    gst_buffer_unref (out);
    gst_harness_teardown (h);
  }
  fail_unless (g_bytes_get_size (points[0]) > 0);
  fail_unless (g_bytes_equal (points[0], points[1]));
  g_bytes_unref (points[0]);
  g_bytes_unref (points[1]);
}

GST_END_TEST;

/* What can't be used stops the element, with a word about the remedy. */
GST_START_TEST (test_refused)
{
  static const struct
  {
    const gchar *property, *value, *word;
  } bad[] = {
    {"pattern", "/nowhere/pattern.json", "pattern.json"},
    {"pattern", TEST_DATA "/checker_pair/rig.json", "pattern.json"},
    {"pattern", TEST_DATA, "pattern.json"},
    {"seed", "", "x0,y0"},
    {"seed", "1,2,3,4,5,6,7", "x0,y0"},
    {"seed", "1,2,3,4,5,6,7,8,9", "x0,y0"},
    {"seed", "1,2,3,4,5,6,7,8,9,10,11", "x0,y0"},
    {"seed", "1,2,3,4,5,6,7,nan", "x0,y0"},
    {"seed", "1,2,3,4,5,6,7,1e300", "x0,y0"},
    {"seed", "1,2,3,4,5,6,7,8px", "x0,y0"},
    {"seed", "1,2,3,4,5,6,7,8,1.5,2", "x0,y0"},
    {"seed", "1,2,3,4,5,6,7,8,-1,2", "x0,y0"}
  };

  for (guint k = 0; k < G_N_ELEMENTS (bad); k++) {
    GstElement *element = gst_element_factory_make ("quadtrack", NULL);
    GstBus *bus = gst_bus_new ();
    GstMessage *message;
    g_autofree gchar *debug = NULL;

    g_object_set (element, bad[k].property, bad[k].value, NULL);
    gst_element_set_bus (element, bus);
    fail_unless (gst_element_set_state (element, GST_STATE_PAUSED) ==
        GST_STATE_CHANGE_FAILURE, "%s=%s", bad[k].property, bad[k].value);
    message = gst_bus_pop_filtered (bus, GST_MESSAGE_ERROR);
    fail_unless (message != NULL);
    gst_message_parse_error (message, NULL, &debug);
    fail_unless (strstr (debug, bad[k].word) != NULL, "%s", debug);
    gst_message_unref (message);
    gst_element_set_state (element, GST_STATE_NULL);
    gst_element_set_bus (element, NULL);
    gst_object_unref (bus);
    gst_object_unref (element);
  }
}

GST_END_TEST;

/* The seed is of the first picture: it holds again after a seek back to it, and never
 * for another one. */
GST_START_TEST (test_seed_and_seeks)
{
  static const guint to[] = { 0, 7, 0 };
  g_autofree gchar *seeded = g_strdup_printf ("quadtrack link=false "
      "seed=%d,%d,%d,%d,%d,%d,%d,%d,4,2" BOARD, LEFT + 4 * SIDE,
      TOP + 2 * SIDE, LEFT + 5 * SIDE, TOP + 2 * SIDE, LEFT + 5 * SIDE,
      TOP + 3 * SIDE, LEFT + 4 * SIDE, TOP + 3 * SIDE);
  GstHarness *h = start (seeded, "GRAY8", WIDTH, HEIGHT);

  for (guint k = 0; k < G_N_ELEMENTS (to); k++) {
    guint n;

    if (k > 0) {
      GstSegment segment;

      gst_harness_push_event (h, gst_event_new_flush_start ());
      gst_harness_push_event (h, gst_event_new_flush_stop (TRUE));
      gst_segment_init (&segment, GST_FORMAT_TIME);
      segment.start = segment.time = segment.position =
          to[k] * 40 * GST_MSECOND;
      gst_harness_push_event (h, gst_event_new_segment (&segment));
    }
    n = push (h, at (picture ("GRAY8", WIDTH, HEIGHT, 0, LEFT, TOP, TRUE),
            to[k]), LEFT, TOP);
    fail_unless ((n > 0) == (to[k] == 0), "%u squares at %u", n, to[k]);
  }
  gst_harness_teardown (h);
}

GST_END_TEST;

/* Saddles may come over a network, or from somebody else's element. */
GST_START_TEST (test_lying_saddles)
{
  static const gfloat values[] = { -1e30f, 1e30f, -40000, 70000, 1e9f, -1, 0,
    127.5f, 0.25f, 1e-30f, NAN, INFINITY, -INFINITY, 3.2f, 77, -3.4e38f
  };
  enum
  { N = G_N_ELEMENTS (values) };
  GstHarness *h = start ("quadtrack "
      "seed=1e6,1e6,-1e6,0,0,0,1,1,99999,99999" BOARD, "GRAY8", WIDTH, HEIGHT);

  for (guint shift = 0; shift < N; shift++) {
    GstClothSaddle saddles[N * N];
    GstClothCandidate candidates[N * N];
    GstBuffer *buffer = picture ("GRAY8", WIDTH, HEIGHT, 0, LEFT, TOP, TRUE);

    for (guint i = 0; i < N * N; i++) {
      saddles[i].x = candidates[i].x = values[i % N];
      saddles[i].y = candidates[i].y = values[i / N];
      saddles[i].response = candidates[i].response = values[(i + shift) % N];
      saddles[i].axis = values[(i / N + shift) % N];
      saddles[i].cov_xx = values[(2 * i + shift) % N];
      saddles[i].cov_xy = values[(3 * i + shift) % N];
      saddles[i].cov_yy = values[(7 * i + shift) % N];
    }
    gst_buffer_add_cloth_saddles_meta (buffer, gst_cloth_saddles_new ("", shift,
            saddles, N * N, candidates, N * N));
    fail_unless_equals_int ((gint) push (h, at (buffer, shift), LEFT, TOP), 0);
  }
  gst_harness_teardown (h);
}

GST_END_TEST;

/* Each number of a saddle spoiled in turn, in the midst of true ones: the spoiled ones are
 * left out, the board is tracked by the others. */
GST_START_TEST (test_spoiled_saddles)
{
  static const gfloat values[] = { NAN, INFINITY, -INFINITY, 1e30f, -1e30f,
    -1e9f, 40000, -2
  };
  enum
  { FIELDS = sizeof (GstClothSaddle) / sizeof (gfloat) };
  GstHarness *h = start ("quadtrack" BOARD, "GRAY8", WIDTH, HEIGHT);
  GstHarness *detector = start ("saddledetect", "GRAY8", WIDTH, HEIGHT);
  GstBuffer *seen = gst_harness_push_and_pull (detector, at (picture ("GRAY8",
              WIDTH, HEIGHT, 0, LEFT, TOP, TRUE), 0));
  GstClothSaddles *from = gst_buffer_get_cloth_saddles (seen);
  guint n, n_candidates;
  const GstClothSaddle *true_ones = gst_cloth_saddles_get_refined (from, &n);
  const GstClothCandidate *true_candidates =
      gst_cloth_saddles_get_candidates (from, &n_candidates);
  g_autofree GstClothSaddle *saddles = g_new (GstClothSaddle, 2 * n);
  g_autofree GstClothCandidate *candidates =
      g_new (GstClothCandidate, 2 * n_candidates);
  guint frame = 0;

  fail_unless (n >= (COLUMNS - 1) * (ROWS - 1));
  for (guint v = 0; v < G_N_ELEMENTS (values); v++)
    for (guint field = 0; field < FIELDS; field++) {
      GstBuffer *buffer = picture ("GRAY8", WIDTH, HEIGHT, 0, LEFT, TOP, TRUE);

      /* Covariances across may be negative. */
      if (isfinite (values[v]) && (field == 2 || field >= 4))
        continue;
      for (guint k = 0; k < n; k++) {
        saddles[2 * k] = saddles[2 * k + 1] = true_ones[k];
        ((gfloat *) & saddles[2 * k])[field] = values[v];
      }
      for (guint k = 0; k < n_candidates; k++) {
        candidates[2 * k] = candidates[2 * k + 1] = true_candidates[k];
        ((gfloat *) & candidates[2 * k])[field % 3] = values[v];
      }
      gst_buffer_add_cloth_saddles_meta (buffer, gst_cloth_saddles_new ("",
              frame, saddles, 2 * n, candidates, 2 * n_candidates));
      fail_unless_equals_int ((gint) push (h, at (buffer, frame), LEFT, TOP),
          N_BLACK);
      frame++;
    }
  gst_buffer_unref (seen);
  gst_harness_teardown (detector);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* A property bound to a controller follows it, picture by picture. */
GST_START_TEST (test_controlled)
{
  GstHarness *h = start ("quadtrack" BOARD, "GRAY8", WIDTH, HEIGHT);
  g_autoptr (GstElement) track = gst_harness_find_element (h, "quadtrack");
  g_autoptr (GstControlSource) source = gst_interpolation_control_source_new ();
  gfloat damping;

  g_object_set (source, "mode", GST_INTERPOLATION_MODE_LINEAR, NULL);
  gst_timed_value_control_source_set ((GstTimedValueControlSource *) source, 0,
      0.0);
  gst_timed_value_control_source_set ((GstTimedValueControlSource *) source,
      400 * GST_MSECOND, 1.0);
  gst_object_add_control_binding (GST_OBJECT (track),
      gst_direct_control_binding_new (GST_OBJECT (track), "damping", source));
  for (guint i = 0; i <= 10; i += 5) {
    push (h, at (picture ("GRAY8", WIDTH, HEIGHT, 0, LEFT, TOP, TRUE), i), LEFT,
        TOP);
    g_object_get (track, "damping", &damping, NULL);
    fail_unless (fabsf (damping - 0.1f * (gfloat) i) < 1e-3f, "%g at %u",
        damping, i);
  }
  gst_harness_teardown (h);
}

GST_END_TEST;

/* A camera's name that the metadata can't hold: an error, no critical. */
GST_START_TEST (test_long_camera_name)
{
  static const gchar *const elements[] = { "quadtrack", "saddledetect" };
  g_autofree gchar *name = g_strnfill (256, 'a');

  for (guint k = 0; k < G_N_ELEMENTS (elements); k++) {
    GstHarness *h = gst_harness_new (elements[k]);
    g_autofree gchar *caps = caps_of ("GRAY8", WIDTH, HEIGHT);
    GstBus *bus = gst_bus_new ();
    GstMessage *message;
    g_autofree gchar *debug = NULL;

    gst_harness_set_src_caps_str (h, caps);
    gst_element_set_bus (h->element, bus);
    g_object_set (h->element, "camera", name, NULL);
    fail_unless_equals_int (gst_harness_push (h, at (picture ("GRAY8", WIDTH,
                    HEIGHT, 0, LEFT, TOP, TRUE), 0)), GST_FLOW_ERROR);
    message = gst_bus_pop_filtered (bus, GST_MESSAGE_ERROR);
    fail_unless (message != NULL);
    gst_message_parse_error (message, NULL, &debug);
    fail_unless (strstr (debug, "255") != NULL, "%s", debug);
    gst_message_unref (message);
    gst_element_set_bus (h->element, NULL);
    gst_object_unref (bus);
    gst_harness_teardown (h);
  }
}

GST_END_TEST;

/* What is read at the start does not seem to change later. */
GST_START_TEST (test_change_while_running)
{
  GstElement *element = gst_element_factory_make ("quadtrack", NULL);
  gint columns;
  gfloat alpha;

  gst_object_ref_sink (element);
  fail_unless (gst_element_set_state (element, GST_STATE_PAUSED) !=
      GST_STATE_CHANGE_FAILURE);
  g_object_set (element, "columns", 5, "alpha", 0.5f, NULL);
  g_object_get (element, "columns", &columns, "alpha", &alpha, NULL);
  fail_unless_equals_int (columns, 8);
  fail_unless_equals_float (alpha, 0.5f);
  gst_element_set_state (element, GST_STATE_NULL);
  g_object_set (element, "columns", 5, NULL);
  g_object_get (element, "columns", &columns, NULL);
  fail_unless_equals_int (columns, 5);
  gst_object_unref (element);
}

GST_END_TEST;

static Suite *
quadtrack_suite (void)
{
  Suite *suite = suite_create ("quadtrack");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (suite, tc);
  tcase_add_test (tc, test_formats);
  tcase_add_test (tc, test_both_colours);
  tcase_add_test (tc, test_board_absent);
  tcase_add_test (tc, test_other_board);
  tcase_add_test (tc, test_seed);
  tcase_add_test (tc, test_seed_and_seeks);
  tcase_add_test (tc, test_useless_seed);
  tcase_add_test (tc, test_clicks);
  tcase_add_test (tc, test_lying_saddles);
  tcase_add_test (tc, test_spoiled_saddles);
  tcase_add_test (tc, test_controlled);
  tcase_add_test (tc, test_long_camera_name);
  tcase_add_test (tc, test_changes);
  tcase_add_test (tc, test_change_while_running);
  tcase_add_test (tc, test_tiny);
  tcase_add_test (tc, test_deterministic);
  tcase_add_test (tc, test_refused);
  return suite;
}

GST_CHECK_MAIN (quadtrack);
