/* A printed plane before the cameras of a stereo head, filmed pixel by pixel: its depth is a
 * formula.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/rig/rig.h"
#include "gst/rig/rotation.h"

#define SCENE_WIDTH 241
#define SCENE_HEIGHT 181
#define SCENE_NEAR 0.8
#define SCENE_FAR 1.6

/* z = 1.1 + 0.2 x − 0.15 y, m; the first camera stands near the origin and looks along z. */
static const gdouble scene_plane[3] = { 0.2, -0.15, 1.1 };

/* A number between 0 and 1 for each knot of a grid. */
static inline gdouble
scene_knot (gint x, gint y)
{
  guint32 h = (guint32) x * 0x9e3779b1u ^ ((guint32) y * 0x85ebca77u + 0x27d4eb2fu);

  h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  h = (h ^ (h >> 12)) * 0x297a2d39u;
  return ((h ^ (h >> 15)) & 0xffff) / 65535.;
}

/* Smooth noise whose knots are @cell m apart. */
static inline gdouble
scene_noise (gdouble x, gdouble y, gdouble cell)
{
  const gdouble u = x / cell, v = y / cell;
  const gint left = (gint) floor (u), top = (gint) floor (v);
  gdouble a = u - left, b = v - top;

  a = a * a * (3 - 2 * a);
  b = b * b * (3 - 2 * b);
  return (1 - b) * ((1 - a) * scene_knot (left, top)
      + a * scene_knot (left + 1, top)) + b * ((1 - a) * scene_knot (left,
          top + 1) + a * scene_knot (left + 1, top + 1));
}

/* The point of the plane that a pixel shows. Returns: its depth in the camera's frame; NaN: the
 * lens has no such pixel */
static inline gdouble
scene_depth (const ClothCamera * camera, gint column, gint row, gdouble X[3])
{
  gdouble u = column, v = row, ray[3], along[3], at[3], s;

  if (!cloth_camera_undistort_points (camera, 1, &u, &v, &u, &v, NULL))
    return NAN;
  ray[0] = u;
  ray[1] = v;
  ray[2] = 1;
  cloth_mat3_vec_t (camera->R, ray, along);
  cloth_mat3_vec_t (camera->R, camera->t, at);
  for (gint i = 0; i < 3; i++)
    at[i] = -at[i];
  s = (scene_plane[2] + scene_plane[0] * at[0] + scene_plane[1] * at[1]
      - at[2]) / (along[2] - scene_plane[0] * along[0]
      - scene_plane[1] * along[1]);
  for (gint i = 0; i < 3; i++)
    X[i] = at[i] + s * along[i];
  return s;
}

/* @offset: added to all, m: moves the print on the plane */
static inline void
scene_film (const ClothCamera * camera, gdouble offset, guint8 * to, gint stride)
{
  for (gint y = 0; y < camera->height; y++)
    for (gint x = 0; x < camera->width; x++) {
      gdouble X[3], tone;

      if (isnan (scene_depth (camera, x, y, X)))
        X[0] = X[1] = 0;
      tone = 30 + 110 * scene_noise (X[0] + offset, X[1], 0.012)
          + 90 * scene_noise (X[0] + offset + 7, X[1] + 3, 0.031);
      to[y * stride + x] = (guint8) (tone + 0.5);
    }
}

/* @place: m; @turn: rotation vector */
static inline void
scene_camera (ClothCamera * camera, const gchar * name,
    const gdouble place[3], const gdouble turn[3])
{
  static const gdouble K[9] = { 300, 0, 120.3, 0, 302, 89.6, 0, 0, 1 };

  g_free (camera->name);
  camera->name = g_strdup (name);
  camera->width = SCENE_WIDTH;
  camera->height = SCENE_HEIGHT;
  memcpy (camera->K, K, sizeof (K));
  cloth_rotation_from_vector (turn, camera->R);
  cloth_mat3_vec (camera->R, place, camera->t);
  for (gint i = 0; i < 3; i++)
    camera->t[i] = -camera->t[i];
}

/* A rig of three: one, one to its right and one below, none of them quite parallel. */
static inline ClothRig *
scene_rig (void)
{
  static const gdouble places[3][3] = { {0, 0, 0}, {0.1, 0.003, 0.004},
  {-0.004, 0.09, -0.003}
  };
  static const gdouble turns[3][3] = { {0.01, -0.02, 0.01}, {0.02, -0.05, -0.01},
  {-0.04, 0.01, 0.02}
  };
  ClothRig *rig = cloth_rig_new (3);

  for (guint i = 0; i < 3; i++) {
    g_autofree gchar *name = g_strdup_printf ("cam%u", i);

    scene_camera (&rig->cameras[i], name, places[i], turns[i]);
  }
  return rig;
}
