/* clothoverlay: squares and saddles from their metadata into a video frame.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth.h>
#include <gst/video/video.h>
#include "gst/rig/camera.h"
#include "gst/render/draw.h"

G_BEGIN_DECLS

typedef enum {
  GST_CLOTH_OVERLAY_MESH_WIREFRAME,
  GST_CLOTH_OVERLAY_MESH_SHADED
} GstClothOverlayMeshStyle;

GType gst_cloth_overlay_mesh_style_get_type (void);

/* The properties of the element that say how things look. */
typedef struct {
  gboolean draw_saddles, draw_quads, draw_dots, draw_indices, draw_mesh, draw_gap;
  gfloat line_width, opacity, fill_opacity, c_low, ellipse_scale;
  guint gap_scale;              /* mm */
  GstClothOverlayMeshStyle mesh_style;
} GstClothOverlayStyle;

/* Indices on squares smaller or dots closer than this could not be read, px. */
#define LEAST_SIZE_FOR_INDEX 14.0f

static inline ClothColour
with_opacity (ClothColour colour, gfloat opacity)
{
  colour.a *= opacity;
  return colour;
}

/* A canvas on the mapped frame, colours by its colorimetry. */
void gst_cloth_overlay_canvas (GstVideoFrame * frame, ClothCanvas * canvas);
void gst_cloth_overlay_draw_quads (const ClothCanvas * canvas,
    const GstClothQuad * quads, guint n, const GstClothOverlayStyle * style);
void gst_cloth_overlay_draw_saddles (const ClothCanvas * canvas,
    GstClothSaddles * saddles, const GstClothOverlayStyle * style);

/* Labelled dots and the links between neighbours of the pattern; crosses on the others.
 * @by_label is room for finding neighbours, kept over the pictures of a film. */
void gst_cloth_overlay_draw_dots (const ClothCanvas * canvas,
    GstClothDots * dots, GHashTable * by_label,
    const GstClothOverlayStyle * style);

/* Colours of a heat map: the lowest for no distance, the last but one for the scale's
 * end and all beyond, the last for a vertex whose distance isn't known. */
#define GST_CLOTH_OVERLAY_HEATS 65
const ClothColour *gst_cloth_overlay_heat_colours (void);
/* Which of them each vertex has, by the length of its residual. */
void gst_cloth_overlay_heat (GstClothGap * gap, guint scale_mm,
    guint8 * heats);
/* The scale, at the lower left, 0 and its end in mm beside it. */
void gst_cloth_overlay_draw_scale (const ClothCanvas * canvas, gint width,
    gint height, const GstClothOverlayStyle * style);

/* The mesh of one topology. It must be printed before it is drawn shaded. */
typedef struct _GstClothOverlayMesh GstClothOverlayMesh;

GstClothOverlayMesh *gst_cloth_overlay_mesh_new (GstClothTopology * topology);
void gst_cloth_overlay_mesh_free (GstClothOverlayMesh * self);
guint gst_cloth_overlay_mesh_get_n_vertices (const GstClothOverlayMesh * self);
gboolean gst_cloth_overlay_mesh_print (GstClothOverlayMesh * self,
    const gchar * texture, GError ** error);
gboolean gst_cloth_overlay_mesh_is_printed (const GstClothOverlayMesh * self);
void gst_cloth_overlay_mesh_draw (GstClothOverlayMesh * self,
    const ClothCanvas * canvas, gint width, gint height,
    const ClothCamera * camera, GstClothMesh * mesh, GstClothGap * gap,
    const GstClothOverlayStyle * style);

G_END_DECLS
