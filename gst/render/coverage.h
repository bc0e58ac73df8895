/* What of a mesh each pixel of a camera sees.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/pool.h"
#include "gst/rig/camera.h"

G_BEGIN_DECLS

/* In place of a triangle: the pixel sees none. */
#define CLOTH_COVERAGE_NONE G_MAXUINT32

/* A lens bends the edges of triangles. They are cut so that no straight piece is further off its
 * curve than this, px, or into so many. */
#define CLOTH_COVERAGE_BEND_PX 0.05
#define CLOTH_COVERAGE_MOST_CUTS 16

/* @n_triangles: of the mesh; a face of four corners makes two
 * @triangles: (array length=n_triangles): their corners
 * @width: of the picture, px
 * @height: of the picture, px
 * @seen: the triangle that the centre of each pixel sees, row by row, or %CLOTH_COVERAGE_NONE
 * @places: where in that triangle: 2 numbers a pixel, the barycentric weights of its second and
 *   third corner; anything where none is seen
 * @bend_px: how far edges are off the curve that the lens makes of them, at most, px
 *
 * Of the picture that was drawn last.
 */
typedef struct {
  guint n_triangles;
  guint32 (*triangles)[3];
  gint width, height;
  guint32 *seen;
  gfloat *places;
  gdouble bend_px;
} ClothCoverage;

ClothCoverage *cloth_coverage_new (guint n_vertices, const guint32 * faces,
    guint n_faces);
void cloth_coverage_free (ClothCoverage * coverage);
void cloth_coverage_draw (ClothCoverage * coverage, const ClothCamera * camera,
    const gdouble * positions, ClothPool * pool);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothCoverage, cloth_coverage_free)
G_END_DECLS
