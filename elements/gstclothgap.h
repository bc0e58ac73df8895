/* clothgap: where a mesh stream departs from a simulation of the cloth, and why.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "elements/gstclothfollow.h"

G_BEGIN_DECLS

/* What it puts on the meshes is #GstClothGap. */
#define GST_TYPE_GAP_DIAGNOSE (gst_gap_diagnose_get_type ())
G_DECLARE_FINAL_TYPE (GstGapDiagnose, gst_gap_diagnose, GST,
    GAP_DIAGNOSE, GstClothFollow)
GST_ELEMENT_REGISTER_DECLARE (clothgap);

G_END_DECLS
