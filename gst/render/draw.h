/* Anti-aliased drawing on 8-bit pictures of any layout.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/render/work.h"

G_BEGIN_DECLS

/* @r: red, 0 … 1
 * @g: green, 0 … 1
 * @b: blue, 0 … 1
 * @a: opacity, 0 … 1
 *
 * Gamma-encoded, not premultiplied.
 */
typedef struct {
  gfloat r, g, b, a;
} ClothColour;

/* @data: first sample
 * @stride: bytes from one row to the next
 * @step: bytes from one sample to the next of its row
 * @width: samples a row
 * @height: rows
 * @shift_x: binary logarithm of the horizontal subsampling
 * @shift_y: binary logarithm of the vertical subsampling
 * @weights: sample value 0 … 255 of a colour: w[0]·r + w[1]·g + w[2]·b + w[3]
 *
 * One colour component of a picture: luma, a chroma difference, red, …
 */
typedef struct {
  guint8 *data;
  gint stride, step;
  gint width, height;
  gint shift_x, shift_y;
  gfloat weights[4];
} ClothComponent;

/* @n_components: 1 … 4
 * @components: components of equal subsampling next to each other
 * @work: (nullable): how much may be drawn; owned by whom the canvas is from
 *
 * A picture to draw on; owns nothing. All coordinates are full-resolution pixels with
 * the centre of the top-left pixel at (0, 0). Whatever lies outside is clipped; shapes
 * with coordinates that are not finite are not drawn.
 */
typedef struct {
  guint n_components;
  ClothComponent components[4];
  ClothWork *work;
} ClothCanvas;

void cloth_draw_line (const ClothCanvas * canvas, gfloat x0, gfloat y0,
    gfloat x1, gfloat y1, gfloat width, const ClothColour * colour);
void cloth_draw_dashes (const ClothCanvas * canvas, gfloat x0, gfloat y0,
    gfloat x1, gfloat y1, gfloat width, gfloat dash,
    const ClothColour * colour);
void cloth_draw_quad (const ClothCanvas * canvas, const gfloat x[4],
    const gfloat y[4], const ClothColour * colour);
void cloth_draw_ellipse (const ClothCanvas * canvas, gfloat x, gfloat y,
    gfloat xx, gfloat xy, gfloat yy, gfloat width, const ClothColour * colour);
void cloth_draw_number (const ClothCanvas * canvas, gint number,
    const gfloat origin[2], const gfloat right[2], const gfloat down[2],
    gfloat width, const ClothColour * colour);

ClothColour cloth_draw_confidence_colour (gfloat confidence, gfloat low);

/* Colours of a heat map. */
#define CLOTH_DRAW_HEATS 65

void cloth_draw_heat_colours (ClothColour colours[CLOTH_DRAW_HEATS]);
void cloth_draw_heats (const gfloat * residuals, guint n, guint scale_mm,
    guint8 * heats);

/* Colours of strain. */
#define CLOTH_DRAW_STRAINS 64

void cloth_draw_strain_colours (ClothColour colours[CLOTH_DRAW_STRAINS]);
void cloth_draw_strains (const gfloat * strains, guint n, guint step,
    guint scale_percent, guint8 * colours);
void cloth_draw_scale (const ClothCanvas * canvas, gint width, gint height,
    const ClothColour * colours, guint n, gint low, gint high, gfloat opacity);

G_END_DECLS
