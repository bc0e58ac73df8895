/* What the model is that effects are looked for beside.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/diagnosis.h"

G_BEGIN_DECLS

gboolean cloth_diagnosis_fit_free (ClothDiagnosis * d, const ClothModel * model,
    GError ** error);
gboolean cloth_diagnosis_is_at_end (const ClothDiagnosis * d, guint i);

G_END_DECLS
