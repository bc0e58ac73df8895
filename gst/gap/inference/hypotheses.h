/* Explanations: sets of effects, each simulated where the data ask it to be.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/diagnosis.h"
#include "gst/gap/inference/likelihood.h"

G_BEGIN_DECLS

/* Most effects of one explanation. */
#define CLOTH_GAP_MAX_EFFECTS CLOTH_DIAGNOSIS_MAX_ACCEPTED

/* @n: how many effects
 * @candidates: (array length=n): which, growing
 * @n_directions: how many numbers they have together
 * @n_winds: the last so many of these are winds of gusts: chance, which can't be simulated
 * @directions: (array length=n_directions): which
 * @priors: (array length=n_directions): of these
 * @at: (array length=n_directions): how far each is from its null where it was simulated
 * @next: (array length=n_directions): where it is simulated next
 * @z: (nullable) (array): residual of the simulation there
 * @derivatives: (array): of it, [n_directions][size]
 * @objective: log likelihood and log prior there
 * @evidence: what follows
 * @by_residual: how much less likely it is by its residual than the likeliest, logarithm
 * @behind: how much less likely it is by all that is known, posterior, logarithm
 *
 * That these effects act and no other of the library.
 */
typedef struct {
  guint n;
  guint candidates[CLOTH_GAP_MAX_EFFECTS];
  guint n_directions;
  guint n_winds;
  guint directions[CLOTH_GAP_MAX_DIRECTIONS];
  ClothGapPrior priors[CLOTH_GAP_MAX_DIRECTIONS];
  gdouble at[CLOTH_GAP_MAX_DIRECTIONS];
  gdouble next[CLOTH_GAP_MAX_DIRECTIONS];
  gdouble *z;
  gdouble *derivatives;
  gdouble objective;
  ClothGapEvidence evidence;
  gdouble by_residual;
  gdouble behind;

  /*< private >*/
  gboolean is_compared;         /* in the running round */
  gboolean is_settled;          /* it has arrived, or can't be simulated */
} ClothGapHypothesis;

/* @likelihood: of residuals
 * @stack: what they are of
 * @gram: of the residual at @base and of all directions, behind the free numbers
 * @base: what they were linearised at: none, or the likeliest set so far
 * @is_first: nothing was simulated before
 *
 * Where hypotheses are compared.
 */
typedef struct {
  const ClothGapLikelihood *likelihood;
  const ClothGapStack *stack;
  const ClothGapGram *gram;
  const ClothGapHypothesis *base;
  gboolean is_first;
} ClothGapLinearisation;

GArray *cloth_gap_hypotheses_new (void);
ClothGapHypothesis *cloth_gap_hypotheses_find (const GArray * hypotheses,
    const ClothGapHypothesis * hypothesis);
gboolean cloth_gap_hypothesis_init (ClothGapHypothesis * hypothesis,
    const ClothCandidates * candidates, const ClothGapStack * stack,
    const guint * list, guint n);
void cloth_gap_hypothesis_copy (ClothGapHypothesis * to,
    const ClothGapHypothesis * from);
void cloth_gap_hypothesis_clear (ClothGapHypothesis * hypothesis);
gboolean cloth_gap_hypothesis_has (const ClothGapHypothesis * hypothesis,
    guint candidate);
gboolean cloth_gap_hypothesis_is_same (const ClothGapHypothesis * a,
    const ClothGapHypothesis * b);
ClothModel *cloth_gap_hypothesis_make_model (const ClothDiagnosis * d,
    const ClothGapHypothesis * hypothesis);
gboolean cloth_gap_hypothesis_simulate (ClothDiagnosis * d,
    const ClothGapHypothesis * hypothesis, gdouble * z, GError ** error);
gdouble cloth_gap_hypothesis_find_p_value (const ClothDiagnosis * d,
    const ClothGapHypothesis * hypothesis, guint candidate);
gdouble cloth_gap_hypotheses_find_without (const GArray * hypotheses,
    const ClothGapHypothesis * h, guint c);
gboolean cloth_gap_hypotheses_screen (const ClothDiagnosis * d,
    const ClothGapLinearisation * linearisation, ClothGapEvidence * best);
gboolean cloth_gap_hypotheses_compare (ClothDiagnosis * d,
    const ClothGapLinearisation * linearisation, GArray * hypotheses,
    GError ** error);

G_END_DECLS
