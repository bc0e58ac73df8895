/* The printed cloth as a picture.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/pattern/marray.h"

G_BEGIN_DECLS

/* Most pixels a texture may have each way.
 */
#define CLOTH_TEXTURE_MAX_PX 16384

/* @width: pixels a row
 * @height: rows
 * @n_channels: 1 for grey; 3 for red, green, blue, one after the other
 * @data: (array): @height·@width·@n_channels values
 * @px_per_m: scale; pixel (x, y) is the mean over the square of cloth from
 *   (x, y) / @px_per_m to (x + 1, y + 1) / @px_per_m
 */
typedef struct {
  gint width, height;
  gint n_channels;
  guint8 *data;
  gdouble px_per_m;
} ClothTexture;

ClothTexture *cloth_pattern_texture (const ClothPattern * pattern,
    gdouble px_per_m, guint8 black, guint8 white, GError ** error);
ClothTexture *cloth_m_array_texture (const ClothMArray * array,
    gdouble px_per_m, guint8 ground, const guint8 (*inks)[3], GError ** error);
GBytes *cloth_texture_to_png (const ClothTexture * texture, GError ** error);
void cloth_texture_free (ClothTexture * texture);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothTexture, cloth_texture_free)
G_END_DECLS
