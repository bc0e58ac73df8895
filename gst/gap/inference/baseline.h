/* The model's free numbers, and how much simulations that lack nothing support each effect.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/diagnosis.h"

G_BEGIN_DECLS

gboolean cloth_diagnosis_fit_free (ClothDiagnosis * d,
    const ClothModel * model, GError ** error);
gboolean cloth_diagnosis_study_baselines (ClothDiagnosis * d,
    GError ** error);
gboolean cloth_diagnosis_study_other_model (ClothDiagnosis * d,
    GError ** error);

G_END_DECLS
