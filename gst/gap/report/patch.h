/* What to change in model.json.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/report/result.h"

G_BEGIN_DECLS

void cloth_gap_result_fill_patch (ClothGapResult * result,
    const ClothModel * given);

G_END_DECLS
