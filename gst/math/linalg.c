/* Small dense linear algebra: 3×3, symmetric eigenproblems, Cholesky, least squares.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/math/linalg.h"

#include <math.h>
#include <string.h>

/**
 * SECTION:linalg
 *
 * Matrices are row-major. No function allocates. The outputs of the 3×3 functions may be
 * one of their inputs.
 */

/* @a: left factor
 * @b: right factor
 * @ab: (out): a·b
 */
void
cloth_mat3_mul (const gdouble a[9], const gdouble b[9], gdouble ab[9])
{
  gdouble m[9];

  for (gint i = 0; i < 3; i++)
    for (gint j = 0; j < 3; j++)
      m[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] +
          a[3 * i + 2] * b[6 + j];
  memcpy (ab, m, sizeof (m));
}

/* @a: left factor, taken transposed
 * @b: right factor
 * @atb: (out): aᵀ·b
 */
void
cloth_mat3_mul_tn (const gdouble a[9], const gdouble b[9], gdouble atb[9])
{
  gdouble m[9];

  for (gint i = 0; i < 3; i++)
    for (gint j = 0; j < 3; j++)
      m[3 * i + j] = a[i] * b[j] + a[3 + i] * b[3 + j] + a[6 + i] * b[6 + j];
  memcpy (atb, m, sizeof (m));
}

/* @a: left factor
 * @b: right factor, taken transposed
 * @abt: (out): a·bᵀ
 */
void
cloth_mat3_mul_nt (const gdouble a[9], const gdouble b[9], gdouble abt[9])
{
  gdouble m[9];

  for (gint i = 0; i < 3; i++)
    for (gint j = 0; j < 3; j++)
      m[3 * i + j] = a[3 * i] * b[3 * j] + a[3 * i + 1] * b[3 * j + 1] +
          a[3 * i + 2] * b[3 * j + 2];
  memcpy (abt, m, sizeof (m));
}

/* @a: matrix
 * @x: vector
 * @ax: (out): a·x
 */
void
cloth_mat3_vec (const gdouble a[9], const gdouble x[3], gdouble ax[3])
{
  gdouble x0 = x[0], x1 = x[1], x2 = x[2];

  for (gint i = 0; i < 3; i++)
    ax[i] = a[3 * i] * x0 + a[3 * i + 1] * x1 + a[3 * i + 2] * x2;
}

/* @a: matrix, taken transposed
 * @x: vector
 * @atx: (out): aᵀ·x
 */
void
cloth_mat3_vec_t (const gdouble a[9], const gdouble x[3], gdouble atx[3])
{
  gdouble x0 = x[0], x1 = x[1], x2 = x[2];

  for (gint i = 0; i < 3; i++)
    atx[i] = a[i] * x0 + a[3 + i] * x1 + a[6 + i] * x2;
}

/* @a: matrix
 *
 * Returns: its determinant
 */
gdouble
cloth_mat3_det (const gdouble a[9])
{
  return a[0] * (a[4] * a[8] - a[5] * a[7]) -
      a[1] * (a[3] * a[8] - a[5] * a[6]) + a[2] * (a[3] * a[7] - a[4] * a[6]);
}

/* @a: matrix
 * @inverse: (out): its inverse, by the adjugate
 *
 * Returns: %FALSE, and @inverse untouched, when @a is singular or not finite
 */
gboolean
cloth_mat3_inverse (const gdouble a[9], gdouble inverse[9])
{
  gdouble det = cloth_mat3_det (a), scale = 0., m[9];

  for (gint i = 0; i < 9; i++)
    scale = fmax (scale, fabs (a[i]));
  /* the determinant's own rounding is a few ulp of scale³ */
  if (!isfinite (det) || fabs (det) <= 1e-15 * scale * scale * scale)
    return FALSE;
  m[0] = a[4] * a[8] - a[5] * a[7];
  m[1] = a[2] * a[7] - a[1] * a[8];
  m[2] = a[1] * a[5] - a[2] * a[4];
  m[3] = a[5] * a[6] - a[3] * a[8];
  m[4] = a[0] * a[8] - a[2] * a[6];
  m[5] = a[2] * a[3] - a[0] * a[5];
  m[6] = a[3] * a[7] - a[4] * a[6];
  m[7] = a[1] * a[6] - a[0] * a[7];
  m[8] = a[0] * a[4] - a[1] * a[3];
  for (gint i = 0; i < 9; i++)
    inverse[i] = m[i] / det;
  return TRUE;
}

/* @a: any matrix, for instance a rotation with errors, or Σ y·xᵀ over pairs of points
 * @r: (out): the proper rotation that maximises trace (rᵀ·a)
 *
 * The rotation nearest to @a in the Frobenius norm; for @a = Σ y·xᵀ the one that best
 * takes the x onto the y. Horn, Closed-form solution of absolute orientation using unit
 * quaternions, 1987.
 *
 * Returns: %FALSE when @a is not finite or the rotation is not determined
 */
gboolean
cloth_mat3_nearest_rotation (const gdouble a[9], gdouble r[9])
{
  /* Horn's S is Σ x·yᵀ, the transpose of a */
  gdouble sxx = a[0], sxy = a[3], sxz = a[6];
  gdouble syx = a[1], syy = a[4], syz = a[7];
  gdouble szx = a[2], szy = a[5], szz = a[8];
  gdouble n[16] = {
    sxx + syy + szz, syz - szy, szx - sxz, sxy - syx,
    syz - szy, sxx - syy - szz, sxy + syx, szx + sxz,
    szx - sxz, sxy + syx, syy - sxx - szz, syz + szy,
    sxy - syx, szx + sxz, syz + szy, szz - sxx - syy
  };
  gdouble values[4], v[16], w, x, y, z;

  if (!cloth_sym_eigen (4, n, values, v) ||
      values[3] - values[2] <= 1e-13 * fmax (fabs (values[0]), values[3]))
    return FALSE;
  w = v[12], x = v[13], y = v[14], z = v[15];
  r[0] = w * w + x * x - y * y - z * z;
  r[1] = 2. * (x * y - w * z);
  r[2] = 2. * (x * z + w * y);
  r[3] = 2. * (x * y + w * z);
  r[4] = w * w - x * x + y * y - z * z;
  r[5] = 2. * (y * z - w * x);
  r[6] = 2. * (x * z - w * y);
  r[7] = 2. * (y * z + w * x);
  r[8] = w * w - x * x - y * y + z * z;
  return TRUE;
}

/* @n: order, 1 … %CLOTH_EIGEN_MAX
 * @a: symmetric n×n matrix; only its upper triangle is read
 * @values: (out): n eigenvalues, ascending
 * @vectors: (out): n×n; row i is the unit eigenvector of values[i]
 *
 * Cyclic Jacobi (Golub & Van Loan, Matrix Computations, 8.5): slow for large n but
 * accurate to the last digits, also for small eigenvalues' vectors.
 *
 * Returns: %FALSE when @n is out of range or @a is not finite
 */
gboolean
cloth_sym_eigen (guint n, const gdouble * a, gdouble * values,
    gdouble * vectors)
{
  gdouble m[CLOTH_EIGEN_MAX][CLOTH_EIGEN_MAX];
  gdouble v[CLOTH_EIGEN_MAX][CLOTH_EIGEN_MAX];
  guint order[CLOTH_EIGEN_MAX];
  gdouble norm = 0.;

  if (n < 1 || n > CLOTH_EIGEN_MAX)
    return FALSE;
  for (guint i = 0; i < n; i++) {
    for (guint j = i; j < n; j++) {
      if (!isfinite (a[i * n + j]))
        return FALSE;
      m[i][j] = m[j][i] = a[i * n + j];
      norm = fmax (norm, fabs (m[i][j]));
      v[i][j] = v[j][i] = i == j ? 1. : 0.;
    }
  }

  for (guint sweep = 0; sweep < 60; sweep++) {
    gdouble off = 0.;

    for (guint p = 0; p + 1 < n; p++)
      for (guint q = p + 1; q < n; q++)
        off = fmax (off, fabs (m[p][q]));
    if (off <= 1e-300 || off <= 1e-18 * norm)
      break;
    for (guint p = 0; p + 1 < n; p++) {
      for (guint q = p + 1; q < n; q++) {
        gdouble theta, t, c, s;

        if (fabs (m[p][q]) <= 1e-300)
          continue;
        theta = (m[q][q] - m[p][p]) / (2. * m[p][q]);
        t = (theta < 0. ? -1. : 1.) /
            (fabs (theta) + sqrt (theta * theta + 1.));
        c = 1. / sqrt (t * t + 1.);
        s = t * c;
        for (guint k = 0; k < n; k++) {
          gdouble kp = m[k][p], kq = m[k][q];

          m[k][p] = c * kp - s * kq;
          m[k][q] = s * kp + c * kq;
        }
        for (guint k = 0; k < n; k++) {
          gdouble pk = m[p][k], qk = m[q][k];
          gdouble vp = v[p][k], vq = v[q][k];

          m[p][k] = c * pk - s * qk;
          m[q][k] = s * pk + c * qk;
          v[p][k] = c * vp - s * vq;
          v[q][k] = s * vp + c * vq;
        }
        m[p][q] = m[q][p] = 0.;
      }
    }
  }

  for (guint i = 0; i < n; i++) {
    guint j = i;

    for (; j > 0 && m[order[j - 1]][order[j - 1]] > m[i][i]; j--)
      order[j] = order[j - 1];
    order[j] = i;
  }
  for (guint i = 0; i < n; i++) {
    values[i] = m[order[i]][order[i]];
    memcpy (vectors + i * n, v[order[i]], n * sizeof (gdouble));
  }
  return TRUE;
}

/* @n: order
 * @a: (inout): symmetric n×n matrix, of which the lower triangle is read; it becomes L
 *   with a = L·Lᵀ. The strict upper triangle is left alone.
 *
 * Returns: %FALSE when @a is not positive definite to working precision, or not
 *   finite; @a is then destroyed
 */
gboolean
cloth_cholesky_factor (guint n, gdouble * a)
{
  for (guint i = 0; i < n; i++) {
    gdouble *ri = a + (gsize) i * n;
    gdouble diagonal = ri[i];

    for (guint j = 0; j <= i; j++) {
      const gdouble *rj = a + (gsize) j * n;
      gdouble sum = ri[j];

      for (guint k = 0; k < j; k++)
        sum -= ri[k] * rj[k];
      if (j < i) {
        ri[j] = sum / rj[j];
      } else {
        /* what is left of the diagonal is rounding: rank deficient */
        if (!(sum > 4. * G_MINDOUBLE && sum > n * 1e-16 * diagonal)
            || !isfinite (sum))
          return FALSE;
        ri[i] = sqrt (sum);
      }
    }
  }
  return TRUE;
}

/* @n: order
 * @l: factor made by cloth_cholesky_factor ()
 * @b: (inout): n right-hand sides; becomes the solution
 */
void
cloth_cholesky_solve (guint n, const gdouble * l, gdouble * b)
{
  for (guint i = 0; i < n; i++) {
    const gdouble *row = l + (gsize) i * n;
    gdouble sum = b[i];

    for (guint k = 0; k < i; k++)
      sum -= row[k] * b[k];
    b[i] = sum / row[i];
  }
  for (guint i = n; i-- > 0;) {
    gdouble x = b[i] /= l[(gsize) i * n + i];

    for (guint k = 0; k < i; k++)
      b[k] -= l[(gsize) i * n + k] * x;
  }
}

/* @n: order
 * @l: factor made by cloth_cholesky_factor ()
 * @inverse: (out): n×n, the inverse of the matrix factored, both triangles
 */
void
cloth_cholesky_inverse (guint n, const gdouble * l, gdouble * inverse)
{
  for (guint j = 0; j < n; j++) {
    gdouble *column = inverse + (gsize) j * n;

    /* symmetric: the columns found are written as rows */
    memset (column, 0, n * sizeof (gdouble));
    column[j] = 1.;
    cloth_cholesky_solve (n, l, column);
  }
  for (guint i = 0; i < n; i++)
    for (guint j = 0; j < i; j++) {
      gdouble mean = 0.5 * (inverse[(gsize) i * n + j] +
          inverse[(gsize) j * n + i]);

      inverse[(gsize) i * n + j] = inverse[(gsize) j * n + i] = mean;
    }
}

/* @m: rows, >= @n
 * @n: unknowns
 * @a: (inout): m×n matrix; destroyed
 * @b: (inout): m right-hand sides; b[0 … n) becomes the x that minimises ‖a·x − b‖ and
 *   the sum of squares of the rest is the residual's
 *
 * By Householder reflections (Golub & Van Loan, 5.3), which keep twice the digits that
 * the normal equations do.
 *
 * Returns: %FALSE when @m < @n, the columns are dependent or anything is not finite
 */
gboolean
cloth_least_squares (guint m, guint n, gdouble * a, gdouble * b)
{
  if (m < n || n < 1)
    return FALSE;
  for (guint j = 0; j < n; j++) {
    gdouble tail = 0., whole = 0., alpha, beta;

    for (guint i = 0; i < m; i++) {
      gdouble x = a[(gsize) i * n + j];

      whole += x * x;
      if (i >= j)
        tail += x * x;
    }
    /* not greater also when it is NaN */
    if (!(tail > 1e-28 * whole) || !isfinite (whole))
      return FALSE;
    alpha = a[(gsize) j * n + j];
    alpha = alpha > 0. ? -sqrt (tail) : sqrt (tail);
    /* v = x − alpha·e, kept in the column; ‖v‖² = 2·beta */
    beta = tail - alpha * a[(gsize) j * n + j];
    a[(gsize) j * n + j] -= alpha;
    for (guint k = j + 1; k < n; k++) {
      gdouble dot = 0.;

      for (guint i = j; i < m; i++)
        dot += a[(gsize) i * n + j] * a[(gsize) i * n + k];
      dot /= beta;
      for (guint i = j; i < m; i++)
        a[(gsize) i * n + k] -= dot * a[(gsize) i * n + j];
    }
    {
      gdouble dot = 0.;

      for (guint i = j; i < m; i++)
        dot += a[(gsize) i * n + j] * b[i];
      dot /= beta;
      for (guint i = j; i < m; i++)
        b[i] -= dot * a[(gsize) i * n + j];
    }
    a[(gsize) j * n + j] = alpha;
  }
  for (guint j = n; j-- > 0;) {
    for (guint k = j + 1; k < n; k++)
      b[j] -= a[(gsize) j * n + k] * b[k];
    b[j] /= a[(gsize) j * n + j];
    if (!isfinite (b[j]))
      return FALSE;
  }
  return TRUE;
}
