/* Something that no effect of the library is.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/inference/likelihood.h"

G_BEGIN_DECLS

/* @force_field: logarithm of the Bayes factor for an unknown force field
 * @displacement_field: the same for an unknown field of displacements of what was measured
 * @power: of what is left, what is more than the ensemble has, sum of squares
 */
typedef struct {
  gdouble force_field;
  gdouble displacement_field;
  gdouble power;
} ClothGapUnknown;

void cloth_gap_find_unknown (const ClothGapStack * stack,
    const ClothGapDiscrepancy * discrepancy, const gboolean * is_force,
    const gdouble * powers, ClothGapUnknown * unknown);

G_END_DECLS
