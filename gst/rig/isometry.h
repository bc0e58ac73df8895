/* Cloth bends but hardly stretches: points too far from or too near to their neighbours are
 * wrong.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* @columns: vertices in a row of the grid
 * @rows: vertices in a column
 * @edge_m: distance of neighbours in a row and in a column on the flat cloth, metres
 * @shortest: least distance of neighbours in space over @edge_m; less than 1 since a chord
 *   is shorter than the bent cloth below it; 0: no limit
 * @longest: largest distance over @edge_m; more than 1 by what the cloth stretches; 0: no
 *   limit
 */
typedef struct {
  guint columns, rows;
  gdouble edge_m[2];
  gdouble shortest, longest;
} ClothIsometry;

guint cloth_isometry_check (const ClothIsometry * isometry,
    const gfloat * positions, const gfloat * covariances, gboolean * wrong,
    gdouble * denials);

G_END_DECLS
