/* Which place of the flat cloth each pixel of a picture shows, as metadata of its mesh.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth-prelude.h>

G_BEGIN_DECLS

/**
 * GST_CLOTH_MAX_UV_SIZE:
 *
 * Largest width and height of a map of places, px.
 *
 * Since: 0.1
 */
#define GST_CLOTH_MAX_UV_SIZE 16384

/**
 * GST_CLOTH_MAX_UV_AREA:
 *
 * Most pixels of a map of places.
 *
 * Since: 0.1
 */
#define GST_CLOTH_MAX_UV_AREA (4096 * 4096)

/**
 * GstClothUV:
 *
 * Of each pixel of a camera's picture which place of the flat cloth it shows. Counted by
 * reference, immutable.
 *
 * Since: 0.1
 */
typedef struct _GstClothUV GstClothUV;
typedef struct _GstClothUVMeta GstClothUVMeta;

/**
 * GstClothUVMeta:
 * @meta: parent
 * @uv: the payload, owned by the meta
 *
 * Puts a map of places on a buffer of a mesh stream: one of each camera that saw the mesh. It
 * has no tags: whatever copies a whole buffer's metadata copies it, by reference.
 *
 * Since: 0.1
 */
struct _GstClothUVMeta {
  GstMeta meta;
  GstClothUV *uv;
};

#define GST_TYPE_CLOTH_UV (gst_cloth_uv_get_type ())

GST_CLOTH_API GType gst_cloth_uv_get_type (void);
GST_CLOTH_API GstClothUV *gst_cloth_uv_new (const gchar * camera, guint64 sequence,
    guint width, guint height, const gfloat * uv, guint n_floats);
GST_CLOTH_API GstClothUV *gst_cloth_uv_ref (GstClothUV * uv);
GST_CLOTH_API void gst_cloth_uv_unref (GstClothUV * uv);
GST_CLOTH_API const gchar *gst_cloth_uv_get_camera (const GstClothUV * uv);
GST_CLOTH_API guint64 gst_cloth_uv_get_sequence (const GstClothUV * uv);
GST_CLOTH_API guint gst_cloth_uv_get_width (const GstClothUV * uv);
GST_CLOTH_API guint gst_cloth_uv_get_height (const GstClothUV * uv);
GST_CLOTH_API const gfloat *gst_cloth_uv_get_uv (const GstClothUV * uv, guint * n_floats);
GST_CLOTH_API GBytes *gst_cloth_uv_get_map (GstClothUV * uv);

GST_CLOTH_API GType gst_cloth_uv_meta_api_get_type (void);
GST_CLOTH_API const GstMetaInfo *gst_cloth_uv_meta_get_info (void);
GST_CLOTH_API GstClothUVMeta *gst_buffer_add_cloth_uv_meta (GstBuffer * buffer, GstClothUV * uv);
GST_CLOTH_API GstClothUV *gst_buffer_get_cloth_uv (GstBuffer * buffer, const gchar * camera);
GST_CLOTH_API GstClothUV *gst_buffer_get_nth_cloth_uv (GstBuffer * buffer, guint index);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (GstClothUV, gst_cloth_uv_unref)
G_END_DECLS
