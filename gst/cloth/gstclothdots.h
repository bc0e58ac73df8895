/* Coloured dots of one picture, as buffer metadata.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth-prelude.h>

G_BEGIN_DECLS

/**
 * GST_CLOTH_DOT_MAX_COLOURS:
 *
 * Most colours that a pattern of dots may have.
 *
 * Since: 0.1
 */
#define GST_CLOTH_DOT_MAX_COLOURS 8

/**
 * GstClothDots:
 *
 * The coloured dots of one picture. Counted by reference, immutable.
 *
 * Since: 0.1
 */
typedef struct _GstClothDots GstClothDots;
typedef struct _GstClothDot GstClothDot;
typedef struct _GstClothDotsMeta GstClothDotsMeta;

/**
 * GstClothDot:
 * @column: column of the dot in the pattern, from 0; −1 when it has no label
 * @row: row of the dot in the pattern, from 0; −1 when it has no label
 * @mirrored: whether its part of the pattern is seen from behind: as in a mirror
 * @touches: whether it runs into another dot or spot; its covariance then says too little
 * @confidence: log-odds of the label, nats; 0 without one
 * @x: column of its centre, px, centre of the top-left pixel at 0
 * @y: row of its centre, px
 * @cov_xx: variance of @x, px²
 * @cov_xy: covariance of @x and @y, px²
 * @cov_yy: variance of @y, px²
 * @log_likelihood: natural logarithm of how likely its colour is under each colour of the
 *   pattern, up to a constant of the dot; 0 beyond the pattern's colours
 *
 * A dot in the picture. Its vertex in the mesh is row·columns + column.
 *
 * Since: 0.1
 */
struct _GstClothDot {
  gint column, row;
  gboolean mirrored;
  gboolean touches;
  gfloat confidence;
  gfloat x, y;
  gfloat cov_xx, cov_xy, cov_yy;
  gfloat log_likelihood[GST_CLOTH_DOT_MAX_COLOURS];
};

/**
 * GstClothDotsMeta:
 * @meta: parent
 * @dots: the payload, owned by the meta
 *
 * Puts dots on a picture. Tagged video, orientation and size: it is copied by reference
 * and scaled with the picture; any other transformation drops it.
 *
 * Since: 0.1
 */
struct _GstClothDotsMeta {
  GstMeta meta;
  GstClothDots *dots;
};

#define GST_TYPE_CLOTH_DOTS (gst_cloth_dots_get_type ())
#define GST_TYPE_CLOTH_DOT (gst_cloth_dot_get_type ())

GST_CLOTH_API GType gst_cloth_dot_get_type (void);
GST_CLOTH_API GstClothDot *gst_cloth_dot_copy (const GstClothDot * dot);
GST_CLOTH_API void gst_cloth_dot_free (GstClothDot * dot);
GST_CLOTH_API gboolean gst_cloth_dot_get_log_likelihood (const GstClothDot * dot, guint colour,
    gfloat * log_likelihood);
GST_CLOTH_API gboolean gst_cloth_dot_set_log_likelihood (GstClothDot * dot, guint colour,
    gfloat log_likelihood);

GST_CLOTH_API GType gst_cloth_dots_get_type (void);
GST_CLOTH_API GstClothDots *gst_cloth_dots_new (const gchar * camera,
    guint64 sequence, guint columns, guint rows, guint n_colours,
    const GstClothDot * dots, guint n_dots);
GST_CLOTH_API GstClothDots *gst_cloth_dots_ref (GstClothDots * dots);
GST_CLOTH_API void gst_cloth_dots_unref (GstClothDots * dots);
GST_CLOTH_API const gchar *gst_cloth_dots_get_camera (const GstClothDots * dots);
GST_CLOTH_API guint64 gst_cloth_dots_get_sequence (const GstClothDots * dots);
GST_CLOTH_API guint gst_cloth_dots_get_columns (const GstClothDots * dots);
GST_CLOTH_API guint gst_cloth_dots_get_rows (const GstClothDots * dots);
GST_CLOTH_API guint gst_cloth_dots_get_n_colours (const GstClothDots * dots);
GST_CLOTH_API guint gst_cloth_dots_get_n_dots (const GstClothDots * dots);
GST_CLOTH_API const GstClothDot *gst_cloth_dots_get_dots (const GstClothDots * dots, guint * n_dots);
GST_CLOTH_API gboolean gst_cloth_dots_get_dot (const GstClothDots * dots, guint index, GstClothDot * dot);
GST_CLOTH_API GBytes *gst_cloth_dots_get_points (GstClothDots * dots);
GST_CLOTH_API GstClothDots *gst_cloth_dots_scale (const GstClothDots * dots, gdouble scale_x, gdouble scale_y);

GST_CLOTH_API GType gst_cloth_dots_meta_api_get_type (void);
GST_CLOTH_API const GstMetaInfo *gst_cloth_dots_meta_get_info (void);
GST_CLOTH_API GstClothDotsMeta *gst_buffer_add_cloth_dots_meta (GstBuffer * buffer, GstClothDots * dots);
GST_CLOTH_API GstClothDots *gst_buffer_get_cloth_dots (GstBuffer * buffer);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (GstClothDots, gst_cloth_dots_unref)
G_END_DECLS
