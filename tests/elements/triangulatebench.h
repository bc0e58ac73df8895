/* Synthetic cameras that see a board, a rig of them, and what triangulate makes of it. The
 * truth is the geometry that the cameras were given.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

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
#define MAX_CAMERAS 16
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
static inline void
truth (guint i, guint frame, gdouble X[3])
{
  gdouble u = (i % (COLUMNS + 1)) * SQUARE, v = (i / (COLUMNS + 1)) * SQUARE;

  X[0] = u - 0.12 + 0.01 * frame;
  X[1] = 0.03 * sin (12. * u + frame) + 0.02 * cos (9. * v);
  X[2] = 1.1 - v;
}

static inline void
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
static inline void
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
  /* The sheet's waves are drawn out by 6%, which exact cameras tell from noise. */
  g_object_set (b->element, "rig", b->rig_path, "pattern", b->pattern_path,
      "max-length", 1.2, NULL);
}

static inline void
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

static inline void
bench_init (Bench * b, guint n_cameras)
{
  bench_open (b, n_cameras);
  bench_link (b, n_cameras, FALSE, VIDEO);
}

static inline void
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
static inline void
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

static inline GstBuffer *
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

static inline void
push (Bench * b, guint pad, GstClothQuads * quads, guint frame)
{
  fail_unless_equals_int (gst_harness_push (b->in[pad], picture (quads, frame)),
      GST_FLOW_OK);
}

/* Camera i's picture to pad i: the first n squares. */
static inline void
push_seen (Bench * b, guint pad, guint camera, guint frame, guint n,
    const gchar * name)
{
  GstClothQuad quads[N_QUADS];

  see (b, camera, frame, quads);
  push (b, pad, gst_cloth_quads_new (name, frame, COLUMNS, ROWS, quads, MIN (n,
              N_QUADS)), frame);
}

static inline void
push_all (Bench * b, guint frame)
{
  guint i;

  for (i = 0; i < b->n_pads; i++) {
    push_seen (b, i, i, frame, ALL, NULL);
  }
}

static inline GstClothMesh *
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
static inline gdouble
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

static inline void
expect_all (Bench * b, guint frame, GstClothVertexState state)
{
  g_autoptr (GstClothMesh) mesh = pull (b, frame);

  /* places in px travel as floats: 3e-5 px */
  fail_unless (check_all (mesh, frame, state) < 1e-6);
}

static inline void
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
static inline void
expect_error (Bench * b, const gchar * text)
{
  expect_message (b, GST_MESSAGE_ERROR, text);
  fail_unless (gst_harness_try_pull (b->src) == NULL);
}
