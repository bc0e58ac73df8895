/* Pictures from any file, and what they and patterns are on a cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/gst.h>
#include <gst/video/video.h>

#include "gst/render/paint.h"

G_BEGIN_DECLS

/* The first picture of a file that GStreamer decodes, in one of @formats, as caps write
 * them. */
GstSample *gst_cloth_load_picture (const gchar * path, const gchar * formats,
    gint max_px, GError ** error);

/* That picture in @format, with the colours as @film has them. NULL: it can't be. @info: (out):
 * of the buffer. */
GstBuffer *gst_cloth_convert_picture (GstSample * picture,
    const GstVideoInfo * film, GstVideoFormat format, GstVideoInfo * info);

/* What a pattern.json shows. @sides: (inout): raised to what a pattern of kind picture says. */
ClothPaint *gst_cloth_paint_pattern (const gchar * path, guint * sides,
    GError ** error);
/* A picture over the whole of the flat cloth. */
ClothPaint *gst_cloth_paint_texture (const gchar * path, const gfloat * uv,
    guint n_vertices, GError ** error);
ClothPaint *gst_cloth_paint_white (void);

G_END_DECLS
