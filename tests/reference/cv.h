/* OpenCV behind plain C functions, for the benchmarks that compare with it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

gboolean cloth_cv_triangulate_points (const gdouble projections[24], guint n,
    const gdouble * x0, const gdouble * y0, const gdouble * x1,
    const gdouble * y1, gdouble * points);

G_END_DECLS
