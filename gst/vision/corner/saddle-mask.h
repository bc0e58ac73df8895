/* The hyperbolic pixels of a picture as a bit mask: the inner loop of the detector.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/simd.h"
#include "gst/vision/image.h"

G_BEGIN_DECLS

/* Widest half filter: sigma 5 rounds to nothing beyond 13 taps each side. */
#define CLOTH_SADDLE_MAX_RADIUS 14
#define CLOTH_SADDLE_MAX_STEP 3

/* @radius: taps on each side of the middle one
 * @step: distance h of the finite differences, px
 * @across: 2·@radius + 1 weights of the pass along rows, then a zero; their sum is 256
 *   or 128, and no even-odd pair exceeds 128, so that 255·pair fits 16 bits
 * @down: weights of the pass along columns: [0] the middle one, [k] both rows at
 *   distance k, in 1/65536
 * @scale: Det of the Hessian in grey levels² / px⁴ for one unit of the 16-bit
 *   determinant
 *
 * The smoothing filter in the fixed point all levels share. With g the grey level, S the
 * smoothed picture in units of 1/s grey level: A = 4s·h²Fxx, B = 4s·h²Fyy,
 * C = 4s·h²Fxy are exact in 16 bits, since s is chosen from the filter's own bounds; the
 * determinant is (AB >> 16) − (C² >> 16).
 */
typedef struct {
  gint radius;
  gint step;
  gint8 across[2 * CLOTH_SADDLE_MAX_RADIUS + 2];
  guint16 down[CLOTH_SADDLE_MAX_RADIUS + 1];
  gfloat scale;
} ClothSaddleKernel;

/* @x: column of the region in the picture
 * @y: row of the region in the picture
 * @width: columns of the region
 * @height: rows of the region
 * @words: 64-pixel words a row
 * @bits: @height·@words, bit i of word w is column @x + 64w + i
 * @blocks: for each word of two rows, even and odd, where in @det their blocks are,
 *   unless none of their bits is set; (@height + 1) / 2·@words
 * @det: blocks of 64 16-bit determinants, the even columns of a word, then the odd; see
 *   cloth_saddle_mask_det()
 *
 * Buffers grow when they must and are kept from picture to picture.
 */
typedef struct {
  gint x, y, width, height;
  gint words;
  guint64 *bits;
  guint32 *blocks;
  gint16 *det;
  guint32 n_blocks;
  gsize bits_allocated;
  guint8 *scratch;
  gsize scratch_allocated;
} ClothSaddleMask;

/* The determinants of word w of row y of the region; valid if one of its bits is set. */
static inline const gint16 *
cloth_saddle_mask_block (const ClothSaddleMask * mask, gint w, gint y)
{
  return mask->det + 64 * ((gsize) mask->blocks[(gsize) (y >> 1) *
          (gsize) mask->words + (gsize) w] + (gsize) (y & 1));
}

/* Bit i's determinant in its block. */
static inline gint
cloth_saddle_block_det (const gint16 * block, gint i)
{
  return block[32 * (i & 1) + (i >> 1)];
}

/* The determinant at column x, row y of the region, where its bit is set. */
static inline gint
cloth_saddle_mask_det (const ClothSaddleMask * mask, gint x, gint y)
{
  return cloth_saddle_block_det (cloth_saddle_mask_block (mask, x >> 6, y),
      x & 63);
}

void cloth_saddle_kernel_init (ClothSaddleKernel * kernel, gfloat sigma);
void cloth_saddle_mask_run (ClothSaddleMask * mask,
    const ClothSaddleKernel * kernel, const ClothImage * image,
    gint threshold, ClothSimd level);
void cloth_saddle_mask_clear (ClothSaddleMask * mask);

G_END_DECLS
