/* What the surfaces of disparities share with their inner loops.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/simd.h"

G_BEGIN_DECLS

/* Pixels that are worked on together, and elements of nothing beside each phase of a row. */
#define CLOTH_DISPARITY_CHUNK 16
/* Rows of nothing above and below. */
#define CLOTH_DISPARITY_ROWS 2
/* Beyond any disparity. */
#define CLOTH_DISPARITY_FAR 1e9f

/* @phase: elements of a phase of a row: of the columns 3·k + phase by k
 * @chunks: chunks of a phase
 * @x: disparities
 * @low: least of each
 * @high: greatest
 * @gain: 1 over the diagonal of the equations; 0 where nothing is to be found
 * @h: 1 where the second difference across counts, else 0
 * @v: that down
 * @residual, @direction, @product: of conjugate gradients
 * @busy: the chunks of each row in which there is something to find: twice the number of the
 *   chunk, which counts on from phase to phase; plus 1 if all second differences that these
 *   pixels are in are there
 * @n_busy: how many they are, by row
 *
 * Planes of one level. A row is three phases, so that pixels that don't touch each other's
 * equations are neighbours in memory: the stencil of the squared Laplacian reaches 2 px.
 * All pointers are those of pixel (0, 0).
 */
typedef struct {
  gint phase, chunks;
  gfloat *x, *low, *high, *gain, *h, *v;
  gfloat *residual, *direction, *product;
  guint16 *busy;
  gint *n_busy;
} ClothDisparityPlanes;

/* @pack: a row of pixels into the phases of row @y of a plane
 * @unpack: back
 * @prepare: gains and busy chunks of a row; gains are 1 where there is something to find
 * @relax: a sweep of projected Gauss–Seidel over a row, which touches no row that is a
 *   multiple of 3 away
 * @residual: of the equations, in a row; Returns: the sum of residual²·gain
 * @apply: the equations to the direction; Returns: direction·product
 * @step: along the direction by @length; Returns: the sum of residual²·gain
 * @turn: the next direction, of the residual and @share of the last one
 */
typedef struct
{
  void (*pack) (const ClothDisparityPlanes * planes, const gfloat * from,
      gint width, gint y, gfloat * plane);
  void (*unpack) (const ClothDisparityPlanes * planes, const gfloat * plane,
      gint width, gint y, gfloat * to);
  void (*prepare) (const ClothDisparityPlanes * planes, gint y);
  void (*relax) (const ClothDisparityPlanes * planes, gint y,
      gfloat relaxation);
  gdouble (*residual) (const ClothDisparityPlanes * planes, gint y);
  gdouble (*apply) (const ClothDisparityPlanes * planes, gint y);
  gdouble (*step) (const ClothDisparityPlanes * planes, gint y, gfloat length);
  void (*turn) (const ClothDisparityPlanes * planes, gint y, gfloat share);
} ClothDisparityKernels;

CLOTH_SIMD_TABLES (ClothDisparityKernels, cloth_disparity_kernels);

G_END_DECLS
