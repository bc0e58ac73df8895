/* The paper's tracker alone on the rendered cloth: no linking, one square given by hand.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <gst/gst.h>
#include <math.h>

#include "tests/common/film.h"

/* Frames before the gust folds the cloth. */
#define QUIET 12
/* Frames in which the squares spread from the one given, a ring a frame. */
#define SPREAD 6
#define LEAST_HIT 0.9
/* Of the visible squares in the gust, which only the squares beside them bring back. */
#define LEAST_HIT_GUST 0.6

static TestFilm *film;

static void
check_paper (gconstpointer data)
{
  const guint camera = GPOINTER_TO_UINT (data);
  g_auto (TestTracking) tracking = { 0 };
  const TestFilmSquare *given = test_film_square (film, camera, 0, 4, 4);
  TestFilmScore quiet = { 0 }, rest = { 0 }, score;
  guint lasts = 0;
  gfloat x[4], y[4];

  for (gint k = 0; k < 4; k++) {
    x[k] = given->x[k] + (k & 1 ? 3 : -3);
    y[k] = given->y[k] + (k & 2 ? 3 : -3);
  }
  test_tracking_init (&tracking, film);
  tracking.quad_params.link = FALSE;
  cloth_quad_tracker_seed (tracking.tracker, x, y, 4, 4);
  for (guint frame = 0; frame < film->n_frames; frame++) {
    guint n;
    const ClothQuad *quads = test_tracking_run (&tracking, film,
        test_film_picture (film, camera, frame), &n);

    test_film_score (film, camera, frame, NULL, quads, n, NULL, &score);
    test_film_add (frame < QUIET ? &quiet : &rest, &score);
    if (score.wrong == 0 && 2 * score.hit >= score.visible && lasts == frame)
      lasts++;
    else if (frame < SPREAD)
      lasts = frame + 1;
    if (frame < QUIET || frame % 8 == 0)
      g_test_message ("camera %u frame %u: %u of %u visible squares, %u wrong",
          camera, frame, score.hit, score.visible, score.wrong);
    if (frame == 0)
      g_assert_cmpuint (score.hit, >=, 1);
    if (frame < QUIET)
      g_assert_cmpuint (score.wrong, ==, 0);
    if (frame >= SPREAD && frame < QUIET)
      g_assert_cmpuint (score.hit, >=, (guint) (LEAST_HIT * score.visible));
  }
  g_test_message
      ("camera %u: quiet frames %.4f px RMS an axis; at least half of "
      "the squares and none wrong up to frame %u; after frame %d %u of %u "
      "visible, %u wrong of %u", camera, test_film_rms (&quiet), lasts, QUIET,
      rest.hit, rest.visible, rest.wrong, rest.tracked);
  g_assert_cmpfloat (test_film_rms (&quiet), <=, 0.15);
  g_assert_cmpuint (rest.wrong, ==, 0);
  g_assert_cmpuint (rest.hit, >=, (guint) (LEAST_HIT_GUST * rest.visible));
}

/* Nothing given and nothing linked: nothing tracked. */
static void
check_not_given (void)
{
  g_auto (TestTracking) tracking = { 0 };

  test_tracking_init (&tracking, film);
  tracking.quad_params.link = FALSE;
  for (guint frame = 0; frame < 3; frame++) {
    guint n;

    test_tracking_run (&tracking, film, test_film_picture (film, 0, frame), &n);
    g_assert_cmpuint (n, ==, 0);
  }
}

/* A square given where the cloth has no print. */
static void
check_given_wrong (void)
{
  g_auto (TestTracking) tracking = { 0 };
  const gfloat x[4] = { 20, 45, 45, 20 }, y[4] = { 20, 20, 45, 45 };
  guint n;

  test_tracking_init (&tracking, film);
  tracking.quad_params.link = FALSE;
  cloth_quad_tracker_seed (tracking.tracker, x, y, 4, 4);
  test_tracking_run (&tracking, film, test_film_picture (film, 0, 0), &n);
  g_assert_cmpuint (n, ==, 0);
}

int
main (int argc, char **argv)
{
  int result;

  gst_init (&argc, &argv);
  g_test_init (&argc, &argv, NULL);
  film = test_film_load (TEST_DATA "/checker_pair");
  g_test_add_data_func ("/film/paper/camera-0", GUINT_TO_POINTER (0),
      check_paper);
  g_test_add_data_func ("/film/paper/camera-1", GUINT_TO_POINTER (1),
      check_paper);
  g_test_add_func ("/film/paper/not-given", check_not_given);
  g_test_add_func ("/film/paper/given-wrong", check_given_wrong);
  result = g_test_run ();
  test_film_free (film);
  return result;
}
