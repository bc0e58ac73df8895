/* How well explanations foretell what happens next.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/inference/hypotheses.h"

G_BEGIN_DECLS

gdouble cloth_gap_find_prediction_evidence (const gdouble * squares, guint n,
    gdouble floor);
gboolean cloth_gap_hypotheses_predict (ClothDiagnosis * d,
    GArray * hypotheses, GError ** error);

G_END_DECLS
