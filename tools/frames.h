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

/* A file that is read picture by picture, beside others. */
typedef struct _ClothFrameReader ClothFrameReader;

ClothFrameReader *cloth_frame_reader_open (const gchar * path,
    GError ** error);
void cloth_frame_reader_free (ClothFrameReader * reader);
gboolean cloth_frame_reader_next (ClothFrameReader * reader,
    ClothImage * image, GError ** error);
gdouble cloth_frame_reader_get_time (const ClothFrameReader * reader);

gboolean cloth_frames_read (const gchar * path, guint every,
    ClothFrameFunc function, gpointer user_data, GError ** error);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothFrameReader, cloth_frame_reader_free)
G_END_DECLS
