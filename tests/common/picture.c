/* Grey pictures out of JPEG and PNG files, decoded by GStreamer.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/common/picture.h"

#include <gst/gst.h>
#include <gst/video/video.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

void
test_picture_init (gint * argc, gchar *** argv)
{
  gst_init (argc, argv);
}

TestPicture *
test_picture_new (gint width, gint height, guint8 grey)
{
  TestPicture *picture = g_new0 (TestPicture, 1);
  const gsize size = (gsize) width * (gsize) height;

  picture->data = g_malloc (size);
  memset (picture->data, grey, size);
  picture->image = (ClothImage) {
  picture->data, width, height, width};
  return picture;
}

TestPicture *
test_picture_load (const gchar * path)
{
  g_autoptr (GError) error = NULL;
  g_autofree gchar *line = g_strdup_printf ("filesrc location=\"%s\" ! %s "
      "! videoconvert ! video/x-raw,format=GRAY8 ! fakesink name=sink "
      "sync=false", path,
      g_str_has_suffix (path, ".png") ? "pngdec" : "jpegdec");
  GstElement *pipeline = gst_parse_launch (line, &error), *sink;
  GstSample *sample = NULL;
  GstMessage *message;
  GstBus *bus;
  GstVideoFrame frame;
  GstVideoInfo info;
  TestPicture *picture;

  g_assert_no_error (error);
  bus = gst_element_get_bus (pipeline);
  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  message = gst_bus_timed_pop_filtered (bus, 60 * GST_SECOND,
      GST_MESSAGE_EOS | GST_MESSAGE_ERROR);
  g_assert_nonnull (message);
  if (GST_MESSAGE_TYPE (message) == GST_MESSAGE_ERROR)
    g_error ("can't decode %s", path);
  gst_message_unref (message);
  sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");
  g_object_get (sink, "last-sample", &sample, NULL);
  g_assert_nonnull (sample);
  gst_video_info_from_caps (&info, gst_sample_get_caps (sample));
  g_assert_true (gst_video_frame_map (&frame, &info,
          gst_sample_get_buffer (sample), GST_MAP_READ));
  picture = test_picture_new (info.width, info.height, 0);
  for (gint y = 0; y < info.height; y++)
    memcpy (picture->data + y * info.width,
        (guint8 *) GST_VIDEO_FRAME_COMP_DATA (&frame, 0)
        + y * GST_VIDEO_FRAME_COMP_STRIDE (&frame, 0), (gsize) info.width);
  gst_video_frame_unmap (&frame);
  gst_sample_unref (sample);
  gst_object_unref (sink);
  gst_object_unref (bus);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (pipeline);
  return picture;
}

TestPicture *
test_picture_copy (const TestPicture * picture)
{
  TestPicture *copy = test_picture_new (picture->image.width,
      picture->image.height, 0);

  memcpy (copy->data, picture->data, (gsize) picture->image.width
      * (gsize) picture->image.height);
  return copy;
}

/* @grey: < 0: every 3×3 pixels another grey */
void
test_picture_disc (TestPicture * picture, gdouble x, gdouble y, gdouble radius,
    gint grey, guint32 seed)
{
  const gint width = picture->image.width, height = picture->image.height;

  for (gint row = (gint) MAX (0, y - radius); row < height
      && row <= y + radius; row++)
    for (gint column = (gint) MAX (0, x - radius); column < width
        && column <= x + radius; column++) {
      guint32 hash = (guint32) column / 3 * 73856093u ^ (guint32) row / 3
          * 19349663u ^ seed;

      if (hypot (column - x, row - y) > radius)
        continue;
      hash = (hash ^ (hash >> 13)) * 1274126177u;
      picture->data[row * width + column] =
          grey < 0 ? (guint8) (hash >> 24) : (guint8) grey;
    }
}

/* For the eye: run with CLOTH_TEST_PICTURES=folder. */
void
test_picture_keep (const gchar * name, const guint8 * data, gint width,
    gint height)
{
  const gchar *folder = g_getenv ("CLOTH_TEST_PICTURES");
  g_autofree gchar *path = NULL;
  FILE *file;

  if (!folder)
    return;
  path = g_build_filename (folder, name, NULL);
  file = fopen (path, "wb");
  g_assert_nonnull (file);
  fprintf (file, "P5 %d %d 255\n", width, height);
  fwrite (data, 1, (gsize) width * (gsize) height, file);
  fclose (file);
}

void
test_picture_free (TestPicture * picture)
{
  g_free (picture->data);
  g_free (picture);
}
