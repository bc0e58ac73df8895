/* meshsink: a mesh stream into files.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/base/gstbasesink.h>

G_BEGIN_DECLS

#define GST_TYPE_MESH_SINK (gst_mesh_sink_get_type ())
G_DECLARE_FINAL_TYPE (GstMeshSink, gst_mesh_sink, GST, MESH_SINK, GstBaseSink)

GST_ELEMENT_REGISTER_DECLARE (meshsink);

G_END_DECLS
