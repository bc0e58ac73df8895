/* One frame: residuals of each camera's picture and their derivatives.
 *
 * Model: a point at x + dx is seen by camera c at y_c = h_c (x + dx; η) + noise, with the
 * covariance Σ_c of the detector plus a floor. h_c is the camera's projection at the time of
 * the picture, η its faults. To first order, with L_c the Cholesky factor of Σ_c:
 *   z_c = L_c⁻¹ (y_c − h_c (x; η)) = J_c dx + B_c dη + white noise.
 * J_c is the projection's derivative, B_c comes from finite differences.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/camera/residuals.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/math/statistics.h"

/* Variance that is added to the covariance of each observed point, px²: errors that detectors
 * don't know of. */
#define FLOOR 0.0025
/* An observed point is an outlier, that is another point's or no point's, when its residual is
 * this many times the 90% quantile of its picture, and this many standard deviations. */
#define GROSS 4.
#define GROSS_DEVIATIONS 6.

void
cloth_camera_points_init (ClothCameraPoints * p, const ClothCameraView * v,
    guint stride)
{
  const ClothRecording *r = v->recording;

  /* not all from a few columns of a grid */
  stride = cloth_coprime_step (stride, r->scene->topology->columns);
  p->stride = stride;
  p->n = (r->n + stride - 1) / stride;
  p->positions = g_new (gdouble, 3 * (gsize) p->n * r->n_frames);
  p->frames = g_new (const gdouble *, r->n_frames);
  for (guint f = 0; f < r->n_frames; f++) {
    gdouble *to = p->positions + 3 * (gsize) f * p->n;

    p->frames[f] = to;
    for (guint i = 0; i < p->n; i++, to += 3) {
      gsize from = (gsize) f * r->n + (gsize) i * stride;

      memcpy (to, v->y + 3 * from, 3 * sizeof *to);
    }
  }
  p->motion = (ClothMotion) {
  p->n, r->n_frames, r->times, p->frames};
}

void
cloth_camera_points_clear (ClothCameraPoints * p)
{
  g_free (p->positions);
  g_free (p->frames);
}

void
cloth_camera_picture_init (ClothCameraPicture * p, guint n)
{
  p->at = g_new (gint, n);
  p->px = g_new (gdouble, 2 * n);
  p->other = g_new (gdouble, 2 * n);
  p->z = g_new (gdouble, 2 * n);
  p->e = g_new (gdouble, n);
  p->sorted = g_new (gdouble, n);
  p->j = g_new (gdouble, 6 * n);
  p->n_columns = cloth_camera_n_columns ();
  p->b = g_new (gdouble, 2 * p->n_columns * n);
}

void
cloth_camera_picture_clear (ClothCameraPicture * p)
{
  g_free (p->at);
  g_free (p->px);
  g_free (p->other);
  g_free (p->z);
  g_free (p->e);
  g_free (p->sorted);
  g_free (p->j);
  g_free (p->b);
}

static void
match (ClothCameraPicture * p, const ClothCameraPoints * points)
{
  guint next = 0;

  for (guint i = 0; i < points->n; i++) {
    while (next < p->observation->n
        && p->observation->vertices[next] < i * points->stride)
      next++;
    p->at[i] = next < p->observation->n
        && p->observation->vertices[next] ==
        i * points->stride ? (gint) next : -1;
  }
}

/* Inverse of the lower Cholesky factor of the covariance. */
static void
whitener (const gdouble * covariance, gdouble w[3])
{
  gdouble l = sqrt (covariance[0] + FLOOR), m = covariance[1] / l;
  gdouble q = sqrt (MAX (covariance[2] + FLOOR - m * m, FLOOR));

  w[0] = 1. / l;
  w[1] = -m / (l * q);
  w[2] = 1. / q;
}

static void
whiten (const gdouble w[3], gdouble * first, gdouble * second)
{
  *second = w[1] * *first + w[2] * *second;
  *first *= w[0];
}

/* When the camera took the picture before, or NaN. */
static gdouble
time_before (const ClothCameraView * v, const ClothObservation * observation)
{
  const ClothObservation *first =
      (const ClothObservation *) v->observations->list->data;
  const guint camera = observation->camera;

  while (observation-- > first)
    if (observation->camera == camera)
      return observation->time_s;
  return NAN;
}

static void
put_column (ClothCameraPicture * p, guint n, guint column, gdouble step)
{
  for (guint i = 0; i < n; i++)
    for (guint k = 0; k < 2; k++)
      p->b[2 * (gsize) p->n_columns * i + k * p->n_columns + column] =
          (p->other[2 * i + k] - p->px[2 * i + k]) / step;
}

/* Derivatives by all faults but frame_drop. */
static void
predict_faults (const ClothMotion * motion, ClothCameraPicture * p,
    const ClothCapture * capture, gdouble time_s)
{
  for (guint column = 0; column + 1 < p->n_columns; column++) {
    gdouble values[CLOTH_EFFECT_MAX_PARAMETERS] = { 0. };
    ClothCapture off = *capture;
    guint k;
    const ClothEffect *effect = cloth_camera_column (column, &k);

    values[k] = CLOTH_CAMERA_STEP * effect->parameters[k].prior;
    cloth_capture_add_effect (&off, effect->id, values, NULL);
    cloth_capture_observe (&off, motion, time_s, p->other, NULL);
    put_column (p, motion->n_points, column, values[k]);
  }
}

/* Residuals, derivatives and columns of one picture. */
static void
look (const ClothCameraView * v, const ClothCameraPoints * points,
    ClothCameraColumns columns, ClothCameraPicture * p, guint frame)
{
  const guint camera = p->observation->camera;
  const ClothCapture *capture = &v->captures[camera];
  const ClothMotion *motion = &points->motion;
  gdouble before = time_before (v, p->observation);
  const gboolean stale = *cloth_camera_stale (v, frame, camera);
  const gboolean held = v->lost[camera] && stale;
  gdouble time_s = held ? before : p->observation->time_s;
  const guint n_columns = p->n_columns;
  const gsize row = 2 * n_columns;

  match (p, points);
  /* a picture of an earlier time says nothing of where points are now */
  for (guint i = 0;
      i < points->n && held && columns != CLOTH_CAMERA_DISPLACEMENT; i++)
    p->at[i] = -1;
  cloth_capture_observe (capture, motion, time_s, p->px, NULL);
  memset (p->b, 0, row * points->n * sizeof *p->b);
  if (columns == CLOTH_CAMERA_FAULTS)
    predict_faults (motion, p, capture, time_s);
  if (columns == CLOTH_CAMERA_DISPLACEMENT) {
    ClothCapture rig;

    cloth_capture_init (&rig, &v->observations->rig->cameras[camera]);
    cloth_capture_observe (&rig, motion, p->observation->time_s, p->other,
        NULL);
    put_column (p, points->n, n_columns - 1, 1.);
  }
  if (!held && !isnan (before) && (columns == CLOTH_CAMERA_DROPS
          || (columns == CLOTH_CAMERA_FAULTS && stale))) {
    cloth_capture_observe (capture, motion, before, p->other, NULL);
    put_column (p, points->n, n_columns - 1, 1.);
  }
  for (guint i = 0; i < points->n; i++) {
    gdouble X[3], px[2], w[3], *z = p->z + 2 * i, *j = p->j + 6 * (gsize) i;
    gdouble *b = p->b + row * i;

    if (p->at[i] < 0)
      continue;
    cloth_motion_at (motion, i, time_s - capture->camera.offset_s, X, NULL);
    if (isnan (p->px[2 * i]) || isnan (X[0])
        || !cloth_camera_project (&capture->camera, X, px, j, NULL)) {
      p->at[i] = -1;
      continue;
    }
    whitener (p->observation->covariances + 3 * p->at[i], w);
    for (guint k = 0; k < 2; k++)
      z[k] = p->observation->px[2 * p->at[i] + (gint) k] - p->px[2 * i + k];
    whiten (w, &z[0], &z[1]);
    for (guint k = 0; k < 3; k++)
      whiten (w, &j[k], &j[3 + k]);
    for (guint k = 0; k < n_columns; k++) {
      if (isnan (b[k] + b[n_columns + k]))
        b[k] = b[n_columns + k] = 0.;
      whiten (w, &b[k], &b[n_columns + k]);
    }
  }
}

void
cloth_camera_forward (const gdouble * l, gdouble * x)
{
  x[0] /= l[0];
  x[1] = (x[1] - l[3] * x[0]) / l[4];
  x[2] = (x[2] - l[6] * x[0] - l[7] * x[1]) / l[8];
}

void
cloth_camera_backward (const gdouble * l, gdouble * x)
{
  x[2] /= l[8];
  x[1] = (x[1] - l[7] * x[2]) / l[4];
  x[0] = (x[0] - l[3] * x[1] - l[6] * x[2]) / l[0];
}

gboolean
cloth_camera_gather (const ClothCameraPicture * pictures, guint n_cameras,
    guint i, gboolean all, ClothCameraPoint * point)
{
  memset (point, 0, sizeof *point);
  for (guint c = 0; c < n_cameras; c++) {
    const ClothCameraPicture *p = &pictures[c];
    const gdouble *z = p->z + 2 * i, *j = p->j + 6 * (gsize) i;

    if (!p->observation || p->at[i] < 0)
      continue;
    if (!all && p->e[i] > p->gross) {
      point->contradicted = TRUE;
      continue;
    }
    point->cameras[point->n++] = c;
    for (guint k = 0; k < 3; k++) {
      for (guint l = 0; l < 3; l++)
        point->a[3 * k + l] += j[k] * j[l] + j[3 + k] * j[3 + l];
      point->u[k] += j[k] * z[0] + j[3 + k] * z[1];
    }
    point->z2 += z[0] * z[0] + z[1] * z[1];
  }
  if (point->n < 2 || !cloth_cholesky_factor (3, point->a))
    return FALSE;
  cloth_camera_forward (point->a, point->u);
  return TRUE;
}

/* The residual above which an observed point contradicts the other pictures. */
static void
find_gross (ClothCameraPicture * p, guint n)
{
  gdouble *all = p->sorted;
  guint count = 0;

  for (guint i = 0; i < n; i++)
    if (p->at[i] >= 0 && !isnan (p->e[i]))
      all[count++] = p->e[i];
  qsort (all, count, sizeof *all, cloth_compare_doubles);
  p->gross =
      count ? MAX (GROSS * all[9 * count / 10], GROSS_DEVIATIONS) : INFINITY;
}

void
cloth_camera_look (const ClothCameraView * v, const ClothCameraPoints * points,
    ClothCameraColumns columns, ClothCameraPicture * pictures, guint frame)
{
  const guint n_cameras = v->observations->rig->n_cameras;

  for (guint c = 0; c < n_cameras; c++) {
    pictures[c].observation = *cloth_camera_picture (v, frame, c);
    if (pictures[c].observation)
      look (v, points, columns, &pictures[c], frame);
  }
  for (guint i = 0; i < points->n; i++) {
    ClothCameraPoint point;
    gboolean solved =
        cloth_camera_gather (pictures, n_cameras, i, TRUE, &point);
    gdouble x[3] = { point.u[0], point.u[1], point.u[2] };

    if (solved)
      cloth_camera_backward (point.a, x);
    for (guint c = 0; c < n_cameras; c++) {
      ClothCameraPicture *p = &pictures[c];
      const gdouble *z = p->z + 2 * i, *j = p->j + 6 * (gsize) i;

      if (!p->observation || p->at[i] < 0)
        continue;
      p->e[i] = solved ? hypot (z[0] - j[0] * x[0] - j[1] * x[1] - j[2] * x[2],
          z[1] - j[3] * x[0] - j[4] * x[1] - j[5] * x[2]) : NAN;
    }
  }
  for (guint c = 0; c < n_cameras; c++)
    if (pictures[c].observation)
      find_gross (&pictures[c], points->n);
}
