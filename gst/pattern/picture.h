/* Any printed cloth: the flat picture that it shows.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/pattern/pattern.h"

G_BEGIN_DECLS

/* Fewest and most vertices each way.
 */
#define CLOTH_PICTURE_PATTERN_MIN 2
#define CLOTH_PICTURE_PATTERN_MAX 500

/* Most vertices in all: as many as go along with a picture.
 */
#define CLOTH_PICTURE_PATTERN_MAX_VERTICES 65536

/* Edge of the cells of a grid that nobody has asked for otherwise, metres: as dense as the
 * paper's dots.
 */
#define CLOTH_PICTURE_PATTERN_CELL 0.02

/* @reference: (type filename): the flat picture, a scan or a photograph
 * @cloth_m: width and height of the cloth that it shows, metres
 * @columns: of the grid of vertices, %CLOTH_PICTURE_PATTERN_MIN to
 *   %CLOTH_PICTURE_PATTERN_MAX
 * @rows: of the same
 * @sides: 1, or 2 where the print shows through or is on both: the back shows it mirrored
 *
 * A cloth with any print. Vertex row·columns+column lies at
 * u = column·width/(columns − 1), v = row·height/(rows − 1) from the picture's top-left
 * edge; the centre of the picture's pixel (i, j) is at u = (i + 0.5)·width over its pixels
 * a row, v likewise.
 */
typedef struct {
  gchar *reference;
  gdouble cloth_m[2];
  gint columns, rows;
  gint sides;
} ClothPicturePattern;

ClothPicturePattern *cloth_picture_pattern_new (const gchar * reference,
    const gdouble cloth_m[2], gint columns, gint rows, gint sides,
    GError ** error);
void cloth_picture_pattern_free (ClothPicturePattern * pattern);

gboolean cloth_picture_pattern_check (const ClothPicturePattern * pattern,
    GError ** error);
void cloth_picture_pattern_get_edges (const ClothPicturePattern * pattern,
    gdouble edge_m[2]);

ClothPicturePattern *cloth_picture_pattern_load (const gchar * path,
    GError ** error);
ClothPicturePattern *cloth_picture_pattern_load_data (const gchar * data,
    gsize size, GError ** error);
gboolean cloth_picture_pattern_save (const ClothPicturePattern * pattern,
    const gchar * path, GError ** error);
gchar *cloth_picture_pattern_to_json (const ClothPicturePattern * pattern);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothPicturePattern, cloth_picture_pattern_free)
G_END_DECLS
