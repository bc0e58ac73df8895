/* Memory through 10,000 sets of pictures from eight cameras: dots, labels, points in space,
 * filled mesh. The pictures are the path-traced ones, of which the middle is cut out, so
 * that a set takes little time; now and then a camera sees nothing, so that holes come and
 * go.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/elements/dotringscene.h"

#include <glib/gstdio.h>
#include <gst/cloth/cloth.h>
#include <unistd.h>

#define N_CAMERAS 8
#define N_SETS 10000
#define WARM 1000
#define SIDE 320
#define CUT_X 342
#define CUT_Y 402
/* One camera in turn sees nothing in each set of this number. */
#define BLIND 7
#define MOST_GROWTH_MB 4.0

/* Resident memory, MB. */
static gdouble
resident (void)
{
  g_autofree gchar *text = NULL;
  g_auto (GStrv) words = NULL;

  fail_unless (g_file_get_contents ("/proc/self/statm", &text, NULL, NULL));
  words = g_strsplit (text, " ", 3);
  return g_ascii_strtod (words[1], NULL) * (gdouble) sysconf (_SC_PAGESIZE)
      / 1e6;
}

/* The middle of a picture, I420. */
static GstBuffer *
cut_out (GstSample * sample)
{
  GstBuffer *buffer = gst_buffer_new_allocate (NULL, SIDE * SIDE * 3 / 2, NULL);
  GstVideoInfo from, to;
  GstVideoFrame in, out;

  fail_unless (gst_video_info_from_caps (&from, gst_sample_get_caps (sample)));
  gst_video_info_set_format (&to, GST_VIDEO_FORMAT_I420, SIDE, SIDE);
  fail_unless (gst_video_frame_map (&in, &from, gst_sample_get_buffer (sample),
          GST_MAP_READ));
  fail_unless (gst_video_frame_map (&out, &to, buffer, GST_MAP_WRITE));
  for (guint k = 0; k < 3; k++) {
    const gint part = k > 0 ? 2 : 1;

    for (gint y = 0; y < SIDE / part; y++)
      memcpy ((guint8 *) GST_VIDEO_FRAME_PLANE_DATA (&out, k)
          + y * GST_VIDEO_FRAME_PLANE_STRIDE (&out, k),
          (guint8 *) GST_VIDEO_FRAME_PLANE_DATA (&in, k)
          + (y + CUT_Y / part) * GST_VIDEO_FRAME_PLANE_STRIDE (&in, k)
          + CUT_X / part, (gsize) (SIDE / part));
  }
  gst_video_frame_unmap (&in);
  gst_video_frame_unmap (&out);
  return buffer;
}

/* The cameras of the pictures cut out. */
static void
save_rig (const gchar * path)
{
  g_autoptr (GError) error = NULL;
  ClothRig *rig = cloth_rig_load (RING "rig8.json", &error);

  g_assert_no_error (error);
  for (guint i = 0; i < rig->n_cameras; i++) {
    rig->cameras[i].width = rig->cameras[i].height = SIDE;
    rig->cameras[i].K[2] -= CUT_X;
    rig->cameras[i].K[5] -= CUT_Y;
  }
  fail_unless (cloth_rig_save (rig, path, &error));
  cloth_rig_free (rig);
}

typedef struct
{
  GstElement *source;
  GstBuffer *picture, *black;
  guint camera;
} Feed;

static gpointer
feed (gpointer data)
{
  Feed *self = data;
  GstFlowReturn flow = GST_FLOW_OK;

  for (guint i = 0; i < N_SETS && flow == GST_FLOW_OK; i++) {
    const gboolean blind = i % BLIND == 0 && i / BLIND % N_CAMERAS
        == self->camera;
    GstBuffer *buffer = gst_buffer_copy (blind ? self->black : self->picture);

    GST_BUFFER_PTS (buffer) = i * 40 * GST_MSECOND;
    GST_BUFFER_DURATION (buffer) = 40 * GST_MSECOND;
    GST_BUFFER_OFFSET (buffer) = i;
    g_signal_emit_by_name (self->source, "push-buffer", buffer, &flow);
    gst_buffer_unref (buffer);
  }
  g_signal_emit_by_name (self->source, "end-of-stream", &flow);
  return NULL;
}

GST_START_TEST (test_memory)
{
  g_autofree gchar *folder = g_dir_make_tmp ("dotsoak-XXXXXX", NULL);
  g_autofree gchar *rig = g_build_filename (folder, "rig.json", NULL);
  g_autoptr (GString) line = g_string_new (NULL);
  g_autoptr (GError) error = NULL;
  g_autoptr (GstElement) pipeline = NULL;
  g_autoptr (GstElement) sink = NULL;
  GThread *threads[N_CAMERAS];
  Feed feeds[N_CAMERAS];
  gdouble warm = 0, end;
  guint n = 0, least = G_MAXUINT;

  save_rig (rig);
  g_string_printf (line, "triangulate name=join rig=\"%s\" pattern=\"" RING
      "pattern.json\" ! meshfill ! appsink name=sink sync=false max-buffers=2",
      rig);
  for (guint i = 0; i < N_CAMERAS; i++)
    g_string_append_printf (line, " appsrc name=s%u format=time block=true "
        "max-buffers=2 max-bytes=0 caps=video/x-raw,format=I420,width=%d,"
        "height=%d,framerate=25/1,colorimetry=bt709 ! dotlabel camera=cam%u "
        "pattern=\"" RING "pattern.json\" ! queue max-size-buffers=2 ! join.",
        i, SIDE, SIDE, i);
  pipeline = gst_parse_launch (line->str, &error);
  g_assert_no_error (error);
  sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");
  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  for (guint i = 0; i < N_CAMERAS; i++) {
    g_autofree gchar *name = g_strdup_printf ("s%u", i);
    g_autofree gchar *camera = g_strdup_printf ("cam%u", i);
    g_autoptr (GstSample) sample = ring_picture (camera);

    feeds[i].source = gst_bin_get_by_name (GST_BIN (pipeline), name);
    feeds[i].picture = cut_out (sample);
    feeds[i].black = gst_buffer_copy_deep (feeds[i].picture);
    gst_buffer_memset (feeds[i].black, 0, 16, SIDE * SIDE);
    gst_buffer_memset (feeds[i].black, SIDE * SIDE, 128, -1);
    feeds[i].camera = i;
  }
  for (guint i = 0; i < N_CAMERAS; i++)
    threads[i] = g_thread_new ("feed", feed, &feeds[i]);
  while (TRUE) {
    g_autoptr (GstSample) sample = NULL;
    g_autoptr (GstClothMesh) mesh = NULL;
    const guint8 *states;
    guint n_measured = 0;

    g_signal_emit_by_name (sink, "try-pull-sample", 60 * GST_SECOND, &sample);
    if (!sample)
      break;
    mesh = gst_cloth_mesh_from_buffer (gst_sample_get_buffer (sample), &error);
    g_assert_no_error (error);
    states = gst_cloth_mesh_get_states (mesh, NULL);
    for (guint i = 0; i < gst_cloth_mesh_get_n_vertices (mesh); i++)
      n_measured += states[i] == GST_CLOTH_VERTEX_MEASURED
          || states[i] == GST_CLOTH_VERTEX_TWO_VIEWS;
    least = MIN (least, n_measured);
    if (++n == WARM)
      warm = resident ();
    if (n % 1000 == 0)
      g_test_message ("%u sets: %.1f MB", n, resident ());
  }
  end = resident ();
  g_test_message ("%u sets, at least %u vertices measured; %.1f MB after %u, "
      "%.1f MB at the end", n, least, warm, WARM, end);
  fail_unless_equals_int (n, N_SETS);
  fail_unless (least > 50, "%u", least);
  fail_unless (end - warm < MOST_GROWTH_MB, "%.1f MB", end - warm);
  for (guint i = 0; i < N_CAMERAS; i++) {
    g_thread_join (threads[i]);
    gst_object_unref (feeds[i].source);
    gst_buffer_unref (feeds[i].picture);
    gst_buffer_unref (feeds[i].black);
  }
  gst_element_set_state (pipeline, GST_STATE_NULL);
  g_remove (rig);
  g_rmdir (folder);
}

GST_END_TEST;

static Suite *
dotsoak_suite (void)
{
  Suite *s = suite_create ("dotsoak");
  TCase *tc = tcase_create ("general");

  suite_add_tcase (s, tc);
  tcase_set_timeout (tc, 1800);
  tcase_add_test (tc, test_memory);
  return s;
}

GST_CHECK_MAIN (dotsoak);
