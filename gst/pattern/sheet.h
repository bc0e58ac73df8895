/* Draws one sheet of a print file.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/pattern/print.h"

#include <cairo.h>

G_BEGIN_DECLS

/* The strip below the cloth: room for marks, ruler and patches, two lines of text. */
#define CLOTH_SHEET_STRIP_MM 25.0
#define CLOTH_SHEET_STRIP_WIDTH_MM 128.0
/* From the cloth's lower edge to the ruler's line, and its length. */
#define CLOTH_SHEET_RULER_MM 7.0
#define CLOTH_SHEET_RULER_LENGTH_MM 100

void cloth_sheet_draw (cairo_t * cr, const ClothArtwork * artwork,
    const ClothPrintOptions * options, const ClothPrintLayout * layout,
    gint column, gint row);

G_END_DECLS
