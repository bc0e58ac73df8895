/* Rectification: two cameras' pictures turned so that a point of the world lies on one row of
 * both.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/camera.h"

G_BEGIN_DECLS

/* The most disparities that a pair's depths may have, px, and the greatest of them. */
#define CLOTH_RECTIFY_MOST_RANGE 1024
#define CLOTH_RECTIFY_MOST 5120

/* @width: of both rectified pictures, px
 * @height: of both
 * @focal: focal length of both, px
 * @centre: principal point of both, px
 * @head: row-major rotation from the first camera's frame to the rectified one, whose x axis
 *   points from the first camera to the second and whose z axis looks at the scene
 * @partner: from the second camera's frame
 * @baseline: from the first camera to the second, m
 * @least: least disparity that is looked for, px
 * @range: how many disparities are, px, from @least on; a multiple of 16
 *
 * A rectified pair. A point at depth z along the rectified z axis lies @focal·@baseline/z px
 * further left in the second picture than in the first, which is always the left one: a
 * partner to the left turns the pictures upside down, one below turns them on their side.
 */
typedef struct {
  gint width, height;
  gdouble focal, centre[2];
  gdouble head[9], partner[9];
  gdouble baseline;
  gint least, range;
} ClothRectification;

gboolean cloth_rectify_pair (const ClothCamera * head,
    const ClothCamera * partner, gdouble near, gdouble far,
    ClothRectification * pair, GError ** error);
void cloth_rectify_map (const ClothRectification * pair,
    const ClothCamera * camera, const gdouble rotation[9], gfloat * x,
    gfloat * y);
void cloth_rectify_rays (const ClothCamera * camera, gfloat * rays);
void cloth_rectify_places (const ClothRectification * pair,
    const gfloat * rays, gsize n, gfloat * x, gfloat * y);
void cloth_rectify_relate (const ClothRectification * base,
    const ClothRectification * pair, gdouble place[9], gdouble unit[3]);
void cloth_rectify_view (const ClothRectification * base,
    const ClothCamera * head, const ClothCamera * camera,
    gdouble rotation[9], gdouble shift[2], gdouble * forward);

G_END_DECLS
