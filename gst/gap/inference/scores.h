/* The residual as few numbers: its score along each direction, and what these are by chance.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/inference/discrepancy.h"

G_BEGIN_DECLS

typedef struct _ClothGapProjector ClothGapProjector;

/* @n: number of scores: one of each direction
 * @size: features of all takes
 * @templates: what each score is the product with, [n][size]
 * @offset: (array): what the reference says of the residual, which is taken off first
 * @whitener: lower triangle L; L⁻¹ scores are independent with variance 1 if nothing acts, [n][n]
 * @derivatives: of whitened scores by the directions, [n][n]: each direction's one after another
 * @projector: takes off what nuisances can make of a residual
 * @member_rests: powers, class by class, of what the nuisances leave of each member, those of its
 *   own family not among them, in units of the variances, [n_members][n_classes]
 * @free_covariance: of the free numbers once the residual is known, [n_free][n_free]
 * @temperature: how many times more logarithm of evidence members show by chance than they should
 */
typedef struct {
  guint n;
  gsize size;
  gdouble *templates;
  gdouble *offset;
  gdouble *whitener;
  gdouble *derivatives;
  ClothGapProjector *projector;
  gdouble *member_rests;
  gdouble *free_covariance;
  gdouble temperature;
} ClothGapScores;

ClothGapScores *cloth_gap_scores_new (const ClothGapStack * stack,
    const ClothGapDiscrepancy * discrepancy);
void cloth_gap_scores_find (const ClothGapScores * scores, const gdouble * z,
    gdouble * e);
void cloth_gap_scores_find_rest (const ClothGapScores * scores,
    const gdouble * z, gdouble * rest);
void cloth_gap_scores_free (ClothGapScores * scores);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothGapScores, cloth_gap_scores_free)
G_END_DECLS
