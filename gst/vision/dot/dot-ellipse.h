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

/* The whole number not above (not below) @v, for what may be a place in a picture. */
#define CLOTH_DOT_FAR_AWAY 1048576

static inline gint
cloth_dot_floor_place (gdouble v)
{
  return (gint) (v + CLOTH_DOT_FAR_AWAY) - CLOTH_DOT_FAR_AWAY;
}

static inline gint
cloth_dot_ceil_place (gdouble v)
{
  return CLOTH_DOT_FAR_AWAY - (gint) (CLOTH_DOT_FAR_AWAY - v);
}

ClothDotAxes cloth_dot_axes (const gdouble shape[3]);
ClothDotEllipse cloth_dot_ellipse (const ClothDotAxes * axes, gdouble scale,
    gdouble margin);
void cloth_dot_ellipse_rows (const ClothDotEllipse * ellipse, gdouble cx,
    gdouble cy, gint y0, gint n, gint width, gint * first, gint * last,
    ClothSimd level);

G_END_DECLS
