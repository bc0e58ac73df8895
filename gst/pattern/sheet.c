/* Draws one sheet of a print file: the part of the cloth, marks, ruler, patches, caption.
 * All lengths are mm.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/pattern/sheet.h"

#include "config.h"

#include <math.h>

#define LINE_MM 0.1
#define MARK_MM 4.0
#define MARK_GAP_MM 0.7
#define TEXT_MM 2.6
#define GREYS 5
#define PATCH_MM 4.0
#define PATCHES_MM 25.0

static void
set_colour (cairo_t * cr, const ClothMArray * array, gint colour)
{
  const guint8 *rgb = array->colours[colour].rgb;

  cairo_set_source_rgb (cr, rgb[0] / 255.0, rgb[1] / 255.0, rgb[2] / 255.0);
}

/* Squares and dots within @view (x, y, width, height on the cloth). Only black is drawn:
 * a white dot is a hole, so any colour of cloth will do. */
static void
draw_board (cairo_t * cr, const ClothPattern * pattern, const gdouble view[4])
{
  const gdouble edge = pattern->square_m * 1000;
  const gdouble x0 = pattern->origin_uv_m[0] * 1000;
  const gdouble y0 = pattern->origin_uv_m[1] * 1000;
  const gint limits[2] = { pattern->columns, pattern->rows };
  gint first[2], last[2];

  for (gint i = 0; i < 2; i++) {
    const gdouble start = (view[i] - (i == 0 ? x0 : y0)) / edge;
    const gdouble end = start + view[2 + i] / edge;

    first[i] = (gint) CLAMP (floor (start) - 1, 0, limits[i]);
    last[i] = (gint) CLAMP (ceil (end) + 1, 0, limits[i]);
  }
  cairo_set_fill_rule (cr, CAIRO_FILL_RULE_EVEN_ODD);
  cairo_set_source_rgb (cr, 0, 0, 0);
  for (gint row = first[1]; row < last[1]; row++) {
    for (gint column = first[0]; column < last[0]; column++) {
      const gdouble x = x0 + column * edge, y = y0 + row * edge;

      if (cloth_pattern_is_black (pattern, column, row))
        cairo_rectangle (cr, x, y, x0 + (column + 1) * edge - x,
            y0 + (row + 1) * edge - y);
      if (cloth_pattern_has_dot (pattern, column, row)) {
        cairo_new_sub_path (cr);
        cairo_arc (cr, x + edge / 2, y + edge / 2,
            pattern->dot_ratio * edge / 2, 0, 2 * G_PI);
        cairo_close_path (cr);
      }
    }
    cairo_fill (cr);
  }
}

/* The ground and the dots within @view. */
static void
draw_dots (cairo_t * cr, const ClothMArray * array, const gdouble view[4])
{
  const gdouble pitch = array->pitch_m * 1000;
  const gdouble radius = array->diameter_m * 1000 / 2;
  const gint limits[2] = { array->columns, array->rows };
  gint first[2], last[2];

  for (gint i = 0; i < 2; i++) {
    const gdouble start = view[i] - array->origin_uv_m[i] * 1000;

    first[i] = (gint) CLAMP (floor ((start - radius) / pitch), 0, limits[i]);
    last[i] = (gint) CLAMP (ceil ((start + view[2 + i] + radius) / pitch) + 1,
        0, limits[i]);
  }
  cairo_set_source_rgb (cr, 0, 0, 0);
  cairo_rectangle (cr, view[0], view[1], view[2], view[3]);
  cairo_fill (cr);
  for (gint row = first[1]; row < last[1]; row++) {
    for (gint column = first[0]; column < last[0]; column++) {
      set_colour (cr, array, array->matrix[row * array->columns + column]);
      cairo_arc (cr, array->origin_uv_m[0] * 1000 + column * pitch,
          array->origin_uv_m[1] * 1000 + row * pitch, radius, 0, 2 * G_PI);
      cairo_fill (cr);
    }
  }
}

static void
draw_line (cairo_t * cr, gdouble x0, gdouble y0, gdouble x1, gdouble y1)
{
  cairo_move_to (cr, x0, y0);
  cairo_line_to (cr, x1, y1);
  cairo_stroke (cr);
}

/* Marks outside the tile, where lines at @x (upright) or @y (level) would leave it. */
static void
draw_mark (cairo_t * cr, const gdouble tile[4], gboolean upright, gdouble at)
{
  const gint along = upright ? 0 : 1, across = 1 - along;

  for (gint side = 0; side < 2; side++) {
    const gdouble near = tile[across] + (side ? tile[2 + across] + MARK_GAP_MM
        : -MARK_GAP_MM);
    const gdouble far = near + (side ? MARK_MM : -MARK_MM);

    if (upright)
      draw_line (cr, at, near, at, far);
    else
      draw_line (cr, near, at, far, at);
  }
}

/* The cloth's edges, and the middles of what neighbouring sheets share: the marks of two
 * sheets laid on each other meet. */
static void
draw_marks (cairo_t * cr, const ClothPrintLayout * layout,
    const gdouble tile[4], gint column, gint row)
{
  const gint sheet[2] = { column, row };

  cairo_set_source_rgb (cr, 0, 0, 0);
  cairo_set_line_width (cr, LINE_MM);
  for (gint i = 0; i < 2; i++) {
    const gdouble overlap = layout->tile_mm[2 + i] - layout->step_mm[i];

    if (sheet[i] == 0)
      draw_mark (cr, tile, i == 0, tile[i]);
    else
      draw_mark (cr, tile, i == 0, tile[i] + overlap / 2);
    if (sheet[i] == layout->sheets[i] - 1)
      draw_mark (cr, tile, i == 0, tile[i] + tile[2 + i]);
    else
      draw_mark (cr, tile, i == 0, tile[i] + tile[2 + i] - overlap / 2);
  }
}

/* As outlines: no font is needed to print the file. */
static void
draw_text (cairo_t * cr, gdouble x, gdouble y, gdouble width,
    const gchar * text)
{
  cairo_text_extents_t extents;

  cairo_set_font_size (cr, TEXT_MM);
  cairo_text_extents (cr, text, &extents);
  if (extents.x_advance > width)
    cairo_set_font_size (cr, TEXT_MM * width / extents.x_advance);
  cairo_move_to (cr, x, y);
  cairo_text_path (cr, text);
  cairo_fill (cr);
}

/* Its outer ticks' centres are 100 mm apart. */
static void
draw_ruler (cairo_t * cr, gdouble x, gdouble y)
{
  cairo_set_source_rgb (cr, 0, 0, 0);
  cairo_set_line_width (cr, LINE_MM);
  draw_line (cr, x, y, x + CLOTH_SHEET_RULER_LENGTH_MM, y);
  for (gint mm = 0; mm <= CLOTH_SHEET_RULER_LENGTH_MM; mm++)
    draw_line (cr, x + mm, y,
        x + mm, y + (mm % 10 == 0 ? 4 : mm % 5 == 0 ? 3 : 2));
  draw_text (cr, x + 1.5, y + 7.2, 98, "100 mm: measure me");
}

static void
draw_frame (cairo_t * cr, gdouble x, gdouble y)
{
  cairo_set_source_rgb (cr, 0, 0, 0);
  cairo_set_line_width (cr, LINE_MM);
  cairo_rectangle (cr, x, y, PATCHES_MM, PATCH_MM);
  cairo_stroke (cr);
}

/* Greys from black to white; below them the colours of the dots. */
static void
draw_patches (cairo_t * cr, const ClothMArray * dots, gdouble x, gdouble y)
{
  for (gint i = 0; i < GREYS; i++) {
    const gdouble grey = (gdouble) i / (GREYS - 1);

    cairo_set_source_rgb (cr, grey, grey, grey);
    cairo_rectangle (cr, x + i * PATCHES_MM / GREYS, y, PATCHES_MM / GREYS,
        PATCH_MM);
    cairo_fill (cr);
  }
  draw_frame (cr, x, y);
  for (gint i = 0; dots && i < dots->n_colours; i++) {
    const gdouble width = PATCHES_MM / dots->n_colours;

    set_colour (cr, dots, i);
    cairo_rectangle (cr, x + i * width, y + PATCH_MM, width, PATCH_MM);
    cairo_fill (cr);
  }
  if (dots)
    draw_frame (cr, x, y + PATCH_MM);
}

static gchar *
checker_caption (const ClothPattern * pattern)
{
  gchar edge[G_ASCII_DTOSTR_BUF_SIZE], ratio[G_ASCII_DTOSTR_BUF_SIZE];
  g_autofree gchar *dots = NULL;

  g_ascii_formatd (edge, sizeof edge, "%.6g", pattern->square_m * 1000);
  g_ascii_formatd (ratio, sizeof ratio, "%.4g", pattern->dot_ratio);
  if (pattern->code)
    dots = g_strdup_printf (", dots of %s squares", ratio);
  return g_strdup_printf ("%s %d × %d, squares of %s mm, first %s%s",
      pattern->code ? "coded-checker" : "checker", pattern->columns,
      pattern->rows, edge, pattern->first_black ? "black" : "white",
      dots ? dots : "");
}

static gchar *
dots_caption (const ClothMArray * array)
{
  gchar pitch[G_ASCII_DTOSTR_BUF_SIZE], diameter[G_ASCII_DTOSTR_BUF_SIZE];

  g_ascii_formatd (pitch, sizeof pitch, "%.6g", array->pitch_m * 1000);
  g_ascii_formatd (diameter, sizeof diameter, "%.6g", array->diameter_m * 1000);
  return g_strdup_printf ("m-array %d × %d, %d colours, dots of %s mm every "
      "%s mm", array->columns, array->rows, array->n_colours, diameter, pitch);
}

static gchar *
caption (const ClothArtwork * artwork, const ClothPrintOptions * options)
{
  g_autofree gchar *what = artwork->checker
      ? checker_caption (artwork->checker) : dots_caption (artwork->dots);

  return g_strdup_printf ("%s %s: %s%s%s", PACKAGE, PACKAGE_VERSION, what,
      options->notes ? ", " : "", options->notes ? options->notes : "");
}

static void
draw_strip (cairo_t * cr, const ClothArtwork * artwork,
    const ClothPrintOptions * options, const ClothPrintLayout * layout,
    gint column, gint row)
{
  const gdouble x = options->margin_mm;
  const gdouble y = layout->tile_mm[1] + layout->tile_mm[3];
  const gdouble width = layout->page_mm[0] - 2 * options->margin_mm;
  g_autofree gchar *line = caption (artwork, options);
  g_autofree gchar *place = NULL;

  draw_ruler (cr, x + 1, y + CLOTH_SHEET_RULER_MM);
  draw_patches (cr, artwork->dots, x + CLOTH_SHEET_RULER_LENGTH_MM + 2.5,
      y + CLOTH_SHEET_RULER_MM);
  draw_text (cr, x, y + 19, width, line);
  if (layout->sheets[0] * layout->sheets[1] > 1) {
    gchar overlap[G_ASCII_DTOSTR_BUF_SIZE];

    g_ascii_formatd (overlap, sizeof overlap, "%.6g", options->overlap_mm);
    place = g_strdup_printf ("sheet %d of %d: column %d of %d, row %d of %d; "
        "neighbours overlap by %s mm: lay their marks on each other",
        row * layout->sheets[0] + column + 1,
        layout->sheets[0] * layout->sheets[1], column + 1, layout->sheets[0],
        row + 1, layout->sheets[1], overlap);
    draw_text (cr, x, y + 23.5, width, place);
  }
}

/* @cr's unit is the mm. */
void
cloth_sheet_draw (cairo_t * cr, const ClothArtwork * artwork,
    const ClothPrintOptions * options, const ClothPrintLayout * layout,
    gint column, gint row)
{
  const gdouble start[2] = { column * layout->step_mm[0],
    row * layout->step_mm[1]
  };
  const gdouble tile[4] = { layout->tile_mm[0], layout->tile_mm[1],
    MIN (layout->tile_mm[2], layout->cloth_mm[0] - start[0]),
    MIN (layout->tile_mm[3], layout->cloth_mm[1] - start[1])
  };
  const gdouble view[4] = { start[0], start[1], tile[2], tile[3] };
  cairo_font_options_t *font = cairo_font_options_create ();

  cairo_save (cr);
  /* Of a device unit, mm or point: the default of 0.1 shows in the dots. */
  cairo_set_tolerance (cr, 0.001);
  cairo_font_options_set_hint_style (font, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics (font, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options (cr, font);
  cairo_font_options_destroy (font);
  cairo_select_font_face (cr, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
      CAIRO_FONT_WEIGHT_NORMAL);
  /* Paper is white where a viewer would show through. */
  cairo_set_source_rgb (cr, 1, 1, 1);
  cairo_rectangle (cr, 0, 0, layout->page_mm[0], layout->page_mm[1]);
  cairo_fill (cr);
  cairo_save (cr);
  cairo_rectangle (cr, tile[0], tile[1], tile[2], tile[3]);
  cairo_clip (cr);
  cairo_translate (cr, tile[0] - start[0], tile[1] - start[1]);
  if (artwork->checker)
    draw_board (cr, artwork->checker, view);
  else
    draw_dots (cr, artwork->dots, view);
  cairo_restore (cr);
  draw_marks (cr, layout, tile, column, row);
  draw_strip (cr, artwork, options, layout, column, row);
  cairo_restore (cr);
}
