/* A plain board that looks the same after a turn rolls before the camera: it is found
 * whatever way it lies, and its squares keep their index.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/vision/quad/quad.h"
#include "tests/common/render.h"

#define STEP (G_PI / 60)

/* Index of the board's square (@column, @row) after @quarters of a turn of the board. */
static gint
turned (gint n, gint quarters, gint column, gint row)
{
  for (gint k = 0; k < quarters; k++) {
    gint old = column;

    column = n - 1 - row;
    row = old;
  }
  return row * n + column;
}

/* Plays a board of @n by @n squares that starts at @start and rolls on. */
static void
roll (gint n, gdouble start, guint n_frames)
{
  const ClothQuadParams params = cloth_quad_default_params ();
  const ClothSaddleParams saddle_params = cloth_saddle_default_params ();
  g_autoptr (ClothPattern) pattern =
      cloth_pattern_new_checker (n, n, 0.05, 0.05, TRUE, NULL);
  g_autoptr (ClothQuadTracker) tracker = cloth_quad_tracker_new (pattern);
  g_autoptr (ClothSaddleDetector) detector = cloth_saddle_detector_new ();
  const ClothCamera camera = test_camera (400, 400, 400, n * 0.05 + 0.45);
  TestWave wave = { pattern, {0, 0, 0}, 0.1, 0.1, start, 0, 1, 0, 0 };
  gint turn = -1;
  guint seen = 0;

  for (guint frame = 0; frame < n_frames; frame++, wave.roll += STEP) {
    const TestScene scene = { pattern, &camera, test_surface_wave, &wave, 40,
      200, 110, NULL, 0, {0, 0, 0, 0}, 0.6, 2, frame
    };
    TestRender *render = test_render (&scene);
    const ClothImage image = { render->data, 400, 400, 400 };
    guint n_saddles, n_candidates, n_quads, right[4] = { 0 }, n_black = 0;
    const ClothSaddle *saddles;
    const ClothSaddleCandidate *candidates;
    const ClothQuad *quads;

    cloth_saddle_detector_run (detector, &saddle_params, &image,
        CLOTH_SIMD_BEST);
    saddles = cloth_saddle_detector_get_saddles (detector, &n_saddles);
    candidates = cloth_saddle_detector_get_candidates (detector, &n_candidates);
    quads = cloth_quad_tracker_run (tracker, &params, &image, saddles,
        n_saddles, candidates, n_candidates, &n_quads);
    for (guint k = 0; k < n_quads; k++) {
      const ClothQuad *quad = &quads[k];
      gdouble x = 0, y = 0;

      if (quad->state != CLOTH_QUAD_TRACKED)
        continue;
      n_black++;
      for (gint c = 0; c < 4; c++) {
        x += quad->x[c] / 4;
        y += quad->y[c] / 4;
      }
      for (gint q = 0; q < 4; q++) {
        const gint s = turned (n, q, quad->column, quad->row);
        const gint v = s / n * (n + 1) + s % n;
        const gdouble tx = (render->x[v] + render->x[v + n + 2]) / 2;
        const gdouble ty = (render->y[v] + render->y[v + n + 2]) / 2;

        right[q] += hypot (x - tx, y - ty) < 5;
      }
    }
    if (turn < 0)
      for (gint q = 0; q < 4; q++)
        if (n_black && right[q] == n_black)
          turn = q;
    g_assert_cmpint (turn, >=, 0);
    if (right[turn] != n_black || n_black != (guint) (n * n + 1) / 2)
      g_test_message
          ("%d by %d, start %.2f rad, picture %u: %u squares, %u right", n, n,
          start, frame, n_black, right[turn]);
    g_assert_cmpuint (right[turn], ==, n_black);
    seen += n_black;
    test_render_free (render);
  }
  g_test_message ("%d by %d squares from %.2f rad on: %u of %u squares tracked",
      n, n, start, seen, n_frames * (guint) ((n * n + 1) / 2));
  g_assert_cmpuint (seen, >=, (guint) (0.98 * n_frames * ((n * n + 1) / 2)));
}

static void
test_even (void)
{
  roll (8, 0, 120);
}

static void
test_start_on_side (void)
{
  for (gint k = 0; k < 8; k++)
    roll (8, k * G_PI / 4, 4);
  roll (8, 1.5, 4);
}

static void
test_odd (void)
{
  roll (5, 0, 120);
  /* Its few corners weigh less than its lying upside down does, so not all the way. */
  roll (3, 0.8, 45);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/roll/even", test_even);
  g_test_add_func ("/roll/start-on-side", test_start_on_side);
  g_test_add_func ("/roll/odd", test_odd);
  return g_test_run ();
}
