/* clothjson: what was found as JSON Lines.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/base/gstbasetransform.h>

G_BEGIN_DECLS

#define GST_TYPE_CLOTH_JSON (gst_cloth_json_get_type ())
G_DECLARE_FINAL_TYPE (GstClothJson, gst_cloth_json, GST, CLOTH_JSON,
    GstBaseTransform)

GST_ELEMENT_REGISTER_DECLARE (clothjson);

G_END_DECLS
