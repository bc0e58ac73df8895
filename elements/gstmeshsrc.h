/* meshsrc: files into a mesh stream.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "elements/gstclothsource.h"

G_BEGIN_DECLS

#define GST_TYPE_MESH_SRC (gst_mesh_src_get_type ())
G_DECLARE_FINAL_TYPE (GstMeshSrc, gst_mesh_src, GST, MESH_SRC, GstClothSource)

GST_ELEMENT_REGISTER_DECLARE (meshsrc);

G_END_DECLS
