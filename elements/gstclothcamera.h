/* clothcamera: films a mesh stream.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/base/gstbasetransform.h>
#include <gst/video/video.h>

G_BEGIN_DECLS

#define GST_TYPE_CLOTH_CAMERA (gst_cloth_camera_get_type ())
G_DECLARE_FINAL_TYPE (GstClothCamera, gst_cloth_camera, GST, CLOTH_CAMERA,
    GstBaseTransform)

GST_ELEMENT_REGISTER_DECLARE (clothcamera);

/* The format of the pictures, and the RGB that those of luma and chroma come from. */
typedef struct
{
  GstVideoInfo info, drawn;
  GstVideoConverter *converter; /* NULL: drawn as it leaves */
  GstBuffer *rgb;
} GstClothCameraOutput;

gboolean gst_cloth_camera_output_set (GstClothCameraOutput * output,
    GstCaps * caps);
void gst_cloth_camera_output_clear (GstClothCameraOutput * output);
gboolean gst_cloth_camera_output_map (GstClothCameraOutput * output,
    GstBuffer * picture, GstVideoFrame * frame, GstVideoFrame * drawn);
void gst_cloth_camera_output_unmap (GstClothCameraOutput * output,
    GstVideoFrame * frame, GstVideoFrame * drawn);
gboolean gst_cloth_camera_output_allocate (GstQuery * query);

G_END_DECLS
