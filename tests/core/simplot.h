/* Panels of lines over time, for the pictures of docs/simulator.md.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <cairo.h>
#include <math.h>

#include <glib.h>

#define PANEL_WIDTH 300.
#define PANEL_HEIGHT 210.

typedef struct
{
  cairo_t *cr;
  gdouble x, y, width, height;  /* of the frame, px */
  gdouble end, low, high;       /* s, and of the values */
  guint n_lines;
} Panel;

static void
panel_text (const Panel * panel, gdouble x, gdouble y, gdouble align,
    const gchar * text)
{
  cairo_text_extents_t extents;

  cairo_text_extents (panel->cr, text, &extents);
  cairo_move_to (panel->cr, x - align * extents.x_advance, y);
  cairo_show_text (panel->cr, text);
}

/* Frame, ticks and title of a panel in a column and row of the picture. */
static Panel
panel_begin (cairo_t * cr, guint column, guint row, const gchar * title,
    gdouble end, gdouble low, gdouble high)
{
  Panel panel = { cr, PANEL_WIDTH * column + 44., PANEL_HEIGHT * row + 26.,
    PANEL_WIDTH - 58., PANEL_HEIGHT - 52., end, low, high, 0
  };
  gdouble step = pow (10., floor (log10 (high - low)));

  if ((high - low) / step < 3.)
    step /= 2.;
  cairo_set_font_size (cr, 11.);
  cairo_set_source_rgb (cr, 0.1, 0.1, 0.1);
  panel_text (&panel, panel.x, panel.y - 8., 0., title);
  cairo_set_line_width (cr, 1.);
  for (gint i = (gint) ceil (low / step); i * step <= high; i++) {
    gdouble y = panel.y + panel.height * (high - i * step) / (high - low);
    g_autofree gchar *text = g_strdup_printf ("%g", i * step);

    cairo_set_source_rgb (cr, 0.87, 0.87, 0.87);
    cairo_move_to (cr, panel.x, y);
    cairo_rel_line_to (cr, panel.width, 0.);
    cairo_stroke (cr);
    cairo_set_source_rgb (cr, 0.3, 0.3, 0.3);
    panel_text (&panel, panel.x - 5., y + 4., 1., text);
  }
  for (gint i = 0; 0.5 * i <= end; i++) {
    g_autofree gchar *text = g_strdup_printf ("%g", 0.5 * i);

    panel_text (&panel, panel.x + panel.width * 0.5 * i / end,
        panel.y + panel.height + 14., 0.5, text);
  }
  cairo_set_source_rgb (cr, 0.3, 0.3, 0.3);
  cairo_rectangle (cr, panel.x, panel.y, panel.width, panel.height);
  cairo_stroke (cr);
  return panel;
}

/* A line of values, one every @frame seconds from 0; gaps where they are NaN. */
static void
panel_line (Panel * panel, const gdouble * values, guint stride, guint n,
    gdouble frame, guint32 colour, const gchar * label)
{
  cairo_t *cr = panel->cr;
  gboolean pen = FALSE;

  cairo_save (cr);
  cairo_set_source_rgb (cr, (colour >> 16) / 255., (colour >> 8 & 255) / 255.,
      (colour & 255) / 255.);
  panel_text (panel, panel->x + 8. + 110. * (panel->n_lines % 2),
      panel->y + 14. + 14. * (panel->n_lines / 2), 0., label);
  panel->n_lines++;
  cairo_rectangle (cr, panel->x, panel->y, panel->width, panel->height);
  cairo_clip (cr);
  cairo_set_line_width (cr, 1.6);
  for (guint i = 0; i < n; i++) {
    gdouble value = values[stride * i];
    gdouble x = panel->x + panel->width * i * frame / panel->end;
    gdouble y = panel->y + panel->height * (panel->high - value) /
        (panel->high - panel->low);

    if (isfinite (value) && pen)
      cairo_line_to (cr, x, y);
    else if (isfinite (value))
      cairo_move_to (cr, x, y);
    pen = isfinite (value);
  }
  cairo_stroke (cr);
  cairo_restore (cr);
}
