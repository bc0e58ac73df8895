/* Averages over time, held against closed forms.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/math/random.h"
#include "gst/vision/match/match.h"

#include <math.h>

/* √χ² of 2 degrees of freedom at 95% */
#define CHI 2.4477

static ClothGridVertex
vertex_at (gdouble x, gdouble y, gdouble sigma)
{
  return (ClothGridVertex) {
  .state = CLOTH_GRID_ALIGNED,.x = x,.y = y,.xx = sigma * sigma,.yy =
        sigma * sigma};
}

/* Still, with unequal correlated covariances: the mean is the weighted one, and its
 * information the sum. */
static void
test_still (void)
{
  g_autoptr (ClothSteady) steady = cloth_steady_new (1, 4);
  static const gdouble c[6][3] = { {0.04, 0.01, 0.09}, {0.01, 0, 0.01},
  {0.16, -0.1, 0.25}, {0.02, 0.01, 0.02}, {0.3, 0, 0.1}, {0.05, 0.02, 0.01}
  };
  static const gdouble x[6][2] = { {100, 200}, {100.05, 199.95}, {100.1, 200.1},
  {99.95, 199.9}, {100.2, 199.9}, {99.98, 200.02}
  };

  for (guint k = 0; k < 6; k++) {
    gdouble i[3] = { 0 }, w[2] = { 0 }, det;
    ClothGridVertex v = { CLOTH_GRID_MATCHED, FALSE, x[k][0], x[k][1], c[k][0],
      c[k][1], c[k][2]
    };

    cloth_steady_run (steady, &v);
    for (guint j = k < 4 ? 0 : k - 3; j <= k; j++) {
      const gdouble d = c[j][0] * c[j][2] - c[j][1] * c[j][1];
      const gdouble p[3] = { c[j][2] / d, -c[j][1] / d, c[j][0] / d };

      for (guint n = 0; n < 3; n++)
        i[n] += p[n];
      w[0] += p[0] * x[j][0] + p[1] * x[j][1];
      w[1] += p[1] * x[j][0] + p[2] * x[j][1];
    }
    det = i[0] * i[2] - i[1] * i[1];
    g_assert_cmpfloat_with_epsilon (v.xx, i[2] / det, 1e-12);
    g_assert_cmpfloat_with_epsilon (v.xy, -i[1] / det, 1e-12);
    g_assert_cmpfloat_with_epsilon (v.yy, i[0] / det, 1e-12);
    g_assert_cmpfloat_with_epsilon (v.x, (i[2] * w[0] - i[1] * w[1]) / det,
        1e-9);
    g_assert_cmpfloat_with_epsilon (v.y, (i[0] * w[1] - i[1] * w[0]) / det,
        1e-9);
    g_assert_cmpint (v.state, ==, CLOTH_GRID_MATCHED);
  }
}

/* Variance falls as 1/n until as many pictures are averaged as may be. */
static void
test_variance (void)
{
  g_autoptr (ClothSteady) steady = cloth_steady_new (1, 10);

  for (guint n = 1; n <= 30; n++) {
    ClothGridVertex v = vertex_at (5, 6, 0.2);

    cloth_steady_run (steady, &v);
    g_assert_cmpfloat_with_epsilon (v.xx, 0.04 / MIN (n, 10), 1e-12);
    g_assert_cmpfloat_with_epsilon (v.yy, 0.04 / MIN (n, 10), 1e-12);
    g_assert_cmpfloat_with_epsilon (v.x, 5, 1e-12);
  }
}

/* Of 4000 vertices that stand still under noise: the errors of the means are as large as their
 * covariances say, and a twelfth of the noise's where no run was broken off by chance. */
static void
test_noise (void)
{
  enum
  { N = 4000, PICTURES = 12 };
  g_autoptr (ClothSteady) steady = cloth_steady_new (N, PICTURES);
  g_autofree ClothGridVertex *v = g_new (ClothGridVertex, N);
  const gdouble sigma = 0.3;
  ClothRandom random;
  gdouble sum = 0, raw = 0, told = 0;
  guint n_whole = 0;

  cloth_random_init (&random, 7);
  for (guint k = 0; k < PICTURES; k++) {
    for (guint i = 0; i < N; i++)
      v[i] = vertex_at (i + sigma * cloth_random_gaussian (&random),
          -sigma * cloth_random_gaussian (&random), sigma);
    cloth_steady_run (steady, v);
  }
  for (guint i = 0; i < N; i++) {
    const gdouble error = pow (v[i].x - i, 2) + v[i].y * v[i].y;

    told += error / v[i].xx / N;
    if (v[i].xx > sigma * sigma / PICTURES * 1.001)
      continue;
    n_whole++;
    sum += error;
  }
  raw = 2 * sigma * sigma;
  g_test_message ("%u whole runs: %g of the variance, χ² %g", n_whole,
      sum / n_whole / raw, told);
  /* eleven tests, each passed by 95% */
  g_assert_cmpfloat_with_epsilon ((gdouble) n_whole / N, pow (0.95, 11), 0.03);
  g_assert_cmpfloat_with_epsilon (sum / n_whole / raw, 1. / PICTURES, 0.005);
  /* runs that begin again do so with a place that was far off */
  g_assert_cmpfloat (told, >, 1.8);
  g_assert_cmpfloat (told, <, 3);
}

/* A step of more than 3 σ is followed at once, whatever came before. */
static void
test_step (void)
{
  for (guint before = 1; before <= 20; before++) {
    g_autoptr (ClothSteady) steady = cloth_steady_new (1, 20);
    const gdouble sigma = 0.25, step = 3.5 * sigma;
    ClothGridVertex v;

    for (guint k = 0; k < before; k++) {
      v = vertex_at (0, 0, sigma);
      cloth_steady_run (steady, &v);
    }
    v = vertex_at (step * 0.6, step * 0.8, sigma);
    cloth_steady_run (steady, &v);
    g_assert_cmpfloat_with_epsilon (v.x, step * 0.6, 1e-12);
    g_assert_cmpfloat_with_epsilon (v.y, step * 0.8, 1e-12);
    g_assert_cmpfloat_with_epsilon (v.xx, sigma * sigma, 1e-12);
  }
}

/* A step of 2 σ is no reason. */
static void
test_small_step (void)
{
  g_autoptr (ClothSteady) steady = cloth_steady_new (1, 20);
  ClothGridVertex v;

  for (guint k = 0; k < 9; k++) {
    v = vertex_at (0, 0, 0.5);
    cloth_steady_run (steady, &v);
  }
  v = vertex_at (1, 0, 0.5);
  cloth_steady_run (steady, &v);
  g_assert_cmpfloat_with_epsilon (v.x, 0.1, 1e-12);
  g_assert_cmpfloat_with_epsilon (v.xx, 0.025, 1e-12);
}

/* However slow a drift is, the mean stays less behind than the test lets it differ, and less
 * than 2 σ most of the time; where it never differs enough, by the middle of the window. */
static void
test_drift (void)
{
  static const gdouble speeds[] = { 0.01, 0.03, 0.1, 0.3, 1, 3 };       /* σ a picture */

  for (guint s = 0; s < G_N_ELEMENTS (speeds); s++) {
    g_autoptr (ClothSteady) steady = cloth_steady_new (1, CLOTH_STEADY_MAX);
    const gdouble sigma = 0.2;
    gdouble most = 0, mean = 0;

    for (guint k = 0; k < 1000; k++) {
      const gdouble x = speeds[s] * sigma * k;
      ClothGridVertex v = vertex_at (x, 0, sigma);

      cloth_steady_run (steady, &v);
      most = MAX (most, x - v.x);
      mean += (x - v.x) / 1000;
      g_assert_cmpfloat (v.x, <=, x + 1e-9);
    }
    g_test_message ("%g σ a picture: behind %g σ, mean %g σ", speeds[s],
        most / sigma, mean / sigma);
    g_assert_cmpfloat (most, <, CHI * sigma);
    g_assert_cmpfloat (mean, <, 2 * sigma);
    if (speeds[s] <= 0.03)
      g_assert_cmpfloat_with_epsilon (most,
          speeds[s] * sigma * (CLOTH_STEADY_MAX - 1) / 2, 1e-9);
  }
}

/* What ends a run: a picture in which it isn't seen, its other side, no covariance, the end of
 * what belongs together. Other vertices know nothing of it. */
static void
test_ends (void)
{
  for (guint how = 0; how < 5; how++) {
    g_autoptr (ClothSteady) steady = cloth_steady_new (2, 10);
    ClothGridVertex v[2];

    for (guint k = 0; k < 3; k++) {
      v[0] = v[1] = vertex_at (1, 2, 0.5);
      cloth_steady_run (steady, v);
    }
    v[0] = v[1] = vertex_at (1, 2, 0.5);
    switch (how) {
      case 0:
      v[0] = (ClothGridVertex) {
      CLOTH_GRID_UNSEEN, FALSE, NAN, NAN, NAN, NAN, NAN};
        break;
      case 1:
        v[0].xx = 0;
        break;
      case 2:
        v[0].xy = 1;            /* no covariance */
        break;
      case 3:
        v[0].y = NAN;
        break;
      default:
        v[0].mirrored = TRUE;
    }
    cloth_steady_run (steady, v);
    g_assert_cmpfloat_with_epsilon (v[1].xx, 0.25 / 4, 1e-12);
    if (how == 0)
      g_assert_cmpint (v[0].state, ==, CLOTH_GRID_UNSEEN);
    if (how == 1)
      g_assert_cmpfloat (v[0].xx, ==, 0);
    v[0] = v[1] = vertex_at (1, 2, 0.5);
    cloth_steady_run (steady, v);
    g_assert_cmpfloat_with_epsilon (v[0].xx, 0.25, 1e-12);
    g_assert_cmpfloat_with_epsilon (v[1].xx, 0.25 / 5, 1e-12);
    cloth_steady_reset (steady);
    v[0] = v[1] = vertex_at (1, 2, 0.5);
    cloth_steady_run (steady, v);
    g_assert_cmpfloat_with_epsilon (v[1].xx, 0.25, 1e-12);
  }
}

/* Limits of what is averaged: one picture is none; nonsense is brought into range. */
static void
test_limits (void)
{
  static const guint most[] = { 0, 1, G_MAXUINT };
  static const guint is[] = { 1, 1, CLOTH_STEADY_MAX };

  for (guint i = 0; i < G_N_ELEMENTS (most); i++) {
    g_autoptr (ClothSteady) steady = cloth_steady_new (1, most[i]);
    ClothGridVertex v;

    for (guint k = 0; k < 2 * CLOTH_STEADY_MAX; k++) {
      v = vertex_at (1e6, -1e6, 1e-3);
      cloth_steady_run (steady, &v);
    }
    g_assert_cmpfloat_with_epsilon (v.xx * is[i], 1e-6, 1e-15);
    g_assert_cmpfloat (v.x, ==, 1e6);
  }
  cloth_steady_free (NULL);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/steady/still", test_still);
  g_test_add_func ("/steady/variance", test_variance);
  g_test_add_func ("/steady/noise", test_noise);
  g_test_add_func ("/steady/step", test_step);
  g_test_add_func ("/steady/small-step", test_small_step);
  g_test_add_func ("/steady/drift", test_drift);
  g_test_add_func ("/steady/ends", test_ends);
  g_test_add_func ("/steady/limits", test_limits);
  return g_test_run ();
}
