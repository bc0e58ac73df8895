/* Views of a flat board: homography, focal length, pose.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

gboolean cloth_planar_homography (guint n, const gdouble * X,
    const gdouble * Y, const gdouble * x, const gdouble * y, gdouble H[9]);
gboolean cloth_planar_focal (guint n_views, const gdouble * H, gdouble cx,
    gdouble cy, gdouble focal[2]);
gboolean cloth_planar_pose (const gdouble H[9], gdouble R[9], gdouble t[3]);

G_END_DECLS
