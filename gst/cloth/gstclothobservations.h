/* The observation stream, application/x-cloth-observations: what a camera saw, without
 * the pixels.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth-prelude.h>

G_BEGIN_DECLS

/**
 * GST_CLOTH_OBSERVATIONS_MEDIA_TYPE:
 *
 * Media type of an observation stream, in its caps.
 *
 * Since: 0.1
 */
#define GST_CLOTH_OBSERVATIONS_MEDIA_TYPE "application/x-cloth-observations"

/**
 * GST_CLOTH_OBSERVATIONS_CAPS:
 *
 * Template caps of an observation stream; width and height are those of the picture
 * that the places refer to.
 *
 * Since: 0.1
 */
#define GST_CLOTH_OBSERVATIONS_CAPS GST_CLOTH_OBSERVATIONS_MEDIA_TYPE ", " \
    "version=(int)1, width=(int)[ 1, 16384 ], height=(int)[ 1, 16384 ], " \
    "framerate=(fraction)[ 0/1, max ]"

GST_CLOTH_API GstBuffer *gst_cloth_observations_pack (GstBuffer * buffer);
GST_CLOTH_API gboolean gst_cloth_observations_unpack (GstBuffer * observation,
    GstBuffer * target, GError ** error);

G_END_DECLS
