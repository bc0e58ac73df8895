/* Where a cloth of known size lies flat on the ground, by its silhouettes in several cameras.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/camera.h"
#include "gst/vision/image.h"

G_BEGIN_DECLS

/* @CLOTH_FLAT_ERROR_PARAMETER: a size, view or camera that can't be
 * @CLOTH_FLAT_ERROR_SILHOUETTE: a silhouette is empty, full or in pieces
 * @CLOTH_FLAT_ERROR_SHAPE: what is seen is no rectangle of the known size, or too
 *   much of it is outside the picture
 * @CLOTH_FLAT_ERROR_DISAGREE: the cameras see it at different places
 */
typedef enum {
  CLOTH_FLAT_ERROR_PARAMETER,
  CLOTH_FLAT_ERROR_SILHOUETTE,
  CLOTH_FLAT_ERROR_SHAPE,
  CLOTH_FLAT_ERROR_DISAGREE
} ClothFlatError;

#define CLOTH_FLAT_ERROR (cloth_flat_error_quark ())
GQuark cloth_flat_error_quark (void);

/* Pieces of a silhouette smaller than this share of the largest are specks. */
#define CLOTH_FLAT_SPECK 0.05

/* @size: width along u and height along v, m
 * @ground: z of the cloth's surface, m: that of the ground and the cloth's thickness
 * @straight: sides that are less straight than this, RMS, are none, m (0.01)
 * @stretch: share by which a side may differ from its known length (0.1)
 * @agree: greatest distance of a camera's corner from the mean of the others, m (0.02)
 */
typedef struct {
  gdouble size[2];
  gdouble ground;
  gdouble straight, stretch, agree;
} ClothFlatParams;

/* @camera: a camera above the ground
 * @mask: its silhouette of the cloth: 0: none; a view that owns nothing
 */
typedef struct {
  const ClothCamera *camera;
  ClothImage mask;
} ClothFlatView;

/* @x: of the place u = v = 0 (vertex 0), m, world
 * @y: of it
 * @angle: from the world's x axis to the direction of u, counterclockwise seen from above,
 *   rad, −π to π
 * @size: of the cloth, m
 * @ground: z of its surface, m
 * @residual: what is left: of corners their RMS distance, m; of annealing the difference of the
 *   areas as a share of that of the silhouettes
 *
 * The print is above: v runs clockwise from u. A place (u, v) is at
 * (x + u cos + v sin, y + u sin − v cos, ground).
 */
typedef struct {
  gdouble x, y, angle;
  gdouble size[2];
  gdouble ground;
  gdouble residual;
} ClothFlatPose;

/* @n: poses that fit alike: 2, or 4 of a cloth that is nearly a square
 * @poses: (array length=n): them
 *
 * An outline doesn't tell which corner is the first.
 */
typedef struct {
  guint n;
  ClothFlatPose poses[4];
} ClothFlatPoses;

ClothFlatParams cloth_flat_default_params (gdouble width, gdouble height);
gboolean cloth_flat_find (const ClothFlatParams * params, guint n_views,
    const ClothFlatView * views, const gdouble * near, ClothFlatPoses * poses,
    GError ** error);

gboolean cloth_flat_check (const ClothFlatParams * params, guint n_views,
    const ClothFlatView * views, GError ** error);
guint8 *cloth_flat_find_piece (const ClothFlatView * view, GError ** error);
gboolean cloth_flat_reach (const ClothCamera * camera, gdouble ground,
    const gdouble px[2], gdouble xy[2], GError ** error);
void cloth_flat_sort (ClothFlatPoses * poses, const gdouble * near);

void cloth_flat_place (const ClothFlatPose * pose, const gdouble uv[2],
    gdouble X[3]);
gboolean cloth_flat_uv (const ClothFlatPose * pose, const ClothCamera * camera,
    const gdouble px[2], gdouble uv[2]);

G_END_DECLS
