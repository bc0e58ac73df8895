/* Which effect: the score test of each candidate, nuisances projected out.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/camera/test.h"

G_BEGIN_DECLS

/* @candidate: index of the candidate
 * @log_bayes_factor: logarithm of the Bayes factor for it
 * @improvement: share of the residual's square that it removes from blocks of time that
 *   it was not estimated on
 * @changes: expected changes of its directions
 * @sigmas: their standard deviations
 * @p_value: that none of its effect's candidates has any
 * @constancy_p_value: of the same effect in every block
 * @kept: share of its derivative that no number of the model can make up for
 */
typedef struct {
  guint candidate;
  gdouble log_bayes_factor;
  gdouble improvement;
  gdouble changes[CLOTH_EFFECT_MAX_PARAMETERS];
  gdouble sigmas[CLOTH_EFFECT_MAX_PARAMETERS];
  gdouble p_value;
  gdouble constancy_p_value;
  gdouble kept;
} ClothGapScore;

/* An effect of whose squared derivative the nuisances leave less than this share can't be told
 * from them. */
#define CLOTH_GAP_IDENTIFIABLE 0.05

gint cloth_gap_score_compare (gconstpointer a, gconstpointer b);
gdouble cloth_gap_test_improvement (const ClothGapTest * test,
    guint candidate, const ClothNormalEquations * without,
    const ClothNormalEquations * with, const guint * directions, const gdouble * at,
    gdouble phi);
GArray *cloth_gap_test_run (const ClothGapTest * test);
gdouble cloth_gap_test_cosine (const ClothGapTest * test, guint one,
    guint other);

G_END_DECLS
