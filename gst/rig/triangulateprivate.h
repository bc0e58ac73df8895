/* What the files of triangulation share: its inner loops, the same arithmetic for 1, 4 or 8
 * points at a time, and the triangulator.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/triangulate.h"

G_BEGIN_DECLS

/* Points of a block: what one row of scratch memory holds. */
#define BLOCK 16

/* A camera prepared for the kernels. */
typedef struct {
  /* world, moved and scaled, to normalised image coordinates */
  gdouble P[12];
  /* K and the inverses of its focal lengths */
  gdouble fx, skew, cx, fy, cy, ifx, ify;
  /* px² per unit² of normalised coordinates at the centre */
  gdouble area;
  /* KᵀIK of information I in px, as xx of I's xx; xy of its xx and xy; yy of its xx,
   * xy and yy */
  gdouble unit[6];
  ClothLens lens;
  gdouble k[8];
  /* k as the derivative has it; Brown: 2k₀ 4k₁ 6k₄ of the radial term's numerator, 2k₅
   * 4k₆ 6k₇ of its denominator, then 2k₂ 2k₃ 4k₂ 4k₃; fisheye: 3k₀ 5k₁ 7k₂ 9k₃ */
  gdouble slope[10];
  /* First guess of the true place d·r + s·t from the distorted one, d, with
   * t = (k[3], k[2]) and q = d²: r = 1 + a₀q + … + a₆q⁷ + (b₀ + … + b₃q³)·(d·t),
   * s = c₀q + … + c₃q⁴; of a fisheye the ratio of angle to radius, r without b. */
  gdouble inverse[15];
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

/* Results of a block in the moved and scaled world; REASON: a #ClothPointReason, of a
 * point that two or more views saw. */
enum {
  OUT_X, OUT_Y, OUT_Z, OUT_XX, OUT_XY, OUT_XZ, OUT_YY, OUT_YZ, OUT_ZZ,
  OUT_CHI2, OUT_REASON, N_OUT
};

/* Squares of the normalised error of a view against the others, σ², and of a view's
 * reprojection error, px², above which the views disagree. */
typedef struct {
  gdouble error, error_px;
} TriangulateLimits;

typedef struct {
  /* Normalises one view of a block: in[N_IN] are BLOCK values each, obs[N_OBS][BLOCK].
   * Returns a bit for each point that the view saw; again: one for each whose lens must
   * be done again by other means. */
  guint (*load) (const TriangulateCamera * camera, const gdouble * const *in,
      gdouble error_floor, gdouble * obs, guint * again);
  /* Solves a block: obs[n_cameras][N_OBS][BLOCK], views: the n_views cameras to use,
   * out[N_OUT][BLOCK]. Returns a bit for each point that all of the views saw and on
   * which they agree. */
  guint (*solve) (const TriangulateCamera * cameras, const gdouble * obs,
      const guint8 * views, guint n_views, const TriangulateLimits * limits,
      gdouble * out);
} TriangulateKernel;

CLOTH_SIMD_TABLES (TriangulateKernel, cloth_triangulate_kernel);
#ifdef __x86_64__
/* Scalar, for processors that have fused instructions. */
extern const TriangulateKernel cloth_triangulate_kernel_fused;
#endif

/* One thread's memory. */
typedef struct
{
  gdouble *obs;
  gdouble *weighted;
  gdouble out[N_OUT * BLOCK];
  gdouble trial[N_OUT * BLOCK];
  gdouble pad[N_IN * BLOCK];
} Scratch;

struct _ClothTriangulator
{
  guint n_cameras;
  TriangulateCamera *cameras;
  /* The world that the kernels see is (X − origin) / scale. */
  gdouble origin[3], scale;

  ClothTriangulateParameters parameters;
  TriangulateLimits limits;
  ClothPool *pool;
  const TriangulateKernel *kernel;

  guint n_scratch;
  Scratch **scratch;
  guint n_allocated;
  gdouble *reals;
  guint64 *words;
  guint8 *bytes;
  ClothTriangulation result;

  /* of the run under way */
  const ClothTriangulateView *views;
};

G_END_DECLS
