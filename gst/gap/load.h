/* The recordings of a diagnosis: read, checked and noted among its inputs.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/diagnosis.h"

G_BEGIN_DECLS

gboolean cloth_diagnosis_load (ClothDiagnosis * d, const ClothModel * model,
    GError ** error);
ClothTake *cloth_diagnosis_run_simulator (ClothDiagnosis * d, guint recording,
    const gdouble * values, GError ** error);
gboolean cloth_diagnosis_add_after (ClothDiagnosis * d, guint recording,
    const gdouble * values, GError ** error);

G_END_DECLS
