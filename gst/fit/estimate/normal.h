/* The linear part of the diagnosis: residual features and their derivatives, block by
 * block, as normal equations.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/features/features.h"

G_BEGIN_DECLS

/**
 * ClothGapPower:
 * @n: number of classes: bands of frequency, of waves, and axes
 * @values: mean square of the features of a class
 *
 * Since: 0.1
 */
typedef struct {
  guint n;
  gdouble *values;
} ClothGapPower;

/**
 * ClothGapNormal:
 * @m: number of columns
 * @n_blocks: number of blocks of time
 * @per_block: features of a block
 * @g: BᵀWB, [n_blocks][m][m]
 * @s: BᵀWz, [n_blocks][m]
 * @r: zᵀWz, [n_blocks]
 *
 * Since: 0.1
 */
typedef struct {
  guint m;
  guint n_blocks;
  gdouble per_block;
  gdouble *g;
  gdouble *s;
  gdouble *r;
} ClothGapNormal;

/**
 * ClothGapReduced:
 * @n: number of directions
 * @g: their normal matrix with the nuisances projected out, n·n
 * @s: their score
 * @kept: share of each direction's square that the projection kept
 * @r: square of the residual with the nuisances fitted
 *
 * Since: 0.1
 */
typedef struct {
  guint n;
  gdouble g[16];
  gdouble s[4];
  gdouble kept[4];
  gdouble r;
} ClothGapReduced;

ClothGapPower *cloth_gap_power_new (const ClothGapFeatures * features,
    const gdouble * z);
ClothGapPower *cloth_gap_power_copy (const ClothGapPower * power);
void cloth_gap_power_free (ClothGapPower * power);
ClothGapNormal *cloth_gap_normal_new (const ClothGapFeatures * features,
    const ClothGapPower * mismatch, gdouble share, const gdouble * z,
    const gdouble * columns, guint m);
ClothGapNormal *cloth_gap_normal_append (ClothGapNormal * to,
    ClothGapNormal * from);
void cloth_gap_normal_free (ClothGapNormal * normal);
gboolean cloth_gap_normal_reduce (const ClothGapNormal * normal,
    const gboolean * blocks, const guint * nuisances,
    const gdouble * precisions, guint n_nuisances, const guint * directions,
    guint n, ClothGapReduced * reduced);
gdouble cloth_gap_normal_project (const ClothGapNormal * normal,
    const gboolean * blocks, guint m, const gdouble * precisions, gdouble * g,
    gdouble * s);
gdouble cloth_gap_normal_change (const ClothGapNormal * normal, guint block,
    const guint * directions, const gdouble * changes, guint n);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothGapPower, cloth_gap_power_free)
G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothGapNormal, cloth_gap_normal_free)
G_END_DECLS
