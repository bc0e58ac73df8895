/* The silhouette of the cloth in one picture, as buffer metadata.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth-prelude.h>

G_BEGIN_DECLS

/**
 * GstClothSilhouette:
 *
 * Which pixels of one picture are cloth, as runs of its rows. Counted by reference, immutable.
 *
 * Since: 0.1
 */
typedef struct _GstClothSilhouette GstClothSilhouette;
typedef struct _GstClothRun GstClothRun;
typedef struct _GstClothSilhouetteMeta GstClothSilhouetteMeta;

/**
 * GST_CLOTH_MAX_RUNS:
 *
 * Most runs of a silhouette.
 *
 * Since: 0.1
 */
#define GST_CLOTH_MAX_RUNS 1048576

/**
 * GST_CLOTH_MAX_SILHOUETTE_SIZE:
 *
 * Largest width and height of a silhouette, px.
 *
 * Since: 0.1
 */
#define GST_CLOTH_MAX_SILHOUETTE_SIZE 16384

/**
 * GstClothRun:
 * @row: row, 0 the uppermost
 * @begin: first column that is cloth
 * @end: the column after the last one
 *
 * Pixels of a row that follow each other and are cloth.
 *
 * Since: 0.1
 */
struct _GstClothRun {
  guint16 row, begin, end;
};

/**
 * GstClothSilhouetteMeta:
 * @meta: parent
 * @silhouette: the payload, owned by the meta
 *
 * Puts a silhouette on a picture. Tagged video, orientation and size: it is copied by
 * reference. A silhouette has a size of its own, so that it stays as it is when the picture
 * is scaled; any other transformation drops it.
 *
 * Since: 0.1
 */
struct _GstClothSilhouetteMeta {
  GstMeta meta;
  GstClothSilhouette *silhouette;
};

#define GST_TYPE_CLOTH_SILHOUETTE (gst_cloth_silhouette_get_type ())
#define GST_TYPE_CLOTH_RUN (gst_cloth_run_get_type ())

GST_CLOTH_API GType gst_cloth_run_get_type (void);
GST_CLOTH_API GstClothRun *gst_cloth_run_copy (const GstClothRun * run);
GST_CLOTH_API void gst_cloth_run_free (GstClothRun * run);

GST_CLOTH_API GType gst_cloth_silhouette_get_type (void);
GST_CLOTH_API GstClothSilhouette *gst_cloth_silhouette_new (const gchar * camera,
    guint64 sequence, guint width, guint height, const GstClothRun * runs, guint n_runs);
GST_CLOTH_API GstClothSilhouette *gst_cloth_silhouette_ref (GstClothSilhouette * silhouette);
GST_CLOTH_API void gst_cloth_silhouette_unref (GstClothSilhouette * silhouette);
GST_CLOTH_API gboolean gst_cloth_silhouette_runs_are_valid (guint width, guint height,
    const GstClothRun * runs, guint n_runs);
GST_CLOTH_API const gchar *gst_cloth_silhouette_get_camera (const GstClothSilhouette * silhouette);
GST_CLOTH_API guint64 gst_cloth_silhouette_get_sequence (const GstClothSilhouette * silhouette);
GST_CLOTH_API guint gst_cloth_silhouette_get_width (const GstClothSilhouette * silhouette);
GST_CLOTH_API guint gst_cloth_silhouette_get_height (const GstClothSilhouette * silhouette);
GST_CLOTH_API guint gst_cloth_silhouette_get_n_runs (const GstClothSilhouette * silhouette);
GST_CLOTH_API const GstClothRun *gst_cloth_silhouette_get_runs (const GstClothSilhouette * silhouette, guint * n_runs);
GST_CLOTH_API gboolean gst_cloth_silhouette_get_run (const GstClothSilhouette * silhouette, guint index, GstClothRun * run);
GST_CLOTH_API guint gst_cloth_silhouette_get_area (const GstClothSilhouette * silhouette);
GST_CLOTH_API GBytes *gst_cloth_silhouette_get_mask (const GstClothSilhouette * silhouette);

GST_CLOTH_API GType gst_cloth_silhouette_meta_api_get_type (void);
GST_CLOTH_API const GstMetaInfo *gst_cloth_silhouette_meta_get_info (void);
GST_CLOTH_API GstClothSilhouetteMeta *gst_buffer_add_cloth_silhouette_meta (GstBuffer * buffer, GstClothSilhouette * silhouette);
GST_CLOTH_API GstClothSilhouette *gst_buffer_get_cloth_silhouette (GstBuffer * buffer);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (GstClothSilhouette, gst_cloth_silhouette_unref)
G_END_DECLS
