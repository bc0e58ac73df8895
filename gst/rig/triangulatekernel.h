/* Inner loops of triangulation: the same arithmetic for 1, 4 or 8 points at a time.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/triangulate.h"

G_BEGIN_DECLS

/* Points of a block: what one row of scratch memory holds. */
#define BLOCK 8

/* A camera prepared for the kernels. */
typedef struct {
  /* world, moved and scaled, to normalised image coordinates */
  gdouble P[12];
  /* K and the inverses of its focal lengths */
  gdouble fx, skew, cx, fy, cy, ifx, ify;
  /* px² per unit² of normalised coordinates at the centre */
  gdouble area;
  ClothLens lens;
  gdouble k[8];
  /* First guess of the true place d·r + s·t from the distorted one, d, with
   * t = (k[3], k[2]) and q = d²: r = 1 + a₀q + … + a₅q⁶ + (b₀ + b₁q)·(d·t),
   * s = c₀q + c₁q²; of a fisheye the ratio of angle to radius, r without b. */
  gdouble inverse[10];
  /* Newton's result is trusted up to this square of the radius, of a fisheye of the
   * angle */
  gdouble max_r2;
  ClothCamera camera;
} TriangulateCamera;

/* An observation in normalised coordinates: place and information matrix (the inverse of
 * the covariance), all 0 when not seen. */
enum { OBS_X, OBS_Y, OBS_IXX, OBS_IXY, OBS_IYY, N_OBS };

/* Planes of a view's input in px. */
enum { IN_U, IN_V, IN_XX, IN_XY, IN_YY, N_IN };

/* Results of a block in the moved and scaled world; WORST: the greatest normalised error
 * of a view against the others, squared, in σ²; WORST_PX: the greatest reprojection
 * error, squared, px²; DEPTH: the least depth; COUNT: views; FLAG: below. */
enum {
  OUT_X, OUT_Y, OUT_Z, OUT_XX, OUT_XY, OUT_XZ, OUT_YY, OUT_YZ, OUT_ZZ,
  OUT_CHI2, OUT_WORST, OUT_WORST_PX, OUT_DEPTH, OUT_COUNT, OUT_SINGULAR, N_OUT
};

typedef struct {
  /* Normalises one view of a block: in[N_IN] are BLOCK values each, obs[N_OBS][BLOCK].
   * Returns a bit for each point whose lens must be done again by other means. */
  guint (*load) (const TriangulateCamera * camera, const gdouble * const *in,
      gdouble error_floor, gdouble * obs);
  /* Solves a block: obs[n_cameras][N_OBS][BLOCK], views: the n_views cameras to use,
   * out[N_OUT][BLOCK]. */
  void (*solve) (const TriangulateCamera * cameras, const gdouble * obs,
      const guint8 * views, guint n_views, gdouble * out);
  /* Solves one point, that of column 0 of every row. */
  void (*solve_one) (const TriangulateCamera * cameras, const gdouble * obs,
      const guint8 * views, guint n_views, gdouble * out);
} TriangulateKernel;

const TriangulateKernel *cloth_triangulate_kernel (ClothSimd simd);

G_END_DECLS
