/* Whether what is held was where the clamps' log has it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/diagnosis.h"

G_BEGIN_DECLS

gdouble cloth_gap_find_clamps_evidence (gdouble square, gdouble usual,
    gdouble n);
gboolean cloth_gap_is_surely_held (const ClothRecording * recording,
    const ClothHeld * held, gsize frame);
gdouble cloth_gap_find_clamps_off (const ClothRecording * recording,
    gdouble * n);
gdouble cloth_gap_find_clamps_distance (const ClothRecording * a,
    const ClothRecording * b);
gchar *cloth_diagnosis_find_clamps_off (const ClothDiagnosis * d,
    gdouble * log_bayes_factor);

G_END_DECLS
