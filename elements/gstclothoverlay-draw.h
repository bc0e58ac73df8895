/* clothoverlay: silhouettes, squares, saddles and dots from their metadata into a video frame.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth.h>
#include <gst/video/video.h>

#include "gst/render/draw.h"

G_BEGIN_DECLS

typedef enum {
  GST_CLOTH_OVERLAY_MESH_WIREFRAME,
  GST_CLOTH_OVERLAY_MESH_SHADED
} GstClothOverlayMeshStyle;

/* The properties of the element that say how things look. */
typedef struct {
  gboolean draw_silhouette, draw_saddles, draw_quads, draw_dots, draw_indices, draw_mesh, draw_gap;
  gfloat line_width, opacity, fill_opacity, c_low, ellipse_scale;
  guint gap_scale;              /* mm */
  GstClothOverlayMeshStyle mesh_style;
} GstClothOverlayStyle;

/* What is cloth in @silhouette, tinted and with its border, on a picture of @width by
 * @height px. */
void gst_cloth_overlay_draw_silhouette (const ClothCanvas * canvas, gint width,
    gint height, const GstClothSilhouette * silhouette,
    const GstClothOverlayStyle * style);

/* A canvas on the mapped frame, colours by its colorimetry. */
void gst_cloth_overlay_canvas (GstVideoFrame * frame, ClothCanvas * canvas);
void gst_cloth_overlay_draw_quads (const ClothCanvas * canvas,
    const GstClothQuad * quads, guint n, const GstClothOverlayStyle * style);
void gst_cloth_overlay_draw_saddles (const ClothCanvas * canvas,
    GstClothSaddles * saddles, const GstClothOverlayStyle * style);

/* Labelled dots and the links between neighbours of the pattern; crosses on the others.
 * @by_label is room for finding neighbours, kept over the pictures of a film. */
void gst_cloth_overlay_draw_dots (const ClothCanvas * canvas,
    GstClothDots * dots, GArray * places,
    const GstClothOverlayStyle * style);

G_END_DECLS
