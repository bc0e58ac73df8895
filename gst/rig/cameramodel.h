/* mrcal's .cameramodel files, one a camera.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/rig.h"

G_BEGIN_DECLS

ClothRig *cloth_rig_import_mrcal (const gchar * const *paths, GError ** error);
ClothRig *cloth_rig_import_mrcal_data (const gchar * data, gsize length,
    GError ** error);
gchar *cloth_cameramodel_to_text (const ClothCamera * camera, GError ** error);
gboolean cloth_rig_export_mrcal (const ClothRig * rig, const gchar * folder,
    GError ** error);

G_END_DECLS
