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

/* @run: fills words [word, word + words) of every row of @mask; NULL: there is only the
 *   reference. @scratch: aligned to 64 bytes, as many as mask_run_tiles () counts. */
typedef struct {
  void (*run) (ClothSaddleMask * mask, const ClothSaddleKernel * kernel,
      const ClothImage * image, gint threshold, gint word, gint words,
      guint8 * scratch);
} ClothSaddleTile;

CLOTH_SIMD_TABLES (ClothSaddleTile, cloth_saddle_tile);

G_END_DECLS
