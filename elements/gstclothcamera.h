/* clothcamera: films a mesh stream.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/base/gstbasetransform.h>

G_BEGIN_DECLS

#define GST_TYPE_CLOTH_CAMERA (gst_cloth_camera_get_type ())
G_DECLARE_FINAL_TYPE (GstClothCamera, gst_cloth_camera, GST, CLOTH_CAMERA,
    GstBaseTransform)

GST_ELEMENT_REGISTER_DECLARE (clothcamera);

G_END_DECLS
