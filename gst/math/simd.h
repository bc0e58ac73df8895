/* Vector instructions: which ones the running processor has, and how inner loops are
 * compiled for each of them.
 *
 * An inner loop that is worth it lies in a source of its own, a kernel, which is named
 * among the kernels of its room's meson.build and compiled once for every level. It is
 * plain C; where it needs the instructions themselves it asks for CLOTH_SIMD_BITS, the width
 * of its level's vectors: 0, 256 or 512. (What the compiler may use, __AVX2__ and the like,
 * depends on the flags of who builds.) At its end is a table of its functions:
 *
 *   const ClothDrawRows CLOTH_SIMD_NAME (cloth_draw_rows) = { line, quad };
 *
 * Its header declares the tables of all levels:
 *
 *   CLOTH_SIMD_TABLES (ClothDrawRows, cloth_draw_rows);
 *
 * Who calls the kernel takes the table of a level:
 *
 *   const ClothDrawRows *rows = CLOTH_SIMD_TABLE (cloth_draw_rows, CLOTH_SIMD_BEST);
 *
 * Every level gives the same bits. A kernel therefore adds in an order that doesn't depend
 * on the width of a vector, and fuses a product with a sum only by fma () and its
 * like. The compiler fuses nothing (-ffp-contract=off).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* @CLOTH_SIMD_SCALAR: portable C, the reference every kernel is tested against
 * @CLOTH_SIMD_AVX2: AVX2 and FMA
 * @CLOTH_SIMD_AVX512: AVX-512 F, BW, DQ and VL, and BMI2
 * @CLOTH_SIMD_BEST: whatever the running processor offers
 *
 * Instruction sets a kernel can be asked to run with.
 */
typedef enum {
  CLOTH_SIMD_SCALAR,
  CLOTH_SIMD_AVX2,
  CLOTH_SIMD_AVX512,
  CLOTH_SIMD_BEST = 0xff
} ClothSimd;

gboolean cloth_simd_from_string (const gchar * text, ClothSimd * level);
ClothSimd cloth_simd_resolve (ClothSimd wanted);

/* In a kernel: the name that something has at the level that is being compiled. */
#define CLOTH_SIMD_NAME(name) CLOTH_SIMD_JOIN (name, CLOTH_SIMD_LEVEL)
#define CLOTH_SIMD_JOIN(name, level) CLOTH_SIMD_JOIN_ (name, level)
#define CLOTH_SIMD_JOIN_(name, level) name ## _ ## level

/* Declares the tables of all levels. CLOTH_SIMD_TABLE: that of the highest level that is
 * not above @wanted and that the processor has. */
#ifdef __x86_64__
#define CLOTH_SIMD_TABLES(type, name) \
  extern const type name ## _scalar, name ## _avx2, name ## _avx512
#define CLOTH_SIMD_TABLE(name, wanted) \
  ((const __typeof__ (name ## _scalar) *const[]) { \
      &name ## _scalar, &name ## _avx2, &name ## _avx512 \
  }[cloth_simd_resolve (wanted)])
#else
#define CLOTH_SIMD_TABLES(type, name) extern const type name ## _scalar
#define CLOTH_SIMD_TABLE(name, wanted) ((void) (wanted), &name ## _scalar)
#endif

G_END_DECLS
