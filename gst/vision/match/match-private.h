/* What growth shares with its inner loop.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/simd.h"

G_BEGIN_DECLS

/* Bytes of a descriptor. */
#define CLOTH_MATCH_BYTES 128

/* @x: (array): columns of the candidates, px
 * @y: (array): rows, px
 * @scale: (array): blur, px
 * @seen: (array): angles, radians
 * @descriptors: (array): %CLOTH_MATCH_BYTES each
 * @centre: of the ring
 * @least: squared inner radius
 * @most: squared outer radius
 * @low: least scale
 * @high: greatest scale
 * @turn: angle that is looked for
 * @turn_range: by how much it may differ
 * @query: descriptor that is looked for
 */
typedef struct {
  const gfloat *x, *y, *scale, *seen;
  const guint8 *descriptors;
  gfloat centre[2], least, most, low, high, turn, turn_range;
  const guint8 *query;
} ClothMatchRing;

/* @search: looks at the candidates from @begin to @end; @index and @distance (inout) are the
 *   nearest so far and its squared distance, of equal ones the first
 */
typedef struct {
  void (*search) (const ClothMatchRing * ring, guint begin, guint end,
      guint32 * index, guint32 * distance);
} ClothMatchKernel;

CLOTH_SIMD_TABLES (ClothMatchKernel, cloth_match_kernel);

G_END_DECLS
