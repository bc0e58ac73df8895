/* Follows a checkerboard in a film and prints what was found in each picture.
 *
 *   preview FILM PATTERN          FILM: any film; PATTERN: its pattern.json
 *   preview FILM PATTERN show     the same, and shows the film with the squares drawn in
 *
 * Built against the installed library alone: see meson.build and CMakeLists.txt beside it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/cloth/cloth.h>

/* Called in the streaming thread for each picture that leaves quadtrack. */
static GstPadProbeReturn
picture_passes (GstPad * pad, GstPadProbeInfo * info, gpointer data)
{
  guint *n_pictures = data;
  GstBuffer *buffer = GST_PAD_PROBE_INFO_BUFFER (info);
  GstClothQuads *quads = gst_buffer_get_cloth_quads (buffer);
  const GstClothQuad *quad;
  guint n = 0, n_tracked = 0;
  gdouble confidence = 0;

  /* Without metadata nobody looked; with empty metadata nothing was there. */
  quad = quads ? gst_cloth_quads_get_quads (quads, &n) : NULL;
  for (guint i = 0; i < n; i++) {
    if (quad[i].state != GST_CLOTH_QUAD_TRACKED)
      continue;
    n_tracked++;
    confidence += quad[i].confidence;
  }
  g_print ("%3u  %.3f s  %2u squares, confidence %.2f\n", (*n_pictures)++,
      (gdouble) GST_BUFFER_PTS (buffer) / GST_SECOND, n_tracked,
      n_tracked > 0 ? confidence / n_tracked : 0);
  return GST_PAD_PROBE_OK;
}

/* FALSE after an error. It is printed, and so are warnings: of late pictures, of another print
 * than was said. */
static gboolean
play (GstElement * pipeline)
{
  GstBus *bus = gst_element_get_bus (pipeline);
  gboolean good = TRUE, going_on = TRUE;

  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  while (going_on) {
    GstMessage *message = gst_bus_timed_pop_filtered (bus, GST_CLOCK_TIME_NONE,
        GST_MESSAGE_EOS | GST_MESSAGE_ERROR | GST_MESSAGE_WARNING);
    GError *error = NULL;
    gchar *debug = NULL;

    if (GST_MESSAGE_TYPE (message) == GST_MESSAGE_WARNING) {
      gst_message_parse_warning (message, &error, &debug);
    } else {
      going_on = FALSE;
      good = GST_MESSAGE_TYPE (message) == GST_MESSAGE_EOS;
      if (!good)
        gst_message_parse_error (message, &error, &debug);
    }
    if (error)
      g_printerr ("%s\n%s\n", error->message, debug ? debug : "");
    g_clear_error (&error);
    g_free (debug);
    gst_message_unref (message);
  }
  gst_object_unref (bus);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  return good;
}

int
main (int argc, char **argv)
{
  GstElement *pipeline, *film, *track;
  GError *error = NULL;
  GstPad *pad;
  guint n_pictures = 0;
  gboolean good;

  gst_init (&argc, &argv);
  if (argc < 3) {
    g_printerr ("usage: preview FILM PATTERN [show]\n");
    return 2;
  }
  pipeline = gst_parse_launch (argc > 3 ?
      "filesrc name=film ! decodebin ! videoconvert ! saddledetect "
      "! quadtrack name=track ! clothoverlay ! videoconvert ! autovideosink" :
      "filesrc name=film ! decodebin ! videoconvert ! saddledetect "
      "! quadtrack name=track ! fakesink", &error);
  if (!pipeline) {
    g_printerr ("%s\nDoes GST_PLUGIN_PATH lead to the plugin?\n",
        error->message);
    g_error_free (error);
    return 1;
  }
  film = gst_bin_get_by_name (GST_BIN (pipeline), "film");
  track = gst_bin_get_by_name (GST_BIN (pipeline), "track");
  g_object_set (film, "location", argv[1], NULL);
  g_object_set (track, "pattern", argv[2], NULL);
  pad = gst_element_get_static_pad (track, "src");
  gst_pad_add_probe (pad, GST_PAD_PROBE_TYPE_BUFFER, picture_passes,
      &n_pictures, NULL);
  good = play (pipeline);
  gst_object_unref (pad);
  gst_object_unref (track);
  gst_object_unref (film);
  gst_object_unref (pipeline);
  return good ? 0 : 1;
}
