/* Saddles and quads: payloads, their metas, copies, changes of size, misuse.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/video/video.h>
#include <gst/cloth/cloth.h>
#include <math.h>

#include "tests/core/refused.h"

static const GstClothSaddle two_saddles[2] = {
  {10.25f, 20.5f, 900, 0.5f, 0.01f, -0.002f, 0.02f},
  {-0.5f, 99.5f, 400, 2.0f, 0.04f, 0.001f, 0.05f}
};

static const GstClothCandidate one_candidate[1] = { {10, 21, 850} };

static GstClothQuad
some_quad (void)
{
  GstClothQuad quad = {.column = 3,.row = 2,.state = GST_CLOTH_QUAD_PREDICTED,
    .black = TRUE,.confidence = 0.75f
  };

  for (gint c = 0; c < 4; c++) {
    quad.x[c] = 100.0f + c;
    quad.y[c] = 50.0f - c;
    quad.cov_xx[c] = 0.1f;
    quad.cov_xy[c] = 0.05f;
    quad.cov_yy[c] = 0.2f;
  }
  return quad;
}

static GstClothSaddles *
some_saddles (void)
{
  return gst_cloth_saddles_new ("cam0", 42, two_saddles, 2, one_candidate, 1);
}

static void
test_payload (void)
{
  GstClothSaddle source[2] = { two_saddles[0], two_saddles[1] };
  GstClothSaddle got;
  GstClothCandidate candidate;
  const GstClothSaddle *refined;
  guint n;
  g_autoptr (GstClothSaddles) saddles =
      gst_cloth_saddles_new ("cam0", G_MAXUINT64, source, 2, one_candidate, 1);

  memset (source, 0, sizeof source);
  refined = gst_cloth_saddles_get_refined (saddles, &n);
  g_assert_cmpuint (n, ==, 2);
  g_assert_cmpmem (refined, 2 * sizeof *refined, two_saddles,
      sizeof two_saddles);
  g_assert_cmpmem (gst_cloth_saddles_get_candidates (saddles, &n),
      sizeof one_candidate, one_candidate, sizeof one_candidate);
  g_assert_cmpuint (n, ==, 1);
  g_assert_cmpstr (gst_cloth_saddles_get_camera (saddles), ==, "cam0");
  g_assert_cmpuint (gst_cloth_saddles_get_sequence (saddles), ==, G_MAXUINT64);
  g_assert_true (gst_cloth_saddles_get_saddle (saddles, 1, &got));
  g_assert_cmpfloat (got.y, ==, 99.5f);
  g_assert_false (gst_cloth_saddles_get_saddle (saddles, 2, &got));
  g_assert_true (gst_cloth_saddles_get_candidate (saddles, 0, &candidate));
  g_assert_false (gst_cloth_saddles_get_candidate (saddles, 1, &candidate));
}

static void
test_empty (void)
{
  g_autoptr (GstClothSaddles) saddles =
      gst_cloth_saddles_new (NULL, 0, NULL, 0, NULL, 0);
  g_autoptr (GstClothQuads) quads = gst_cloth_quads_new (NULL, 0, 8, 8, NULL,
      0);
  GstClothQuad quad;

  g_assert_cmpstr (gst_cloth_saddles_get_camera (saddles), ==, "");
  g_assert_cmpuint (gst_cloth_saddles_get_n_refined (saddles), ==, 0);
  g_assert_cmpuint (gst_cloth_saddles_get_n_candidates (saddles), ==, 0);
  g_assert_cmpuint (gst_cloth_quads_get_n_quads (quads), ==, 0);
  g_assert_cmpuint (gst_cloth_quads_get_columns (quads), ==, 8);
  g_assert_false (gst_cloth_quads_get_quad (quads, 0, &quad));
}

static void
test_points (void)
{
  GstClothQuad quad = some_quad ();
  GstClothSaddles *saddles = some_saddles ();
  g_autoptr (GstClothQuads) quads = gst_cloth_quads_new ("c", 1, 8, 8, &quad,
      1);
  g_autoptr (GBytes) points = gst_cloth_saddles_get_points (saddles);
  g_autoptr (GBytes) corners = gst_cloth_quads_get_points (quads);
  const gfloat *corner = g_bytes_get_data (corners, NULL);
  gsize size;

  /* The bytes outlive the last reference that we hold. */
  gst_cloth_saddles_unref (saddles);
  g_assert_cmpmem (g_bytes_get_data (points, &size), size, two_saddles,
      sizeof two_saddles);
  g_assert_cmpuint (g_bytes_get_size (corners), ==, 8 * sizeof (gfloat));
  for (gint c = 0; c < 4; c++) {
    g_assert_cmpfloat (corner[2 * c], ==, quad.x[c]);
    g_assert_cmpfloat (corner[2 * c + 1], ==, quad.y[c]);
  }
}

/* A copied buffer shares the payload, which outlives the first buffer. */
static void
test_copy_is_reference (void)
{
  GstClothQuad quad = some_quad ();
  GstClothSaddles *saddles = some_saddles ();
  GstBuffer *buffer = gst_buffer_new ();
  GstBuffer *copy;

  g_assert_null (gst_buffer_get_cloth_saddles (buffer));
  g_assert_null (gst_buffer_get_cloth_quads (buffer));
  gst_buffer_add_cloth_saddles_meta (buffer, saddles);
  gst_buffer_add_cloth_quads_meta (buffer, gst_cloth_quads_new ("cam0", 42, 8,
          6, &quad, 1));
  copy = gst_buffer_copy (buffer);
  g_assert_true (gst_buffer_get_cloth_saddles (copy) == saddles);
  g_assert_true (gst_buffer_get_cloth_quads (copy) ==
      gst_buffer_get_cloth_quads (buffer));
  gst_buffer_unref (buffer);
  g_assert_cmpuint (gst_cloth_saddles_get_sequence (saddles), ==, 42);
  g_assert_cmpuint (gst_cloth_quads_get_rows (gst_buffer_get_cloth_quads
          (copy)), ==, 6);
  gst_buffer_unref (copy);
}

/* Metas put on by GStreamer's own function have no payload yet. */
static void
test_bare (void)
{
  GstBuffer *buffer = gst_buffer_new ();
  GstBuffer *copy;

  gst_buffer_add_meta (buffer, gst_cloth_saddles_meta_get_info (), NULL);
  gst_buffer_add_meta (buffer, gst_cloth_quads_meta_get_info (), NULL);
  copy = gst_buffer_copy (buffer);
  g_assert_null (gst_buffer_get_cloth_saddles (copy));
  g_assert_null (gst_buffer_get_cloth_quads (copy));
  gst_buffer_unref (buffer);
  gst_buffer_unref (copy);
}

static void
test_adding_replaces (void)
{
  GstBuffer *buffer = gst_buffer_new ();
  GstClothSaddles *second = gst_cloth_saddles_new ("cam1", 2, NULL, 0, NULL, 0);

  gst_buffer_add_cloth_saddles_meta (buffer, some_saddles ());
  gst_buffer_add_cloth_saddles_meta (buffer, second);
  g_assert_true (gst_buffer_get_cloth_saddles (buffer) == second);
  g_assert_cmpuint (gst_buffer_get_n_meta (buffer,
          gst_cloth_saddles_meta_api_get_type ()), ==, 1);
  gst_buffer_unref (buffer);
}

static gpointer
ref_and_unref (gpointer saddles)
{
  for (guint i = 0; i < 100000; i++)
    gst_cloth_saddles_unref (gst_cloth_saddles_ref (saddles));
  return NULL;
}

static void
test_references_across_threads (void)
{
  g_autoptr (GstClothSaddles) saddles = some_saddles ();
  GThread *threads[4];

  for (guint i = 0; i < G_N_ELEMENTS (threads); i++)
    threads[i] = g_thread_new ("ref", ref_and_unref, saddles);
  for (guint i = 0; i < G_N_ELEMENTS (threads); i++)
    g_thread_join (threads[i]);
  g_assert_cmpuint (gst_cloth_saddles_get_sequence (saddles), ==, 42);
}

/* The axis of the largest curvature of [hxx, hxy; hxy, hyy] by looking everywhere. */
static gdouble
search_axis (gdouble hxx, gdouble hxy, gdouble hyy)
{
  gdouble best = -INFINITY, axis = 0;

  for (guint i = 0; i < 200000; i++) {
    gdouble a = G_PI * i / 200000, c = cos (a), s = sin (a);
    gdouble curvature = hxx * c * c + 2 * hxy * c * s + hyy * s * s;

    if (curvature > best) {
      best = curvature;
      axis = a;
    }
  }
  return axis;
}

static void
test_scale_saddles (void)
{
  const gdouble sx = 0.5, sy = 3;
  g_autoptr (GstClothSaddles) saddles = some_saddles ();
  g_autoptr (GstClothSaddles) scaled = gst_cloth_saddles_scale (saddles, sx,
      sy);
  const GstClothSaddle *to = gst_cloth_saddles_get_refined (scaled, NULL);
  GstClothCandidate candidate;

  g_assert_cmpstr (gst_cloth_saddles_get_camera (scaled), ==, "cam0");
  g_assert_cmpuint (gst_cloth_saddles_get_sequence (scaled), ==, 42);
  for (guint i = 0; i < 2; i++) {
    const GstClothSaddle *from = &two_saddles[i];
    gdouble h = sqrt (from->response), axis;
    gdouble hxx = h * cos (2 * from->axis) / (sx * sx);
    gdouble hxy = h * sin (2 * from->axis) / (sx * sy);
    gdouble hyy = -h * cos (2 * from->axis) / (sy * sy);

    axis = search_axis (hxx, hxy, hyy);
    g_test_message ("axis %g became %g, by search %g", from->axis, to[i].axis,
        axis);
    g_assert_cmpfloat_with_epsilon (to[i].axis, axis, 1e-4);
    g_assert_cmpfloat_with_epsilon (to[i].response, hxy * hxy - hxx * hyy,
        1e-3 * from->response);
    g_assert_cmpfloat_with_epsilon (to[i].cov_xx, 0.25 * from->cov_xx, 1e-7);
    g_assert_cmpfloat_with_epsilon (to[i].cov_xy, 1.5 * from->cov_xy, 1e-7);
    g_assert_cmpfloat_with_epsilon (to[i].cov_yy, 9 * from->cov_yy, 1e-7);
  }
  g_assert_cmpfloat (to[0].x, ==, 4.875f);
  g_assert_cmpfloat (to[0].y, ==, 62.5f);
  /* The left edge of the picture and the lower one, 100 rows down, stay edges. */
  g_assert_cmpfloat (to[1].x, ==, -0.5f);
  g_assert_cmpfloat (to[1].y, ==, 299.5f);
  g_assert_true (gst_cloth_saddles_get_candidate (scaled, 0, &candidate));
  g_assert_cmpfloat (candidate.x, ==, 4.75f);
  g_assert_cmpfloat (candidate.y, ==, 64);
}

static void
test_scale_quads (void)
{
  GstClothQuad quad = some_quad (), got;
  g_autoptr (GstClothQuads) quads = gst_cloth_quads_new ("cam0", 7, 8, 6, &quad,
      1);
  g_autoptr (GstClothQuads) scaled = gst_cloth_quads_scale (quads, 2, 0.5);

  g_assert_true (gst_cloth_quads_get_quad (scaled, 0, &got));
  g_assert_cmpint (got.column, ==, 3);
  g_assert_cmpint (got.row, ==, 2);
  g_assert_cmpint (got.state, ==, GST_CLOTH_QUAD_PREDICTED);
  g_assert_true (got.black);
  g_assert_cmpfloat (got.confidence, ==, 0.75f);
  for (gint c = 0; c < 4; c++) {
    g_assert_cmpfloat (got.x[c], ==, 200.5f + 2 * c);
    g_assert_cmpfloat (got.y[c], ==, 24.75f - 0.5f * c);
    g_assert_cmpfloat_with_epsilon (got.cov_xx[c], 0.4, 1e-7);
    g_assert_cmpfloat_with_epsilon (got.cov_xy[c], 0.05, 1e-7);
    g_assert_cmpfloat_with_epsilon (got.cov_yy[c], 0.05, 1e-7);
  }
}

/* What an element does that hands metas on: it asks each for its transformation. */
static gboolean
transform (GstBuffer * from, GstBuffer * to, GQuark type, gpointer data)
{
  gpointer state = NULL;
  gboolean all = TRUE;
  GstMeta *meta;

  while ((meta = gst_buffer_iterate_meta (from, &state)))
    all &= meta->info->transform_func (to, meta, from, type, data);
  return all;
}

static void
test_transforms (void)
{
  GstClothQuad quad = some_quad ();
  GstBuffer *buffer = gst_buffer_new (), *small = gst_buffer_new ();
  GstBuffer *other = gst_buffer_new ();
  GstVideoInfo in, out;
  GstVideoMetaTransform scale = { &in, &out };
  GstClothSaddle got;

  gst_buffer_add_cloth_saddles_meta (buffer, some_saddles ());
  gst_buffer_add_cloth_quads_meta (buffer, gst_cloth_quads_new ("cam0", 42, 8,
          6, &quad, 1));
  gst_video_info_set_format (&in, GST_VIDEO_FORMAT_GRAY8, 640, 480);
  gst_video_info_set_format (&out, GST_VIDEO_FORMAT_I420, 320, 240);

  g_assert_true (transform (buffer, small,
          gst_video_meta_transform_scale_get_quark (), &scale));
  g_assert_true (gst_cloth_saddles_get_saddle (gst_buffer_get_cloth_saddles
          (small), 0, &got));
  g_assert_cmpfloat (got.x, ==, (10.25f + 0.5f) / 2 - 0.5f);
  g_assert_cmpfloat (got.axis, ==, two_saddles[0].axis);

  g_assert_false (transform (buffer, other,
          g_quark_from_static_string ("a-transform-that-nobody-knows"), NULL));
  g_assert_null (gst_buffer_get_cloth_saddles (other));
  g_assert_null (gst_buffer_get_cloth_quads (other));
  gst_buffer_unref (buffer);
  gst_buffer_unref (small);
  gst_buffer_unref (other);
}

/* Where the shape changes there are borders, or none: nobody knows where places are then. */
static void
test_shapes (void)
{
  static const struct
  {
    gint par_n, par_d, width, height, to_n, to_d;
    gboolean kept;
  } cases[] = {
    {1, 1, 320, 240, 1, 1, TRUE},
    {1, 1, 320, 320, 1, 1, FALSE},
    {1, 1, 320, 320, 4, 3, TRUE},
    {1, 1, 1280, 720, 1, 1, FALSE},
    /* 213.3 × 160, rounded */
    {1, 1, 213, 160, 1, 1, TRUE},
    {1, 1, 214, 160, 1, 1, TRUE},
    {1, 1, 212, 160, 1, 1, FALSE},
    {1, 1, 215, 160, 1, 1, FALSE},
    {1, 1, 1, 1, 1, 1, TRUE},
    {12, 11, 320, 240, 1, 1, FALSE},
    {12, 11, 320, 240, 12, 11, TRUE},
    {12, 11, 640, 440, 1, 1, TRUE},
    {12, 11, 440, 640, 1, 1, FALSE},
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    g_autoptr (GstBuffer) buffer = gst_buffer_new ();
    g_autoptr (GstBuffer) scaled = gst_buffer_new ();
    GstVideoInfo in, out;
    GstVideoMetaTransform scale = { &in, &out };

    gst_buffer_add_cloth_saddles_meta (buffer, some_saddles ());
    gst_video_info_set_format (&in, GST_VIDEO_FORMAT_GRAY8, 640, 480);
    in.par_n = cases[i].par_n;
    in.par_d = cases[i].par_d;
    gst_video_info_set_format (&out, GST_VIDEO_FORMAT_GRAY8,
        (guint) cases[i].width, (guint) cases[i].height);
    out.par_n = cases[i].to_n;
    out.par_d = cases[i].to_d;
    g_assert_cmpint (transform (buffer, scaled,
            gst_video_meta_transform_scale_get_quark (), &scale), ==,
        cases[i].kept);
    g_assert_true ((gst_buffer_get_cloth_saddles (scaled) != NULL) ==
        cases[i].kept);
  }
}

static void
test_tags (void)
{
  const GType apis[] = { gst_cloth_saddles_meta_api_get_type (),
    gst_cloth_quads_meta_api_get_type ()
  };

  for (guint i = 0; i < G_N_ELEMENTS (apis); i++) {
    g_assert_true (gst_meta_api_type_has_tag (apis[i],
            g_quark_from_string (GST_META_TAG_VIDEO_STR)));
    g_assert_true (gst_meta_api_type_has_tag (apis[i],
            g_quark_from_string (GST_META_TAG_VIDEO_ORIENTATION_STR)));
    g_assert_true (gst_meta_api_type_has_tag (apis[i],
            g_quark_from_string (GST_META_TAG_VIDEO_SIZE_STR)));
  }
}

static void
test_misuse (void)
{
  g_autofree gchar *long_name = g_strnfill (GST_CLOTH_MAX_CAMERA_NAME + 1, 'a');
  g_autofree gchar *longest = g_strnfill (GST_CLOTH_MAX_CAMERA_NAME, 'a');
  g_autofree GstClothSaddle *many = g_new0 (GstClothSaddle,
      GST_CLOTH_MAX_FEATURES + 1);
  g_autoptr (GstClothSaddles) most = gst_cloth_saddles_new (longest, 0, many,
      GST_CLOTH_MAX_FEATURES, NULL, 0);
  GstBuffer *buffer = gst_buffer_new ();

  g_assert_nonnull (most);
  ASSERT_MISUSE (gst_cloth_saddles_new ("c", 0, many,
          GST_CLOTH_MAX_FEATURES + 1, NULL, 0));
  ASSERT_MISUSE (gst_cloth_saddles_new ("c", 0, NULL, 1, NULL, 0));
  ASSERT_MISUSE (gst_cloth_saddles_new ("c", 0, NULL, 0, NULL, 1));
  ASSERT_MISUSE (gst_cloth_saddles_new (long_name, 0, NULL, 0, NULL, 0));
  ASSERT_MISUSE (gst_cloth_saddles_new ("\xff", 0, NULL, 0, NULL, 0));
  ASSERT_MISUSE (gst_cloth_quads_new ("c", 0, 1, 1, NULL, 1));
  ASSERT_MISUSE (gst_cloth_quads_new ("c", 0, G_MAXUINT, 1, NULL, 0));
  ASSERT_MISUSE (gst_cloth_quads_new ("\xc3", 0, 1, 1, NULL, 0));
  ASSERT_MISUSE (gst_cloth_saddles_scale (most, 0, 1));
  ASSERT_MISUSE (gst_cloth_saddles_scale (most, 1, NAN));
  ASSERT_MISUSE (gst_buffer_add_cloth_saddles_meta (buffer, NULL));
  gst_buffer_ref (buffer);
  ASSERT_MISUSE (gst_buffer_add_cloth_saddles_meta (buffer, most));
  gst_buffer_unref (buffer);
  gst_buffer_unref (buffer);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  gst_init (&argc, &argv);
  g_test_add_func ("/cloth/saddles/payload", test_payload);
  g_test_add_func ("/cloth/saddles/empty", test_empty);
  g_test_add_func ("/cloth/saddles/points", test_points);
  g_test_add_func ("/cloth/saddles/copy-is-reference", test_copy_is_reference);
  g_test_add_func ("/cloth/saddles/bare", test_bare);
  g_test_add_func ("/cloth/saddles/adding-replaces", test_adding_replaces);
  g_test_add_func ("/cloth/saddles/threads", test_references_across_threads);
  g_test_add_func ("/cloth/saddles/scale", test_scale_saddles);
  g_test_add_func ("/cloth/quads/scale", test_scale_quads);
  g_test_add_func ("/cloth/saddles/transforms", test_transforms);
  g_test_add_func ("/cloth/saddles/shapes", test_shapes);
  g_test_add_func ("/cloth/saddles/tags", test_tags);
  g_test_add_func ("/cloth/saddles/misuse", test_misuse);
  return g_test_run ();
}
