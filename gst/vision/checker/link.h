/* Joining saddle points into patches of a square grid.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/image.h"
#include "gst/vision/corner/saddle.h"

G_BEGIN_DECLS

/* @patch: number of the patch it belongs to, < 0 for none
 * @i: column of the vertex in the patch's own grid, >= 0
 * @j: row of the vertex in the patch's own grid, >= 0
 *
 * What linking says of one saddle.
 */
typedef struct {
  gint patch;
  gint i, j;
} ClothLinkNode;

/* @columns: vertices in a row of the patch's bounding box
 * @rows: vertices in a column
 * @n_nodes: saddles in the patch
 * @size: saddles times the mean diagonal of a square, px: of two boards with as many
 *   saddles the nearer one is larger
 * @node: rows·columns, the saddle at vertex row·columns + column, -1 for none
 * @square: rows·columns, 1 where the cell right of and below the vertex is a square
 *   with its four edges seen
 * @odd_black: whether the cell (0, 0) is white, so that cells with odd column + row are
 *   black
 *
 * One connected piece of checkerboard, in a grid of its own: columns go the way that,
 * turned by 90° from x towards y, gives the rows; where on the board it lies is not known.
 */
typedef struct {
  gint columns, rows;
  guint n_nodes;
  gfloat size;
  gint *node;
  guint8 *square;
  gboolean odd_black;
} ClothLinkPatch;

typedef struct _ClothLinker ClothLinker;

ClothLinker *cloth_linker_new (void);
void cloth_linker_free (ClothLinker * linker);
guint cloth_linker_run (ClothLinker * linker, const ClothImage * image,
    const guint8 * levels, const ClothSaddle * saddles, guint n_saddles,
    const ClothLinkPatch ** patches, const ClothLinkNode ** nodes);
guint cloth_link_largest (const ClothLinkPatch * patches, guint n_patches,
    guint * order, guint n_order);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothLinker, cloth_linker_free)
G_END_DECLS
