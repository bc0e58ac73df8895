/* The motion of the rendered cloth, filmed anew by clothcamera and tracked: error against
 * truth, as for the path-traced film of the same motion.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <gst/app/gstappsink.h>
#include <gst/gst.h>
#include <math.h>
#include <string.h>

#include "tests/common/film.h"

#define FOLDER TEST_DATA "/checker_pair"
/* What is to be reached. */
#define LEAST_HIT 0.95
#define MOST_RMS_PX 0.15

static TestFilm *film;
static gchar *take;

static void
make_take (void)
{
  g_autofree gchar *about = NULL, *positions = NULL;
  g_autoptr (GFile) from = g_file_new_for_path (FOLDER "/vertices.npy");
  g_autoptr (GFile) to = NULL;
  GError *error = NULL;

  take = g_dir_make_tmp ("film-XXXXXX", &error);
  g_assert_no_error (error);
  about = g_build_filename (take, "take.json", NULL);
  positions = g_build_filename (take, "positions.npy", NULL);
  to = g_file_new_for_path (positions);
  g_assert_true (g_file_set_contents (about, "{\"version\":1,\"name\":\"film\","
          "\"fps\":25,\"grid\":{\"columns\":33,\"rows\":35,\"width_m\":0.63,"
          "\"height_m\":0.67}}", -1, &error));
  g_assert_true (g_file_copy (from, to, G_FILE_COPY_NONE, NULL, NULL, NULL,
          &error));
}

static void
remove_take (void)
{
  g_autofree gchar *about = g_build_filename (take, "take.json", NULL);
  g_autofree gchar *positions = g_build_filename (take, "positions.npy", NULL);

  g_remove (about);
  g_remove (positions);
  g_rmdir (take);
  g_free (take);
}

/* Puts clothcamera's pictures in place of the film's. */
static void
shoot (guint camera, const gchar * effects)
{
  g_autofree gchar *launch = g_strdup_printf ("meshsrc location=%s ! "
      "clothcamera rig=" FOLDER "/rig.json camera=cam%u pattern=" FOLDER
      "/pattern.json effects=\"%s\" ! video/x-raw,format=GRAY8 ! "
      "appsink name=out sync=false", take, camera, effects);
  GError *error = NULL;
  GstElement *pipeline = gst_parse_launch (launch, &error);
  g_autoptr (GstElement) sink = NULL;
  const gsize size = (gsize) film->width * (gsize) film->height;
  GstSample *sample;
  guint n = 0;

  g_assert_no_error (error);
  sink = gst_bin_get_by_name (GST_BIN (pipeline), "out");
  gst_element_set_state (pipeline, GST_STATE_PLAYING);
  while ((sample = gst_app_sink_pull_sample (GST_APP_SINK (sink)))) {
    GstBuffer *buffer = gst_sample_get_buffer (sample);

    g_assert_cmpuint (n, <, film->n_frames);
    g_assert_cmpuint (GST_BUFFER_PTS (buffer), ==, n * 40 * GST_MSECOND);
    g_assert_cmpuint (gst_buffer_extract (buffer, 0,
            film->luma[camera] + size * n++, size), ==, size);
    gst_sample_unref (sample);
  }
  g_assert_cmpuint (n, ==, film->n_frames);
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (pipeline);
}

static void
check (const gchar * effects, gdouble most_rms)
{
  TestFilmScore sum = { 0 };

  for (guint camera = 0; camera < TEST_FILM_CAMERAS; camera++) {
    shoot (camera, effects);
    test_film_track (film, camera, 0, NULL, &sum);
  }
  test_film_tell (effects, &sum);
  g_assert_cmpuint (sum.visible, >, 3000);
  g_assert_cmpuint (sum.hit, >=, (guint) ceil (LEAST_HIT * sum.visible));
  g_assert_cmpuint (sum.wrong, ==, 0);
  g_assert_cmpfloat (test_film_rms (&sum), <=, most_rms);
}

static void
test_clean (void)
{
  check ("defocus,sigma=0.6", MOST_RMS_PX);
}

static void
test_noisy (void)
{
  check ("defocus,sigma=0.6; noise,sigma=3,shot=2", MOST_RMS_PX);
}

/* A camera that is late by an interval films the mesh before: the error must show. */
static void
test_late (void)
{
  TestFilmScore sum = { 0 };

  shoot (0, "defocus,sigma=0.6; sync_offset,seconds=0.04");
  test_film_track (film, 0, 1, NULL, &sum);
  test_film_tell ("late by a frame, held against the frame before", &sum);
  g_assert_cmpfloat (test_film_rms (&sum), <=, MOST_RMS_PX);
}

int
main (int argc, char **argv)
{
  int result;

  gst_init (&argc, &argv);
  g_test_init (&argc, &argv, NULL);
  film = test_film_load (FOLDER);
  make_take ();
  g_test_add_func ("/film/synthetic/clean", test_clean);
  g_test_add_func ("/film/synthetic/noisy", test_noisy);
  g_test_add_func ("/film/synthetic/late", test_late);
  result = g_test_run ();
  remove_take ();
  test_film_free (film);
  return result;
}
