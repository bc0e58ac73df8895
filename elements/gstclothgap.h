/* clothgap: where a mesh stream departs from a simulation of the cloth, and why.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/gst.h>

G_BEGIN_DECLS

/* GstClothGap is what it puts on the meshes. */
#define GST_TYPE_CLOTH_GAP_ELEMENT (gst_cloth_gap_element_get_type ())
G_DECLARE_FINAL_TYPE (GstClothGapElement, gst_cloth_gap_element, GST,
    CLOTH_GAP_ELEMENT, GstElement)
GST_ELEMENT_REGISTER_DECLARE (clothgap);

G_END_DECLS
