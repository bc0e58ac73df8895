/* Print files of patterns at true size: layout on sheets, PDF and SVG files. A sheet shows
 * its part of the cloth, marks, ruler, patches and a caption; its lengths are mm.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/pattern/print.h"

#include "config.h"
#include "gst/file/output.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <math.h>
#include <string.h>

#define MM_PER_POINT (25.4 / 72)
/* What PDF viewers take: 14,400 points. */
#define MAX_PAGE_MM 5080.0
#define MAX_SHEETS 400
#define MIN_TILE_MM 50.0
/* The strip below the cloth: room for marks, ruler and patches, two lines of text. */
#define STRIP_MM 25.0
#define STRIP_WIDTH_MM 128.0
/* From the cloth's lower edge to the ruler's line, and its length. */
#define RULER_MM 7.0
#define RULER_LENGTH_MM 100
#define LINE_MM 0.1
#define MARK_MM 4.0
#define MARK_GAP_MM 0.7
#define TEXT_MM 2.6
#define GREYS 5
#define PATCH_MM 4.0
#define PATCHES_MM 25.0

/* @name: "A0" to "A5", "letter", "legal", "tabloid", "cloth" or a size as "600x900mm"
 * @paper_mm: (out): width and height, mm; 0, 0 for "cloth"
 *
 * Returns: whether the name is known
 */
gboolean
cloth_print_paper (const gchar * name, gdouble paper_mm[2])
{
  static const struct
  {
    const gchar *name;
    gdouble width, height;
  } papers[] = {
    {"cloth", 0, 0}, {"A0", 841, 1189}, {"A1", 594, 841}, {"A2", 420, 594},
    {"A3", 297, 420}, {"A4", 210, 297}, {"A5", 148, 210},
    {"letter", 215.9, 279.4}, {"legal", 215.9, 355.6}, {"tabloid", 279.4,
        431.8}
  };
  gchar *end;

  for (gsize i = 0; i < G_N_ELEMENTS (papers); i++) {
    if (!g_ascii_strcasecmp (name, papers[i].name)) {
      paper_mm[0] = papers[i].width;
      paper_mm[1] = papers[i].height;
      return TRUE;
    }
  }
  if (!g_ascii_isdigit (name[0]))
    return FALSE;
  paper_mm[0] = g_ascii_strtod (name, &end);
  if (*end != 'x' || !g_ascii_isdigit (end[1]))
    return FALSE;
  paper_mm[1] = g_ascii_strtod (end + 1, &end);
  return !strcmp (end, "mm") && paper_mm[0] > 0 && paper_mm[1] > 0
      && isfinite (paper_mm[0]) && isfinite (paper_mm[1]);
}

static gboolean
refuse (GError ** error, const gchar * why)
{
  g_set_error_literal (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE,
      why);
  return FALSE;
}

/* Sheets that tiles of @tile take for @cloth along one direction. */
static gdouble
count_sheets (gdouble cloth, gdouble tile, gdouble overlap)
{
  return cloth <= tile ? 1 : ceil ((cloth - overlap) / (tile - overlap) - 1e-9);
}

static gboolean
lay_paper (const ClothPrintOptions * options, ClothPrintLayout * layout,
    GError ** error)
{
  const gdouble margin = options->margin_mm, overlap = options->overlap_mm;
  gdouble least = G_MAXDOUBLE;

  for (gint turned = 0; turned < 2; turned++) {
    const gdouble page[2] =
        { options->paper_mm[turned], options->paper_mm[1 - turned] };
    const gdouble room[2] = { page[0] - 2 * margin,
      page[1] - 2 * margin - STRIP_MM
    };
    gdouble sheets[2];

    if (!(room[0] >= STRIP_WIDTH_MM && room[1] >= MIN_TILE_MM
            && MIN (room[0], room[1]) >= 2 * overlap))
      continue;
    for (gint i = 0; i < 2; i++)
      sheets[i] = count_sheets (layout->cloth_mm[i], room[i], overlap);
    if (sheets[0] * sheets[1] >= least)
      continue;
    least = sheets[0] * sheets[1];
    for (gint i = 0; i < 2; i++) {
      layout->page_mm[i] = page[i];
      layout->tile_mm[2 + i] = MIN (room[i], layout->cloth_mm[i]);
      layout->step_mm[i] = layout->tile_mm[2 + i] - overlap;
      layout->sheets[i] = (gint) MIN (sheets[i], MAX_SHEETS + 1);
    }
  }
  if (least == G_MAXDOUBLE)
    return refuse (error, "the paper is too small for a ruler of 100 mm and a "
        "part of the cloth: use A5 or larger, less margin or less overlap");
  if (least > MAX_SHEETS) {
    g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE,
        "the cloth would take %.0f sheets: use larger paper, at most %d are "
        "made", least, MAX_SHEETS);
    return FALSE;
  }
  return TRUE;
}

/* @artwork: what is printed
 * @options: paper, margin, overlap
 * @layout: (out): where everything goes
 * @error: return location
 *
 * Lays the cloth out on sheets of paper, upright or lying, whichever takes fewer. Below
 * the cloth every sheet has a strip with a ruler, patches and a caption.
 *
 * Returns: %FALSE with %CLOTH_PATTERN_ERROR_VALUE
 */
gboolean
cloth_print_layout (const ClothArtwork * artwork,
    const ClothPrintOptions * options, ClothPrintLayout * layout,
    GError ** error)
{
  const gdouble *cloth_m = artwork->sheet ? artwork->sheet->cloth_m
      : artwork->checker ? artwork->checker->cloth_m : artwork->dots->cloth_m;
  const gdouble margin = options->margin_mm;

  if ((artwork->checker && !cloth_pattern_check (artwork->checker, error))
      || (artwork->dots && !cloth_m_array_check (artwork->dots, error)))
    return FALSE;
  if (!(margin >= 0 && margin <= 100))
    return refuse (error, "the paper's margin must be 0 to 100 mm");
  if (!(options->overlap_mm >= 0 && options->overlap_mm <= 100))
    return refuse (error, "the sheets' overlap must be 0 to 100 mm");
  memset (layout, 0, sizeof *layout);
  /* A nanometre is enough; it rids 0.63 m of its 630.0000000000001 mm. */
  for (gint i = 0; i < 2; i++)
    layout->cloth_mm[i] = round (cloth_m[i] * 1e9) / 1e6;
  if (options->paper_mm[0] == 0 && options->paper_mm[1] == 0) {
    layout->sheets[0] = layout->sheets[1] = 1;
    layout->page_mm[0] = 2 * margin + MAX (layout->cloth_mm[0], STRIP_WIDTH_MM);
    layout->page_mm[1] = 2 * margin + layout->cloth_mm[1] + STRIP_MM;
    for (gint i = 0; i < 2; i++)
      layout->tile_mm[2 + i] = layout->step_mm[i] = layout->cloth_mm[i];
  } else if (!lay_paper (options, layout, error)) {
    return FALSE;
  }
  if (!(MAX (layout->page_mm[0], layout->page_mm[1]) <= MAX_PAGE_MM)) {
    g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE,
        "a page of %.0f by %.0f mm: at most %.0f mm print; choose a paper to "
        "spread it on sheets", layout->page_mm[0], layout->page_mm[1],
        MAX_PAGE_MM);
    return FALSE;
  }
  layout->tile_mm[0] = layout->tile_mm[1] = margin;
  return TRUE;
}

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
  draw_line (cr, x, y, x + RULER_LENGTH_MM, y);
  for (gint mm = 0; mm <= RULER_LENGTH_MM; mm++)
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
sheet_caption (const ClothSheet * sheet)
{
  gchar width[G_ASCII_DTOSTR_BUF_SIZE], height[G_ASCII_DTOSTR_BUF_SIZE];

  g_ascii_formatd (width, sizeof width, "%.6g", sheet->cloth_m[0] * 1000);
  g_ascii_formatd (height, sizeof height, "%.6g", sheet->cloth_m[1] * 1000);
  return g_strdup_printf ("picture of %s × %s mm, seed %" G_GUINT64_FORMAT,
      width, height, sheet->seed);
}

static gchar *
caption (const ClothArtwork * artwork, const ClothPrintOptions * options)
{
  g_autofree gchar *what = artwork->sheet ? sheet_caption (artwork->sheet)
      : artwork->checker ? checker_caption (artwork->checker)
      : dots_caption (artwork->dots);

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

  draw_ruler (cr, x + 1, y + RULER_MM);
  draw_patches (cr, artwork->dots, x + RULER_LENGTH_MM + 2.5, y + RULER_MM);
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
static void
draw_sheet (cairo_t * cr, const ClothArtwork * artwork,
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
  else if (artwork->dots)
    draw_dots (cr, artwork->dots, view);
  else
    cloth_sheet_draw (artwork->sheet, cr, view);
  cairo_restore (cr);
  draw_marks (cr, layout, tile, column, row);
  draw_strip (cr, artwork, options, layout, column, row);
  cairo_restore (cr);
}

static cairo_status_t
append_bytes (void *closure, const unsigned char *data, unsigned int length)
{
  g_byte_array_append (closure, data, length);
  return CAIRO_STATUS_SUCCESS;
}

/* Takes @cr and @surface; the bytes they wrote are in @bytes. */
static gboolean
finish (cairo_t * cr, cairo_surface_t * surface, GError ** error)
{
  cairo_status_t status = cairo_status (cr);

  cairo_destroy (cr);
  cairo_surface_finish (surface);
  if (status == CAIRO_STATUS_SUCCESS)
    status = cairo_surface_status (surface);
  cairo_surface_destroy (surface);
  if (status == CAIRO_STATUS_SUCCESS)
    return TRUE;
  g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_PRINT,
      "drawing the pattern failed: %s", cairo_status_to_string (status));
  return FALSE;
}

/* Equal input gives equal bytes: the date is the one that reproducible builds set, or
 * the epoch. */
static void
set_pdf_date (cairo_surface_t * surface)
{
  const gchar *epoch = g_getenv ("SOURCE_DATE_EPOCH");
  gint64 seconds = epoch ? g_ascii_strtoll (epoch, NULL, 10) : 0;
  g_autoptr (GDateTime) date = g_date_time_new_from_unix_utc (seconds);
  g_autofree gchar *text = NULL;

  if (!date)
    date = g_date_time_new_from_unix_utc (0);
  text = g_date_time_format (date, "%Y-%m-%dT%H:%M:%SZ");
  cairo_pdf_surface_set_metadata (surface, CAIRO_PDF_METADATA_CREATE_DATE,
      text);
}

/* @artwork: what is printed
 * @options: paper, margin, overlap
 * @error: return location
 *
 * Draws @artwork as a PDF with a page for each sheet, row by row, at true size. Equal
 * input gives equal bytes on a machine; the creation date is that of the environment
 * variable SOURCE_DATE_EPOCH, else 1970.
 *
 * Returns: (transfer full): the file, or %NULL with a #ClothPatternError
 */
GBytes *
cloth_print_pdf (const ClothArtwork * artwork,
    const ClothPrintOptions * options, GError ** error)
{
  g_autoptr (GByteArray) bytes = g_byte_array_new ();
  ClothPrintLayout layout;
  cairo_surface_t *surface;
  cairo_t *cr;

  if (!cloth_print_layout (artwork, options, &layout, error))
    return NULL;
  surface = cairo_pdf_surface_create_for_stream (append_bytes, bytes,
      layout.page_mm[0] / MM_PER_POINT, layout.page_mm[1] / MM_PER_POINT);
  set_pdf_date (surface);
  cr = cairo_create (surface);
  cairo_scale (cr, 1 / MM_PER_POINT, 1 / MM_PER_POINT);
  for (gint row = 0; row < layout.sheets[1]; row++) {
    for (gint column = 0; column < layout.sheets[0]; column++) {
      draw_sheet (cr, artwork, options, &layout, column, row);
      cairo_show_page (cr);
    }
  }
  if (!finish (cr, surface, error))
    return NULL;
  return g_byte_array_free_to_bytes (g_steal_pointer (&bytes));
}

/* cairo numbers its surfaces within the process and writes the number as an id. */
static void
drop_surface_number (GByteArray * bytes)
{
  static const gchar mark[] = "id=\"surface";
  guint8 *at = memmem (bytes->data, bytes->len, mark, strlen (mark));
  guint start, n = 0;

  if (!at)
    return;
  start = (guint) (at - bytes->data) + (guint) strlen (mark);
  while (start + n < bytes->len && g_ascii_isdigit (bytes->data[start + n]))
    n++;
  if (n > 0)
    g_byte_array_remove_range (bytes, start, n);
}

/* @artwork: what is printed
 * @options: paper, margin, overlap
 * @column: which sheet across
 * @row: which sheet down
 * @error: return location
 *
 * Draws one sheet as an SVG whose size is given in mm. Equal input gives equal bytes.
 *
 * Returns: (transfer full): the file, or %NULL with a #ClothPatternError
 */
GBytes *
cloth_print_svg (const ClothArtwork * artwork,
    const ClothPrintOptions * options, gint column, gint row, GError ** error)
{
  g_autoptr (GByteArray) bytes = g_byte_array_new ();
  ClothPrintLayout layout;
  cairo_surface_t *surface;
  cairo_t *cr;

  if (!cloth_print_layout (artwork, options, &layout, error))
    return NULL;
  if (column < 0 || row < 0 || column >= layout.sheets[0]
      || row >= layout.sheets[1]) {
    refuse (error, "there is no such sheet");
    return NULL;
  }
  surface = cairo_svg_surface_create_for_stream (append_bytes, bytes,
      layout.page_mm[0], layout.page_mm[1]);
  cairo_svg_surface_set_document_unit (surface, CAIRO_SVG_UNIT_MM);
  cr = cairo_create (surface);
  draw_sheet (cr, artwork, options, &layout, column, row);
  if (!finish (cr, surface, error))
    return NULL;
  drop_surface_number (bytes);
  return g_byte_array_free_to_bytes (g_steal_pointer (&bytes));
}

static gboolean
save_bytes (GBytes * bytes, const gchar * path, GError ** error)
{
  gsize size;
  const gchar *data;

  if (!bytes)
    return FALSE;
  data = g_bytes_get_data (bytes, &size);
  return cloth_file_write (path, data, size, error);
}

/* @artwork: what is printed
 * @options: paper, margin, overlap
 * @path: (type filename): where to; ends with .pdf or .svg
 * @error: return location
 *
 * Writes the print file. Sheets of an SVG that takes several are files of their own:
 * board.svg becomes board-1-1.svg, board-1-2.svg … (row, column). Each file appears
 * whole or not at all.
 *
 * Returns: (transfer full) (array zero-terminated=1): the files' names; free with
 *   g_strfreev(). %NULL with a #ClothPatternError or #GIOErrorEnum
 */
gchar **
cloth_print_save (const ClothArtwork * artwork,
    const ClothPrintOptions * options, const gchar * path, GError ** error)
{
  g_autoptr (GPtrArray) names = g_ptr_array_new_with_free_func (g_free);
  g_autofree gchar *stem = g_strdup (path);
  ClothPrintLayout layout;

  if (!cloth_print_layout (artwork, options, &layout, error))
    return NULL;
  if (g_str_has_suffix (path, ".pdf")) {
    g_autoptr (GBytes) bytes = cloth_print_pdf (artwork, options, error);

    if (!save_bytes (bytes, path, error))
      return NULL;
    g_ptr_array_add (names, g_strdup (path));
  } else if (g_str_has_suffix (path, ".svg")) {
    stem[strlen (path) - 4] = 0;
    for (gint n = 0; n < layout.sheets[0] * layout.sheets[1]; n++) {
      const gint column = n % layout.sheets[0], row = n / layout.sheets[0];
      g_autoptr (GBytes) bytes =
          cloth_print_svg (artwork, options, column, row, error);
      gchar *name = layout.sheets[0] * layout.sheets[1] == 1 ? g_strdup (path)
          : g_strdup_printf ("%s-%d-%d.svg", stem, row + 1, column + 1);

      g_ptr_array_add (names, name);
      if (!save_bytes (bytes, name, error))
        return NULL;
    }
  } else {
    g_set_error (error, CLOTH_PATTERN_ERROR, CLOTH_PATTERN_ERROR_VALUE,
        "%s: the name must end with .pdf or .svg", path);
    return NULL;
  }
  g_ptr_array_add (names, NULL);
  return (gchar **) g_ptr_array_free (g_steal_pointer (&names), FALSE);
}
