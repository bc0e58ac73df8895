/* Inner loops of triangulation: the same arithmetic for 1, 4 or 8 points at a time.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/triangulatekernel.h"

#include <math.h>

/* Gauss–Newton steps; one or two are the rule. */
#define MAX_STEPS 12
/* A step of at most one standard deviation (δᵀHδ) and of a thousandth of the cameras'
 * distance is the last one: it leaves a thousandth of itself, and the chord step after it
 * a thousandth of that. */
#define LAST_SIGMA 1.
#define LAST_RELATIVE 1e-6
/* A pivot this small against the trace: the distance is not determined. */
#define SINGULAR 1e-13
/* Newton steps that undistort, and the error before the last of them: it leaves its
 * square. */
#define MAX_NEWTON 6
#define LAST_NEWTON 1e-8

/* Every width is the same source, so every width gives the same bits: there are no sums
 * over lanes, and fused rounding is switched off for the whole project. */
#define LANES 1
#define V gdouble
#define M gint64
#define NAME(f) f ## _1
#include "gst/rig/triangulatekernel.inc.c"
#undef LANES
#undef V
#undef M
#undef NAME

static const TriangulateKernel scalar = { load_1, solve_1 };

#if defined (__x86_64__) && defined (__GNUC__)
#pragma GCC push_options
#pragma GCC target ("avx2,fma")
typedef gdouble V4 __attribute__((vector_size (32)));
typedef gint64 M4 __attribute__((vector_size (32)));

#define LANES 4
#define V V4
#define M M4
#define NAME(f) f ## _4
#include "gst/rig/triangulatekernel.inc.c"
#undef LANES
#undef V
#undef M
#undef NAME
#pragma GCC pop_options

#pragma GCC push_options
#pragma GCC target ("avx512f,avx512bw,avx512dq,avx512vl")
typedef gdouble V8 __attribute__((vector_size (64)));
typedef gint64 M8 __attribute__((vector_size (64)));

#define LANES 8
#define V V8
#define M M8
#define NAME(f) f ## _8
#include "gst/rig/triangulatekernel.inc.c"
#undef LANES
#undef V
#undef M
#undef NAME
#pragma GCC pop_options

static const TriangulateKernel avx2 = { load_4, solve_4 };
static const TriangulateKernel avx512 = { load_8, solve_8 };
#endif

const TriangulateKernel *
cloth_triangulate_kernel (ClothSimd simd)
{
#if defined (__x86_64__) && defined (__GNUC__)
  switch (cloth_simd_resolve (simd)) {
    case CLOTH_SIMD_AVX512:
      return &avx512;
    case CLOTH_SIMD_AVX2:
      return &avx2;
    default:
      break;
  }
#endif
  return &scalar;
}

void
cloth_triangulate_solve_one (const TriangulateCamera * cameras,
    const gdouble * obs, const guint8 * views, guint n_views, gdouble * out)
{
  solve_group_1 (cameras, obs, views, n_views, out);
}
