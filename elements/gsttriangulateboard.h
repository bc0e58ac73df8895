/* The printed board as triangulate sees it: squares in, a grid of vertices out.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth.h>

#include "gst/pattern/pattern.h"
#include "gst/rig/merge.h"

G_BEGIN_DECLS

/* A grid with a vertex for each corner of the squares, uv at the board's place on the
 * cloth. */
GstClothTopology *gst_triangulate_board_to_topology (const ClothPattern *
    pattern, GError ** error);
/* Adds the corners of the squares that pad @index tracks to @merge; %FALSE, after an
 * element error, when they are of another board. */
gboolean gst_triangulate_board_take (GstElement * self, guint index,
    const ClothPattern * pattern, GstClothQuads * quads, ClothMerge * merge);

G_END_DECLS
