/* Where a picture shows the vertices of a printed cloth's grid: first by the matched features
 * around each, then by the print itself.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/pool.h"
#include "gst/math/simd.h"
#include "gst/vision/image.h"
#include "gst/vision/match/align.h"
#include "gst/vision/match/grow.h"
#include "gst/vision/match/reference.h"
#include "gst/vision/match/stretch.h"
#include "gst/vision/match/warp.h"

G_BEGIN_DECLS

/* Most columns and rows of a grid. */
#define CLOTH_GRID_MAX 4096

/* @columns: of vertices, 2 to %CLOTH_GRID_MAX
 * @rows: 2 to %CLOTH_GRID_MAX
 * @cloth_m: width and height of the flat picture on the cloth, m, > 0
 *
 * Vertex row·@columns + column lies at u = column·width / (@columns − 1) and
 * v = row·height / (@rows − 1) from the picture's top-left edge.
 */
typedef struct {
  gint columns, rows;
  gdouble cloth_m[2];
} ClothGridShape;

/* @x: column in the film, px
 * @y: row, px
 * @u: on the flat cloth, m from the left edge of the flat picture
 * @v: m from its top edge
 * @metres_per_pixel: of the cloth in the film, by the scales of the two features, > 0
 * @mirrored: whether it is seen from behind
 */
typedef struct {
  gfloat x, y, u, v;
  gfloat metres_per_pixel;
  gboolean mirrored;
} ClothGridMatch;

/* @reach: longest edge of a triangle of matches, px
 * @stretch: the bounds of an edge's length on the flat cloth
 * @beyond: how far beyond triangles vertices are looked for, px
 * @radius: matches so near to a vertex tell its place, px
 * @most: of these so many, the nearest ones
 * @least: fewer that agree don't tell a place
 * @noise: standard deviation of a match's place, px
 * @bend: standard deviation of half the second derivatives of the places, by which the
 *   cloth's bending and perspective show, 1/px
 * @outlier: a match so far off counts half, px
 * @rival: a place with as large a share of the support of another contradicts it, 0 to 1
 * @uncertain: what leaves a vertex a greater standard deviation doesn't tell it, px
 * @align: how a place is found by the print
 */
typedef struct {
  gdouble reach;
  ClothStretchParams stretch;
  gdouble beyond, radius;
  guint most, least;
  gdouble noise, bend, outlier, rival, uncertain;
  ClothAlignParams align;
} ClothGridParams;

/* @CLOTH_GRID_UNSEEN: the picture doesn't show it, or not clearly
 * @CLOTH_GRID_MATCHED: placed by the matches around it
 * @CLOTH_GRID_ALIGNED: placed by the print around it
 * @CLOTH_GRID_FOLLOWED: placed by the flow from the picture before
 */
typedef enum {
  CLOTH_GRID_UNSEEN,
  CLOTH_GRID_MATCHED,
  CLOTH_GRID_ALIGNED,
  CLOTH_GRID_FOLLOWED
} ClothGridState;

/* @state: how it was found
 * @mirrored: whether it is seen from behind
 * @x: column in the film, px; NaN where unseen
 * @y: row
 * @xx: covariance, px²
 * @xy: covariance
 * @yy: covariance
 */
typedef struct {
  ClothGridState state;
  gboolean mirrored;
  gdouble x, y;
  gdouble xx, xy, yy;
} ClothGridVertex;

/* @n_aligned: vertices placed by the print
 * @n_matched: by matches only
 * @n_contradicted: that seem to be at two places at once by the matches; they are left out
 *   unless the print beside an aligned neighbour shows them
 */
typedef struct {
  guint n_aligned, n_matched, n_contradicted;
} ClothGridding;

typedef struct _ClothGridder ClothGridder;

ClothGridParams cloth_grid_default_params (void);
ClothGridder *cloth_gridder_new (const ClothGridShape * shape,
    const ClothImage * reference, GError ** error);
void cloth_gridder_free (ClothGridder * gridder);
void cloth_gridder_run (ClothGridder * gridder,
    const ClothGridParams * params, const ClothGridMatch * matches,
    guint n_matches, const ClothImage * film, const ClothImage * mask,
    const ClothMatchSurface * surface, ClothGridVertex * vertices,
    ClothGridding * gridding, ClothPool * pool, ClothSimd level);
guint cloth_grid_get_matches (const ClothReference * reference,
    const gdouble cloth_m[2], const ClothCvFeatures * features,
    const ClothMatch * matches, ClothGridMatch * to);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothGridder, cloth_gridder_free)
G_END_DECLS
