/* Small pictures of what a calibration saw, as JPEG.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "calibrate-picture.h"

#include <gst/app/gstappsink.h>
#include <gst/app/gstappsrc.h>
#include <gst/gst.h>
#include <gst/video/video.h>
#include <string.h>

/* As wide as a page shows it. */
#define MOST_WIDTH 640

#define PATIENCE (10 * GST_SECOND)

struct _ClothPictureMaker
{
  GstElement *pipeline;
  gint width, height;
};

/* Returns: (transfer full) (nullable): a maker of pictures, or %NULL where GStreamer has no
 *   encoder for JPEG.
 */
ClothPictureMaker *
cloth_picture_maker_new (void)
{
  ClothPictureMaker *maker;
  GstElement *pipeline = gst_parse_launch_full ("appsrc name=in format=time ! "
      "videoscale ! capsfilter name=size ! jpegenc quality=75 ! "
      "appsink name=out sync=false", NULL, GST_PARSE_FLAG_FATAL_ERRORS, NULL);

  if (!pipeline)
    return NULL;
  maker = g_new0 (ClothPictureMaker, 1);
  maker->pipeline = pipeline;
  return maker;
}

/* @maker: (transfer full) (nullable): a maker
 */
void
cloth_picture_maker_free (ClothPictureMaker * maker)
{
  if (!maker)
    return;
  gst_element_set_state (maker->pipeline, GST_STATE_NULL);
  gst_object_unref (maker->pipeline);
  g_free (maker);
}

static void
start (ClothPictureMaker * maker, GstElement * source, const ClothImage * image)
{
  g_autoptr (GstElement) filter =
      gst_bin_get_by_name (GST_BIN (maker->pipeline), "size");
  gint width = MIN (image->width, MOST_WIDTH);
  gint height = MAX (1, (gint) ((gint64) image->height * width / image->width));
  g_autoptr (GstCaps) in = gst_caps_new_simple ("video/x-raw", "format",
      G_TYPE_STRING, "GRAY8", "width", G_TYPE_INT, image->width, "height",
      G_TYPE_INT, image->height, "framerate", GST_TYPE_FRACTION, 0, 1, NULL);
  g_autoptr (GstCaps) out = gst_caps_new_simple ("video/x-raw", "width",
      G_TYPE_INT, width, "height", G_TYPE_INT, height, NULL);

  maker->width = image->width;
  maker->height = image->height;
  g_object_set (source, "caps", in, NULL);
  g_object_set (filter, "caps", out, NULL);
  gst_element_set_state (maker->pipeline, GST_STATE_PLAYING);
}

/* @maker: a maker
 * @image: a picture, each time of the same size
 *
 * Returns: (transfer full) (nullable): the picture as JPEG, at most 640 pixels wide; %NULL
 *   when it couldn't be made.
 */
GBytes *
cloth_picture_maker_make (ClothPictureMaker * maker, const ClothImage * image)
{
  g_autoptr (GstElement) source =
      gst_bin_get_by_name (GST_BIN (maker->pipeline), "in");
  g_autoptr (GstElement) sink =
      gst_bin_get_by_name (GST_BIN (maker->pipeline), "out");
  g_autoptr (GstSample) sample = NULL;
  gsize stride = GST_ROUND_UP_4 ((gsize) image->width);
  GstBuffer *buffer;
  GstMapInfo map;
  GBytes *bytes;

  if (maker->width == 0)
    start (maker, source, image);
  else if (image->width != maker->width || image->height != maker->height)
    return NULL;
  buffer = gst_buffer_new_allocate (NULL, stride * image->height, NULL);
  gst_buffer_map (buffer, &map, GST_MAP_WRITE);
  memset (map.data, 0, map.size);
  for (gint y = 0; y < image->height; y++)
    memcpy (map.data + y * stride,
        image->data + (gsize) y * image->stride, image->width);
  gst_buffer_unmap (buffer, &map);
  if (gst_app_src_push_buffer (GST_APP_SRC (source), buffer) != GST_FLOW_OK)
    return NULL;
  sample = gst_app_sink_try_pull_sample (GST_APP_SINK (sink), PATIENCE);
  if (!sample || !gst_buffer_map (gst_sample_get_buffer (sample), &map,
          GST_MAP_READ))
    return NULL;
  bytes = g_bytes_new (map.data, map.size);
  gst_buffer_unmap (gst_sample_get_buffer (sample), &map);
  return bytes;
}
