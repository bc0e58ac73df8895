/* Draws a printed cloth as a camera films it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/simd.h"
#include "gst/rig/capture.h"
#include "gst/render/paint.h"
#include "gst/render/work.h"

G_BEGIN_DECLS

typedef struct _ClothRenderer ClothRenderer;

/* @lamp: direction from the cloth to the lamp, world; of any length but 0
 * @lamp_light: light of the lamp on a cloth that faces it
 * @ambient_light: light from everywhere
 * @through: share of the lamp's light that passes through the cloth to its other side
 * @two_sided: whether the back shows the print, too: mirrored, as where it soaks through
 * @back: what the back of the cloth reflects where it carries no print
 * @background: light of the background at the top and at the bottom of the picture
 *
 * How the cloth is lit (Lambert's law). A light of 1 on a white cloth is the brightest
 * that a picture can show.
 */
typedef struct {
  gdouble lamp[3];
  gdouble lamp_light;
  gdouble ambient_light;
  gdouble through;
  gboolean two_sided;
  gdouble back;
  gdouble background[2];
} ClothRenderStyle;

/* @width: pixels a row
 * @height: rows
 * @n_channels: 1, or 3 for red, green, blue
 * @data: (array): the planes, one after the other; each @height·@width
 *
 * The light that falls on a sensor; 1 is the brightest that a picture can show.
 */
typedef struct {
  gint width, height;
  guint n_channels;
  gfloat *data;
} ClothLight;

void cloth_render_style_init (ClothRenderStyle * style);

ClothRenderer *cloth_renderer_new (guint n_vertices, const gfloat * uv,
    const guint32 * faces, guint n_faces, guint threads, ClothSimd simd);
void cloth_renderer_free (ClothRenderer * renderer);
const ClothLight *cloth_renderer_draw (ClothRenderer * renderer,
    const ClothPaint * paint, const ClothCapture * capture,
    const ClothRenderStyle * style, const ClothMotion * motion,
    gdouble time_s, ClothWork * work);
void cloth_renderer_develop (ClothRenderer * renderer,
    const ClothCapture * capture, guint64 frame, guint64 seed,
    guint n_planes, guint8 * const *planes, const gint * strides,
    gint pixel_stride, const ClothWork * work);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothRenderer, cloth_renderer_free)
G_END_DECLS
