/* Sums of the corner model over a window, for corner.c: sixteen pixels at a time, the
 * same rounding in every instruction set.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/simd.h"

G_BEGIN_DECLS

#define CLOTH_CORNER_LANES 16
/* A disc of radius 12 with its rim, in whole vectors. */
#define CLOTH_CORNER_MAX_VECTORS 36

typedef gfloat ClothLanes __attribute__((vector_size (64)));

/* The window's pixels: offsets from its middle, grey levels less their mean, weights.
 * Padding lanes have weight 0. */
typedef struct {
  ClothLanes x[CLOTH_CORNER_MAX_VECTORS];
  ClothLanes y[CLOTH_CORNER_MAX_VECTORS];
  ClothLanes value[CLOTH_CORNER_MAX_VECTORS];
  ClothLanes weight[CLOTH_CORNER_MAX_VECTORS];
  /* Left by the basis for the normal equations. */
  ClothLanes e1[CLOTH_CORNER_MAX_VECTORS];
  ClothLanes e2[CLOTH_CORNER_MAX_VECTORS];
  ClothLanes g1[CLOTH_CORNER_MAX_VECTORS];
  ClothLanes g2[CLOTH_CORNER_MAX_VECTORS];
  ClothLanes e12[CLOTH_CORNER_MAX_VECTORS];
  ClothLanes q1[CLOTH_CORNER_MAX_VECTORS];
  ClothLanes q2[CLOTH_CORNER_MAX_VECTORS];
  ClothLanes ridge[CLOTH_CORNER_MAX_VECTORS];
  gint n_vectors;
} ClothCornerWindow;

typedef struct {
  gfloat x, y, theta1, theta2, blur;
} ClothCornerState;

/* Parameters of the linearised model: place of edge 1 and 2 across their directions in
 * units of sqrt(2)·blur, their angles, blur; then c0 to c3. */
#define CLOTH_CORNER_N 9
#define CLOTH_CORNER_N_SUMS 45
#define CLOTH_CORNER_N_BASIS 14

/* @basis: @sums: upper triangle by rows of BᵀWB with B = (1, e1, e2, e12), then BᵀWI. e12 is
 *   the blurred product of both steps.
 * @normal: @normal: upper triangle by rows of JᵀWJ; @gradient: JᵀWr of the first five;
 *   @cost: rᵀWr. @sums: what @basis gave.
 * @influence: what the residuals, taken for independent noise, do to two linear
 *   combinations of the parameters: the covariance xx, xy, yy. @root: Cholesky's factor of
 *   JᵀWJ, its diagonal inverted; @row: both combinations times (JᵀWJ)⁻¹. Each squared
 *   residual is divided by one minus its leverage (MacKinnon & White 1985, HC2). */
typedef struct {
  void (*basis) (ClothCornerWindow * window, const ClothCornerState * state,
      gfloat sums[CLOTH_CORNER_N_BASIS]);
  void (*normal) (const ClothCornerWindow * window,
      const ClothCornerState * state, const gfloat c[4],
      const gfloat sums[CLOTH_CORNER_N_BASIS],
      gfloat normal[CLOTH_CORNER_N_SUMS], gfloat gradient[5], gfloat * cost);
  void (*influence) (const ClothCornerWindow * window,
      const ClothCornerState * state, const gfloat c[4],
      const gfloat root[CLOTH_CORNER_N * CLOTH_CORNER_N],
      const gfloat row[2 * CLOTH_CORNER_N], gfloat cov[3]);
} ClothCornerModel;

CLOTH_SIMD_TABLES (ClothCornerModel, cloth_corner_model);

G_END_DECLS
