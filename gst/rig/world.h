/* Where the world of a rig lies, and which way is up.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/bundle.h"
#include "gst/rig/rig.h"

G_BEGIN_DECLS

/* Most lines of a file of points. */
#define CLOTH_WORLD_MAX_POINTS 10000

/* @camera: which camera
 * @px: where it sees the point
 * @world: where the point is in the new world, m; equal in all views of one point
 */
typedef struct {
  guint camera;
  gdouble px[2];
  gdouble world[3];
} ClothWorldPoint;

/* @R: row-major rotation from the new world to the old one
 * @t: the new world's origin in the old one, m
 */
typedef struct {
  gdouble R[9];
  gdouble t[3];
} ClothWorld;

const ClothCamera *cloth_world_camera (const ClothRig * rig);
void cloth_world_of_camera (const ClothCamera * camera, ClothWorld * world);
GArray *cloth_world_points_parse (const ClothRig * rig, const gchar * data,
    gsize length, GError ** error);
gboolean cloth_world_of_points (const ClothRig * rig, guint n,
    const ClothWorldPoint * points, ClothWorld * world, gdouble * rms,
    gdouble * scale, GError ** error);
gboolean cloth_world_of_board (const ClothRig * rig, guint n_views,
    const ClothBundleView * views, const gdouble * board, ClothWorld * world,
    GError ** error);
void cloth_world_move_rig (const ClothWorld * world, ClothRig * rig);
void cloth_world_move_pose (const ClothWorld * world, gdouble pose[12]);

G_END_DECLS
