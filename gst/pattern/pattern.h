/* Printed patterns: what is on the cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/**
 * ClothPattern:
 * @columns: squares in a row
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
 *
 * Since: 0.1
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

static inline gboolean
cloth_pattern_is_black (const ClothPattern * pattern, gint column, gint row)
{
  return (((column + row) & 1) == 0) == !!pattern->first_black;
}

G_END_DECLS
