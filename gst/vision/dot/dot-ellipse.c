/* Ellipses about dots, row by row.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/dot/dot-ellipse.h"

#include <math.h>

/* The ellipse of second moments @shape. */
ClothDotAxes
cloth_dot_axes (const gdouble shape[3])
{
  const gdouble mean = (shape[0] + shape[2]) / 2;
  const gdouble half = (shape[0] - shape[2]) / 2;
  const gdouble root = sqrt (half * half + shape[1] * shape[1]);

  return (ClothDotAxes) {
  2 *sqrt (mean + root), 2 * sqrt (MAX (mean - root, 1.0 / 12)),
        root > 0 ? half / root : 1, root > 0 ? shape[1] / root : 0};
}

/* With half-axes @scale times as long and @margin longer. */
ClothDotEllipse
cloth_dot_ellipse (const ClothDotAxes * axes, gdouble scale, gdouble margin)
{
  const gdouble a = axes->a * scale + margin, b = axes->b * scale + margin;
  const gdouble p = (1 / (a * a) + 1 / (b * b)) / 2;
  const gdouble q = (1 / (a * a) - 1 / (b * b)) / 2;
  const gdouble A = p + q * axes->c, B = q * axes->s, C = p - q * axes->c;

  return (ClothDotEllipse) {
  -B / A, 1 / A, 1 / (a * a * b * b * A * A), sqrt (C) * a * b,
        sqrt (A) * a * b};
}

#define INLINE static inline __attribute__((always_inline))

/* Without branches, so that the compiler makes vectors of it; √, +, · and / are rounded
 * alike in all of them. */
INLINE void
rows (const ClothDotEllipse * ellipse, gdouble cx, gdouble cy, gint y0, gint n,
    gint width, gint * restrict first, gint * restrict last)
{
  for (gint i = 0; i < n; i++) {
    const gdouble dy = (y0 + i) - cy;
    const gdouble middle = cx + ellipse->slope * dy;
    const gdouble square = ellipse->widest - ellipse->narrowing * dy * dy;
    const gdouble half = sqrt (square > 0 ? square : 0);
    /* beyond the ellipse from behind the picture's end, so that nothing is left */
    const gint none = square < 0 ? width : 0;
    const gint from = cloth_dot_ceil_place (middle - half);
    const gint to = cloth_dot_floor_place (middle + half);

    first[i] = MAX (none, from);
    last[i] = MIN (width - 1, to);
  }
}

#if defined (__x86_64__) && defined (__GNUC__)
#pragma GCC push_options
#pragma GCC target ("avx2")
static void
rows_avx2 (const ClothDotEllipse * ellipse, gdouble cx, gdouble cy, gint y0,
    gint n, gint width, gint * first, gint * last)
{
  rows (ellipse, cx, cy, y0, n, width, first, last);
}

#pragma GCC pop_options
#endif

/* The pixels of @n rows from @y0 on within the ellipse about (@cx, @cy) and the picture's
 * @width: from @first to @last, none where @first is greater. */
void
cloth_dot_ellipse_rows (const ClothDotEllipse * ellipse, gdouble cx,
    gdouble cy, gint y0, gint n, gint width, gint * first, gint * last,
    ClothSimd level)
{
#if defined (__x86_64__) && defined (__GNUC__)
  if (level >= CLOTH_SIMD_AVX2) {
    rows_avx2 (ellipse, cx, cy, y0, n, width, first, last);
    return;
  }
#endif
  rows (ellipse, cx, cy, y0, n, width, first, last);
}
