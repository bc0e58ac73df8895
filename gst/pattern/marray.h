/* Colour-coded dots: an M-array printed on black cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/pattern/pattern.h"

G_BEGIN_DECLS

/* Fewest dots each way: those of one window.
 */
#define CLOTH_M_ARRAY_MIN 3

/* Most dots each way; more values than theirs no JSON file may have.
 */
#define CLOTH_M_ARRAY_MAX 400

/* Most colours of dots.
 */
#define CLOTH_M_ARRAY_MAX_COLOURS 8

/* Greatest code distance that can be asked for.
 */
#define CLOTH_M_ARRAY_MAX_DISTANCE 5

/* @name: what people call it, at most 31 bytes
 * @rgb: how it is printed, 0 to 255 each (sRGB)
 */
typedef struct {
  gchar name[32];
  guint8 rgb[3];
} ClothDotColour;

/* @columns: dots in a row
 * @rows: dots in a column
 * @n_colours: colours of dots, 2 to %CLOTH_M_ARRAY_MAX_COLOURS
 * @colours: the first @n_colours of them
 * @pitch_m: from the centre of a dot to that of the next, metres
 * @diameter_m: of a dot, metres
 * @origin_uv_m: centre of the dot in row 0, column 0 on the flat cloth, metres
 * @cloth_m: width and height of the flat cloth, metres
 * @matrix: rows·columns bytes: which colour each dot has
 *
 * Dots of several colours on black cloth. The mesh vertex of a dot is
 * row·columns+column; it lies at origin + (column, row)·pitch_m on the flat cloth.
 */
typedef struct {
  gint columns, rows;
  gint n_colours;
  ClothDotColour colours[CLOTH_M_ARRAY_MAX_COLOURS];
  gdouble pitch_m;
  gdouble diameter_m;
  gdouble origin_uv_m[2];
  gdouble cloth_m[2];
  guint8 *matrix;
} ClothMArray;

/* @distance: least number of dots by which any two windows differ, 1 to
 *   %CLOTH_M_ARRAY_MAX_DISTANCE
 * @two_sided: whether mirror images of windows differ as well: for cloth whose print is
 *   seen from both sides
 * @seed: equal seeds give equal arrays on every machine
 */
typedef struct {
  gint distance;
  gboolean two_sided;
  guint64 seed;
} ClothMArrayCode;

#define CLOTH_M_ARRAY_CODE_INIT { 1, FALSE, 1 }

gboolean cloth_m_array_generate (gint columns, gint rows, gint n_colours,
    const ClothMArrayCode * code, guint8 * matrix, GError ** error);

ClothMArray *cloth_m_array_new (gint columns, gint rows, gint n_colours,
    gdouble pitch_m, gdouble diameter_m, gdouble margin_m,
    const ClothMArrayCode * code, GError ** error);
void cloth_m_array_free (ClothMArray * array);

gboolean cloth_m_array_check (const ClothMArray * array, GError ** error);

ClothMArray *cloth_m_array_load (const gchar * path, GError ** error);
ClothMArray *cloth_m_array_load_data (const gchar * data, gsize size,
    GError ** error);
gboolean cloth_m_array_save (const ClothMArray * array, const gchar * path,
    GError ** error);
gchar *cloth_m_array_to_json (const ClothMArray * array);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothMArray, cloth_m_array_free)
G_END_DECLS
