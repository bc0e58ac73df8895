/* clothfit: a simulated cloth that follows a stream, whole where the stream has holes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "elements/gstclothfollow.h"

G_BEGIN_DECLS

#define GST_TYPE_CLOTH_FIT (gst_cloth_fit_get_type ())
G_DECLARE_FINAL_TYPE (GstClothFit, gst_cloth_fit, GST, CLOTH_FIT,
    GstClothFollow)
GST_ELEMENT_REGISTER_DECLARE (clothfit);

G_END_DECLS
