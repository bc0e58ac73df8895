/* Tracked squares of one picture, as buffer metadata.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth-prelude.h>

G_BEGIN_DECLS

typedef struct _GstClothQuads GstClothQuads;
typedef struct _GstClothQuad GstClothQuad;
typedef struct _GstClothQuadsMeta GstClothQuadsMeta;

typedef enum {
  GST_CLOTH_QUAD_TRACKED,
  GST_CLOTH_QUAD_PREDICTED,
  GST_CLOTH_QUAD_LOST
} GstClothQuadState;

/* Corners 0..3: top-left, top-right, bottom-right, bottom-left of the square as it lies
 * on the flat cloth; corner 0 of square (column, row) is vertex
 * row * (columns + 1) + column. */
struct _GstClothQuad {
  gint column, row;
  GstClothQuadState state;
  gboolean black;
  gfloat confidence;
  gfloat x[4], y[4];
  gfloat cov_xx[4], cov_xy[4], cov_yy[4];
};

struct _GstClothQuadsMeta {
  GstMeta meta;
  GstClothQuads *quads;
};

#define GST_TYPE_CLOTH_QUADS (gst_cloth_quads_get_type ())

GST_CLOTH_API GType gst_cloth_quads_get_type (void);
/* columns, rows: squares of the whole board */
GST_CLOTH_API GstClothQuads *gst_cloth_quads_new (const gchar * camera,
    guint64 sequence, guint columns, guint rows, const GstClothQuad * quads,
    guint n_quads);
GST_CLOTH_API GstClothQuads *gst_cloth_quads_ref (GstClothQuads * quads);
GST_CLOTH_API void gst_cloth_quads_unref (GstClothQuads * quads);
GST_CLOTH_API const gchar *gst_cloth_quads_get_camera (const GstClothQuads * quads);
GST_CLOTH_API guint64 gst_cloth_quads_get_sequence (const GstClothQuads * quads);
GST_CLOTH_API guint gst_cloth_quads_get_columns (const GstClothQuads * quads);
GST_CLOTH_API guint gst_cloth_quads_get_rows (const GstClothQuads * quads);
GST_CLOTH_API const GstClothQuad *gst_cloth_quads_get_quads (const GstClothQuads * quads, guint * n_quads);

GST_CLOTH_API GType gst_cloth_quads_meta_api_get_type (void);
GST_CLOTH_API const GstMetaInfo *gst_cloth_quads_meta_get_info (void);
/* takes the reference */
GST_CLOTH_API GstClothQuadsMeta *gst_buffer_add_cloth_quads_meta (GstBuffer * buffer, GstClothQuads * quads);
/* borrowed; NULL when the buffer has none */
GST_CLOTH_API GstClothQuads *gst_buffer_get_cloth_quads (GstBuffer * buffer);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (GstClothQuads, gst_cloth_quads_unref)
G_END_DECLS
