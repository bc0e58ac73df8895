/* One camera: pinhole with lens distortion, and its place in the world.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* @CLOTH_LENS_NONE: pinhole
 * @CLOTH_LENS_BROWN5: Brown–Conrady, k1 k2 p1 p2 k3
 * @CLOTH_LENS_BROWN8: rational Brown–Conrady, k1 k2 p1 p2 k3 k4 k5 k6
 * @CLOTH_LENS_FISHEYE: equidistant (Kannala–Brandt), k1 k2 k3 k4
 *
 * Lens models; coefficients in OpenCV's order and meaning.
 */
typedef enum {
  CLOTH_LENS_NONE,
  CLOTH_LENS_BROWN5,
  CLOTH_LENS_BROWN8,
  CLOTH_LENS_FISHEYE
} ClothLens;

/* @name: (nullable): its name in rig.json
 * @width: picture width, px
 * @height: picture height, px
 * @K: row-major 3×3 camera matrix, px
 * @lens: distortion model
 * @k: its coefficients, unused ones 0
 * @R: row-major rotation, world to camera
 * @t: translation, metres: x ~ K [R|t] X
 * @device: (nullable): what the camera is opened by
 * @rolling_shutter_s: time from the first to the last row, s
 * @offset_s: this camera's time minus the rig's, s
 * @K_sd: standard deviations of fx, fy, cx, cy, px; 0 when unknown
 * @k_sd: standard deviations of @k
 * @r_sd: standard deviations of a small rotation about the camera's axes, rad
 * @t_sd: standard deviations of @t, m
 * @offset_sd: standard deviation of @offset_s, s
 */
typedef struct {
  gchar *name;
  gint width, height;
  gdouble K[9];
  ClothLens lens;
  gdouble k[8];
  gdouble R[9];
  gdouble t[3];
  gchar *device;
  gdouble rolling_shutter_s, offset_s;
  gdouble K_sd[4], k_sd[8], r_sd[3], t_sd[3], offset_sd;
} ClothCamera;

/* Columns of the derivative with respect to a camera's parameters, in this order:
 * fx fy cx cy, k[0] … k[7], rotation vector (3), t (3).
 */
#define CLOTH_CAMERA_N_PARAMETERS 18

guint cloth_lens_n_coefficients (ClothLens lens);
void cloth_camera_copy (ClothCamera * to, const ClothCamera * from);
void cloth_camera_clear (ClothCamera * camera);

gboolean cloth_camera_project (const ClothCamera * camera,
    const gdouble X[3], gdouble px[2], gdouble * d_point,
    gdouble * d_parameters);

void cloth_camera_distort (const ClothCamera * camera, const gdouble xy[2],
    gdouble px[2], gdouble * d_xy);

guint cloth_camera_undistort_points (const ClothCamera * camera, guint n,
    const gdouble * u, const gdouble * v, gdouble * x, gdouble * y,
    gdouble * jacobian);

G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC (ClothCamera, cloth_camera_clear)
G_END_DECLS
