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
tell (const gchar * what, const TestFilmScore * score)
{
  g_test_message ("%s: %u of %u visible squares tracked (%.2f%%), %u wrong, "
      "%u ghosts, %u with a corner astray of %u; %u corners, %.4f px RMS an axis",
      what, score->hit, score->visible,
      100.0 * score->hit / MAX (score->visible, 1), score->wrong,
      score->ghosts, score->strays, score->tracked, score->n_corners,
      test_film_rms (score));
}

static void
check_once (void)
{
  TestFilmScore sum = { 0 };

  for (guint camera = 0; camera < TEST_FILM_CAMERAS; camera++) {
    g_auto (TestTracking) tracking = { 0 };
    TestFilmScore all = { 0 };

    test_tracking_init (&tracking, film);
    for (guint frame = 0; frame < film->n_frames; frame++) {
      TestFilmScore score;
      guint n;
      const ClothQuad *quads = test_tracking_run (&tracking, film,
          test_film_picture (film, camera, frame), &n);

      test_film_score (film, camera, frame, NULL, quads, n, "once", &score);
      test_film_add (&all, &score);
    }
    tell (camera ? "camera 1" : "camera 0", &all);
    test_film_add (&sum, &all);
  }
  tell ("both cameras", &sum);
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
    tell ("first pass forth", &first[0]);
    tell ("first pass back", &first[1]);
    tell ("last pass forth", &last[0]);
    tell ("last pass back", &last[1]);
    tell ("all passes", &sum);
    g_assert_cmpuint (sum.wrong, ==, 0);
    for (guint way = 0; way < 2; way++)
      g_assert_cmpfloat (fabs (test_film_rms (&last[way])
              - test_film_rms (&first[way])), <=,
          0.1 * test_film_rms (&first[way]));
  }
}

int
main (int argc, char **argv)
{
  int result;

  gst_init (&argc, &argv);
  g_test_init (&argc, &argv, NULL);
  film = test_film_load (TEST_DATA "/checker_pair");
  g_test_add_func ("/film/track/once", check_once);
  g_test_add_func ("/film/track/forth-and-back", check_drift);
  result = g_test_run ();
  test_film_free (film);
  return result;
}
