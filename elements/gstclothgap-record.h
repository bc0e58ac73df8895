/* clothgap: the meshes that went by as a take, and its diagnosis.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/diagnose.h"
#include "gst/sim/scene.h"

G_BEGIN_DECLS

typedef struct _GstClothGapRecord GstClothGapRecord;

GstClothGapRecord *gst_cloth_gap_record_new (const ClothTakeInfo * info,
    const ClothScene * scene, GError ** error);
gboolean gst_cloth_gap_record_append (GstClothGapRecord * record,
    gdouble time_s, const gfloat * positions, const guint8 * states,
    const gfloat * covariances, GError ** error);
ClothGapResult *gst_cloth_gap_record_diagnose (GstClothGapRecord * record,
    const ClothModel * model, const ClothGapOptions * options,
    GError ** error);
void gst_cloth_gap_record_free (GstClothGapRecord * record);

G_END_DECLS
