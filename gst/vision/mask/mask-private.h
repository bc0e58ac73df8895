/* What the silhouette shares with its inner loops.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/mask/mask.h"

G_BEGIN_DECLS

/* What is asked of the windows of a row.
 * @radius: of the windows
 * @shadow: least gain
 * @glow: greatest gain
 * @limits: greatest residual of each column's window
 * @bias: of the film's sums of Cb and Cr */
typedef struct
{
  gint radius;
  gfloat shadow, glow;
  const gfloat *limits;
  gfloat bias[2];
} ClothMaskTest;

/* @add_row: adds the products film², film·ground, ground² of a row to the sums of each
 *   column; with @sign −1 takes them away
 * @test_row: @sums begin @radius columns before the row; @gains: (out): of the background in
 *   each window; @hits: (out): 1 where the window is none of the background
 * @test_chroma: the same of chroma: @sums of Cb of the film, of the ground, of Cr of both,
 *   less 128 a sample; @gains of these windows
 * @median: of @n samples, %CLOTH_MASK_SAMPLES at most, byte by byte; of two middle ones the
 *   lower */
typedef struct
{
  void (*add_row) (const guint8 * film, const guint8 * ground, gint width,
      gint32 sign, gint32 * const sums[3]);
  void (*test_row) (const ClothMaskTest * test, gint32 * const sums[3],
      gint width, gfloat * gains, guint8 * hits);
  void (*test_chroma) (const ClothMaskTest * test, gint32 * const sums[4],
      gint width, const gfloat * gains, guint8 * hits);
  void (*median) (guint8 * const *samples, guint n, gsize size, guint8 * to);
} ClothMaskKernels;

CLOTH_SIMD_TABLES (ClothMaskKernels, cloth_mask_kernels);

G_END_DECLS
