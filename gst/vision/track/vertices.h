/* The vertices of a grid in a picture, between features whose places on the cloth are known.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/match/match.h"

G_BEGIN_DECLS

/* @spread: standard deviation of a feature's place, px (0.3)
 * @reach: no vertex is placed by features that are further apart, edges of the grid (2)
 */
typedef struct {
  gdouble spread, reach;
} ClothVerticesParams;

typedef struct _ClothVertices ClothVertices;

ClothVerticesParams cloth_vertices_default_params (void);
ClothVertices *cloth_vertices_new (guint columns, guint rows, gdouble width,
    gdouble height);
void cloth_vertices_free (ClothVertices * vertices);
guint cloth_vertices_run (ClothVertices * vertices,
    const ClothVerticesParams * params, guint n, const gdouble * uv,
    const gdouble * px, ClothGridVertex * grid);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothVertices, cloth_vertices_free)
G_END_DECLS
