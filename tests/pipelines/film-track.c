/* The squares of the rendered cloth: how many are tracked, which, and how exactly; once,
 * and forth and back for twenty seconds.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/gst.h>
#include <math.h>

#include "tests/common/film.h"

/* What is to be reached. */
#define LEAST_HIT 0.95
#define MOST_RMS_PX 0.15
#define PASSES 16

static TestFilm *film;

static void
check_once (void)
{
  TestFilmScore sum = { 0 };

  for (guint camera = 0; camera < TEST_FILM_CAMERAS; camera++) {
    TestFilmScore all = { 0 };

    test_film_track (film, camera, 0, "once", &all);
    test_film_tell (camera ? "camera 1" : "camera 0", &all);
    test_film_add (&sum, &all);
  }
  test_film_tell ("both cameras", &sum);
  g_assert_cmpuint (sum.visible, >, 3000);
  g_assert_cmpuint (sum.hit, >=, (guint) ceil (LEAST_HIT * sum.visible));
  g_assert_cmpuint (sum.wrong, ==, 0);
  g_assert_cmpfloat (test_film_rms (&sum), <=, MOST_RMS_PX);
}

static void
check_drift (void)
{
  for (guint camera = 0; camera < TEST_FILM_CAMERAS; camera++) {
    g_auto (TestTracking) tracking = { 0 };
    TestFilmScore first[2] = { {0}
    }, last[2] = { {0}
    }, sum = { 0 };

    test_tracking_init (&tracking, film);
    for (guint pass = 0; pass < PASSES; pass++)
      for (guint k = 0; k < film->n_frames; k++) {
        const guint frame = pass & 1 ? film->n_frames - 1 - k : k;
        TestFilmScore score;
        guint n;
        const ClothQuad *quads = test_tracking_run (&tracking, film,
            test_film_picture (film, camera, frame), &n);

        test_film_score (film, camera, frame, NULL, quads, n,
            pass > 1 ? NULL : "pass", &score);
        test_film_add (&sum, &score);
        if (pass < 2)
          test_film_add (&first[pass], &score);
        else if (pass + 2 >= PASSES)
          test_film_add (&last[pass & 1], &score);
      }
    test_film_tell ("first pass forth", &first[0]);
    test_film_tell ("first pass back", &first[1]);
    test_film_tell ("last pass forth", &last[0]);
    test_film_tell ("last pass back", &last[1]);
    test_film_tell ("all passes", &sum);
    g_assert_cmpuint (sum.wrong, ==, 0);
    for (guint way = 0; way < 2; way++) {
      g_assert_cmpuint (100 * last[way].hit, >=, 98 * first[way].hit);
      g_assert_cmpfloat (fabs (test_film_rms (&last[way])
              - test_film_rms (&first[way])), <=,
          0.1 * test_film_rms (&first[way]));
    }
  }
}

static gint
compare (gconstpointer a, gconstpointer b)
{
  gdouble p = *(const gdouble *) a, q = *(const gdouble *) b;

  return (p > q) - (p < q);
}

/* What refined saddles claim against how far they are off, at the inner corners of visible
 * squares. A film's corners are worse than its noise in flat places would have them:
 * compression, texture, bends. Half of the errors are below the median, that of a Rayleigh
 * distribution being sigma·sqrt (2 ln 2). */
static void
check_saddles (void)
{
  for (gint mode = CLOTH_SADDLE_REFINE_STREAM;
      mode <= CLOTH_SADDLE_REFINE_MODEL; mode++) {
    g_autoptr (ClothSaddleDetector) detector = cloth_saddle_detector_new ();
    ClothSaddleParams params = cloth_saddle_default_params ();
    g_autoptr (GArray) off = g_array_new (FALSE, FALSE, sizeof (gdouble));
    g_autoptr (GArray) says = g_array_new (FALSE, FALSE, sizeof (gdouble));
    gdouble off2 = 0, says2 = 0, median_off, median_says;

    params.refine = mode;
    params.radius = 4.5f;
    for (guint at = 0; at < TEST_FILM_CAMERAS * film->n_frames; at += 4) {
      guint camera = at / film->n_frames, frame = at % film->n_frames, n;
      const ClothImage image = { test_film_picture (film, camera, frame),
        film->width, film->height, film->width
      };
      const ClothSaddle *saddles;

      cloth_saddle_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
      saddles = cloth_saddle_detector_get_saddles (detector, &n);
      for (gint k = 0; k < film->pattern->columns * film->pattern->rows; k++) {
        gint column = k % film->pattern->columns;
        gint row = k / film->pattern->columns;
        const TestFilmSquare *square;

        if (column + 1 == film->pattern->columns
            || row + 1 == film->pattern->rows
            || !test_film_is_visible (film, camera, frame, column + 1, row + 1,
                NULL)
            || !test_film_is_visible (film, camera, frame, column, row, NULL))
          continue;
        square = test_film_square (film, camera, frame, column, row);
        for (guint s = 0; s < n; s++) {
          gdouble dx = saddles[s].x - square->x[2];
          gdouble dy = saddles[s].y - square->y[2];
          gdouble d2 = (dx * dx + dy * dy) / 2;
          gdouble claimed = (saddles[s].cov[0] + saddles[s].cov[2]) / 2;

          /* Farther away it is something else. */
          if (d2 > 0.5)
            continue;
          g_array_append_val (off, d2);
          g_array_append_val (says, claimed);
          off2 += d2;
          says2 += claimed;
        }
      }
    }
    g_assert_cmpuint (off->len, >, 1000);
    g_array_sort (off, compare);
    g_array_sort (says, compare);
    median_off = sqrt (g_array_index (off, gdouble, off->len / 2) / G_LN2);
    median_says = sqrt (g_array_index (says, gdouble, says->len / 2));
    g_test_message ("%s: %u corners, %.4f px RMS an axis, claimed %.4f px "
        "(%.2f); by the medians %.4f px, claimed %.4f px (%.2f)",
        mode == CLOTH_SADDLE_REFINE_STREAM ? "stream" : "model", off->len,
        sqrt (off2 / off->len), sqrt (says2 / off->len), sqrt (says2 / off2),
        median_off, median_says, median_says / median_off);
    g_assert_cmpfloat (median_says / median_off, >, 0.8);
    g_assert_cmpfloat (median_says / median_off, <, 1.2);
    g_assert_cmpfloat (sqrt (says2 / off2), >, 0.7);
    g_assert_cmpfloat (sqrt (says2 / off2), <, 1.3);
  }
}

int
main (int argc, char **argv)
{
  int result;

  gst_init (&argc, &argv);
  g_test_init (&argc, &argv, NULL);
  film = test_film_load (TEST_DATA "/checker_pair");
  g_test_add_func ("/film/track/saddles", check_saddles);
  g_test_add_func ("/film/track/once", check_once);
  g_test_add_func ("/film/track/forth-and-back", check_drift);
  result = g_test_run ();
  test_film_free (film);
  return result;
}
