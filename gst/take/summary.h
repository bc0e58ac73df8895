/* What a take holds, in a few lines for people.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/take/take.h"

G_BEGIN_DECLS

/* @CLOTH_SIDES_ALL: all sides of the faces
 * @CLOTH_SIDES_U: those that run rather along u, as rows of a grid
 * @CLOTH_SIDES_V: those that run rather along v, as columns
 */
typedef enum {
  CLOTH_SIDES_ALL,
  CLOTH_SIDES_U,
  CLOTH_SIDES_V
} ClothSides;

void cloth_summary_add (GString * table, const gchar * label,
    const gchar * format, ...) G_GNUC_PRINTF (3, 4);
const gchar *cloth_summary_name_sides (ClothSides sides, gboolean grid);
gdouble cloth_summary_stretch (const ClothTopology * topology,
    const gfloat * positions, ClothSides sides, GArray * scratch);
gchar *cloth_take_summarise (ClothTake * take, GError ** error);

G_END_DECLS
