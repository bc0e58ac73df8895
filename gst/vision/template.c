/* How well four corners delineate a square: the cross template.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/template.h"

#include <math.h>

/* Samples along an edge. The sums over pixels of the paper become sums over a regular
 * grid in the square's own coordinates: the same for a parallelogram in the limit, and
 * of equal cost for small and large squares. */
#define ALONG 12
#define MAX_ACROSS 12

/* Sums sign (I - mean) over a set of samples. */
static gint
signs (const guint8 * level, gint n, gint mean_times_n, gint total)
{
  gint sum = 0;

  for (gint k = 0; k < n; k++) {
    gint d = level[k] * total - mean_times_n;

    sum += (d > 0) - (d < 0);
  }
  return sum;
}

/**
 * cloth_quad_confidence:
 * @image: the picture
 * @x: columns of the four corners in ring order, px
 * @y: rows of the four corners, px
 * @alpha: width of the lapels over the edge of the square
 * @black: whether the square is black on white, else white on black
 *
 * Confidence of "Direct Pattern Tracking On Flexible Geometry", section 3.5: the square
 * is extended by four lapels to a cross; the share of the cross that is darker than the
 * cross's mean within the square and brighter in the lapels, less the share that is not.
 * Corners need not form a parallelogram: the cross follows the bilinear map of the unit
 * square onto them, whose lapels are the paper's where they do.
 *
 * Returns: confidence in [-1, 1]; -1 when the cross is not wholly inside the picture or a
 *   corner is not finite
 *
 * Since: 0.1
 */
gfloat
cloth_quad_confidence (const ClothImage * image, const gfloat x[4],
    const gfloat y[4], gfloat alpha, gboolean black)
{
  guint8 inside[ALONG * ALONG], lapels[4 * ALONG * MAX_ACROSS];
  gint across = CLAMP ((gint) lrintf (alpha * ALONG), 1, MAX_ACROSS);
  gint n_inside = 0, n_lapels = 0, total, sum = 0, score;
  gfloat limit_x = (gfloat) image->width - 0.5f;
  gfloat limit_y = (gfloat) image->height - 0.5f;

  for (gint v = -across; v < ALONG + across; v++) {
    gboolean in_v = v >= 0 && v < ALONG;
    gint first = in_v ? -across : 0, last = in_v ? ALONG + across : ALONG;
    /* *INDENT-OFF* */
    gfloat t = v < 0 ? alpha * ((gfloat) v + 0.5f) / (gfloat) across
        : v >= ALONG ? 1 + alpha * ((gfloat) (v - ALONG) + 0.5f) / (gfloat) across
        : ((gfloat) v + 0.5f) / ALONG;
    /* *INDENT-ON* */
    /* Left and right edge at height t. */
    gfloat x0 = x[0] + t * (x[3] - x[0]), x1 = x[1] + t * (x[2] - x[1]);
    gfloat y0 = y[0] + t * (y[3] - y[0]), y1 = y[1] + t * (y[2] - y[1]);

    for (gint u = first; u < last; u++) {
      /* *INDENT-OFF* */
      gfloat s = u < 0 ? alpha * ((gfloat) u + 0.5f) / (gfloat) across
          : u >= ALONG ? 1 + alpha * ((gfloat) (u - ALONG) + 0.5f) / (gfloat) across
          : ((gfloat) u + 0.5f) / ALONG;
      /* *INDENT-ON* */
      gfloat px = x0 + s * (x1 - x0), py = y0 + s * (y1 - y0);
      guint8 level;

      if (!(px > -0.5f && py > -0.5f && px < limit_x && py < limit_y))
        return -1;
      level = image->data[(gint) (py + 0.5f) * image->stride
          + (gint) (px + 0.5f)];
      if (in_v && u >= 0 && u < ALONG)
        inside[n_inside++] = level;
      else
        lapels[n_lapels++] = level;
      sum += level;
    }
  }
  total = n_inside + n_lapels;
  score = signs (lapels, n_lapels, sum, total)
      - signs (inside, n_inside, sum, total);
  return (gfloat) (black ? score : -score) / (gfloat) total;
}
