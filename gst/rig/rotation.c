/* Rotation vectors and matrices (Rodrigues), with derivatives.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/rotation.h"

#include <math.h>

#include "gst/math/vec3.h"

/* I + a [r]x + b [r]x². Both maps and both Jacobians have this form. */
static void
series (const gdouble r[3], gdouble a, gdouble b, gdouble M[9])
{
  gdouble xx = r[0] * r[0], yy = r[1] * r[1], zz = r[2] * r[2];

  M[0] = 1 - b * (yy + zz);
  M[1] = b * r[0] * r[1] - a * r[2];
  M[2] = b * r[0] * r[2] + a * r[1];
  M[3] = b * r[0] * r[1] + a * r[2];
  M[4] = 1 - b * (xx + zz);
  M[5] = b * r[1] * r[2] - a * r[0];
  M[6] = b * r[0] * r[2] - a * r[1];
  M[7] = b * r[1] * r[2] + a * r[0];
  M[8] = 1 - b * (xx + yy);
}

/* @r: rotation vector: axis times angle, rad
 * @R: (out): row-major rotation matrix exp([r]x)
 *
 * Rodrigues' formula.
 */
void
cloth_rotation_from_vector (const gdouble r[3], gdouble R[9])
{
  gdouble t2 = cloth_vec3_dot (r, r);

  if (t2 < 1e-8) {
    series (r, 1 - t2 / 6, 0.5 - t2 / 24, R);
  } else {
    gdouble t = sqrt (t2), h = sin (0.5 * t);

    series (r, sin (t) / t, 2 * h * h / t2, R);
  }
}

/* @R: row-major rotation matrix
 * @r: (out): rotation vector, its length in [0, π]
 *
 * By way of the unit quaternion, so that it is exact to rounding at every angle, half
 * turns included.
 */
void
cloth_rotation_to_vector (const gdouble R[9], gdouble r[3])
{
  gdouble q[4], n, s;
  gdouble trace = R[0] + R[4] + R[8];

  /* The largest of the four is computed first: no small divisor. */
  if (trace >= R[0] && trace >= R[4] && trace >= R[8]) {
    q[0] = 1 + trace;
    q[1] = R[7] - R[5];
    q[2] = R[2] - R[6];
    q[3] = R[3] - R[1];
  } else if (R[0] >= R[4] && R[0] >= R[8]) {
    q[0] = R[7] - R[5];
    q[1] = 1 + R[0] - R[4] - R[8];
    q[2] = R[1] + R[3];
    q[3] = R[2] + R[6];
  } else if (R[4] >= R[8]) {
    q[0] = R[2] - R[6];
    q[1] = R[1] + R[3];
    q[2] = 1 + R[4] - R[0] - R[8];
    q[3] = R[5] + R[7];
  } else {
    q[0] = R[3] - R[1];
    q[1] = R[2] + R[6];
    q[2] = R[5] + R[7];
    q[3] = 1 + R[8] - R[0] - R[4];
  }
  if (q[0] < 0) {
    for (gint i = 0; i < 4; i++)
      q[i] = -q[i];
  }
  n = sqrt (q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  s = n > 1e-150 ? 2 * atan2 (n, q[0]) / n : 0;
  for (gint i = 0; i < 3; i++)
    r[i] = s * q[i + 1];
}

/* @r: rotation vector
 * @J: (out): row-major 3×3: exp(r + J⁻¹ w) = exp(w) exp(r) to first order in w
 *
 * d(R X)/dr = −[R X]x J.
 */
void
cloth_rotation_left_jacobian (const gdouble r[3], gdouble J[9])
{
  gdouble t2 = cloth_vec3_dot (r, r);

  if (t2 < 1e-4) {
    series (r, 0.5 - t2 / 24 + t2 * t2 / 720,
        1. / 6 - t2 / 120 + t2 * t2 / 5040, J);
  } else {
    gdouble t = sqrt (t2), h = sin (0.5 * t);

    series (r, 2 * h * h / t2, (t - sin (t)) / (t2 * t), J);
  }
}
