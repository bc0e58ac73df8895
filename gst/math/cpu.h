/* Which vector instructions the running processor offers.
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
 * Instruction sets a kernel can be asked to run with. A kernel that lacks the one
 * asked for takes the next lower one.
 */
typedef enum {
  CLOTH_SIMD_SCALAR,
  CLOTH_SIMD_AVX2,
  CLOTH_SIMD_AVX512,
  CLOTH_SIMD_BEST = 0xff
} ClothSimd;

ClothSimd cloth_simd_resolve (ClothSimd wanted);

G_END_DECLS
