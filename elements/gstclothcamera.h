/* clothcamera: films a mesh stream.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/base/gstbasetransform.h>
#include <gst/video/video.h>

#include "gst/rig/orbit.h"

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

/* Where the free view is from. */
#define GST_CLOTH_CAMERA_VIEW_SETTINGS 3

typedef struct
{
  gdouble settings[GST_CLOTH_CAMERA_VIEW_SETTINGS];
  ClothOrbit orbit;
  gboolean framed;              /* the orbit knows where the cloth is */
} GstClothCameraView;

void gst_cloth_camera_view_init (GstClothCameraView * view);
void gst_cloth_camera_view_install (GObjectClass * klass, guint id);
void gst_cloth_camera_view_aim (GstClothCameraView * view, guint n_vertices,
    const gdouble * positions, gint width, gint height, ClothCamera * camera);
GstCaps *gst_cloth_camera_view_fixate (GstCaps * caps);

G_END_DECLS
