/* Import of calibrations made by OpenCV and Kalibr.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/rig.h"

G_BEGIN_DECLS

ClothRig *cloth_rig_import_opencv (const gchar * const *paths, gint width,
    gint height, GError ** error);
ClothRig *cloth_rig_import_opencv_data (const gchar * data, gsize length,
    gint width, gint height, GError ** error);
ClothRig *cloth_rig_import_kalibr (const gchar * path, GError ** error);
ClothRig *cloth_rig_import_kalibr_data (const gchar * data, gsize length,
    GError ** error);

G_END_DECLS
