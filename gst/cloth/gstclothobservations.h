/* The observation stream, application/x-cloth-observations: what a camera saw, without
 * the pixels.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth-prelude.h>

G_BEGIN_DECLS

#define GST_CLOTH_OBSERVATIONS_MEDIA_TYPE "application/x-cloth-observations"
#define GST_CLOTH_OBSERVATIONS_CAPS GST_CLOTH_OBSERVATIONS_MEDIA_TYPE ", " \
    "version=(int)1, width=(int)[ 1, 16384 ], height=(int)[ 1, 16384 ], " \
    "framerate=(fraction)[ 0/1, max ]"

/* A new buffer with the cloth metas of @buffer serialised, timestamps copied. */
GST_CLOTH_API GstBuffer *gst_cloth_observations_pack (GstBuffer * buffer);
/* Adds to @target (writable) the metas that @observation holds. */
GST_CLOTH_API gboolean gst_cloth_observations_unpack (GstBuffer * observation,
    GstBuffer * target, GError ** error);

G_END_DECLS
