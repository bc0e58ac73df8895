/* What is printed on a cloth, ready to be looked at from any distance.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* Most pixels a picture on the cloth may have each way.
 */
#define CLOTH_PAINT_MAX_PX 8192

#define CLOTH_PAINT_MAX_LEVELS 15

/* @width: pixels a row
 * @height: rows
 * @data: reflected share of the light, @height·@width·channels
 * @flat: 1 where everything under the pixel and its eight neighbours is of one value
 *
 * The picture at one scale: each pixel is the mean over 2×2 of the level before.
 */
typedef struct {
  gint width, height;
  gfloat *data;
  guint8 *flat;
} ClothPaintLevel;

/* @n_channels: 1 for grey, 3 for red, green, blue
 * @origin_uv_m: place of the picture's top-left corner on the flat cloth, m
 * @px_per_m: its scale along u and v
 * @n_levels: number of @levels, >= 1
 * @levels: from fine to coarse
 *
 * A picture printed on a cloth, in linear light. Beyond its edge its outermost pixels
 * go on.
 */
typedef struct {
  guint n_channels;
  gdouble origin_uv_m[2];
  gdouble px_per_m[2];
  guint n_levels;
  ClothPaintLevel levels[CLOTH_PAINT_MAX_LEVELS];
} ClothPaint;

ClothPaint *cloth_paint_new (const guint8 * data, gint width, gint height,
    gint stride, guint n_channels, const gfloat * light,
    const gdouble origin_uv_m[2], const gdouble size_m[2]);
void cloth_paint_free (ClothPaint * paint);

gfloat cloth_light_from_level (guint8 level);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothPaint, cloth_paint_free)
G_END_DECLS
