/* A picture from any file.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "elements/gstclothpicture.h"

#include <gio/gio.h>
#include <gst/video/video.h>

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
