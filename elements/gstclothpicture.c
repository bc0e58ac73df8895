/* Pictures that an element hands on in the layout in which they came.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothpicture.h"

gboolean
gst_cloth_picture_map (GstElement * element, const GstVideoInfo * info,
    GstBuffer * buffer, GstMapFlags flags, GstVideoFrame * frame)
{
  if (gst_video_frame_map (frame, info, buffer, flags)) {
    return TRUE;
  }
  GST_ELEMENT_ERROR (element, STREAM, FORMAT,
      ("The picture does not fit its caps."),
      ("%" GST_PTR_FORMAT " for %s of %d × %d", buffer,
          GST_VIDEO_INFO_NAME (info), GST_VIDEO_INFO_WIDTH (info),
          GST_VIDEO_INFO_HEIGHT (info)));
  return FALSE;
}

static gboolean
is_plain (const GstVideoInfo * info, GstBuffer * buffer)
{
  const GstVideoMeta *meta = gst_buffer_get_video_meta (buffer);
  guint i;

  for (i = 0; meta && i < GST_VIDEO_INFO_N_PLANES (info); i++) {
    if (meta->stride[i] != GST_VIDEO_INFO_PLANE_STRIDE (info, i)
        || meta->offset[i] != GST_VIDEO_INFO_PLANE_OFFSET (info, i)) {
      return FALSE;
    }
  }
  return TRUE;
}

gboolean
gst_cloth_picture_make_plain (GstElement * element, const GstVideoInfo * info,
    GstBuffer ** buffer)
{
  g_autoptr (GstBuffer) plain = NULL;
  GstVideoFrame from, to;

  if (is_plain (info, *buffer)) {
    return TRUE;
  }
  plain = gst_buffer_new_allocate (NULL, GST_VIDEO_INFO_SIZE (info), NULL);
  if (!gst_cloth_picture_map (element, info, *buffer, GST_MAP_READ, &from)) {
    return FALSE;
  }
  if (!gst_cloth_picture_map (element, info, plain, GST_MAP_WRITE, &to)) {
    gst_video_frame_unmap (&from);
    return FALSE;
  }
  gst_video_frame_copy (&to, &from);
  gst_video_frame_unmap (&to);
  gst_video_frame_unmap (&from);
  gst_buffer_copy_into (plain, *buffer, GST_BUFFER_COPY_METADATA, 0, -1);
  gst_buffer_replace (buffer, plain);
  return TRUE;
}

void
gst_cloth_picture_proxy_caps (GstPad * pad, GstPad * other, GstQuery * query)
{
  g_autoptr (GstCaps) templ = gst_pad_get_pad_template_caps (pad);
  g_autoptr (GstCaps) peer = NULL;
  g_autoptr (GstCaps) result = NULL;
  GstCaps *filter;

  gst_query_parse_caps (query, &filter);
  peer = gst_pad_peer_query_caps (other, templ);
  if (filter) {
    result = gst_caps_intersect_full (filter, peer, GST_CAPS_INTERSECT_FIRST);
  } else {
    result = gst_caps_ref (peer);
  }
  gst_query_set_caps_result (query, result);
}
