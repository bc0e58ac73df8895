/* Where on the board a patch lies.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/pattern/pattern.h"
#include "gst/vision/patch.h"

G_BEGIN_DECLS

/**
 * ClothPlacement:
 * @rotation: quarter turns from the patch's grid to the board's, 0 to 3
 * @column: board vertex of the patch's vertex (0, 0)
 * @row: likewise
 * @weight: as a vote: log-likelihood in favour; as a result: log-likelihood of this
 *   placement less that of the next best
 *
 * A way to lay a patch on the board: vertex (i, j) of the patch, turned @rotation times
 * by (i, j) → (-j, i), plus (@column, @row).
 *
 * Since: 0.1
 */
typedef struct {
  gint rotation;
  gint column, row;
  gfloat weight;
} ClothPlacement;

void cloth_placement_vertex (const ClothPlacement * placement, gint i, gint j,
    gint * column, gint * row);
void cloth_placement_cell (const ClothPlacement * placement, gint i, gint j,
    gint * column, gint * row);
GArray *cloth_place_scratch_new (void);
gboolean cloth_place_patch (const ClothPattern * pattern,
    const ClothPatch * patch, const ClothPlacement * votes, guint n_votes,
    GArray * scratch, ClothPlacement * best);

G_END_DECLS
