/* triangulate: N cameras' observations become a mesh in space.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "elements/gstclothsync.h"

G_BEGIN_DECLS

#define GST_TYPE_TRIANGULATE (gst_triangulate_get_type ())
G_DECLARE_FINAL_TYPE (GstTriangulate, gst_triangulate, GST, TRIANGULATE,
    GstClothSync)
GST_ELEMENT_REGISTER_DECLARE (triangulate);

G_END_DECLS
