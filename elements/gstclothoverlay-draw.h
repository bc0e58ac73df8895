/* clothoverlay: silhouettes, squares, saddles, dots, matches and maps of places from their
 * metadata into a video frame.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gst/cloth/cloth.h>
#include <gst/video/video.h>

#include "gst/render/draw.h"

G_BEGIN_DECLS

typedef enum {
  GST_CLOTH_OVERLAY_MESH_WIREFRAME,
  GST_CLOTH_OVERLAY_MESH_SHADED,
  /* in the order of ClothStrainComponent */
  GST_CLOTH_OVERLAY_MESH_STRAIN_WARP,
  GST_CLOTH_OVERLAY_MESH_STRAIN_WEFT,
  GST_CLOTH_OVERLAY_MESH_STRAIN_SHEAR
} GstClothOverlayMeshStyle;

typedef enum {
  GST_CLOTH_OVERLAY_MATCHES_NONE,
  GST_CLOTH_OVERLAY_MATCHES_GROUPS,
  GST_CLOTH_OVERLAY_MATCHES_DENSITY
} GstClothOverlayMatches;

/* The properties of the element that say how things look. */
typedef struct {
  gboolean draw_silhouette, draw_saddles, draw_quads, draw_dots, draw_indices;
  gboolean draw_mesh, draw_gap, draw_uv, draw_legend, draw_speed;
  GstClothOverlayMatches draw_matches;
  gfloat line_width, opacity, fill_opacity, c_low, ellipse_scale;
  guint gap_scale, check;       /* mm */
  guint strain_scale;           /* % */
  GstClothOverlayMeshStyle mesh_style;
} GstClothOverlayStyle;

/* By GstClothVertexState. */
#define GST_CLOTH_OVERLAY_STATES 5
extern const ClothColour
    gst_cloth_overlay_vertex_colours[GST_CLOTH_OVERLAY_STATES];
extern const ClothColour gst_cloth_overlay_behind_colour;
extern const ClothColour gst_cloth_overlay_unlabelled_colour;

/* What the colours of the mesh say. */
typedef enum {
  GST_CLOTH_OVERLAY_COLOURS_NONE,       /* there is no mesh */
  GST_CLOTH_OVERLAY_COLOURS_STATE,
  GST_CLOTH_OVERLAY_COLOURS_PLAIN,
  GST_CLOTH_OVERLAY_COLOURS_GAP,
  GST_CLOTH_OVERLAY_COLOURS_STRAIN
} GstClothOverlayColours;

/* @camera: (nullable): of the picture, where its metadata don't say
 * @n_pictures: before this one
 * @time: its stream time, or none
 * @mesh_colours: what is drawn of the mesh
 * @n_of_state: vertices of the mesh
 * @speed: pictures a second; 0: not known yet
 * @n_lost: pictures that the time stamps say are missing
 *
 * What is told of a picture besides its metadata.
 */
typedef struct {
  const gchar *camera;
  guint64 n_pictures;
  GstClockTime time;
  GstClothOverlayColours mesh_colours;
  guint n_of_state[GST_CLOTH_OVERLAY_STATES];
  gdouble speed;
  guint64 n_lost;
} GstClothOverlayFacts;

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

/* Verified matches, coloured by the seed that they grew from or as a heat map of how many there
 * are, and the vertices of the grid, with links between neighbours of the pattern. On a picture
 * of @width by @height px. @places and @cells are room, kept over the pictures of a film. */
void gst_cloth_overlay_draw_matches (const ClothCanvas * canvas, gint width,
    gint height, GstClothMatches * matches, GArray * places, GArray * cells,
    const GstClothOverlayStyle * style);

/* Checks on the flat cloth, where @uv says that its pixels show it. They are scaled to a
 * picture of @width by @height px. */
void gst_cloth_overlay_draw_uv (const ClothCanvas * canvas, gint width,
    gint height, const GstClothUV * uv, const GstClothOverlayStyle * style);

/* In words, on a picture of @width by @height px: where it is from, how many of what was found,
 * what the colours mean; how fast it goes. */
void gst_cloth_overlay_draw_legend (const ClothCanvas * canvas, gint width,
    gint height, GstBuffer * buffer, const GstClothOverlayFacts * facts,
    const GstClothOverlayStyle * style);

/* Where something belongs in the pattern, and in the low half which it is. */
guint64 gst_cloth_overlay_place (guint columns, gint column, gint row,
    guint index);
void gst_cloth_overlay_sort_places (GArray * places);
/* The first that is at a place of @places, which are in order; %G_MAXUINT: none. */
guint gst_cloth_overlay_find_place (const GArray * places, guint columns,
    guint rows, gint column, gint row);

G_END_DECLS
