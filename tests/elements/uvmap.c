/* uvmap: from synthetic heads, which see a cylinder of cloth, to a mesh. The truth is the
 * cylinder, whose geodesics are known exactly.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <glib/gstdio.h>
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <math.h>

#include <gst/cloth/cloth.h>

#define COLUMNS 9
#define ROWS 7
#define N_VERTICES (COLUMNS * ROWS)
#define CLOTH_W 0.32
#define CLOTH_H 0.24
#define RADIUS 0.2
#define FOCAL_BASELINE 30.0
#define PERIOD (40 * GST_MSECOND)
#define MAX_HEADS 16

static gchar *folder;

typedef struct
{
  GstElement *element;
  GstHarness *src, *in[MAX_HEADS];
  guint n_pads;
  GstBus *bus;
} Bench;

/* @turn: heads stand turned by this about the upright axis of the world, which is the
 *   cylinder's, a metre away from it, rad
 * @aside: by how much the calibration of a head is wrong, m
 * @columns: of the grid of the matches
 * @scaled: the picture is so much smaller than the disparities
 *
 * What one head sees.
 */
typedef struct
{
  const gchar *camera;
  gint width, height;
  gdouble turn, aside;
  guint n_cameras;
  guint columns;
  gboolean matches, disparity, points;
  guint scaled;
} View;

static const View usual =
    { "head", 201, 151, 0, 0, 2, COLUMNS, TRUE, TRUE, FALSE, 1 };

static gdouble
focal (const View * view)
{
  return 1.7 * view->width;
}

/* Point (camera frame) and uv under a pixel. */
static gboolean
look (const View * view, gdouble x, gdouble y, gdouble point[3], gdouble uv[2])
{
  const gdouble rx = (x - 0.5 * (view->width - 1)) / focal (view);
  const gdouble ry = (y - 0.5 * (view->height - 1)) / focal (view);
  const gdouble a = 1 + rx * rx, root = 1 - a * (1 - RADIUS * RADIUS);
  const gdouble z = (1 - sqrt (root)) / a;
  gdouble turn;

  if (!(root > 0))
    return FALSE;
  point[0] = rx * z;
  point[1] = ry * z;
  point[2] = z;
  turn = asin (point[0] / RADIUS);
  uv[0] = CLOTH_W / 2 + RADIUS * (turn - view->turn);
  uv[1] = CLOTH_H / 2 + point[1];
  return fabs (turn) < 1.2 && uv[0] >= 0 && uv[0] <= CLOTH_W && uv[1] >= 0
      && uv[1] <= CLOTH_H;
}

static GstClothDisparity *
make_disparity (const View * view, guint64 sequence)
{
  const guint n = (guint) view->width * (guint) view->height;
  const gdouble normal[3] = { 0, 0, 1 };
  const gdouble s = sin (view->turn), c = cos (view->turn);
  /* world: the cylinder's axis is y; the head stands at distance 1 */
  const gdouble R[9] = { c, 0, -s, 0, 1, 0, s, 0, c };
  const gdouble t[3] = { view->aside, 0, 1 };
  g_autofree gfloat *rays = g_new (gfloat, 2 * n);
  g_autofree gfloat *disparities = g_new (gfloat, n);
  g_autofree guint8 *states = g_new (guint8, n);
  GstClothStereo *stereo;
  GstClothDisparity *disparity;

  for (guint i = 0; i < n; i++) {
    const gdouble x = i % (guint) view->width, y = i / (guint) view->width;
    gdouble p[3], uv[2];
    const gboolean is = look (view, x, y, p, uv);

    rays[2 * i] = (gfloat) ((x - 0.5 * (view->width - 1)) / focal (view));
    rays[2 * i + 1] = (gfloat) ((y - 0.5 * (view->height - 1)) / focal (view));
    disparities[i] = is ? (gfloat) (FOCAL_BASELINE / p[2]) : NAN;
    states[i] = is ? GST_CLOTH_DISPARITY_MEASURED : GST_CLOTH_DISPARITY_OUTSIDE;
  }
  stereo = gst_cloth_stereo_new ((guint) view->width, (guint) view->height,
      rays, 2 * n, normal, FOCAL_BASELINE, R, t, view->n_cameras);
  disparity = gst_cloth_disparity_new (view->camera, sequence, stereo, 0.1f,
      disparities, n, states, n);
  gst_cloth_stereo_unref (stereo);
  return disparity;
}

static GstClothMatches *
make_matches (const View * view, guint64 sequence)
{
  g_autoptr (GArray) matches = g_array_new (FALSE, TRUE,
      sizeof (GstClothMatch));
  const GstClothGridPoint point = { 4, 3, FALSE,
    (gfloat) ((0.5 * view->width) / view->scaled - 0.5),
    (gfloat) ((0.5 * view->height) / view->scaled - 0.5), 0.01f, 0, 0.01f
  };

  for (gint y = 2; y < view->height - 1; y += 7)
    for (gint x = 2; x < view->width - 1; x += 7) {
      const gdouble px = x + 0.3 * (y % 3), py = y + 0.3 * (x % 3);
      gdouble p[3], uv[2];

      if (look (view, px, py, p, uv)) {
        const GstClothMatch match = {
          .x = (gfloat) ((px + 0.5) / view->scaled - 0.5),
          .y = (gfloat) ((py + 0.5) / view->scaled - 0.5),
          .u = (gfloat) uv[0],.v = (gfloat) uv[1],.scale = 1,.verified = TRUE
        };
        GstClothMatch wrong = match;

        g_array_append_val (matches, match);
        /* one that was refused */
        wrong.u += 0.1f;
        wrong.verified = FALSE;
        g_array_append_val (matches, wrong);
      }
    }
  return gst_cloth_matches_new (view->camera, sequence, view->columns, ROWS,
      matches->len, TRUE, (const GstClothMatch *) matches->data, matches->len,
      &point, view->points ? 1 : 0);
}

static gchar *
write_pattern (const gchar * kind)
{
  g_autofree gchar *picture = g_build_filename (folder, "print.png", NULL);
  gchar *path = g_build_filename (folder, "pattern.json", NULL);
  g_autofree gchar *text = g_strdup_printf ("{\"version\": 1, \"pattern\": "
      "\"%s\", \"reference\": \"print.png\", \"cloth_m\": [%g, %g], "
      "\"columns\": %d, \"rows\": %d}", kind, CLOTH_W, CLOTH_H, COLUMNS, ROWS);

  fail_unless (g_file_set_contents (picture, "", 0, NULL));
  fail_unless (g_file_set_contents (path, text, -1, NULL));
  return path;
}

static void
bench_caps (Bench * b, guint pad, const View * view, gint fps)
{
  g_autofree gchar *caps =
      g_strdup_printf ("video/x-raw,format=GRAY8,width=%d,height=%d,"
      "framerate=%d/1", view->width / (gint) view->scaled,
      view->height / (gint) view->scaled, fps);

  gst_harness_set_src_caps_str (b->in[pad], caps);
}

static void
bench_init (Bench * b, guint n_pads, const View * view, guint threads)
{
  g_autofree gchar *path = write_pattern ("picture");

  *b = (Bench) {
  gst_element_factory_make ("uvmap", NULL)};
  fail_unless (b->element != NULL);
  gst_object_ref_sink (b->element);
  b->bus = gst_bus_new ();
  gst_element_set_bus (b->element, b->bus);
  g_object_set (b->element, "pattern", path, "threads", threads, "depth-step",
      0.05, "radius", 0.015, "reach", 12., NULL);
  b->src = gst_harness_new_with_element (b->element, NULL, "src");
  b->n_pads = n_pads;
  for (guint i = 0; i < n_pads; i++) {
    g_autofree gchar *name = g_strdup_printf ("sink_%u", i);

    b->in[i] = gst_harness_new_with_element (b->element, name, NULL);
    bench_caps (b, i, view, 25);
  }
}

static void
bench_clear (Bench * b)
{
  gst_element_set_state (b->element, GST_STATE_NULL);
  for (guint i = 0; i < b->n_pads; i++)
    gst_harness_teardown (b->in[i]);
  gst_harness_teardown (b->src);
  gst_element_set_bus (b->element, NULL);
  gst_object_unref (b->bus);
  gst_object_unref (b->element);
}

static GstFlowReturn
push (Bench * b, guint pad, const View * view, guint frame)
{
  GstBuffer *buffer = gst_buffer_new ();

  GST_BUFFER_PTS (buffer) = frame * PERIOD;
  GST_BUFFER_DURATION (buffer) = PERIOD;
  if (view->matches)
    gst_buffer_add_cloth_matches_meta (buffer, make_matches (view, frame));
  if (view->disparity)
    gst_buffer_add_cloth_disparity_meta (buffer, make_disparity (view, frame));
  return gst_harness_push (b->in[pad], buffer);
}

static GstClothMesh *
parse (GstBuffer * buffer)
{
  g_autoptr (GError) error = NULL;
  GstClothMesh *mesh = gst_cloth_mesh_from_buffer (buffer, &error);

  g_assert_no_error (error);
  fail_unless_equals_int (gst_cloth_mesh_get_n_vertices (mesh), N_VERTICES);
  return mesh;
}

/* Vertices within @worst of the cylinder; returns how many are in @state; none is in another
 * but unseen. */
static guint
expect (GstClothMesh * mesh, guint8 state, gdouble worst)
{
  const gfloat *p = gst_cloth_mesh_get_positions (mesh, NULL);
  const gfloat *c = gst_cloth_mesh_get_covariances (mesh, NULL);
  const guint8 *states = gst_cloth_mesh_get_states (mesh, NULL);
  guint n = 0;

  for (guint i = 0; i < N_VERTICES; i++) {
    const gdouble turn = (CLOTH_W * (i % COLUMNS) / (COLUMNS - 1)
        - CLOTH_W / 2) / RADIUS;
    const gdouble truth[3] = { RADIUS * sin (turn), CLOTH_H * (i / COLUMNS)
          / (ROWS - 1) - CLOTH_H / 2, -RADIUS * cos (turn)
    };
    gdouble e = 0;

    if (states[i] == GST_CLOTH_VERTEX_UNSEEN) {
      fail_unless (isnan (p[3 * i]));
      continue;
    }
    fail_unless_equals_int (states[i], state);
    for (guint k = 0; k < 3; k++)
      e += (p[3 * i + k] - truth[k]) * (p[3 * i + k] - truth[k]);
    fail_unless (sqrt (e) < worst, "vertex %u is %g m off", i, sqrt (e));
    fail_unless (c[6 * i] > 0 && c[6 * i + 3] > 0 && c[6 * i + 5] > 0);
    n++;
  }
  return n;
}

/* The same of the next mesh. */
static guint
expect_next (Bench * b, guint8 state, gdouble worst)
{
  GstBuffer *buffer = gst_harness_pull (b->src);
  g_autoptr (GstClothMesh) mesh = parse (buffer);

  gst_buffer_unref (buffer);
  return expect (mesh, state, worst);
}

static guint
count_messages (Bench * b, GstMessageType type, const gchar * part)
{
  GstMessage *message;
  guint n = 0;

  while ((message = gst_bus_pop_filtered (b->bus, type))) {
    g_autoptr (GError) error = NULL;

    if (type == GST_MESSAGE_WARNING)
      gst_message_parse_warning (message, &error, NULL);
    else
      gst_message_parse_error (message, &error, NULL);
    n += strstr (error->message, part) != NULL;
    gst_message_unref (message);
  }
  return n;
}

GST_START_TEST (test_one_head)
{
  g_autoptr (GstClothMesh) mesh = NULL;
  g_autoptr (GstClothTopology) topology = NULL;
  g_autoptr (GstCaps) caps = NULL;
  g_autoptr (GError) error = NULL;
  const gfloat *uv;
  GstBuffer *buffer;
  GstClothUV *map;
  gint n, d;
  Bench b;

  bench_init (&b, 1, &usual, 1);
  fail_unless_equals_int (push (&b, 0, &usual, 3), GST_FLOW_OK);
  buffer = gst_harness_pull (b.src);
  fail_unless (GST_BUFFER_PTS (buffer) == 3 * PERIOD);
  mesh = parse (buffer);
  fail_unless (gst_cloth_mesh_get_sequence (mesh) == 3);
  fail_unless (expect (mesh, GST_CLOTH_VERTEX_TWO_VIEWS, 0.002) > 45);

  caps = gst_pad_get_current_caps (b.src->sinkpad);
  topology = gst_cloth_topology_from_caps (caps, &error);
  g_assert_no_error (error);
  fail_unless_equals_int (gst_cloth_topology_get_columns (topology), COLUMNS);
  fail_unless_equals_int (gst_cloth_topology_get_rows (topology), ROWS);
  uv = gst_cloth_topology_get_uv (topology, NULL);
  fail_unless (fabs (uv[2 * (N_VERTICES - 1)] - CLOTH_W) < 1e-6);
  fail_unless (fabs (uv[2 * (N_VERTICES - 1) + 1] - CLOTH_H) < 1e-6);
  fail_unless (gst_structure_get_fraction (gst_caps_get_structure (caps, 0),
          "framerate", &n, &d));
  fail_unless (n == 25 && d == 1);

  map = gst_buffer_get_cloth_uv (buffer, "head");
  fail_unless (map != NULL);
  fail_unless_equals_int (gst_cloth_uv_get_width (map), usual.width);
  fail_unless_equals_int (gst_cloth_uv_get_height (map), usual.height);
  uv = gst_cloth_uv_get_uv (map, NULL);
  for (gint y = 40; y < usual.height - 40; y += 5)
    for (gint x = 60; x < usual.width - 60; x += 5) {
      const gfloat *at = uv + 2 * (y * usual.width + x);
      gdouble p[3], truth[2];

      fail_unless (look (&usual, x, y, p, truth));
      fail_unless (hypot (at[0] - truth[0], at[1] - truth[1]) < 0.001);
    }
  fail_unless (isnan (uv[0]));
  gst_buffer_unref (buffer);
  bench_clear (&b);
}

GST_END_TEST;

/* Each sees a side; the middle is seen by both. */
GST_START_TEST (test_two_heads)
{
  View left = usual, right = usual;
  g_autoptr (GstClothMesh) mesh = NULL;
  const guint8 *states;
  const gfloat *p;
  GstBuffer *buffer;
  guint n_both = 0, n_one = 0;
  Bench b;

  left.turn = -0.4;
  left.camera = "left";
  right.turn = 0.4;
  right.camera = "right";
  bench_init (&b, 2, &usual, 2);
  push (&b, 0, &left, 0);
  push (&b, 1, &right, 0);
  buffer = gst_harness_pull (b.src);
  mesh = parse (buffer);
  states = gst_cloth_mesh_get_states (mesh, NULL);
  p = gst_cloth_mesh_get_positions (mesh, NULL);
  for (guint i = 0; i < N_VERTICES; i++) {
    const gdouble turn = (CLOTH_W * (i % COLUMNS) / (COLUMNS - 1)
        - CLOTH_W / 2) / RADIUS;

    n_both += states[i] == GST_CLOTH_VERTEX_MEASURED;
    n_one += states[i] == GST_CLOTH_VERTEX_TWO_VIEWS;
    if (states[i] != GST_CLOTH_VERTEX_UNSEEN) {
      fail_unless (fabs (p[3 * i] - RADIUS * sin (turn)) < 0.002);
      fail_unless (fabs (p[3 * i + 2] + RADIUS * cos (turn)) < 0.002);
    }
  }
  fail_unless (n_both > 30, "%u by both", n_both);
  fail_unless (n_one > 5, "%u by one", n_one);
  fail_unless (gst_buffer_get_cloth_uv (buffer, "left") != NULL);
  fail_unless (gst_buffer_get_cloth_uv (buffer, "right") != NULL);
  gst_buffer_unref (buffer);
  bench_clear (&b);
}

GST_END_TEST;

/* A head that stands elsewhere than its calibration says. */
GST_START_TEST (test_contradiction)
{
  View wrong = usual;
  Bench b;

  wrong.aside = 0.05;
  bench_init (&b, 2, &usual, 1);
  for (guint frame = 0; frame < 26; frame++) {
    push (&b, 0, &usual, frame);
    push (&b, 1, &wrong, frame);
    fail_unless (expect_next (&b, GST_CLOTH_VERTEX_TWO_VIEWS, 0.06) < 10);
  }
  fail_unless_equals_int (count_messages (&b, GST_MESSAGE_WARNING,
          "contradict"), 1);
  bench_clear (&b);
}

GST_END_TEST;

/* A film that ends before the 25th set is judged, too. */
GST_START_TEST (test_short_contradiction)
{
  View wrong = usual;
  Bench b;

  wrong.aside = 0.05;
  bench_init (&b, 2, &usual, 1);
  push (&b, 0, &usual, 0);
  push (&b, 1, &wrong, 0);
  gst_buffer_unref (gst_harness_pull (b.src));
  fail_unless_equals_int (count_messages (&b, GST_MESSAGE_WARNING,
          "contradict"), 0);
  gst_harness_push_event (b.in[0], gst_event_new_eos ());
  gst_harness_push_event (b.in[1], gst_event_new_eos ());
  while (TRUE) {
    g_autoptr (GstEvent) event = gst_harness_pull_event (b.src);

    if (GST_EVENT_TYPE (event) == GST_EVENT_EOS)
      break;
  }
  fail_unless_equals_int (count_messages (&b, GST_MESSAGE_WARNING,
          "contradict"), 1);
  bench_clear (&b);
}

GST_END_TEST;

/* The third tells which of two is wrong. */
GST_START_TEST (test_three_heads)
{
  View wrong = usual;
  Bench b;

  wrong.aside = 0.05;
  bench_init (&b, 3, &usual, 1);
  push (&b, 0, &usual, 0);
  push (&b, 1, &wrong, 0);
  push (&b, 2, &usual, 0);
  fail_unless (expect_next (&b, GST_CLOTH_VERTEX_MEASURED, 0.002) > 45);
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_three_cameras)
{
  View view = usual;
  Bench b;

  view.n_cameras = 3;
  bench_init (&b, 1, &view, 1);
  push (&b, 0, &view, 0);
  fail_unless (expect_next (&b, GST_CLOTH_VERTEX_MEASURED, 0.002) > 45);
  bench_clear (&b);
}

GST_END_TEST;

/* What is missing is told once; the mesh goes on, all unseen. */
GST_START_TEST (test_missing)
{
  View without = usual;
  Bench b;

  without.matches = FALSE;
  bench_init (&b, 1, &usual, 1);
  for (guint frame = 0; frame < 4; frame++) {
    g_autoptr (GstClothMesh) mesh = NULL;
    GstBuffer *buffer;

    if (frame == 2) {
      without.matches = TRUE;
      without.disparity = FALSE;
    }
    push (&b, 0, &without, frame);
    buffer = gst_harness_pull (b.src);
    mesh = parse (buffer);
    fail_unless_equals_int (expect (mesh, GST_CLOTH_VERTEX_UNSEEN, 0), 0);
    fail_unless (gst_buffer_get_nth_cloth_uv (buffer, 0) == NULL);
    gst_buffer_unref (buffer);
    fail_unless_equals_int (count_messages (&b, GST_MESSAGE_WARNING,
            frame < 2 ? "no matches" : "no disparities"), frame % 2 == 0);
  }
  bench_clear (&b);
}

GST_END_TEST;

/* Matches of another grid. */
GST_START_TEST (test_other_grid)
{
  View other = usual;
  g_autoptr (GError) error = NULL;
  GstMessage *message;
  Bench b;

  other.columns = COLUMNS + 1;
  bench_init (&b, 1, &usual, 1);
  push (&b, 0, &other, 0);
  message = gst_bus_timed_pop_filtered (b.bus, GST_CLOCK_TIME_NONE,
      GST_MESSAGE_ERROR);
  gst_message_parse_error (message, &error, NULL);
  fail_unless (strstr (error->message,
          "10×7 vertices, but pattern has 9×7") != NULL);
  gst_message_unref (message);
  fail_unless_equals_int (gst_harness_buffers_received (b.src), 0);
  bench_clear (&b);
}

GST_END_TEST;

/* No pattern, one of another kind, one that isn't there. */
GST_START_TEST (test_wrong_pattern)
{
  g_autofree gchar *checker = write_pattern ("checker");
  const gchar *const paths[] = { NULL, checker, "/nowhere/pattern.json" };
  const gchar *const parts[] = { "not set", "checker", "nowhere" };

  for (guint i = 0; i < G_N_ELEMENTS (paths); i++) {
    GstElement *element = gst_object_ref_sink (gst_element_factory_make
        ("uvmap", NULL));
    Bench b = { element,.bus = gst_bus_new () };

    gst_element_set_bus (element, b.bus);
    g_object_set (element, "pattern", paths[i], NULL);
    fail_unless_equals_int (gst_element_set_state (element, GST_STATE_PAUSED),
        GST_STATE_CHANGE_FAILURE);
    fail_unless_equals_int (count_messages (&b, GST_MESSAGE_ERROR, parts[i]),
        1);
    gst_element_set_state (element, GST_STATE_NULL);
    gst_element_set_bus (element, NULL);
    gst_object_unref (b.bus);
    gst_object_unref (element);
  }
}

GST_END_TEST;

/* A place that siftmatch has found counts: here it is told three pixels off. */
GST_START_TEST (test_points)
{
  View view = usual;
  const guint middle = 3 * COLUMNS + 4;
  gfloat x[2];
  Bench b;

  bench_init (&b, 1, &view, 1);
  for (guint frame = 0; frame < 2; frame++) {
    g_autoptr (GstClothMesh) mesh = NULL;
    GstBuffer *buffer;

    view.points = frame == 1;
    push (&b, 0, &view, frame);
    buffer = gst_harness_pull (b.src);
    mesh = parse (buffer);
    x[frame] = gst_cloth_mesh_get_covariances (mesh, NULL)[6 * middle];
    gst_buffer_unref (buffer);
  }
  fail_unless (x[0] > 0 && x[1] > 0 && x[0] != x[1]);
  bench_clear (&b);
}

GST_END_TEST;

/* The picture was made smaller after its disparities were found. */
GST_START_TEST (test_scaled)
{
  View view = usual;
  Bench b;

  view.width = 200;
  view.height = 150;
  view.scaled = 2;
  bench_init (&b, 1, &view, 1);
  push (&b, 0, &view, 0);
  fail_unless (expect_next (&b, GST_CLOTH_VERTEX_TWO_VIEWS, 0.004) > 45);
  bench_clear (&b);
}

GST_END_TEST;

/* Another size and rate in mid-stream; a flush; the end. */
GST_START_TEST (test_stream)
{
  View other = usual;
  g_autoptr (GstClothMesh) first = NULL, second = NULL, third = NULL;
  g_autoptr (GstCaps) caps = NULL;
  GstBuffer *buffer;
  GstSegment segment;
  GstEvent *event;
  gint n, d;
  Bench b;

  bench_init (&b, 1, &usual, 1);
  push (&b, 0, &usual, 0);
  buffer = gst_harness_pull (b.src);
  first = parse (buffer);
  fail_unless (expect (first, GST_CLOTH_VERTEX_TWO_VIEWS, 0.002) > 45);
  gst_buffer_unref (buffer);

  other.width = 253;
  other.height = 187;
  bench_caps (&b, 0, &other, 50);
  push (&b, 0, &other, 1);
  buffer = gst_harness_pull (b.src);
  second = parse (buffer);
  fail_unless (expect (second, GST_CLOTH_VERTEX_TWO_VIEWS, 0.002) > 45);
  gst_buffer_unref (buffer);
  caps = gst_pad_get_current_caps (b.src->sinkpad);
  fail_unless (gst_structure_get_fraction (gst_caps_get_structure (caps, 0),
          "framerate", &n, &d));
  fail_unless (n == 50 && d == 1);

  fail_unless (gst_harness_push_event (b.in[0], gst_event_new_flush_start ()));
  fail_unless (gst_harness_push_event (b.in[0],
          gst_event_new_flush_stop (TRUE)));
  gst_segment_init (&segment, GST_FORMAT_TIME);
  gst_harness_push_event (b.in[0], gst_event_new_segment (&segment));
  push (&b, 0, &other, 0);
  buffer = gst_harness_pull (b.src);
  third = parse (buffer);
  fail_unless (gst_cloth_mesh_get_sequence (third) == 0);
  gst_buffer_unref (buffer);

  fail_unless (gst_harness_push_event (b.in[0], gst_event_new_eos ()));
  do {
    event = gst_harness_pull_event (b.src);
    fail_unless (event != NULL);
    n = GST_EVENT_TYPE (event);
    gst_event_unref (event);
  } while (n != GST_EVENT_EOS);
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_threads)
{
  g_autoptr (GstBuffer) first = NULL;

  for (guint threads = 1; threads <= 5; threads += 2) {
    GstBuffer *buffer;
    gsize size;
    GstMapInfo map;
    Bench b;

    bench_init (&b, 1, &usual, threads);
    push (&b, 0, &usual, 0);
    buffer = gst_harness_pull (b.src);
    if (!first)
      first = gst_buffer_ref (buffer);
    size = gst_buffer_get_size (first);
    fail_unless (gst_buffer_map (buffer, &map, GST_MAP_READ));
    fail_unless_equals_int (map.size, size);
    fail_unless (gst_buffer_memcmp (first, 0, map.data, size) == 0);
    gst_buffer_unmap (buffer, &map);
    gst_buffer_unref (buffer);
    bench_clear (&b);
  }
}

GST_END_TEST;

/* Sixteen heads, and no more. */
GST_START_TEST (test_heads)
{
  GstElement *element = gst_object_ref_sink (gst_element_factory_make ("uvmap",
          NULL));

  for (guint i = 0; i <= MAX_HEADS; i++) {
    GstPad *pad = gst_element_request_pad_simple (element, "sink_%u");

    fail_unless ((pad != NULL) == (i < MAX_HEADS));
    if (pad)
      gst_object_unref (pad);
  }
  gst_object_unref (element);
}

GST_END_TEST;

static gint
compare_doubles (gconstpointer a, gconstpointer b)
{
  const gdouble x = *(const gdouble *) a, y = *(const gdouble *) b;

  return x < y ? -1 : x > y;
}

/* The first picture of a film whose truth is known, through all elements of a head. */
GST_START_TEST (test_film)
{
  static const gchar data[] = TEST_DATA "/lineart_stereo3";
  g_autofree gchar *line = g_strdup_printf ("clothdisparity name=head "
      "rig=%s/rig.json near=1.2 far=2.2 ! siftmatch pattern=%s/pattern.json "
      "! uvmap pattern=%s/pattern.json ! fakesink name=sink num-buffers=1 "
      "filesrc location=%s/cam0.mp4 ! decodebin ! videoconvert ! queue "
      "! head.sink_0 filesrc location=%s/cam1.mp4 ! decodebin ! queue "
      "! head.sink_1 filesrc location=%s/cam2.mp4 ! decodebin ! queue "
      "! head.sink_2", data, data, data, data, data, data);
  g_autoptr (GError) error = NULL;
  g_autofree gchar *path = g_build_filename (data, "vertices.npy", NULL);
  g_autofree gchar *truth = NULL;
  g_autoptr (GstSample) sample = NULL;
  g_autoptr (GstClothMesh) mesh = NULL;
  g_autoptr (GArray) errors = g_array_new (FALSE, FALSE, sizeof (gdouble));
  GstElement *pipeline = gst_parse_launch (line, &error), *sink;
  const gfloat *p;
  GstMessage *message;
  GstBus *bus;
  gsize size, header;

  g_assert_no_error (error);
  sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");
  bus = gst_element_get_bus (pipeline);
  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  message = gst_bus_timed_pop_filtered (bus, GST_CLOCK_TIME_NONE,
      GST_MESSAGE_EOS | GST_MESSAGE_ERROR);
  fail_unless_equals_int (GST_MESSAGE_TYPE (message), GST_MESSAGE_EOS);
  gst_message_unref (message);
  g_object_get (sink, "last-sample", &sample, NULL);
  fail_unless (GST_BUFFER_PTS (gst_sample_get_buffer (sample)) == 0);
  mesh = gst_cloth_mesh_from_buffer (gst_sample_get_buffer (sample), &error);
  g_assert_no_error (error);
  fail_unless_equals_int (gst_cloth_mesh_get_n_vertices (mesh), 33 * 35);
  p = gst_cloth_mesh_get_positions (mesh, NULL);

  fail_unless (g_file_get_contents (path, &truth, &size, NULL));
  /* of a version 1 file */
  header = 10 + (guint8) truth[8] + 256 * (gsize) (guint8) truth[9];
  fail_unless (size >= header + 3 * 33 * 35 * sizeof (gfloat));
  for (guint i = 0; i < 33 * 35; i++) {
    gfloat at[3];
    gdouble e;

    memcpy (at, truth + header + 3 * i * sizeof (gfloat), sizeof at);
    e = sqrt ((p[3 * i] - at[0]) * (p[3 * i] - at[0]) + (p[3 * i + 1]
            - at[1]) * (p[3 * i + 1] - at[1]) + (p[3 * i + 2] - at[2])
        * (p[3 * i + 2] - at[2]));
    if (!isnan (e))
      g_array_append_val (errors, e);
  }
  fail_unless (errors->len > 1000, "%u seen", errors->len);
  qsort (errors->data, errors->len, sizeof (gdouble), compare_doubles);
  fail_unless (g_array_index (errors, gdouble, errors->len / 2) < 0.0015);
  fail_unless (g_array_index (errors, gdouble, errors->len * 9 / 10) < 0.006);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (bus);
  gst_object_unref (sink);
  gst_object_unref (pipeline);
}

GST_END_TEST;

static void
set_up (void)
{
  g_autoptr (GError) error = NULL;

  folder = g_dir_make_tmp ("uvmap-XXXXXX", &error);
  g_assert_no_error (error);
}

static void
tear_down (void)
{
  static const gchar *const names[] = { "print.png", "pattern.json" };

  for (guint i = 0; i < G_N_ELEMENTS (names); i++) {
    g_autofree gchar *path = g_build_filename (folder, names[i], NULL);

    g_remove (path);
  }
  g_rmdir (folder);
  g_clear_pointer (&folder, g_free);
}

static Suite *
uvmap_suite (void)
{
  Suite *s = suite_create ("uvmap");
  TCase *tc = tcase_create ("general");

  tcase_add_checked_fixture (tc, set_up, tear_down);
  tcase_add_test (tc, test_one_head);
  tcase_add_test (tc, test_two_heads);
  tcase_add_test (tc, test_contradiction);
  tcase_add_test (tc, test_short_contradiction);
  tcase_add_test (tc, test_three_heads);
  tcase_add_test (tc, test_three_cameras);
  tcase_add_test (tc, test_missing);
  tcase_add_test (tc, test_other_grid);
  tcase_add_test (tc, test_wrong_pattern);
  tcase_add_test (tc, test_points);
  tcase_add_test (tc, test_scaled);
  tcase_add_test (tc, test_stream);
  tcase_add_test (tc, test_threads);
  tcase_add_test (tc, test_heads);
  tcase_add_test (tc, test_film);
  suite_add_tcase (s, tc);
  return s;
}

GST_CHECK_MAIN (uvmap);
