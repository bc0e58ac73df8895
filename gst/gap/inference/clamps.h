/* Whether what is held was where the clamps' log has it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/diagnosis.h"

G_BEGIN_DECLS

gdouble cloth_gap_find_clamps_evidence (gdouble square, gdouble usual,
    gdouble n);
gchar *cloth_diagnosis_find_clamps_off (const ClothDiagnosis * d,
    gdouble * log_bayes_factor);

G_END_DECLS
