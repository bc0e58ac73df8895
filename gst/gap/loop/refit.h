/* The user's simulator in the loop: its numbers are fitted, and it is run with them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/diagnosis.h"

G_BEGIN_DECLS

gboolean cloth_diagnosis_refit (ClothDiagnosis * d, GError ** error);

G_END_DECLS
