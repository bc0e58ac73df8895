/* Which place of the flat cloth each pixel shows: between matched places, along the surface.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/pool.h"
#include "gst/vision/match/stretch.h"

G_BEGIN_DECLS

/* Most matches of a picture. */
#define CLOTH_UV_MAX_MATCHES 1000000

/* @x: column, px
 * @y: row, px
 * @u: on the flat cloth, m
 * @v: on the flat cloth, m
 *
 * A match that is believed.
 */
typedef struct {
  gfloat x, y;
  gfloat u, v;
} ClothUVMatch;

/* @together: matches nearer to each other than this become one, their mean, px, 0 to 100
 * @outlier: a match doesn't count when it is farther from where its neighbours say than this
 *   many standard deviations, >= 1; 0: all count
 * @smooth: by which share of the way a match is moved to where its neighbours say, 0 to 1;
 *   0: the paper's, which keeps matches as they are
 * @longest: longest edge of a triangle, px, >= 1
 * @reach: how far uv goes on beyond the triangles, px, 0 to 1000
 * @stretch: of the edges of triangles; what is beyond is no surface between its ends. Its
 *   @depth_step is where the surface is broken
 *
 * Values out of range are brought into it.
 */
typedef struct {
  gdouble together;
  gdouble outlier;
  gdouble smooth;
  gdouble longest;
  gdouble reach;
  ClothStretchParams stretch;
} ClothUVParams;

/* @n_places: matches that were used, near ones together
 * @n_outliers: places that their neighbours contradict
 * @n_triangles: triangles that lie on the surface
 * @n_surface: pixels where the surface is known
 * @n_between: those that lie in the triangles and have a uv
 * @n_beyond: those that have one by what lies next to them
 * @sigma: standard deviation of a place by its neighbours, m along u or v; 0: not known
 */
typedef struct {
  guint n_places, n_outliers, n_triangles;
  guint n_surface, n_between, n_beyond;
  gdouble sigma;
} ClothUVCounts;

typedef struct _ClothUV ClothUV;

ClothUVParams cloth_uv_default_params (void);
ClothUV *cloth_uv_new (void);
void cloth_uv_free (ClothUV * self);
void cloth_uv_run (ClothUV * self, const ClothUVParams * params,
    const ClothUVMatch * matches, guint n_matches,
    const ClothMatchSurface * surface, ClothPool * pool, gfloat * uv,
    ClothUVCounts * counts);
gdouble cloth_uv_get_sigma (const ClothUV * self, guint32 pixel);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothUV, cloth_uv_free)
G_END_DECLS
