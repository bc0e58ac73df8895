/* Features of a residual and their derivatives as normal equations, block by block.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/effect/effect.h"
#include "gst/fit/features/features.h"

G_BEGIN_DECLS

/* @n: number of classes: bands of frequency, of waves, and axes
 * @values: mean square of the features of a class
 */
typedef struct {
  guint n;
  gdouble *values;
} ClothPowerSpectrum;

/* @m: number of columns
 * @n_blocks: number of blocks of time
 * @per_block: features of a block
 * @g: BᵀWB, [n_blocks][m][m]
 * @s: BᵀWz, [n_blocks][m]
 * @r: zᵀWz, [n_blocks]
 */
typedef struct {
  guint m;
  guint n_blocks;
  gdouble per_block;
  gdouble *g;
  gdouble *s;
  gdouble *r;
} ClothNormalEquations;

/* @n: number of directions
 * @g: their normal matrix with the nuisances projected out, n·n
 * @s: their score
 * @kept: share of each direction's square that the projection kept
 * @r: zᵀWz with the nuisances fitted
 */
typedef struct {
  guint n;
  gdouble g[CLOTH_EFFECT_MAX_PARAMETERS * CLOTH_EFFECT_MAX_PARAMETERS];
  gdouble s[CLOTH_EFFECT_MAX_PARAMETERS];
  gdouble kept[CLOTH_EFFECT_MAX_PARAMETERS];
  gdouble r;
} ClothReducedEquations;

guint *cloth_features_list_classes (const ClothFeatures * features,
    guint * n_classes);
ClothPowerSpectrum *cloth_power_spectrum_new (const ClothFeatures * features,
    const gdouble * z);
ClothPowerSpectrum *cloth_power_spectrum_copy (const ClothPowerSpectrum * power);
void cloth_power_spectrum_get_weights (const ClothPowerSpectrum * power,
    const ClothFeatures * features, gdouble * weights);
void cloth_power_spectrum_free (ClothPowerSpectrum * power);
ClothNormalEquations *cloth_normal_equations_new (const ClothFeatures * features,
    const ClothPowerSpectrum * discrepancy, const gdouble * z,
    const gdouble * columns, guint m);
ClothNormalEquations *cloth_normal_equations_append (ClothNormalEquations * to,
    ClothNormalEquations * from);
void cloth_normal_equations_free (ClothNormalEquations * normal);
gdouble cloth_normal_equations_sum (const ClothNormalEquations * normal,
    const gboolean * blocks, const guint * columns, guint n, gdouble * g,
    gdouble * s);
gboolean cloth_normal_equations_reduce (const ClothNormalEquations * normal,
    const gboolean * blocks, const guint * nuisances,
    const gdouble * precisions, guint n_nuisances, const guint * directions,
    guint n, ClothReducedEquations * reduced);
gdouble cloth_normal_equations_project (const ClothNormalEquations * normal,
    const gboolean * blocks, guint m, const gdouble * precisions, gdouble * g,
    gdouble * s);
gdouble cloth_normal_equations_change (const ClothNormalEquations * normal, guint block,
    const guint * directions, const gdouble * changes, guint n);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothPowerSpectrum, cloth_power_spectrum_free)
G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothNormalEquations, cloth_normal_equations_free)
G_END_DECLS
