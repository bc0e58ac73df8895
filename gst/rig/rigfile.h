/* rig.json: the cameras of a rig in a file.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/rig.h"

G_BEGIN_DECLS

ClothRig *cloth_rig_load (const gchar * path, GError ** error);
ClothRig *cloth_rig_load_data (const gchar * data, gsize length,
    GError ** error);
gboolean cloth_rig_save (const ClothRig * rig, const gchar * path,
    GError ** error);

G_END_DECLS
