/* Simulations that diverged, and effects that could not be tested for it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/diagnosis.h"

G_BEGIN_DECLS

void cloth_diagnosis_note_failure (gpointer data,
    const ClothRecording * recording, const ClothModel * model,
    gdouble sound_s);
void cloth_diagnosis_note_untested (ClothDiagnosis * d);

G_END_DECLS
