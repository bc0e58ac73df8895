/* The loops over the rows of lines and quadrilaterals, for each instruction set.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/render/draw-private.h"

#include <math.h>
#include <string.h>

#define CHUNK CLOTH_DRAW_CHUNK

typedef guint8 U8 __attribute__((vector_size (CHUNK)));
typedef guint16 U16 __attribute__((vector_size (2 * CHUNK)));

#define INLINE static inline __attribute__((always_inline))

/* First and last sample of [low, high] pixels, kept inside the grid; safe for any
 * finite numbers. */
INLINE void
clip_range (gfloat low, gfloat high, gfloat offset, gfloat per_sample,
    gint size, gint * first, gint * last)
{
  gfloat a = (low - offset) * per_sample, b = (high - offset) * per_sample;

  a = CLAMP (a, 0.0f, (gfloat) size);
  b = CLAMP (b, -1.0f, (gfloat) (size - 1));
  /* ceil and floor, which plain SSE2 lacks; adding 1 keeps floor from below zero */
  *first = (gint) a + ((gfloat) (gint) a < a);
  *last = (gint) (b + 1) - 1;
}

#define NAME(f) f ## _plain
#include "gst/render/draw-rows.inc.c"
#undef NAME

#if defined (__x86_64__) && defined (__GNUC__)
#pragma GCC push_options
#pragma GCC target ("avx2")
#define NAME(f) f ## _avx2
#include "gst/render/draw-rows.inc.c"
#undef NAME
#pragma GCC pop_options
#endif

const ClothDrawRows *
cloth_draw_rows (ClothSimd simd)
{
  static const ClothDrawRows plain = { line_plain, quad_plain };
#if defined (__x86_64__) && defined (__GNUC__)
  static const ClothDrawRows avx2 = { line_avx2, quad_avx2 };

  if (cloth_simd_resolve (simd) >= CLOTH_SIMD_AVX2)
    return &avx2;
#endif
  return &plain;
}
