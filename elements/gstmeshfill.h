/* meshfill: a mesh stream with holes becomes a whole one.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/gst.h>

G_BEGIN_DECLS

#define GST_TYPE_MESH_FILL (gst_mesh_fill_get_type ())
G_DECLARE_FINAL_TYPE (GstMeshFill, gst_mesh_fill, GST, MESH_FILL, GstElement)
GST_ELEMENT_REGISTER_DECLARE (meshfill);

G_END_DECLS
