/* What is on a cloth: patterns and pictures from files.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/render/paint.h"

G_BEGIN_DECLS

ClothPaint *gst_cloth_paint_pattern (const gchar * path, GError ** error);
/* A picture over the whole of the flat cloth. */
ClothPaint *gst_cloth_paint_texture (const gchar * path, const gfloat * uv,
    guint n_vertices, GError ** error);
ClothPaint *gst_cloth_paint_white (void);

G_END_DECLS
