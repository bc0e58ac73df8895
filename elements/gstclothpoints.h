/* The places of a grid's vertices that squares or dots in a picture tell.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth.h>

#include "gst/rig/merge.h"

G_BEGIN_DECLS

/* @columns, @rows: of the grid's vertices, row * columns + column. Squares have a vertex at
 * each of their corners, so a board has one fewer of them each way. */
void gst_cloth_points_add_quads (const GstClothQuads * quads, guint columns,
    guint rows, ClothMerge * merge);
/* @seen: memory for columns * rows bytes. */
void gst_cloth_points_add_dots (const GstClothDots * dots, guint columns,
    guint rows, guint8 * seen, ClothMerge * merge);

G_END_DECLS
