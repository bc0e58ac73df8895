/* What is tested: normal equations of a residual, and what is fitted along in each test.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/estimate/estimate.h"

G_BEGIN_DECLS

/* @normal: the normal equations, over the blocks of all takes
 * @candidates: what the columns mean: column i is direction i
 * @blocks: (array): which blocks count
 * @nuisances: (array length=n_nuisances): columns that are fitted along
 * @precisions: (array length=n_nuisances): of their priors
 * @n_nuisances: how many
 * @n_numbers: the first so many of them are numbers of the model; the others stand for
 *   variability
 * @overdispersion: see #ClothEstimateOptions
 * @block_s: length of a block, s
 * @sound: (array): columns that could be simulated
 */
typedef struct {
  ClothNormalEquations *normal;
  const ClothCandidates *candidates;
  const gboolean *blocks;
  const guint *nuisances;
  const gdouble *precisions;
  guint n_nuisances;
  guint n_numbers;
  gdouble overdispersion;
  gdouble block_s;
  const gboolean *sound;
} ClothGapTest;

gboolean cloth_gap_test_reduce (const ClothGapTest * test,
    const ClothNormalEquations * normal, const gboolean * blocks,
    const guint * directions, guint n, ClothReducedEquations * reduced);
gdouble cloth_gap_dispersion (gdouble overdispersion, gdouble r,
    gdouble n_features);
gdouble cloth_gap_test_dispersion (const ClothGapTest * test,
    const ClothNormalEquations * normal, const ClothReducedEquations * reduced);

G_END_DECLS
