/* The colours of dots as one camera sees them, from a picture of the print; and what that
 * picture and those of the film have in common.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/video/video.h>

#include "gst/pattern/marray.h"
#include "gst/vision/label/dot-colour.h"
#include "gst/vision/label/dot-label.h"

G_BEGIN_DECLS

/* A picture in colour, luma and chroma in planes. */
void gst_dot_label_view (const GstVideoFrame * frame, ClothDotImage * image);
/* Which colour the label of each dot says that it has, -1 without a label. Returns how many
 * have one. */
guint gst_dot_label_say (const ClothDotLabeller * labeller,
    const ClothMArray * array, gint8 * said);

GstSample *gst_dot_label_chart_load (const gchar * path, GError ** error);
/* Learns from the dots of @chart that can be labelled. @colours holds those of the print
 * and is changed when that succeeds alone; @film is what it is meant for. */
gboolean gst_dot_label_chart_learn (GstSample * chart,
    const ClothMArray * array, const GstVideoInfo * film,
    const ClothDotParams * dot_params, const ClothDotLabelParams * label_params,
    ClothDotColourModel * colours, GError ** error);

G_END_DECLS
