/* Whether the user's simulator with the accepted effects agrees with what judges.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/diagnosis.h"

G_BEGIN_DECLS

/* What remains in the user's simulator is no more than the floor when it is below so many of it
 * (variance). */
#define CLOTH_DIAGNOSIS_LARGEST_REST 2.25

void cloth_diagnosis_confirm (ClothDiagnosis * d);

G_END_DECLS
