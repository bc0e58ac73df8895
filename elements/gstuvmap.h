/* uvmap: stereo heads' matches and disparities become a mesh in space.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "elements/gstclothsync.h"

G_BEGIN_DECLS

#define GST_TYPE_UV_MAP (gst_uv_map_get_type ())
G_DECLARE_FINAL_TYPE (GstUVMap, gst_uv_map, GST, UV_MAP, GstClothSync)
GST_ELEMENT_REGISTER_DECLARE (uvmap);

G_END_DECLS
