/* clothoverlay: squares and saddles from their metadata into a video frame.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth.h>
#include <gst/video/video.h>
#include "gst/vision/draw.h"

G_BEGIN_DECLS

/* The properties of the element that say how things look. */
typedef struct {
  gboolean draw_saddles, draw_quads, draw_indices, draw_mesh;
  gfloat line_width, opacity, fill_opacity, c_low, ellipse_scale;
} GstClothOverlayStyle;

/* A canvas on the mapped frame, colours by its colorimetry. */
void gst_cloth_overlay_canvas (GstVideoFrame * frame, ClothCanvas * canvas);
void gst_cloth_overlay_draw_quads (const ClothCanvas * canvas,
    const GstClothQuad * quads, guint n, const GstClothOverlayStyle * style);
void gst_cloth_overlay_draw_saddles (const ClothCanvas * canvas,
    GstClothSaddles * saddles, const GstClothOverlayStyle * style);

G_END_DECLS
