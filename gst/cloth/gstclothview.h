/* What one of the cameras that a mesh was made of saw, as metadata of the mesh.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth-prelude.h>

G_BEGIN_DECLS

/**
 * GstClothView:
 *
 * What one of the cameras that a mesh was made of saw: a buffer of its observation stream.
 * Counted by reference, immutable.
 *
 * Since: 0.2
 */
typedef struct _GstClothView GstClothView;
typedef struct _GstClothViewMeta GstClothViewMeta;

/**
 * GstClothViewMeta:
 * @meta: parent
 * @view: the payload, owned by the meta
 *
 * Puts what a camera saw on the mesh that was made of it: one of each camera. It has no tags:
 * whatever copies a whole buffer's metadata copies it, by reference.
 *
 * Since: 0.2
 */
struct _GstClothViewMeta {
  GstMeta meta;
  GstClothView *view;
};

#define GST_TYPE_CLOTH_VIEW (gst_cloth_view_get_type ())

GST_CLOTH_API GType gst_cloth_view_get_type (void);
GST_CLOTH_API GstClothView *gst_cloth_view_new (const gchar * camera, guint64 sequence,
    GstBuffer * observation);
GST_CLOTH_API GstClothView *gst_cloth_view_ref (GstClothView * view);
GST_CLOTH_API void gst_cloth_view_unref (GstClothView * view);
GST_CLOTH_API const gchar *gst_cloth_view_get_camera (const GstClothView * view);
GST_CLOTH_API guint64 gst_cloth_view_get_sequence (const GstClothView * view);
GST_CLOTH_API GstBuffer *gst_cloth_view_get_observation (const GstClothView * view);

GST_CLOTH_API GType gst_cloth_view_meta_api_get_type (void);
GST_CLOTH_API const GstMetaInfo *gst_cloth_view_meta_get_info (void);
GST_CLOTH_API GstClothViewMeta *gst_buffer_add_cloth_view_meta (GstBuffer * buffer, GstClothView * view);
GST_CLOTH_API GstClothView *gst_buffer_get_cloth_view (GstBuffer * buffer, const gchar * camera);
GST_CLOTH_API GstClothView *gst_buffer_get_nth_cloth_view (GstBuffer * buffer, guint index);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (GstClothView, gst_cloth_view_unref)
G_END_DECLS
