/* Circles that a point of the triangulation lies in, or has left behind.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/math/delaunay-private.h"

#if CLOTH_SIMD_BITS >= 256
#include <immintrin.h>
#endif

#define LANES CLOTH_DELAUNAY_LANES

/* Bit by bit those of LANES circles that count. */
#if CLOTH_SIMD_BITS == 512

static inline guint
look (const gdouble * cx, const gdouble * cy, const gdouble * square,
    gdouble x, gdouble y)
{
  const __m512d dx = _mm512_set1_pd (x) - _mm512_loadu_pd (cx);
  const __m512d dy = _mm512_set1_pd (y) - _mm512_loadu_pd (cy);
  const __m512d s = _mm512_loadu_pd (square), across = dx * dx;

  return (guint) _mm512_cmp_pd_mask (across + dy * dy, s, _CMP_LT_OQ)
      | (guint) (_mm512_cmp_pd_mask (dx, _mm512_setzero_pd (), _CMP_GT_OQ)
      & _mm512_cmp_pd_mask (across, s, _CMP_GT_OQ));
}

#elif CLOTH_SIMD_BITS == 256

static inline guint
look_at_half (const gdouble * cx, const gdouble * cy, const gdouble * square,
    gdouble x, gdouble y)
{
  const __m256d dx = _mm256_set1_pd (x) - _mm256_loadu_pd (cx);
  const __m256d dy = _mm256_set1_pd (y) - _mm256_loadu_pd (cy);
  const __m256d s = _mm256_loadu_pd (square), across = dx * dx;
  const __m256d within = _mm256_cmp_pd (across + dy * dy, s, _CMP_LT_OQ);
  const __m256d left =
      _mm256_and_pd (_mm256_cmp_pd (dx, _mm256_setzero_pd (), _CMP_GT_OQ),
      _mm256_cmp_pd (across, s, _CMP_GT_OQ));

  return (guint) _mm256_movemask_pd (_mm256_or_pd (within, left));
}

static inline guint
look (const gdouble * cx, const gdouble * cy, const gdouble * square,
    gdouble x, gdouble y)
{
  return look_at_half (cx, cy, square, x, y)
      | look_at_half (cx + 4, cy + 4, square + 4, x, y) << 4;
}

#else

static inline guint
look (const gdouble * cx, const gdouble * cy, const gdouble * square,
    gdouble x, gdouble y)
{
  guint found = 0;

  for (guint i = 0; i < LANES; i++) {
    const gdouble dx = x - cx[i], dy = y - cy[i];

    found |= (guint) ((dx * dx + dy * dy < square[i]) | ((dx > 0)
            & (dx * dx > square[i]))) << i;
  }
  return found;
}

#endif

static guint
find (const ClothDelaunayCircles * circles, guint from, guint n, gdouble x,
    gdouble y)
{
  for (; from < n; from += LANES) {
    const guint found = look (circles->x + from, circles->y + from,
        circles->square + from, x, y);

    if (found)
      return from + (guint) __builtin_ctz (found);
  }
  return n;
}

const ClothDelaunayKernel CLOTH_SIMD_NAME (cloth_delaunay_kernel) = { find };
