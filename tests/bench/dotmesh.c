/* Speed from pictures to mesh: eight decoded pictures of 1004×1004 in memory, through
 * dotlabel, triangulate and meshfill: of the path-traced cloth with 1,023 dots, of a skirt
 * with 3,500 that the cameras stand around, and of a sheet with as many that all of them see
 * whole. Each camera has a thread, as in a pipeline that films. Memory is read before and
 * after.
 *
 * Usage: bench-dotmesh [SETS]
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <glib/gstdio.h>
#include <gst/cloth/cloth.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "tests/bench/dotfilm.h"

#define RING TEST_DATA "/dots_ring8/"
#define N_CAMERAS DOT_FILM_CAMERAS
#define PATIENCE (60 * GST_SECOND)

/* What is filmed, and what says so. */
typedef struct
{
  const gchar *name;
  gchar *pattern, *rig;
  GstSample *pictures[N_CAMERAS][DOT_FILM_LENGTH];
  guint length;
} Film;

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
  GstSample **pictures;
  guint length, n_sets;
} Feed;

static gpointer
feed (gpointer data)
{
  Feed *self = data;
  GstFlowReturn flow = GST_FLOW_OK;

  for (guint i = 0; i < self->n_sets && flow == GST_FLOW_OK; i++) {
    /* To the end and back: the cloth never jumps. */
    const guint turn = MAX (1, 2 * (self->length - 1)), k = i % turn;
    GstSample *picture = self->pictures[MIN (k, turn - k) % self->length];
    GstBuffer *buffer = gst_buffer_copy (gst_sample_get_buffer (picture));

    GST_BUFFER_PTS (buffer) = i * 40 * GST_MSECOND;
    GST_BUFFER_DURATION (buffer) = 40 * GST_MSECOND;
    GST_BUFFER_OFFSET (buffer) = i;
    g_signal_emit_by_name (self->source, "push-buffer", buffer, &flow);
    gst_buffer_unref (buffer);
  }
  g_signal_emit_by_name (self->source, "end-of-stream", &flow);
  return NULL;
}

/* How many vertices of a mesh were measured, and how many have a place. */
static void
count (GstSample * sample, guint * measured, guint * placed, guint * all)
{
  g_autoptr (GstClothMesh) mesh =
      gst_cloth_mesh_from_buffer (gst_sample_get_buffer (sample), NULL);
  const guint8 *states;

  *measured = *placed = *all = 0;
  if (!mesh)
    return;
  states = gst_cloth_mesh_get_states (mesh, all);
  for (guint i = 0; i < *all; i++) {
    *measured += states[i] == GST_CLOTH_VERTEX_MEASURED
        || states[i] == GST_CLOTH_VERTEX_TWO_VIEWS;
    *placed += states[i] != GST_CLOTH_VERTEX_UNSEEN;
  }
}

static gboolean
run (Film * film, const gchar * what, const gchar * after, guint n_sets)
{
  g_autoptr (GString) line = g_string_new (NULL);
  g_autoptr (GError) error = NULL;
  GstElement *pipeline, *sink;
  GThread *threads[N_CAMERAS];
  Feed feeds[N_CAMERAS];
  gint64 start = 0;
  gdouble memory = 0;
  clock_t work = 0;
  guint n = 0, measured = 0, placed = 0, all = 0;

  g_string_append_printf (line, "triangulate name=join rig=\"%s\" "
      "pattern=\"%s\" %s ! appsink name=sink sync=false", film->rig,
      film->pattern, after);
  for (guint i = 0; i < N_CAMERAS; i++)
    g_string_append_printf (line, " appsrc name=s%u format=time block=true "
        "max-buffers=2 max-bytes=0 ! dotlabel camera=cam%u pattern=\"%s\" ! "
        "queue max-size-buffers=2 ! join.", i, i, film->pattern);
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
    feeds[i].pictures = film->pictures[i];
    feeds[i].length = film->length;
    feeds[i].n_sets = n_sets;
    g_object_set (feeds[i].source, "caps",
        gst_sample_get_caps (film->pictures[i][0]), NULL);
    threads[i] = g_thread_new (name, feed, &feeds[i]);
  }
  while (TRUE) {
    g_autoptr (GstSample) mesh = NULL;

    g_signal_emit_by_name (sink, "try-pull-sample", PATIENCE, &mesh);
    if (!mesh)
      break;
    count (mesh, &measured, &placed, &all);
    /* the first sets find their error floor and their memory */
    if (++n == 5) {
      start = g_get_monotonic_time ();
      work = clock ();
      memory = resident ();
    }
  }
  if (n > 5)
    printf
        ("  to %-18s %5.1f sets/s over %u sets, %4.1f ms of processor a set; "
        "at last %u of %u vertices measured, %u with a place; memory %.1f MB, "
        "after set 5 %.1f MB\n", what,
        1e6 * (n - 5) / (gdouble) (g_get_monotonic_time () - start), n,
        1e3 * (gdouble) (clock () - work) / CLOCKS_PER_SEC / (n - 5), measured,
        all, placed, resident (), memory);
  else
    printf ("  to %s: no mesh came out\n", what);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  for (guint i = 0; i < N_CAMERAS; i++) {
    g_thread_join (threads[i]);
    gst_object_unref (feeds[i].source);
  }
  gst_object_unref (sink);
  gst_object_unref (pipeline);
  return n > 5;
}

static gboolean
run_all (Film * film, guint n_sets)
{
  gboolean good;

  printf ("%s\n", film->name);
  good = run (film, "triangulated mesh", "", n_sets)
      && run (film, "filled mesh", "! meshfill", n_sets);
  for (guint i = 0; i < N_CAMERAS; i++)
    for (guint k = 0; k < film->length; k++)
      gst_sample_unref (film->pictures[i][k]);
  g_free (film->pattern);
  g_free (film->rig);
  return good;
}

static gboolean
run_traced (guint n_sets)
{
  Film film = { "path-traced cloth", g_strdup (RING "pattern.json"),
    g_strdup (RING "rig8.json")
  };

  film.length = 1;
  for (guint i = 0; i < N_CAMERAS; i++) {
    film.pictures[i][0] = decode (i);
    if (!film.pictures[i][0]) {
      printf ("cam%u.mp4 can't be decoded: is there an H.264 decoder?\n", i);
      return FALSE;
    }
  }
  return run_all (&film, n_sets);
}

static gboolean
run_drawn (DotFilmCloth cloth, const gchar * name, guint n_sets)
{
  g_autoptr (GError) error = NULL;
  g_autofree gchar *folder = g_dir_make_tmp ("dotmesh-XXXXXX", &error);
  Film film = { name };
  gboolean good;

  if (!folder || !dot_film_draw (cloth, folder, film.pictures, &error)) {
    printf ("%s: %s\n", name, error->message);
    return FALSE;
  }
  film.length = DOT_FILM_LENGTH;
  film.pattern = g_build_filename (folder, "pattern.json", NULL);
  film.rig = g_build_filename (folder, "rig.json", NULL);
  {
    g_autofree gchar *pattern = g_strdup (film.pattern);
    g_autofree gchar *rig = g_strdup (film.rig);

    good = run_all (&film, n_sets);
    g_remove (pattern);
    g_remove (rig);
  }
  g_rmdir (folder);
  return good;
}

int
main (int argc, char **argv)
{
  guint n_sets;
  gboolean good;

  gst_init (&argc, &argv);
  n_sets = argc > 1 ? (guint) atoi (argv[1]) : 200;
  good = run_traced (n_sets);
  good &= run_drawn (DOT_FILM_SKIRT, "skirt, cameras around it", n_sets);
  good &=
      run_drawn (DOT_FILM_SHEET, "sheet, seen whole by all cameras", n_sets);
  return good ? 0 : 1;
}
