/* The formats that clothcamera's pictures leave in: drawn in them, or drawn in RGB and
 * converted.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "elements/gstclothcamera.h"

void
gst_cloth_camera_output_clear (GstClothCameraOutput * output)
{
  g_clear_pointer (&output->converter, gst_video_converter_free);
  gst_clear_buffer (&output->rgb);
}

/* Pictures of luma and chroma are computed by GStreamer from RGB, with the matrix, the
 * range and the sites of chroma that the caps say. FALSE: @caps are no video. */
gboolean
gst_cloth_camera_output_set (GstClothCameraOutput * output, GstCaps * caps)
{
  gst_cloth_camera_output_clear (output);
  if (!gst_video_info_from_caps (&output->info, caps))
    return FALSE;
  output->drawn = output->info;
  if (!GST_VIDEO_INFO_IS_YUV (&output->info))
    return TRUE;
  if (!gst_video_info_set_format (&output->drawn, GST_VIDEO_FORMAT_RGBx,
          GST_VIDEO_INFO_WIDTH (&output->info),
          GST_VIDEO_INFO_HEIGHT (&output->info)))
    return FALSE;
  output->drawn.fps_n = GST_VIDEO_INFO_FPS_N (&output->info);
  output->drawn.fps_d = GST_VIDEO_INFO_FPS_D (&output->info);
  /* one thread, so that no seam between threads can show */
  output->converter = gst_video_converter_new (&output->drawn, &output->info,
      NULL);
  if (!output->converter)
    return FALSE;
  output->rgb = gst_buffer_new_allocate (NULL, GST_VIDEO_INFO_SIZE
      (&output->drawn), NULL);
  return TRUE;
}

/* Maps @picture, and what is to be drawn into: @picture itself or the RGB before. */
gboolean
gst_cloth_camera_output_map (GstClothCameraOutput * output,
    GstBuffer * picture, GstVideoFrame * frame, GstVideoFrame * drawn)
{
  if (!gst_video_frame_map (frame, &output->info, picture, GST_MAP_WRITE))
    return FALSE;
  if (!output->converter) {
    *drawn = *frame;
    return TRUE;
  }
  if (gst_video_frame_map (drawn, &output->drawn, output->rgb,
          GST_MAP_READWRITE))
    return TRUE;
  gst_video_frame_unmap (frame);
  return FALSE;
}

/* To be called when all is drawn. */
void
gst_cloth_camera_output_unmap (GstClothCameraOutput * output,
    GstVideoFrame * frame, GstVideoFrame * drawn)
{
  if (output->converter) {
    gst_video_converter_frame (output->converter, drawn, frame);
    gst_video_frame_unmap (drawn);
  }
  gst_video_frame_unmap (frame);
}

/* Offers pools of buffers that may have strides of their own. FALSE: no video. */
gboolean
gst_cloth_camera_output_allocate (GstQuery * query)
{
  g_autoptr (GstBufferPool) pool = NULL;
  GstStructure *config;
  GstCaps *caps;
  GstVideoInfo info;
  guint size, least = 0, most = 0;
  const gboolean offered = gst_query_get_n_allocation_pools (query) > 0;

  gst_query_parse_allocation (query, &caps, NULL);
  if (!caps || !gst_video_info_from_caps (&info, caps))
    return FALSE;
  size = (guint) GST_VIDEO_INFO_SIZE (&info);
  if (offered) {
    guint asked;

    gst_query_parse_nth_allocation_pool (query, 0, &pool, &asked, &least,
        &most);
    size = MAX (size, asked);
  }
  if (!pool)
    pool = gst_video_buffer_pool_new ();
  config = gst_buffer_pool_get_config (pool);
  gst_buffer_pool_config_set_params (config, caps, size, least, most);
  if (gst_query_find_allocation_meta (query, GST_VIDEO_META_API_TYPE, NULL))
    gst_buffer_pool_config_add_option (config,
        GST_BUFFER_POOL_OPTION_VIDEO_META);
  gst_buffer_pool_set_config (pool, config);
  if (offered)
    gst_query_set_nth_allocation_pool (query, 0, pool, size, least, most);
  else
    gst_query_add_allocation_pool (query, pool, size, least, most);
  return TRUE;
}
