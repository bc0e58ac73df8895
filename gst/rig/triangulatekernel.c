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
 * square; of a Brown lens the chord step after it leaves the cube. */
#define MAX_NEWTON 6
#define LAST_NEWTON 1e-5
#define LAST_NEWTON_FISHEYE 1e-7

/* Every width is the same source, so every width gives the same bits: there are no sums
 * over lanes, and products are fused with sums where the source says so and nowhere
 * else. A width has its operations on vectors V of LANES doubles and on masks M; VECTOR
 * makes one of a number, where the two meet. */
#define FMA(a, b, c) V_FMA (VECTOR (a), VECTOR (b), VECTOR (c))
/* c − a·b */
#define FNMA(a, b, c) V_FNMA (VECTOR (a), VECTOR (b), VECTOR (c))
#define GREATER(a, b) V_GREATER (VECTOR (a), VECTOR (b))
#define CHOOSE(mask, a, b) V_CHOOSE (mask, VECTOR (a), VECTOR (b))
#define INLINE static inline __attribute__((always_inline))

#define TARGET
#define LANES 1
#define V gdouble
#define M guint
#define VECTOR(x) ((gdouble) (x))
#define V_FMA(a, b, c) fma (a, b, c)
#define V_FNMA(a, b, c) fma (-(a), b, c)
#define V_GREATER(a, b) ((a) > (b) ? ~0u : 0u)
#define V_CHOOSE(mask, a, b) ((mask) ? (a) : (b))
#define BITS(mask) ((mask) & 1)
#define LOAD(p) (*(p))
#define STORE(p, v) (*(p) = (v))
#define NAME(f) f ## _1
#include "gst/rig/triangulatekernel.inc.c"
#undef NAME
#undef TARGET

static const TriangulateKernel scalar = { load_1, solve_1 };

#if defined (__x86_64__) && defined (__GNUC__)
#include <immintrin.h>

/* fma () is an instruction here, not a call. */
#define TARGET __attribute__ ((target ("fma")))
#define NAME(f) f ## _1_fma
#include "gst/rig/triangulatekernel.inc.c"
#undef NAME
#undef TARGET
#undef LANES
#undef V
#undef M
#undef VECTOR
#undef V_FMA
#undef V_FNMA
#undef V_GREATER
#undef V_CHOOSE
#undef BITS
#undef LOAD
#undef STORE

#define TARGET __attribute__ ((target ("avx2,fma")))
typedef gint64 Mask4 __attribute__((vector_size (32)));

TARGET INLINE __m256d
same_4 (__m256d a)
{
  return a;
}

#define LANES 4
#define V __m256d
#define M Mask4
#define VECTOR(x) _Generic ((x), V: same_4, default: _mm256_set1_pd) (x)
#define V_FMA _mm256_fmadd_pd
#define V_FNMA _mm256_fnmadd_pd
#define V_GREATER(a, b) ((M) _mm256_cmp_pd (a, b, _CMP_GT_OQ))
#define V_CHOOSE(mask, a, b) _mm256_blendv_pd (b, a, (V) (mask))
#define BITS(mask) ((guint) _mm256_movemask_pd ((V) (mask)))
#define LOAD _mm256_loadu_pd
#define STORE _mm256_storeu_pd
#define NAME(f) f ## _4
#include "gst/rig/triangulatekernel.inc.c"
#undef LANES
#undef V
#undef M
#undef VECTOR
#undef V_FMA
#undef V_FNMA
#undef V_GREATER
#undef V_CHOOSE
#undef BITS
#undef LOAD
#undef STORE
#undef NAME
#undef TARGET

#define TARGET __attribute__ ((target ("avx512f,avx512bw,avx512dq,avx512vl")))
TARGET INLINE __m512d
same_8 (__m512d a)
{
  return a;
}

#define LANES 8
#define V __m512d
#define M __mmask8
#define VECTOR(x) _Generic ((x), V: same_8, default: _mm512_set1_pd) (x)
#define V_FMA _mm512_fmadd_pd
#define V_FNMA _mm512_fnmadd_pd
#define V_GREATER(a, b) _mm512_cmp_pd_mask (a, b, _CMP_GT_OQ)
#define V_CHOOSE(mask, a, b) _mm512_mask_blend_pd ((M) (mask), b, a)
#define BITS(mask) ((guint) (mask) & 0xff)
#define LOAD _mm512_loadu_pd
#define STORE _mm512_storeu_pd
#define NAME(f) f ## _8
#include "gst/rig/triangulatekernel.inc.c"
#undef TARGET

static const TriangulateKernel fused = { load_1_fma, solve_1_fma };
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
      /* whoever has AVX2 has the fused instructions */
      return cloth_simd_resolve (CLOTH_SIMD_BEST) == CLOTH_SIMD_SCALAR ?
          &scalar : &fused;
  }
#endif
  return &scalar;
}
