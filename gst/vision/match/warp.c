/* Polynomials of second order between two pictures.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/match/warp.h"

#include <math.h>

/* Newton's steps to a place, and when it is reached, px. */
#define STEPS 8
#define REACHED 1e-6

/* @warp: of the film
 * @x: column in the film, px
 * @y: row, px
 * @terms: (out): 1, s, t, s², st, t² there
 */
void
cloth_warp_get_terms (const ClothWarp * warp, gdouble x, gdouble y,
    gdouble terms[CLOTH_WARP_TERMS])
{
  const gdouble s = (x - warp->centre[0]) / warp->unit;
  const gdouble t = (y - warp->centre[1]) / warp->unit;

  terms[0] = 1;
  terms[1] = s;
  terms[2] = t;
  terms[3] = s * s;
  terms[4] = s * t;
  terms[5] = t * t;
}

/* @warp: of the film
 * @x: column in the film, px
 * @y: row, px
 * @to: (out): column and row in the flat picture, px
 */
void
cloth_warp_apply (const ClothWarp * warp, gdouble x, gdouble y, gdouble to[2])
{
  gdouble terms[CLOTH_WARP_TERMS];

  cloth_warp_get_terms (warp, x, y, terms);
  for (gint c = 0; c < 2; c++) {
    to[c] = 0;
    for (gint k = 0; k < CLOTH_WARP_TERMS; k++)
      to[c] += warp->terms[c][k] * terms[k];
  }
}

/* @warp: of the film
 * @x: column in the film, px
 * @y: row, px
 * @slopes: (out): of the flat picture's column by x and by y, of its row by x and by y
 */
void
cloth_warp_get_slopes (const ClothWarp * warp, gdouble x, gdouble y,
    gdouble slopes[4])
{
  const gdouble s = (x - warp->centre[0]) / warp->unit;
  const gdouble t = (y - warp->centre[1]) / warp->unit;

  for (gint c = 0; c < 2; c++) {
    const gdouble *k = warp->terms[c];

    slopes[2 * c] = (k[1] + 2 * k[3] * s + k[4] * t) / warp->unit;
    slopes[2 * c + 1] = (k[2] + k[4] * s + 2 * k[5] * t) / warp->unit;
  }
}

/* @warp: of the film
 * @to: column and row in the flat picture, px
 * @at: (inout): column and row in the film, px: where to start, and what shows @to
 *
 * Returns: %FALSE where no place near does; then @at is undefined
 */
gboolean
cloth_warp_find (const ClothWarp * warp, const gdouble to[2], gdouble at[2])
{
  for (gint step = 0; step < STEPS; step++) {
    gdouble here[2], j[4], det, by[2];

    cloth_warp_apply (warp, at[0], at[1], here);
    cloth_warp_get_slopes (warp, at[0], at[1], j);
    det = j[0] * j[3] - j[1] * j[2];
    /* also for what is no number */
    if (!(fabs (det) > 1e-12))
      return FALSE;
    by[0] = (j[3] * (to[0] - here[0]) - j[1] * (to[1] - here[1])) / det;
    by[1] = (j[0] * (to[1] - here[1]) - j[2] * (to[0] - here[0])) / det;
    at[0] += by[0];
    at[1] += by[1];
    if (hypot (by[0], by[1]) < REACHED)
      return TRUE;
  }
  return FALSE;
}

/* @warp: (inout): of the film; it stays the same map
 * @x: its new centre's column, px
 * @y: row, px
 * @unit: its new unit, px, > 0
 */
void
cloth_warp_move (ClothWarp * warp, gdouble x, gdouble y, gdouble unit)
{
  const gdouble grow = unit / warp->unit;
  gdouble to[2], slopes[4];

  cloth_warp_apply (warp, x, y, to);
  cloth_warp_get_slopes (warp, x, y, slopes);
  for (gint c = 0; c < 2; c++) {
    warp->terms[c][0] = to[c];
    warp->terms[c][1] = slopes[2 * c] * unit;
    warp->terms[c][2] = slopes[2 * c + 1] * unit;
    for (gint k = 3; k < CLOTH_WARP_TERMS; k++)
      warp->terms[c][k] *= grow * grow;
  }
  warp->centre[0] = x;
  warp->centre[1] = y;
  warp->unit = unit;
}
