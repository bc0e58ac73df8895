/* The verdict.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/diagnosis.h"

G_BEGIN_DECLS

gboolean cloth_gap_result_is_ambiguous (const ClothGapResult * result);
void cloth_diagnosis_decide (ClothDiagnosis * d);

G_END_DECLS
