/* A piece of checkerboard in a grid of its own: its corners, its squares, its rim.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/checker/link.h"

G_BEGIN_DECLS

/* Free vertices kept around what linking found. */
#define CLOTH_PATCH_MARGIN 2

/* @CLOTH_VERTEX_UNKNOWN: not seen
 * @CLOTH_VERTEX_SADDLE: an inner corner, four squares meet
 * @CLOTH_VERTEX_UNSURE: an inner corner by its look, fitted with a doubt
 * @CLOTH_VERTEX_RIM: a corner fitted where fewer edges meet, e.g. on the board's rim
 */
typedef enum {
  CLOTH_VERTEX_UNKNOWN,
  CLOTH_VERTEX_SADDLE,
  CLOTH_VERTEX_UNSURE,
  CLOTH_VERTEX_RIM
} ClothVertexKind;

/* @columns: vertices in a row, the margin included
 * @rows: vertices in a column
 * @n_squares: cells seen as squares
 * @kind: rows·columns, #ClothVertexKind
 * @x: rows·columns, px
 * @y: rows·columns, px
 * @cov: 3·rows·columns, xx, xy, yy, px²
 * @linked: rows·columns, 1 for saddles that linking joined; others were found later, with
 *   less certainty of what they are
 * @square: rows·columns, 1 where the cell right of and below the vertex was seen as a
 *   square of the board
 * @confidence: rows·columns, of the black squares seen, else 0
 * @inside: rows·columns, for cells not seen: log-likelihood ratio that the board goes on
 *   there
 * @bit: rows·columns, for squares seen: log-likelihood ratio that they carry a dot
 * @odd_black: whether cells with odd column + row are black, else the even ones
 */
typedef struct {
  gint columns, rows;
  guint n_squares;
  guint8 *kind;
  gfloat *x, *y;
  gfloat *cov;
  guint8 *linked;
  guint8 *square;
  gfloat *confidence;
  gfloat *inside;
  gfloat *bit;
  gboolean odd_black;
  /*< private > */
  guint8 *tried;
  gpointer memory;
  gsize capacity;
} ClothPatch;

/* @alpha: width of the template's lapels over the square's edge
 * @c_low: confidence from which a black cell is taken for a square
 * @other_colour: log-likelihood ratio of the board going on at a cell that shows the other
 *   colour
 * @alike: share of the contrast within which a cell shows the other colour
 * @thorough: whether to try harder to find corners, at the cost of exactness
 * @read_bits: whether to look for the dots of a coded board
 */
typedef struct {
  gfloat alpha;
  gfloat c_low;
  gfloat other_colour;
  gfloat alike;
  gboolean thorough;
  gboolean read_bits;
} ClothPatchParams;

static inline gboolean
cloth_patch_is_black (const ClothPatch * patch, gint i, gint j)
{
  return ((i + j) & 1) == (patch->odd_black ? 1 : 0);
}

void cloth_patch_clear (ClothPatch * patch);
void cloth_patch_build (ClothPatch * patch, const ClothImage * image,
    const ClothSaddle * saddles, const ClothLinkPatch * link,
    const ClothPatchParams * params);

G_END_DECLS
