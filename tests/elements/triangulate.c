/* triangulate: from the squares that synthetic cameras see to a mesh, and everything that
 * must not become one. The truth is the geometry that the cameras were given.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <glib/gstdio.h>
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/check/gsttestclock.h>
#include <math.h>

#include <gst/cloth/cloth.h>

#include "gst/pattern/pattern.h"
#include "gst/rig/rigfile.h"

#define COLUMNS 6
#define ROWS 5
#define N_QUADS (COLUMNS * ROWS)
#define N_VERTICES ((COLUMNS + 1) * (ROWS + 1))
#define SQUARE 0.04
#define MAX_CAMERAS 4
#define PERIOD (40 * GST_MSECOND)
#define VIDEO "video/x-raw,format=GRAY8,width=1280,height=720,framerate=25/1"
#define OBSERVATIONS GST_CLOTH_OBSERVATIONS_MEDIA_TYPE \
    ",version=1,width=1280,height=720,framerate=25/1"
#define ALL G_MAXUINT

typedef struct
{
  gchar *folder, *rig_path, *pattern_path;
  ClothRig *rig;
  GstElement *element;
  GstHarness *src;
  GstHarness *in[MAX_CAMERAS];
  guint n_pads;
  GstBus *bus;
  guint frame;
} Bench;

/* Where vertex i is at a time: a wavy sheet that moves. */
static void
truth (guint i, guint frame, gdouble X[3])
{
  gdouble u = (i % (COLUMNS + 1)) * SQUARE, v = (i / (COLUMNS + 1)) * SQUARE;

  X[0] = u - 0.12 + 0.01 * frame;
  X[1] = 0.03 * sin (12. * u + frame) + 0.02 * cos (9. * v);
  X[2] = 1.1 - v;
}

static void
make_rig (ClothRig * rig)
{
  static const gdouble k[5] = { -0.2, 0.05, 1e-3, -5e-4, 0.002 };
  guint i;

  for (i = 0; i < rig->n_cameras; i++) {
    ClothCamera *c = &rig->cameras[i];
    gdouble a = -0.5 + 0.5 * i, s = sin (a), co = cos (a);
    gdouble R[9] = { co, -s, 0., 0., 0., -1., s, co, 0. };

    g_free (c->name);
    c->name = g_strdup_printf ("cam%u", i);
    c->width = 1280;
    c->height = 720;
    c->K[0] = c->K[4] = 1200.;
    c->K[2] = 639.5;
    c->K[5] = 359.5;
    c->K[8] = 1.;
    c->lens = CLOTH_LENS_BROWN5;
    memcpy (c->k, k, sizeof (k));
    memcpy (c->R, R, sizeof (R));
    /* 1.5 m from (0, 0, 1) */
    c->t[0] = 0.;
    c->t[1] = 1.;
    c->t[2] = 1.5;
  }
}

/* Element with rig and pattern, not linked yet. */
static void
bench_open (Bench * b, guint n_cameras)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothPattern) pattern = NULL;

  memset (b, 0, sizeof (*b));
  b->folder = g_dir_make_tmp ("triangulate-XXXXXX", &error);
  g_assert_no_error (error);
  b->rig_path = g_build_filename (b->folder, "rig.json", NULL);
  b->pattern_path = g_build_filename (b->folder, "pattern.json", NULL);
  b->rig = cloth_rig_new (n_cameras);
  make_rig (b->rig);
  cloth_rig_save (b->rig, b->rig_path, &error);
  g_assert_no_error (error);
  pattern = cloth_pattern_new_checker (COLUMNS, ROWS, SQUARE, 0.05, TRUE,
      &error);
  g_assert_no_error (error);
  cloth_pattern_save (pattern, b->pattern_path, &error);
  g_assert_no_error (error);

  b->element = gst_element_factory_make ("triangulate", NULL);
  fail_unless (b->element != NULL);
  gst_object_ref_sink (b->element);
  b->bus = gst_bus_new ();
  gst_element_set_bus (b->element, b->bus);
  g_object_set (b->element, "rig", b->rig_path, "pattern", b->pattern_path,
      NULL);
}

static void
bench_link (Bench * b, guint n_pads, gboolean live, const gchar * caps)
{
  guint i;

  b->n_pads = n_pads;
  b->src = gst_harness_new_with_element (b->element, NULL, "src");
  for (i = 0; i < n_pads; i++) {
    g_autofree gchar *name = g_strdup_printf ("sink_%u", i);

    b->in[i] = gst_harness_new_with_element (b->element, name, NULL);
    gst_harness_set_live (b->in[i], live);
  }
  if (live) {
    gst_harness_use_testclock (b->src);
  }
  gst_harness_set_live (b->src, live);
  for (i = 0; i < n_pads; i++) {
    gst_harness_set_src_caps_str (b->in[i], caps);
  }
}

static void
bench_init (Bench * b, guint n_cameras)
{
  bench_open (b, n_cameras);
  bench_link (b, n_cameras, FALSE, VIDEO);
}

static void
bench_clear (Bench * b)
{
  guint i;

  gst_element_set_state (b->element, GST_STATE_NULL);
  for (i = 0; i < b->n_pads; i++) {
    gst_harness_teardown (b->in[i]);
  }
  if (b->src) {
    gst_harness_teardown (b->src);
  }
  gst_element_set_bus (b->element, NULL);
  gst_object_unref (b->bus);
  gst_object_unref (b->element);
  cloth_rig_free (b->rig);
  g_remove (b->rig_path);
  g_remove (b->pattern_path);
  g_rmdir (b->folder);
  g_free (b->rig_path);
  g_free (b->pattern_path);
  g_free (b->folder);
}

/* What camera i sees of all squares at a time. */
static void
see (Bench * b, guint camera, guint frame, GstClothQuad quads[N_QUADS])
{
  guint q, c;

  memset (quads, 0, N_QUADS * sizeof (*quads));
  for (q = 0; q < N_QUADS; q++) {
    quads[q].column = (gint) (q % COLUMNS);
    quads[q].row = (gint) (q / COLUMNS);
    quads[q].state = GST_CLOTH_QUAD_TRACKED;
    quads[q].confidence = 1.0f;
    for (c = 0; c < 4; c++) {
      guint column = q % COLUMNS + (c == 1 || c == 2);
      guint row = q / COLUMNS + (c >= 2);
      gdouble X[3], px[2];

      truth (row * (COLUMNS + 1) + column, frame, X);
      fail_unless (cloth_camera_project (&b->rig->cameras[camera], X, px, NULL,
              NULL));
      quads[q].x[c] = (gfloat) px[0];
      quads[q].y[c] = (gfloat) px[1];
      quads[q].cov_xx[c] = quads[q].cov_yy[c] = 0.01f;
    }
  }
}

static GstBuffer *
picture (GstClothQuads * quads, guint frame)
{
  GstBuffer *buffer = gst_buffer_new ();

  GST_BUFFER_PTS (buffer) = frame * PERIOD;
  GST_BUFFER_DURATION (buffer) = PERIOD;
  if (quads) {
    gst_buffer_add_cloth_quads_meta (buffer, quads);
  }
  return buffer;
}

static void
push (Bench * b, guint pad, GstClothQuads * quads, guint frame)
{
  fail_unless_equals_int (gst_harness_push (b->in[pad], picture (quads, frame)),
      GST_FLOW_OK);
}

/* Camera i's picture to pad i: the first n squares. */
static void
push_seen (Bench * b, guint pad, guint camera, guint frame, guint n,
    const gchar * name)
{
  GstClothQuad quads[N_QUADS];

  see (b, camera, frame, quads);
  push (b, pad, gst_cloth_quads_new (name, frame, COLUMNS, ROWS, quads, MIN (n,
              N_QUADS)), frame);
}

static void
push_all (Bench * b, guint frame)
{
  guint i;

  for (i = 0; i < b->n_pads; i++) {
    push_seen (b, i, i, frame, ALL, NULL);
  }
}

static GstClothMesh *
pull (Bench * b, guint frame)
{
  g_autoptr (GstBuffer) buffer = gst_harness_pull (b->src);
  g_autoptr (GError) error = NULL;
  GstClothMesh *mesh;

  fail_unless (buffer != NULL);
  fail_unless_equals_uint64 (GST_BUFFER_PTS (buffer), frame * PERIOD);
  mesh = gst_cloth_mesh_from_buffer (buffer, &error);
  g_assert_no_error (error);
  fail_unless_equals_int (gst_cloth_mesh_get_n_vertices (mesh), N_VERTICES);
  return mesh;
}

/* Each vertex has the state given, and is where it was if it is not unseen. Returns the
 * greatest error. */
static gdouble
check_all (GstClothMesh * mesh, guint frame, GstClothVertexState state)
{
  const gfloat *p = gst_cloth_mesh_get_positions (mesh, NULL);
  const gfloat *cov = gst_cloth_mesh_get_covariances (mesh, NULL);
  const guint8 *states = gst_cloth_mesh_get_states (mesh, NULL);
  gdouble worst = 0.;
  guint i, j;

  for (i = 0; i < N_VERTICES; i++) {
    gdouble X[3], s = 0.;

    fail_unless_equals_int (states[i], state);
    truth (i, frame, X);
    for (j = 0; j < 3; j++) {
      s += (p[3 * i + j] - X[j]) * (p[3 * i + j] - X[j]);
      fail_unless (isnan (p[3 * i + j]) == (state == GST_CLOTH_VERTEX_UNSEEN));
    }
    if (state != GST_CLOTH_VERTEX_UNSEEN) {
      worst = fmax (worst, sqrt (s));
      /* 0.1 px and as much again is 0.18 mm at 1.5 m; depth comes from half a radian or
       * more */
      for (j = 0; j < 6; j += j == 0 ? 3 : 2) {
        gdouble sigma = sqrt (cov[6 * i + j]);

        fail_unless (sigma > 0.05e-3 && sigma < 0.6e-3, "sigma %g", sigma);
      }
    }
  }
  return worst;
}

static void
expect_all (Bench * b, guint frame, GstClothVertexState state)
{
  g_autoptr (GstClothMesh) mesh = pull (b, frame);

  /* places in px travel as floats: 3e-5 px */
  fail_unless (check_all (mesh, frame, state) < 1e-6);
}

static void
expect_message (Bench * b, GstMessageType type, const gchar * text)
{
  g_autoptr (GstMessage) message =
      gst_bus_timed_pop_filtered (b->bus, 10 * GST_SECOND, type);
  g_autoptr (GError) error = NULL;
  g_autofree gchar *debug = NULL;

  fail_unless (message != NULL, "no message with \"%s\"", text);
  if (type == GST_MESSAGE_ERROR) {
    gst_message_parse_error (message, &error, &debug);
  } else {
    gst_message_parse_warning (message, &error, &debug);
  }
  fail_unless (strstr (error->message, text) || strstr (debug, text),
      "\"%s\" is not in: %s (%s)", text, error->message, debug);
  g_test_message ("%s", error->message);
}

/* Nothing more must have been sent. */
static void
expect_error (Bench * b, const gchar * text)
{
  expect_message (b, GST_MESSAGE_ERROR, text);
  fail_unless (gst_harness_try_pull (b->src) == NULL);
}

GST_START_TEST (test_three_views)
{
  Bench b;
  guint frame;

  bench_init (&b, 3);
  for (frame = 0; frame < 4; frame++) {
    push_all (&b, frame);
    expect_all (&b, frame, GST_CLOTH_VERTEX_MEASURED);
  }
  {
    g_autoptr (GstCaps) caps = gst_pad_get_current_caps (b.src->sinkpad);
    g_autoptr (GError) error = NULL;
    g_autoptr (GstClothTopology) topology =
        gst_cloth_topology_from_caps (caps, &error);
    const gfloat *uv;
    gint n, d;

    g_assert_no_error (error);
    fail_unless_equals_int (gst_cloth_topology_get_columns (topology),
        COLUMNS + 1);
    fail_unless_equals_int (gst_cloth_topology_get_rows (topology), ROWS + 1);
    uv = gst_cloth_topology_get_uv (topology, NULL);
    /* the margin of 50 mm; then the third vertex of the second row */
    fail_unless (fabs (uv[0] - 0.05) < 1e-6 && fabs (uv[1] - 0.05) < 1e-6);
    fail_unless (fabs (uv[2 * (COLUMNS + 3)] - 0.13) < 1e-6);
    fail_unless (fabs (uv[2 * (COLUMNS + 3) + 1] - 0.09) < 1e-6);
    fail_unless (gst_structure_get_fraction (gst_caps_get_structure (caps, 0),
            "framerate", &n, &d));
    fail_unless_equals_int (n, 25);
    fail_unless_equals_int (d, 1);
  }
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_two_views)
{
  Bench b;

  bench_init (&b, 2);
  push_all (&b, 0);
  expect_all (&b, 0, GST_CLOTH_VERTEX_TWO_VIEWS);
  bench_clear (&b);
}

GST_END_TEST;

/* Squares seen by one camera only, and squares that are not tracked now, are unseen. */
GST_START_TEST (test_unseen)
{
  Bench b;
  GstClothQuad quads[N_QUADS];
  g_autoptr (GstClothMesh) mesh = NULL;
  const guint8 *states;
  guint i;

  bench_init (&b, 2);
  see (&b, 0, 0, quads);
  for (i = 0; i < N_QUADS; i++) {
    if (i % COLUMNS >= 3) {
      quads[i].state = i % 2 ? GST_CLOTH_QUAD_LOST : GST_CLOTH_QUAD_PREDICTED;
    }
  }
  push (&b, 0, gst_cloth_quads_new (NULL, 0, COLUMNS, ROWS, quads, N_QUADS), 0);
  push_seen (&b, 1, 1, 0, ALL, NULL);
  mesh = pull (&b, 0);
  states = gst_cloth_mesh_get_states (mesh, NULL);
  for (i = 0; i < N_VERTICES; i++) {
    fail_unless_equals_int (states[i], i % (COLUMNS + 1) <= 3 ?
        GST_CLOTH_VERTEX_TWO_VIEWS : GST_CLOTH_VERTEX_UNSEEN);
  }
  bench_clear (&b);
}

GST_END_TEST;

/* Nothing seen is a mesh of unseen vertices: nothing of the frame before is left. */
GST_START_TEST (test_nothing_seen)
{
  Bench b;

  bench_init (&b, 3);
  push_all (&b, 0);
  expect_all (&b, 0, GST_CLOTH_VERTEX_MEASURED);
  push_seen (&b, 0, 0, 1, 0, NULL);
  push_seen (&b, 1, 1, 1, 0, NULL);
  push_seen (&b, 2, 2, 1, 0, NULL);
  expect_all (&b, 1, GST_CLOTH_VERTEX_UNSEEN);
  /* no metadata at all, in one and in every camera */
  push (&b, 0, NULL, 2);
  push_seen (&b, 1, 1, 2, ALL, NULL);
  push_seen (&b, 2, 2, 2, ALL, NULL);
  expect_all (&b, 2, GST_CLOTH_VERTEX_TWO_VIEWS);
  push (&b, 0, NULL, 3);
  push (&b, 1, NULL, 3);
  push (&b, 2, NULL, 3);
  expect_all (&b, 3, GST_CLOTH_VERTEX_UNSEEN);
  push_all (&b, 4);
  expect_all (&b, 4, GST_CLOTH_VERTEX_MEASURED);
  bench_clear (&b);
}

GST_END_TEST;

/* No frame ever carries squares: said once. */
GST_START_TEST (test_no_detector)
{
  Bench b;
  guint frame, i;

  bench_init (&b, 2);
  for (frame = 0; frame < 30; frame++) {
    for (i = 0; i < 2; i++) {
      push (&b, i, NULL, frame);
    }
    expect_all (&b, frame, GST_CLOTH_VERTEX_UNSEEN);
  }
  expect_message (&b, GST_MESSAGE_WARNING, "quadtrack");
  fail_unless (gst_bus_pop_filtered (b.bus, GST_MESSAGE_WARNING) == NULL);
  bench_clear (&b);
}

GST_END_TEST;

/* One camera linked, or one of two with a detector: said once, with its name. */
GST_START_TEST (test_one_detector)
{
  guint n, frame;

  for (n = 1; n <= 2; n++) {
    Bench b;

    bench_open (&b, 2);
    bench_link (&b, n, FALSE, VIDEO);
    for (frame = 0; frame < 30; frame++) {
      push_seen (&b, 0, 0, frame, ALL, "cam0");
      if (n == 2) {
        push (&b, 1, NULL, frame);
      }
      expect_all (&b, frame, GST_CLOTH_VERTEX_UNSEEN);
    }
    expect_message (&b, GST_MESSAGE_WARNING, "Only camera \"cam0\"");
    fail_unless (gst_bus_pop_filtered (b.bus, GST_MESSAGE_WARNING) == NULL);
    bench_clear (&b);
  }
}

GST_END_TEST;

/* The pads are mixed up, or a camera was moved: said once, with its name. */
GST_START_TEST (test_cameras_do_not_fit)
{
  Bench b;
  guint frame, i;

  bench_init (&b, 4);
  b.rig->cameras[2].t[1] += 0.02;
  for (frame = 0; frame < 30; frame++) {
    for (i = 0; i < 4; i++) {
      push_seen (&b, i, i, frame, ALL, NULL);
    }
    gst_buffer_unref (gst_harness_pull (b.src));
  }
  expect_message (&b, GST_MESSAGE_WARNING, "Camera \"cam2\"");
  fail_unless (gst_bus_pop_filtered (b.bus, GST_MESSAGE_WARNING) == NULL);
  bench_clear (&b);
}

GST_END_TEST;

/* A camera without a frame for an instant: the others make the mesh. */
GST_START_TEST (test_missing_camera)
{
  Bench b;

  bench_init (&b, 3);
  push_all (&b, 0);
  expect_all (&b, 0, GST_CLOTH_VERTEX_MEASURED);
  fail_unless (gst_harness_push_event (b.in[1], gst_event_new_gap (PERIOD,
              PERIOD)));
  push_seen (&b, 0, 0, 1, ALL, NULL);
  push_seen (&b, 2, 2, 1, ALL, NULL);
  expect_all (&b, 1, GST_CLOTH_VERTEX_TWO_VIEWS);
  push_seen (&b, 0, 0, 2, ALL, NULL);
  push_seen (&b, 2, 2, 2, ALL, NULL);
  push_seen (&b, 1, 1, 2, ALL, NULL);
  expect_all (&b, 2, GST_CLOTH_VERTEX_MEASURED);
  /* one ends before the others */
  fail_unless (gst_harness_push_event (b.in[0], gst_event_new_eos ()));
  push_seen (&b, 1, 1, 3, ALL, NULL);
  push_seen (&b, 2, 2, 3, ALL, NULL);
  expect_all (&b, 3, GST_CLOTH_VERTEX_TWO_VIEWS);
  bench_clear (&b);
}

GST_END_TEST;

/* A camera whose clock is two frames ahead: pictures of different instants, which the
 * first ones are, make no mesh. */
GST_START_TEST (test_offset)
{
  /* pad and frame, in an order in which no pad waits for another */
  static const guint order[][2] = { {0, 0}, {1, 0}, {2, 0}, {0, 1}, {2, 1},
  {1, 1}, {1, 2}, {1, 3}
  };
  g_autoptr (GError) error = NULL;
  g_autoptr (GstClothMesh) mesh = NULL;
  Bench b;
  guint i;

  bench_open (&b, 3);
  b.rig->cameras[1].offset_s = 2. * PERIOD / GST_SECOND;
  cloth_rig_save (b.rig, b.rig_path, &error);
  g_assert_no_error (error);
  bench_link (&b, 3, FALSE, VIDEO);
  for (i = 0; i < G_N_ELEMENTS (order); i++) {
    guint pad = order[i][0], frame = order[i][1];
    GstClothQuad quads[N_QUADS];

    see (&b, pad, frame + (pad == 1 ? 0 : 2), quads);
    push (&b, pad, gst_cloth_quads_new (NULL, frame, COLUMNS, ROWS, quads,
            N_QUADS), frame);
  }
  mesh = pull (&b, 1);
  fail_unless (check_all (mesh, 3, GST_CLOTH_VERTEX_MEASURED) < 1e-6);
  bench_clear (&b);
}

GST_END_TEST;

/* Cameras by the name in the metadata, whatever the order of the pads. */
GST_START_TEST (test_names_in_metadata)
{
  Bench b;

  bench_init (&b, 3);
  push_seen (&b, 0, 2, 0, ALL, "cam2");
  push_seen (&b, 1, 0, 0, ALL, "cam0");
  push_seen (&b, 2, 1, 0, ALL, "cam1");
  expect_all (&b, 0, GST_CLOTH_VERTEX_MEASURED);
  bench_clear (&b);
}

GST_END_TEST;

/* Cameras by the pads' property, which wins over the metadata; two pads of a rig of
 * three. */
GST_START_TEST (test_names_of_pads)
{
  Bench b;
  g_autofree gchar *name = NULL;

  bench_open (&b, 3);
  bench_link (&b, 2, FALSE, VIDEO);
  gst_child_proxy_set (GST_CHILD_PROXY (b.element), "sink_0::camera", "cam2",
      "sink_1::camera", "cam1", NULL);
  gst_child_proxy_get (GST_CHILD_PROXY (b.element), "sink_1::camera", &name,
      NULL);
  fail_unless_equals_string (name, "cam1");
  push_seen (&b, 0, 2, 0, ALL, "cam0");
  push_seen (&b, 1, 1, 0, ALL, NULL);
  expect_all (&b, 0, GST_CLOTH_VERTEX_TWO_VIEWS);
  bench_clear (&b);
}

GST_END_TEST;

/* The same from observation streams, beside a picture. */
GST_START_TEST (test_observations)
{
  Bench b;
  guint frame, i;

  bench_open (&b, 3);
  bench_link (&b, 3, FALSE, OBSERVATIONS);
  gst_harness_set_src_caps_str (b.in[1], VIDEO);
  for (frame = 0; frame < 3; frame++) {
    for (i = 0; i < 3; i++) {
      GstClothQuad quads[N_QUADS];
      GstBuffer *buffer;

      see (&b, i, frame, quads);
      buffer = picture (gst_cloth_quads_new (NULL, frame, COLUMNS, ROWS, quads,
              N_QUADS), frame);
      if (i != 1) {
        GstBuffer *packed = gst_cloth_observations_pack (buffer);

        gst_buffer_unref (buffer);
        buffer = packed;
      }
      fail_unless_equals_int (gst_harness_push (b.in[i], buffer), GST_FLOW_OK);
    }
    expect_all (&b, frame, GST_CLOTH_VERTEX_MEASURED);
  }
  /* bytes that are no observations: as a camera that saw nothing */
  push_seen (&b, 1, 1, 3, ALL, NULL);
  for (i = 0; i < 3; i += 2) {
    GstBuffer *buffer = gst_buffer_new_memdup ("nonsense", 8);

    GST_BUFFER_PTS (buffer) = 3 * PERIOD;
    GST_BUFFER_DURATION (buffer) = PERIOD;
    fail_unless_equals_int (gst_harness_push (b.in[i], buffer), GST_FLOW_OK);
  }
  expect_all (&b, 3, GST_CLOTH_VERTEX_UNSEEN);
  expect_message (&b, GST_MESSAGE_WARNING, "sink_0 holds no observations");
  expect_message (&b, GST_MESSAGE_WARNING, "sink_2 holds no observations");
  /* a stream of them is told of once */
  for (i = 0; i < 3; i++) {
    GstBuffer *buffer = gst_buffer_new_memdup ("nonsense", 8);

    GST_BUFFER_PTS (buffer) = 4 * PERIOD;
    GST_BUFFER_DURATION (buffer) = PERIOD;
    fail_unless_equals_int (gst_harness_push (b.in[i], buffer), GST_FLOW_OK);
  }
  expect_all (&b, 4, GST_CLOTH_VERTEX_UNSEEN);
  fail_unless (gst_bus_pop_filtered (b.bus, GST_MESSAGE_WARNING) == NULL);
  bench_clear (&b);
}

GST_END_TEST;

/* One camera has slipped by a square: the three others outvote it. */
GST_START_TEST (test_slipped_camera)
{
  Bench b;
  GstClothQuad quads[N_QUADS];
  g_autoptr (GstClothMesh) mesh = NULL;
  guint i;

  bench_init (&b, 4);
  for (i = 0; i < 3; i++) {
    push_seen (&b, i, i, 0, ALL, NULL);
  }
  see (&b, 3, 0, quads);
  for (i = 0; i < N_QUADS; i++) {
    quads[i].column = (quads[i].column + 1) % COLUMNS;
  }
  push (&b, 3, gst_cloth_quads_new (NULL, 0, COLUMNS, ROWS, quads, N_QUADS), 0);
  mesh = pull (&b, 0);
  fail_unless (check_all (mesh, 0, GST_CLOTH_VERTEX_MEASURED) < 1e-6);
  bench_clear (&b);
}

GST_END_TEST;

/* Neighbouring squares of one picture that put their common corner 5 px apart: that
 * camera has not seen that corner. */
GST_START_TEST (test_contradictory_corners)
{
  Bench b;
  GstClothQuad quads[N_QUADS];
  g_autoptr (GstClothMesh) mesh = NULL;
  const guint8 *states;
  guint i;

  bench_init (&b, 2);
  see (&b, 0, 0, quads);
  quads[0].x[2] += 5.0f;
  push (&b, 0, gst_cloth_quads_new (NULL, 0, COLUMNS, ROWS, quads, N_QUADS), 0);
  push_seen (&b, 1, 1, 0, ALL, NULL);
  mesh = pull (&b, 0);
  states = gst_cloth_mesh_get_states (mesh, NULL);
  for (i = 0; i < N_VERTICES; i++) {
    fail_unless_equals_int (states[i], i == COLUMNS + 2 ?
        GST_CLOTH_VERTEX_UNSEEN : GST_CLOTH_VERTEX_TWO_VIEWS);
  }
  bench_clear (&b);
}

GST_END_TEST;

/* The corners state 0.01 px²: a floor of 0.03 px² makes four times the covariance that no
 * floor does. */
GST_START_TEST (test_error_floor)
{
  Bench b;
  g_autoptr (GstClothMesh) without = NULL, with = NULL;
  const gfloat *small, *large;
  GstClothQuad quads[N_QUADS];
  guint i, round;

  bench_init (&b, 3);
  for (round = 0; round < 2; round++) {
    g_object_set (b.element, "error-floor", round ? 0.03 : 0.0, NULL);
    for (i = 0; i < 3; i++) {
      /* the same places in both */
      see (&b, i, 0, quads);
      push (&b, i, gst_cloth_quads_new (NULL, round, COLUMNS, ROWS, quads,
              N_QUADS), round);
    }
    *(round ? &with : &without) = pull (&b, round);
  }
  small = gst_cloth_mesh_get_covariances (without, NULL);
  large = gst_cloth_mesh_get_covariances (with, NULL);
  for (i = 0; i < 6 * N_VERTICES; i++) {
    fail_unless (fabsf (large[i] - 4.0f * small[i]) <=
        1e-5f * large[6 * (i / 6)]);
  }
  bench_clear (&b);
}

GST_END_TEST;

/* Places that are not finite and squares off the board do no harm. */
GST_START_TEST (test_bad_quads)
{
  Bench b;
  GstClothQuad quads[N_QUADS];
  g_autoptr (GstClothMesh) mesh = NULL;
  const guint8 *states;
  guint i, n = 0;

  bench_init (&b, 2);
  see (&b, 0, 0, quads);
  for (i = 0; i < N_QUADS; i++) {
    switch (i % 4) {
      case 0:
        quads[i].x[0] = quads[i].y[1] = NAN;
        break;
      case 1:
        quads[i].x[2] = INFINITY;
        break;
      case 2:
        quads[i].cov_xx[0] = -1.0f;
        quads[i].cov_xy[1] = NAN;
        break;
      default:
        break;
    }
  }
  push (&b, 0, gst_cloth_quads_new (NULL, 0, COLUMNS, ROWS, quads, N_QUADS), 0);
  push_seen (&b, 1, 1, 0, ALL, NULL);
  mesh = pull (&b, 0);
  states = gst_cloth_mesh_get_states (mesh, NULL);
  for (i = 0; i < N_VERTICES; i++) {
    n += states[i] == GST_CLOTH_VERTEX_TWO_VIEWS;
  }
  /* most corners are also those of a good square */
  fail_unless (n > N_VERTICES / 2 && n < N_VERTICES, "%u", n);
  bench_clear (&b);
}

GST_END_TEST;

/* Squares that no board has, of states that there are not, are left alone. */
GST_START_TEST (test_wild_quads)
{
  static const gint wild[] = { -1, G_MININT, G_MAXINT, COLUMNS, 65536 };
  enum
  { N_WILD = G_N_ELEMENTS (wild) };
  Bench b;
  GstClothQuad quads[N_QUADS + 3 * N_WILD];
  guint i, k;

  bench_init (&b, 2);
  for (i = 0; i < 2; i++) {
    see (&b, i, 0, quads);
    for (k = 0; k < 3 * N_WILD; k++) {
      GstClothQuad *q = &quads[N_QUADS + k];

      *q = quads[k];
      q->x[0] += 50;
      q->y[2] = 1e30f;
      if (k < N_WILD) {
        q->column = wild[k];
      } else if (k < 2 * N_WILD) {
        q->row = wild[k - N_WILD];
      } else {
        q->state = (GstClothQuadState) (k == 2 * N_WILD ? -1 : 99 + (gint) k);
      }
    }
    push (&b, i, gst_cloth_quads_new (NULL, 0, COLUMNS, ROWS, quads,
            G_N_ELEMENTS (quads)), 0);
  }
  expect_all (&b, 0, GST_CLOTH_VERTEX_TWO_VIEWS);
  bench_clear (&b);
}

GST_END_TEST;

/* Everything that is the user's to mend stops the element, and the error names it. */
static void
refuse_to_start (const gchar * property, const gchar * value,
    const gchar * text)
{
  Bench b;

  bench_open (&b, 2);
  g_object_set (b.element, property, value, NULL);
  fail_unless_equals_int (gst_element_set_state (b.element, GST_STATE_PAUSED),
      GST_STATE_CHANGE_FAILURE);
  expect_message (&b, GST_MESSAGE_ERROR, text);
  bench_clear (&b);
}

GST_START_TEST (test_no_calibration)
{
  refuse_to_start ("rig", NULL, "rig is not set");
  refuse_to_start ("rig", "/nonexistent/rig.json", "rig.json");
  refuse_to_start ("pattern", NULL, "pattern is not set");
  refuse_to_start ("pattern", "/nonexistent/pattern.json", "pattern.json");
  /* a file of another kind */
  refuse_to_start ("rig", TEST_DATA "/checker_pair/pattern.json", "cameras");
  refuse_to_start ("pattern", TEST_DATA "/checker_pair/rig.json", "board");
}

GST_END_TEST;

GST_START_TEST (test_one_camera)
{
  Bench b;

  bench_open (&b, 1);
  fail_unless_equals_int (gst_element_set_state (b.element, GST_STATE_PAUSED),
      GST_STATE_CHANGE_FAILURE);
  expect_message (&b, GST_MESSAGE_ERROR, "2 to 64 cameras");
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_wrong_camera_count)
{
  Bench b;

  /* fewer pads than cameras and no names */
  bench_open (&b, 3);
  bench_link (&b, 2, FALSE, VIDEO);
  push_all (&b, 0);
  expect_error (&b, "2 sink pads for 3 cameras");
  bench_clear (&b);

  bench_open (&b, 2);
  bench_link (&b, 2, FALSE, VIDEO);
  b.n_pads = 3;
  b.in[2] = gst_harness_new_with_element (b.element, "sink_2", NULL);
  gst_harness_set_src_caps_str (b.in[2], VIDEO);
  {
    guint i;

    for (i = 0; i < 3; i++) {
      push_seen (&b, i, 0, 0, ALL, NULL);
    }
  }
  expect_error (&b, "rig has 2 cameras");
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_unknown_camera)
{
  Bench b;

  bench_init (&b, 2);
  push_seen (&b, 0, 0, 0, ALL, "left");
  push_seen (&b, 1, 1, 0, ALL, "cam1");
  expect_error (&b, "camera \"left\"");
  bench_clear (&b);

  bench_init (&b, 2);
  gst_child_proxy_set (GST_CHILD_PROXY (b.element), "sink_1::camera", "right",
      NULL);
  push_all (&b, 0);
  expect_error (&b, "camera \"right\"");
  bench_clear (&b);

  bench_init (&b, 2);
  push_seen (&b, 0, 0, 0, ALL, "cam1");
  push_seen (&b, 1, 1, 0, ALL, "cam1");
  expect_error (&b, "both of camera \"cam1\"");
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_wrong_size)
{
  Bench b;

  bench_init (&b, 2);
  gst_harness_set_src_caps_str (b.in[1],
      "video/x-raw,format=GRAY8,width=640,height=360,framerate=25/1");
  push_all (&b, 0);
  expect_error (&b, "640×360");
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_wrong_board)
{
  Bench b;
  GstClothQuad quads[N_QUADS];

  bench_init (&b, 2);
  see (&b, 0, 0, quads);
  push (&b, 0, gst_cloth_quads_new (NULL, 0, 8, 8, quads, N_QUADS), 0);
  push_seen (&b, 1, 1, 0, ALL, NULL);
  expect_error (&b, "8×8");
  bench_clear (&b);
}

GST_END_TEST;

/* In mid-stream: another frame rate, a moved camera with a new rig.json, a rig.json that
 * can't be read. */
GST_START_TEST (test_changes)
{
  Bench b;
  g_autoptr (GError) error = NULL;
  guint i;

  bench_init (&b, 3);
  push_all (&b, 0);
  expect_all (&b, 0, GST_CLOTH_VERTEX_MEASURED);

  for (i = 0; i < 3; i++) {
    gst_harness_set_src_caps_str (b.in[i],
        "video/x-raw,format=I420,width=1280,height=720,framerate=50/1");
  }
  push_all (&b, 1);
  expect_all (&b, 1, GST_CLOTH_VERTEX_MEASURED);
  {
    g_autoptr (GstCaps) caps = gst_pad_get_current_caps (b.src->sinkpad);
    gint n, d;

    fail_unless (gst_structure_get_fraction (gst_caps_get_structure (caps, 0),
            "framerate", &n, &d));
    fail_unless_equals_int (n, 50);
  }

  b.rig->cameras[1].t[0] += 0.1;
  b.rig->cameras[2].K[2] -= 20.;
  cloth_rig_save (b.rig, b.rig_path, &error);
  g_assert_no_error (error);
  g_object_set (b.element, "rig", b.rig_path, NULL);
  push_all (&b, 2);
  expect_all (&b, 2, GST_CLOTH_VERTEX_MEASURED);

  g_object_set (b.element, "rig", "/nonexistent/rig.json", NULL);
  push_all (&b, 3);
  expect_error (&b, "/nonexistent/rig.json");
  bench_clear (&b);
}

GST_END_TEST;

/* A board of other size in mid-stream: new caps, then meshes of the new size. */
GST_START_TEST (test_other_pattern)
{
  Bench b;
  g_autoptr (ClothPattern) pattern = NULL;
  g_autoptr (GError) error = NULL;
  GstClothQuad quads[N_QUADS];
  guint i;

  bench_init (&b, 2);
  push_all (&b, 0);
  expect_all (&b, 0, GST_CLOTH_VERTEX_TWO_VIEWS);
  pattern = cloth_pattern_new_checker (COLUMNS, ROWS - 1, SQUARE, 0.05, TRUE,
      &error);
  g_assert_no_error (error);
  cloth_pattern_save (pattern, b.pattern_path, &error);
  g_assert_no_error (error);
  g_object_set (b.element, "pattern", b.pattern_path, NULL);
  for (i = 0; i < 2; i++) {
    see (&b, i, 1, quads);
    push (&b, i, gst_cloth_quads_new (NULL, 1, COLUMNS, ROWS - 1, quads,
            COLUMNS * (ROWS - 1)), 1);
  }
  {
    g_autoptr (GstBuffer) buffer = gst_harness_pull (b.src);
    g_autoptr (GstClothMesh) mesh = gst_cloth_mesh_from_buffer (buffer, &error);
    g_autoptr (GstCaps) caps = gst_pad_get_current_caps (b.src->sinkpad);
    gint n;

    g_assert_no_error (error);
    fail_unless_equals_int (gst_cloth_mesh_get_n_vertices (mesh),
        (COLUMNS + 1) * ROWS);
    fail_unless (gst_structure_get_int (gst_caps_get_structure (caps, 0),
            "vertices", &n));
    fail_unless_equals_int (n, (COLUMNS + 1) * ROWS);
  }
  bench_clear (&b);
}

GST_END_TEST;

/* Live, one camera silent: at the deadline the mesh is made of what is there. */
GST_START_TEST (test_live)
{
  Bench b;
  GstTestClock *clock;

  bench_open (&b, 3);
  bench_link (&b, 3, TRUE, VIDEO);
  clock = gst_harness_get_testclock (b.src);
  push_all (&b, 0);
  expect_all (&b, 0, GST_CLOTH_VERTEX_MEASURED);
  push_seen (&b, 0, 0, 1, ALL, NULL);
  push_seen (&b, 2, 2, 1, ALL, NULL);
  {
    GstClockID id;

    gst_test_clock_wait_for_next_pending_id (clock, &id);
    fail_unless_equals_uint64 (gst_clock_id_get_time (id), PERIOD + PERIOD / 2);
    gst_clock_id_unref (id);
  }
  fail_unless (gst_harness_try_pull (b.src) == NULL);
  fail_unless (gst_test_clock_crank (clock));
  expect_all (&b, 1, GST_CLOTH_VERTEX_TWO_VIEWS);
  push_all (&b, 2);
  expect_all (&b, 2, GST_CLOTH_VERTEX_MEASURED);
  gst_object_unref (clock);
  bench_clear (&b);
}

GST_END_TEST;

static void
expect_rate (Bench * b, gint n, gint d)
{
  g_autoptr (GstCaps) caps = gst_pad_get_current_caps (b->src->sinkpad);
  gint have_n, have_d;

  fail_unless (gst_structure_get_fraction (gst_caps_get_structure (caps, 0),
          "framerate", &have_n, &have_d));
  fail_unless (have_n == n && have_d == d, "%d/%d instead of %d/%d", have_n,
      have_d, n, d);
}

/* Cameras of different rates: variable when that is known from the start; one that joins
 * a running stream late changes nothing, for a recording can't change its rate. */
GST_START_TEST (test_rates_differ)
{
  static const gchar other[] =
      "video/x-raw,format=GRAY8,width=1280,height=720,framerate=20/1";
  Bench b;

  bench_open (&b, 2);
  bench_link (&b, 2, FALSE, VIDEO);
  gst_harness_set_src_caps_str (b.in[1], other);
  push_all (&b, 0);
  expect_all (&b, 0, GST_CLOTH_VERTEX_TWO_VIEWS);
  expect_rate (&b, 0, 1);
  /* once they agree there is a rate */
  gst_harness_set_src_caps_str (b.in[1], VIDEO);
  push_all (&b, 1);
  expect_all (&b, 1, GST_CLOTH_VERTEX_TWO_VIEWS);
  expect_rate (&b, 25, 1);
  bench_clear (&b);
}

GST_END_TEST;

GST_START_TEST (test_late_camera_of_other_rate)
{
  static const gchar other[] =
      "video/x-raw,format=GRAY8,width=1280,height=720,framerate=20/1";
  g_autoptr (GstTestClock) clock = NULL;
  GstEvent *event;
  guint n_caps = 0;
  Bench b;

  bench_open (&b, 2);
  b.n_pads = 2;
  b.src = gst_harness_new_with_element (b.element, NULL, "src");
  b.in[0] = gst_harness_new_with_element (b.element, "sink_0", NULL);
  b.in[1] = gst_harness_new_with_element (b.element, "sink_1", NULL);
  gst_harness_set_live (b.in[0], TRUE);
  gst_harness_set_live (b.in[1], TRUE);
  gst_harness_use_testclock (b.src);
  gst_harness_set_live (b.src, TRUE);
  clock = gst_harness_get_testclock (b.src);
  gst_harness_set_src_caps_str (b.in[0], VIDEO);
  push_seen (&b, 0, 0, 0, ALL, NULL);
  {
    GstClockID id;

    gst_test_clock_wait_for_next_pending_id (clock, &id);
    gst_clock_id_unref (id);
  }
  fail_unless (gst_test_clock_crank (clock));
  expect_all (&b, 0, GST_CLOTH_VERTEX_UNSEEN);
  expect_rate (&b, 25, 1);

  gst_harness_set_src_caps_str (b.in[1], other);
  push_all (&b, 1);
  expect_all (&b, 1, GST_CLOTH_VERTEX_TWO_VIEWS);
  expect_rate (&b, 25, 1);
  push_all (&b, 2);
  expect_all (&b, 2, GST_CLOTH_VERTEX_TWO_VIEWS);
  while ((event = gst_harness_try_pull_event (b.src))) {
    n_caps += GST_EVENT_TYPE (event) == GST_EVENT_CAPS;
    gst_event_unref (event);
  }
  fail_unless_equals_int ((gint) n_caps, 1);
  bench_clear (&b);
}

GST_END_TEST;

/* The first camera's capture time and number go on with the mesh, also when only its
 * observations came. */
static void
check_capture_time (gboolean observations)
{
  Bench b;
  g_autoptr (GstCaps) reference =
      gst_caps_new_empty_simple ("timestamp/x-unix");
  g_autoptr (GstBuffer) out = NULL;
  g_autoptr (GstClothMesh) mesh = NULL;
  g_autoptr (GError) error = NULL;
  GstReferenceTimestampMeta *stamp;
  GstClothQuad quads[N_QUADS];
  guint i;

  bench_open (&b, 2);
  bench_link (&b, 2, FALSE, observations ? OBSERVATIONS : VIDEO);
  for (i = 0; i < 2; i++) {
    GstBuffer *buffer;

    see (&b, i, 0, quads);
    buffer = picture (gst_cloth_quads_new (NULL, 1234 + i, COLUMNS, ROWS, quads,
            N_QUADS), 0);
    gst_buffer_add_reference_timestamp_meta (buffer, reference,
        100 * GST_SECOND + i, GST_CLOCK_TIME_NONE);
    if (observations) {
      GstBuffer *packed = gst_cloth_observations_pack (buffer);

      gst_buffer_unref (buffer);
      buffer = packed;
    }
    fail_unless_equals_int (gst_harness_push (b.in[i], buffer), GST_FLOW_OK);
  }
  out = gst_harness_pull (b.src);
  stamp = gst_buffer_get_reference_timestamp_meta (out, NULL);
  fail_unless (stamp != NULL);
  fail_unless_equals_uint64 (stamp->timestamp, 100 * GST_SECOND);
  mesh = gst_cloth_mesh_from_buffer (out, &error);
  g_assert_no_error (error);
  fail_unless_equals_uint64 (gst_cloth_mesh_get_sequence (mesh), 1234);
  bench_clear (&b);
}

GST_START_TEST (test_capture_time)
{
  check_capture_time (FALSE);
  check_capture_time (TRUE);
}

GST_END_TEST;

/* Flush, end, and back to NULL and PLAYING again. */
GST_START_TEST (test_flush_and_restart)
{
  Bench b;
  guint32 seqnum;
  guint i;

  bench_init (&b, 2);
  push_all (&b, 0);
  expect_all (&b, 0, GST_CLOTH_VERTEX_TWO_VIEWS);
  /* one seek, so one sequence number, reaches all pads */
  seqnum = gst_util_seqnum_next ();
  for (i = 0; i < 2; i++) {
    GstEvent *event = gst_event_new_flush_start ();

    gst_event_set_seqnum (event, seqnum);
    fail_unless (gst_harness_push_event (b.in[i], event));
  }
  for (i = 0; i < 2; i++) {
    GstEvent *event = gst_event_new_flush_stop (TRUE);
    GstSegment segment;

    gst_event_set_seqnum (event, seqnum);
    fail_unless (gst_harness_push_event (b.in[i], event));
    gst_segment_init (&segment, GST_FORMAT_TIME);
    fail_unless (gst_harness_push_event (b.in[i],
            gst_event_new_segment (&segment)));
  }
  push_all (&b, 0);
  expect_all (&b, 0, GST_CLOTH_VERTEX_TWO_VIEWS);
  for (i = 0; i < 2; i++) {
    fail_unless (gst_harness_push_event (b.in[i], gst_event_new_eos ()));
  }
  fail_unless (gst_bus_pop_filtered (b.bus, GST_MESSAGE_ERROR) == NULL);
  for (i = 0; i < 3; i++) {
    fail_unless (gst_element_set_state (b.element, GST_STATE_NULL) ==
        GST_STATE_CHANGE_SUCCESS);
    fail_if (gst_element_set_state (b.element, GST_STATE_PLAYING) ==
        GST_STATE_CHANGE_FAILURE);
  }
  bench_clear (&b);
}

GST_END_TEST;

static Suite *
triangulate_suite (void)
{
  Suite *s = suite_create ("triangulate");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_add_test (tc, test_three_views);
  tcase_add_test (tc, test_two_views);
  tcase_add_test (tc, test_unseen);
  tcase_add_test (tc, test_nothing_seen);
  tcase_add_test (tc, test_no_detector);
  tcase_add_test (tc, test_one_detector);
  tcase_add_test (tc, test_cameras_do_not_fit);
  tcase_add_test (tc, test_missing_camera);
  tcase_add_test (tc, test_offset);
  tcase_add_test (tc, test_names_in_metadata);
  tcase_add_test (tc, test_names_of_pads);
  tcase_add_test (tc, test_observations);
  tcase_add_test (tc, test_slipped_camera);
  tcase_add_test (tc, test_contradictory_corners);
  tcase_add_test (tc, test_error_floor);
  tcase_add_test (tc, test_bad_quads);
  tcase_add_test (tc, test_wild_quads);
  tcase_add_test (tc, test_no_calibration);
  tcase_add_test (tc, test_one_camera);
  tcase_add_test (tc, test_wrong_camera_count);
  tcase_add_test (tc, test_unknown_camera);
  tcase_add_test (tc, test_wrong_size);
  tcase_add_test (tc, test_wrong_board);
  tcase_add_test (tc, test_changes);
  tcase_add_test (tc, test_other_pattern);
  tcase_add_test (tc, test_live);
  tcase_add_test (tc, test_rates_differ);
  tcase_add_test (tc, test_late_camera_of_other_rate);
  tcase_add_test (tc, test_capture_time);
  tcase_add_test (tc, test_flush_and_restart);
  return s;
}

GST_CHECK_MAIN (triangulate);
