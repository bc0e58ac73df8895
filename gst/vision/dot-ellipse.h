/* Ellipses about dots, row by row.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/cpu.h"

G_BEGIN_DECLS

/* Half-axes, px, and the cosine and sine of twice the angle of the longer one. */
typedef struct
{
  gdouble a, b, c, s;
} ClothDotAxes;

/* An ellipse about a centre, A·dx² + 2·B·dx·dy + C·dy² ≤ 1, as its rows need it: dx is
 * within √(widest − narrowing·dy²) of slope·dy. */
typedef struct
{
  gdouble slope, widest, narrowing;
  gdouble width, height;        /* greatest dx and dy */
} ClothDotEllipse;

ClothDotAxes cloth_dot_axes (const gdouble shape[3]);
ClothDotEllipse cloth_dot_ellipse (const ClothDotAxes * axes, gdouble scale,
    gdouble margin);
void cloth_dot_ellipse_rows (const ClothDotEllipse * ellipse, gdouble cx,
    gdouble cy, gint y0, gint n, gint width, gint * first, gint * last,
    ClothSimd level);

G_END_DECLS
