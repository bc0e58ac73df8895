/* silhouette: where the cloth is in a picture.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "elements/gstclothfilter.h"

G_BEGIN_DECLS

#define GST_TYPE_SILHOUETTE (gst_silhouette_get_type ())
G_DECLARE_FINAL_TYPE (GstSilhouette, gst_silhouette, GST, SILHOUETTE,
    GstClothFilter)

GST_ELEMENT_REGISTER_DECLARE (silhouette);

G_END_DECLS
