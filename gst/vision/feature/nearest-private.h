/* What the search of descriptors shares with its inner loop.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/feature/nearest.h"

G_BEGIN_DECLS

/* Reference descriptors of a block, each in a lane of its own. */
#define CLOTH_NEAREST_LANES 16
/* Groups of 4 bytes of a descriptor: a block has the first group of all its descriptors,
 * then the second, and so on. */
#define CLOTH_NEAREST_GROUPS (CLOTH_NEAREST_BYTES / 4)
#define CLOTH_NEAREST_BLOCK (CLOTH_NEAREST_LANES * CLOTH_NEAREST_BYTES)
/* Queries that are compared with a block at once. */
#define CLOTH_NEAREST_QUERIES 8

/* The two nearest to a query so far. Distances are less by the query's square;
 * %G_MAXINT32 is none. */
typedef struct
{
  gint32 distance, second_distance;
  guint32 index, second;
} ClothNearestPair;

/* @blocks: interleaved reference descriptors
 * @offsets: of each of these |r|² − 256·Σr; %G_MAXINT32 of what fills up the last blocks
 * @begin: first block to look at
 * @end: one past the last; an even number of them
 * @queries: %CLOTH_NEAREST_QUERIES descriptors
 * @pairs: (inout): the nearest of each query up to @begin, then up to @end
 *
 * Compares by |r − q|² − |q|² = |r|² − 256·Σr − 2·Σ r·(q − 128), in which q − 128 is a signed
 * byte, as the processors' products of bytes want it.
 */
typedef struct
{
  void (*scan) (const guint8 * blocks, const gint32 * offsets, guint begin,
      guint end, const guint8 * queries, ClothNearestPair * pairs);
} ClothNearestKernel;

CLOTH_SIMD_TABLES (ClothNearestKernel, cloth_nearest_kernel);
#ifdef __x86_64__
/* AVX-512 with VNNI. */
extern const ClothNearestKernel cloth_nearest_kernel_vnni;
#endif

const ClothNearestKernel *cloth_nearest_find_kernel (ClothSimd level);

G_END_DECLS
