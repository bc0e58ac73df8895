/* Pictures of polygons by brute force: 8 by 8 places a pixel. Shares no formula with what
 * is tested on them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <math.h>
#include <string.h>

#include "gst/vision/image.h"

#define POLYGON_FINE 8

static inline ClothImage
polygon_picture (gint width, gint height, guint8 grey)
{
  guint8 *data = g_malloc ((gsize) width * (gsize) height);

  memset (data, grey, (gsize) width * (gsize) height);
  return (ClothImage) { data, width, height, width };
}

static inline void
polygon_picture_clear (ClothImage * image)
{
  g_free ((gpointer) image->data);
}

/* Even-odd rule; pixel (0, 0) covers [-0.5, 0.5]². */
static inline gboolean
polygon_holds (const gdouble * x, const gdouble * y, guint n, gdouble px,
    gdouble py)
{
  gboolean in = FALSE;

  for (guint a = 0, b = n - 1; a < n; b = a++)
    if ((y[a] > py) != (y[b] > py)
        && px < x[a] + (x[b] - x[a]) * (py - y[a]) / (y[b] - y[a]))
      in = !in;
  return in;
}

static inline void
polygon_paint (ClothImage * image, const gdouble * x, const gdouble * y,
    guint n, guint8 grey)
{
  guint8 *data = (guint8 *) image->data;
  gdouble left = x[0], right = x[0], top = y[0], bottom = y[0];

  for (guint k = 1; k < n; k++) {
    left = MIN (left, x[k]);
    right = MAX (right, x[k]);
    top = MIN (top, y[k]);
    bottom = MAX (bottom, y[k]);
  }
  for (gint v = MAX (0, (gint) top - 1);
      v <= MIN (image->height - 1, (gint) bottom + 1); v++)
    for (gint u = MAX (0, (gint) left - 1);
        u <= MIN (image->width - 1, (gint) right + 1); u++) {
      guint8 *at = data + v * image->stride + u;
      gint covered = 0;

      for (gint k = 0; k < POLYGON_FINE * POLYGON_FINE; k++)
        covered += polygon_holds (x, y, n,
            u + (k % POLYGON_FINE + 0.5) / POLYGON_FINE - 0.5,
            v + (k / POLYGON_FINE + 0.5) / POLYGON_FINE - 0.5);
      *at = (guint8) lrint (*at + (grey - *at) * covered
          / (gdouble) (POLYGON_FINE * POLYGON_FINE));
    }
}

/* A rectangle with upright sides. */
static inline void
polygon_paint_box (ClothImage * image, gdouble left, gdouble top,
    gdouble right, gdouble bottom, guint8 grey)
{
  const gdouble x[4] = { left, right, right, left };
  const gdouble y[4] = { top, top, bottom, bottom };

  polygon_paint (image, x, y, 4, grey);
}

/* Corners of a square turned by @angle, in ring order from x towards y. */
static inline void
polygon_square (gdouble cx, gdouble cy, gdouble side, gdouble angle,
    gdouble x[4], gdouble y[4])
{
  for (gint k = 0; k < 4; k++) {
    gdouble to = angle + G_PI * (2 * k - 3) / 4;

    x[k] = cx + side * G_SQRT2 / 2 * cos (to);
    y[k] = cy + side * G_SQRT2 / 2 * sin (to);
  }
}
