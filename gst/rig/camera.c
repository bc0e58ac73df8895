/* One camera: pinhole with lens distortion, and its place in the world.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/camera.h"

#include <math.h>
#include <string.h>

#include "gst/math/vec3.h"
#include "gst/rig/rotation.h"

/* @lens: a lens model
 *
 * Returns: how many coefficients it has.
 */
guint
cloth_lens_n_coefficients (ClothLens lens)
{
  switch (lens) {
    case CLOTH_LENS_BROWN5:
      return 5;
    case CLOTH_LENS_BROWN8:
      return 8;
    case CLOTH_LENS_FISHEYE:
      return 4;
    case CLOTH_LENS_NONE:
    default:
      return 0;
  }
}

/* @to: (out): overwritten, not cleared first
 * @from: a camera
 *
 * Copies a camera with its strings.
 */
void
cloth_camera_copy (ClothCamera * to, const ClothCamera * from)
{
  *to = *from;
  to->name = g_strdup (from->name);
  to->device = g_strdup (from->device);
}

/* @camera: a camera
 *
 * Frees its strings and sets everything to 0.
 */
void
cloth_camera_clear (ClothCamera * camera)
{
  g_free (camera->name);
  g_free (camera->device);
  memset (camera, 0, sizeof *camera);
}

/* Brown–Conrady of (x, y). J: row-major 2×2; dk: row-major 2×8. */
static void
distort_brown (const gdouble k[8], gdouble x, gdouble y, gdouble d[2],
    gdouble * J, gdouble * dk)
{
  gdouble s = x * x + y * y, xy = x * y;
  gdouble num = 1 + s * (k[0] + s * (k[1] + s * k[4]));
  gdouble den = 1 + s * (k[5] + s * (k[6] + s * k[7]));
  gdouble inv = 1 / den, g = num * inv;

  d[0] = x * g + 2 * k[2] * xy + k[3] * (s + 2 * x * x);
  d[1] = y * g + k[2] * (s + 2 * y * y) + 2 * k[3] * xy;
  if (J) {
    gdouble dnum = k[0] + s * (2 * k[1] + s * 3 * k[4]);
    gdouble dden = k[5] + s * (2 * k[6] + s * 3 * k[7]);
    gdouble dg = (dnum - g * dden) * inv;

    J[0] = g + 2 * x * x * dg + 2 * k[2] * y + 6 * k[3] * x;
    J[1] = 2 * xy * dg + 2 * k[2] * x + 2 * k[3] * y;
    J[2] = J[1];
    J[3] = g + 2 * y * y * dg + 6 * k[2] * y + 2 * k[3] * x;
  }
  if (dk) {
    gdouble a = s * inv, b = -g * a;

    for (gint i = 0; i < 2; i++) {
      gdouble p = i ? y : x;
      gdouble *row = dk + 8 * i;

      row[0] = p * a;
      row[1] = p * a * s;
      row[4] = p * a * s * s;
      row[5] = p * b;
      row[6] = p * b * s;
      row[7] = p * b * s * s;
    }
    dk[2] = 2 * xy;
    dk[3] = s + 2 * x * x;
    dk[8 + 2] = s + 2 * y * y;
    dk[8 + 3] = 2 * xy;
  }
}

/* Kannala–Brandt of (x, y), as distort_brown(). */
static void
distort_fisheye (const gdouble k[8], gdouble x, gdouble y, gdouble d[2],
    gdouble * J, gdouble * dk)
{
  gdouble s = x * x + y * y, r = sqrt (s);
  gdouble theta = atan (r), q = theta * theta;
  gdouble bend = 1 + q * (k[0] + q * (k[1] + q * (k[2] + q * k[3])));
  /* θ/r and (dθ/dr − θ/r)/r² are 0/0 at the centre: series there. */
  gdouble ratio = s < 1e-6 ? 1 - s / 3 + s * s / 5 : theta / r;
  gdouble g = ratio * bend;

  d[0] = x * g;
  d[1] = y * g;
  if (J) {
    gdouble slope = s < 1e-6 ? -2. / 3 + s * 4 / 5 : (1 / (1 + s) - ratio) / s;
    gdouble dbend = k[0] + q * (2 * k[1] + q * (3 * k[2] + q * 4 * k[3]));
    /* (dg/dr)/r */
    gdouble dg = slope * bend + ratio * ratio * 2 * dbend / (1 + s);

    J[0] = g + x * x * dg;
    J[1] = J[2] = x * y * dg;
    J[3] = g + y * y * dg;
  }
  if (dk) {
    gdouble power = ratio;

    memset (dk, 0, 16 * sizeof (gdouble));
    for (gint i = 0; i < 4; i++) {
      power *= q;
      dk[i] = x * power;
      dk[8 + i] = y * power;
    }
  }
}

/* Normalised to distorted normalised coordinates. */
static void
distort (const ClothCamera * camera, gdouble x, gdouble y, gdouble d[2],
    gdouble * J, gdouble * dk)
{
  switch (camera->lens) {
    case CLOTH_LENS_BROWN5:
    case CLOTH_LENS_BROWN8:
      distort_brown (camera->k, x, y, d, J, dk);
      break;
    case CLOTH_LENS_FISHEYE:
      distort_fisheye (camera->k, x, y, d, J, dk);
      break;
    case CLOTH_LENS_NONE:
    default:
      d[0] = x;
      d[1] = y;
      if (J) {
        J[0] = J[3] = 1;
        J[1] = J[2] = 0;
      }
      if (dk)
        memset (dk, 0, 16 * sizeof (gdouble));
      break;
  }
}

/* @camera: a camera
 * @xy: normalised coordinates (X/Z, Y/Z in the camera's frame)
 * @px: (out): where they appear, px
 * @d_xy: (out) (optional): row-major 2×2 derivative of @px with respect to @xy
 *
 * Applies the lens and the camera matrix. Distortion in OpenCV's meaning: Brown's
 * "Close-range camera calibration" (1971) with the rational radial term, or Kannala and
 * Brandt's "A generic camera model" (2006).
 */
void
cloth_camera_distort (const ClothCamera * camera, const gdouble xy[2],
    gdouble px[2], gdouble * d_xy)
{
  const gdouble *K = camera->K;
  gdouble d[2], J[4];

  distort (camera, xy[0], xy[1], d, d_xy ? J : NULL, NULL);
  px[0] = K[0] * d[0] + K[1] * d[1] + K[2];
  px[1] = K[4] * d[1] + K[5];
  if (d_xy) {
    d_xy[0] = K[0] * J[0] + K[1] * J[2];
    d_xy[1] = K[0] * J[1] + K[1] * J[3];
    d_xy[2] = K[4] * J[2];
    d_xy[3] = K[4] * J[3];
  }
}

/* @camera: a camera
 * @X: a point in the world, m
 * @px: (out): where it appears, px
 * @d_point: (out) (optional): row-major 2×3 derivative of @px with respect to @X
 * @d_parameters: (out) (optional): row-major 2×%CLOTH_CAMERA_N_PARAMETERS derivative
 *   with respect to fx fy cx cy, k[0] … k[7], the rotation vector of R, t; columns of
 *   coefficients the lens lacks are 0
 *
 * Projects a point through the lens. Far outside of the picture a distortion polynomial
 * may fold back; such points are not told apart here.
 *
 * Returns: %FALSE, with nothing written, when @X is not in front of the camera.
 */
gboolean
cloth_camera_project (const ClothCamera * camera, const gdouble X[3],
    gdouble px[2], gdouble * d_point, gdouble * d_parameters)
{
  const gdouble *K = camera->K, *R = camera->R, *t = camera->t;
  gdouble RX[3], Z, x, y, d[2], J[4], dk[16], A[6];
  gboolean derive = d_point || d_parameters;

  for (gint i = 0; i < 3; i++)
    RX[i] = R[3 * i] * X[0] + R[3 * i + 1] * X[1] + R[3 * i + 2] * X[2];
  Z = RX[2] + t[2];
  if (!(Z > 0))
    return FALSE;
  x = (RX[0] + t[0]) / Z;
  y = (RX[1] + t[1]) / Z;
  distort (camera, x, y, d, derive ? J : NULL, d_parameters ? dk : NULL);
  px[0] = K[0] * d[0] + K[1] * d[1] + K[2];
  px[1] = K[4] * d[1] + K[5];
  if (!derive)
    return TRUE;

  /* A = d px / d (point in the camera's frame), 2×3 */
  for (gint i = 0; i < 2; i++) {
    gdouble jx = i ? K[4] * J[2] : K[0] * J[0] + K[1] * J[2];
    gdouble jy = i ? K[4] * J[3] : K[0] * J[1] + K[1] * J[3];

    A[3 * i] = jx / Z;
    A[3 * i + 1] = jy / Z;
    A[3 * i + 2] = -(jx * x + jy * y) / Z;
  }
  if (d_point) {
    for (gint i = 0; i < 2; i++) {
      for (gint j = 0; j < 3; j++)
        d_point[3 * i + j] = A[3 * i] * R[j] + A[3 * i + 1] * R[3 + j]
            + A[3 * i + 2] * R[6 + j];
    }
  }
  if (d_parameters) {
    guint n = cloth_lens_n_coefficients (camera->lens);
    gdouble r[3], L[9];

    memset (d_parameters, 0, 2 * CLOTH_CAMERA_N_PARAMETERS * sizeof (gdouble));
    cloth_rotation_to_vector (R, r);
    cloth_rotation_left_jacobian (r, L);
    for (gint i = 0; i < 2; i++) {
      gdouble *row = d_parameters + i * CLOTH_CAMERA_N_PARAMETERS;
      const gdouble *a = A + 3 * i;
      /* a · (w × RX) = w · (RX × a) */
      gdouble c[3];

      cloth_vec3_cross (RX, a, c);
      row[i] = d[i];
      row[2 + i] = 1;
      for (guint j = 0; j < n; j++)
        row[4 + j] = i ? K[4] * dk[8 + j] : K[0] * dk[j] + K[1] * dk[8 + j];
      for (gint j = 0; j < 3; j++) {
        row[12 + j] = c[0] * L[j] + c[1] * L[3 + j] + c[2] * L[6 + j];
        row[15 + j] = a[j];
      }
    }
  }
  return TRUE;
}

/* Derivative, over its positive denominator, of the distorted radius with respect to the
 * true one; the lens folds back where it turns negative. q: r² (Brown) or θ² (fisheye). */
static gdouble
radial_slope (const ClothCamera * camera, gdouble q)
{
  const gdouble *k = camera->k;

  if (camera->lens == CLOTH_LENS_FISHEYE) {
    return 1 + q * (3 * k[0] + q * (5 * k[1] + q * (7 * k[2] + q * 9 * k[3])));
  } else {
    gdouble num = 1 + q * (k[0] + q * (k[1] + q * k[4]));
    gdouble den = 1 + q * (k[5] + q * (k[6] + q * k[7]));
    gdouble dnum = k[0] + q * (2 * k[1] + q * 3 * k[4]);
    gdouble dden = k[5] + q * (2 * k[6] + q * 3 * k[7]);

    if (!(den > 0))
      return -1;
    return num * den + 2 * q * (dnum * den - num * dden);
  }
}

/* The radius (Brown: tan of the angle; fisheye: the angle) up to which the lens is
 * monotonous. */
static gdouble
fold_radius (const ClothCamera * camera)
{
  gboolean fisheye = camera->lens == CLOTH_LENS_FISHEYE;
  gint steps = 256;
  gdouble last = fisheye ? G_PI_2 : 16;
  gdouble low = 0, high = last;
  gint i;

  for (i = 1; i <= steps; i++) {
    high = last * i / steps;
    if (!(radial_slope (camera, high * high) > 0))
      break;
    low = high;
  }
  if (i > steps)
    return fisheye ? G_PI_2 : G_MAXDOUBLE;
  for (i = 0; i < 60; i++) {
    gdouble middle = 0.5 * (low + high);

    if (radial_slope (camera, middle * middle) > 0)
      low = middle;
    else
      high = middle;
  }
  return low;
}

#define MAX_NEWTON 50

static gboolean
undistort_brown (const gdouble k[8], gdouble fold, gdouble a, gdouble b,
    gdouble xy[2])
{
  gdouble x = a, y = b, r = sqrt (a * a + b * b);
  gdouble size = 1 + r, last = G_MAXDOUBLE, d[2], J[4];

  if (r > fold) {
    x *= 0.9 * fold / r;
    y *= 0.9 * fold / r;
  }
  for (gint i = 0; i < MAX_NEWTON; i++) {
    gdouble ex, ey, error, det, nx, ny, rn;

    distort_brown (k, x, y, d, J, NULL);
    ex = a - d[0];
    ey = b - d[1];
    error = fabs (ex) + fabs (ey);
    /* At the limit of rounding the error stops to shrink. */
    if (error <= 4e-15 * size && !(error < 0.5 * last))
      break;
    last = error;
    det = J[0] * J[3] - J[1] * J[2];
    nx = x + (J[3] * ex - J[1] * ey) / det;
    ny = y + (J[0] * ey - J[2] * ex) / det;
    rn = sqrt (nx * nx + ny * ny);
    if (!(rn < fold)) {
      gdouble ro = sqrt (x * x + y * y);

      if (!isfinite (rn) || rn == 0)
        return FALSE;
      nx *= 0.5 * (ro + fold) / rn;
      ny *= 0.5 * (ro + fold) / rn;
    }
    x = nx;
    y = ny;
  }
  xy[0] = x;
  xy[1] = y;
  /* Not the last step but what it led to decides. */
  distort_brown (k, x, y, d, J, NULL);
  return isfinite (size) && fabs (a - d[0]) + fabs (b - d[1]) <= 1e-12 * size
      && J[0] * J[3] - J[1] * J[2] > 0;
}

/* Points that go through the iteration abreast. */
#define LANES 8

/* The angle of each distorted radius, NaN where there is none. Lanes stop one by one, so
 * that none depends on its neighbours. */
static void
fisheye_angles (const gdouble k[8], gdouble fold, const gdouble rd[LANES],
    gdouble theta[LANES])
{
  gdouble error[LANES] = { 0, }, last[LANES];
  gdouble going[LANES];
  gdouble q = fold * fold;
  gdouble reach = fold * (1 + q * (k[0] + q * (k[1] + q * (k[2] + q * k[3]))));

  for (guint l = 0; l < LANES; l++) {
    theta[l] = fmin (rd[l], 0.9 * fold);
    last[l] = G_MAXDOUBLE;
    going[l] = rd[l] < reach;
  }
  for (gint i = 0; i < MAX_NEWTON; i++) {
    gdouble any = 0;

    for (guint l = 0; l < LANES; l++) {
      gdouble at = theta[l], next, size, go;
      gdouble r = at * at;
      gdouble bend = 1 + r * (k[0] + r * (k[1] + r * (k[2] + r * k[3])));
      gdouble slope = 1 + r * (3 * k[0]
          + r * (5 * k[1] + r * (7 * k[2] + r * 9 * k[3])));
      gdouble e = rd[l] - at * bend;

      size = fabs (e);
      next = at + e / slope;
      next = next < fold ? next : 0.5 * (at + fold);
      next = next < 0 ? 0.5 * at : next;
      /* at the limit of rounding the error stops to shrink */
      go = size > 4e-15 * (1 + rd[l]) ? 1. : size < 0.5 * last[l] ? 1. : 0.;
      go *= going[l];
      error[l] = going[l] != 0 ? size : error[l];
      last[l] = size;
      theta[l] = go != 0 ? next : at;
      going[l] = go;
    }
    for (guint l = 0; l < LANES; l++)
      any += going[l];
    if (any == 0)
      break;
  }
  for (guint l = 0; l < LANES; l++)
    if (!(rd[l] < reach) || !(error[l] <= 1e-12 * (1 + rd[l]))
        || !(theta[l] < fold))
      theta[l] = NAN;
}

/* cloth_camera_undistort_points() for a fisheye. */
static guint
undistort_fisheye (const ClothCamera * camera, guint n, const gdouble * u,
    const gdouble * v, gdouble * x, gdouble * y, gdouble * jacobian)
{
  const gdouble *K = camera->K, *k = camera->k;
  gdouble fold = fold_radius (camera);
  gdouble ifx = 1 / K[0], ify = 1 / K[4], shear = -K[1] * ifx * ify;
  guint n_good = 0;

  for (guint first = 0; first < n; first += LANES) {
    guint m = MIN (n - first, LANES);
    gdouble a[LANES] = { 0, }, b[LANES] = { 0, }, rd[LANES], theta[LANES];

    for (guint l = 0; l < m; l++) {
      b[l] = (v[first + l] - K[5]) / K[4];
      a[l] = (u[first + l] - K[2] - K[1] * b[l]) / K[0];
    }
    for (guint l = 0; l < LANES; l++)
      rd[l] = sqrt (a[l] * a[l] + b[l] * b[l]);
    fisheye_angles (k, fold, rd, theta);
    for (guint l = 0; l < m; l++) {
      gboolean centre = rd[l] < 1e-12;
      gdouble tangent = tan (theta[l]), scale = centre ? 1 : tangent / rd[l];
      guint i = first + l;

      x[i] = a[l] * scale;
      y[i] = b[l] * scale;
      n_good += !isnan (x[i]);
      if (jacobian) {
        gdouble q = theta[l] * theta[l];
        gdouble along = (1 + tangent * tangent) / (1 + q * (3 * k[0]
                + q * (5 * k[1] + q * (7 * k[2] + q * 9 * k[3]))));
        gdouble cx = centre ? 1 : a[l] / rd[l], cy = centre ? 0 : b[l] / rd[l];
        /* along the radius, and across it */
        gdouble xx = scale + (along - scale) * cx * cx;
        gdouble xy = (along - scale) * cx * cy;
        gdouble yy = scale + (along - scale) * cy * cy;

        jacobian[i] = xx * ifx;
        jacobian[n + i] = xx * shear + xy * ify;
        jacobian[2 * (gsize) n + i] = xy * ifx;
        jacobian[3 * (gsize) n + i] = xy * shear + yy * ify;
      }
    }
  }
  return n_good;
}

/* @camera: a camera
 * @n: points
 * @u: (array length=n): columns, px
 * @v: (array length=n): rows, px
 * @x: (array length=n) (out caller-allocates): X/Z in the camera's frame; may be @u
 * @y: (array length=n) (out caller-allocates): Y/Z; may be @v
 * @jacobian: (optional) (out caller-allocates): four planes of @n: dx/du, dx/dv, dy/du,
 *   dy/dv; carries a covariance of pixels over to normalised coordinates
 *
 * The inverse of cloth_camera_distort(): Newton's method to the limit of rounding, kept
 * inside the radius up to which the lens is monotonous. Where a pixel has no such
 * inverse, all outputs of the point are NaN.
 *
 * Returns: how many points have an inverse.
 */
guint
cloth_camera_undistort_points (const ClothCamera * camera, guint n,
    const gdouble * u, const gdouble * v, gdouble * x, gdouble * y,
    gdouble * jacobian)
{
  const gdouble *K = camera->K;
  gdouble fold;
  guint n_good = 0;

  if (camera->lens == CLOTH_LENS_FISHEYE)
    return undistort_fisheye (camera, n, u, v, x, y, jacobian);
  fold = camera->lens == CLOTH_LENS_NONE ? 0 : fold_radius (camera);
  for (guint i = 0; i < n; i++) {
    gdouble b = (v[i] - K[5]) / K[4];
    gdouble a = (u[i] - K[2] - K[1] * b) / K[0];
    gdouble xy[2] = { a, b };
    gboolean good = camera->lens == CLOTH_LENS_NONE ? isfinite (a)
        && isfinite (b) : undistort_brown (camera->k, fold, a, b, xy);

    if (!good)
      xy[0] = xy[1] = NAN;
    n_good += !!good;
    x[i] = xy[0];
    y[i] = xy[1];
    if (jacobian) {
      gdouble J[4], px[2], det;

      cloth_camera_distort (camera, xy, px, J);
      det = J[0] * J[3] - J[1] * J[2];
      jacobian[i] = good ? J[3] / det : NAN;
      jacobian[n + i] = good ? -J[1] / det : NAN;
      jacobian[2 * (gsize) n + i] = good ? -J[2] / det : NAN;
      jacobian[3 * (gsize) n + i] = good ? J[0] / det : NAN;
    }
  }
  return n_good;
}
