/* Grey pictures out of any file that GStreamer decodes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "frames.h"

#include <gio/gio.h>
#include <math.h>
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

struct _ClothFrameReader
{
  gchar *path;
  GstElement *pipeline, *sink;
  GstBus *bus;
  guint number;                 /* of the next picture */
  GstSample *sample;
  GstVideoFrame frame;          /* of it, mapped */
};

/* Gives back the picture that was handed out last. */
static void
give_back (ClothFrameReader * reader)
{
  if (!reader->sample)
    return;
  gst_video_frame_unmap (&reader->frame);
  g_clear_pointer (&reader->sample, gst_sample_unref);
}

/* Maps a sample, which it takes. */
static gboolean
hand_out (ClothFrameReader * reader, GstSample * sample, ClothImage * image,
    GError ** error)
{
  GstVideoInfo info;

  if (!gst_video_info_from_caps (&info, gst_sample_get_caps (sample))
      || info.width > MAX_SIZE || info.height > MAX_SIZE
      || !gst_video_frame_map (&reader->frame, &info,
          gst_sample_get_buffer (sample), GST_MAP_READ)) {
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_FAILED,
        "%s: picture %u can't be used, or is larger than %d pixels",
        reader->path, reader->number, MAX_SIZE);
    gst_sample_unref (sample);
    return FALSE;
  }
  reader->sample = sample;
  image->data = GST_VIDEO_FRAME_PLANE_DATA (&reader->frame, 0);
  image->width = info.width;
  image->height = info.height;
  image->stride = GST_VIDEO_FRAME_PLANE_STRIDE (&reader->frame, 0);
  reader->number++;
  return TRUE;
}

/* @path: a picture or a film
 * @error: what is wrong with the file
 *
 * Decodes a file with GStreamer, turning to grey what is not.
 *
 * Returns: (transfer full): its reader
 */
ClothFrameReader *
cloth_frame_reader_open (const gchar * path, GError ** error)
{
  ClothFrameReader *reader;
  GstElement *pipeline;
  g_autoptr (GstElement) source = NULL;

  if (!g_file_test (path, G_FILE_TEST_IS_REGULAR)) {
    g_set_error (error, G_FILE_ERROR, G_FILE_ERROR_NOENT,
        "%s: there is no such file", path);
    return NULL;
  }
  /* else a missing element would leave both a pipeline and an error */
  pipeline = gst_parse_launch_full ("filesrc name=in ! decodebin ! "
      "videoconvert dither=none ! video/x-raw,format=GRAY8 ! appsink name=out "
      "sync=false max-buffers=4", NULL, GST_PARSE_FLAG_FATAL_ERRORS, error);
  if (!pipeline)
    return NULL;
  source = gst_bin_get_by_name (GST_BIN (pipeline), "in");
  g_object_set (source, "location", path, NULL);
  reader = g_new0 (ClothFrameReader, 1);
  reader->path = g_strdup (path);
  reader->pipeline = pipeline;
  reader->sink = gst_bin_get_by_name (GST_BIN (pipeline), "out");
  reader->bus = gst_element_get_bus (pipeline);
  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  return reader;
}

/* @reader: (nullable) (transfer full): a reader
 */
void
cloth_frame_reader_free (ClothFrameReader * reader)
{
  if (!reader)
    return;
  give_back (reader);
  gst_element_set_state (reader->pipeline, GST_STATE_NULL);
  gst_object_unref (reader->bus);
  gst_object_unref (reader->sink);
  gst_object_unref (reader->pipeline);
  g_free (reader->path);
  g_free (reader);
}

/* @reader: a reader
 * @image: (out): the next picture, the reader's until the next call
 * @error: what is wrong with the file; not set at its end
 *
 * Returns: whether there is one
 */
gboolean
cloth_frame_reader_next (ClothFrameReader * reader, ClothImage * image,
    GError ** error)
{
  GstClockTime waited = 0;

  give_back (reader);
  for (;;) {
    GstSample *sample = gst_app_sink_try_pull_sample (GST_APP_SINK
        (reader->sink), 50 * GST_MSECOND);

    if (sample)
      return hand_out (reader, sample, image, error);
    if (failed (reader->bus, reader->path, error))
      return FALSE;
    if (gst_app_sink_is_eos (GST_APP_SINK (reader->sink)))
      break;
    if ((waited += 50 * GST_MSECOND) >= PATIENCE) {
      g_set_error (error, G_IO_ERROR, G_IO_ERROR_TIMED_OUT,
          "%s: no picture in %d s", reader->path,
          (gint) (PATIENCE / GST_SECOND));
      return FALSE;
    }
  }
  if (reader->number == 0)
    g_set_error (error, G_IO_ERROR, G_IO_ERROR_FAILED, "%s: holds no picture",
        reader->path);
  return FALSE;
}

/* @reader: a reader whose picture was handed out
 *
 * Returns: when that was filmed, from the film's beginning, s; NaN when the file doesn't say
 */
gdouble
cloth_frame_reader_get_time (const ClothFrameReader * reader)
{
  const GstBuffer *buffer = gst_sample_get_buffer (reader->sample);
  const GstClockTime time = gst_segment_to_stream_time
      (gst_sample_get_segment (reader->sample), GST_FORMAT_TIME,
      GST_BUFFER_PTS (buffer));

  return GST_CLOCK_TIME_IS_VALID (time) ? (gdouble) time / GST_SECOND : NAN;
}

/* @path: a picture or a film
 * @every: takes each so many-th picture, the first included
 * @function: gets them
 * @user_data: for @function
 * @error: what is wrong with the file
 *
 * Reads a whole file.
 *
 * Returns: whether it was read to its end, or to where @function stopped it without error.
 */
gboolean
cloth_frames_read (const gchar * path, guint every, ClothFrameFunc function,
    gpointer user_data, GError ** error)
{
  g_autoptr (ClothFrameReader) reader = cloth_frame_reader_open (path, error);
  GError *wrong = NULL;
  ClothImage image;

  if (!reader)
    return FALSE;
  for (guint number = 0; cloth_frame_reader_next (reader, &image, &wrong);
      number++)
    if (number % every == 0 && !function (&image, number, user_data, &wrong))
      break;
  if (wrong)
    g_propagate_error (error, wrong);
  return wrong == NULL;
}
