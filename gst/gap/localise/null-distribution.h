/* What the gap would be if the simulation lacked nothing.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/diagnosis.h"

G_BEGIN_DECLS

void cloth_diagnosis_fill_null_distribution (ClothDiagnosis * d);

G_END_DECLS
