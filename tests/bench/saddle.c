/* Speed of the hyperbolic mask, the refined saddles and the corner model.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/cv/reference.h"
#include "gst/vision/corner.h"
#include "gst/vision/saddle-mask.h"
#include "gst/vision/saddle.h"

#define WIDTH 1920
#define HEIGHT 1080
#define ROUNDS 60

/* A slightly turned board of squares of 30 px with noise: some 2,300 corners. */
static guint8 *
board (void)
{
  guint8 *image = g_malloc (WIDTH * HEIGHT);
  g_autoptr (GRand) rand = g_rand_new_with_seed (1);

  for (gint y = 0; y < HEIGHT; y++) {
    for (gint x = 0; x < WIDTH; x++) {
      gdouble u = 0.995 * x + 0.0998 * y, v = 0.995 * y - 0.0998 * x;
      gdouble s = tanh (10 * sin (u * G_PI / 30)) * tanh (10 * sin (v * G_PI /
              30));
      gdouble noise = g_rand_double (rand) + g_rand_double (rand) +
          g_rand_double (rand) - 1.5;
      image[y * WIDTH + x] = (guint8) (120.5 + 80 * s + 6 * noise);
    }
  }
  return image;
}

/* Middle of ROUNDS times, in ms. */
static gint
compare (gconstpointer a, gconstpointer b)
{
  gint64 d = *(const gint64 *) a - *(const gint64 *) b;

  return d < 0 ? -1 : d > 0;
}

static gdouble
middle (gint64 * times)
{
  qsort (times, ROUNDS, sizeof (gint64), compare);
  return (gdouble) times[ROUNDS / 2] * 1e-3;
}

int
main (void)
{
  static const gchar *const names[] = { "scalar", "AVX2", "AVX-512" };
  g_autofree guint8 *data = board ();
  const ClothImage image = { data, WIDTH, HEIGHT, WIDTH };
  ClothSaddleParams params = cloth_saddle_default_params ();
  g_autoptr (ClothSaddleDetector) detector = cloth_saddle_detector_new ();
  ClothCvSaddle *reference = cloth_cv_saddle_new ();
  ClothSimd best = cloth_simd_resolve (CLOTH_SIMD_BEST);
  ClothSaddleKernel kernel;
  ClothSaddleMask mask = {.width = WIDTH,.height = HEIGHT };
  gint64 times[ROUNDS];
  gdouble peer, own = 0;
  guint n = 0;

  for (gint i = 0; i < ROUNDS; i++) {
    gint64 start = g_get_monotonic_time ();
    cloth_cv_saddle_mask (reference, data, WIDTH, HEIGHT, WIDTH, params.sigma,
        params.epsilon, &n);
    times[i] = g_get_monotonic_time () - start;
  }
  peer = middle (times);
  g_print ("saddle mask 1920x1080, one core, sigma %.1f:\n"
      "  OpenCV GaussianBlur + 3 Sobel + determinant + compare: %.3f ms\n",
      params.sigma, peer);

  cloth_saddle_kernel_init (&kernel, params.sigma);
  for (ClothSimd level = CLOTH_SIMD_SCALAR; level <= best; level++) {
    for (gint i = 0; i < ROUNDS; i++) {
      gint64 start = g_get_monotonic_time ();
      cloth_saddle_mask_run (&mask, &kernel, &image,
          (gint) (params.epsilon / kernel.scale), level);
      times[i] = g_get_monotonic_time () - start;
    }
    own = middle (times);
    g_print ("  %s: %.3f ms, %.1f times as fast\n", names[level], own,
        peer / own);
  }

  for (gint mode = CLOTH_SADDLE_REFINE_NONE;
      mode <= CLOTH_SADDLE_REFINE_MODEL; mode++) {
    static const gchar *const what[] = { "candidates listed",
      "with stream refinement", "with the corner model"
    };
    guint n_candidates, n_saddles;

    params.refine = mode;
    for (gint i = 0; i < ROUNDS; i++) {
      gint64 start = g_get_monotonic_time ();
      cloth_saddle_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
      times[i] = g_get_monotonic_time () - start;
    }
    cloth_saddle_detector_get_candidates (detector, &n_candidates);
    cloth_saddle_detector_get_saddles (detector, &n_saddles);
    g_print ("  %s: %.3f ms (%u candidates, %u saddles)\n", what[mode],
        middle (times), n_candidates, n_saddles);
  }
  cloth_cv_saddle_free (reference);
  cloth_saddle_mask_clear (&mask);
  return 0;
}
