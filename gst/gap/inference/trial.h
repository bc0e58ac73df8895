/* The likeliest effects, simulated where the residual asks them to be.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/inference/name.h"

G_BEGIN_DECLS

gboolean cloth_diagnosis_refine_hypotheses (ClothDiagnosis * d,
    const ClothGapTest * test, GArray * scores, const ClothModel * base,
    GError ** error);

G_END_DECLS
