/* Print files of patterns at true size: PDF and SVG.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/pattern/marray.h"
#include "gst/pattern/pattern.h"
#include "gst/pattern/sheet.h"

G_BEGIN_DECLS

/* @checker: (nullable): a checkerboard, plain or coded
 * @dots: (nullable): an M-array
 * @sheet: (nullable): random shapes
 *
 * What is printed: exactly one of them.
 */
typedef struct {
  const ClothPattern *checker;
  const ClothMArray *dots;
  const ClothSheet *sheet;
} ClothArtwork;

/* @paper_mm: width and height of the paper, mm, either way round; 0, 0 for one sheet as
 *   large as it takes
 * @margin_mm: edge of the paper that printers leave blank, mm
 * @overlap_mm: how far neighbouring sheets show the same part of the cloth, mm
 * @notes: (nullable): printed after the caption
 */
typedef struct {
  gdouble paper_mm[2];
  gdouble margin_mm;
  gdouble overlap_mm;
  const gchar *notes;
} ClothPrintOptions;

#define CLOTH_PRINT_OPTIONS_INIT { { 0, 0 }, 10, 10, NULL }

/* @page_mm: width and height of each page, mm
 * @tile_mm: place (x, y) and size (width, height) of the part of a page that shows the
 *   cloth, mm from the page's top-left corner
 * @step_mm: cloth between the left (top) edges of neighbouring tiles, mm
 * @sheets: sheets across and down
 * @cloth_mm: width and height of the cloth, mm
 *
 * The tile of sheet (column, row) shows the cloth from column·@step_mm, row·@step_mm on;
 * the last ones may show less than a tile.
 */
typedef struct {
  gdouble page_mm[2];
  gdouble tile_mm[4];
  gdouble step_mm[2];
  gint sheets[2];
  gdouble cloth_mm[2];
} ClothPrintLayout;

gboolean cloth_print_paper (const gchar * name, gdouble paper_mm[2]);
gboolean cloth_print_layout (const ClothArtwork * artwork,
    const ClothPrintOptions * options, ClothPrintLayout * layout,
    GError ** error);

GBytes *cloth_print_pdf (const ClothArtwork * artwork,
    const ClothPrintOptions * options, GError ** error);
GBytes *cloth_print_svg (const ClothArtwork * artwork,
    const ClothPrintOptions * options, gint column, gint row, GError ** error);
gchar **cloth_print_save (const ClothArtwork * artwork,
    const ClothPrintOptions * options, const gchar * path, GError ** error);

G_END_DECLS
