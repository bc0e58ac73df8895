/* Points filmed by several cameras, and what comes back of them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/math/random.h"
#include "gst/rig/triangulate.h"

#define MAX_VIEWS 20

typedef struct
{
  guint n_views, n_points;
  gdouble *planes;
  ClothTriangulateView views[MAX_VIEWS];
} Scene;

static inline gdouble *
plane (Scene * scene, guint view, guint k)
{
  return scene->planes + (view * 5 + k) * (gsize) scene->n_points;
}

static inline void
scene_init (Scene * scene, guint n_views, guint n_points)
{
  scene->n_views = n_views;
  scene->n_points = n_points;
  scene->planes = g_new0 (gdouble, 5 * n_views * (gsize) n_points);
  for (guint i = 0; i < n_views; i++) {
    ClothTriangulateView view = { plane (scene, i, 0), plane (scene, i, 1),
      plane (scene, i, 2), plane (scene, i, 3), plane (scene, i, 4)
    };

    scene->views[i] = view;
    for (guint k = 0; k < n_points; k++)
      plane (scene, i, 2)[k] = plane (scene, i, 4)[k] = 0.01;
  }
}

static inline void
scene_clear (Scene * scene)
{
  g_free (scene->planes);
}

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (Scene, scene_clear)
/* Camera i of n on an arc of radius 2 m about (10, -5, 1), looking at it; z is up. */
     static void
         make_camera (ClothCamera * camera, guint i, guint n, ClothLens lens)
{
  static const gdouble brown[8] =
      { -0.28, 0.09, 1e-3, -5e-4, -0.012, 0.02, 0.003, -0.001 };
  static const gdouble fisheye[8] = { 0.02, -0.01, 0.003, -0.0005 };
  gdouble angle = n > 1 ? -0.9 + 1.8 * i / (n - 1) : 0., tilt = 0.2 - 0.05 * i;
  gdouble f[3] = { sin (angle) * cos (tilt), cos (angle) * cos (tilt),
    -sin (tilt)
  };
  gdouble r[3] = { cos (angle), -sin (angle), 0. };
  const gdouble target[3] = { 10., -5., 1. };

  memset (camera, 0, sizeof (*camera));
  camera->width = 1920;
  camera->height = 1080;
  camera->K[0] = 1500.;
  camera->K[4] = 1490.;
  camera->K[1] = 0.7;
  camera->K[2] = 955.;
  camera->K[5] = 545.;
  camera->K[8] = 1.;
  camera->lens = lens;
  if (lens == CLOTH_LENS_FISHEYE)
    memcpy (camera->k, fisheye, sizeof (fisheye));
  else if (lens != CLOTH_LENS_NONE)
    memcpy (camera->k, brown,
        cloth_lens_n_coefficients (lens) * sizeof (gdouble));
  for (gint j = 0; j < 3; j++) {
    camera->R[j] = r[j];
    camera->R[6 + j] = f[j];
  }
  /* down = forward × right */
  camera->R[3] = f[1] * r[2] - f[2] * r[1];
  camera->R[4] = f[2] * r[0] - f[0] * r[2];
  camera->R[5] = f[0] * r[1] - f[1] * r[0];
  cloth_mat3_vec (camera->R, target, camera->t);
  for (gint j = 0; j < 3; j++)
    camera->t[j] = -camera->t[j];
  camera->t[2] += 2.;
}

static inline void
random_point (ClothRandom * random, gdouble X[3])
{
  X[0] = 10. + 0.8 * (cloth_random_uniform (random) - 0.5);
  X[1] = -5. + 0.8 * (cloth_random_uniform (random) - 0.5);
  X[2] = 1. + 0.5 * (cloth_random_uniform (random) - 0.5);
}

static inline void
film (Scene * scene, const ClothCamera * cameras, guint k, const gdouble X[3])
{
  for (guint i = 0; i < scene->n_views; i++) {
    gdouble px[2];

    g_assert_true (cloth_camera_project (&cameras[i], X, px, NULL, NULL));
    plane (scene, i, 0)[k] = px[0];
    plane (scene, i, 1)[k] = px[1];
  }
}

static inline const ClothTriangulation *
run (ClothTriangulator * triangulator, Scene * scene)
{
  const ClothTriangulation *result = NULL;
  g_autoptr (GError) error = NULL;

  g_assert_true (cloth_triangulator_run (triangulator, scene->n_views,
          scene->views, scene->n_points, &result, &error));
  g_assert_no_error (error);
  g_assert_cmpuint (result->n_points, ==, scene->n_points);
  return result;
}

static inline ClothTriangulator *
make (const ClothCamera * cameras, guint n)
{
  g_autoptr (GError) error = NULL;
  ClothTriangulator *triangulator = cloth_triangulator_new (n, cameras, &error);

  g_assert_no_error (error);
  g_assert_nonnull (triangulator);
  return triangulator;
}

static inline gdouble
distance (const ClothTriangulation * r, guint k, const gdouble X[3])
{
  gdouble s = 0.;

  for (gint j = 0; j < 3; j++)
    s += (r->position[j][k] - X[j]) * (r->position[j][k] - X[j]);
  return sqrt (s);
}

static inline void
assert_unseen (const ClothTriangulation * r, guint k, ClothPointReason reason)
{
  g_assert_cmpuint (r->state[k], ==, CLOTH_POINT_UNSEEN);
  g_assert_cmpuint (r->reason[k], ==, reason);
  g_assert_cmpuint (r->n_views[k], ==, 0);
  g_assert_cmpuint (r->views[k], ==, 0);
  for (gint j = 0; j < 3; j++)
    g_assert_true (isnan (r->position[j][k]));
  g_assert_true (isinf (r->covariance[0][k]) && isinf (r->covariance[3][k])
      && isinf (r->covariance[5][k]));
}
