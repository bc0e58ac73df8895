/* Both cameras' films through the elements as they come, to points in space: held against
 * the true surface, and against the errors the points say they have.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/app/gstappsink.h>
#include <gst/cloth/cloth.h>
#include <gst/gst.h>
#include <math.h>

#include "tests/common/film.h"

#define FOLDER TEST_DATA "/checker_pair"
/* What is to be reached. */
#define MOST_RMS_MM 0.9
#define SIGMA_TOLERANCE 0.2
/* For one mesh, before the pipeline counts as stuck. */
#define PATIENCE (60 * GST_SECOND)
/* Of the corners of squares that both cameras see. */
#define LEAST_LOCATED 0.9

static TestFilm *film;

/* Whether a corner of the board can be seen, and whether a visible black square has it. */
static gboolean
is_clear (guint camera, guint frame, gint column, gint row, gboolean * printed)
{
  gboolean clear = FALSE;

  *printed = FALSE;
  for (gint k = 0; k < 4; k++) {
    const gint c = column - (k == 1 || k == 2), r = row - (k >= 2);
    const TestFilmSquare *square;

    if (c < 0 || r < 0 || c >= film->pattern->columns
        || r >= film->pattern->rows)
      continue;
    square = test_film_square (film, camera, frame, c, r);
    clear = square->clear[k];
    *printed |= square->visible && cloth_pattern_is_black (film->pattern, c, r);
  }
  return clear;
}

typedef struct
{
  guint n, visible, located;    /* the last two of those of visible black squares */
  gdouble sum2, variance, chi2;
} Errors;

static void
compare (guint frame, const GstClothMesh * mesh, Errors * errors)
{
  const gint across = film->pattern->columns + 1;
  const gint n = across * (film->pattern->rows + 1);
  guint n_floats;
  const gfloat *at = gst_cloth_mesh_get_positions (mesh, &n_floats);
  const gfloat *cov = gst_cloth_mesh_get_covariances (mesh, &n_floats);
  const gdouble *truth = film->corners + 3 * (gint) frame * n;

  g_assert_cmpuint (gst_cloth_mesh_get_n_vertices (mesh), ==, (guint) n);
  g_assert_nonnull (cov);
  for (gint k = 0; k < n; k++, at += 3, cov += 6, truth += 3) {
    gdouble error2 = 0, variance = cov[0] + cov[3] + cov[5];
    gboolean printed[2];

    if (!is_clear (0, frame, k % across, k / across, &printed[0])
        || !is_clear (1, frame, k % across, k / across, &printed[1]))
      continue;
    errors->visible += printed[0] && printed[1];
    if (isnan (at[0]))
      continue;
    errors->located += printed[0] && printed[1];
    for (gint i = 0; i < 3; i++)
      error2 += (at[i] - truth[i]) * (at[i] - truth[i]);
    errors->n++;
    errors->sum2 += error2;
    errors->variance += variance;
    errors->chi2 += error2 / variance;
    if (error2 > 16e-6)
      g_test_message ("frame %u vertex (%d, %d) is %.1f mm off, says %.1f mm",
          frame, k % across, k / across, 1e3 * sqrt (error2),
          1e3 * sqrt (variance));
  }
}

/* The error is the root of the mean squared distance from the truth; it is predicted as
 * the root of the mean trace of the covariances. */
static void
check_mesh (void)
{
  g_autoptr (GError) error = NULL;
  GstElement *pipeline = gst_parse_launch ("triangulate name=join rig=" FOLDER
      "/rig.json pattern=" FOLDER
      "/pattern.json ! appsink name=sink sync=false " "filesrc location=" FOLDER
      "/cam0.mp4 ! qtdemux ! h264parse ! avdec_h264 ! "
      "saddledetect ! quadtrack camera=cam0 pattern=" FOLDER "/pattern.json ! "
      "queue ! join. " "filesrc location=" FOLDER
      "/cam1.mp4 ! qtdemux ! h264parse ! avdec_h264 ! "
      "saddledetect ! quadtrack camera=cam1 pattern=" FOLDER "/pattern.json ! "
      "queue ! join.", &error);
  g_autoptr (GstElement) sink = NULL;
  GstSample *sample;
  Errors sum = { 0 };
  gdouble rms, predicted;
  guint frame = 0;

  g_assert_no_error (error);
  sink = gst_bin_get_by_name (GST_BIN (pipeline), "sink");
  g_assert_cmpint (gst_element_set_state (pipeline, GST_STATE_PLAYING), !=,
      GST_STATE_CHANGE_FAILURE);
  while ((sample = gst_app_sink_try_pull_sample (GST_APP_SINK (sink),
              PATIENCE))) {
    g_autoptr (GstClothMesh) mesh =
        gst_cloth_mesh_from_buffer (gst_sample_get_buffer (sample), &error);

    g_assert_no_error (error);
    g_assert_cmpuint (frame, <, film->n_frames);
    compare (frame++, mesh, &sum);
    gst_sample_unref (sample);
  }
  gst_element_set_state (pipeline, GST_STATE_NULL);
  gst_object_unref (pipeline);

  rms = 1e3 * sqrt (sum.sum2 / sum.n);
  predicted = 1e3 * sqrt (sum.variance / sum.n);
  g_test_message ("%u frames; %u of %u corners of visible squares located; %u "
      "that both cameras see: %.3f mm RMS, predicted %.3f mm (%.2f of it); mean "
      "normalised square of the error %.2f", frame, sum.located, sum.visible,
      sum.n, rms, predicted, rms / predicted, sum.chi2 / sum.n);
  g_assert_cmpuint (frame, ==, film->n_frames);
  g_assert_cmpuint (sum.located, >=, (guint) (LEAST_LOCATED * sum.visible));
  g_assert_cmpfloat (rms, <=, MOST_RMS_MM);
  g_assert_cmpfloat (fabs (rms / predicted - 1), <=, SIGMA_TOLERANCE);
}

int
main (int argc, char **argv)
{
  int result;

  gst_init (&argc, &argv);
  g_test_init (&argc, &argv, NULL);
  film = test_film_load (FOLDER);
  g_test_add_func ("/film/mesh/truth", check_mesh);
  result = g_test_run ();
  test_film_free (film);
  return result;
}
