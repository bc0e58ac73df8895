/* How large the gap is without and with the accepted effects, on every take and hold-out.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/diagnosis.h"

G_BEGIN_DECLS

gboolean cloth_diagnosis_measure (ClothDiagnosis * d, GError ** error);
gboolean cloth_diagnosis_measure_after (ClothDiagnosis * d, GError ** error);

G_END_DECLS
