/* The model's free numbers and the effects to look for, as directions.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/diagnosis.h"

G_BEGIN_DECLS

gboolean cloth_diagnosis_list_candidates (ClothDiagnosis * d,
    const ClothModel * model, GError ** error);

G_END_DECLS
