/* Pictures that an element hands on in the layout in which they came.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/video/video.h>

G_BEGIN_DECLS

/* Maps @buffer, or posts an error of @element. */
gboolean gst_cloth_picture_map (GstElement * element,
    const GstVideoInfo * info, GstBuffer * buffer, GstMapFlags flags,
    GstVideoFrame * frame);

/* Brings @buffer (inout) into the layout that the caps mean, if it is in another one. FALSE:
 * an error was posted. */
gboolean gst_cloth_picture_make_plain (GstElement * element,
    const GstVideoInfo * info, GstBuffer ** buffer);

/* Answers a query for the caps of @pad: what one side of a picture's way takes is what the
 * @other takes. */
void gst_cloth_picture_proxy_caps (GstPad * pad, GstPad * other,
    GstQuery * query);

G_END_DECLS
