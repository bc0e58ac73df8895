/* Grey pictures out of any file that GStreamer decodes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "frames.h"

#include <gio/gio.h>
#include <gst/app/gstappsink.h>
#include <gst/gst.h>
#include <gst/video/video.h>

/* A file that gives no picture for so long is broken. */
#define PATIENCE (30 * GST_SECOND)
#define MAX_SIZE 16384

/* Takes an error off the bus; TRUE when there is one. */
static gboolean
failed (GstBus * bus, const gchar * path, GError ** error)
{
  g_autoptr (GstMessage) message =
      gst_bus_pop_filtered (bus, GST_MESSAGE_ERROR);
  g_autoptr (GError) cause = NULL;

  if (!message)
    return FALSE;
  gst_message_parse_error (message, &cause, NULL);
  g_set_error (error, G_IO_ERROR, G_IO_ERROR_FAILED, "%s: %s", path,
      cause->message);
  return TRUE;
}

static gboolean
deliver (GstSample * sample, const gchar * path, guint number,
    ClothFrameFunc function, gpointer user_data, GError ** error)
{
  GstVideoInfo info;
  GstVideoFrame frame;
  ClothImage image;
  gboolean more;

  if (!gst_video_info_from_caps (&info, gst_sample_get_caps (sample))
      || info.width > MAX_SIZE || info.height > MAX_SIZE
      || !gst_video_frame_map (&frame, &info, gst_sample_get_buffer (sample),
          GST_MAP_READ)) {
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_FAILED,
        "%s: picture %u can't be used, or is larger than %d pixels", path,
        number, MAX_SIZE);
    return FALSE;
  }
  image.data = GST_VIDEO_FRAME_PLANE_DATA (&frame, 0);
  image.width = info.width;
  image.height = info.height;
  image.stride = GST_VIDEO_FRAME_PLANE_STRIDE (&frame, 0);
  more = function (&image, number, user_data, error);
  gst_video_frame_unmap (&frame);
  return more;
}

/* Reads on until the end, an error, or the function's FALSE. */
static gboolean
read_all (GstElement * pipeline, const gchar * path, guint every,
    ClothFrameFunc function, gpointer user_data, GError ** error)
{
  g_autoptr (GstElement) sink = gst_bin_get_by_name (GST_BIN (pipeline), "out");
  g_autoptr (GstBus) bus = gst_element_get_bus (pipeline);
  guint number = 0;
  GstClockTime waited = 0;

  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  for (;;) {
    g_autoptr (GstSample) sample =
        gst_app_sink_try_pull_sample (GST_APP_SINK (sink), 50 * GST_MSECOND);
    GError *stop = NULL;

    if (sample) {
      waited = 0;
      if (number++ % every == 0
          && !deliver (sample, path, number - 1, function, user_data, &stop)) {
        if (stop)
          g_propagate_error (error, stop);
        return stop == NULL;
      }
      continue;
    }
    if (failed (bus, path, error))
      return FALSE;
    if (gst_app_sink_is_eos (GST_APP_SINK (sink)))
      break;
    if ((waited += 50 * GST_MSECOND) >= PATIENCE) {
      g_set_error (error, G_IO_ERROR, G_IO_ERROR_TIMED_OUT,
          "%s: no picture in %d s", path, (gint) (PATIENCE / GST_SECOND));
      return FALSE;
    }
  }
  if (number == 0) {
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_FAILED, "%s: holds no picture",
        path);
    return FALSE;
  }
  return TRUE;
}

/* @path: a picture or a film
 * @every: takes each so many-th picture, the first included
 * @function: gets them
 * @user_data: for @function
 * @error: what is wrong with the file
 *
 * Decodes a file with GStreamer, turning to grey what is not.
 *
 * Returns: whether it was read to its end, or to where @function stopped it without error.
 */
gboolean
cloth_frames_read (const gchar * path, guint every, ClothFrameFunc function,
    gpointer user_data, GError ** error)
{
  g_autoptr (GstElement) pipeline = NULL;
  g_autoptr (GstElement) source = NULL;
  gboolean ok;

  if (!g_file_test (path, G_FILE_TEST_IS_REGULAR)) {
    g_set_error (error, G_FILE_ERROR, G_FILE_ERROR_NOENT,
        "%s: there is no such file", path);
    return FALSE;
  }
  /* else a missing element would leave both a pipeline and an error */
  pipeline = gst_parse_launch_full ("filesrc name=in ! decodebin ! "
      "videoconvert dither=none ! video/x-raw,format=GRAY8 ! appsink name=out "
      "sync=false max-buffers=4", NULL, GST_PARSE_FLAG_FATAL_ERRORS, error);
  if (!pipeline)
    return FALSE;
  source = gst_bin_get_by_name (GST_BIN (pipeline), "in");
  g_object_set (source, "location", path, NULL);
  ok = read_all (pipeline, path, every, function, user_data, error);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  return ok;
}
