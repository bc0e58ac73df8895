/* Grey pictures out of any file that GStreamer decodes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/image.h"

G_BEGIN_DECLS

/* Called with each picture taken and its number in the file, from 0; FALSE, with @error
 * set or not, ends the reading. */
typedef gboolean (*ClothFrameFunc) (const ClothImage * image, guint number,
    gpointer user_data, GError ** error);

gboolean cloth_frames_read (const gchar * path, guint every,
    ClothFrameFunc function, gpointer user_data, GError ** error);

G_END_DECLS
