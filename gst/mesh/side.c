/* Sides of faces.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/side.h"

/* @from: one end, a vertex
 * @to: the other
 * @face: the face
 * @number: which of its sides
 *
 * Returns: the side, with its ends in order
 */
ClothSide
cloth_side (guint32 from, guint32 to, guint32 face, guint32 number)
{
  return (ClothSide) {
  MIN (from, to), MAX (from, to), face, number};
}

/* @x: a side
 * @y: another
 *
 * Returns: whether they have the same ends
 */
gboolean
cloth_side_same_edge (const ClothSide * x, const ClothSide * y)
{
  return x->a == y->a && x->b == y->b;
}

/* @x: a #ClothSide
 * @y: another
 *
 * For qsort (): sides of the same edge become neighbours, by face, then by number.
 *
 * Returns: their order
 */
gint
cloth_side_compare (gconstpointer x, gconstpointer y)
{
  const ClothSide *p = x, *q = y;

  if (p->a != q->a)
    return p->a < q->a ? -1 : 1;
  if (p->b != q->b)
    return p->b < q->b ? -1 : 1;
  if (p->face != q->face)
    return p->face < q->face ? -1 : 1;
  return p->number < q->number ? -1 : p->number > q->number;
}
