/* Views of a flat board: homography, focal length, pose.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/planar.h"

#include <math.h>

#include "gst/math/linalg.h"

/* Points this much thinner than long lie on a line. */
#define MIN_THICKNESS 1e-3

/* Takes the points' centre to 0 and their RMS radius to √2: out = s·(in − c). Returns
 * their thickness: smallest over largest extent. */
static gdouble
normalise (guint n, const gdouble * a, const gdouble * b, gdouble c[2],
    gdouble * s)
{
  gdouble aa = 0, ab = 0, bb = 0, middle, half;

  c[0] = c[1] = 0;
  for (guint i = 0; i < n; i++) {
    c[0] += a[i] / n;
    c[1] += b[i] / n;
  }
  for (guint i = 0; i < n; i++) {
    aa += (a[i] - c[0]) * (a[i] - c[0]) / n;
    ab += (a[i] - c[0]) * (b[i] - c[1]) / n;
    bb += (b[i] - c[1]) * (b[i] - c[1]) / n;
  }
  *s = sqrt (2 / (aa + bb));
  middle = 0.5 * (aa + bb);
  half = sqrt (0.25 * (aa - bb) * (aa - bb) + ab * ab);
  return sqrt (fmax (0, middle - half) / (middle + half));
}

/* @n: points, at least 4
 * @X: (array length=n): first coordinate on the plane
 * @Y: (array length=n): second coordinate on the plane
 * @x: (array length=n): first coordinate in the picture
 * @y: (array length=n): second coordinate in the picture
 * @H: (out): row-major, (x, y, 1) ~ H (X, Y, 1)
 *
 * Normalised direct linear transform: Hartley and Zisserman, "Multiple View Geometry",
 * algorithm 4.2.
 *
 * Returns: %FALSE when the points don't determine it: too few, or on a line.
 */
gboolean
cloth_planar_homography (guint n, const gdouble * X, const gdouble * Y,
    const gdouble * x, const gdouble * y, gdouble H[9])
{
  gdouble A[81] = { 0, }, values[9], vectors[81];
  gdouble C[2], c[2], S, s;
  const gdouble *h;

  if (n < 4 || !(normalise (n, X, Y, C, &S) > MIN_THICKNESS)
      || !(normalise (n, x, y, c, &s) > MIN_THICKNESS))
    return FALSE;
  for (guint i = 0; i < n; i++) {
    gdouble P[3] = { S * (X[i] - C[0]), S * (Y[i] - C[1]), 1 };
    gdouble p[2] = { s * (x[i] - c[0]), s * (y[i] - c[1]) };

    for (gint e = 0; e < 2; e++) {
      gdouble row[9] = { 0, };

      for (gint j = 0; j < 3; j++) {
        row[3 * e + j] = P[j];
        row[6 + j] = -p[e] * P[j];
      }
      for (gint j = 0; j < 9; j++) {
        for (gint k = 0; k < 9; k++)
          A[9 * j + k] += row[j] * row[k];
      }
    }
  }
  if (!cloth_sym_eigen (9, A, values, vectors))
    return FALSE;
  h = vectors;                  /* of the smallest eigenvalue */
  /* H = N(x)⁻¹ h N(X) */
  for (gint i = 0; i < 3; i++) {
    gdouble row[3];

    for (gint j = 0; j < 3; j++)
      row[j] = i < 2 ? h[3 * i + j] / s + c[i] * h[6 + j] : h[6 + j];
    H[3 * i] = row[0] * S;
    H[3 * i + 1] = row[1] * S;
    H[3 * i + 2] = row[2] - S * (row[0] * C[0] + row[1] * C[1]);
  }
  return TRUE;
}

/* @n_views: views
 * @H: (array): 9 numbers a view: homographies from the board to pixels
 * @cx: assumed principal point, px
 * @cy: assumed principal point, px
 * @focal: (out): fx, fy, px
 *
 * The two directions of the board are orthogonal and of equal length, which gives two
 * equations a view in 1/fx² and 1/fy². Z. Zhang, "A flexible new technique for camera
 * calibration", 2000, section 3.1, with skew 0 and a known principal point.
 *
 * Returns: %FALSE when the views don't determine it, as when all are seen straight on.
 */
gboolean
cloth_planar_focal (guint n_views, const gdouble * H, gdouble cx, gdouble cy,
    gdouble focal[2])
{
  gdouble N[3] = { 0, 0, 0 }, b[2] = { 0, 0 }, one[2] = { 0, 0 };
  gdouble det, inverse[2];

  for (guint v = 0; v < n_views; v++) {
    const gdouble *h = H + 9 * (gsize) v;
    gdouble u[3], w[3], rows[2][3];

    u[2] = h[6];
    w[2] = h[7];
    u[0] = h[0] - cx * u[2];
    w[0] = h[1] - cx * w[2];
    u[1] = h[3] - cy * u[2];
    w[1] = h[4] - cy * w[2];
    for (gint j = 0; j < 3; j++) {
      rows[0][j] = u[j] * w[j];
      rows[1][j] = u[j] * u[j] - w[j] * w[j];
    }
    for (gint r = 0; r < 2; r++) {
      gdouble scale = u[0] * u[0] + u[1] * u[1] + w[0] * w[0] + w[1] * w[1];
      gdouble p = rows[r][0] / scale, q = rows[r][1] / scale;
      gdouble c = -rows[r][2] / scale * (cx * cx + cy * cy);

      N[0] += p * p;
      N[1] += p * q;
      N[2] += q * q;
      b[0] += p * c;
      b[1] += q * c;
      one[0] += (p + q) * (p + q);
      one[1] += (p + q) * c;
    }
  }
  det = N[0] * N[2] - N[1] * N[1];
  inverse[0] = (b[0] * N[2] - b[1] * N[1]) / det;
  inverse[1] = (b[1] * N[0] - b[0] * N[1]) / det;
  /* Far from square pixels: noise. One focal length is better determined. */
  if (!(det > 1e-12 * N[0] * N[2]) || !(inverse[0] > 0) || !(inverse[1] > 0)
      || !(inverse[0] < 2 * inverse[1]) || !(inverse[1] < 2 * inverse[0]))
    inverse[0] = inverse[1] = one[1] / one[0];
  for (gint i = 0; i < 2; i++) {
    focal[i] = sqrt ((cx * cx + cy * cy) / inverse[i]);
    if (!isfinite (focal[i]) || !(focal[i] > 0))
      return FALSE;
  }
  return TRUE;
}

/* @H: homography from the board (m) to normalised coordinates
 * @R: (out): row-major rotation, board to camera
 * @t: (out): translation, m
 *
 * Zhang, section 3.1, with the nearest rotation; the board lies in front of the camera.
 *
 * Returns: %FALSE when @H is no view of a plane.
 */
gboolean
cloth_planar_pose (const gdouble H[9], gdouble R[9], gdouble t[3])
{
  gdouble a = sqrt (H[0] * H[0] + H[3] * H[3] + H[6] * H[6]);
  gdouble b = sqrt (H[1] * H[1] + H[4] * H[4] + H[7] * H[7]);
  gdouble scale = 2 / (a + b), M[9];

  if (H[8] < 0)
    scale = -scale;
  if (!isfinite (scale))
    return FALSE;
  for (gint i = 0; i < 3; i++) {
    M[3 * i] = scale * H[3 * i];
    M[3 * i + 1] = scale * H[3 * i + 1];
    t[i] = scale * H[3 * i + 2];
  }
  for (gint i = 0; i < 3; i++) {
    gint j = (i + 1) % 3, k = (i + 2) % 3;

    M[3 * i + 2] = M[3 * j] * M[3 * k + 1] - M[3 * k] * M[3 * j + 1];
  }
  return t[2] > 0 && cloth_mat3_nearest_rotation (M, R);
}
