/* Signs of something in a take that its baseline has not.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/diagnosis.h"

G_BEGIN_DECLS

gchar *cloth_diagnosis_find_unexplained (ClothDiagnosis * d);

G_END_DECLS
