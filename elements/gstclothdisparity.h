/* clothdisparity: how far away the cloth is in the pictures of a stereo head.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "elements/gstclothsync.h"

G_BEGIN_DECLS

/* What it puts on the pictures is #GstClothDisparity. */
#define GST_TYPE_STEREO_MATCH (gst_stereo_match_get_type ())
G_DECLARE_FINAL_TYPE (GstStereoMatch, gst_stereo_match, GST, STEREO_MATCH,
    GstClothSync)
GST_ELEMENT_REGISTER_DECLARE (clothdisparity);

G_END_DECLS
