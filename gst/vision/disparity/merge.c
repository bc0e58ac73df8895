/* Disparities of one or two baselines on the pixels of one picture.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/disparity/merge.h"

#include <math.h>
#include <stdlib.h>

/* The most baselines of a map. */
#define MOST_PAIRS 8
/* Neighbours that differ by more are of two surfaces: no value between them, px. */
#define EDGE 1

/* @disparities: of the left picture
 * @width: pixels a row; rows without gaps
 * @height: rows
 *
 * Returns: the pair that cloth_cv_stereo_run () gives, whose left picture is the map's and
 *   which is the only one or the first: 16 steps a pixel, −16 where there is none
 */
ClothDisparityPair
cloth_disparity_pair (const gint16 * disparities, gint width, gint height)
{
  return (ClothDisparityPair) {
    disparities, width, height, width, 16, -16, {
    1, 0, 0, 0, 1, 0, 0, 0, 1}
    , {
    0, 0, 1}
  , 0};
}

static gboolean
check_pair (const ClothDisparityPair * pair, GError ** error)
{
  gboolean is_finite = isfinite (pair->offset);

  if (!cloth_disparity_check_size (pair->width, pair->height, pair->stride,
          error))
    return FALSE;
  for (gint i = 0; i < 9; i++)
    is_finite &= isfinite (pair->place[i]);
  for (gint i = 0; i < 3; i++)
    is_finite &= isfinite (pair->unit[i]);
  if (is_finite && pair->steps >= 1 && pair->steps <= 256)
    return TRUE;
  g_set_error (error, CLOTH_DISPARITY_ERROR, CLOTH_DISPARITY_ERROR_PARAMETER,
      is_finite ? "%d steps of a pixel: make it 1 to 256" : "The place of a "
      "pair with %d steps of a pixel contains what is no number", pair->steps);
  return FALSE;
}

/* @left: (inout): disparities of the left picture's pixels, sixteenths of a pixel
 * @right: those of the right picture's, columns from the right end on, as matching gives
 *   them for the two pictures mirrored and swapped
 * @width: pixels a row; rows without gaps
 * @height: rows
 * @none: what stands for no disparity
 * @most: greatest difference of what one pixel has from left to right and from right to
 *   left, sixteenths, >= 0
 * @error: (out): set on failure
 *
 * The left–right check: what doesn't lead back to its pixel is hidden or wrong, and becomes
 * @none.
 *
 * Returns: %FALSE on error
 */
gboolean
cloth_disparity_check (gint16 * left, const gint16 * right, gint width,
    gint height, gint16 none, gint most, GError ** error)
{
  if (!cloth_disparity_check_size (width, height, width, error))
    return FALSE;
  if (most < 0) {
    g_set_error (error, CLOTH_DISPARITY_ERROR, CLOTH_DISPARITY_ERROR_PARAMETER,
        "A difference of %d sixteenths from left to right: it can't be below 0",
        most);
    return FALSE;
  }
  for (gint y = 0; y < height; y++)
    for (gint x = 0; x < width; x++) {
      gint16 *here = left + (gsize) y * (gsize) width + (gsize) x;
      /* the nearest pixel: shifts of negative numbers round down, too */
      const gint to = x - ((*here + 8) >> 4), mirrored = width - 1 - to;
      gint16 back;

      if (*here == none)
        continue;
      if (to < 0 || to >= width) {
        *here = none;
        continue;
      }
      back = right[(gsize) y * (gsize) width + (gsize) mirrored];
      if (back == none || abs (back - *here) > most)
        *here = none;
    }
  return TRUE;
}

/* @pair: disparities
 * @least: least disparity that was looked for, px
 * @most: greatest
 * @border: (out): how much of what was found lies at the ends of the range; 0 where nothing
 *   was found
 * @error: (out): set on failure
 *
 * Returns: %FALSE on error
 */
gboolean
cloth_disparity_border (const ClothDisparityPair * pair, gdouble least,
    gdouble most, ClothDisparityBorder * border, GError ** error)
{
  guint n = 0, n_least = 0, n_most = 0;

  *border = (ClothDisparityBorder) {
  0, 0};
  if (!check_pair (pair, error))
    return FALSE;
  for (gint y = 0; y < pair->height; y++)
    for (gint x = 0; x < pair->width; x++) {
      const gint d = pair->disparities[(gsize) y * (gsize) pair->stride
          + (gsize) x];

      if (d == pair->none)
        continue;
      n++;
      n_least += d < (least + 1) * pair->steps;
      n_most += d > (most - 1) * pair->steps;
    }
  if (n > 0)
    *border = (ClothDisparityBorder) {
    n_least / (gdouble) n, n_most / (gdouble) n};
  return TRUE;
}

static gdouble
get (const ClothDisparityPair * pair, gint x, gint y)
{
  const gint16 d = x < 0 || y < 0 || x >= pair->width || y >= pair->height ?
      pair->none : pair->disparities[(gsize) y * (gsize) pair->stride
      + (gsize) x];

  return d == pair->none ? NAN : d / (gdouble) pair->steps;
}

/* A pair's disparity at a place between its pixels: bilinear, or of the nearest one where
 * not all four are of one surface. */
static gdouble
interpolate (const ClothDisparityPair * pair, gdouble x, gdouble y)
{
  const gint near_x = (gint) floor (x + 0.5), near_y = (gint) floor (y + 0.5);
  const gint left = (gint) floor (x), top = (gint) floor (y);
  const gdouble here = get (pair, near_x, near_y);
  const gdouble u = x - left, v = y - top;
  gdouble sum = 0;

  if ((near_x == x && near_y == y) || isnan (here))
    return here;
  for (gint i = 0; i < 4; i++) {
    const gdouble weight = (i & 1 ? u : 1 - u) * (i & 2 ? v : 1 - v);
    const gdouble d = get (pair, left + (i & 1), top + (i >> 1));

    if (!(weight > 0))
      continue;
    if (!(fabs (d - here) <= EDGE))
      return here;
    sum += weight * d;
  }
  return sum;
}

/* What a pair says of a pixel of the map, in the unit of the first pair; NaN: nothing.
 * @scale: (out): the factor between the units. */
static gdouble
look_up (const ClothDisparityPair * pair, gint column, gint row,
    gdouble * scale)
{
  const gdouble *h = pair->place;
  const gdouble x = h[0] * column + h[1] * row + h[2];
  const gdouble y = h[3] * column + h[4] * row + h[5];
  const gdouble z = h[6] * column + h[7] * row + h[8];

  *scale = pair->unit[0] * column + pair->unit[1] * row + pair->unit[2];
  /* also false for what is no number */
  if (!(z > 0 && *scale > 0 && x / z > -1 && y / z > -1 && x / z < pair->width
          && y / z < pair->height))
    return NAN;
  return *scale * (interpolate (pair, x / z, y / z) + pair->offset);
}

/* The mean of what pairs say that agree; NaN if any two don't. */
static gdouble
agree (const ClothDisparityPair * pairs, guint n_pairs, gint x, gint y,
    gdouble most)
{
  gdouble least = INFINITY, greatest = -INFINITY, sum = 0, weights = 0;

  for (guint i = 0; i < n_pairs; i++) {
    gdouble scale;
    const gdouble d = look_up (&pairs[i], x, y, &scale);
    /* errors of a shorter baseline are enlarged with it */
    const gdouble weight = 1 / (scale * scale);

    if (!(fabs (d) <= CLOTH_DISPARITY_MOST))
      continue;
    least = fmin (least, d);
    greatest = fmax (greatest, d);
    sum += weight * d;
    weights += weight;
  }
  return greatest - least <= most ? sum / weights : NAN;
}

typedef struct
{
  const ClothDisparityPair *pairs;
  guint n_pairs;
  gdouble most;
  const ClothDisparityMap *map;
} Merging;

static void
merge_rows (gpointer data, guint begin, guint end, guint worker)
{
  const Merging *m = data;
  const ClothDisparityMap *map = m->map;

  for (guint y = begin; y < end; y++)
    for (gint x = 0; x < map->width; x++) {
      const gsize at = (gsize) y * (gsize) map->stride + (gsize) x;
      gdouble d = NAN;

      if (map->states[at] != CLOTH_DISPARITY_OUTSIDE) {
        d = agree (m->pairs, m->n_pairs, x, (gint) y, m->most);
        map->states[at] = isnan (d) ? CLOTH_DISPARITY_HOLE :
            CLOTH_DISPARITY_MEASURED;
      }
      map->disparities[at] = (gfloat) d;
    }
}

/* @pairs: (array length=n_pairs): the disparities of each baseline
 * @n_pairs: 1 to 8
 * @most: greatest difference of two baselines that are both taken, in px of the first, > 0
 * @map: (inout): states in, those of the mask; disparities and states out
 * @pool: (nullable): threads
 * @error: (out): set on failure
 *
 * Of baselines that agree a pixel has the mean, weighted by their lengths squared; where only
 * one sees it, its disparity; where they disagree, none.
 *
 * Returns: %FALSE on error
 */
gboolean
cloth_disparity_merge (const ClothDisparityPair * pairs, guint n_pairs,
    gdouble most, ClothDisparityMap * map, ClothPool * pool, GError ** error)
{
  Merging merging = { pairs, n_pairs, most, map };

  if (!cloth_disparity_check_size (map->width, map->height, map->stride, error))
    return FALSE;
  if (n_pairs < 1 || n_pairs > MOST_PAIRS || !(most > 0)) {
    g_set_error (error, CLOTH_DISPARITY_ERROR, CLOTH_DISPARITY_ERROR_PARAMETER,
        "%u pairs that may differ by %g px: 1 to %d may, by more than 0",
        n_pairs, most, MOST_PAIRS);
    return FALSE;
  }
  for (guint i = 0; i < n_pairs; i++)
    if (!check_pair (&pairs[i], error))
      return FALSE;
  cloth_pool_run (pool, merge_rows, &merging, (guint) map->height);
  return TRUE;
}
