/* Banded matrices against closed forms and the dense algebra.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/math/band.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/math/random.h"

/* Second differences, −1 2 −1, of order n: the inverse's diagonal is i (n + 1 − i) / (n + 1).
 */
static void
test_tridiagonal (void)
{
  enum
  { N = 50 };
  gdouble a[2 * N], diagonal[N], b[2 * N];

  for (guint i = 0; i < N; i++) {
    a[2 * i] = -1;
    CLOTH_BAND (a, 1, i, i) = 2;
    /* the solution of −x'' = 2 with zeros at the ends is i (n + 1 − i) */
    b[2 * i] = 2;
    b[2 * i + 1] = i == 0;
  }
  g_assert_true (cloth_band_factor (N, 1, a));
  cloth_band_solve (N, 1, a, 2, b);
  cloth_band_inverse_diagonal (N, 1, a, diagonal);
  for (guint i = 0; i < N; i++) {
    g_assert_cmpfloat_with_epsilon (diagonal[i], (i + 1.) * (N - i) / (N + 1.),
        1e-10);
    g_assert_cmpfloat_with_epsilon (b[2 * i], (i + 1.) * (N - i), 1e-9);
    g_assert_cmpfloat_with_epsilon (b[2 * i + 1], (N - i) / (N + 1.), 1e-10);
  }
}

static void
test_dense (void)
{
  enum
  { N = 31, W = 7 };
  static gdouble band[N * (W + 1)], dense[N * N];
  gdouble x[N], y[N], inverse[N * N], diagonal[N];
  ClothRandom random;

  cloth_random_init (&random, 3);
  for (guint i = 0; i < N; i++)
    for (guint j = i > W ? i - W : 0; j <= i; j++) {
      gdouble value = i == j ? 2 * W : cloth_random_gaussian (&random);

      CLOTH_BAND (band, W, i, j) = value;
      dense[i * N + j] = dense[j * N + i] = value;
    }
  for (guint i = 0; i < N; i++)
    x[i] = y[i] = cloth_random_gaussian (&random);
  g_assert_true (cloth_band_factor (N, W, band));
  g_assert_true (cloth_cholesky_factor (N, dense));
  cloth_band_solve (N, W, band, 1, x);
  cloth_cholesky_solve (N, dense, y);
  cloth_cholesky_inverse (N, dense, inverse);
  cloth_band_inverse_diagonal (N, W, band, diagonal);
  for (guint i = 0; i < N; i++) {
    g_assert_cmpfloat_with_epsilon (x[i], y[i], 1e-12);
    g_assert_cmpfloat_with_epsilon (diagonal[i], inverse[i * N + i], 1e-12);
  }
}

static void
test_not_positive (void)
{
  gdouble indefinite[4] = { 0, 1, 2, 1 };
  gdouble singular[6] = { 0, 1, -1, 2, -1, 1 };
  gdouble nan[4] = { 0, 1, NAN, 4 };
  gdouble zero[1] = { 0 };

  g_assert_false (cloth_band_factor (2, 1, indefinite));
  /* nothing holds the two ends: constants are free */
  g_assert_false (cloth_band_factor (3, 1, singular));
  g_assert_false (cloth_band_factor (2, 1, nan));
  g_assert_false (cloth_band_factor (1, 0, zero));
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/band/tridiagonal", test_tridiagonal);
  g_test_add_func ("/band/dense", test_dense);
  g_test_add_func ("/band/not-positive", test_not_positive);
  return g_test_run ();
}
