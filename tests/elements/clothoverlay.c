/* clothoverlay: what is drawn lies where geometry says, and nothing else changes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/cloth/cloth.h>
#include <gst/video/video.h>
#include <glib/gstdio.h>
#include <math.h>

#define FILL 128

static const gchar *const formats[] = {
  "GRAY8", "I420", "YV12", "NV12", "NV21", "Y42B", "NV16", "NV61", "Y444",
  "NV24", "Y41B", "YUV9", "YVU9", "A420", "YUY2",
  "UYVY",
  "YVYU", "AYUV", "BGRx", "RGBx", "xBGR", "xRGB", "BGRA", "RGBA", "ABGR",
  "ARGB",
  "RGB", "BGR"
};

/* ---- pictures ---- */

/* A grey picture; with @padding every row is that many bytes longer than need be. */
static GstBuffer *
picture (const gchar * format, gint width, gint height, gint padding,
    GstVideoInfo * info)
{
  gsize offset[GST_VIDEO_MAX_PLANES] = { 0 }, size = 0;
  gint stride[GST_VIDEO_MAX_PLANES] = { 0 };
  GstBuffer *buffer;
  guint p;

  fail_unless (gst_video_info_set_format (info,
          gst_video_format_from_string (format), (guint) width,
          (guint) height));
  info->fps_n = 30;
  info->fps_d = 1;
  for (p = 0; p < GST_VIDEO_INFO_N_PLANES (info); p++) {
    gint comp[GST_VIDEO_MAX_COMPONENTS];

    gst_video_format_info_component (info->finfo, p, comp);
    stride[p] = GST_VIDEO_INFO_PLANE_STRIDE (info, p) + padding;
    offset[p] = size + (gsize) padding;
    size = offset[p] + (gsize) stride[p] *
        (gsize) GST_VIDEO_INFO_COMP_HEIGHT (info, comp[0]);
  }
  buffer = gst_buffer_new_allocate (NULL, size, NULL);
  gst_buffer_memset (buffer, 0, FILL, size);
  gst_buffer_add_video_meta_full (buffer, GST_VIDEO_FRAME_FLAG_NONE,
      GST_VIDEO_INFO_FORMAT (info), (guint) width, (guint) height,
      GST_VIDEO_INFO_N_PLANES (info), offset, stride);
  GST_BUFFER_PTS (buffer) = 0;
  GST_BUFFER_DURATION (buffer) = GST_SECOND / 30;
  return buffer;
}

static GstClothQuad
quad_at (gfloat x, gfloat y, gfloat size, gfloat confidence)
{
  GstClothQuad q = { 0 };

  q.column = 3;
  q.row = 12;
  q.state = GST_CLOTH_QUAD_TRACKED;
  q.black = TRUE;
  q.confidence = confidence;
  q.x[0] = q.x[3] = x;
  q.x[1] = q.x[2] = x + size;
  q.y[0] = q.y[1] = y;
  q.y[2] = q.y[3] = y + size;
  return q;
}

static void
add_quads (GstBuffer * buffer, const GstClothQuad * quads, guint n)
{
  gst_buffer_add_cloth_quads_meta (buffer, gst_cloth_quads_new ("cam0", 0, 40,
          30, quads, n));
}

static GstHarness *
overlay (const gchar * properties, const GstVideoInfo * info)
{
  g_autofree gchar *launch = g_strdup_printf ("clothoverlay %s", properties);
  GstElement *element = gst_parse_launch (launch, NULL);
  GstHarness *h;

  fail_unless (element != NULL);
  gst_object_ref_sink (element);
  h = gst_harness_new_with_element (element, "sink", "src");
  gst_object_unref (element);
  gst_harness_add_propose_allocation_meta (h, GST_VIDEO_META_API_TYPE, NULL);
  if (info) {
    gst_harness_set_src_caps (h, gst_video_info_to_caps (info));
  }
  return h;
}

static GstBuffer *
draw (const gchar * properties, GstVideoInfo * info, GstBuffer * buffer)
{
  GstHarness *h = overlay (properties, info);
  GstBuffer *out;

  fail_unless_equals_int (gst_harness_push (h, buffer), GST_FLOW_OK);
  out = gst_harness_pull (h);
  fail_unless (out != NULL);
  gst_harness_teardown (h);
  return out;
}

static gdouble
distance (gdouble px, gdouble py, gdouble x0, gdouble y0, gdouble x1,
    gdouble y1)
{
  gdouble dx = x1 - x0, dy = y1 - y0, l = dx * dx + dy * dy;
  gdouble t = l > 0 ? ((px - x0) * dx + (py - y0) * dy) / l : 0;

  t = CLAMP (t, 0, 1);
  return hypot (px - x0 - t * dx, py - y0 - t * dy);
}

typedef struct
{
  gdouble x0, y0, x1, y1;
} Line;

/* Every sample that changed is near a line, every sample on a line changed, and the
 * bytes between the rows are as they were. Returns the samples that changed. */
static guint
check_lines (GstBuffer * buffer, GstVideoInfo * info, const Line * lines,
    guint n_lines, gdouble width)
{
  GstVideoFrame frame;
  guint c, changed = 0;
  gint x, y;

  fail_unless (gst_video_frame_map (&frame, info, buffer, GST_MAP_READ));
  for (c = 0; c < GST_VIDEO_FRAME_N_COMPONENTS (&frame); c++) {
    gdouble sx = 1 << GST_VIDEO_FORMAT_INFO_W_SUB (info->finfo, c);
    gdouble sy = 1 << GST_VIDEO_FORMAT_INFO_H_SUB (info->finfo, c);

    for (y = 0; y < GST_VIDEO_FRAME_COMP_HEIGHT (&frame, c); y++) {
      const guint8 *row = GST_VIDEO_FRAME_COMP_DATA (&frame, c);

      row += y * GST_VIDEO_FRAME_COMP_STRIDE (&frame, c);
      for (x = 0; x < GST_VIDEO_FRAME_COMP_WIDTH (&frame, c); x++) {
        guint8 value = row[x * GST_VIDEO_FRAME_COMP_PSTRIDE (&frame, c)];
        gdouble px = x * sx + 0.5 * (sx - 1), py = y * sy + 0.5 * (sy - 1);
        gdouble nearest = G_MAXDOUBLE;
        guint i;

        for (i = 0; i < n_lines; i++) {
          nearest = MIN (nearest, distance (px, py, lines[i].x0, lines[i].y0,
                  lines[i].x1, lines[i].y1));
        }
        if (value != FILL) {
          changed++;
          fail_unless (nearest <= 0.5 * (width + MAX (sx, sy)) + 0.01,
              "%s component %u sample (%d, %d) is %.2f px from any line",
              GST_VIDEO_INFO_NAME (info), c, x, y, nearest);
        } else if (c == 0) {
          fail_unless (nearest > 0.25, "%s: (%d, %d) was not drawn",
              GST_VIDEO_INFO_NAME (info), x, y);
        }
      }
    }
  }
  gst_video_frame_unmap (&frame);
  return changed;
}

static void
check_padding (GstBuffer * buffer, GstVideoInfo * info, gint padding)
{
  GstVideoMeta *meta = gst_buffer_get_video_meta (buffer);
  GstMapInfo map;
  guint p;
  gint y, i;

  fail_unless (meta != NULL);
  fail_unless (gst_buffer_map (buffer, &map, GST_MAP_READ));
  for (p = 0; p < meta->n_planes; p++) {
    gint comp[GST_VIDEO_MAX_COMPONENTS], used;

    gst_video_format_info_component (info->finfo, p, comp);
    used = GST_VIDEO_INFO_COMP_WIDTH (info, comp[0]) *
        GST_VIDEO_INFO_COMP_PSTRIDE (info, comp[0]);
    if (GST_VIDEO_INFO_IS_YUV (info) && meta->n_planes == 1) {
      used = GST_VIDEO_INFO_PLANE_STRIDE (info, p);
    }
    for (y = 0; y < GST_VIDEO_INFO_COMP_HEIGHT (info, comp[0]); y++) {
      for (i = used; i < meta->stride[p]; i++) {
        fail_unless_equals_int (map.data[meta->offset[p] +
                (gsize) (y * meta->stride[p] + i)], FILL);
      }
    }
    for (i = 0; i < padding; i++) {
      fail_unless_equals_int (map.data[meta->offset[p] - 1 - (gsize) i], FILL);
    }
  }
  gst_buffer_unmap (buffer, &map);
}

static const guint8 *
pixel (GstVideoFrame * frame, guint component, gint x, gint y)
{
  return (const guint8 *) GST_VIDEO_FRAME_COMP_DATA (frame, component) +
      y * GST_VIDEO_FRAME_COMP_STRIDE (frame, component) +
      x * GST_VIDEO_FRAME_COMP_PSTRIDE (frame, component);
}

/* ---- positive ---- */

/* All formats, an odd size, padded rows, a square that is turned and cut by the edge. */
GST_START_TEST (test_formats)
{
  const gchar *format = formats[__i__];
  GstClothQuad q[2] = { quad_at (10.3f, 7.8f, 20, 1), quad_at (0, 0, 0, 0.8f) };
  const gfloat x[4] = { 50, 75.5f, 68, 42 }, y[4] = { 10, 18, 44, 33.3f };
  Line lines[8];
  GstVideoInfo info;
  GstBuffer *buffer, *out;
  guint i, changed;

  memcpy (q[1].x, x, sizeof (x));
  memcpy (q[1].y, y, sizeof (y));
  for (i = 0; i < 8; i++) {
    guint k = i & 3, l = (k + 1) & 3;

    lines[i].x0 = q[i / 4].x[k];
    lines[i].y0 = q[i / 4].y[k];
    lines[i].x1 = q[i / 4].x[l];
    lines[i].y1 = q[i / 4].y[l];
  }
  buffer = picture (format, 71, 47, 13, &info);
  add_quads (buffer, q, 2);
  out = draw ("fill-opacity=0 line-width=2", &info, buffer);
  changed = check_lines (out, &info, lines, 8, 2);
  fail_unless (changed > 300, "%u", changed);
  check_padding (out, &info, 13);
  gst_buffer_unref (out);
}

GST_END_TEST;

/* Who does not know of strides gets pictures as their caps mean them, drawn on or not, with
 * all that is on them. */
GST_START_TEST (test_plain_layout)
{
  guint k;

  for (k = 0; k < 2; k++) {
    GstClothQuad q = quad_at (10, 10, 20, 1);
    const Line lines[4] = { {10, 10, 30, 10}, {30, 10, 30, 30},
    {30, 30, 10, 30}, {10, 30, 10, 10}
    };
    GstHarness *h;
    GstVideoInfo info;
    GstBuffer *buffer = picture ("I420", 71, 47, 13, &info), *out;

    add_quads (buffer, &q, 1);
    h = gst_harness_new_parse (k ? "clothoverlay draw-quads=false" :
        "clothoverlay fill-opacity=0 line-width=2");
    gst_harness_set_src_caps (h, gst_video_info_to_caps (&info));
    out = gst_harness_push_and_pull (h, buffer);
    fail_unless (gst_buffer_get_video_meta (out) == NULL);
    fail_unless_equals_int (gst_buffer_get_size (out),
        GST_VIDEO_INFO_SIZE (&info));
    fail_unless (gst_buffer_get_cloth_quads (out) != NULL);
    fail_unless (GST_BUFFER_PTS (out) == 0);
    fail_unless ((check_lines (out, &info, lines, k ? 0 : 4, 2) > 0) == !k);
    gst_buffer_unref (out);
    gst_harness_teardown (h);
  }
}

GST_END_TEST;

GST_START_TEST (test_nothing_to_draw)
{
  GstVideoInfo info;
  GstBuffer *buffer = picture ("I420", 33, 21, 0, &info), *out;

  /* the very same buffer */
  out = draw ("", &info, buffer);
  fail_unless (out == buffer);
  check_lines (out, &info, NULL, 0, 1);
  gst_buffer_unref (out);

  /* neither does what is switched off change anything */
  buffer = picture ("I420", 33, 21, 0, &info);
  {
    GstClothQuad q = quad_at (3, 3, 12, 1);

    add_quads (buffer, &q, 1);
  }
  out = draw ("draw-quads=false", &info, buffer);
  fail_unless (out == buffer);
  check_lines (out, &info, NULL, 0, 1);
  gst_buffer_unref (out);
}

GST_END_TEST;

/* Another branch of a tee keeps its picture. */
GST_START_TEST (test_shared_buffer)
{
  GstClothQuad q = quad_at (5, 5, 15, 1);
  GstVideoInfo info;
  GstBuffer *buffer = picture ("I420", 40, 30, 0, &info), *out;

  add_quads (buffer, &q, 1);
  out = draw ("", &info, gst_buffer_ref (buffer));
  fail_unless (out != buffer);
  check_lines (buffer, &info, NULL, 0, 1);
  fail_unless (gst_buffer_get_cloth_quads (out) != NULL);
  gst_buffer_unref (out);
  gst_buffer_unref (buffer);
}

GST_END_TEST;

/* The ends of the colour map, through GStreamer's own converter for YUV. */
GST_START_TEST (test_confidence_colours)
{
  static const struct
  {
    gfloat confidence;
    guint8 rgb[3];
  } ends[] = {
    {1.0f, {255, 237, 38}}, {0.62f, {128, 33, 199}}, {0.1f, {128, 33, 199}}
  };
  static const gchar *const of[] = { "RGBA", "BGRx", "Y444", "AYUV", "I420" };
  guint e, f, c;

  for (e = 0; e < G_N_ELEMENTS (ends); e++) {
    for (f = 0; f < G_N_ELEMENTS (of); f++) {
      GstClothQuad q = quad_at (8, 8, 32, ends[e].confidence);
      GstVideoInfo info, rgb;
      GstBuffer *buffer = picture (of[f], 48, 48, 0, &info), *out, *converted;
      GstVideoConverter *converter;
      GstVideoFrame from, to;

      add_quads (buffer, &q, 1);
      out = draw ("fill-opacity=1", &info, buffer);
      converted = picture ("RGBA", 48, 48, 0, &rgb);
      converter = gst_video_converter_new (&info, &rgb, NULL);
      fail_unless (gst_video_frame_map (&from, &info, out, GST_MAP_READ));
      fail_unless (gst_video_frame_map (&to, &rgb, converted, GST_MAP_WRITE));
      gst_video_converter_frame (converter, &from, &to);
      for (c = 0; c < 3; c++) {
        gint got = *pixel (&to, c, 24, 24);

        /* the converter's fast paths are a few levels off */
        fail_unless (ABS (got - ends[e].rgb[c]) <= (f < 2 ? 1 : 5),
            "%s confidence %.2f component %u: %d, not %d", of[f],
            ends[e].confidence, c, got, ends[e].rgb[c]);
      }
      gst_video_frame_unmap (&from);
      gst_video_frame_unmap (&to);
      gst_video_converter_free (converter);
      gst_buffer_unref (converted);
      gst_buffer_unref (out);
    }
  }
}

GST_END_TEST;

/* Half opacity is half way, and alpha rises towards opaque. */
GST_START_TEST (test_opacity)
{
  GstClothQuad q = quad_at (8, 8, 32, 1);
  GstVideoInfo info;
  GstBuffer *buffer = picture ("RGBA", 48, 48, 0, &info), *out;
  GstVideoFrame frame;

  add_quads (buffer, &q, 1);
  out = draw ("fill-opacity=0.5", &info, buffer);
  fail_unless (gst_video_frame_map (&frame, &info, out, GST_MAP_READ));
  fail_unless (ABS (*pixel (&frame, 0, 24, 24) - (128 + 255) / 2) <= 1);
  fail_unless (ABS (*pixel (&frame, 1, 24, 24) - (128 + 237) / 2) <= 1);
  fail_unless (ABS (*pixel (&frame, 2, 24, 24) - (128 + 38) / 2) <= 1);
  fail_unless (ABS (*pixel (&frame, 3, 24, 24) - (128 + 255) / 2) <= 1);
  fail_unless_equals_int (*pixel (&frame, 0, 2, 2), FILL);
  gst_video_frame_unmap (&frame);
  gst_buffer_unref (out);
}

GST_END_TEST;

/* A predicted square is dashed and hollow, a lost one is not there. */
GST_START_TEST (test_states)
{
  GstClothQuad q[3] = {
    quad_at (5, 5, 30, 0.9f), quad_at (45, 5, 30, 0.9f), quad_at (85, 5, 30,
        0.9f)
  };
  guint drawn[3] = { 0 };
  GstVideoInfo info;
  GstBuffer *buffer = picture ("GRAY8", 120, 40, 0, &info), *out;
  GstVideoFrame frame;
  gint x, y;

  q[1].state = GST_CLOTH_QUAD_PREDICTED;
  q[2].state = GST_CLOTH_QUAD_LOST;
  add_quads (buffer, q, 3);
  out = draw ("", &info, buffer);
  fail_unless (gst_video_frame_map (&frame, &info, out, GST_MAP_READ));
  for (y = 0; y < 40; y++) {
    for (x = 0; x < 120; x++) {
      drawn[x / 40] += *pixel (&frame, 0, x, y) != FILL;
    }
  }
  fail_unless (*pixel (&frame, 0, 20, 20) != FILL);
  fail_unless_equals_int (*pixel (&frame, 0, 60, 20), FILL);
  gst_video_frame_unmap (&frame);
  GST_INFO ("samples drawn: tracked %u, predicted %u, lost %u", drawn[0],
      drawn[1], drawn[2]);
  fail_unless (drawn[0] > 900);
  fail_unless (drawn[1] > 120 && drawn[1] < 320);
  fail_unless_equals_int (drawn[2], 0);
  gst_buffer_unref (out);
}

GST_END_TEST;

static void
add_saddles (GstBuffer * buffer, const GstClothSaddle * refined, guint n,
    const GstClothCandidate * candidates, guint n_candidates)
{
  gst_buffer_add_cloth_saddles_meta (buffer, gst_cloth_saddles_new ("cam0", 0,
          refined, n, candidates, n_candidates));
}

GST_START_TEST (test_saddles)
{
  const GstClothSaddle s[2] = {
    {12.5f, 20.25f, 1, 0, 1e-4f, 0, 1e-4f}, {40, 9, 1, 0, 1e-4f, 0, 1e-4f}
  };
  const GstClothCandidate c[2] = { {25, 30, 1}, {26, 30, 1} };
  const Line crosses[4] = {
    {8.5, 20.25, 16.5, 20.25}, {12.5, 16.25, 12.5, 24.25},
    {36, 9, 44, 9}, {40, 5, 40, 13}
  };
  const Line dots[2] = { {25, 30, 25, 30}, {26, 30, 26, 30} };
  GstVideoInfo info;
  GstBuffer *buffer = picture ("NV12", 61, 43, 5, &info), *out;

  add_saddles (buffer, s, 2, c, 2);
  out = draw ("line-width=1", &info, buffer);
  fail_unless (check_lines (out, &info, crosses, 4, 1) > 60);
  gst_buffer_unref (out);

  buffer = picture ("NV12", 61, 43, 5, &info);
  add_saddles (buffer, NULL, 0, c, 2);
  out = draw ("line-width=1", &info, buffer);
  fail_unless (check_lines (out, &info, dots, 2, 1) >= 2);
  gst_buffer_unref (out);

  buffer = picture ("NV12", 61, 43, 5, &info);
  add_saddles (buffer, s, 2, c, 2);
  out = draw ("draw-saddles=false", &info, buffer);
  fail_unless (out == buffer);
  gst_buffer_unref (out);
}

GST_END_TEST;

/* The ellipse p' C^-1 p = scale², C with sigmas 0.1 and 0.05 px turned by 30 degrees. */
GST_START_TEST (test_covariance_ellipse)
{
  const gdouble a = 10, b = 5, angle = G_PI / 6;
  GstClothSaddle s = { 30, 25, 1, 0, 0, 0, 0 };
  gdouble ca = cos (angle), sa = sin (angle);
  Line lines[722];
  GstVideoInfo info;
  GstBuffer *buffer = picture ("GRAY8", 60, 50, 0, &info), *out;
  guint i;

  s.cov_xx = (gfloat) (1e-4 * (a * a * ca * ca + b * b * sa * sa));
  s.cov_xy = (gfloat) (1e-4 * (a * a - b * b) * ca * sa);
  s.cov_yy = (gfloat) (1e-4 * (a * a * sa * sa + b * b * ca * ca));
  for (i = 0; i < 720; i++) {
    gdouble t = G_PI * i / 360, u = G_PI * (i + 1) / 360;

    lines[i].x0 = 30 + a * cos (t) * ca - b * sin (t) * sa;
    lines[i].y0 = 25 + a * cos (t) * sa + b * sin (t) * ca;
    lines[i].x1 = 30 + a * cos (u) * ca - b * sin (u) * sa;
    lines[i].y1 = 25 + a * cos (u) * sa + b * sin (u) * ca;
  }
  lines[720] = (Line) {
  26, 25, 34, 25};
  lines[721] = (Line) {
  30, 21, 30, 29};
  add_saddles (buffer, &s, 1, NULL, 0);
  out = draw ("line-width=1.5 ellipse-scale=100", &info, buffer);
  /* chords of the drawn polygon stay within 0.35 px of the curve */
  fail_unless (check_lines (out, &info, lines, 722, 2.2) > 100);
  gst_buffer_unref (out);
}

GST_END_TEST;

/* The index is written inside its square and differs from square to square. */
GST_START_TEST (test_indices)
{
  GstVideoInfo info;
  GstBuffer *first = NULL;
  gint round;

  for (round = 0; round < 2; round++) {
    GstClothQuad q = quad_at (8, 8, 40, 1);
    GstBuffer *buffer = picture ("GRAY8", 56, 56, 0, &info), *out;
    GstVideoFrame frame;
    guint inside = 0;
    gint x, y;

    q.column += round;
    add_quads (buffer, &q, 1);
    out = draw ("draw-quads=false draw-indices=true", &info, buffer);
    fail_unless (gst_video_frame_map (&frame, &info, out, GST_MAP_READ));
    for (y = 0; y < 56; y++) {
      for (x = 0; x < 56; x++) {
        gboolean is_inside = x > 8 && x < 48 && y > 8 && y < 48;

        fail_unless (is_inside || *pixel (&frame, 0, x, y) == FILL);
        inside += *pixel (&frame, 0, x, y) != FILL;
      }
    }
    gst_video_frame_unmap (&frame);
    fail_unless (inside > 60, "%u", inside);
    if (first) {
      GstMapInfo map;

      gst_buffer_map (first, &map, GST_MAP_READ);
      fail_unless (gst_buffer_memcmp (out, 0, map.data, map.size) != 0);
      gst_buffer_unmap (first, &map);
      gst_buffer_unref (out);
    } else {
      first = out;
    }
  }
  gst_buffer_unref (first);
}

GST_END_TEST;

/* ---- mesh ---- */

static gchar *
write_rig (const gchar * extra_keys, const gchar * extra_camera)
{
  gchar *path = NULL;
  gint fd = g_file_open_tmp ("cloth-overlay-XXXXXX.json", &path, NULL);
  g_autofree gchar *text =
      g_strdup_printf ("{\"version\": 1, \"cameras\": [{\"name\": \"left\", "
      "\"size\": [80, 60], \"K\": [[100, 0, 39.5], [0, 100, 29.5], [0, 0, 1]], "
      "\"distortion\": {\"model\": \"none\", \"coefficients\": []}, "
      "\"R\": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], \"t\": [0, 0, 0]%s}%s]}",
      extra_keys, extra_camera);

  fail_unless (fd >= 0);
  g_close (fd, NULL);
  fail_unless (g_file_set_contents (path, text, -1, NULL));
  return path;
}

static const gchar second_camera[] =
    ", {\"name\": \"right\", \"size\": [80, 60], "
    "\"K\": [[100, 0, 39.5], [0, 100, 29.5], [0, 0, 1]], "
    "\"distortion\": {\"model\": \"none\", \"coefficients\": []}, "
    "\"R\": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], \"t\": [0.1, 0, 0]}";

#define COLUMNS 4
#define ROWS 3

/* A flat grid in front of the camera: vertex (c, r) projects to (15 + 15 c, 15 + 15 r)
 * at 2 m and f = 100 px. */
static GstBuffer *
mesh_buffer (guint n_vertices, gint missing)
{
  g_autofree gfloat *positions = g_new (gfloat, 3 * n_vertices);
  g_autofree guint8 *states = g_new0 (guint8, n_vertices);
  g_autoptr (GstClothMesh) mesh = NULL;
  GstBuffer *buffer;
  guint i;

  for (i = 0; i < n_vertices; i++) {
    gdouble px = 15 + 15 * (gdouble) (i % COLUMNS);
    gdouble py = 15 + 15 * (gdouble) (i / COLUMNS);

    positions[3 * i] = (gfloat) ((px - 39.5) * 2 / 100);
    positions[3 * i + 1] = (gfloat) ((py - 29.5) * 2 / 100);
    positions[3 * i + 2] = 2;
    states[i] = GST_CLOTH_VERTEX_MEASURED;
    if ((gint) i == missing) {
      positions[3 * i] = positions[3 * i + 1] = positions[3 * i + 2] = NAN;
      states[i] = GST_CLOTH_VERTEX_UNSEEN;
    }
  }
  mesh = gst_cloth_mesh_new (0, n_vertices, positions, states, NULL);
  buffer = gst_cloth_mesh_to_buffer (mesh);
  GST_BUFFER_PTS (buffer) = 0;
  GST_BUFFER_DURATION (buffer) = GST_SECOND / 30;
  return buffer;
}

static GstHarness *
mesh_pad (GstHarness * h)
{
  GstHarness *mesh = gst_harness_new_with_element (h->element, "mesh", NULL);
  g_autoptr (GstClothTopology) topology =
      gst_cloth_topology_new_grid (COLUMNS, ROWS, 0.9f, 0.6f, NULL);

  gst_harness_set_src_caps (mesh, gst_cloth_topology_to_caps (topology, 30, 1));
  return mesh;
}

static guint
grid_lines (Line * lines, gdouble scale, gint missing)
{
  guint n = 0;
  gint r, c, d;

  for (r = 0; r < ROWS; r++) {
    for (c = 0; c < COLUMNS; c++) {
      for (d = 0; d < 2; d++) {
        gint r2 = r + d, c2 = c + 1 - d;

        if (r2 >= ROWS || c2 >= COLUMNS || r * COLUMNS + c == missing
            || r2 * COLUMNS + c2 == missing) {
          continue;
        }
        lines[n].x0 = (15 + 15 * c + 0.5) * scale - 0.5;
        lines[n].y0 = (15 + 15 * r + 0.5) * scale - 0.5;
        lines[n].x1 = (15 + 15 * c2 + 0.5) * scale - 0.5;
        lines[n].y1 = (15 + 15 * r2 + 0.5) * scale - 0.5;
        n++;
      }
    }
  }
  return n;
}

/* Also with a picture three times as large as the calibration's. */
GST_START_TEST (test_mesh)
{
  g_autofree gchar *rig = write_rig ("", "");
  gint pass;

  for (pass = 0; pass < 3; pass++) {
    g_autofree gchar *properties =
        g_strdup_printf ("rig=%s line-width=1.5 %s", rig,
        pass ? "camera=left" : "");
    gint missing = pass == 2 ? 5 : -1;
    gdouble scale = pass == 1 ? 3 : 1;
    GstVideoInfo info;
    GstBuffer *buffer =
        picture ("I420", (gint) (80 * scale), (gint) (60 * scale), 3, &info);
    GstHarness *h = overlay (properties, &info), *m = mesh_pad (h);
    Line lines[40];
    guint n = grid_lines (lines, scale, missing);
    GstBuffer *out;

    fail_unless_equals_int (n, pass == 2 ? 13 : 17);
    gst_harness_push (h, buffer);
    gst_harness_push (m, mesh_buffer (COLUMNS * ROWS, missing));
    out = gst_harness_pull (h);
    fail_unless (check_lines (out, &info, lines, n, 1.5) > 400);
    gst_buffer_unref (out);
    gst_harness_teardown (m);
    gst_harness_teardown (h);
  }
  g_unlink (rig);
}

GST_END_TEST;

/* ---- heat map ---- */

/* The flat grid, every vertex @mm millimetres off; one vertex not seen. */
static GstBuffer *
gap_buffer (gfloat mm, guint n_gap, gint missing)
{
  GstBuffer *buffer = mesh_buffer (COLUMNS * ROWS, missing);
  g_autofree gfloat *residuals = g_new (gfloat, 3 * n_gap);
  guint i;

  for (i = 0; i < n_gap; i++) {
    /* 2² + 3² + 6² = 7² */
    residuals[3 * i] = -2e-3f * mm / 7;
    residuals[3 * i + 1] = 3e-3f * mm / 7;
    residuals[3 * i + 2] = (gint) i == missing ? NAN : 6e-3f * mm / 7;
  }
  gst_buffer_add_cloth_gap_meta (buffer, gst_cloth_gap_new (0, n_gap, residuals,
          NULL));
  return buffer;
}

static GstBuffer *
draw_gap (const gchar * properties, gint width, gint height,
    GstVideoInfo * info, GstBuffer * mesh)
{
  g_autofree gchar *rig = write_rig ("", "");
  g_autofree gchar *all = g_strdup_printf ("rig=%s %s", rig, properties);
  GstBuffer *buffer = picture ("RGB", width, height, 3, info), *out;
  GstHarness *h = overlay (all, info), *m = mesh_pad (h);

  gst_harness_push (h, buffer);
  gst_harness_push (m, mesh);
  out = gst_harness_pull (h);
  fail_unless (out != NULL);
  gst_harness_teardown (m);
  gst_harness_teardown (h);
  g_unlink (rig);
  return out;
}

static void
check_rgb (GstBuffer * buffer, GstVideoInfo * info, gint x, gint y,
    const gdouble rgb[3], gdouble most, const gchar * what)
{
  GstVideoFrame frame;
  guint c;

  fail_unless (gst_video_frame_map (&frame, info, buffer, GST_MAP_READ));
  for (c = 0; c < 3; c++) {
    gint got = *pixel (&frame, c, x, y);

    fail_unless (fabs (got - rgb[c]) <= most, "%s (%d, %d) component %u: %d, "
        "not %.1f", what, x, y, c, got, rgb[c]);
  }
  gst_video_frame_unmap (&frame);
}

/* The ends of the report's scale, 60% over the film's 128, in the middle of a cell; the
 * full colour on the line between two cells. */
GST_START_TEST (test_gap_colours)
{
  static const struct
  {
    gfloat mm;
    const gchar *properties;
    gdouble rgb[3];
  } cases[] = {
    {0, "", {240, 234, 222}}, {10, "", {104, 10, 62}},
    {4000, "", {104, 10, 62}}, {9, "gap-scale=20", {244, 150, 70}},
    {0.45f, "gap-scale=1", {244, 150, 70}}, {14, "gap-scale=20", {214, 62, 52}}
  };
  guint i, c;

  for (i = 0; i < G_N_ELEMENTS (cases); i++) {
    GstVideoInfo info;
    GstBuffer *out = draw_gap (cases[i].properties, 80, 60, &info,
        gap_buffer (cases[i].mm, COLUMNS * ROWS, -1));
    gdouble face[3];

    for (c = 0; c < 3; c++) {
      face[c] = FILL + 0.6 * (cases[i].rgb[c] - FILL);
    }
    check_rgb (out, &info, 22, 22, face, 4, cases[i].properties);
    check_rgb (out, &info, 22, 30, cases[i].rgb, 5, "line");
    gst_buffer_unref (out);
  }
}

GST_END_TEST;

/* A face with an unseen corner is not filled, nor is anything when it is switched off
 * or when the gap is of another mesh. */
GST_START_TEST (test_gap_not_drawn)
{
  const gdouble film[3] = { FILL, FILL, FILL };
  GstVideoInfo info;
  GstBuffer *out;

  out = draw_gap ("", 80, 60, &info, gap_buffer (10, COLUMNS * ROWS, 5));
  check_rgb (out, &info, 22, 22, film, 1, "unseen corner");
  gst_buffer_unref (out);

  out = draw_gap ("draw-gap=false", 80, 60, &info, gap_buffer (10,
          COLUMNS * ROWS, -1));
  check_rgb (out, &info, 22, 22, film, 1, "switched off");
  gst_buffer_unref (out);

  out = draw_gap ("", 80, 60, &info, gap_buffer (10, COLUMNS * ROWS - 1, -1));
  check_rgb (out, &info, 22, 22, film, 1, "another mesh");
  gst_buffer_unref (out);

  out = draw_gap ("draw-mesh=false", 80, 60, &info, gap_buffer (10,
          COLUMNS * ROWS, -1));
  check_rgb (out, &info, 22, 22, film, 1, "no mesh");
  gst_buffer_unref (out);
}

GST_END_TEST;

/* The scale: its first colour below, its last above, and only in pictures with room. */
GST_START_TEST (test_gap_scale)
{
  const gdouble low[3] = { 240, 234, 222 }, high[3] = { 104, 10, 62 };
  const gdouble film[3] = { FILL, FILL, FILL };
  GstVideoInfo info;
  GstBuffer *out = draw_gap ("", 640, 480, &info, gap_buffer (0, COLUMNS * ROWS,
          -1));

  check_rgb (out, &info, 17, 467, low, 1, "low end");
  check_rgb (out, &info, 17, 373, high, 1, "high end");
  check_rgb (out, &info, 17, 370, film, 1, "above");
  gst_buffer_unref (out);
  out = draw_gap ("", 160, 120, &info, gap_buffer (0, COLUMNS * ROWS, -1));
  check_rgb (out, &info, 4, 115, film, 1, "thumbnail");
  gst_buffer_unref (out);
}

GST_END_TEST;

/* Pictures without a mesh pass, meshes without a picture are dropped. */
GST_START_TEST (test_mesh_pairing)
{
  g_autofree gchar *rig = write_rig ("", "");
  g_autofree gchar *properties = g_strdup_printf ("rig=%s", rig);
  GstVideoInfo info;
  GstBuffer *buffer = picture ("I420", 80, 60, 0, &info), *out;
  GstHarness *h = overlay (properties, &info), *m = mesh_pad (h);

  GST_BUFFER_PTS (buffer) = 1 * GST_SECOND;
  gst_harness_push (h, buffer);
  gst_harness_push (m, mesh_buffer (COLUMNS * ROWS, -1));       /* at 0 s */
  buffer = mesh_buffer (COLUMNS * ROWS, -1);
  GST_BUFFER_PTS (buffer) = 2 * GST_SECOND;
  gst_harness_push (m, buffer);
  out = gst_harness_pull (h);
  fail_unless_equals_uint64 (GST_BUFFER_PTS (out), 1 * GST_SECOND);
  check_lines (out, &info, NULL, 0, 1);
  gst_buffer_unref (out);

  /* the mesh stream ends early: the film goes on */
  gst_harness_push_event (m, gst_event_new_eos ());
  buffer = picture ("I420", 80, 60, 0, &info);
  GST_BUFFER_PTS (buffer) = 3 * GST_SECOND;
  gst_harness_push (h, buffer);
  out = gst_harness_pull (h);
  fail_unless_equals_uint64 (GST_BUFFER_PTS (out), 3 * GST_SECOND);
  gst_buffer_unref (out);
  gst_harness_teardown (m);
  gst_harness_teardown (h);
  g_unlink (rig);
}

GST_END_TEST;

/* When the pictures end the film ends, however long the meshes go on. */
GST_START_TEST (test_film_ends)
{
  g_autofree gchar *rig = write_rig ("", "");
  g_autofree gchar *properties = g_strdup_printf ("rig=%s", rig);
  GstVideoInfo info;
  GstBuffer *buffer = picture ("I420", 80, 60, 0, &info);
  GstHarness *h = overlay (properties, &info), *m = mesh_pad (h);
  GstEventType type = GST_EVENT_UNKNOWN;

  gst_harness_push (h, buffer);
  gst_harness_push (m, mesh_buffer (COLUMNS * ROWS, -1));
  gst_buffer_unref (gst_harness_pull (h));
  gst_harness_push_event (h, gst_event_new_eos ());
  buffer = mesh_buffer (COLUMNS * ROWS, -1);
  GST_BUFFER_PTS (buffer) = 1 * GST_SECOND;
  gst_harness_push (m, buffer);
  while (type != GST_EVENT_EOS) {
    GstEvent *event = gst_harness_pull_event (h);

    fail_unless (event != NULL);
    type = GST_EVENT_TYPE (event);
    gst_event_unref (event);
  }
  gst_harness_teardown (m);
  gst_harness_teardown (h);
  g_unlink (rig);
}

GST_END_TEST;

/* Meshes are in the rig's time; this camera's clock is half a second ahead of it. */
GST_START_TEST (test_camera_offset)
{
  g_autofree gchar *rig = write_rig (", \"offset_s\": 0.5", "");
  g_autofree gchar *properties = g_strdup_printf ("rig=%s", rig);
  GstVideoInfo info;
  GstBuffer *buffer = picture ("I420", 80, 60, 0, &info), *out;
  GstHarness *h = overlay (properties, &info), *m = mesh_pad (h);
  Line lines[40];
  guint n = grid_lines (lines, 1, -1);

  GST_BUFFER_PTS (buffer) = 500 * GST_MSECOND;
  gst_harness_push (h, buffer);
  gst_harness_push (m, mesh_buffer (COLUMNS * ROWS, -1));       /* at 0 s */
  out = gst_harness_pull (h);
  fail_unless_equals_uint64 (GST_BUFFER_PTS (out), 500 * GST_MSECOND);
  fail_unless (check_lines (out, &info, lines, n, 1.5) > 400);
  gst_buffer_unref (out);
  gst_harness_teardown (m);
  gst_harness_teardown (h);
  g_unlink (rig);
}

GST_END_TEST;

GST_START_TEST (test_caps_change)
{
  static const gchar *const of[] = { "I420", "RGBA", "GRAY8" };
  GstHarness *h = overlay ("fill-opacity=0", NULL);
  guint i;

  for (i = 0; i < 3; i++) {
    gint width = 50 + 13 * (gint) i;
    GstClothQuad q = quad_at (5, 6, 25, 1);
    const Line lines[4] = {
      {5, 6, 30, 6}, {30, 6, 30, 31}, {30, 31, 5, 31}, {5, 31, 5, 6}
    };
    GstVideoInfo info;
    GstBuffer *buffer = picture (of[i], width, 40, 0, &info), *out;
    GstCaps *caps;

    GST_BUFFER_PTS (buffer) = i * GST_SECOND;
    add_quads (buffer, &q, 1);
    gst_harness_set_src_caps (h, gst_video_info_to_caps (&info));
    gst_harness_push (h, buffer);
    out = gst_harness_pull (h);
    check_lines (out, &info, lines, 4, 1.5);
    caps = gst_pad_get_current_caps (h->sinkpad);
    fail_unless_equals_string (gst_structure_get_string (gst_caps_get_structure
            (caps, 0), "format"), of[i]);
    gst_caps_unref (caps);
    gst_buffer_unref (out);
  }
  gst_harness_teardown (h);
}

GST_END_TEST;

/* Upstream learns what downstream takes. */
GST_START_TEST (test_caps_query)
{
  GstHarness *h = overlay ("", NULL);
  GstCaps *caps;

  gst_harness_set_sink_caps_str (h, "video/x-raw,format=NV12,width=320");
  caps = gst_pad_peer_query_caps (h->srcpad, NULL);
  fail_unless_equals_string (gst_structure_get_string (gst_caps_get_structure
          (caps, 0), "format"), "NV12");
  gst_caps_unref (caps);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* A flushing seek in a real pipeline: the frame asked for comes next, and the film goes
 * on to its end. */
GST_START_TEST (test_seek)
{
  GstElement *pipeline =
      gst_parse_launch ("videotestsrc num-buffers=300 ! "
      "video/x-raw,format=I420,width=32,height=32,framerate=30/1 ! clothoverlay ! "
      "fakesink name=sink sync=false", NULL);
  GstElement *sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");
  GstBus *bus = gst_element_get_bus (pipeline);
  GstSample *sample = NULL;
  GstMessage *message;

  gst_element_set_state (pipeline, GST_STATE_PAUSED);
  fail_unless_equals_int (gst_element_get_state (pipeline, NULL, NULL,
          GST_CLOCK_TIME_NONE), GST_STATE_CHANGE_SUCCESS);
  fail_unless (gst_element_seek_simple (pipeline, GST_FORMAT_TIME,
          GST_SEEK_FLAG_FLUSH | GST_SEEK_FLAG_ACCURATE, 5 * GST_SECOND));
  fail_unless_equals_int (gst_element_get_state (pipeline, NULL, NULL,
          GST_CLOCK_TIME_NONE), GST_STATE_CHANGE_SUCCESS);
  g_object_get (sink, "last-sample", &sample, NULL);
  fail_unless (sample != NULL);
  fail_unless_equals_uint64 (GST_BUFFER_PTS (gst_sample_get_buffer (sample)),
      5 * GST_SECOND);
  gst_sample_unref (sample);

  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  message = gst_bus_timed_pop_filtered (bus, GST_CLOCK_TIME_NONE,
      GST_MESSAGE_EOS | GST_MESSAGE_ERROR);
  fail_unless_equals_int (GST_MESSAGE_TYPE (message), GST_MESSAGE_EOS);
  gst_message_unref (message);
  g_object_get (sink, "last-sample", &sample, NULL);
  fail_unless (GST_BUFFER_PTS (gst_sample_get_buffer (sample)) >
      9900 * GST_MSECOND);
  gst_sample_unref (sample);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (bus);
  gst_object_unref (sink);
  gst_object_unref (pipeline);
}

GST_END_TEST;

/* ---- bad input ---- */

GST_START_TEST (test_one_pixel)
{
  guint f;

  for (f = 0; f < G_N_ELEMENTS (formats); f++) {
    GstClothQuad q = quad_at (-5, -5, 20, 1);
    GstVideoInfo info;
    GstBuffer *buffer = picture (formats[f], 1, 1, 0, &info), *out;

    add_quads (buffer, &q, 1);
    out = draw ("draw-indices=true", &info, buffer);
    gst_buffer_unref (out);
  }
}

GST_END_TEST;

GST_START_TEST (test_bad_coordinates)
{
  static const gfloat bad[] = {
    NAN, INFINITY, -INFINITY, 1e30f, -1e30f, 3e9f, -3e9f, 1e6f
  };
  GstVideoInfo info;
  guint i, k;

  for (i = 0; i < G_N_ELEMENTS (bad); i++) {
    for (k = 0; k < 4; k++) {
      GstBuffer *buffer = picture ("I420", 64, 48, 7, &info), *out;
      GstClothQuad q = quad_at (10, 10, 20, NAN);
      GstClothSaddle s = { 20, 20, 1, 0, 1, 0, 1 };

      q.x[k] = bad[i];
      q.y[(k + 1) & 3] = bad[i];
      s.x = k & 1 ? bad[i] : 20;
      s.y = k & 1 ? 20 : bad[i];
      s.cov_xx = s.cov_xy = bad[i];
      add_quads (buffer, &q, 1);
      add_saddles (buffer, &s, 1, NULL, 0);
      out = draw ("draw-indices=true ellipse-scale=10", &info, buffer);
      check_padding (out, &info, 7);
      gst_buffer_unref (out);
    }
  }
}

GST_END_TEST;

/* Indices that no board has, states that there are not: drawn or left out, within the
 * picture. */
GST_START_TEST (test_wild_squares)
{
  static const gint wild[] = { -1, G_MININT, G_MAXINT, 1000000, 65536 };
  GstVideoInfo info;
  GstClothQuad q[3 * G_N_ELEMENTS (wild)];
  GstBuffer *buffer = picture ("NV12", 64, 48, 7, &info), *out;
  guint i;

  for (i = 0; i < G_N_ELEMENTS (q); i++) {
    gint value = wild[i / 3];

    q[i] = quad_at (i % 2 ? 40 : 10, 10, 20, i % 3 ? 1e30f : -1e30f);
    if (i % 3 == 0) {
      q[i].column = value;
    } else if (i % 3 == 1) {
      q[i].row = value;
    } else {
      q[i].state = (GstClothQuadState) value;
    }
  }
  add_quads (buffer, q, G_N_ELEMENTS (q));
  out = draw ("draw-indices=true", &info, buffer);
  check_padding (out, &info, 7);
  gst_buffer_unref (out);
}

GST_END_TEST;

/* A square folded over itself has no inside to fill; degenerate ones are points. */
GST_START_TEST (test_degenerate_squares)
{
  GstClothQuad q[2] = { quad_at (10, 10, 20, 1), quad_at (40, 10, 0, 1) };
  GstVideoInfo info;
  GstBuffer *buffer = picture ("GRAY8", 64, 48, 0, &info), *out;
  const Line lines[5] = {
    {10, 10, 30, 10}, {30, 10, 10, 30}, {10, 30, 30, 30}, {30, 30, 10, 10},
    {40, 10, 40, 10}
  };

  q[0].x[2] = 10;
  q[0].x[3] = 30;
  add_quads (buffer, q, 2);
  out = draw ("line-width=2", &info, buffer);
  check_lines (out, &info, lines, 5, 2);
  gst_buffer_unref (out);
}

GST_END_TEST;

GST_START_TEST (test_unknown_format)
{
  GstHarness *h = overlay ("", NULL);

  gst_harness_set_src_caps_str (h,
      "video/x-raw,format=P010_10LE,width=32,height=32,framerate=30/1");
  fail_unless_equals_int (gst_harness_push (h, gst_buffer_new_allocate (NULL,
              4096, NULL)), GST_FLOW_NOT_NEGOTIATED);
  gst_harness_teardown (h);
}

GST_END_TEST;

/* Each must end in an element error that names the fix. */
static void
expect_error (const gchar * properties, gint width, gint height,
    GstBuffer * mesh, gsize picture_size, const gchar * in_text)
{
  GstVideoInfo info;
  GstBuffer *buffer = picture ("GRAY8", width, height, 0, &info);
  GstHarness *h = overlay (properties, NULL), *m = NULL;
  GstBus *bus = gst_bus_new ();
  GstMessage *message;
  GError *error = NULL;
  gchar *debug = NULL, *all;

  gst_element_set_bus (h->element, bus);
  if (picture_size) {
    GstClothQuad q = quad_at (2, 2, 5, 1);

    gst_buffer_unref (buffer);
    buffer = gst_buffer_new_allocate (NULL, picture_size, NULL);
    GST_BUFFER_PTS (buffer) = 0;
    add_quads (buffer, &q, 1);
  }
  if (mesh) {
    m = mesh_pad (h);
  }
  gst_harness_set_src_caps (h, gst_video_info_to_caps (&info));
  gst_harness_push (h, buffer);
  if (m) {
    gst_harness_push (m, mesh);
  }
  message = gst_bus_timed_pop_filtered (bus, 20 * GST_SECOND,
      GST_MESSAGE_ERROR);
  fail_unless (message != NULL, "%s: no error", properties);
  gst_message_parse_error (message, &error, &debug);
  all = g_strconcat (error->message, " ", debug, NULL);
  fail_unless (strstr (all, in_text) != NULL, "%s", all);
  fail_unless (gst_harness_try_pull (h) == NULL);
  g_free (all);
  g_free (debug);
  g_clear_error (&error);
  gst_message_unref (message);
  if (m) {
    gst_harness_teardown (m);
  }
  gst_element_set_bus (h->element, NULL);
  gst_harness_teardown (h);
  gst_object_unref (bus);
}

GST_START_TEST (test_no_rig)
{
  expect_error ("", 80, 60, mesh_buffer (COLUMNS * ROWS, -1), 0, "rig=");
}

GST_END_TEST;

GST_START_TEST (test_rig_not_there)
{
  expect_error ("rig=/nonexistent/rig.json", 80, 60,
      mesh_buffer (COLUMNS * ROWS, -1), 0, "/nonexistent/rig.json");
}

GST_END_TEST;

GST_START_TEST (test_which_camera)
{
  g_autofree gchar *rig = write_rig ("", second_camera);
  g_autofree gchar *none = g_strdup_printf ("rig=%s", rig);
  g_autofree gchar *wrong = g_strdup_printf ("rig=%s camera=middle", rig);

  expect_error (none, 80, 60, mesh_buffer (COLUMNS * ROWS, -1), 0,
      "left, right");
  expect_error (wrong, 80, 60, mesh_buffer (COLUMNS * ROWS, -1), 0,
      "left, right");
  g_unlink (rig);
}

GST_END_TEST;

GST_START_TEST (test_other_shape)
{
  g_autofree gchar *rig = write_rig ("", "");
  g_autofree gchar *properties = g_strdup_printf ("rig=%s", rig);

  expect_error (properties, 60, 80, mesh_buffer (COLUMNS * ROWS, -1), 0,
      "80×60");
  g_unlink (rig);
}

GST_END_TEST;

GST_START_TEST (test_bad_mesh)
{
  g_autofree gchar *rig = write_rig ("", "");
  g_autofree gchar *properties = g_strdup_printf ("rig=%s", rig);
  GstBuffer *garbage = gst_buffer_new_memdup ("garbage", 7);

  GST_BUFFER_PTS (garbage) = 0;
  expect_error (properties, 80, 60, garbage, 0, "no valid mesh");
  expect_error (properties, 80, 60, mesh_buffer (COLUMNS * ROWS + 1, -1), 0,
      "stream of 12");
  g_unlink (rig);
}

GST_END_TEST;

GST_START_TEST (test_short_picture)
{
  expect_error ("", 80, 60, NULL, 100, "fit");
}

GST_END_TEST;

GST_START_TEST (test_second_mesh_pad)
{
  GstHarness *h = overlay ("", NULL);
  GstPad *pad = gst_element_request_pad_simple (h->element, "mesh");

  fail_unless (pad != NULL);
  ASSERT_CRITICAL (fail_unless (gst_element_request_pad_simple (h->element,
              "mesh") == NULL));
  gst_element_release_request_pad (h->element, pad);
  gst_object_unref (pad);
  pad = gst_element_request_pad_simple (h->element, "mesh");
  fail_unless (pad != NULL);
  gst_object_unref (pad);
  gst_harness_teardown (h);
}

GST_END_TEST;

static Suite *
clothoverlay_suite (void)
{
  Suite *s = suite_create ("clothoverlay");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_add_loop_test (tc, test_formats, 0, G_N_ELEMENTS (formats));
  tcase_add_test (tc, test_plain_layout);
  tcase_add_test (tc, test_nothing_to_draw);
  tcase_add_test (tc, test_shared_buffer);
  tcase_add_test (tc, test_confidence_colours);
  tcase_add_test (tc, test_opacity);
  tcase_add_test (tc, test_states);
  tcase_add_test (tc, test_saddles);
  tcase_add_test (tc, test_covariance_ellipse);
  tcase_add_test (tc, test_indices);
  tcase_add_test (tc, test_mesh);
  tcase_add_test (tc, test_gap_colours);
  tcase_add_test (tc, test_gap_not_drawn);
  tcase_add_test (tc, test_gap_scale);
  tcase_add_test (tc, test_mesh_pairing);
  tcase_add_test (tc, test_film_ends);
  tcase_add_test (tc, test_camera_offset);
  tcase_add_test (tc, test_caps_change);
  tcase_add_test (tc, test_caps_query);
  tcase_add_test (tc, test_seek);
  tcase_add_test (tc, test_one_pixel);
  tcase_add_test (tc, test_bad_coordinates);
  tcase_add_test (tc, test_wild_squares);
  tcase_add_test (tc, test_degenerate_squares);
  tcase_add_test (tc, test_unknown_format);
  tcase_add_test (tc, test_no_rig);
  tcase_add_test (tc, test_rig_not_there);
  tcase_add_test (tc, test_which_camera);
  tcase_add_test (tc, test_other_shape);
  tcase_add_test (tc, test_bad_mesh);
  tcase_add_test (tc, test_short_picture);
  tcase_add_test (tc, test_second_mesh_pad);
  return s;
}

GST_CHECK_MAIN (clothoverlay);
