/* Pictures, meshes and rigs for the tests of clothoverlay, and looking for lines in what
 * comes out.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/cloth/cloth.h>
#include <gst/video/video.h>
#include <glib/gstdio.h>
#include <math.h>

#define FILL 128
/* px: what the dark edges of a line add to its width */
#define EDGES 2

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
static inline GstBuffer *
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

static inline GstClothQuad
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

static inline void
add_quads (GstBuffer * buffer, const GstClothQuad * quads, guint n)
{
  gst_buffer_add_cloth_quads_meta (buffer, gst_cloth_quads_new ("cam0", 0, 40,
          30, quads, n));
}

static inline GstHarness *
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

static inline GstBuffer *
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

static inline gdouble
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
static inline guint
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

static inline void
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

static inline const guint8 *
pixel (GstVideoFrame * frame, guint component, gint x, gint y)
{
  return (const guint8 *) GST_VIDEO_FRAME_COMP_DATA (frame, component) +
      y * GST_VIDEO_FRAME_COMP_STRIDE (frame, component) +
      x * GST_VIDEO_FRAME_COMP_PSTRIDE (frame, component);
}


static inline void
add_saddles (GstBuffer * buffer, const GstClothSaddle * refined, guint n,
    const GstClothCandidate * candidates, guint n_candidates)
{
  gst_buffer_add_cloth_saddles_meta (buffer, gst_cloth_saddles_new ("cam0", 0,
          refined, n, candidates, n_candidates));
}

static inline gchar *
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

#define COLUMNS 4
#define ROWS 3

/* A flat grid in front of the camera: vertex (c, r) projects to (15 + 15 c, 15 + 15 r)
 * at 2 m and f = 100 px. */
static inline GstBuffer *
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

static inline GstHarness *
mesh_pad (GstHarness * h)
{
  GstHarness *mesh = gst_harness_new_with_element (h->element, "mesh", NULL);
  g_autoptr (GstClothTopology) topology =
      gst_cloth_topology_new_grid (COLUMNS, ROWS, 0.9f, 0.6f, NULL);

  gst_harness_set_src_caps (mesh, gst_cloth_topology_to_caps (topology, 30, 1));
  return mesh;
}
