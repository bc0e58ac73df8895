/* A print that is like no other part of itself: a sheet of random shapes of all sizes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <cairo.h>

#include "gst/pattern/texture.h"

G_BEGIN_DECLS

/* Smallest and largest side of a sheet, metres.
 */
#define CLOTH_SHEET_MIN 0.05
#define CLOTH_SHEET_MAX 3.0

/* Most corners of a shape.
 */
#define CLOTH_SHEET_CORNERS 6

/* @n: corners
 * @grey: 0 black to 255 white
 * @radius: that of a circle around it, mm
 * @middle: x, y, mm from the sheet's top-left corner
 * @corners: (array): 2·@n, x, y, mm from the middle
 *
 * A polygon.
 */
typedef struct {
  guint8 n, grey;
  gfloat radius;
  gfloat middle[2];
  gfloat corners[2 * CLOTH_SHEET_CORNERS];
} ClothSheetShape;

/* @cloth_m: width and height, metres
 * @seed: which sheet
 * @n_shapes: how many
 * @shapes: (array length=n_shapes): from the undermost to the uppermost: the large ones
 *   first
 */
typedef struct {
  gdouble cloth_m[2];
  guint64 seed;
  guint n_shapes;
  ClothSheetShape *shapes;
} ClothSheet;

ClothSheet *cloth_sheet_new (const gdouble cloth_m[2], guint64 seed,
    GError ** error);
void cloth_sheet_free (ClothSheet * sheet);

void cloth_sheet_draw (const ClothSheet * sheet, cairo_t * cr,
    const gdouble view[4]);
ClothTexture *cloth_sheet_texture (const ClothSheet * sheet, GError ** error);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothSheet, cloth_sheet_free)
G_END_DECLS
