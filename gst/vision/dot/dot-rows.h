/* What dot detection does to every pixel.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/cpu.h"
#include "gst/vision/image.h"

G_BEGIN_DECLS

/* Edge of a tile, px. */
#define CLOTH_DOT_TILE 16

void cloth_dot_tile_bounds (const ClothImage * image, gint tile_row,
    guint8 * least, guint8 * most, ClothSimd level);
void cloth_dot_row_bits (const guint8 * row, gint width,
    const guint8 * thresholds, guint16 * bits, ClothSimd level);

G_END_DECLS
