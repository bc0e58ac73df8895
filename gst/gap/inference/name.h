/* Naming: how much the residual supports each effect.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/diagnosis.h"
#include "gst/gap/inference/score.h"

G_BEGIN_DECLS

static inline const ClothCandidate *
cloth_diagnosis_candidate (const ClothDiagnosis * d, const ClothGapScore * score)
{
  return &g_array_index (d->candidates->list, ClothCandidate,
      score->candidate);
}

gboolean cloth_diagnosis_list_candidates (ClothDiagnosis * d,
    const ClothModel * model, GError ** error);
ClothPowerSpectrum *cloth_diagnosis_find_discrepancy_variance (const ClothDiagnosis * d,
    guint take);
ClothPowerSpectrum *cloth_diagnosis_find_weight (const ClothDiagnosis * d,
    guint take);
gdouble *cloth_diagnosis_list_columns (const ClothDiagnosis * d, guint take,
    guint before, guint more);
void cloth_diagnosis_find_discrepancies (ClothDiagnosis * d);
gboolean cloth_diagnosis_linearise (ClothDiagnosis * d, guint first, guint end,
    const ClothModel * model, gdouble from, gdouble to, GError ** error);
void cloth_diagnosis_make_test (ClothDiagnosis * d, guint begin, guint end,
    ClothGapTest * test);
void cloth_diagnosis_make_normals (ClothDiagnosis * d, guint begin, guint end,
    ClothGapTest * test);
void cloth_diagnosis_list_nuisances (ClothDiagnosis * d, ClothGapTest * test);
guint cloth_diagnosis_list_accepted (const ClothDiagnosis * d, gdouble width,
    guint * directions, gdouble * precisions);
void cloth_diagnosis_find_residual_variance (ClothDiagnosis * d,
    const ClothGapScore * score);
GArray *cloth_diagnosis_rank (ClothDiagnosis * d, ClothGapTest * test);
gdouble cloth_diagnosis_find_probability (const ClothDiagnosis * d,
    const GArray * scores, const ClothGapScore * which);
void cloth_diagnosis_fill_effects (ClothDiagnosis * d,
    const ClothGapTest * test, const GArray * scores);

G_END_DECLS
