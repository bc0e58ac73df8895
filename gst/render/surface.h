/* A mesh drawn into a camera's picture as a shaded, printed surface.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/camera.h"
#include "gst/render/draw.h"
#include "gst/render/paint.h"
#include "gst/render/render.h"

G_BEGIN_DECLS

/* The triangles of one mesh with what is printed on it, and the buffers that drawing it
 * over a film needs. Made for speed: one look at each pixel, edges are not smoothed, and
 * light and lens are exact at the vertices only. #ClothRenderer is the one that films.
 */
typedef struct _ClothSurface ClothSurface;

ClothSurface *cloth_surface_new (guint n_vertices, const gfloat * uv,
    const guint32 * faces, guint n_faces, const ClothPaint * paint,
    ClothSimd simd);
void cloth_surface_free (ClothSurface * surface);
void cloth_surface_draw (ClothSurface * surface, const ClothCanvas * canvas,
    gint width, gint height, const ClothCamera * camera,
    const gfloat * positions, const ClothRenderStyle * style, gfloat opacity);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothSurface, cloth_surface_free)
G_END_DECLS
