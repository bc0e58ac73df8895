/* Recordings of other programs become takes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/take/take.h"

G_BEGIN_DECLS

/* @source: a table (CSV), `.c3d`, `.npy`, `.pc2`, `.obj` or `.ply`; of numbered files the first
 * @output: the folder of the take
 * @unit_m: metres a unit of length; 0: what the file says, else metres
 * @axes: (nullable): `z-up`, `y-up`, `x-up`, or which of the source's axes becomes x, y and z,
 *   such as `x,-z,y`
 * @fps: frames a second; 0: what the file says
 * @columns, @rows: vertices of a grid, 0 without one
 * @width_m, @height_m: its size on the flat cloth
 * @mesh: (nullable): an OBJ file with uv in metres, its vertices in the source's order
 * @clamps: (nullable): what clamps hold, `VERTEX` or `VERTEX=NAME`, where NAME is the marker
 *   whose path the clamp took; a vertex is a number or a marker's name
 * @clamp_file: (nullable): the table in which these names are looked up, by default the source
 * @zero_is_missing: what lies at 0, 0, 0 was not seen
 * @overwrite: an older take of the name goes
 */
typedef struct {
  const gchar *source;
  const gchar *output;
  gdouble unit_m;
  const gchar *axes;
  gdouble fps;
  guint columns, rows;
  gdouble width_m, height_m;
  const gchar *mesh;
  const gchar *const *clamps;
  const gchar *clamp_file;
  gboolean zero_is_missing;
  gboolean overwrite;
} ClothImport;

gchar *cloth_take_import (const ClothImport * import, GError ** error);

G_END_DECLS
