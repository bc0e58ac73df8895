/* Words over a picture, white with a dark edge, by cairo.
 *
 * cairo makes a mask of the words and one of their edge; runs of equal coverage are drawn as
 * boxes, which know every layout of samples.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/render/caption.h"

#include <cairo.h>
#include <math.h>
#include <string.h>

/* in sizes of the font */
#define EDGE 0.14
#define HEIGHT 1.5
#define BASELINE 1.1

static const ClothColour edge_colour = { 0.05f, 0.05f, 0.15f, 0.85f };
static const ClothColour text_colour = { 1, 1, 1, 1 };

static void
set_font (cairo_t * cr, gint size)
{
  cairo_font_options_t *options = cairo_font_options_create ();

  /* the same picture on every screen */
  cairo_font_options_set_antialias (options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style (options, CAIRO_HINT_STYLE_NONE);
  cairo_set_font_options (cr, options);
  cairo_font_options_destroy (options);
  cairo_select_font_face (cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
      CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size (cr, size);
}

/* Returns: how wide the text is, px */
static gdouble
measure (const gchar * text, gint size)
{
  cairo_surface_t *surface = cairo_image_surface_create (CAIRO_FORMAT_A8, 1, 1);
  cairo_t *cr = cairo_create (surface);
  cairo_text_extents_t extents;

  set_font (cr, size);
  cairo_text_extents (cr, text, &extents);
  cairo_destroy (cr);
  cairo_surface_destroy (surface);
  return extents.x_advance;
}

static void
draw_mask (const ClothCanvas * canvas, cairo_surface_t * mask, gint left,
    gint top, ClothColour colour, gfloat opacity)
{
  const gint width = cairo_image_surface_get_width (mask);
  const gint height = cairo_image_surface_get_height (mask);
  const gint stride = cairo_image_surface_get_stride (mask);
  const guint8 *row = cairo_image_surface_get_data (mask);

  for (gint y = 0; y < height; y++, row += stride) {
    for (gint from = 0, to; from < width; from = to) {
      const gfloat x0 = (gfloat) (left + from) - 0.5f;
      const gfloat y0 = (gfloat) (top + y) - 0.5f;
      ClothColour shade = colour;
      gfloat xs[4], ys[4];

      for (to = from + 1; to < width && row[to] == row[from];)
        to++;
      if (row[from] == 0)
        continue;
      xs[0] = xs[3] = x0;
      xs[1] = xs[2] = x0 + (gfloat) (to - from);
      ys[0] = ys[1] = y0;
      ys[2] = ys[3] = y0 + 1;
      shade.a *= opacity * (gfloat) row[from] / 255;
      cloth_draw_quad (canvas, xs, ys, &shade);
    }
  }
}

/* The words, or their edge. */
static cairo_surface_t *
make_mask (const gchar * text, gint size, gint width, gboolean edge)
{
  cairo_surface_t *mask = cairo_image_surface_create (CAIRO_FORMAT_A8, width,
      (gint) ceil (HEIGHT * size));
  cairo_t *cr = cairo_create (mask);

  set_font (cr, size);
  cairo_move_to (cr, EDGE * size, BASELINE * size);
  cairo_text_path (cr, text);
  if (edge) {
    cairo_set_line_join (cr, CAIRO_LINE_JOIN_ROUND);
    cairo_set_line_width (cr, 2 * EDGE * size);
    cairo_stroke_preserve (cr);
  }
  cairo_fill (cr);
  cairo_destroy (cr);
  cairo_surface_flush (mask);
  return mask;
}

/* @canvas: picture to draw on
 * @text: UTF-8; of a stranger's only the first %CLOTH_CAPTION_MAX bytes are drawn
 * @x: left end, px
 * @y: top, px
 * @size: of the font, px
 * @room: how wide it may be, px; what is beyond is cut
 * @opacity: 0 … 1
 *
 * Returns: how wide it is, px
 */
gfloat
cloth_caption_draw (const ClothCanvas * canvas, const gchar * text, gint x,
    gint y, gint size, gint room, gfloat opacity)
{
  g_autofree gchar *valid = g_utf8_make_valid (text, -1);
  gint width;

  if (strlen (valid) > CLOTH_CAPTION_MAX) {
    gchar *end = g_utf8_find_prev_char (valid, valid + CLOTH_CAPTION_MAX + 1);

    *end = 0;
  }
  for (gchar * at = valid; *at; at++)
    if (g_ascii_iscntrl (*at))
      *at = ' ';
  width = (gint) CLAMP (ceil (measure (valid, size) + 2 * EDGE * size), 0,
      MAX (room, 0));
  if (width == 0)
    return 0;
  for (gint edge = 1; edge >= 0; edge--) {
    cairo_surface_t *mask = make_mask (valid, size, width, edge);

    if (cairo_surface_status (mask) == CAIRO_STATUS_SUCCESS)
      draw_mask (canvas, mask, x, y, edge ? edge_colour : text_colour, opacity);
    cairo_surface_destroy (mask);
  }
  return (gfloat) width;
}
