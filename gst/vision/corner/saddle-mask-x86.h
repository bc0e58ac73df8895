/* The hyperbolic mask by AVX2 and AVX-512.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/corner/saddle-mask.h"

G_BEGIN_DECLS

/* Columns computed on either side of a tile; even, and no less than the longest step. */
#define CLOTH_SADDLE_TILE_MARGIN 4
/* Even (or odd) columns of a tile with its margins, in whole vectors of 32. */
#define CLOTH_SADDLE_TILE_LANES(words) (32 * (words) + 32)
/* From row to row in 16 bits; an odd number of cache lines, so that rows don't contend
 * for the same ones. */
#define CLOTH_SADDLE_TILE_ROW(words) \
  ((gsize) (2 * CLOTH_SADDLE_TILE_LANES (words) + 32))
/* Bytes of a row of the picture for a tile, with what the widest filter reaches. */
#define CLOTH_SADDLE_TILE_LINE(words) ((gsize) (64 * (words) + 192))

/* @scratch: aligned to 64 bytes, cloth_saddle_tile_size() of them. Words [word,
 * word + words) of every row of @mask are filled. */
void cloth_saddle_mask_tile_avx2 (ClothSaddleMask * mask,
    const ClothSaddleKernel * kernel, const ClothImage * image,
    gint threshold, gint word, gint words, guint8 * scratch);
void cloth_saddle_mask_tile_avx512 (ClothSaddleMask * mask,
    const ClothSaddleKernel * kernel, const ClothImage * image,
    gint threshold, gint word, gint words, guint8 * scratch);

G_END_DECLS
