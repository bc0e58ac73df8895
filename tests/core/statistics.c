/* Medians by hand; the tails of χ² against tables and closed forms.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <stdlib.h>

#include "gst/math/statistics.h"

static void
test_compare (void)
{
  const gdouble numbers[] = { -INFINITY, -1., 0., 1e-300, 2., INFINITY };

  for (guint i = 0; i < G_N_ELEMENTS (numbers); i++)
    for (guint j = 0; j < G_N_ELEMENTS (numbers); j++)
      g_assert_cmpint (cloth_compare_doubles (&numbers[i], &numbers[j]), ==,
          (i > j) - (i < j));
}

static void
test_median (void)
{
  gdouble odd[] = { 3., -7., 1e9 }, even[] = { 4., 1., 3., 2. }, one = 5.;

  g_assert_true (isnan (cloth_median (NULL, 0)));
  g_assert_cmpfloat (cloth_median (&one, 1), ==, 5.);
  g_assert_cmpfloat (cloth_median (odd, 3), ==, 3.);
  /* of an even number, the greater of the two in the middle */
  g_assert_cmpfloat (cloth_median (even, 4), ==, 3.);
  for (guint i = 0; i < 4; i++)
    g_assert_cmpfloat (even[i], ==, i + 1.);
}

static void
test_chi_square (void)
{
  /* the 5% points of printed tables */
  const gdouble five_percent[] =
      { 3.841459, 5.991465, 7.814728, 9.487729, 11.070498, 12.591587 };

  for (guint n = 1; n <= G_N_ELEMENTS (five_percent); n++)
    g_assert_cmpfloat_with_epsilon (cloth_chi_square_tail (five_percent[n - 1],
            n), 0.05, n <= 3 ? 1e-7 : 1e-3);
  for (guint n = 1; n <= 3; n++) {
    g_assert_cmpfloat (cloth_chi_square_tail (0., n), ==, 1.);
    g_assert_cmpfloat (cloth_chi_square_tail (-1., n), ==, 1.);
  }
  /* n even: exp (−x/2) Σ (x/2)^k / k!, k < n/2 */
  for (gdouble x = 1.; x < 40.; x *= 1.5) {
    gdouble term = exp (-x / 2), sum = 0.;

    for (guint n = 2; n <= 12; n += 2) {
      sum += term;
      term *= x / n;
      g_assert_cmpfloat_with_epsilon (cloth_chi_square_tail (x, n), sum,
          n == 2 ? 1e-15 : 5e-3);
    }
  }
}

gint
main (gint argc, gchar ** argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/statistics/compare", test_compare);
  g_test_add_func ("/statistics/median", test_median);
  g_test_add_func ("/statistics/chi-square", test_chi_square);
  return g_test_run ();
}
