/* Speed from pictures to mesh: eight decoded pictures of 1004×1004 in memory, of the
 * path-traced cloth with dots, through dotlabel, triangulate and meshfill. Each camera has
 * a thread, as in a pipeline that films. Memory is read before and after.
 *
 * Usage: bench-dotmesh [SETS]
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/gst.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define RING TEST_DATA "/dots_ring8/"
#define N_CAMERAS 8
#define PATIENCE (60 * GST_SECOND)

static GstSample *
decode (guint camera)
{
  g_autofree gchar *line = g_strdup_printf ("filesrc location=\"" RING
      "cam%u.mp4\" ! qtdemux ! h264parse ! avdec_h264 ! "
      "video/x-raw,format=I420 ! appsink name=sink sync=false", camera);
  GstElement *pipeline = gst_parse_launch (line, NULL);
  GstElement *sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");
  GstSample *sample = NULL;

  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  g_signal_emit_by_name (sink, "try-pull-sample", PATIENCE, &sample);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (sink);
  gst_object_unref (pipeline);
  return sample;
}

/* Resident memory, MB. */
static gdouble
resident (void)
{
  g_autofree gchar *text = NULL;
  g_auto (GStrv) words = NULL;

  if (!g_file_get_contents ("/proc/self/statm", &text, NULL, NULL))
    return 0;
  words = g_strsplit (text, " ", 3);
  return g_ascii_strtod (words[1], NULL) * 4096 / 1e6;
}

typedef struct
{
  GstElement *source;
  GstSample *sample;
  guint n_sets;
} Feed;

static gpointer
feed (gpointer data)
{
  Feed *self = data;
  GstFlowReturn flow = GST_FLOW_OK;

  for (guint i = 0; i < self->n_sets && flow == GST_FLOW_OK; i++) {
    GstBuffer *buffer = gst_buffer_copy (gst_sample_get_buffer (self->sample));

    GST_BUFFER_PTS (buffer) = i * 40 * GST_MSECOND;
    GST_BUFFER_DURATION (buffer) = 40 * GST_MSECOND;
    GST_BUFFER_OFFSET (buffer) = i;
    g_signal_emit_by_name (self->source, "push-buffer", buffer, &flow);
    gst_buffer_unref (buffer);
  }
  g_signal_emit_by_name (self->source, "end-of-stream", &flow);
  return NULL;
}

static gboolean
run (const gchar * what, const gchar * after, GstSample ** samples,
    guint n_sets)
{
  g_autoptr (GString) line = g_string_new (after);
  g_autoptr (GError) error = NULL;
  GstElement *pipeline, *sink;
  GThread *threads[N_CAMERAS];
  Feed feeds[N_CAMERAS];
  gint64 start = 0;
  gdouble memory = 0;
  clock_t work = 0;
  guint n = 0;

  for (guint i = 0; i < N_CAMERAS; i++)
    g_string_append_printf (line, " appsrc name=s%u format=time block=true "
        "max-buffers=2 max-bytes=0 ! dotlabel camera=cam%u pattern=\"" RING
        "pattern.json\" ! queue max-size-buffers=2 ! join.", i, i);
  pipeline = gst_parse_launch (line->str, &error);
  if (!pipeline || error) {
    printf ("%s: %s\n", what, error->message);
    return FALSE;
  }
  sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");
  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  for (guint i = 0; i < N_CAMERAS; i++) {
    g_autofree gchar *name = g_strdup_printf ("s%u", i);

    feeds[i].source = gst_bin_get_by_name (GST_BIN (pipeline), name);
    feeds[i].sample = samples[i];
    feeds[i].n_sets = n_sets;
    g_object_set (feeds[i].source, "caps", gst_sample_get_caps (samples[i]),
        NULL);
    threads[i] = g_thread_new (name, feed, &feeds[i]);
  }
  while (TRUE) {
    g_autoptr (GstSample) mesh = NULL;

    g_signal_emit_by_name (sink, "try-pull-sample", PATIENCE, &mesh);
    if (!mesh)
      break;
    /* the first sets find their error floor and their memory */
    if (++n == 5) {
      start = g_get_monotonic_time ();
      work = clock ();
      memory = resident ();
    }
  }
  if (n > 5)
    printf
        ("%-30s %5.1f sets/s over %u sets, %4.1f ms of processor a set; memory "
        "%.1f MB, after set 5 %.1f MB\n", what,
        1e6 * (n - 5) / (gdouble) (g_get_monotonic_time () - start), n,
        1e3 * (gdouble) (clock () - work) / CLOCKS_PER_SEC / (n - 5),
        resident (), memory);
  else
    printf ("%s: no mesh came out\n", what);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  for (guint i = 0; i < N_CAMERAS; i++) {
    g_thread_join (threads[i]);
    gst_object_unref (feeds[i].source);
  }
  gst_object_unref (sink);
  gst_object_unref (pipeline);
  return n > 5;
}

int
main (int argc, char **argv)
{
  const gchar *join = "triangulate name=join rig=\"" RING "rig8.json\" "
      "pattern=\"" RING "pattern.json\"";
  g_autofree gchar *bare = g_strconcat (join, " ! appsink name=sink "
      "sync=false", NULL);
  g_autofree gchar *filled = g_strconcat (join, " ! meshfill ! appsink "
      "name=sink sync=false", NULL);
  GstSample *samples[N_CAMERAS];
  guint n_sets;
  gboolean good;

  gst_init (&argc, &argv);
  n_sets = argc > 1 ? (guint) atoi (argv[1]) : 200;
  for (guint i = 0; i < N_CAMERAS; i++) {
    samples[i] = decode (i);
    if (!samples[i]) {
      printf ("cam%u.mp4 can't be decoded: is there an H.264 decoder?\n", i);
      return 1;
    }
  }
  good = run ("pictures to triangulated mesh", bare, samples, n_sets);
  if (gst_registry_check_feature_version (gst_registry_get (), "meshfill", 0, 1,
          0))
    good &= run ("pictures to filled mesh", filled, samples, n_sets);
  for (guint i = 0; i < N_CAMERAS; i++)
    gst_sample_unref (samples[i]);
  return good ? 0 : 1;
}
