/* What the windows of a free simulation give to the result.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/nudge/windows.h"
#include "gst/gap/report/result.h"
#include "gst/take/take.h"

G_BEGIN_DECLS

void cloth_windowed_gap_fill (const ClothWindowedGap * before,
    const ClothWindowedGap * after, const ClothRecording * recording,
    ClothTake * take, ClothGapResult * result);

G_END_DECLS
