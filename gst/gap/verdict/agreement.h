/* Whether takes and hold-outs agree on what is accepted.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/diagnosis.h"

G_BEGIN_DECLS

/* How often takes that agree are said to contradict each other. */
#define CLOTH_DIAGNOSIS_CONTRADICTION 0.01

gboolean cloth_diagnosis_test_agreement (ClothDiagnosis * d, GError ** error);

G_END_DECLS
