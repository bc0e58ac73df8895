/* What the triangulation shares with its inner loop.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/simd.h"

G_BEGIN_DECLS

/* Circles that are looked at together. Behind the last one there are as many of nothing. */
#define CLOTH_DELAUNAY_LANES 8

/* @x, @y: middles of circles
 * @square: their radii squared
 *
 * Of nothing: infinity, 0 and 0.
 */
typedef struct {
  gdouble *x, *y, *square;
} ClothDelaunayCircles;

/* @find: the first circle from @from on, of @n, that contains the point (@x, @y) or lies
 *   left of it; @n if there is none
 */
typedef struct {
  guint (*find) (const ClothDelaunayCircles * circles, guint from, guint n,
      gdouble x, gdouble y);
} ClothDelaunayKernel;

CLOTH_SIMD_TABLES (ClothDelaunayKernel, cloth_delaunay_kernel);

G_END_DECLS
