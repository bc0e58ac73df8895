/* The nearest of many descriptors, found by comparing them all.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/pool.h"
#include "gst/math/simd.h"

G_BEGIN_DECLS

/* Bytes of a descriptor: those of SIFT. */
#define CLOTH_NEAREST_BYTES 128

/* Index of a neighbour that there is not, and its distance. */
#define CLOTH_NEAREST_NONE G_MAXUINT32

/* @index: the nearest reference descriptor, of equal ones the first
 * @second: the nearest but @index, of equal ones the first
 * @distance: squared Euclidean distance to the nearest
 * @second_distance: to the second
 */
typedef struct {
  guint32 index, second;
  guint32 distance, second_distance;
} ClothNeighbours;

typedef struct _ClothNearest ClothNearest;

ClothNearest *cloth_nearest_new (const guint8 * descriptors, guint n);
void cloth_nearest_free (ClothNearest * nearest);
void cloth_nearest_run (const ClothNearest * nearest, const guint8 * queries,
    guint n, ClothNeighbours * found, ClothPool * pool, ClothSimd level);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothNearest, cloth_nearest_free)
G_END_DECLS
