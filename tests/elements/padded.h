/* Pictures whose rows are longer than need be.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/video/video.h>
#include <string.h>

/* Where luma lies in a padded picture. */
typedef struct
{
  gsize offset;
  gint stride;
} Luma;

/* A picture of @fill without a time.
 * @padding: bytes that each plane's rows have too many, told by a video meta; with 0 there
 *   is none, and the picture is as its caps say */
static inline GstBuffer *
padded_picture (const GstVideoInfo * info, gint padding, guint8 fill,
    Luma * luma)
{
  gsize offset[GST_VIDEO_MAX_PLANES] = { 0 }, size = 0;
  gint stride[GST_VIDEO_MAX_PLANES] = { 0 };
  GstBuffer *buffer;

  for (guint p = 0; p < GST_VIDEO_INFO_N_PLANES (info); p++) {
    stride[p] = GST_VIDEO_INFO_PLANE_STRIDE (info, p) + padding;
    offset[p] = size;
    size += (gsize) stride[p] * (gsize) (GST_VIDEO_INFO_HEIGHT (info) + 1);
  }
  if (padding == 0)
    size = GST_VIDEO_INFO_SIZE (info);
  buffer = gst_buffer_new_allocate (NULL, size, NULL);
  gst_buffer_memset (buffer, 0, fill, size);
  if (padding)
    gst_buffer_add_video_meta_full (buffer, GST_VIDEO_FRAME_FLAG_NONE,
        GST_VIDEO_INFO_FORMAT (info), (guint) GST_VIDEO_INFO_WIDTH (info),
        (guint) GST_VIDEO_INFO_HEIGHT (info), GST_VIDEO_INFO_N_PLANES (info),
        offset, stride);
  luma->offset = padding ? offset[0] : GST_VIDEO_INFO_PLANE_OFFSET (info, 0);
  luma->stride = stride[0];
  GST_BUFFER_DURATION (buffer) = 40 * GST_MSECOND;
  return buffer;
}
