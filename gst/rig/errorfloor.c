/* The errors of a film's observations that their covariances know nothing of.
 *
 * A detector states what the picture's noise does to a place. What compression, lens
 * model and calibration add shows in the residuals of triangulation: points seen by n
 * cameras leave 2 n − 3 degrees of freedom. Two cameras check each other across their
 * epipolar lines only, so three are needed. The variance that brings the sum of their
 * squared normalised residuals to its expectation is the estimate of Paule and Mandel,
 * "Consensus values and weighting factors", 1982; it is followed from set to set by
 * stochastic approximation (Robbins and Monro 1951).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/errorfloor.h"

#include <math.h>

/* So few degrees of freedom in a set tell nothing. */
#define LEAST 30
/* A film is remembered so long, degrees of freedom: a few seconds of some thousand. */
#define MEMORY 1e5

/* The mean of the variances that observations state themselves, px². */
static gdouble
stated (guint n_views, const ClothTriangulateView * views,
    const ClothTriangulation * result)
{
  gdouble sum = 0;
  gsize n = 0;

  for (guint v = 0; v < n_views; v++)
    for (guint i = 0; views[v].x && i < result->n_points; i++)
      if (result->n_views[i] > 2 && result->views[i] >> v & 1) {
        sum += views[v].xx ? (views[v].xx[i] + views[v].yy[i]) / 2 : 1;
        n++;
      }
  return n ? sum / (gdouble) n : 0;
}

/* @self: the estimate; before the first set a guess with a weight of 0
 * @n_views: number of views
 * @views: what the cameras saw
 * @result: what was triangulated from it, with an error floor of @self's
 *
 * Corrects the estimate by a set. Views that were left out don't count, nor do points of
 * two views.
 *
 * Returns: chi² over its degrees of freedom, of this set with the floor that it was
 *   triangulated with; NaN when the set has too few to tell
 */
gdouble
cloth_error_floor_add (ClothErrorFloor * self, guint n_views,
    const ClothTriangulateView * views, const ClothTriangulation * result)
{
  gdouble chi2 = 0, n = 0, ratio, own;

  for (guint i = 0; i < result->n_points; i++) {
    if (result->reason[i] == CLOTH_POINT_FINE && result->n_views[i] > 2) {
      chi2 += result->chi2[i];
      n += 2. * result->n_views[i] - 3.;
    }
  }
  if (!(n >= LEAST) || !isfinite (chi2))
    return NAN;
  ratio = chi2 / n;
  own = stated (n_views, views, result);
  self->weight = fmin (self->weight + n, MEMORY);
  /* residuals grow with the whole variance, which is known to be own + floor */
  self->floor += fmin (n / self->weight, 1) * (self->floor + own)
      * (ratio - 1);
  self->floor = fmax (self->floor, 0);
  return ratio;
}
