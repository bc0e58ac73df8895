/* clothgap: the camera of an observation stream.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth.h>

#include "elements/gstclothgap-settings.h"
#include "gst/fit/recording/recording.h"
#include "gst/mesh/topology.h"

G_BEGIN_DECLS

typedef struct _GstClothGapView GstClothGapView;

/* All post an error on @element when they fail. */
GstClothGapView *gst_cloth_gap_view_new (GstElement * element,
    const GstClothGapSettings * settings, const ClothTopology * topology);
gboolean gst_cloth_gap_view_set_caps (GstClothGapView * view,
    GstElement * element, const GstCaps * caps);
/* @sequence, @offset_s: of the picture, and of the camera's clock to the rig's. What is
 * returned belongs to @view. */
const ClothRays *gst_cloth_gap_view_read (GstClothGapView * view,
    GstElement * element, GstBuffer * buffer, guint64 * sequence,
    gdouble * offset_s);
/* Posts an error when no picture so far showed squares or dots. */
gboolean gst_cloth_gap_view_check_seen (const GstClothGapView * view,
    GstElement * element);
void gst_cloth_gap_view_free (GstClothGapView * view);

G_END_DECLS
