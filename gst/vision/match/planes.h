/* A picture at several blurs, to be looked up between its pixels.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/image.h"

G_BEGIN_DECLS

/* Most planes of a picture. */
#define CLOTH_PLANES 12
/* Pixels by which a plane goes on beyond the picture on each side. */
#define CLOTH_PLANE_PAD 8

/* @coefficients: of a cubic B-spline through the blurred picture, @stride a row
 * @width: columns with both pads
 * @height: rows with both pads
 * @stride: numbers from one row to the next
 * @step: pixels of the picture from one to the next
 * @variance: of the blur, px² of the picture
 *
 * The picture's (x, y) lies at ((x + 0.5) / @step − 0.5 + pad, the same of y).
 */
typedef struct {
  gfloat *coefficients;
  gint width, height, stride, step;
  gdouble variance;
} ClothPlane;

/* @planes: sharpest first
 * @n_planes: number of them, at least 1
 * @width: of the picture, px
 * @height: of it
 */
typedef struct {
  ClothPlane planes[CLOTH_PLANES];
  guint n_planes;
  gint width, height;
} ClothPlanes;

ClothPlanes *cloth_planes_new (const ClothImage * picture);
void cloth_planes_free (ClothPlanes * planes);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothPlanes, cloth_planes_free)
G_END_DECLS
