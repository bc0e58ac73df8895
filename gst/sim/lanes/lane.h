/* A lane is a model: numbers of several models side by side in one vector.
 *
 * This header and all that includes it is compiled once for each kind of number and
 * instruction set, with CLOTH_SIM_LANES (4: float, 8: double, 1: one double),
 * CLOTH_LANE_BYTES (size of a vector) and CLOTH_LANE_SUFFIX (of its global names) given
 * on the command line. Plain operators do the arithmetic; here is what C has no operator
 * for. The same source text without fused or reordered arithmetic gives every lane the
 * same bits in each of them; so nothing here may ever mix lanes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>
#include <math.h>
#include <string.h>

#if defined (__SSE2__)
#include <immintrin.h>
#endif

#ifndef CLOTH_SIM_LANES
#error This is compiled with the lanes: see gst/sim/meson.build
#endif

#define CLOTH_LANE_PASTE_(a, b) a ## _ ## b
#define CLOTH_LANE_PASTE(a, b) CLOTH_LANE_PASTE_ (a, b)
/* The name of a global symbol of this variant. */
#define CLOTH_LANE_NAME(name) CLOTH_LANE_PASTE (name, CLOTH_LANE_SUFFIX)
#define CLOTH_LANE_INLINE static inline __attribute__((always_inline))

/* ClothReal: one number. ClothLane: one for each lane. ClothMask: a truth for each
 * lane, all bits set or none. */
#if CLOTH_SIM_LANES == 4
typedef gfloat ClothReal;
typedef gint32 ClothBits;
#else
typedef gdouble ClothReal;
typedef gint64 ClothBits;
#endif

#if CLOTH_SIM_LANES == 1
#define CLOTH_N_LANES 1
typedef ClothReal ClothLane;
typedef ClothBits ClothMask;
/* The number of lane l of *p. */
#define CLOTH_LANE_AT(p, l) (*(p))
#define cloth_lane_less(a, b) ((ClothMask) - ((a) < (b)))
#define cloth_lane_equal(a, b) ((ClothMask) - ((a) == (b)))
#else
#define CLOTH_N_LANES (CLOTH_LANE_BYTES / CLOTH_SIM_LANES)
typedef ClothReal ClothLane __attribute__((vector_size (CLOTH_LANE_BYTES)));
typedef ClothBits ClothMask __attribute__((vector_size (CLOTH_LANE_BYTES)));
#define CLOTH_LANE_AT(p, l) ((*(p))[l])
/* Where a < b; not where one of them is NaN. */
#define cloth_lane_less(a, b) ((ClothMask) ((a) < (b)))
#define cloth_lane_equal(a, b) ((ClothMask) ((a) == (b)))
#endif

/* The same number in every lane. */
CLOTH_LANE_INLINE ClothLane
cloth_lane_set (gdouble value)
{
  return (ClothLane) {
  0} +(ClothReal) value;
}

/* a where the mask is set, else b. */
CLOTH_LANE_INLINE ClothLane
cloth_lane_select (ClothMask mask, ClothLane a, ClothLane b)
{
#if CLOTH_SIM_LANES == 1
  return mask ? a : b;
#else
  return (ClothLane) ((mask & (ClothMask) a) | (~mask & (ClothMask) b));
#endif
}

/* a > b ? a : b: b when one of them is NaN. */
CLOTH_LANE_INLINE ClothLane
cloth_lane_max (ClothLane a, ClothLane b)
{
#if CLOTH_SIM_LANES == 1
  return a > b ? a : b;
#elif defined (__AVX512F__) && CLOTH_LANE_BYTES == 64 && CLOTH_SIM_LANES == 4
  return (ClothLane) _mm512_max_ps ((__m512) a, (__m512) b);
#elif defined (__AVX512F__) && CLOTH_LANE_BYTES == 64
  return (ClothLane) _mm512_max_pd ((__m512d) a, (__m512d) b);
#elif defined (__AVX__) && CLOTH_LANE_BYTES == 32 && CLOTH_SIM_LANES == 4
  return (ClothLane) _mm256_max_ps ((__m256) a, (__m256) b);
#elif defined (__AVX__) && CLOTH_LANE_BYTES == 32
  return (ClothLane) _mm256_max_pd ((__m256d) a, (__m256d) b);
#elif defined (__SSE2__) && CLOTH_LANE_BYTES == 16 && CLOTH_SIM_LANES == 4
  return (ClothLane) _mm_max_ps ((__m128) a, (__m128) b);
#elif defined (__SSE2__) && CLOTH_LANE_BYTES == 16
  return (ClothLane) _mm_max_pd ((__m128d) a, (__m128d) b);
#else
  return cloth_lane_select (cloth_lane_less (b, a), a, b);
#endif
}

/* a < b ? a : b: b when one of them is NaN. */
CLOTH_LANE_INLINE ClothLane
cloth_lane_min (ClothLane a, ClothLane b)
{
#if CLOTH_SIM_LANES == 1
  return a < b ? a : b;
#elif defined (__AVX512F__) && CLOTH_LANE_BYTES == 64 && CLOTH_SIM_LANES == 4
  return (ClothLane) _mm512_min_ps ((__m512) a, (__m512) b);
#elif defined (__AVX512F__) && CLOTH_LANE_BYTES == 64
  return (ClothLane) _mm512_min_pd ((__m512d) a, (__m512d) b);
#elif defined (__AVX__) && CLOTH_LANE_BYTES == 32 && CLOTH_SIM_LANES == 4
  return (ClothLane) _mm256_min_ps ((__m256) a, (__m256) b);
#elif defined (__AVX__) && CLOTH_LANE_BYTES == 32
  return (ClothLane) _mm256_min_pd ((__m256d) a, (__m256d) b);
#elif defined (__SSE2__) && CLOTH_LANE_BYTES == 16 && CLOTH_SIM_LANES == 4
  return (ClothLane) _mm_min_ps ((__m128) a, (__m128) b);
#elif defined (__SSE2__) && CLOTH_LANE_BYTES == 16
  return (ClothLane) _mm_min_pd ((__m128d) a, (__m128d) b);
#else
  return cloth_lane_select (cloth_lane_less (a, b), a, b);
#endif
}

/* Correctly rounded, so the same everywhere. */
CLOTH_LANE_INLINE ClothLane
cloth_lane_sqrt (ClothLane a)
{
#if CLOTH_SIM_LANES == 1
  return sqrt (a);
#elif defined (__AVX512F__) && CLOTH_LANE_BYTES == 64 && CLOTH_SIM_LANES == 4
  return (ClothLane) _mm512_sqrt_ps ((__m512) a);
#elif defined (__AVX512F__) && CLOTH_LANE_BYTES == 64
  return (ClothLane) _mm512_sqrt_pd ((__m512d) a);
#elif defined (__AVX__) && CLOTH_LANE_BYTES == 32 && CLOTH_SIM_LANES == 4
  return (ClothLane) _mm256_sqrt_ps ((__m256) a);
#elif defined (__AVX__) && CLOTH_LANE_BYTES == 32
  return (ClothLane) _mm256_sqrt_pd ((__m256d) a);
#elif defined (__SSE2__) && CLOTH_LANE_BYTES == 16 && CLOTH_SIM_LANES == 4
  return (ClothLane) _mm_sqrt_ps ((__m128) a);
#elif defined (__SSE2__) && CLOTH_LANE_BYTES == 16
  return (ClothLane) _mm_sqrt_pd ((__m128d) a);
#else
  for (guint l = 0; l < CLOTH_N_LANES; l++)
    a[l] = (ClothReal) sqrt (a[l]);
  return a;
#endif
}

CLOTH_LANE_INLINE ClothLane
cloth_lane_abs (ClothLane a)
{
#if CLOTH_SIM_LANES == 1
  return fabs (a);
#elif CLOTH_SIM_LANES == 4
  return (ClothLane) ((ClothMask) a & G_MAXINT32);
#else
  return (ClothLane) ((ClothMask) a & G_MAXINT64);
#endif
}

/* Whether any lane of the mask is set: for skipping work that changes nothing. */
CLOTH_LANE_INLINE gboolean
cloth_lane_any (ClothMask mask)
{
#if CLOTH_SIM_LANES == 1
  return mask != 0;
#else
  ClothBits any = 0;

  for (guint l = 0; l < CLOTH_N_LANES; l++)
    any |= mask[l];
  return any != 0;
#endif
}

CLOTH_LANE_INLINE ClothLane
cloth_lane_dot (const ClothLane a[3], const ClothLane b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

CLOTH_LANE_INLINE void
cloth_lane_subtract (const ClothLane a[3], const ClothLane b[3],
    ClothLane difference[3])
{
  for (guint k = 0; k < 3; k++)
    difference[k] = a[k] - b[k];
}

CLOTH_LANE_INLINE void
cloth_lane_cross (const ClothLane a[3], const ClothLane b[3],
    ClothLane cross[3])
{
  cross[0] = a[1] * b[2] - a[2] * b[1];
  cross[1] = a[2] * b[0] - a[0] * b[2];
  cross[2] = a[0] * b[1] - a[1] * b[0];
}

/* b = S a with S symmetric: xx, yy, zz, yz, xz, xy. */
CLOTH_LANE_INLINE void
cloth_lane_symmetric (const ClothLane s[6], const ClothLane a[3],
    ClothLane b[3])
{
  b[0] = s[0] * a[0] + s[5] * a[1] + s[4] * a[2];
  b[1] = s[5] * a[0] + s[1] * a[1] + s[3] * a[2];
  b[2] = s[4] * a[0] + s[3] * a[1] + s[2] * a[2];
}
