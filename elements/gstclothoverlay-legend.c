/* clothoverlay: what is seen and what the colours mean, in words.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#ifdef HAVE_CONFIG_H
#include "config.h"
#endif

#include "elements/gstclothoverlay-draw.h"

#include "gst/render/caption.h"

/* px in a picture of 640 by 480, in larger ones more */
#define SIZE 14
#define MARGIN 8
/* A picture that has no room for so many lines gets none. */
#define LEAST_LINES 10

typedef struct
{
  const ClothCanvas *canvas;
  gint width, height, size, x, y;
  gfloat opacity;
} Pen;

static void
new_line (Pen * pen)
{
  pen->x = MARGIN * pen->size / SIZE;
  pen->y += pen->size * 3 / 2;
}

G_GNUC_PRINTF (2, 3)
     static void put (Pen * pen, const gchar * format, ...)
{
  g_autofree gchar *text = NULL;
  va_list arguments;

  va_start (arguments, format);
  text = g_strdup_vprintf (format, arguments);
  va_end (arguments);
  pen->x += (gint) cloth_caption_draw (pen->canvas, text, pen->x, pen->y,
      pen->size, pen->width - pen->x, pen->opacity) + pen->size / 2;
}

/* A box of a colour that is explained by what follows. */
static void
put_colour (Pen * pen, ClothColour colour)
{
  const gfloat side = 0.8f * (gfloat) pen->size;
  const gfloat left = (gfloat) pen->x, top = (gfloat) pen->y +
      0.4f * (gfloat) pen->size;
  const ClothColour edge = { 0.05f, 0.05f, 0.15f, 0.85f * pen->opacity };

  for (gint inner = 0; inner < 2; inner++) {
    const gfloat in = inner ? 0.12f * (gfloat) pen->size : 0;
    const gfloat x[4] = { left + in, left + side - in, left + side - in,
      left + in
    };
    const gfloat y[4] =
        { top + in, top + in, top + side - in, top + side - in };

    colour.a = pen->opacity;
    cloth_draw_quad (pen->canvas, x, y, inner ? &colour : &edge);
  }
  pen->x += pen->size;
}

static void
put_quads (Pen * pen, GstClothQuads * quads, const GstClothOverlayStyle * style)
{
  guint n, n_of[3] = { 0, 0, 0 };
  const GstClothQuad *quad = gst_cloth_quads_get_quads (quads, &n);

  for (guint i = 0; i < n; i++)
    if ((guint) quad[i].state < G_N_ELEMENTS (n_of))
      n_of[quad[i].state]++;
  new_line (pen);
  put (pen, "squares: %u tracked", n_of[GST_CLOTH_QUAD_TRACKED]);
  put_colour (pen, cloth_draw_confidence_colour (1, style->c_low));
  put (pen, "sure");
  put_colour (pen, cloth_draw_confidence_colour (style->c_low, style->c_low));
  put (pen, "unsure");
  put (pen, "%u predicted (dashed)", n_of[GST_CLOTH_QUAD_PREDICTED]);
}

static void
put_dots (Pen * pen, GstClothDots * dots)
{
  guint n, n_labelled = 0, n_behind = 0;
  const GstClothDot *dot = gst_cloth_dots_get_dots (dots, &n);

  for (guint i = 0; i < n; i++) {
    const gboolean labelled = dot[i].column >= 0 && dot[i].row >= 0;

    n_labelled += labelled;
    n_behind += labelled && dot[i].mirrored;
  }
  new_line (pen);
  put (pen, "dots: %u labelled", n_labelled);
  put_colour (pen, cloth_draw_confidence_colour (1, 0));
  put (pen, "sure");
  put_colour (pen, cloth_draw_confidence_colour (0, 0));
  put (pen, "unsure");
  put_colour (pen, gst_cloth_overlay_behind_colour);
  put (pen, "%u from behind", n_behind);
  put_colour (pen, gst_cloth_overlay_unlabelled_colour);
  put (pen, "%u without label", n - n_labelled);
}

static void
put_mesh (Pen * pen, const GstClothOverlayFacts * facts,
    const GstClothOverlayStyle * style)
{
  static const gchar *const names[GST_CLOTH_OVERLAY_STATES] = {
    "not seen", "measured", "from two views", "filled", "predicted"
  };
  static const gchar *const strains[] = { "warp", "weft", "shear" };

  new_line (pen);
  put (pen, "vertices:");
  for (guint k = 0; k < GST_CLOTH_OVERLAY_STATES; k++) {
    const guint state = (k + 1) % GST_CLOTH_OVERLAY_STATES;

    if (facts->n_of_state[state] == 0)
      continue;
    if (facts->mesh_colours == GST_CLOTH_OVERLAY_COLOURS_STATE)
      put_colour (pen, gst_cloth_overlay_vertex_colours[state]);
    put (pen, "%u %s", facts->n_of_state[state], names[state]);
  }
  if (facts->mesh_colours == GST_CLOTH_OVERLAY_COLOURS_GAP) {
    new_line (pen);
    put (pen, "colour: distance from the simulation, mm");
  } else if (facts->mesh_colours == GST_CLOTH_OVERLAY_COLOURS_STRAIN) {
    new_line (pen);
    put (pen, "colour: %s strain, %%", strains[style->mesh_style -
            GST_CLOTH_OVERLAY_MESH_STRAIN_WARP]);
  }
}

static void
put_legend (Pen * pen, GstBuffer * buffer, const GstClothOverlayFacts * facts,
    const GstClothOverlayStyle * style)
{
  GstClothQuads *quads = gst_buffer_get_cloth_quads (buffer);
  GstClothDots *dots = gst_buffer_get_cloth_dots (buffer);
  GstClothSaddles *saddles = gst_buffer_get_cloth_saddles (buffer);
  GstClothMatches *matches = gst_buffer_get_cloth_matches (buffer);
  guint64 number = facts->n_pictures;
  const gchar *camera = facts->camera;

  if (quads) {
    number = gst_cloth_quads_get_sequence (quads);
    camera = gst_cloth_quads_get_camera (quads);
  } else if (dots) {
    number = gst_cloth_dots_get_sequence (dots);
    camera = gst_cloth_dots_get_camera (dots);
  } else if (matches) {
    number = gst_cloth_matches_get_sequence (matches);
    camera = gst_cloth_matches_get_camera (matches);
  } else if (saddles) {
    number = gst_cloth_saddles_get_sequence (saddles);
    camera = gst_cloth_saddles_get_camera (saddles);
  }
  new_line (pen);
  if (camera && *camera)
    put (pen, "%s", camera);
  put (pen, "picture %" G_GUINT64_FORMAT, number);
  if (GST_CLOCK_TIME_IS_VALID (facts->time))
    put (pen, "%.2f s", (gdouble) facts->time / GST_SECOND);
  if (quads && style->draw_quads)
    put_quads (pen, quads, style);
  if (dots && style->draw_dots)
    put_dots (pen, dots);
  if (matches && style->draw_matches != GST_CLOTH_OVERLAY_MATCHES_NONE) {
    guint n, n_verified = 0;
    const GstClothMatch *match = gst_cloth_matches_get_matches (matches, &n);

    for (guint i = 0; i < n; i++)
      n_verified += match[i].verified != FALSE;
    new_line (pen);
    put (pen, "matches: %u, of which %u are verified", n, n_verified);
  }
  if (saddles && style->draw_saddles) {
    guint n;

    gst_cloth_saddles_get_refined (saddles, &n);
    new_line (pen);
    put (pen, "saddles: %u", n);
  }
  if (facts->mesh_colours != GST_CLOTH_OVERLAY_COLOURS_NONE)
    put_mesh (pen, facts, style);
}

/* At the upper left of a picture of @width by @height px. */
void
gst_cloth_overlay_draw_legend (const ClothCanvas * canvas, gint width,
    gint height, GstBuffer * buffer, const GstClothOverlayFacts * facts,
    const GstClothOverlayStyle * style)
{
  Pen pen = { canvas, width, height,
    MAX (SIZE, SIZE * MIN (height * 4 / 3, width) / 640), 0, 0,
    style->opacity
  };

  if (height < LEAST_LINES * pen.size * 3 / 2)
    return;
  pen.y = -pen.size;
  if (style->draw_legend)
    put_legend (&pen, buffer, facts, style);
  if (style->draw_speed) {
    new_line (&pen);
    if (facts->speed > 0)
      put (&pen, "%.1f pictures/s", facts->speed);
    put (&pen, "%" G_GUINT64_FORMAT " lost", facts->n_lost);
  }
}
