/* Where the gap lies.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/diagnosis.h"

G_BEGIN_DECLS

void cloth_windowed_gap_fill (const ClothWindowedGap * before,
    const ClothWindowedGap * after, const ClothRecording * recording,
    ClothTake * take, ClothGapResult * result);
void cloth_diagnosis_locate (ClothDiagnosis * d);

G_END_DECLS
