/* Places of a print that a picture shows, as buffer metadata.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth-prelude.h>

G_BEGIN_DECLS

/**
 * GstClothMatches:
 *
 * The features of one picture and the places of the print that they show, and the vertices of
 * the pattern's grid. Counted by reference, immutable.
 *
 * Since: 0.1
 */
typedef struct _GstClothMatches GstClothMatches;
typedef struct _GstClothMatch GstClothMatch;
typedef struct _GstClothGridPoint GstClothGridPoint;
typedef struct _GstClothMatchesMeta GstClothMatchesMeta;

/**
 * GstClothMatch:
 * @x: column of the feature, px, centre of the top-left pixel at 0
 * @y: row of the feature, px
 * @u: where on the flat cloth it is, from the print's left edge, m
 * @v: from its upper edge, m
 * @scale: blur at which the feature was found, px
 * @distance: how far it is from the feature of the print, in feature space; 0: they are equal
 * @group: number of the seed that it grew from
 * @oblique: whether it is like the print seen obliquely rather than flat
 * @mirrored: whether its part of the print is seen from behind: as in a mirror
 * @verified: whether its neighbours bear it out
 *
 * A feature of the picture and the place of the print that it shows.
 *
 * Since: 0.1
 */
struct _GstClothMatch {
  gfloat x, y;
  gfloat u, v;
  gfloat scale;
  gfloat distance;
  guint group;
  gboolean oblique;
  gboolean mirrored;
  gboolean verified;
};

/**
 * GstClothGridPoint:
 * @column: column of the vertex in the pattern, from 0
 * @row: row of the vertex in the pattern, from 0
 * @mirrored: whether it is seen from behind
 * @x: column in the picture, px, centre of the top-left pixel at 0
 * @y: row in the picture, px
 * @cov_xx: variance of @x, px²
 * @cov_xy: covariance of @x and @y, px²
 * @cov_yy: variance of @y, px²
 *
 * Where the picture shows a vertex of the pattern's grid. Its vertex in the mesh is
 * row·columns + column.
 *
 * Since: 0.1
 */
struct _GstClothGridPoint {
  gint column, row;
  gboolean mirrored;
  gfloat x, y;
  gfloat cov_xx, cov_xy, cov_yy;
};

/**
 * GstClothMatchesMeta:
 * @meta: parent
 * @matches: the payload, owned by the meta
 *
 * Puts matches on a picture. Tagged video, orientation and size: it is copied by reference
 * and scaled with the picture; any other transformation drops it.
 *
 * Since: 0.1
 */
struct _GstClothMatchesMeta {
  GstMeta meta;
  GstClothMatches *matches;
};

#define GST_TYPE_CLOTH_MATCHES (gst_cloth_matches_get_type ())
#define GST_TYPE_CLOTH_MATCH (gst_cloth_match_get_type ())
#define GST_TYPE_CLOTH_GRID_POINT (gst_cloth_grid_point_get_type ())

GST_CLOTH_API GType gst_cloth_match_get_type (void);
GST_CLOTH_API GstClothMatch *gst_cloth_match_copy (const GstClothMatch * match);
GST_CLOTH_API void gst_cloth_match_free (GstClothMatch * match);

GST_CLOTH_API GType gst_cloth_grid_point_get_type (void);
GST_CLOTH_API GstClothGridPoint *gst_cloth_grid_point_copy (const GstClothGridPoint * point);
GST_CLOTH_API void gst_cloth_grid_point_free (GstClothGridPoint * point);

GST_CLOTH_API GType gst_cloth_matches_get_type (void);
GST_CLOTH_API GstClothMatches *gst_cloth_matches_new (const gchar * camera,
    guint64 sequence, guint columns, guint rows, guint n_features, gboolean on_surface,
    const GstClothMatch * matches, guint n_matches, const GstClothGridPoint * points,
    guint n_points);
GST_CLOTH_API GstClothMatches *gst_cloth_matches_ref (GstClothMatches * matches);
GST_CLOTH_API void gst_cloth_matches_unref (GstClothMatches * matches);
GST_CLOTH_API const gchar *gst_cloth_matches_get_camera (const GstClothMatches * matches);
GST_CLOTH_API guint64 gst_cloth_matches_get_sequence (const GstClothMatches * matches);
GST_CLOTH_API guint gst_cloth_matches_get_columns (const GstClothMatches * matches);
GST_CLOTH_API guint gst_cloth_matches_get_rows (const GstClothMatches * matches);
GST_CLOTH_API guint gst_cloth_matches_get_n_features (const GstClothMatches * matches);
GST_CLOTH_API gboolean gst_cloth_matches_get_on_surface (const GstClothMatches * matches);
GST_CLOTH_API guint gst_cloth_matches_get_n_matches (const GstClothMatches * matches);
GST_CLOTH_API guint gst_cloth_matches_get_n_points (const GstClothMatches * matches);
GST_CLOTH_API const GstClothMatch *gst_cloth_matches_get_matches (const GstClothMatches * matches, guint * n_matches);
GST_CLOTH_API gboolean gst_cloth_matches_get_match (const GstClothMatches * matches, guint index, GstClothMatch * match);
GST_CLOTH_API const GstClothGridPoint *gst_cloth_matches_get_points (const GstClothMatches * matches, guint * n_points);
GST_CLOTH_API gboolean gst_cloth_matches_get_point (const GstClothMatches * matches, guint index, GstClothGridPoint * point);
GST_CLOTH_API GBytes *gst_cloth_matches_get_table (GstClothMatches * matches);
GST_CLOTH_API GstClothMatches *gst_cloth_matches_scale (const GstClothMatches * matches, gdouble scale_x, gdouble scale_y);

GST_CLOTH_API GType gst_cloth_matches_meta_api_get_type (void);
GST_CLOTH_API const GstMetaInfo *gst_cloth_matches_meta_get_info (void);
GST_CLOTH_API GstClothMatchesMeta *gst_buffer_add_cloth_matches_meta (GstBuffer * buffer, GstClothMatches * matches);
GST_CLOTH_API GstClothMatches *gst_buffer_get_cloth_matches (GstBuffer * buffer);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (GstClothMatches, gst_cloth_matches_unref)
G_END_DECLS
