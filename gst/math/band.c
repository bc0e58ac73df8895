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

/* @n: order
 * @bandwidth: bandwidth
 * @l: factor made by cloth_band_factor ()
 * @work: (array): n·(bandwidth + 1) numbers to work in
 * @diagonal: (out) (array): the n elements of the diagonal of the inverse
 *
 * From the elements of the inverse within the band alone (K. Takahashi, J. Fagan, M.-S.
 * Chin, “Formation of a sparse bus impedance matrix”, 1973).
 */
void
cloth_band_inverse_diagonal (guint n, guint bandwidth, const gdouble * l,
    gdouble * work, gdouble * diagonal)
{
  for (guint j = n; j-- > 0;) {
    guint last = MIN (j + bandwidth, n - 1);
    gdouble pivot = CLOTH_BAND (l, bandwidth, j, j), sum;

    for (guint i = j + 1; i <= last; i++) {
      sum = 0;
      for (guint k = j + 1; k <= last; k++)
        sum += CLOTH_BAND (l, bandwidth, k, j)
            * (k > i ? CLOTH_BAND (work, bandwidth, k, i)
            : CLOTH_BAND (work, bandwidth, i, k));
      CLOTH_BAND (work, bandwidth, i, j) = -sum / pivot;
    }
    sum = 1 / pivot;
    for (guint k = j + 1; k <= last; k++)
      sum -= CLOTH_BAND (l, bandwidth, k, j)
          * CLOTH_BAND (work, bandwidth, k, j);
    diagonal[j] = CLOTH_BAND (work, bandwidth, j, j) = sum / pivot;
  }
}
