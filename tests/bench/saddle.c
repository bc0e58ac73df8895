/* Speed of the hyperbolic mask, the refined saddles and the corner model.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <stdlib.h>

#include "tests/reference/reference.h"
#include "gst/vision/corner/corner.h"
#include "gst/vision/corner/saddle-mask.h"
#include "gst/vision/corner/saddle.h"
#include "tests/bench/clock.h"

#define WIDTH 1920
#define HEIGHT 1080
#define ROUNDS 60

/* A slightly turned board of a thousand squares with noise. */
static guint8 *
board (void)
{
  guint8 *image = g_malloc (WIDTH * HEIGHT);
  g_autoptr (GRand) rand = g_rand_new_with_seed (1);

  for (gint y = 0; y < HEIGHT; y++) {
    for (gint x = 0; x < WIDTH; x++) {
      gdouble u = 0.995 * x + 0.0998 * y, v = 0.995 * y - 0.0998 * x;
      gdouble s = tanh (15 * sin (u * G_PI / 45)) * tanh (15 * sin (v * G_PI /
              45));
      gdouble noise = g_rand_double (rand) + g_rand_double (rand) +
          g_rand_double (rand) - 1.5;
      image[y * WIDTH + x] = (guint8) (120.5 + 80 * s + 6 * noise);
    }
  }
  return image;
}

/* Fastest of ROUNDS times, in ms: whatever else runs only adds to it. */
static gdouble
fastest (const gdouble * times)
{
  gdouble least = times[0];

  for (gint i = 1; i < ROUNDS; i++)
    least = MIN (least, times[i]);
  return least;
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
  gdouble times[ROUNDS];
  gdouble peer, own = 0;
  guint n = 0;

  for (gint i = 0; i < ROUNDS; i++) {
    gdouble start = cpu_ms ();
    cloth_cv_saddle_mask (reference, data, WIDTH, HEIGHT, WIDTH, params.sigma,
        params.epsilon, &n);
    times[i] = cpu_ms () - start;
  }
  peer = fastest (times);
  g_print ("saddle mask 1920x1080, one core, sigma %.1f:\n"
      "  OpenCV GaussianBlur + 3 Sobel + determinant + compare: %.3f ms\n",
      params.sigma, peer);

  cloth_saddle_kernel_init (&kernel, params.sigma);
  for (ClothSimd level = CLOTH_SIMD_SCALAR; level <= best; level++) {
    for (gint i = 0; i < ROUNDS; i++) {
      gdouble start = cpu_ms ();
      cloth_saddle_mask_run (&mask, &kernel, &image,
          (gint) (params.epsilon / kernel.scale), level);
      times[i] = cpu_ms () - start;
    }
    own = fastest (times);
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
      gdouble start = cpu_ms ();
      cloth_saddle_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
      times[i] = cpu_ms () - start;
    }
    cloth_saddle_detector_get_candidates (detector, &n_candidates);
    cloth_saddle_detector_get_saddles (detector, &n_saddles);
    g_print ("  %s: %.3f ms (%u candidates, %u saddles)\n", what[mode],
        fastest (times), n_candidates, n_saddles);
  }
  {
    ClothCornerParams corner = cloth_corner_default_params ();
    g_autofree gfloat *xy = NULL;
    const ClothSaddle *saddles;
    guint n_saddles;

    params.refine = CLOTH_SADDLE_REFINE_STREAM;
    cloth_saddle_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
    saddles = cloth_saddle_detector_get_saddles (detector, &n_saddles);
    xy = g_new (gfloat, 2 * n_saddles);
    for (gint i = 0; i < ROUNDS; i++) {
      gdouble start;
      for (guint k = 0; k < n_saddles; k++) {
        xy[2 * k] = saddles[k].x;
        xy[2 * k + 1] = saddles[k].y;
      }
      start = cpu_ms ();
      cloth_cv_corner_sub_pix (data, WIDTH, HEIGHT, WIDTH, 5, xy, n_saddles);
      times[i] = cpu_ms () - start;
    }
    peer = fastest (times);
    for (gint i = 0; i < ROUNDS; i++) {
      gdouble start = cpu_ms ();
      for (guint k = 0; k < n_saddles; k++) {
        ClothCornerFit fit;
        cloth_corner_refine (&image, saddles[k].x, saddles[k].y, &corner,
            CLOTH_SIMD_BEST, &fit);
      }
      times[i] = cpu_ms () - start;
    }
    own = fastest (times);
    g_print ("corner model, radius 5: %.2f us a corner; OpenCV cornerSubPix "
        "11x11: %.2f us\n", 1e3 * own / n_saddles, 1e3 * peer / n_saddles);
  }
  cloth_cv_saddle_free (reference);
  cloth_saddle_mask_clear (&mask);
  return 0;
}
