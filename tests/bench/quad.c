/* Speed of the tracker, with and without the search for saddles before it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <stdlib.h>

#include "gst/vision/quad/quad.h"
#include "gst/vision/corner/saddle.h"
#include "tests/bench/clock.h"

#define FRAMES 24
#define ROUNDS 5

typedef struct
{
  const gchar *what;
  gint width, height, columns, rows;
  gdouble side;                 /* px */
} Scene;

static gint
compare (gconstpointer a, gconstpointer b)
{
  gdouble d = *(const gdouble *) a - *(const gdouble *) b;

  return d < 0 ? -1 : d > 0;
}

/* A waving board on white, a little turned, that sways by up to 2 px a frame; noise of 2
 * grey levels. */
static guint8 *
picture (const Scene * scene, guint frame, GRand * rand)
{
  guint8 *data = g_malloc ((gsize) scene->width * (gsize) scene->height);
  gdouble phase = 2 * G_PI * frame / FRAMES, turn = 0.05 + 0.01 * sin (phase);
  gdouble cx = scene->width / 2. + 6 * cos (phase);
  gdouble cy = scene->height / 2. + 4 * sin (phase);

  for (gint y = 0; y < scene->height; y++) {
    for (gint x = 0; x < scene->width; x++) {
      gdouble u = (cos (turn) * (x - cx) + sin (turn) * (y - cy)) / scene->side;
      gdouble v = (cos (turn) * (y - cy) - sin (turn) * (x - cx)) / scene->side;
      gdouble noise = g_rand_double (rand) + g_rand_double (rand) +
          g_rand_double (rand) - 1.5;
      gdouble edge, s;

      u += scene->columns / 2. + 0.1 * sin (v + phase);
      v += scene->rows / 2. + 0.1 * sin (u - phase);
      edge = fmin (fmin (u, scene->columns - u), fmin (v, scene->rows - v));
      s = tanh (15 * sin (u * G_PI)) * tanh (15 * sin (v * G_PI));
      /* Black where s is 1, white outside. */
      s = (s + 1) / 2 * (1 + tanh (30 * edge)) / 2;
      data[y * scene->width + x] = (guint8) (200.5 - 160 * s + 4 * noise);
    }
  }
  return data;
}

static void
measure (const Scene * scene)
{
  g_autoptr (ClothPattern) pattern = cloth_pattern_new_checker (scene->columns,
      scene->rows, 0.05, 0, TRUE, NULL);
  g_autoptr (ClothQuadTracker) tracker = cloth_quad_tracker_new (pattern);
  g_autoptr (ClothSaddleDetector) detector = cloth_saddle_detector_new ();
  g_autoptr (GRand) rand = g_rand_new_with_seed (1);
  const ClothSaddleParams saddle_params = cloth_saddle_default_params ();
  const ClothQuadParams params = cloth_quad_default_params ();
  gdouble find[FRAMES * ROUNDS], track[FRAMES * ROUNDS];
  guint8 *pictures[FRAMES];
  guint tracked = 0, least = G_MAXUINT;

  for (guint f = 0; f < FRAMES; f++)
    pictures[f] = picture (scene, f, rand);
  for (guint i = 0; i < FRAMES * ROUNDS; i++) {
    const ClothImage image = { pictures[i % FRAMES], scene->width,
      scene->height, scene->width
    };
    const ClothSaddleCandidate *candidates;
    const ClothSaddle *saddles;
    const ClothQuad *quads;
    guint n_candidates, n_saddles, n;
    gdouble start = cpu_ms (), middle;

    cloth_saddle_detector_run (detector, &saddle_params, &image,
        CLOTH_SIMD_BEST);
    saddles = cloth_saddle_detector_get_saddles (detector, &n_saddles);
    candidates = cloth_saddle_detector_get_candidates (detector, &n_candidates);
    middle = cpu_ms ();
    quads = cloth_quad_tracker_run (tracker, &params, &image, saddles,
        n_saddles, candidates, n_candidates, &n);
    track[i] = cpu_ms () - middle;
    find[i] = middle - start;
    tracked = 0;
    for (guint k = 0; k < n; k++)
      tracked += quads[k].state == CLOTH_QUAD_TRACKED;
    least = MIN (least, tracked);
  }
  g_print ("%s: first picture %.3f ms, ", scene->what, track[0]);
  qsort (find, FRAMES * ROUNDS, sizeof (gdouble), compare);
  qsort (track, FRAMES * ROUNDS, sizeof (gdouble), compare);
  g_print
      ("middle %.3f ms, slowest %.3f ms a picture (saddles before: %.3f ms); "
      "%u squares or more tracked; the paper: 5 to 10 s\n",
      track[FRAMES * ROUNDS / 2],
      track[FRAMES * ROUNDS - 1], find[FRAMES * ROUNDS / 2], least);
  for (guint f = 0; f < FRAMES; f++)
    g_free (pictures[f]);
}

int
main (void)
{
  static const Scene scenes[] = {
    {"376x240, 32 squares", 376, 240, 8, 8, 24},
    {"1920x1080, 1,000 squares", 1920, 1080, 50, 40, 25}
  };

  for (guint k = 0; k < G_N_ELEMENTS (scenes); k++)
    measure (&scenes[k]);
  return 0;
}
