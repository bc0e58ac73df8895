/* How well data agree with some directions of change, and how far to go along them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* Most directions of one explanation. */
#define CLOTH_GAP_MAX_DIRECTIONS 18
/* Degrees of freedom of the ensemble's scale, see evidence.c. */
#define CLOTH_GAP_FREEDOM 10.

/* @prior: standard deviation about @mean
 * @mean: where it is expected
 * @one_sided: it is not below 0
 *
 * What is known of a direction before.
 */
typedef struct {
  gdouble prior;
  gdouble mean;
  gboolean one_sided;
} ClothGapPrior;

/* @log_evidence: logarithm of the marginal likelihood, less a constant of the data
 * @log_volume: of it, what is not the likelihood and the prior at @values
 * @values: the most probable changes
 * @covariance: of these, [n][n]
 */
typedef struct {
  gdouble log_evidence;
  gdouble log_volume;
  gdouble values[CLOTH_GAP_MAX_DIRECTIONS];
  gdouble covariance[CLOTH_GAP_MAX_DIRECTIONS * CLOTH_GAP_MAX_DIRECTIONS];
} ClothGapEvidence;

gdouble cloth_gap_log_likelihood (guint n, gdouble square);
gdouble cloth_gap_log_prior (const ClothGapPrior * priors,
    const gdouble * values, guint n);
gboolean cloth_gap_evidence_find (guint n, const gdouble * e,
    const gdouble * derivatives, const gdouble * at,
    const ClothGapPrior * priors, guint n_directions, ClothGapEvidence * evidence);

G_END_DECLS
