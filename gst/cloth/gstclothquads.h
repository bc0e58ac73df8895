/* Tracked squares of one picture, as buffer metadata.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth-prelude.h>

G_BEGIN_DECLS

/**
 * GstClothQuads:
 *
 * The squares of a board in one picture. Counted by reference, immutable.
 *
 * Since: 0.1
 */
typedef struct _GstClothQuads GstClothQuads;
typedef struct _GstClothQuad GstClothQuad;
typedef struct _GstClothQuadsMeta GstClothQuadsMeta;

/**
 * GstClothQuadState:
 * @GST_CLOTH_QUAD_TRACKED: its corners were measured in this picture
 * @GST_CLOTH_QUAD_PREDICTED: carried on from neighbours or earlier pictures
 * @GST_CLOTH_QUAD_LOST: it was tracked, and is not seen any more; its place is old
 *
 * What a quad's place rests on.
 *
 * Since: 0.1
 */
typedef enum {
  GST_CLOTH_QUAD_TRACKED,
  GST_CLOTH_QUAD_PREDICTED,
  GST_CLOTH_QUAD_LOST
} GstClothQuadState;

/**
 * GstClothQuad:
 * @column: column of the square on the board, from 0
 * @row: row of the square on the board, from 0
 * @state: what its place rests on
 * @black: whether the square is black
 * @confidence: −1 (the opposite of a square) to 1 (full); 0 unless tracked
 * @x: columns of its corners, px, centre of the top-left pixel at 0
 * @y: rows of its corners, px
 * @cov_xx: variance of @x, px²
 * @cov_xy: covariance of @x and @y, px²
 * @cov_yy: variance of @y, px²
 *
 * A square of the board in the picture. Corners 0..3: top-left, top-right,
 * bottom-right, bottom-left of the square as it lies on the flat cloth; corner 0 of
 * square (column, row) is vertex row·(columns + 1) + column.
 *
 * Since: 0.1
 */
struct _GstClothQuad {
  gint column, row;
  GstClothQuadState state;
  gboolean black;
  gfloat confidence;
  gfloat x[4], y[4];
  gfloat cov_xx[4], cov_xy[4], cov_yy[4];
};

/**
 * GstClothQuadsMeta:
 * @meta: parent
 * @quads: the payload, owned by the meta
 *
 * Puts quads on a picture. Tagged video, orientation and size: it is copied by
 * reference and scaled with the picture; any other transformation drops it.
 *
 * Since: 0.1
 */
struct _GstClothQuadsMeta {
  GstMeta meta;
  GstClothQuads *quads;
};

#define GST_TYPE_CLOTH_QUADS (gst_cloth_quads_get_type ())
#define GST_TYPE_CLOTH_QUAD (gst_cloth_quad_get_type ())

GST_CLOTH_API GType gst_cloth_quad_get_type (void);
GST_CLOTH_API GstClothQuad *gst_cloth_quad_copy (const GstClothQuad * quad);
GST_CLOTH_API void gst_cloth_quad_free (GstClothQuad * quad);
GST_CLOTH_API gboolean gst_cloth_quad_get_corner (const GstClothQuad * quad, guint corner,
    gfloat * x, gfloat * y, gfloat * cov_xx, gfloat * cov_xy, gfloat * cov_yy);
GST_CLOTH_API gboolean gst_cloth_quad_set_corner (GstClothQuad * quad, guint corner,
    gfloat x, gfloat y, gfloat cov_xx, gfloat cov_xy, gfloat cov_yy);

GST_CLOTH_API GType gst_cloth_quads_get_type (void);
GST_CLOTH_API GstClothQuads *gst_cloth_quads_new (const gchar * camera,
    guint64 sequence, guint columns, guint rows, const GstClothQuad * quads,
    guint n_quads);
GST_CLOTH_API GstClothQuads *gst_cloth_quads_ref (GstClothQuads * quads);
GST_CLOTH_API void gst_cloth_quads_unref (GstClothQuads * quads);
GST_CLOTH_API const gchar *gst_cloth_quads_get_camera (const GstClothQuads * quads);
GST_CLOTH_API guint64 gst_cloth_quads_get_sequence (const GstClothQuads * quads);
GST_CLOTH_API guint gst_cloth_quads_get_columns (const GstClothQuads * quads);
GST_CLOTH_API guint gst_cloth_quads_get_rows (const GstClothQuads * quads);
GST_CLOTH_API guint gst_cloth_quads_get_n_quads (const GstClothQuads * quads);
GST_CLOTH_API const GstClothQuad *gst_cloth_quads_get_quads (const GstClothQuads * quads, guint * n_quads);
GST_CLOTH_API gboolean gst_cloth_quads_get_quad (const GstClothQuads * quads, guint index, GstClothQuad * quad);
GST_CLOTH_API GBytes *gst_cloth_quads_get_points (GstClothQuads * quads);
GST_CLOTH_API GstClothQuads *gst_cloth_quads_scale (const GstClothQuads * quads, gdouble scale_x, gdouble scale_y);

GST_CLOTH_API GType gst_cloth_quads_meta_api_get_type (void);
GST_CLOTH_API const GstMetaInfo *gst_cloth_quads_meta_get_info (void);
GST_CLOTH_API GstClothQuadsMeta *gst_buffer_add_cloth_quads_meta (GstBuffer * buffer, GstClothQuads * quads);
GST_CLOTH_API GstClothQuads *gst_buffer_get_cloth_quads (GstBuffer * buffer);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (GstClothQuads, gst_cloth_quads_unref)
G_END_DECLS
