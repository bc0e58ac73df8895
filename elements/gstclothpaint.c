/* What is on a cloth: patterns and pictures from files.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "elements/gstclothpaint.h"

#include <gio/gio.h>
#include <gst/video/video.h>

#include "gst/pattern/any.h"
#include "gst/pattern/texture.h"

/* Ink and cloth: shares of the light that they reflect. */
#define BLACK 0.04f
#define WHITE 0.75f
/* Pixels along the longer side of a pattern's picture: edges between are exact. */
#define PATTERN_PX 2048
/* A file that gives no picture for so long is broken. */
#define PATIENCE (30 * GST_SECOND)

static gboolean
fits (GstSample * sample, gint max_px)
{
  GstVideoInfo info;

  return sample && gst_video_info_from_caps (&info,
      gst_sample_get_caps (sample)) && info.width <= max_px
      && info.height <= max_px;
}

GstSample *
gst_cloth_load_picture (const gchar * path, const gchar * formats,
    gint max_px, GError ** error)
{
  g_autofree gchar *line = g_strdup_printf ("filesrc name=in ! decodebin ! "
      "videoconvert dither=none ! video/x-raw,format=%s ! fakesink name=out "
      "sync=false", formats);
  g_autoptr (GstElement) pipeline = NULL;
  g_autoptr (GstElement) source = NULL, sink = NULL;
  GstSample *sample = NULL;

  if (g_file_test (path, G_FILE_TEST_IS_DIR)) {
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_IS_DIRECTORY,
        "%s is a folder: name a picture file in it", path);
    return NULL;
  }
  if (!g_file_test (path, G_FILE_TEST_IS_REGULAR)) {
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND,
        "%s: there is no such file", path);
    return NULL;
  }
  /* else a missing element would leave both a pipeline and an error */
  pipeline = gst_parse_launch_full (line, NULL, GST_PARSE_FLAG_FATAL_ERRORS,
      error);
  if (!pipeline)
    return NULL;
  source = gst_bin_get_by_name (GST_BIN (pipeline), "in");
  sink = gst_bin_get_by_name (GST_BIN (pipeline), "out");
  g_object_set (source, "location", path, NULL);
  gst_element_set_state (pipeline, GST_STATE_PAUSED);
  if (gst_element_get_state (pipeline, NULL, NULL, PATIENCE)
      == GST_STATE_CHANGE_SUCCESS) {
    g_object_get (sink, "last-sample", &sample, NULL);
    if (!fits (sample, max_px)) {
      g_clear_pointer (&sample, gst_sample_unref);
      g_set_error (error, G_IO_ERROR, G_IO_ERROR_FAILED,
          "%s: no picture, or one larger than %d pixels a side", path, max_px);
    }
  } else {
    g_autoptr (GstBus) bus = gst_element_get_bus (pipeline);
    g_autoptr (GstMessage) message =
        gst_bus_pop_filtered (bus, GST_MESSAGE_ERROR);
    g_autoptr (GError) cause = NULL;

    if (message)
      gst_message_parse_error (message, &cause, NULL);
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_FAILED, "%s: %s", path,
        cause ? cause->message : "no picture came out of it in time");
  }
  gst_element_set_state (pipeline, GST_STATE_NULL);
  return sample;
}

GstBuffer *
gst_cloth_convert_picture (GstSample * picture, const GstVideoInfo * film,
    GstVideoFormat format, GstVideoInfo * info)
{
  GstVideoInfo from;
  GstVideoFrame in, out;
  GstVideoConverter *converter;
  GstBuffer *buffer;

  if (!gst_video_info_from_caps (&from, gst_sample_get_caps (picture))
      || !gst_video_frame_map (&in, &from, gst_sample_get_buffer (picture),
          GST_MAP_READ))
    return NULL;
  gst_video_info_set_format (info, format, (guint) from.width,
      (guint) from.height);
  info->colorimetry = film->colorimetry;
  info->fps_n = from.fps_n;
  info->fps_d = from.fps_d;
  info->interlace_mode = from.interlace_mode;
  converter = gst_video_converter_new (&from, info, gst_structure_new
      ("options", GST_VIDEO_CONVERTER_OPT_DITHER_METHOD,
          GST_TYPE_VIDEO_DITHER_METHOD, GST_VIDEO_DITHER_NONE, NULL));
  buffer = gst_buffer_new_allocate (NULL, GST_VIDEO_INFO_SIZE (info), NULL);
  if (converter && gst_video_frame_map (&out, info, buffer, GST_MAP_WRITE)) {
    gst_video_converter_frame (converter, &in, &out);
    gst_video_frame_unmap (&out);
  } else {
    gst_clear_buffer (&buffer);
  }
  g_clear_pointer (&converter, gst_video_converter_free);
  gst_video_frame_unmap (&in);
  return buffer;
}

static gdouble
pattern_scale (const gdouble cloth_m[2])
{
  return PATTERN_PX / MAX (cloth_m[0], cloth_m[1]);
}

/* Dots on black cloth, in levels proportional to the light that they reflect. */
static ClothTexture *
draw_dots (const ClothMArray * array, gfloat light[256], GError ** error)
{
  guint8 inks[CLOTH_M_ARRAY_MAX_COLOURS][3];

  for (gint i = 0; i < array->n_colours; i++)
    for (gint c = 0; c < 3; c++)
      inks[i][c] = (guint8) (255 * cloth_light_from_level
          (array->colours[i].rgb[c]) + 0.5f);
  for (gint i = 0; i < 256; i++)
    light[i] = (gfloat) i / 255;
  return cloth_m_array_texture (array, pattern_scale (array->cloth_m),
      (guint8) (255 * BLACK + 0.5f), (const guint8 (*)[3]) inks, error);
}

static ClothTexture *
draw_squares (const ClothPattern * pattern, gfloat light[256], GError ** error)
{
  for (gint i = 0; i < 256; i++)
    light[i] = BLACK + (WHITE - BLACK) * (gfloat) i / 255;
  return cloth_pattern_texture (pattern, pattern_scale (pattern->cloth_m), 0,
      255, error);
}

/* The first picture of any file that GStreamer decodes. */
static ClothPaint *
paint_picture (const gchar * path,
    const gdouble origin_uv_m[2], const gdouble size_m[2], GError ** error)
{
  g_autoptr (GstSample) sample = gst_cloth_load_picture (path,
      "{ RGB, GRAY8 }", CLOTH_PAINT_MAX_PX, error);
  ClothPaint *paint = NULL;
  GstVideoInfo info;
  GstVideoFrame frame;

  if (!sample)
    return NULL;
  if (!gst_video_info_from_caps (&info, gst_sample_get_caps (sample))
      || !gst_video_frame_map (&frame, &info, gst_sample_get_buffer (sample),
          GST_MAP_READ)) {
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_FAILED,
        "%s: the picture can't be read", path);
    return NULL;
  }
  paint = cloth_paint_new (GST_VIDEO_FRAME_PLANE_DATA (&frame, 0), info.width,
      info.height, GST_VIDEO_FRAME_PLANE_STRIDE (&frame, 0),
      GST_VIDEO_INFO_IS_GRAY (&info) ? 1 : 3, NULL, origin_uv_m, size_m);
  gst_video_frame_unmap (&frame);
  return paint;
}

ClothPaint *
gst_cloth_paint_pattern (const gchar * path, guint * sides, GError ** error)
{
  g_autoptr (ClothAnyPattern) pattern = cloth_any_pattern_load (path, error);
  g_autoptr (ClothTexture) texture = NULL;
  const gdouble origin[2] = { 0, 0 };
  gdouble size[2];
  gfloat light[256];

  if (!pattern)
    return NULL;
  if (pattern->picture) {
    *sides = MAX (*sides, (guint) pattern->picture->sides);
    return paint_picture (pattern->picture->reference, origin,
        pattern->picture->cloth_m, error);
  }
  texture = pattern->dots ? draw_dots (pattern->dots, light, error) :
      draw_squares (pattern->checker, light, error);
  if (!texture)
    return NULL;
  size[0] = texture->width / texture->px_per_m;
  size[1] = texture->height / texture->px_per_m;
  return cloth_paint_new (texture->data, texture->width, texture->height,
      texture->n_channels * texture->width, (guint) texture->n_channels, light,
      origin, size);
}

ClothPaint *
gst_cloth_paint_white (void)
{
  const gdouble origin[2] = { 0, 0 }, size[2] = { 1, 1 };
  const guint8 level = 255;
  gfloat light[256];

  light[255] = WHITE;
  return cloth_paint_new (&level, 1, 1, 1, 1, light, origin, size);
}

ClothPaint *
gst_cloth_paint_texture (const gchar * path, const gfloat * uv,
    guint n_vertices, GError ** error)
{
  gdouble low[2] = { G_MAXDOUBLE, G_MAXDOUBLE };
  gdouble high[2] = { -G_MAXDOUBLE, -G_MAXDOUBLE }, size[2];

  for (gsize i = 0; i < 2 * (gsize) n_vertices; i++) {
    low[i % 2] = MIN (low[i % 2], uv[i]);
    high[i % 2] = MAX (high[i % 2], uv[i]);
  }
  for (gint k = 0; k < 2; k++)
    size[k] = high[k] - low[k];
  if (!(size[0] > 0 && size[1] > 0)) {
    g_set_error (error, GST_STREAM_ERROR, GST_STREAM_ERROR_FORMAT,
        "the mesh has no uv coordinates to lay %s on: give it some, in metres",
        path);
    return NULL;
  }
  return paint_picture (path, low, size, error);
}
