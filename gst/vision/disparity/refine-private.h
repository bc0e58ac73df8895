/* What refining shares with its inner loop.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/simd.h"

G_BEGIN_DECLS

/* @here: row of the map's picture
 * @there: the same row of the other camera's
 * @shown: (nullable): bytes of that row: 0 where it shows nothing
 * @width: pixels of the other camera's row
 * @shift: how far each pixel of disparity moves along that row
 * @disparities, @states: row of the map
 * @known: least state of what has a disparity
 * @count: (out): 1 where the other camera sees the pixel, else 0
 * @gradient: (out): of the other picture along the shift; NaN: not seen
 * @difference: (out): of the two pictures; 0: not seen
 */
typedef struct {
  const guint8 *here, *there, *shown;
  gint width;
  gdouble shift;
  const gfloat *disparities;
  const guint8 *states;
  guint8 known;
  gfloat *count, *gradient, *difference;
} ClothRefineRow;

/* @compare: columns @begin to @end of a row that the other camera sees as a row */
typedef struct {
  void (*compare) (const ClothRefineRow * row, gint begin, gint end);
} ClothRefineKernel;

CLOTH_SIMD_TABLES (ClothRefineKernel, cloth_refine_kernel);

/* Cubic through four samples (Catmull and Rom), @t of the way from b to c. */
static inline gdouble
cloth_refine_cubic (const gdouble s[4], gdouble t, gdouble * slope)
{
  const gdouble first = 0.5 * (s[2] - s[0]);
  const gdouble second = s[0] - 2.5 * s[1] + 2 * s[2] - 0.5 * s[3];
  const gdouble third = 0.5 * (s[3] - s[0]) + 1.5 * (s[1] - s[2]);

  *slope = first + t * (2 * second + t * 3 * third);
  return s[1] + t * (first + t * (second + t * third));
}

G_END_DECLS
