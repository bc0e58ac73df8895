/* What several elements do alike: caps, times, properties that hold from start to stop, the
 * camera of a rig, what comes as a mesh stream.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth.h>

#include "gst/rig/rig.h"

G_BEGIN_DECLS

GstCaps *gst_cloth_filter_caps (GstCaps * caps, GstCaps * filter);
GstCaps *gst_cloth_carry_caps (const GstCaps * caps,
    const gchar * const * fields, GstCaps * other, GstCaps * filter);
GstClockTime gst_cloth_stream_time (const GstSegment * segment,
    GstBuffer * buffer);
guint64 gst_cloth_number_picture (const GstSegment * segment, gint fps_n,
    gint fps_d, GstBuffer * buffer, guint64 count);
void gst_cloth_add_latency (GstQuery * query, GstClockTime own);
ClothRig *gst_cloth_open_rig (GstElement * element, const gchar * path,
    const gchar * name, const ClothCamera ** camera);
GstClothTopology *gst_cloth_read_topology (GstElement * element,
    const GstCaps * caps);
GstClothMesh *gst_cloth_parse_mesh (GstBuffer * buffer, guint n_vertices,
    GError ** error);
GstClothMesh *gst_cloth_read_mesh (GstElement * element, GstBuffer * buffer,
    guint n_vertices);

G_END_DECLS
