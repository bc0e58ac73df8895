/* The loops over the rows of a surface, for each instruction set.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/render/surface-private.h"

#include <string.h>

#define PLACE CLOTH_SURFACE_PLACE_BITS

typedef guint8 U8x4 __attribute__((vector_size (4)));
typedef guint8 U8x8 __attribute__((vector_size (8)));
typedef guint16 U16x4 __attribute__((vector_size (8)));
typedef guint16 U16x8 __attribute__((vector_size (16)));

#define NAME(f) f ## _plain
#include "gst/render/surface-rows.inc.c"
#undef NAME

#if defined (__x86_64__) && defined (__GNUC__)
#pragma GCC push_options
#pragma GCC target ("avx2")
#define NAME(f) f ## _avx2
#include "gst/render/surface-rows.inc.c"
#undef NAME
#pragma GCC pop_options
#endif

const ClothSurfaceRows *
cloth_surface_rows (ClothSimd simd)
{
  static const ClothSurfaceRows plain = { fill_plain, lay_plain,
    lay_half_plain
  };
#if defined (__x86_64__) && defined (__GNUC__)
  static const ClothSurfaceRows avx2 = { fill_avx2, lay_avx2, lay_half_avx2 };

  if (cloth_simd_resolve (simd) >= CLOTH_SIMD_AVX2)
    return &avx2;
#endif
  return &plain;
}
