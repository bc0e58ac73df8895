/* How likely a residual is: class by class of features, with nuisances integrated out.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/inference/discrepancy.h"

G_BEGIN_DECLS

/* Most directions of one explanation. */
#define CLOTH_GAP_MAX_DIRECTIONS 18
/* No family of members is left out. */
#define CLOTH_GAP_ALL_FAMILIES G_MAXUINT

/* @prior: standard deviation about @mean
 * @mean: expected value
 * @one_sided: the direction is not below 0
 *
 * What is known of a direction before anything is seen.
 */
typedef struct {
  gdouble prior;
  gdouble mean;
  gboolean one_sided;
} ClothGapPrior;

/* @log_evidence: logarithm of the marginal likelihood, up to a constant of the likelihood
 * @log_volume: the part of it that the directions' uncertainty contributes (Occam factor)
 * @modes: most probable values of the directions
 * @values: the same, but of those that can't be negative the mean of that half
 * @covariance: of these, [n][n]
 */
typedef struct {
  gdouble log_evidence;
  gdouble log_volume;
  gdouble modes[CLOTH_GAP_MAX_DIRECTIONS];
  gdouble values[CLOTH_GAP_MAX_DIRECTIONS];
  gdouble covariance[CLOTH_GAP_MAX_DIRECTIONS * CLOTH_GAP_MAX_DIRECTIONS];
} ClothGapEvidence;

typedef struct _ClothGapLikelihood ClothGapLikelihood;
typedef struct _ClothGapGram ClothGapGram;

ClothGapLikelihood *cloth_gap_likelihood_new (const ClothGapStack * stack,
    const ClothGapDiscrepancy * discrepancy, guint left_out);
gdouble cloth_gap_likelihood_get_coarsening (void);
gdouble cloth_gap_likelihood_find_constant (const ClothGapLikelihood * likelihood);
void cloth_gap_likelihood_find_rest (const ClothGapLikelihood * likelihood,
    const gdouble * left, gdouble * powers);
void cloth_gap_likelihood_find_free_covariance (const ClothGapLikelihood *
    likelihood, gdouble * covariance);
void cloth_gap_likelihood_free (ClothGapLikelihood * likelihood);

ClothGapGram *cloth_gap_gram_new (const ClothGapLikelihood * likelihood,
    const gdouble * z, const gdouble * columns, guint n);
gboolean cloth_gap_gram_find_evidence (const ClothGapGram * gram,
    const guint * list, const gdouble * at, const ClothGapPrior * priors,
    guint n, ClothGapEvidence * evidence);
gdouble cloth_gap_gram_find_information (const ClothGapGram * gram,
    guint direction);
void cloth_gap_gram_free (ClothGapGram * gram);

gdouble cloth_gap_log_normal_cdf (gdouble x);
gdouble cloth_gap_log_prior (const ClothGapPrior * priors,
    const gdouble * values, guint n);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothGapLikelihood, cloth_gap_likelihood_free)
G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothGapGram, cloth_gap_gram_free)
G_END_DECLS
