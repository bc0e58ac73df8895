/* What the posterior over all explanations says of each effect.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/inference/hypotheses.h"

G_BEGIN_DECLS

/* @stack: features of the last round
 * @discrepancy: what they are off by if nothing acts
 * @likelihood: what hypotheses were compared by
 * @gram: of the residual that was linearised last and of all directions
 * @null: (array): the residual without any effect
 *
 * What the posterior was found with.
 */
typedef struct {
  const ClothGapStack *stack;
  const ClothGapDiscrepancy *discrepancy;
  const ClothGapLikelihood *likelihood;
  const ClothGapGram *gram;
  const gdouble *null;
} ClothGapBasis;

void cloth_diagnosis_find_unknown (ClothDiagnosis * d,
    const ClothGapBasis * basis, const gdouble * z);
void cloth_diagnosis_conclude (ClothDiagnosis * d, const ClothGapBasis * basis,
    const GArray * hypotheses);

G_END_DECLS
