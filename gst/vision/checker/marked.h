/* Checkerboards with a marker in each white square (ChArUco): of what is seen of them, each corner
 * is known by the markers beside it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/checker/board.h"

G_BEGIN_DECLS

typedef struct _ClothMarkedBoard ClothMarkedBoard;

ClothMarkedBoard *cloth_marked_board_new (const ClothPattern * pattern,
    gdouble marker);
void cloth_marked_board_free (ClothMarkedBoard * board);

guint cloth_marked_board_set_markers (ClothMarkedBoard * board, guint n,
    const gint * ids, const gfloat * corners);
gdouble cloth_marked_board_get_margin (const ClothMarkedBoard * board);
gboolean cloth_marked_board_find (ClothMarkedBoard * board,
    const ClothSaddle * saddles, guint n_saddles, const ClothBoardView ** view);
gboolean cloth_marked_board_is_contradicted (const ClothMarkedBoard * board);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothMarkedBoard, cloth_marked_board_free)
G_END_DECLS
