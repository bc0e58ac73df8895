/* A surface of disparities at halved sizes, each of which begins with the solution of the
 * next smaller one.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/pool.h"
#include "gst/vision/disparity/disparity-private.h"

G_BEGIN_DECLS

/* The most levels; the smallest has fewer than 16 rows or columns. */
#define CLOTH_PYRAMID_LEVELS 11

/* @CLOTH_PYRAMID_SURFACE: of the surface
 * @CLOTH_PYRAMID_RIGHT: so is its right neighbour, without an edge of depth between them
 * @CLOTH_PYRAMID_DOWN: so is the lower one
 * @CLOTH_PYRAMID_FREE: may have any disparity
 */
enum
{
  CLOTH_PYRAMID_SURFACE = 1,
  CLOTH_PYRAMID_RIGHT = 2,
  CLOTH_PYRAMID_DOWN = 4,
  CLOTH_PYRAMID_FREE = 8
};

/* @given: disparities that were measured
 * @found: those that are looked for
 * @flags: of each pixel, as above
 *
 * One size; rows without gaps.
 */
typedef struct {
  gint width, height;
  gfloat *given, *found;
  guint8 *flags;
  ClothDisparityPlanes planes;
} ClothPyramidLevel;

typedef struct {
  gint width, height, n_levels;
  ClothPyramidLevel levels[CLOTH_PYRAMID_LEVELS];
  gfloat *memory;
  guint8 *flags;
  guint16 *busy;
  gint *n_busy;
  gdouble *sums;                /* of each row */
  gfloat *rows;                 /* of each worker, for packing */
  guint n_workers;
} ClothPyramid;

/* @half_width: how far what isn't free may go from what was given, px; 0: not at all
 * @narrowing: factor of it from one level to the next smaller one
 * @sweeps: of projected Gauss–Seidel on each level, with this @relaxation
 * @tolerance: of conjugate gradients, which are used if @half_width is 0
 */
typedef struct {
  gdouble half_width, narrowing;
  guint sweeps;
  gdouble relaxation, tolerance;
} ClothPyramidParams;

void cloth_pyramid_resize (ClothPyramid * self, gint width, gint height,
    guint n_workers);
void cloth_pyramid_clear (ClothPyramid * self);
void cloth_pyramid_solve (ClothPyramid * self,
    const ClothPyramidParams * params, ClothPool * pool, ClothSimd level);

G_END_DECLS
