/* Fuzz target: pictures and meshes with metadata that nobody should attach, through the
 * elements that read them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "fuzzelements.h"

#include <math.h>
#include <string.h>

#define WIDTH 64
#define HEIGHT 48
#define VIDEO "video/x-raw,format=I420,width=64,height=48,framerate=25/1"
#define PERIOD (40 * GST_MSECOND)
#define MAX_FRAMES 4

static gint
take_index (FuzzBytes * bytes)
{
  static const gint wild[] = { -1, G_MININT, G_MAXINT, 65535, 65536, 1 << 24 };
  guint8 kind = fuzz_take_byte (bytes);

  return kind < G_N_ELEMENTS (wild) ? wild[kind] : kind % 8;
}

/* Squares of a board across or down: more than the library's limit nobody can attach. */
static guint
take_count (FuzzBytes * bytes)
{
  guint8 kind = fuzz_take_byte (bytes);

  return kind == 0 ? 65536 : kind % 8;
}

static void
add_saddles (GstBuffer * buffer, FuzzBytes * bytes)
{
  GstClothSaddle saddles[32];
  GstClothCandidate candidates[32];
  guint n = fuzz_take_byte (bytes) % 33, n_candidates =
      fuzz_take_byte (bytes) % 33;

  for (guint i = 0; i < n; i++) {
    GstClothSaddle *s = &saddles[i];

    s->x = fuzz_take_place (bytes, WIDTH);
    s->y = fuzz_take_place (bytes, HEIGHT);
    s->response = fuzz_take_place (bytes, 1);
    s->axis = fuzz_take_place (bytes, (gfloat) G_PI);
    s->cov_xx = fuzz_take_place (bytes, 1);
    s->cov_xy = fuzz_take_place (bytes, 1);
    s->cov_yy = fuzz_take_place (bytes, 1);
  }
  for (guint i = 0; i < n_candidates; i++) {
    candidates[i].x = fuzz_take_place (bytes, WIDTH);
    candidates[i].y = fuzz_take_place (bytes, HEIGHT);
    candidates[i].response = fuzz_take_place (bytes, 1);
  }
  gst_buffer_add_cloth_saddles_meta (buffer, gst_cloth_saddles_new (NULL,
          fuzz_take_byte (bytes), saddles, n, candidates, n_candidates));
}

static void
add_quads (GstBuffer * buffer, FuzzBytes * bytes)
{
  GstClothQuad quads[32];
  guint n = fuzz_take_byte (bytes) % 33;
  guint columns = take_count (bytes), rows = take_count (bytes);

  for (guint i = 0; i < n; i++) {
    GstClothQuad *q = &quads[i];

    q->column = take_index (bytes);
    q->row = take_index (bytes);
    q->state = (GstClothQuadState) (take_index (bytes) % 4);
    q->black = fuzz_take_byte (bytes) % 2;
    q->confidence = fuzz_take_place (bytes, 1);
    for (guint c = 0; c < 4; c++) {
      q->x[c] = fuzz_take_place (bytes, WIDTH);
      q->y[c] = fuzz_take_place (bytes, HEIGHT);
      q->cov_xx[c] = q->cov_yy[c] = fuzz_take_place (bytes, 1);
      q->cov_xy[c] = 0;
    }
  }
  gst_buffer_add_cloth_quads_meta (buffer, gst_cloth_quads_new ("cam0",
          fuzz_take_byte (bytes), columns, rows, quads, n));
}

static void
add_dots (GstBuffer * buffer, FuzzBytes * bytes)
{
  GstClothDot dots[32];
  guint n = fuzz_take_byte (bytes) % 33;
  guint columns = take_count (bytes), rows = take_count (bytes);

  for (guint i = 0; i < n; i++) {
    GstClothDot *d = &dots[i];

    memset (d, 0, sizeof *d);
    d->column = take_index (bytes);
    d->row = take_index (bytes);
    d->mirrored = fuzz_take_byte (bytes) % 2;
    d->touches = fuzz_take_byte (bytes) % 2;
    d->confidence = fuzz_take_place (bytes, 1);
    d->x = fuzz_take_place (bytes, WIDTH);
    d->y = fuzz_take_place (bytes, HEIGHT);
    d->cov_xx = d->cov_yy = fuzz_take_place (bytes, 1);
    for (guint c = 0; c < GST_CLOTH_DOT_MAX_COLOURS; c++)
      d->log_likelihood[c] = -(gfloat) c;
    d->log_likelihood[0] = fuzz_take_place (bytes, 1);
  }
  gst_buffer_add_cloth_dots_meta (buffer, gst_cloth_dots_new ("cam1",
          fuzz_take_byte (bytes), columns, rows,
          fuzz_take_byte (bytes) % (GST_CLOTH_DOT_MAX_COLOURS + 1), dots, n));
}

static void
add_matches (GstBuffer * buffer, FuzzBytes * bytes)
{
  GstClothMatch matches[32];
  GstClothGridPoint points[32];
  guint n = fuzz_take_byte (bytes) % 33, n_points = fuzz_take_byte (bytes) % 33;
  guint columns = take_count (bytes), rows = take_count (bytes);

  for (guint i = 0; i < n; i++) {
    GstClothMatch *m = &matches[i];
    guint8 flags = fuzz_take_byte (bytes);

    m->x = fuzz_take_place (bytes, WIDTH);
    m->y = fuzz_take_place (bytes, HEIGHT);
    m->u = fuzz_take_place (bytes, 1);
    m->v = fuzz_take_place (bytes, 1);
    m->scale = fuzz_take_place (bytes, 8);
    m->distance = fuzz_take_place (bytes, 300);
    m->group = (guint) take_index (bytes);
    m->oblique = flags & 1;
    m->mirrored = flags & 2;
    m->verified = flags & 4;
  }
  for (guint i = 0; i < n_points; i++) {
    GstClothGridPoint *p = &points[i];

    p->column = take_index (bytes);
    p->row = take_index (bytes);
    p->mirrored = fuzz_take_byte (bytes) % 2;
    p->x = fuzz_take_place (bytes, WIDTH);
    p->y = fuzz_take_place (bytes, HEIGHT);
    p->cov_xx = p->cov_yy = fuzz_take_place (bytes, 1);
    p->cov_xy = fuzz_take_place (bytes, 1);
  }
  gst_buffer_add_cloth_matches_meta (buffer, gst_cloth_matches_new ("cam0",
          fuzz_take_byte (bytes), columns, rows, n, FALSE, matches, n, points,
          n_points));
}

static void
add_metas (GstBuffer * buffer, FuzzBytes * bytes)
{
  guint which = fuzz_take_byte (bytes);

  if (which & 1)
    add_saddles (buffer, bytes);
  if (which & 2)
    add_quads (buffer, bytes);
  if (which & 4)
    add_dots (buffer, bytes);
  if (which & 8)
    add_matches (buffer, bytes);
}

static GstBuffer *
make_picture (guint frame, FuzzBytes * bytes)
{
  gsize size = WIDTH * HEIGHT * 3 / 2;
  GstBuffer *buffer = gst_buffer_new_allocate (NULL, size, NULL);
  GstMapInfo map;

  /* Squares of 8 pixels. */
  g_assert_true (gst_buffer_map (buffer, &map, GST_MAP_WRITE));
  memset (map.data, 128, size);
  for (guint i = 0; i < WIDTH * HEIGHT; i++)
    map.data[i] = (i % WIDTH / 8 + i / WIDTH / 8) % 2 ? 220 : 30;
  gst_buffer_unmap (buffer, &map);
  GST_BUFFER_PTS (buffer) = frame * PERIOD;
  GST_BUFFER_DURATION (buffer) = PERIOD;
  add_metas (buffer, bytes);
  return buffer;
}

static void
feed_pictures (const gchar * line, FuzzBytes * bytes)
{
  GstHarness *h = gst_harness_new_parse (line);

  gst_harness_set_src_caps_str (h, VIDEO);
  for (guint f = 0; f < MAX_FRAMES && bytes->size > 0; f++)
    g_assert_cmpint (gst_harness_push (h, make_picture (f, bytes)), ==,
        GST_FLOW_OK);
  gst_harness_teardown (h);
}

static void
feed_triangulate (FuzzBytes * bytes)
{
  GstHarness *in[2], *src = fuzz_triangulate_new (2, in);
  GstBuffer *out;

  for (guint f = 0; f < MAX_FRAMES && bytes->size > 0; f++)
    for (guint i = 0; i < 2; i++) {
      GstBuffer *buffer = gst_buffer_new ();

      GST_BUFFER_PTS (buffer) = f * PERIOD;
      GST_BUFFER_DURATION (buffer) = PERIOD;
      add_metas (buffer, bytes);
      g_assert_cmpint (gst_harness_push (in[i], buffer), ==, GST_FLOW_OK);
    }
  for (guint i = 0; i < 2; i++)
    gst_harness_push_event (in[i], gst_event_new_eos ());
  while (gst_harness_pull_until_eos (src, &out) && out) {
    g_autoptr (GstClothMesh) mesh = gst_cloth_mesh_from_buffer (out, NULL);

    g_assert_nonnull (mesh);
    gst_buffer_unref (out);
  }
  fuzz_triangulate_free (src, 2, in);
}

static void
feed_meshes (FuzzBytes * bytes)
{
  enum
  { N = FUZZ_COLUMNS * FUZZ_ROWS };
  g_autoptr (GstClothTopology) topology =
      gst_cloth_topology_new_grid (FUZZ_COLUMNS, FUZZ_ROWS, 0.3f, 0.2f, NULL);
  GstHarness *h = gst_harness_new ("meshfill");
  GstBuffer *out;

  gst_harness_set_src_caps (h, gst_cloth_topology_to_caps (topology, 25, 1));
  for (guint f = 0; f < MAX_FRAMES && bytes->size > 0; f++) {
    gfloat positions[3 * N], covariances[6 * N];
    guint8 states[N];
    gboolean sure = fuzz_take_byte (bytes) % 2;
    GstBuffer *buffer;

    for (guint i = 0; i < N; i++) {
      states[i] = fuzz_take_byte (bytes) % 5;
      for (guint k = 0; k < 3; k++)
        positions[3 * i + k] = fuzz_take_place (bytes, 1);
      for (guint k = 0; k < 6 && sure; k++)
        covariances[6 * i + k] = fuzz_take_place (bytes, 1e-3f);
    }
    {
      g_autoptr (GstClothMesh) mesh = gst_cloth_mesh_new (f, N, positions,
          states, sure ? covariances : NULL);

      buffer = gst_cloth_mesh_to_buffer (mesh);
    }
    GST_BUFFER_PTS (buffer) = f * PERIOD;
    GST_BUFFER_DURATION (buffer) = PERIOD;
    gst_harness_push (h, buffer);
  }
  gst_harness_push_event (h, gst_event_new_eos ());
  while ((out = gst_harness_try_pull (h))) {
    g_autoptr (GstClothMesh) mesh = gst_cloth_mesh_from_buffer (out, NULL);

    g_assert_nonnull (mesh);
    gst_buffer_unref (out);
  }
  gst_harness_teardown (h);
}

int
LLVMFuzzerTestOneInput (const guint8 * data, gsize size)
{
  FuzzBytes bytes = { data, size };

  fuzz_elements_init ();
  switch (fuzz_take_byte (&bytes) % 6) {
    case 0:
      feed_pictures ("clothoverlay draw-saddles=true draw-indices=true "
          "ellipse-scale=10", &bytes);
      break;
    case 1:
      feed_pictures ("quadtrack columns=6 rows=4", &bytes);
      break;
    case 2:
      feed_pictures ("quadtrack columns=6 rows=4 link=false "
          "seed=16,16,24,16,24,24,16,24,2,2", &bytes);
      break;
    case 3:
      feed_triangulate (&bytes);
      break;
    case 5:
      feed_pictures ("clothjson", &bytes);
      break;
    default:
      feed_meshes (&bytes);
      break;
  }
  return 0;
}
