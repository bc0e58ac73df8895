/* The luma of a film as the decoder gives it, as the elements would see it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/common/luma.h"

#include <gst/app/gstappsink.h>
#include <gst/video/video.h>
#include <string.h>

/* For one picture, before the decoder counts as stuck. */
#define PATIENCE (60 * GST_SECOND)

static void
take_picture (GstSample * sample, gint width, gint height, guint8 * to)
{
  GstVideoFrame frame;
  GstVideoInfo info;

  g_assert_true (gst_video_info_from_caps (&info,
          gst_sample_get_caps (sample)));
  g_assert_true (gst_video_frame_map (&frame, &info,
          gst_sample_get_buffer (sample), GST_MAP_READ));
  g_assert_cmpint (GST_VIDEO_FRAME_WIDTH (&frame), ==, width);
  g_assert_cmpint (GST_VIDEO_FRAME_HEIGHT (&frame), ==, height);
  for (gint y = 0; y < height; y++)
    memcpy (to + y * width, (const guint8 *) GST_VIDEO_FRAME_PLANE_DATA (&frame,
            0) + y * GST_VIDEO_FRAME_PLANE_STRIDE (&frame, 0), (gsize) width);
  gst_video_frame_unmap (&frame);
}

guint8 *
test_luma_decode (const gchar * path, gint width, gint height, guint n_frames)
{
  g_autofree gchar *launch = g_strdup_printf ("filesrc location=\"%s\" ! "
      "qtdemux ! h264parse ! avdec_h264 ! video/x-raw,format=I420 ! "
      "appsink name=sink sync=false", path);
  const gsize size = (gsize) width * (gsize) height;
  g_autoptr (GError) error = NULL;
  GstElement *pipeline = gst_parse_launch (launch, &error);
  g_autoptr (GstElement) sink = NULL;
  guint8 *luma = g_malloc (size * n_frames);
  GstSample *sample;
  guint n = 0;

  g_assert_no_error (error);
  sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");
  g_assert_cmpint (gst_element_set_state (pipeline, GST_STATE_PLAYING), !=,
      GST_STATE_CHANGE_FAILURE);
  while ((sample = gst_app_sink_try_pull_sample (GST_APP_SINK (sink),
              PATIENCE))) {
    g_assert_cmpuint (n, <, n_frames);
    take_picture (sample, width, height, luma + size * n++);
    gst_sample_unref (sample);
  }
  g_assert_cmpuint (n, ==, n_frames);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (pipeline);
  return luma;
}
