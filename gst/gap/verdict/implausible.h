/* Recordings that nothing can be decided from.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/diagnosis.h"

G_BEGIN_DECLS

gchar *cloth_diagnosis_find_implausible_input (ClothDiagnosis * d,
    const ClothModel * model);
gchar *cloth_diagnosis_find_noise (ClothDiagnosis * d);
gchar *cloth_diagnosis_find_implausible_result (ClothDiagnosis * d,
    const ClothModel * model);

G_END_DECLS
