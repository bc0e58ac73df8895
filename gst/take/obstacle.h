/* What the cloth may touch.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/file/file.h"

G_BEGIN_DECLS

#define CLOTH_MAX_OBSTACLES 1024

/* @CLOTH_OBSTACLE_SPHERE: a ball
 * @CLOTH_OBSTACLE_PLANE: a half-space that the normal points out of
 * @CLOTH_OBSTACLE_CAPSULE: what lies within a radius of a line from point to end
 * @CLOTH_OBSTACLE_MESH: triangles, whose fronts (counter-clockwise) are outside
 */
typedef enum {
  CLOTH_OBSTACLE_SPHERE,
  CLOTH_OBSTACLE_PLANE,
  CLOTH_OBSTACLE_CAPSULE,
  CLOTH_OBSTACLE_MESH
} ClothObstacleKind;

/* @kind: its shape
 * @point: centre of the sphere, a point of the plane, one end of the capsule's line,
 *   metres
 * @end: the other end of the capsule's line
 * @normal: unit normal of the plane
 * @radius_m: radius of the sphere or capsule, metres
 * @friction: coefficient of friction, NaN when unknown
 * @mesh: (nullable): name of the mesh's OBJ file
 * @n_points: points of the mesh; 0 as long as its file was not read
 * @points: 3 numbers a point, metres in the world
 * @n_triangles: triangles of the mesh
 * @triangles: 3 points a triangle
 *
 * Something at rest that the cloth may touch.
 */
typedef struct {
  ClothObstacleKind kind;
  gdouble point[3];
  gdouble end[3];
  gdouble normal[3];
  gdouble radius_m;
  gdouble friction;
  gchar *mesh;
  guint n_points;
  gdouble *points;
  guint n_triangles;
  guint32 *triangles;
} ClothObstacle;

GArray *cloth_obstacles_new (void);
GArray *cloth_obstacles_copy (const GArray * obstacles);
gboolean cloth_obstacle_load_mesh (ClothObstacle * obstacle,
    const gchar * folder, GError ** error);

G_END_DECLS
