/* Printed patterns: what is on the cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* Most squares a board may have each way.
 */
#define CLOTH_PATTERN_MAX_SQUARES 500

/* @CLOTH_PATTERN_ERROR_FORMAT: the file is no pattern.json
 * @CLOTH_PATTERN_ERROR_UNSUPPORTED: a version or a kind of pattern this build doesn't
 *   know
 * @CLOTH_PATTERN_ERROR_VALUE: a number outside its limits
 * @CLOTH_PATTERN_ERROR_CODE: no code with the wanted distance was found
 * @CLOTH_PATTERN_ERROR_PRINT: the print file could not be drawn
 */
typedef enum {
  CLOTH_PATTERN_ERROR_FORMAT,
  CLOTH_PATTERN_ERROR_UNSUPPORTED,
  CLOTH_PATTERN_ERROR_VALUE,
  CLOTH_PATTERN_ERROR_CODE,
  CLOTH_PATTERN_ERROR_PRINT
} ClothPatternError;

#define CLOTH_PATTERN_ERROR (cloth_pattern_error_quark ())
GQuark cloth_pattern_error_quark (void);

/* @columns: squares in a row
 * @rows: squares in a column
 * @square_m: edge of a square, metres
 * @origin_uv_m: place of the board's top-left outer corner on the flat cloth, metres
 * @cloth_m: width and height of the flat cloth, metres
 * @first_black: whether the square at row 0, column 0 is black
 * @code: (nullable): rows·columns bytes, 1 where the square carries a dot of the
 *   other colour at its centre; %NULL for a plain checkerboard
 * @dot_ratio: diameter of such a dot over the edge of a square
 *
 * A checkerboard, plain or coded. Vertex row·(columns+1)+column is the board corner
 * (column, row), the outer ones included; it lies at
 * origin + (column, row)·square_m on the flat cloth.
 */
typedef struct {
  gint columns, rows;
  gdouble square_m;
  gdouble origin_uv_m[2];
  gdouble cloth_m[2];
  gboolean first_black;
  guint8 *code;
  gdouble dot_ratio;
} ClothPattern;

ClothPattern *cloth_pattern_new_checker (gint columns, gint rows,
    gdouble square_m, gdouble margin_m, gboolean first_black, GError ** error);
void cloth_pattern_free (ClothPattern * pattern);

gboolean cloth_pattern_check (const ClothPattern * pattern, GError ** error);

ClothPattern *cloth_pattern_load (const gchar * path, GError ** error);
ClothPattern *cloth_pattern_load_data (const gchar * data, gsize size,
    GError ** error);
gboolean cloth_pattern_save (const ClothPattern * pattern, const gchar * path,
    GError ** error);
gchar *cloth_pattern_to_json (const ClothPattern * pattern);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothPattern, cloth_pattern_free)

static inline gboolean
cloth_pattern_is_black (const ClothPattern * pattern, gint column, gint row)
{
  return (((column + row) & 1) == 0) == !!pattern->first_black;
}

static inline gboolean
cloth_pattern_has_dot (const ClothPattern * pattern, gint column, gint row)
{
  return pattern->code && pattern->code[row * pattern->columns + column];
}

G_END_DECLS
