/* Speed of triangulation: 3,500 points by 8 views with covariance, against OpenCV's
 * linear triangulation from two views without.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tests/reference/reference.h"
#include "gst/math/random.h"
#include "gst/rig/triangulate.h"

#define N_POINTS 3500
#define N_VIEWS 8
#define REPEATS 60

static void
make_cameras (ClothCamera cameras[N_VIEWS], ClothLens lens)
{
  static const gdouble brown[8] =
      { -0.28, 0.09, 1e-3, -5e-4, -0.012, 0.02, 0.003, -0.001 };
  static const gdouble fisheye[8] = { 0.02, -0.01, 0.003, -0.0005 };

  memset (cameras, 0, N_VIEWS * sizeof (*cameras));
  for (guint i = 0; i < N_VIEWS; i++) {
    ClothCamera *c = &cameras[i];
    gdouble angle = -1. + 2. * i / (N_VIEWS - 1);

    c->width = 1920;
    c->height = 1080;
    c->K[0] = c->K[4] = 1500.;
    c->K[2] = 959.5;
    c->K[5] = 539.5;
    c->K[8] = 1.;
    c->lens = lens;
    if (lens == CLOTH_LENS_FISHEYE)
      memcpy (c->k, fisheye, sizeof (fisheye));
    else if (lens != CLOTH_LENS_NONE)
      memcpy (c->k, brown, cloth_lens_n_coefficients (lens) * sizeof (gdouble));
    /* about the z axis, 2 m away, z up */
    c->R[0] = cos (angle);
    c->R[1] = -sin (angle);
    c->R[5] = -1.;
    c->R[6] = sin (angle);
    c->R[7] = cos (angle);
    c->t[2] = 2.;
  }
}

static gint
compare (gconstpointer a, gconstpointer b)
{
  gint64 x = *(const gint64 *) a, y = *(const gint64 *) b;

  return (x > y) - (x < y);
}

static gdouble
median_ms (gint64 * times, guint n)
{
  qsort (times, n, sizeof (*times), compare);
  return times[n / 2] / 1000.;
}

int
main (void)
{
  static const gchar *const lens_names[] = { "none", "brown5", "brown8",
    "fisheye"
  };
  static const gchar *const level_names[] = { "scalar", "avx2", "avx512" };
  static gdouble planes[N_VIEWS][5][N_POINTS], found[3 * N_POINTS];
  ClothTriangulateView views[N_VIEWS];
  ClothCamera cameras[N_VIEWS];
  gint64 times[REPEATS];
  gdouble projections[24] = { 0. }, peer, best = G_MAXDOUBLE;

  printf ("%d points, %d views, covariance in and out; median of %d\n",
      N_POINTS, N_VIEWS, REPEATS);
  for (guint lens = 0; lens < G_N_ELEMENTS (lens_names); lens++) {
    ClothRandom random;

    cloth_random_init (&random, 1);
    make_cameras (cameras, (ClothLens) lens);
    for (guint i = 0; i < N_VIEWS; i++) {
      ClothTriangulateView view = { planes[i][0], planes[i][1], planes[i][2],
        planes[i][3], planes[i][4]
      };

      views[i] = view;
    }
    for (guint k = 0; k < N_POINTS; k++) {
      gdouble X[3];

      for (gint j = 0; j < 3; j++)
        X[j] = 0.8 * (cloth_random_uniform (&random) - 0.5);
      for (guint i = 0; i < N_VIEWS; i++) {
        gdouble px[2];

        if (!cloth_camera_project (&cameras[i], X, px, NULL, NULL))
          return 1;
        planes[i][0][k] = px[0] + 0.1 * cloth_random_gaussian (&random);
        planes[i][1][k] = px[1] + 0.1 * cloth_random_gaussian (&random);
        planes[i][2][k] = planes[i][4][k] = 0.01;
        planes[i][3][k] = 0.;
      }
    }
    for (guint level = 0; level < G_N_ELEMENTS (level_names); level++) {
      if (cloth_simd_resolve ((ClothSimd) level) != (ClothSimd) level)
        continue;
      for (guint threads = 1; threads <= 2; threads++) {
        g_autoptr (ClothPool) pool = cloth_pool_new (threads);
        g_autoptr (ClothTriangulator) triangulator =
            cloth_triangulator_new (N_VIEWS, cameras, NULL);
        const ClothTriangulation *result;
        gdouble ms;

        cloth_triangulator_set_pool (triangulator, pool);
        cloth_triangulator_set_simd (triangulator, (ClothSimd) level);
        for (guint repeat = 0; repeat < REPEATS; repeat++) {
          gint64 start = g_get_monotonic_time ();

          if (!cloth_triangulator_run (triangulator, N_VIEWS, views, N_POINTS,
                  &result, NULL))
            return 1;
          times[repeat] = g_get_monotonic_time () - start;
        }
        ms = median_ms (times, REPEATS);
        best = fmin (best, ms);
        printf ("  lens %-8s %-7s %u thread%s %7.3f ms (fastest %.3f)\n",
            lens_names[lens], level_names[level], threads,
            threads > 1 ? "s" : " ", ms, times[0] / 1000.);
      }
    }
  }

  /* the peer: two views, no lens, no covariance, no refinement */
  for (guint i = 0; i < 2; i++)
    for (gint j = 0; j < 3; j++)
      for (gint k = 0; k < 4; k++)
        for (gint l = 0; l < 3; l++)
          projections[12 * i + 4 * j + k] += cameras[7 * i].K[3 * j + l] *
              (k < 3 ? cameras[7 * i].R[3 * l + k] : cameras[7 * i].t[l]);
  for (guint repeat = 0; repeat < REPEATS; repeat++) {
    gint64 start = g_get_monotonic_time ();

    if (!cloth_cv_triangulate_points (projections, N_POINTS, planes[0][0],
            planes[0][1], planes[7][0], planes[7][1], found))
      return 1;
    times[repeat] = g_get_monotonic_time () - start;
  }
  peer = median_ms (times, REPEATS);
  printf
      ("  cv::triangulatePoints, 2 views: %.3f ms; best of ours / it: %.3f\n",
      peer, best / peer);
  return 0;
}
