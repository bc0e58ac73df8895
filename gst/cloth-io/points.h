/* From the squares, dots or matches of a picture to the places of a grid's vertices in it, px.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth.h>

#include "gst/rig/merge.h"

G_BEGIN_DECLS

/* What one camera saw of a cloth with @columns by @rows vertices, picture by picture. */
typedef struct {
  guint columns, rows;
  /* of the last picture; the camera may be "" */
  const gchar *camera;
  guint64 sequence;
  ClothTriangulateView view;    /* NaN where a vertex was not seen */

  ClothMerge *merge;
  guint8 *seen;
} GstClothIoPoints;

GstClothIoPoints *gst_cloth_io_points_new (guint columns, guint rows);
/* Whether a picture carries squares, dots or matches. */
gboolean gst_cloth_io_points_has_any (GstBuffer * picture);
/* Merges the squares, dots or matches of a picture, which must have some: FALSE when they are of
 * another grid (CLOTH_FIT_ERROR). What is found belongs to the picture and to @points. */
gboolean gst_cloth_io_points_find (GstClothIoPoints * points, GstBuffer * picture,
    GError ** error);
/* FALSE when a point of the last picture lies where @camera sees nothing. */
gboolean gst_cloth_io_points_check_places (const GstClothIoPoints * points,
    const ClothCamera * camera, GError ** error);
/* Lists what a picture showed of @n vertices: which, where, px, and xx, xy, yy of the covariance, px²;
 * each has room for all. Returns: how many it showed. */
guint gst_cloth_io_points_list (const ClothTriangulateView * view, guint n,
    guint32 * vertices, gdouble * px, gdouble * covariances);
void gst_cloth_io_points_free (GstClothIoPoints * points);

/* @columns, @rows: of the grid's vertices, row * columns + column. Squares have a vertex at
 * each of their corners, so a board has one fewer of them each way. */
void gst_cloth_io_points_add_quads (const GstClothQuads * quads, guint columns,
    guint rows, ClothMerge * merge);
/* @seen: memory for columns * rows bytes. */
void gst_cloth_io_points_add_dots (const GstClothDots * dots, guint columns,
    guint rows, guint8 * seen, ClothMerge * merge);
/* Of matches the grid's points. */
void gst_cloth_io_points_add_matches (const GstClothMatches * matches,
    guint columns, guint rows, ClothMerge * merge);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (GstClothIoPoints, gst_cloth_io_points_free)
G_END_DECLS
