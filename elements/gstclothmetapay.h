/* clothmetapay: what was seen in pictures, as an observation stream.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/base/gstbasetransform.h>

G_BEGIN_DECLS

#define GST_TYPE_CLOTH_META_PAY (gst_cloth_meta_pay_get_type ())
G_DECLARE_FINAL_TYPE (GstClothMetaPay, gst_cloth_meta_pay, GST, CLOTH_META_PAY,
    GstBaseTransform)
GST_ELEMENT_REGISTER_DECLARE (clothmetapay);

G_END_DECLS
