/* Which effect: the score test of each candidate, nuisances projected out.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/estimate/sensitivities.h"

G_BEGIN_DECLS

/* @candidate: index of the candidate
 * @evidence: mean over the gains of the logarithm of the Bayes factor for it
 * @improvement: share of the residual's square that it removes from blocks of time that
 *   it was not estimated on
 * @changes: expected changes of its directions; of gusts their intensity and azimuth
 * @sigmas: their standard deviations
 * @p_value: of no effect
 * @constancy_p_value: of the same effect in every block
 * @kept: share of its derivative that no number of the model can make up for
 */
typedef struct {
  guint candidate;
  gdouble evidence;
  gdouble improvement;
  gdouble changes[4];
  gdouble sigmas[4];
  gdouble p_value;
  gdouble constancy_p_value;
  gdouble kept;
} ClothGapScore;

/* @normals: of each gain, over the blocks of all takes
 * @candidates: what the columns mean: column i is direction i
 * @blocks: (array): which blocks count
 * @nuisances: (array length=n_nuisances): columns that are fitted along
 * @precisions: (array length=n_nuisances): of their priors
 * @n_nuisances: how many
 * @n_numbers: the first so many of them are numbers of the model; the others stand for
 *   variability
 * @overdispersion: see #ClothEstimateOptions
 * @block_s: length of a block, s
 * @gusts: first column of the wind in the parts of a block, x and y of each; 0: there are
 *   none
 * @sound: (array): columns that could be simulated
 */
typedef struct {
  ClothNormalEquations *normals[CLOTH_ESTIMATE_N_GAINS];
  const ClothCandidates *candidates;
  const gboolean *blocks;
  const guint *nuisances;
  const gdouble *precisions;
  guint n_nuisances;
  guint n_numbers;
  gdouble overdispersion;
  gdouble block_s;
  guint gusts;
  const gboolean *sound;
} ClothGapTest;

/* Below this share left by the nuisances an effect can't be told from them. */
#define CLOTH_GAP_IDENTIFIABLE 0.05

gint cloth_gap_score_compare (gconstpointer a, gconstpointer b);
gboolean cloth_gap_test_reduce (const ClothGapTest * test,
    const ClothNormalEquations * normal, const gboolean * blocks,
    const guint * directions, guint n, ClothReducedEquations * reduced);
gdouble cloth_gap_test_dispersion (const ClothGapTest * test,
    const ClothNormalEquations * normal, const ClothReducedEquations * reduced);
gdouble cloth_gap_test_improvement (const ClothGapTest * test,
    guint candidate, const ClothNormalEquations * without,
    const ClothNormalEquations * with, const guint * directions, const gdouble * at,
    gdouble phi);
GArray *cloth_gap_test_run (const ClothGapTest * test);
gdouble cloth_gap_test_cosine (const ClothGapTest * test, guint one,
    guint other);

G_END_DECLS
