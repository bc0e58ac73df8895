/* How well four corners delineate a square: the cross template.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/checker/template.h"

#include <math.h>

/* Samples along an edge. The sums over pixels of the paper become sums over a regular
 * grid in the square's own coordinates: the same for a parallelogram in the limit, and
 * of equal cost for small and large squares. */
#define ALONG 12
#define MAX_ACROSS 12
/* Levels compared along an edge, and how far on either side of it, in squares. */
#define BESIDE 5
#define DEPTH 0.25f

/* How many levels are above @high less how many are below @low. */
static inline gint
signs (const gint16 * level, gint n, gint16 high, gint16 low)
{
  gint16 sum = 0;

  for (gint k = 0; k < n; k++)
    sum = (gint16) (sum + (level[k] > high) - (level[k] < low));
  return sum;
}

/* Whether the whole cross lies in the picture: its outermost corners do. */
static gboolean
is_inside (const ClothImage * image, const gfloat x[4], const gfloat y[4],
    gfloat alpha)
{
  gfloat limit_x = (gfloat) image->width - 1, limit_y =
      (gfloat) image->height - 1;

  for (gint k = 0; k < 4; k++)
    for (gint way = 1; way <= 3; way += 2) {
      gint from = (k + way) & 3;
      gfloat px = x[k] + alpha * (x[k] - x[from]);
      gfloat py = y[k] + alpha * (y[k] - y[from]);

      if (!(px >= 0 && py >= 0 && px <= limit_x && py <= limit_y))
        return FALSE;
    }
  return TRUE;
}

/* Takes @n levels along (@x, @y) + s·(@dx, @dy) from s = @first in steps of @step, in
 * fixed point with 16 bits behind the point. */
static gint
take (const ClothImage * image, gfloat x, gfloat y, gfloat dx, gfloat dy,
    gfloat first, gfloat step, gint n, gint16 * levels)
{
  const guint8 *data = image->data;
  gint stride = image->stride;
  gint px = (gint) ((x + first * dx + 0.5f) * 65536.0f);
  gint py = (gint) ((y + first * dy + 0.5f) * 65536.0f);
  gint sx = (gint) (step * dx * 65536.0f), sy = (gint) (step * dy * 65536.0f);

  for (gint k = 0; k < n; k++, px += sx, py += sy)
    levels[k] = data[(py >> 16) * stride + (px >> 16)];
  return n;
}

/* @image: the picture
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
 */
gfloat
cloth_quad_confidence (const ClothImage * image, const gfloat x[4],
    const gfloat y[4], gfloat alpha, gboolean black)
{
  gint16 inside[ALONG * ALONG], lapels[4 * ALONG * MAX_ACROSS];
  gint across = CLAMP ((gint) lrintf (alpha * ALONG), 1, MAX_ACROSS);
  gfloat wide = alpha / (gfloat) across;
  gint n_inside = 0, n_lapels = 0, total, sum = 0, low, score;

  if (!is_inside (image, x, y, alpha))
    return -1;
  for (gint v = -across; v < ALONG + across; v++) {
    gboolean in_v = v >= 0 && v < ALONG;
    gfloat t = v < 0 ? wide * ((gfloat) v + 0.5f)
        : v >= ALONG ? 1 + wide * ((gfloat) (v - ALONG) + 0.5f)
        : ((gfloat) v + 0.5f) / ALONG;
    /* Left and right edge at height t. */
    gfloat x0 = x[0] + t * (x[3] - x[0]), x1 = x[1] + t * (x[2] - x[1]);
    gfloat y0 = y[0] + t * (y[3] - y[0]), y1 = y[1] + t * (y[2] - y[1]);

    if (in_v) {
      n_lapels += take (image, x0, y0, x1 - x0, y1 - y0,
          wide * (0.5f - (gfloat) across), wide, across, lapels + n_lapels);
      n_inside += take (image, x0, y0, x1 - x0, y1 - y0, 0.5f / ALONG,
          1.0f / ALONG, ALONG, inside + n_inside);
      n_lapels += take (image, x0, y0, x1 - x0, y1 - y0, 1 + 0.5f * wide, wide,
          across, lapels + n_lapels);
    } else {
      n_lapels += take (image, x0, y0, x1 - x0, y1 - y0, 0.5f / ALONG,
          1.0f / ALONG, ALONG, lapels + n_lapels);
    }
  }
  for (gint k = 0; k < n_inside; k++)
    sum += inside[k];
  for (gint k = 0; k < n_lapels; k++)
    sum += lapels[k];
  total = n_inside + n_lapels;
  /* The mean is no whole number mostly: above it is above its floor. */
  low = (sum + total - 1) / total;
  score = signs (lapels, n_lapels, (gint16) (sum / total), (gint16) low)
      - signs (inside, n_inside, (gint16) (sum / total), (gint16) low);
  return (gfloat) (black ? score : -score) / (gfloat) total;
}

static inline gint
level_at (const ClothImage * image, gfloat x, gfloat y)
{
  return image->data[(gint) (y + 0.5f) * image->stride + (gint) (x + 0.5f)];
}

static gfloat
middle_two (const gfloat v[4])
{
  gfloat least = v[0], most = v[0], sum = 0;

  for (gint k = 0; k < 4; k++) {
    least = MIN (least, v[k]);
    most = MAX (most, v[k]);
    sum += v[k];
  }
  return 0.5f * (sum - least - most);
}

/* @image: the picture
 * @x: columns of the four corners in ring order, px
 * @y: rows of the four corners, px
 * @black: whether the square is black on white, else white on black
 *
 * Level of the print's dark colour over that of its bright one, as the square shows it on
 * either side of its edges. What light falls on the one side falls on the other too, so
 * light and shadow leave it as it is. Two of the sides may show something else, one lighter
 * and one darker: it is the mean of the middle two.
 *
 * Returns: ratio, > 0; -1 where the square lies at the picture's edge
 */
gfloat
cloth_quad_shade (const ClothImage * image, const gfloat x[4],
    const gfloat y[4], gboolean black)
{
  gfloat shade[4];

  if (!is_inside (image, x, y, DEPTH))
    return -1;
  for (gint k = 0; k < 4; k++) {
    const gint to = (k + 1) & 3, far = (k + 2) & 3, back = (k + 3) & 3;
    gint in = 0, out = 0;

    for (gint n = 0; n < BESIDE; n++) {
      const gfloat s = 0.3f + 0.4f * (gfloat) n / (BESIDE - 1);
      const gfloat ex = x[k] + s * (x[to] - x[k]);
      const gfloat ey = y[k] + s * (y[to] - y[k]);
      const gfloat dx = DEPTH * (x[back] + s * (x[far] - x[back]) - ex);
      const gfloat dy = DEPTH * (y[back] + s * (y[far] - y[back]) - ey);

      in += level_at (image, ex + dx, ey + dy);
      out += level_at (image, ex - dx, ey - dy);
    }
    shade[k] = (gfloat) (black ? in : out) / (gfloat) MAX (black ? out : in, 1);
  }
  return middle_two (shade);
}

/* @image: the picture
 * @x: columns of the four corners in ring order, px
 * @y: rows of the four corners, px
 * @black: whether the square is black on white, else white on black
 *
 * How evenly light falls on a square: the dimmest level of the print's bright colour along
 * its edges over the brightest.
 *
 * Returns: ratio, no more than 1; 1 where the square lies at the picture's edge
 */
gfloat
cloth_quad_light (const ClothImage * image, const gfloat x[4],
    const gfloat y[4], gboolean black)
{
  const gfloat depth = black ? -DEPTH : DEPTH;
  gint least = 255, most = 1;

  if (!is_inside (image, x, y, DEPTH))
    return 1;
  for (gint k = 0; k < 4; k++) {
    const gint to = (k + 1) & 3, far = (k + 2) & 3, back = (k + 3) & 3;

    for (gint n = 0; n < BESIDE; n++) {
      const gfloat s = 0.1f + 0.8f * (gfloat) n / (BESIDE - 1);
      const gfloat ex = x[k] + s * (x[to] - x[k]);
      const gfloat ey = y[k] + s * (y[to] - y[k]);
      const gint level = level_at (image,
          ex + depth * (x[back] + s * (x[far] - x[back]) - ex),
          ey + depth * (y[back] + s * (y[far] - y[back]) - ey));

      least = MIN (least, level);
      most = MAX (most, level);
    }
  }
  return (gfloat) MIN (least, most) / (gfloat) most;
}
