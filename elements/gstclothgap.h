/* clothgap: where a mesh stream departs from a simulation of the cloth, and why.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/gst.h>

G_BEGIN_DECLS

/* Not GstClothGap: that is what it puts on the meshes. */
#define GST_TYPE_CLOTHGAP (gst_clothgap_get_type ())
G_DECLARE_FINAL_TYPE (GstClothgap, gst_clothgap, GST,
    CLOTHGAP, GstElement)
GST_ELEMENT_REGISTER_DECLARE (clothgap);

G_END_DECLS
