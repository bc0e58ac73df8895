/* The derivatives of the smoothed picture at one place.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/corner/saddle-derivatives.h"

#include <string.h>

#if CLOTH_SIMD_BITS >= 256
#include <immintrin.h>
#endif

#define TAPS CLOTH_SADDLE_TAPS

typedef gfloat v8f __attribute__((vector_size (32)));
typedef gfloat v4f __attribute__((vector_size (16)));

#define INLINE static inline __attribute__((always_inline))

/* Smoothed derivatives: out = Fx, Fy, Fxx, Fxy, Fyy. */
INLINE void
weigh (const ClothSaddleTaps * rows, const ClothSaddleTaps * gx,
    const ClothSaddleTaps * gy, gfloat * out)
{
  ClothSaddleTaps a0 = { 0 }, a1 = { 0 }, a2 = { 0 };
  ClothSaddleTaps p[5];

#pragma GCC unroll 15
  for (gint j = 0; j < TAPS - 1; j++) {
    a0 += rows[j] * gy[0][j];
    a1 += rows[j] * gy[1][j];
    a2 += rows[j] * gy[2][j];
  }
  p[0] = a0 * gx[1];
  p[1] = a1 * gx[0];
  p[2] = a0 * gx[2];
  p[3] = a1 * gx[1];
  p[4] = a2 * gx[0];
  for (gint k = 0; k < 5; k++) {
    v8f half[2], s;
    v4f quarter[2], t;

    memcpy (half, &p[k], sizeof (half));
    s = half[0] + half[1];
    memcpy (quarter, &s, sizeof (quarter));
    t = quarter[0] + quarter[1];
    out[k] = (t[0] + t[2]) + (t[1] + t[3]);
  }
}

INLINE void
load (const guint8 * data, ClothSaddleTaps * row)
{
#if CLOTH_SIMD_BITS == 512
  *row = (ClothSaddleTaps) _mm512_cvtepi32_ps (_mm512_cvtepu8_epi32
      (_mm_loadu_si128 ((const __m128i *) data)));
#elif CLOTH_SIMD_BITS == 256
  const __m128i bytes = _mm_loadu_si128 ((const __m128i *) data);
  const __m256 half[2] = {
    _mm256_cvtepi32_ps (_mm256_cvtepu8_epi32 (bytes)),
    _mm256_cvtepi32_ps (_mm256_cvtepu8_epi32 (_mm_srli_si128 (bytes, 8)))
  };

  memcpy (row, half, sizeof half);
#else
  for (gint i = 0; i < TAPS; i++)
    (*row)[i] = data[i];
#endif
}

static void
derivatives (const guint8 * data, gsize stride, const ClothSaddleTaps * gx,
    const ClothSaddleTaps * gy, gfloat out[5])
{
  ClothSaddleTaps rows[TAPS - 1];

  for (gint j = 0; j < TAPS - 1; j++)
    load (data + (gsize) j * stride, &rows[j]);
  weigh (rows, gx, gy, out);
}

const ClothSaddleDerivatives CLOTH_SIMD_NAME (cloth_saddle_derivatives) = {
  derivatives
};
