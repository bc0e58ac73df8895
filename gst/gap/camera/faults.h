/* What was wrong with the cameras, and the recordings without it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/diagnosis.h"

G_BEGIN_DECLS

void cloth_diagnosis_find_faults (ClothDiagnosis * d);

G_END_DECLS
