/* The path data of SVG as a line of points.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/file/file.h"

G_BEGIN_DECLS

gboolean cloth_svg_path_parse (const gchar * data, gdouble tolerance,
    guint most_points, GArray * points, GError ** error);

G_END_DECLS
