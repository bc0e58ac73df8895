/* Pattern files of any print.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/pattern/picture.h"
#include "gst/pattern/sheet.h"

G_BEGIN_DECLS

/* @cloth_m: width and height of the cloth that the picture shows; height 0: by the picture's
 *   shape
 * @columns: of the grid's vertices; 0: see cloth_picture_pattern_new()
 * @rows: of the same
 * @sides: 1 or 2
 * @output: the file to write
 */
typedef struct {
  gdouble cloth_m[2];
  gint columns, rows, sides;
  const gchar *output;
} PrintedPicture;

/* Writes pattern.json of a scan of the whole cloth, and copies the scan beside it; or of a sheet,
 * with its picture. Says which files were written, how many features the print has and which
 * share of them is repeated. The picture of @pattern is put beside @json. Returns: an exit
 * code. */
gint pattern_from_scan (const PrintedPicture * printed, const gchar * scan);
gint pattern_from_sheet (ClothPicturePattern * pattern,
    const ClothSheet * sheet, const gchar * json);

G_END_DECLS
