/* Which effects act: the posterior over all sets of them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/diagnosis.h"

G_BEGIN_DECLS

gboolean cloth_diagnosis_infer (ClothDiagnosis * d, GError ** error);

G_END_DECLS
