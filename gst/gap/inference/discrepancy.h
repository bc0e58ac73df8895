/* What a simulator is off by although nothing acts that it lacks.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/inference/stack.h"

G_BEGIN_DECLS

/* No law of an effect holds better than to this share of what it changes. */
#define CLOTH_GAP_LAW_ERROR 0.2

/* @slopes: (array): how much of the reference's residual the take's has by class, [n_classes]
 * @free: derivatives by the free numbers less what the reference's say of them, [n_free][size]
 * @members: what each member of the ensemble is off by beyond the reference, [n_members][size]
 * @variances: (array): mean square of these by class
 * @on_reference: (nullable): the members on the reference, their free numbers fitted
 * @reference_variances: (nullable) (array): mean square of these by class
 * @shared: share of the ensemble's power that the reference tells, class by class, 0 to 1
 */
typedef struct {
  gdouble *slopes;
  gdouble *free;
  gdouble *members;
  gdouble *variances;
  gdouble *on_reference;
  gdouble *reference_variances;
  gdouble shared;
} ClothGapDiscrepancy;

ClothGapDiscrepancy *cloth_gap_discrepancy_new (const ClothGapStack * stack,
    const gdouble * response);
void cloth_gap_discrepancy_free (ClothGapDiscrepancy * discrepancy);
void cloth_gap_discrepancy_take_reference_off (const ClothGapDiscrepancy *
    discrepancy, const ClothGapStack * stack, const gdouble * z, gdouble * left);
void cloth_gap_find_mean_powers (const ClothGapStack * stack,
    const gdouble * members, gdouble * mean);
void cloth_gap_find_powers (const ClothGapStack * stack, const gdouble * z,
    gdouble * powers);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothGapDiscrepancy, cloth_gap_discrepancy_free)
G_END_DECLS
