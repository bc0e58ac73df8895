/* clothmetadepay: an observation stream as black pictures with metas.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/base/gstbasetransform.h>

G_BEGIN_DECLS

#define GST_TYPE_CLOTH_META_DEPAY (gst_cloth_meta_depay_get_type ())
G_DECLARE_FINAL_TYPE (GstClothMetaDepay, gst_cloth_meta_depay, GST, CLOTH_META_DEPAY,
    GstBaseTransform)
GST_ELEMENT_REGISTER_DECLARE (clothmetadepay);

G_END_DECLS
