/* clothoverlay: draws what the other elements have found.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "elements/gstclothsync.h"

G_BEGIN_DECLS

#define GST_TYPE_CLOTH_OVERLAY (gst_cloth_overlay_get_type ())
G_DECLARE_FINAL_TYPE (GstClothOverlay, gst_cloth_overlay, GST, CLOTH_OVERLAY,
    GstClothSync)
GST_ELEMENT_REGISTER_DECLARE (clothoverlay);

G_END_DECLS
