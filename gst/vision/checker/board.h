/* Finding a checkerboard, flat or bent, whole or in part, in a single picture.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/pattern/pattern.h"
#include "gst/vision/image.h"
#include "gst/vision/checker/patch.h"

G_BEGIN_DECLS

/* @columns: vertices in a row, the pattern's squares + 1
 * @rows: vertices in a column
 * @n_seen: vertices seen
 * @seen: rows·columns, #ClothVertexKind: how the vertex was found, 0 where it wasn't
 * @x: rows·columns, px
 * @y: rows·columns, px
 * @cov: 3·rows·columns, covariance xx, xy, yy, px²
 *
 * The corners of one board in one picture, the outer ones included. Vertex
 * row·@columns + column.
 */
typedef struct {
  gint columns, rows;
  guint n_seen;
  guint8 *seen;
  gfloat *x, *y;
  gfloat *cov;
} ClothBoardView;

void cloth_board_view_init (ClothBoardView * view,
    const ClothPattern * pattern);
void cloth_board_view_forget (ClothBoardView * view);
void cloth_board_view_clear (ClothBoardView * view);

typedef struct _ClothBoardFinder ClothBoardFinder;

ClothBoardFinder *cloth_board_finder_new (const ClothPattern * pattern);
void cloth_board_finder_free (ClothBoardFinder * finder);

gboolean cloth_board_finder_find (ClothBoardFinder * finder,
    const ClothImage * image, const ClothSaddle * saddles, guint n_saddles,
    const ClothBoardView ** view);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothBoardFinder, cloth_board_finder_free)
G_END_DECLS
