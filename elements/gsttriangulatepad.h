/* Sink pads of triangulate: each has a camera.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "elements/gstclothsync.h"

G_BEGIN_DECLS

#define GST_TYPE_TRIANGULATE_PAD (gst_triangulate_pad_get_type ())
G_DECLARE_FINAL_TYPE (GstTriangulatePad, gst_triangulate_pad, GST,
    TRIANGULATE_PAD, GstClothSyncPad)

/* Renews *@camera when the property camera is another. */
void gst_triangulate_pad_update_camera (GstTriangulatePad * pad,
    gchar ** camera);
/* Makes sink_0::camera work on a gst-launch line: the interface of the element. */
void gst_triangulate_pad_child_proxy_init (gpointer iface, gpointer data);

G_END_DECLS
