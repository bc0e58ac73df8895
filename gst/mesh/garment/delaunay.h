/* Delaunay triangles of points in the plane.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

GArray *cloth_delaunay (guint n, const gdouble * points, gdouble scale);

G_END_DECLS
