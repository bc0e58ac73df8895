/* A picture from any file.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/gst.h>

G_BEGIN_DECLS

/* The first picture of a file that GStreamer decodes, in one of @formats, as caps write
 * them. */
GstSample *gst_cloth_load_picture (const gchar * path, const gchar * formats,
    gint max_px, GError ** error);

G_END_DECLS
