/* The diagnosis: where a simulation departs from recordings, and which effect it lacks.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/error.h"
#include "gst/gap/inputs.h"
#include "gst/gap/report/result.h"

G_BEGIN_DECLS

ClothGapResult *cloth_gap_diagnose (ClothTake ** takes, guint n_takes,
    const ClothModel * model, const ClothGapOptions * options,
    GError ** error);

G_END_DECLS
