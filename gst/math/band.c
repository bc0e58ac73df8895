/* Symmetric banded matrices: Cholesky, solutions, the inverse's diagonal.
 *
 * The holes of a mesh give many small systems whose unknowns, in the order of a walk from
 * one end to the other, touch only near ones. A band then holds the factor as well as
 * lists of indices would, its inner loops are dot products of rows, and the inverse's
 * diagonal comes from the same band, which packages for sparse factors don't offer.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/math/band.h"

#include <math.h>
#include <string.h>

/* What is left of a pivot that is nothing but rounding, of its diagonal. */
#define PIVOT_FLOOR 1e-11

/* @n: order
 * @bandwidth: greatest distance of a nonzero element from the diagonal
 * @a: (inout) (array): n·(bandwidth + 1), see CLOTH_BAND(); elements left of the first
 *   column are not looked at. Becomes the factor L, A = L Lᵀ
 *
 * Returns: %FALSE when @a isn't positive definite to working precision
 */
gboolean
cloth_band_factor (guint n, guint bandwidth, gdouble * a)
{
  for (guint i = 0; i < n; i++) {
    guint first = i > bandwidth ? i - bandwidth : 0;
    gdouble *ri = &CLOTH_BAND (a, bandwidth, i, first);
    gdouble diagonal = ri[i - first];

    for (guint j = first; j <= i; j++) {
      guint start = j > bandwidth ? j - bandwidth : 0;
      const gdouble *rj;
      gdouble sum = ri[j - first];

      start = MAX (start, first);
      rj = &CLOTH_BAND (a, bandwidth, j, start);
      for (guint k = start; k < j; k++)
        sum -= ri[k - first] * rj[k - start];
      if (j < i) {
        ri[j - first] = sum / CLOTH_BAND (a, bandwidth, j, j);
      } else {
        if (!(sum > PIVOT_FLOOR * diagonal) || !isfinite (sum))
          return FALSE;
        ri[j - first] = sqrt (sum);
      }
    }
  }
  return TRUE;
}

/* @n: order
 * @bandwidth: bandwidth
 * @l: factor made by cloth_band_factor ()
 * @columns: number of right-hand sides
 * @b: (inout) (array): n·columns, row by row; becomes the solutions
 */
void
cloth_band_solve (guint n, guint bandwidth, const gdouble * l, guint columns,
    gdouble * b)
{
  for (guint i = 0; i < n; i++) {
    guint first = i > bandwidth ? i - bandwidth : 0;
    const gdouble *row = &CLOTH_BAND (l, bandwidth, i, first);
    gdouble *bi = b + (gsize) i * columns;

    for (guint k = first; k < i; k++)
      for (guint c = 0; c < columns; c++)
        bi[c] -= row[k - first] * b[(gsize) k * columns + c];
    for (guint c = 0; c < columns; c++)
      bi[c] /= row[i - first];
  }
  for (guint i = n; i-- > 0;) {
    guint first = i > bandwidth ? i - bandwidth : 0;
    const gdouble *row = &CLOTH_BAND (l, bandwidth, i, first);
    gdouble *bi = b + (gsize) i * columns;

    for (guint c = 0; c < columns; c++)
      bi[c] /= row[i - first];
    for (guint k = first; k < i; k++)
      for (guint c = 0; c < columns; c++)
        b[(gsize) k * columns + c] -= row[k - first] * bi[c];
  }
}

/* Adds the products of rows of @window with numbers of @l to @sums, four rows at a time: in the order of the rows. */
static void
add_rows (const gdouble * window, guint width, const guint * slots,
    const gdouble * l, guint n, gdouble * sums)
{
  guint k = 0;

  for (; k + 4 <= n; k += 4) {
    const gdouble *a = window + (gsize) slots[k] * width;
    const gdouble *b = window + (gsize) slots[k + 1] * width;
    const gdouble *c = window + (gsize) slots[k + 2] * width;
    const gdouble *d = window + (gsize) slots[k + 3] * width;

    for (guint i = 0; i < width; i++)
      sums[i] = (((sums[i] + l[k] * a[i]) + l[k + 1] * b[i]) +
          l[k + 2] * c[i]) + l[k + 3] * d[i];
  }
  for (; k < n; k++)
    for (guint i = 0; i < width; i++)
      sums[i] += l[k] * window[(gsize) slots[k] * width + i];
}

/* @n: order
 * @bandwidth: bandwidth
 * @l: factor made by cloth_band_factor ()
 * @diagonal: (out) (array): the n elements of the diagonal of the inverse
 *
 * From the elements of the inverse within the band alone (K. Takahashi, J. Fagan, M.-S.
 * Chin, “Formation of a sparse bus impedance matrix”, 1973). Of these a column needs those of the @bandwidth
 * columns behind it: a full square, in which row i is at i modulo bandwidth + 1.
 */
void
cloth_band_inverse_diagonal (guint n, guint bandwidth, const gdouble * l,
    gdouble * diagonal)
{
  const guint width = bandwidth + 1;
  g_autofree gdouble *window = g_new0 (gdouble, (gsize) width * width);
  g_autofree gdouble *sums = g_new (gdouble, width);
  g_autofree gdouble *column = g_new (gdouble, width);
  g_autofree guint *slots = g_new (guint, width);

  for (guint j = n; j-- > 0;) {
    const guint last = MIN (j + bandwidth, n - 1), own = j % width;
    const gdouble pivot = CLOTH_BAND (l, bandwidth, j, j);
    gdouble sum = 1 / pivot;

    for (guint k = j + 1; k <= last; k++) {
      slots[k - j - 1] = k % width;
      column[k - j - 1] = CLOTH_BAND (l, bandwidth, k, j);
    }
    memset (sums, 0, width * sizeof *sums);
    add_rows (window, width, slots, column, last - j, sums);
    for (guint k = 0; k < last - j; k++) {
      const gdouble z = -sums[slots[k]] / pivot;

      window[(gsize) own * width + slots[k]] = z;
      window[(gsize) slots[k] * width + own] = z;
      sum -= column[k] * z;
    }
    diagonal[j] = window[(gsize) own * width + own] = sum / pivot;
  }
}
