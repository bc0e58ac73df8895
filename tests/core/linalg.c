/* Dense algebra against closed forms: Hilbert matrices, the discrete Laplacian, known
 * rotations, an exactly solvable fit.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/math/random.h"

static void
assert_near (const gdouble * a, const gdouble * b, guint n, gdouble tolerance)
{
  for (guint i = 0; i < n; i++)
    g_assert_cmpfloat (fabs (a[i] - b[i]), <=, tolerance);
}

static void
test_mat3 (void)
{
  const gdouble a[9] = { 2., 0., 1., 1., 3., 2., 1., 1., 1. };
  const gdouble b[9] = { 0., -1., 0., 1., 0., 0., 0., 0., 1. };
  const gdouble ab[9] = { 0., -2., 1., 3., -1., 2., 1., -1., 1. };
  const gdouble x[3] = { 1., 2., 3. };
  const gdouble ax[3] = { 5., 13., 6. }, atx[3] = { 7., 9., 8. };
  gdouble m[9], y[3];

  /* 2·(3 − 2) + 1·(1 − 3): singular */
  g_assert_cmpfloat (cloth_mat3_det (a), ==, 0.);
  g_assert_false (cloth_mat3_inverse (a, m));

  cloth_mat3_mul (a, b, m);
  assert_near (m, ab, 9, 0.);
  cloth_mat3_vec (a, x, y);
  assert_near (y, ax, 3, 0.);
  cloth_mat3_vec_t (a, x, y);
  assert_near (y, atx, 3, 0.);
  cloth_mat3_mul_nt (b, b, m);
  assert_near (m, (gdouble[]) {
      1, 0, 0, 0, 1, 0, 0, 0, 1}, 9, 0.);
  cloth_mat3_mul_tn (b, b, m);
  assert_near (m, (gdouble[]) {
      1, 0, 0, 0, 1, 0, 0, 0, 1}, 9, 0.);

  /* a regular one: det = 2·(4.5 − 2) − 2 = 3 */

  {
    const gdouble c[9] = { 2., 0., 1., 1., 3., 2., 1., 1., 1.5 };
    gdouble i[9];

    g_assert_cmpfloat_with_epsilon (cloth_mat3_det (c), 3., 1e-14);
    g_assert_true (cloth_mat3_inverse (c, i));
    cloth_mat3_mul (c, i, m);
    assert_near (m, (gdouble[]) {
        1, 0, 0, 0, 1, 0, 0, 0, 1}, 9, 1e-14);
    memcpy (m, c, sizeof (m));
    g_assert_true (cloth_mat3_inverse (m, m));
    assert_near (m, i, 9, 0.);
  }
  memcpy (m, a, sizeof (m));
  m[4] = NAN;
  g_assert_false (cloth_mat3_inverse (m, m));
}

static void
test_rotation (void)
{
  gdouble c = cos (0.7), s = sin (0.7);
  /* about z, then its axis moved: the plain z rotation and a reflected case */
  const gdouble r[9] = { c, -s, 0., s, c, 0., 0., 0., 1. };
  const gdouble mirror[9] = { 1., 0., 0., 0., 1., 0., 0., 0., -1.0001 };
  gdouble scaled[9], found[9], a[9] = { 0. };
  ClothRandom random;

  for (gint i = 0; i < 9; i++)
    scaled[i] = 3. * r[i];
  g_assert_true (cloth_mat3_nearest_rotation (scaled, found));
  assert_near (found, r, 9, 1e-14);

  /* Σ y·xᵀ of points turned by r */
  cloth_random_init (&random, 1);
  for (gint k = 0; k < 10; k++) {
    gdouble x[3], y[3];

    for (gint i = 0; i < 3; i++)
      x[i] = cloth_random_gaussian (&random);
    cloth_mat3_vec (r, x, y);
    for (gint i = 0; i < 9; i++)
      a[i] += y[i / 3] * x[i % 3];
  }
  g_assert_true (cloth_mat3_nearest_rotation (a, found));
  assert_near (found, r, 9, 1e-13);

  /* never a reflection */
  if (cloth_mat3_nearest_rotation (mirror, found))
    g_assert_cmpfloat_with_epsilon (cloth_mat3_det (found), 1., 1e-12);
  memset (a, 0, sizeof (a));
  g_assert_false (cloth_mat3_nearest_rotation (a, found));
}

static void
test_eigen (void)
{
  /* the second difference matrix: eigenvalues 2 − 2·cos (kπ/(n+1)) */
  for (guint n = 1; n <= CLOTH_EIGEN_MAX; n++) {
    gdouble a[CLOTH_EIGEN_MAX * CLOTH_EIGEN_MAX] = { 0. };
    gdouble values[CLOTH_EIGEN_MAX], v[CLOTH_EIGEN_MAX * CLOTH_EIGEN_MAX];
    gdouble worst = 0.;

    for (guint i = 0; i < n; i++) {
      a[i * n + i] = 2.;
      if (i + 1 < n)
        a[i * n + i + 1] = a[(i + 1) * n + i] = -1.;
    }
    g_assert_true (cloth_sym_eigen (n, a, values, v));
    for (guint k = 0; k < n; k++) {
      worst = fmax (worst,
          fabs (values[k] - (2. - 2. * cos ((k + 1) * G_PI / (n + 1)))));
      for (guint i = 0; i < n; i++) {
        gdouble av = 0.;

        for (guint j = 0; j < n; j++)
          av += a[i * n + j] * v[k * n + j];
        worst = fmax (worst, fabs (av - values[k] * v[k * n + i]));
      }
    }
    g_assert_cmpfloat (worst, <, 2e-14);
  }
  {
    gdouble a[4] = { NAN, 0., 0., 1. }, values[2], v[4];

    g_assert_false (cloth_sym_eigen (2, a, values, v));
    g_assert_false (cloth_sym_eigen (0, a, values, v));
    g_assert_false (cloth_sym_eigen (CLOTH_EIGEN_MAX + 1, a, values, v));
  }
}

static void
test_cholesky (void)
{
  /* Hilbert matrices: the inverse is known in integers; order 4 */
  static const gdouble inverse4[16] = {
    16., -120., 240., -140., -120., 1200., -2700., 1680.,
    240., -2700., 6480., -4200., -140., 1680., -4200., 2800.
  };
  gdouble h[16], inverse[16], b[4];

  for (guint i = 0; i < 16; i++)
    h[i] = 1. / (i / 4 + i % 4 + 1);
  for (guint i = 0; i < 4; i++)
    b[i] = h[4 * i] + h[4 * i + 1] + h[4 * i + 2] + h[4 * i + 3];
  g_assert_true (cloth_cholesky_factor (4, h));
  cloth_cholesky_inverse (4, h, inverse);
  assert_near (inverse, inverse4, 16, 1e-8);
  cloth_cholesky_solve (4, h, b);
  assert_near (b, (gdouble[]) {
      1., 1., 1., 1.}
      , 4, 1e-12);

  /* indefinite, rank deficient, not a number */
  {
    gdouble indefinite[4] = { 1., 2., 2., 1. };
    gdouble deficient[9] = { 1., 1., 1., 1., 1., 1., 1., 1., 1. };
    gdouble nan[4] = { 1., 0., 0., NAN }, zero[1] = { 0. };

    g_assert_false (cloth_cholesky_factor (2, indefinite));
    g_assert_false (cloth_cholesky_factor (3, deficient));
    g_assert_false (cloth_cholesky_factor (2, nan));
    g_assert_false (cloth_cholesky_factor (1, zero));
  }
}

static void
test_least_squares (void)
{
  /* a line through 0 1, 1 3, 2 4, 3 4: intercept 1.5, slope 1, residual 1.0 */
  gdouble a[8] = { 1., 0., 1., 1., 1., 2., 1., 3. };
  gdouble b[4] = { 1., 3., 4., 4. };
  gdouble dependent[6] = { 1., 2., 2., 4., 3., 6. }, c[3] = { 1., 1., 1. };

  g_assert_true (cloth_least_squares (4, 2, a, b));
  g_assert_cmpfloat_with_epsilon (b[0], 1.5, 1e-14);
  g_assert_cmpfloat_with_epsilon (b[1], 1., 1e-14);
  g_assert_cmpfloat_with_epsilon (b[2] * b[2] + b[3] * b[3], 1., 1e-13);
  g_assert_false (cloth_least_squares (3, 2, dependent, c));
  g_assert_false (cloth_least_squares (1, 2, dependent, c));
}

static void
test_random (void)
{
  /* xoshiro256++'s own published first outputs for the state 1, 2, 3, 4 */
  static const guint64 reference[4] = {
    G_GUINT64_CONSTANT (41943041), G_GUINT64_CONSTANT (58720359),
    G_GUINT64_CONSTANT (3588806011781223),
    G_GUINT64_CONSTANT (3591011842654386)
  };
  ClothRandom random = { {1, 2, 3, 4} }, again;
  gdouble moment[5] = { 0. };
  guint n = 200000;

  for (guint i = 0; i < 4; i++)
    g_assert_cmpuint (cloth_random_bits (&random), ==, reference[i]);

  cloth_random_init (&random, 7);
  cloth_random_init (&again, 7);
  for (guint i = 0; i < n; i++) {
    gdouble x = cloth_random_gaussian (&random);

    g_assert_true (x == cloth_random_gaussian (&again));
    for (guint p = 1; p < 5; p++)
      moment[p] += pow (x, p) / n;
  }
  g_test_message ("gaussian moments %.4f %.4f %.4f %.4f", moment[1], moment[2],
      moment[3], moment[4]);
  /* 0, 1, 0, 3 within four standard errors */
  g_assert_cmpfloat_with_epsilon (moment[1], 0., 4. / sqrt (n));
  g_assert_cmpfloat_with_epsilon (moment[2], 1., 4. * sqrt (2. / n));
  g_assert_cmpfloat_with_epsilon (moment[3], 0., 4. * sqrt (15. / n));
  g_assert_cmpfloat_with_epsilon (moment[4], 3., 4. * sqrt (96. / n));
  for (guint i = 0; i < 1000; i++) {
    gdouble u = cloth_random_uniform (&random);

    g_assert_true (u >= 0. && u < 1.);
    g_assert_cmpuint (cloth_random_below (&random, 3), <, 3);
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/linalg/mat3", test_mat3);
  g_test_add_func ("/linalg/nearest-rotation", test_rotation);
  g_test_add_func ("/linalg/sym-eigen", test_eigen);
  g_test_add_func ("/linalg/cholesky", test_cholesky);
  g_test_add_func ("/linalg/least-squares", test_least_squares);
  g_test_add_func ("/random", test_random);
  return g_test_run ();
}
