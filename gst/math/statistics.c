/* Order statistics and the χ² distribution.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/math/statistics.h"

#include <math.h>
#include <stdlib.h>

/* @a: (type gdouble): a number
 * @b: (type gdouble): another one
 *
 * For qsort () and g_array_sort (), the least number first.
 *
 * Returns: −1 when @a is less than @b, 1 when it is greater, 0 otherwise
 */
gint
cloth_compare_doubles (gconstpointer a, gconstpointer b)
{
  const gdouble x = *(const gdouble *) a, y = *(const gdouble *) b;

  return (x > y) - (x < y);
}

/* @values: numbers, none of them NaN; they are sorted afterwards, the least first
 * @n: how many
 *
 * Returns: their median, of an even number the greater of the two in the middle;
 *   NaN: there are none
 */
gdouble
cloth_median (gdouble * values, gsize n)
{
  if (n == 0)
    return NAN;
  qsort (values, n, sizeof *values, cloth_compare_doubles);
  return values[n / 2];
}

/* @x: a number
 * @n: degrees of freedom, at least 1
 *
 * Exact for 1, 2 and 3 degrees of freedom:
 *   erfc √(x/2),  exp (−x/2),  erfc √(x/2) + √(2x/π) exp (−x/2).
 * Above, the cube root of χ²/n is nearly normal with mean 1 − 2/(9n) and variance 2/(9n)
 * (Wilson and Hilferty 1931).
 *
 * Returns: P(χ² > @x)
 */
gdouble
cloth_chi_square_tail (gdouble x, guint n)
{
  const gdouble half = 0.5 * MAX (x, 0.);
  gdouble z;

  switch (n) {
    case 1:
      return erfc (sqrt (half));
    case 2:
      return exp (-half);
    case 3:
      return erfc (sqrt (half)) + 2. * sqrt (half / G_PI) * exp (-half);
    default:
      z = (cbrt (x / n) - (1. - 2. / (9. * n))) / sqrt (2. / (9. * n));
      return 0.5 * erfc (z * M_SQRT1_2);
  }
}

static guint
common_divisor (guint a, guint b)
{
  while (b) {
    guint rest = a % b;

    a = b;
    b = rest;
  }
  return a;
}

/* @least: a step, at least 1
 * @n: a number; 0: any step will do
 *
 * Returns: the shortest step, from @least on, that has no divisor in common with @n: of @n things in
 *   a ring it comes to all, of rows of @n to every column
 */
guint
cloth_coprime_step (guint least, guint n)
{
  while (n && common_divisor (least, n) > 1)
    least++;
  return least;
}
