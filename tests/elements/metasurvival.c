/* Which stock elements keep the metas: the table of docs/metadata.md, row by row.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/check/gstcheck.h>
#include <gst/video/video.h>
#include <gst/cloth/cloth.h>

#define FRAMES 8
#define WIDTH 320
#define HEIGHT 240
#define IN_CAPS "video/x-raw,format=I420,width=320,height=240,framerate=25/1"

typedef struct
{
  const gchar *chain;
  const gchar *places;          /* kept, scaled or lost */
  const gchar *time;            /* kept or lost */
} Row;

static const Row rows[] = {
#include "tests/elements/metasurvival.inc"
};

typedef struct
{
  const gchar *chain;
  const gchar *gap;             /* kept or lost */
} GapRow;

static const GapRow gap_rows[] = {
#include "tests/elements/metasurvival-gap.inc"
};

static GstBuffer *
make_picture (guint number)
{
  const gfloat place = 10.25f + number;
  GstClothSaddle saddle = {.x = place,.y = 20.5f,.response = 9,.axis = 1,
    .cov_xx = 0.01f,.cov_yy = 0.04f
  };
  GstClothQuad quad = {.column = 1,.row = 1,.x = {place, 30, 30, place},.y =
      {20.5f, 20.5f, 40, 40}
  };
  GstClothDot dot = {.column = -1,.row = -1,.x = place,.y = 20.5f };
  GstClothRun run = {.row = 1,.begin = 2,.end = 5 };
  GstClothMatch match = {.x = place,.y = 20.5f,.u = 0.25f,.v = 0.5f,.scale = 2,
    .verified = TRUE
  };
  GstClothGridPoint point = {.column = 1,.row = 2,.x = place,.y = 20.5f,
    .cov_xx = 0.01f,.cov_yy = 0.04f
  };
  const gfloat ray[2] = { 0.5f, 0.25f }, disparity = place;
  const gdouble normal[3] = { 0, 0, 1 }, none[3] = { 0 };
  const gdouble turn[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  const guint8 measured = GST_CLOTH_DISPARITY_MEASURED;
  g_autoptr (GstClothStereo) stereo = gst_cloth_stereo_new (1, 1, ray, 2,
      normal, 1, turn, none, 2);
  GstBuffer *picture = gst_buffer_new_allocate (NULL, WIDTH * HEIGHT * 3 / 2,
      NULL);
  g_autoptr (GstCaps) clock = gst_caps_from_string ("timestamp/x-unix");

  gst_buffer_memset (picture, 0, (guint8) (90 + 10 * number), -1);
  gst_buffer_add_cloth_saddles_meta (picture, gst_cloth_saddles_new ("cam0",
          number, &saddle, 1, NULL, 0));
  gst_buffer_add_cloth_quads_meta (picture, gst_cloth_quads_new ("cam0", number,
          8, 8, &quad, 1));
  gst_buffer_add_cloth_dots_meta (picture, gst_cloth_dots_new ("cam0", number,
          8, 8, 5, &dot, 1));
  gst_buffer_add_cloth_silhouette_meta (picture,
      gst_cloth_silhouette_new ("cam0", number, WIDTH, HEIGHT, &run, 1));
  gst_buffer_add_cloth_matches_meta (picture, gst_cloth_matches_new ("cam0",
          number, 8, 8, 1, TRUE, &match, 1, &point, 1));
  gst_buffer_add_cloth_disparity_meta (picture, gst_cloth_disparity_new ("cam0",
          number, stereo, 0.5f, &disparity, 1, &measured, 1));
  gst_buffer_add_reference_timestamp_meta (picture, clock,
      GST_SECOND + number, GST_CLOCK_TIME_NONE);
  GST_BUFFER_PTS (picture) = gst_util_uint64_scale (number, GST_SECOND, 25);
  GST_BUFFER_DURATION (picture) = GST_SECOND / 25;
  return picture;
}

/* Silhouettes and disparities have a size of their own: they stay as they are. */
static gboolean
maps_are_kept (GstClothSilhouette * silhouette, GstClothDisparity * disparity,
    guint64 number)
{
  GstClothRun run;

  return gst_cloth_silhouette_get_sequence (silhouette) == number
      && gst_cloth_silhouette_get_width (silhouette) == WIDTH
      && gst_cloth_silhouette_get_run (silhouette, 0, &run) && run.end == 5
      && gst_cloth_disparity_get_sequence (disparity) == number
      && gst_cloth_disparity_get_width (disparity) == 1
      && gst_cloth_disparity_get_disparities (disparity, NULL)[0] ==
      10.25f + (gfloat) number;
}

/* What became of the places on @picture: kept, scaled to its size, lost, or wrong. */
static const gchar *
judge_places (GstBuffer * picture, const GstVideoInfo * info)
{
  GstClothSaddles *saddles = gst_buffer_get_cloth_saddles (picture);
  GstClothQuads *quads = gst_buffer_get_cloth_quads (picture);
  GstClothDots *dots = gst_buffer_get_cloth_dots (picture);
  GstClothSilhouette *silhouette = gst_buffer_get_cloth_silhouette (picture);
  GstClothMatches *matches = gst_buffer_get_cloth_matches (picture);
  GstClothDisparity *disparity = gst_buffer_get_cloth_disparity (picture);
  gfloat sx = (gfloat) GST_VIDEO_INFO_WIDTH (info) / WIDTH;
  gfloat sy = (gfloat) GST_VIDEO_INFO_HEIGHT (info) / HEIGHT;
  GstClothSaddle saddle;
  GstClothQuad quad;
  GstClothDot dot;
  GstClothMatch match;
  GstClothGridPoint point;
  gfloat x, most = sx == 1 && sy == 1 ? G_MINFLOAT : 1e-4f;

  if (!saddles && !quads && !dots && !silhouette && !matches && !disparity)
    return "lost";
  if (!saddles || !quads || !dots || !silhouette || !matches || !disparity
      || !gst_cloth_dots_get_dot (dots, 0, &dot)
      || !gst_cloth_matches_get_match (matches, 0, &match)
      || !gst_cloth_matches_get_point (matches, 0, &point)
      || !gst_cloth_saddles_get_saddle (saddles, 0, &saddle)
      || !gst_cloth_quads_get_quad (quads, 0, &quad)
      || g_strcmp0 (gst_cloth_saddles_get_camera (saddles), "cam0") != 0
      || gst_cloth_saddles_get_sequence (saddles) >= FRAMES
      || gst_cloth_quads_get_sequence (quads) !=
      gst_cloth_saddles_get_sequence (saddles)
      || gst_cloth_matches_get_sequence (matches) !=
      gst_cloth_saddles_get_sequence (saddles)
      || !maps_are_kept (silhouette, disparity,
          gst_cloth_saddles_get_sequence (saddles)))
    return "wrong";
  x = 10.25f + (gfloat) gst_cloth_saddles_get_sequence (saddles);
  if (!G_APPROX_VALUE (saddle.x, (x + 0.5f) * sx - 0.5f, most)
      || !G_APPROX_VALUE (saddle.y, 21 * sy - 0.5f, most)
      || !G_APPROX_VALUE (saddle.cov_xx, 0.01f * sx * sx, most)
      || !G_APPROX_VALUE (saddle.cov_yy, 0.04f * sy * sy, most)
      || !G_APPROX_VALUE (dot.x, saddle.x, most)
      || !G_APPROX_VALUE (dot.y, saddle.y, most)
      || !G_APPROX_VALUE (match.x, saddle.x, most)
      || !G_APPROX_VALUE (match.y, saddle.y, most) || match.u != 0.25f
      || !G_APPROX_VALUE (point.x, saddle.x, most)
      || !G_APPROX_VALUE (point.y, saddle.y, most)
      || !G_APPROX_VALUE (point.cov_xx, saddle.cov_xx, most)
      || !G_APPROX_VALUE (quad.x[3], (x + 0.5f) * sx - 0.5f, most)
      || !G_APPROX_VALUE (quad.y[2], 40.5f * sy - 0.5f, most))
    return "wrong";
  return sx == 1 && sy == 1 ? "kept" : "scaled";
}

static const gchar *
judge_time (GstBuffer * picture)
{
  GstReferenceTimestampMeta *time =
      gst_buffer_get_reference_timestamp_meta (picture, NULL);

  if (!time)
    return "lost";
  return time->timestamp >= GST_SECOND && time->timestamp < GST_SECOND + FRAMES
      ? "kept" : "wrong";
}

/* All pictures that come out must be judged alike. */
static void
agree (const gchar ** verdict, const gchar * next)
{
  if (*verdict == NULL || g_str_equal (*verdict, next))
    *verdict = next;
  else
    *verdict = "mixed";
}

#define MAX_VERDICTS 2

typedef GstBuffer *(*Make) (guint number);
typedef void (*Judge) (GstSample * sample, const gchar * verdicts[]);

/* Sends FRAMES of what @make makes through a chain; returns how many come out. */
static guint
run_chain (const gchar * chain, GstCaps * caps, Make make, Judge judge,
    const gchar * verdicts[MAX_VERDICTS])
{
  g_autofree gchar *line = g_strdup_printf ("appsrc name=source format=time "
      "! %s ! appsink name=sink sync=false", chain);
  g_autoptr (GError) error = NULL;
  g_autoptr (GstElement) pipeline = gst_parse_launch (line, &error);
  g_autoptr (GstElement) source = NULL;
  g_autoptr (GstElement) sink = NULL;
  const gchar *next[MAX_VERDICTS] = { NULL };
  guint seen = 0;
  GstFlowReturn flow;

  g_assert_no_error (error);
  source = gst_bin_get_by_name (GST_BIN (pipeline), "source");
  sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");
  g_object_set (source, "caps", caps, NULL);
  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  for (guint i = 0; i < FRAMES; i++) {
    GstBuffer *buffer = make (i);

    g_signal_emit_by_name (source, "push-buffer", buffer, &flow);
    gst_buffer_unref (buffer);
  }
  g_signal_emit_by_name (source, "end-of-stream", &flow);

  for (guint k = 0; k < MAX_VERDICTS; k++)
    verdicts[k] = NULL;
  while (TRUE) {
    g_autoptr (GstSample) sample = NULL;

    g_signal_emit_by_name (sink, "try-pull-sample", 30 * GST_SECOND, &sample);
    if (!sample)
      break;
    judge (sample, next);
    for (guint k = 0; k < MAX_VERDICTS && next[k]; k++)
      agree (&verdicts[k], next[k]);
    seen++;
  }
  gst_element_set_state (pipeline, GST_STATE_NULL);
  return seen;
}

/* Verdicts: on the places, on the time. */
static void
judge_picture (GstSample * sample, const gchar * verdicts[])
{
  GstBuffer *picture = gst_sample_get_buffer (sample);
  GstVideoInfo info;

  if (!gst_video_info_from_caps (&info, gst_sample_get_caps (sample)))
    gst_video_info_set_format (&info, GST_VIDEO_FORMAT_GRAY8, WIDTH, HEIGHT);
  verdicts[0] = judge_places (picture, &info);
  verdicts[1] = judge_time (picture);
}

GST_START_TEST (test_rows)
{
  g_autoptr (GstCaps) caps = gst_caps_from_string (IN_CAPS);
  guint wrong = 0;

  for (guint i = 0; i < G_N_ELEMENTS (rows); i++) {
    const gchar *is[MAX_VERDICTS];
    guint seen = run_chain (rows[i].chain, caps, make_picture, judge_picture,
        is);

    if (seen == 0 || g_strcmp0 (is[0], rows[i].places) != 0
        || g_strcmp0 (is[1], rows[i].time) != 0) {
      g_printerr ("%s: %u pictures, places %s, time %s; the table says %s, "
          "%s\n", rows[i].chain, seen, is[0], is[1], rows[i].places,
          rows[i].time);
      wrong++;
    }
  }
  fail_unless_equals_int (wrong, 0);
}

GST_END_TEST;

static GstBuffer *
make_mesh (guint number)
{
  const gfloat places[12] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0 };
  const guint8 states[4] = { 1, 1, 1, 1 };
  const gfloat uv[2] = { 0.5f, 0.25f };
  gfloat residuals[12] = { 0.001f * (gfloat) number };
  g_autoptr (GstClothMesh) mesh = gst_cloth_mesh_new (number, 4, places, states,
      NULL);
  GstBuffer *buffer = gst_cloth_mesh_to_buffer (mesh);

  gst_buffer_add_cloth_gap_meta (buffer, gst_cloth_gap_new (number, 4,
          residuals, NULL));
  gst_buffer_add_cloth_uv_meta (buffer, gst_cloth_uv_new ("cam0", number, 1, 1,
          uv, 2));
  gst_buffer_add_cloth_uv_meta (buffer, gst_cloth_uv_new ("cam1", number, 1, 1,
          uv, 2));
  gst_buffer_add_cloth_view_meta (buffer, gst_cloth_view_new ("cam0", number,
          gst_buffer_new ()));
  GST_BUFFER_PTS (buffer) = gst_util_uint64_scale (number, GST_SECOND, 25);
  GST_BUFFER_DURATION (buffer) = GST_SECOND / 25;
  return buffer;
}

/* The gap, the maps and the view must still be those of the mesh they lie on. */
static void
judge_gap (GstSample * sample, const gchar * verdicts[])
{
  GstBuffer *buffer = gst_sample_get_buffer (sample);
  GstClothGap *gap = gst_buffer_get_cloth_gap (buffer);
  GstClothUV *uvs[2] = { gst_buffer_get_nth_cloth_uv (buffer, 0),
    gst_buffer_get_cloth_uv (buffer, "cam1")
  };
  GstClothView *view = gst_buffer_get_cloth_view (buffer, "cam0");
  g_autoptr (GstClothMesh) mesh = gst_cloth_mesh_from_buffer (buffer, NULL);

  if (!mesh)
    verdicts[0] = "wrong";
  else if (!gap && !uvs[0] && !uvs[1] && !view)
    verdicts[0] = "lost";
  else if (!gap || !uvs[0] || !uvs[1] || uvs[0] == uvs[1] || !view)
    verdicts[0] = "wrong";
  else
    verdicts[0] = gst_cloth_gap_get_sequence (gap) ==
        gst_cloth_mesh_get_sequence (mesh)
        && gst_cloth_uv_get_sequence (uvs[0]) ==
        gst_cloth_mesh_get_sequence (mesh)
        && gst_cloth_uv_get_sequence (uvs[1]) ==
        gst_cloth_mesh_get_sequence (mesh)
        && gst_cloth_view_get_sequence (view) ==
        gst_cloth_mesh_get_sequence (mesh)
        && gst_cloth_gap_get_residuals (gap, NULL)[0] ==
        0.001f * (gfloat) gst_cloth_mesh_get_sequence (mesh) ? "kept" : "wrong";
}

GST_START_TEST (test_gap_rows)
{
  g_autoptr (GstClothTopology) topology =
      gst_cloth_topology_new_grid (2, 2, 1, 1, NULL);
  g_autoptr (GstCaps) caps = gst_cloth_topology_to_caps (topology, 25, 1);
  guint wrong = 0;

  for (guint i = 0; i < G_N_ELEMENTS (gap_rows); i++) {
    const gchar *is[MAX_VERDICTS];
    guint seen = run_chain (gap_rows[i].chain, caps, make_mesh, judge_gap, is);

    if (seen != FRAMES || g_strcmp0 (is[0], gap_rows[i].gap) != 0) {
      g_printerr ("%s: %u meshes, gap %s; the table says %s\n",
          gap_rows[i].chain, seen, is[0], gap_rows[i].gap);
      wrong++;
    }
  }
  fail_unless_equals_int (wrong, 0);
}

GST_END_TEST;

/* The page has exactly these rows, in this order. */
GST_START_TEST (test_page)
{
  g_autoptr (GString) table =
      g_string_new ("| chain | of a picture | capture "
      "time |\n|---|---|---|\n");
  g_autoptr (GString) gaps =
      g_string_new ("| chain | gap, maps, views |\n|---|---|\n");
  g_autofree gchar *text = NULL;
  g_autoptr (GError) error = NULL;

  for (guint i = 0; i < G_N_ELEMENTS (rows); i++)
    g_string_append_printf (table, "| `%s` | %s | %s |\n", rows[i].chain,
        rows[i].places, rows[i].time);
  g_string_append (table, "\n");
  for (guint i = 0; i < G_N_ELEMENTS (gap_rows); i++)
    g_string_append_printf (gaps, "| `%s` | %s |\n", gap_rows[i].chain,
        gap_rows[i].gap);
  g_string_append (gaps, "\n");
  g_file_get_contents (TEST_DATA "/../../docs/metadata.md", &text, NULL,
      &error);
  g_assert_no_error (error);
  if (!strstr (text, table->str))
    g_printerr ("docs/metadata.md should have this table:\n%s", table->str);
  fail_unless (strstr (text, table->str) != NULL);
  if (!strstr (text, gaps->str))
    g_printerr ("docs/metadata.md should have this table:\n%s", gaps->str);
  fail_unless (strstr (text, gaps->str) != NULL);
}

GST_END_TEST;

static Suite *
metasurvival_suite (void)
{
  Suite *suite = suite_create ("metasurvival");
  TCase *chain = tcase_create ("general");

  suite_add_tcase (suite, chain);
  tcase_add_test (chain, test_rows);
  tcase_add_test (chain, test_gap_rows);
  tcase_add_test (chain, test_page);
  return suite;
}

GST_CHECK_MAIN (metasurvival);
