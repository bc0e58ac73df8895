/* The gap of one mesh between recording and simulation, as buffer metadata.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth-prelude.h>

G_BEGIN_DECLS

/**
 * GstClothGap:
 *
 * Of each vertex of a mesh recorded minus simulated position, and the standard deviation of
 * what was recorded. Counted by reference, immutable.
 *
 * Since: 0.1
 */
typedef struct _GstClothGap GstClothGap;
typedef struct _GstClothGapMeta GstClothGapMeta;

/**
 * GstClothGapMeta:
 * @meta: parent
 * @gap: the payload, owned by the meta
 *
 * Puts a gap on a buffer of a mesh stream. It lies in the world, not in a picture, so it
 * has no tags: whatever copies a buffer's metadata copies it, by reference.
 *
 * Since: 0.1
 */
struct _GstClothGapMeta {
  GstMeta meta;
  GstClothGap *gap;
};

#define GST_TYPE_CLOTH_GAP (gst_cloth_gap_get_type ())

GST_CLOTH_API GType gst_cloth_gap_get_type (void);
GST_CLOTH_API GstClothGap *gst_cloth_gap_new (guint64 sequence,
    guint n_vertices, const gfloat * residuals, const gfloat * sigmas);
GST_CLOTH_API GstClothGap *gst_cloth_gap_new_from_arrays (guint64 sequence,
    const gfloat * residuals, guint n_residuals, const gfloat * sigmas,
    guint n_sigmas, GError ** error);
GST_CLOTH_API GstClothGap *gst_cloth_gap_ref (GstClothGap * gap);
GST_CLOTH_API void gst_cloth_gap_unref (GstClothGap * gap);
GST_CLOTH_API guint64 gst_cloth_gap_get_sequence (const GstClothGap * gap);
GST_CLOTH_API guint gst_cloth_gap_get_n_vertices (const GstClothGap * gap);
GST_CLOTH_API const gfloat *gst_cloth_gap_get_residuals (const GstClothGap * gap, guint * n_floats);
GST_CLOTH_API const gfloat *gst_cloth_gap_get_sigmas (const GstClothGap * gap, guint * n_floats);

GST_CLOTH_API GType gst_cloth_gap_meta_api_get_type (void);
GST_CLOTH_API const GstMetaInfo *gst_cloth_gap_meta_get_info (void);
GST_CLOTH_API GstClothGapMeta *gst_buffer_add_cloth_gap_meta (GstBuffer * buffer, GstClothGap * gap);
GST_CLOTH_API GstClothGap *gst_buffer_get_cloth_gap (GstBuffer * buffer);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (GstClothGap, gst_cloth_gap_unref)
G_END_DECLS
