/* Nearest points of triangles and edges.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* cloth_nearest_on_triangle () found a point within the face. */
#define CLOTH_NEAREST_FACE 6

guint cloth_nearest_on_triangle (const gdouble * a, const gdouble * b,
    const gdouble * c, const gdouble * point, gdouble weights[3]);
gboolean cloth_nearest_of_edges (const gdouble * a0, const gdouble * a1,
    const gdouble * b0, const gdouble * b1, gdouble * s, gdouble * t);

G_END_DECLS
