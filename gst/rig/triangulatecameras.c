/* Cameras made ready for triangulation.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/math/vec3.h"
#include "gst/rig/triangulateprivate.h"

GQuark
cloth_triangulate_error_quark (void)
{
  return g_quark_from_static_string ("cloth-triangulate-error-quark");
}

/* The place that all optical axes pass nearest to becomes the origin, the cameras' mean
 * distance from it the unit: the linear estimate is then well conditioned wherever the
 * world's own origin is. */
static void
normalise_world (ClothTriangulator * self, const gdouble (*centres)[3])
{
  gdouble a[9] = { 0. }, b[3] = { 0. }, mean[3] = { 0. };
  gdouble values[3], vectors[9];
  gdouble distance = 0.;

  for (guint i = 0; i < self->n_cameras; i++) {
    const gdouble *d = self->cameras[i].P + 8, *c = centres[i];

    for (gint j = 0; j < 3; j++) {
      for (gint k = 0; k < 3; k++) {
        gdouble p = (j == k ? 1. : 0.) - d[j] * d[k];

        a[3 * j + k] += p;
        b[j] += p * c[k];
      }
      mean[j] += c[j] / self->n_cameras;
    }
  }
  /* parallel axes meet nowhere */
  if (cloth_sym_eigen (3, a, values, vectors) && values[0] > 1e-4 * values[2]
      && cloth_cholesky_factor (3, a)) {
    cloth_cholesky_solve (3, a, b);
    memcpy (mean, b, sizeof (mean));
  }
  for (guint i = 0; i < self->n_cameras; i++) {
    gdouble s = 0.;

    for (gint j = 0; j < 3; j++)
      s += (centres[i][j] - mean[j]) * (centres[i][j] - mean[j]);
    distance += sqrt (s) / self->n_cameras;
  }
  memcpy (self->origin, mean, sizeof (mean));
  self->scale = distance > 0. && isfinite (distance) ? distance : 1.;
  for (guint i = 0; i < self->n_cameras; i++) {
    gdouble *P = self->cameras[i].P;

    for (gint j = 0; j < 3; j++)
      P[4 * j + 3] = (P[4 * j] * mean[0] + P[4 * j + 1] * mean[1] +
          P[4 * j + 2] * mean[2] + P[4 * j + 3]) / self->scale;
  }
}

/* Fits the polynomial that guesses the true place from the distorted one, over the
 * picture. */
static void
fit_inverse (TriangulateCamera * self)
{
  enum
  { SIDE = 16, N = SIDE * SIDE, RADIAL = 7, TANGENTIAL = 4, ALL = 15 };
  const ClothCamera *camera = &self->camera;
  const gdouble *k = self->k;
  gboolean fisheye = self->lens == CLOTH_LENS_FISHEYE;
  gdouble width = camera->width > 1 ? camera->width - 1 : 2. * self->cx;
  gdouble height = camera->height > 1 ? camera->height - 1 : 2. * self->cy;
  g_autofree gdouble *u = g_new (gdouble, 4 * N);
  g_autofree gdouble *a = g_new (gdouble, 2 * N * ALL);
  g_autofree gdouble *b = g_new (gdouble, 2 * N);
  gdouble *v = u + N, *x = v + N, *y = x + N;
  /* without a direction there are no terms along it */
  guint m = 0, n = !fisheye && (k[2] != 0. || k[3] != 0.) ? ALL : RADIAL;

  for (guint i = 0; i < N; i++) {
    u[i] = width * (i % SIDE) / (SIDE - 1);
    v[i] = height * (i / SIDE) / (SIDE - 1);
  }
  cloth_camera_undistort_points (camera, N, u, v, x, y, NULL);
  for (guint i = 0; i < N; i++) {
    gdouble dy = (v[i] - self->cy) * self->ify;
    gdouble dx = (u[i] - self->cx - self->skew * dy) * self->ifx;
    gdouble q = dx * dx + dy * dy, r2 = x[i] * x[i] + y[i] * y[i];
    gdouble t = dx * k[3] + dy * k[2];

    if (!isfinite (r2))
      continue;
    if (fisheye) {
      gdouble angle = atan (sqrt (r2));

      /* The kernel's series reach a little less than a right angle. */
      self->max_r2 = fmin (fmax (self->max_r2, 1.05 * angle * angle), 2.3);
      if (q > 1e-6) {
        b[m] = angle / sqrt (q) - 1.;
        a[n * m] = q;
        for (guint j = 1; j < RADIAL; j++)
          a[n * m + j] = a[n * m + j - 1] * q;
        m++;
      }
      continue;
    }
    self->max_r2 = fmax (self->max_r2, 1.05 * r2);
    for (gint axis = 0; axis < 2; axis++, m++) {
      gdouble *row = a + n * m, d = axis ? dy : dx;

      b[m] = (axis ? y[i] : x[i]) - d;
      row[0] = d * q;
      for (guint j = 1; j < RADIAL; j++)
        row[j] = row[j - 1] * q;
      if (n > RADIAL) {
        row[RADIAL] = d * t;
        row[RADIAL + TANGENTIAL] = (axis ? k[2] : k[3]) * q;
        for (guint j = RADIAL + 1; j < RADIAL + TANGENTIAL; j++) {
          row[j] = row[j - 1] * q;
          row[j + TANGENTIAL] = row[j + TANGENTIAL - 1] * q;
        }
      }
    }
  }
  if (cloth_least_squares (m, n, a, b))
    memcpy (self->inverse, b, n * sizeof (gdouble));
}

/* What the kernels need of K and the lens beyond the numbers themselves. */
static void
prepare (TriangulateCamera * self)
{
  const gdouble *k = self->k, fx = self->fx, fy = self->fy, skew = self->skew;
  const gdouble unit[6] = { fx * fx, fx * skew, fx * fy, skew * skew,
    2. * skew * fy, fy * fy
  };
  const gdouble brown[10] = { 2. * k[0], 4. * k[1], 6. * k[4], 2. * k[5],
    4. * k[6], 6. * k[7], 2. * k[2], 2. * k[3], 4. * k[2], 4. * k[3]
  };
  const gdouble fisheye[4] = { 3. * k[0], 5. * k[1], 7. * k[2], 9. * k[3] };

  self->ifx = 1. / fx;
  self->ify = 1. / fy;
  self->area = fx * fy;
  memcpy (self->unit, unit, sizeof (unit));
  if (self->lens == CLOTH_LENS_FISHEYE)
    memcpy (self->slope, fisheye, sizeof (fisheye));
  else
    memcpy (self->slope, brown, sizeof (brown));
}

static gboolean
all_finite (const gdouble * x, guint n)
{
  for (guint i = 0; i < n; i++)
    if (!isfinite (x[i]))
      return FALSE;
  return TRUE;
}

static ClothTriangulator *
new_empty (guint n_cameras, GError ** error)
{
  static const ClothTriangulateParameters parameters =
      CLOTH_TRIANGULATE_PARAMETERS_DEFAULT;
  ClothTriangulator *self;

  if (n_cameras < 2 || n_cameras > CLOTH_TRIANGULATE_MAX_CAMERAS) {
    g_set_error (error, CLOTH_TRIANGULATE_ERROR,
        CLOTH_TRIANGULATE_ERROR_CAMERAS,
        "Triangulation takes 2 to %d cameras, not %u",
        CLOTH_TRIANGULATE_MAX_CAMERAS, n_cameras);
    return NULL;
  }
  self = g_new0 (ClothTriangulator, 1);
  self->n_cameras = n_cameras;
  self->cameras = g_new0 (TriangulateCamera, n_cameras);
  cloth_triangulator_set_parameters (self, &parameters);
  self->kernel = CLOTH_SIMD_TABLE (cloth_triangulate_kernel, CLOTH_SIMD_BEST);
  return self;
}

/* @n_cameras: 2 … %CLOTH_TRIANGULATE_MAX_CAMERAS
 * @cameras: (array length=n_cameras): copied
 * @error: return location
 *
 * Returns: (transfer full) (nullable): a triangulator for these cameras; %NULL when
 *   there are too few or too many or one has numbers that make no camera
 */
ClothTriangulator *
cloth_triangulator_new (guint n_cameras, const ClothCamera * cameras,
    GError ** error)
{
  g_autoptr (ClothTriangulator) self = new_empty (n_cameras, error);
  gdouble centres[CLOTH_TRIANGULATE_MAX_CAMERAS][3];

  if (self == NULL)
    return NULL;
  for (guint i = 0; i < n_cameras; i++) {
    TriangulateCamera *c = &self->cameras[i];
    const ClothCamera *camera = &cameras[i];
    const gdouble *K = camera->K, *R = camera->R, *t = camera->t;
    gdouble identity[9], off = 0.;

    if (!all_finite (K, 9) || !all_finite (R, 9) || !all_finite (t, 3)
        || !all_finite (camera->k, 8) || !(K[0] > 0.) || !(K[4] > 0.)) {
      g_set_error (error, CLOTH_TRIANGULATE_ERROR,
          CLOTH_TRIANGULATE_ERROR_CAMERA,
          "Camera %u (%s) has a focal length that is not positive or a number that "
          "is not finite; calibrate it again", i,
          camera->name ? camera->name : "no name");
      return NULL;
    }
    cloth_mat3_mul_nt (R, R, identity);
    for (gint j = 0; j < 9; j++)
      off = fmax (off, fabs (identity[j] - (j % 4 == 0 ? 1. : 0.)));
    if (off > 1e-3 || cloth_mat3_det (R) < 0.) {
      g_set_error (error, CLOTH_TRIANGULATE_ERROR,
          CLOTH_TRIANGULATE_ERROR_CAMERA,
          "R of camera %u (%s) is no rotation", i,
          camera->name ? camera->name : "no name");
      return NULL;
    }
    cloth_camera_copy (&c->camera, camera);
    for (gint j = 0; j < 3; j++) {
      memcpy (c->P + 4 * j, R + 3 * j, 3 * sizeof (gdouble));
      c->P[4 * j + 3] = t[j];
    }
    cloth_mat3_vec_t (R, t, centres[i]);
    for (gint j = 0; j < 3; j++)
      centres[i][j] = -centres[i][j];
    c->fx = K[0];
    c->skew = K[1];
    c->cx = K[2];
    c->fy = K[4];
    c->cy = K[5];
    c->lens = camera->lens;
    memcpy (c->k, camera->k, sizeof (c->k));
    prepare (c);
    if (c->lens != CLOTH_LENS_NONE)
      fit_inverse (c);
  }
  normalise_world (self, (const gdouble (*)[3]) centres);
  return g_steal_pointer (&self);
}

/* @n_cameras: 2 … %CLOTH_TRIANGULATE_MAX_CAMERAS
 * @projections: (array): 12·@n_cameras: row-major 3×4 matrices P, x ~ P·X in px, of any
 *   scale and sign
 * @error: return location
 *
 * For cameras that are known by their projection matrix only, such as a direct linear
 * transformation's; observations have no lens distortion then. The sign is set so that
 * depth is positive in front of the camera if the picture's y axis points down.
 *
 * Returns: (transfer full) (nullable): a triangulator
 */
ClothTriangulator *
cloth_triangulator_new_projections (guint n_cameras,
    const gdouble * projections, GError ** error)
{
  g_autoptr (ClothTriangulator) self = new_empty (n_cameras, error);
  gdouble centres[CLOTH_TRIANGULATE_MAX_CAMERAS][3];

  if (self == NULL)
    return NULL;
  for (guint i = 0; i < n_cameras; i++) {
    TriangulateCamera *c = &self->cameras[i];
    const gdouble *p = projections + 12 * i;
    gdouble m[9], inverse[9], column[3], scale, rest[2], P[12];
    gboolean good = all_finite (p, 12);

    for (gint j = 0; j < 9; j++)
      m[j] = p[4 * (j / 3) + j % 3];
    scale = sqrt (m[6] * m[6] + m[7] * m[7] + m[8] * m[8]);
    good = good && scale > 0. && cloth_mat3_inverse (m, inverse);
    if (good) {
      if (cloth_mat3_det (m) < 0.)
        scale = -scale;
      for (gint j = 0; j < 12; j++)
        P[j] = p[j] / scale;
      /* Split off principal point and focal lengths: the rest is a rotation, but for
       * skew. */
      c->cx = P[0] * P[8] + P[1] * P[9] + P[2] * P[10];
      c->cy = P[4] * P[8] + P[5] * P[9] + P[6] * P[10];
      for (gint axis = 0; axis < 2; axis++) {
        gdouble *row = P + 4 * axis;

        for (gint j = 0; j < 4; j++)
          row[j] -= (axis ? c->cy : c->cx) * P[8 + j];
        rest[axis] = cloth_vec3_length (row);
        for (gint j = 0; j < 4; j++)
          row[j] /= rest[axis];
      }
      c->fx = rest[0];
      c->fy = rest[1];
      good = all_finite (P, 12) && c->fx > 0. && c->fy > 0.;
    }
    if (!good) {
      g_set_error (error, CLOTH_TRIANGULATE_ERROR,
          CLOTH_TRIANGULATE_ERROR_CAMERA,
          "Projection matrix %u is not finite or has no camera centre", i);
      return NULL;
    }
    memcpy (c->P, P, sizeof (P));
    c->lens = CLOTH_LENS_NONE;
    prepare (c);
    for (gint j = 0; j < 3; j++)
      column[j] = -p[4 * j + 3];
    cloth_mat3_vec (inverse, column, centres[i]);
  }
  normalise_world (self, (const gdouble (*)[3]) centres);
  return g_steal_pointer (&self);
}
