/* From the rendered film to a take with observations, in one pipeline, and back: what is
 * read of them against the film's truth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <glib/gstdio.h>
#include <gst/gst.h>
#include <math.h>

#include "gst/cloth-io/observations.h"
#include "gst/take/take.h"
#include "tests/common/film.h"

#define FOLDER TEST_DATA "/checker_pair"
#define FPS 25.0
/* Of the corners that nothing hides, those of small and slanted squares among them. */
#define MOST_RMS_PX 0.2
#define LEAST_SEEN 0.85

#define CAMERA(n) " filesrc location=" FOLDER "/cam" #n ".mp4 ! qtdemux ! " \
    "h264parse ! avdec_h264 ! saddledetect ! quadtrack pattern=" FOLDER \
    "/pattern.json camera=cam" #n " ! tee name=t" #n " t" #n ". ! queue ! join. t" \
    #n ". ! queue ! clothmetapay ! filesink location=%s/observations/cam" #n ".obs"

static void
record (const gchar * folder)
{
  g_autofree gchar *observations = g_build_filename (folder, "observations",
      NULL);
  g_autofree gchar *rig = g_build_filename (folder, "rig.json", NULL);
  g_autofree gchar *bytes = NULL;
  g_autofree gchar *launch = g_strdup_printf ("triangulate name=join rig="
      FOLDER "/rig.json pattern=" FOLDER "/pattern.json ! meshsink format=take "
      "location=%s" CAMERA (0) CAMERA (1), folder, folder, folder);
  GError *error = NULL;
  GstElement *pipeline = gst_parse_launch (launch, &error);
  g_autoptr (GstBus) bus = NULL;
  g_autoptr (GstMessage) message = NULL;
  gsize size;

  g_assert_no_error (error);
  g_assert_cmpint (g_mkdir (observations, 0777), ==, 0);
  g_assert_true (g_file_get_contents (FOLDER "/rig.json", &bytes, &size,
          &error));
  g_assert_true (g_file_set_contents (rig, bytes, (gssize) size, &error));
  bus = gst_element_get_bus (pipeline);
  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  message = gst_bus_timed_pop_filtered (bus, 120 * GST_SECOND,
      GST_MESSAGE_EOS | GST_MESSAGE_ERROR);
  g_assert_nonnull (message);
  g_assert_cmpint (GST_MESSAGE_TYPE (message), ==, GST_MESSAGE_EOS);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (pipeline);
}

/* Whether the cloth around a corner faces the camera and nothing hides it; and where the
 * camera sees it, px. */
static gboolean
find_corner (const TestFilm * film, guint camera, guint frame, guint vertex,
    gdouble px[2])
{
  const gint columns = film->pattern->columns + 1;
  const gint column = (gint) vertex % columns, row = (gint) vertex / columns;

  for (gint k = 0; k < 4; k++) {
    /* the square whose corner @k it is, from the top left one clockwise */
    const gint i = column - (k == 1 || k == 2), j = row - (k >= 2);
    const TestFilmSquare *square;

    if (i < 0 || j < 0 || i >= film->pattern->columns
        || j >= film->pattern->rows)
      continue;
    square = test_film_square (film, camera, frame, i, j);
    px[0] = (gdouble) square->x[k];
    px[1] = (gdouble) square->y[k];
    return square->clear[k];
  }
  g_assert_not_reached ();
}

static void
check_points (const TestFilm * film, const ClothObservations * observations)
{
  guint n = 0, clear = 0, hidden = 0;
  gdouble sum = 0;

  for (guint k = 0; k < observations->list->len; k++) {
    const ClothObservation *observation =
        &g_array_index (observations->list, ClothObservation, k);
    const guint frame = (guint) floor (observation->time_s * FPS + 0.5);
    guint at = 0;

    g_assert_cmpuint (frame, <, film->n_frames);
    for (guint vertex = 0; vertex < observations->n_vertices; vertex++) {
      gboolean seen = at < observation->n
          && observation->vertices[at] == vertex;
      gdouble px[2];

      if (find_corner (film, observation->camera, frame, vertex, px)) {
        clear++;
        if (seen) {
          sum += (pow (observation->px[2 * at] - px[0], 2)
              + pow (observation->px[2 * at + 1] - px[1], 2)) / 2;
          n++;
        }
      } else {
        hidden += seen;
      }
      at += seen;
    }
  }
  g_test_message
      ("%u of %u clear corners, RMS %.3f px an axis; %u that are not " "clear",
      n, clear, sqrt (sum / n), hidden);
  g_assert_cmpfloat (n, >=, LEAST_SEEN * clear);
  g_assert_cmpfloat (sqrt (sum / n), <=, MOST_RMS_PX);
}

/* The film's first picture is at 80 ms: take and observations must agree on 0. */
static void
check_times (const ClothTake * take, const ClothObservations * observations)
{
  guint n[2] = { 0, 0 };

  for (guint k = 0; k < observations->list->len; k++) {
    const ClothObservation *observation =
        &g_array_index (observations->list, ClothObservation, k);
    guint frame = n[observation->camera]++;

    g_assert_cmpfloat_with_epsilon (observation->time_s,
        cloth_take_get_time (take, frame), 1e-9);
    g_assert_cmpfloat_with_epsilon (observation->time_s, frame / FPS, 1e-9);
  }
  g_assert_cmpuint (n[0], ==, cloth_take_get_n_frames (take));
  g_assert_cmpuint (n[1], ==, n[0]);
}

static void
remove_folder (const gchar * path)
{
  GDir *dir = g_dir_open (path, 0, NULL);
  const gchar *name;

  while (dir && (name = g_dir_read_name (dir))) {
    g_autofree gchar *inside = g_build_filename (path, name, NULL);

    remove_folder (inside);
  }
  if (dir)
    g_dir_close (dir);
  g_remove (path);
}

static void
test_film (void)
{
  GError *error = NULL;
  g_autofree gchar *folder = g_dir_make_tmp ("film-XXXXXX", &error);
  g_autoptr (TestFilm) film = test_film_load (FOLDER);
  g_autoptr (ClothTake) take = NULL;
  g_autoptr (ClothObservations) observations = NULL;

  g_assert_no_error (error);
  record (folder);
  take = cloth_take_open (folder, &error);
  g_assert_no_error (error);
  gst_cloth_io_observations_load (folder, NULL,
      cloth_take_get_topology (take), &observations, &error);
  g_assert_no_error (error);
  g_assert_nonnull (observations);
  check_points (film, observations);
  check_times (take, observations);
  remove_folder (folder);
}

int
main (int argc, char **argv)
{
  gst_init (&argc, &argv);
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/film/observations", test_film);
  return g_test_run ();
}
