/* Where on the board a patch of one picture lies, half hidden as it may be.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/place.h"

G_BEGIN_DECLS

typedef struct _ClothBoardScratch ClothBoardScratch;

ClothBoardScratch *cloth_board_scratch_new (void);
void cloth_board_scratch_free (ClothBoardScratch * scratch);
gboolean cloth_place_board (const ClothPattern * pattern,
    const ClothPatch * patch, const ClothPlacement * votes, guint n_votes,
    ClothBoardScratch * scratch, ClothPlacement * best);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothBoardScratch, cloth_board_scratch_free)
G_END_DECLS
