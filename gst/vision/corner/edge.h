/* Following the edge of a square from one of its corners to the next.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/image.h"

G_BEGIN_DECLS

gfloat cloth_edge_contrast (const ClothImage * image, gfloat ax, gfloat ay,
    gfloat bx, gfloat by);
gfloat cloth_edge_contrast_in_levels (const ClothImage * image,
    const guint8 levels[256], gfloat ax, gfloat ay, gfloat bx, gfloat by);
gboolean cloth_edge_wedge (const ClothImage * image, gfloat x, gfloat y,
    gfloat radius, gboolean black, gfloat towards, gfloat rays[2],
    gfloat * contrast);
gboolean cloth_edge_walk (const ClothImage * image, gfloat x, gfloat y,
    gfloat angle, gboolean dark_ahead, gfloat contrast, gfloat longest,
    gfloat * end_x, gfloat * end_y, gfloat * end_angle);

G_END_DECLS
