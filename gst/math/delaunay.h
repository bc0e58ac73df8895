/* Delaunay triangles of points in the plane.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

typedef struct _ClothDelaunay ClothDelaunay;

ClothDelaunay *cloth_delaunay_new (void);
void cloth_delaunay_free (ClothDelaunay * delaunay);
guint *cloth_delaunay_run (ClothDelaunay * delaunay, guint n,
    const gdouble * points, gdouble scale, guint * n_triangles);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothDelaunay, cloth_delaunay_free)
G_END_DECLS
