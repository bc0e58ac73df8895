/* The vertices of a cloth's grid in space, by uv and the surface of a picture.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/match/grid.h"
#include "gst/vision/uv/dense.h"

G_BEGIN_DECLS

/* @radius: how far on the flat cloth around a vertex uv and depth are fitted, m, > 0
 * @edge: a vertex is as far beyond the pixels with a uv at most, m, >= 0
 * @rival: a vertex is unseen when this share of the pixels that show it lie elsewhere in
 *   space, 0 to 1
 * @correlation: over how many px disparities err alike, >= 1
 * @noise: least standard deviation of uv along u or v, m
 *
 * Values out of range are brought into it.
 */
typedef struct {
  gdouble radius, edge, rival, correlation, noise;
} ClothUVVertexParams;

/* @sigma: standard deviation of a disparity, px
 * @focal_baseline: depth along @normal times disparity, px·m, > 0
 * @normal: unit axis along which depth is measured, camera frame
 *
 * How sure the surface is.
 */
typedef struct {
  gdouble sigma, focal_baseline;
  gdouble normal[3];
} ClothUVDepth;

/* @vertex: row·columns + column
 * @x: column in the picture, px
 * @y: row, px
 * @xx: covariance, px²
 * @xy: covariance
 * @yy: covariance
 *
 * A vertex whose place in the picture is known better than by uv.
 */
typedef struct {
  guint vertex;
  gdouble x, y;
  gdouble xx, xy, yy;
} ClothUVSpot;

/* @seen: whether it is known
 * @point: m, camera frame
 * @covariance: xx, xy, xz, yy, yz, zz, m²
 */
typedef struct {
  gboolean seen;
  gdouble point[3];
  gdouble covariance[6];
} ClothUVVertex;

typedef struct _ClothUVVertices ClothUVVertices;

ClothUVVertexParams cloth_uv_vertex_default_params (void);
ClothUVVertices *cloth_uv_vertices_new (void);
void cloth_uv_vertices_free (ClothUVVertices * self);
guint cloth_uv_vertices_run (ClothUVVertices * self,
    const ClothUVVertexParams * params, const ClothGridShape * shape,
    const ClothMatchSurface * surface, const gfloat * uv, const ClothUV * dense,
    const ClothUVDepth * depth, const ClothUVSpot * spots, guint n_spots,
    ClothUVVertex * vertices);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothUVVertices, cloth_uv_vertices_free)
G_END_DECLS
