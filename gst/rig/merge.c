/* Several estimates of the same points in one picture become one each.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/merge.h"

#include <math.h>
#include <string.h>

/* Squares that share a corner; a few more do no harm. */
#define MAX_ESTIMATES 4

typedef struct
{
  gdouble x, y, cov[3];
} Estimate;

struct _ClothMerge
{
  guint n_points;
  guint8 *n;
  Estimate *estimates;
  gdouble *planes;
};

/* @n_points: number of points
 *
 * Returns: (transfer full): memory for the estimates of one picture
 */
ClothMerge *
cloth_merge_new (guint n_points)
{
  ClothMerge *self = g_new0 (ClothMerge, 1);

  self->n_points = n_points;
  self->n = g_new0 (guint8, n_points);
  self->estimates = g_new (Estimate, MAX_ESTIMATES * (gsize) n_points);
  self->planes = g_new (gdouble, 5 * (gsize) n_points);
  return self;
}

/* @self: (nullable) (transfer full): what cloth_merge_new () gave
 */
void
cloth_merge_free (ClothMerge * self)
{
  if (self == NULL)
    return;
  g_free (self->n);
  g_free (self->estimates);
  g_free (self->planes);
  g_free (self);
}

/* @self: estimates of the picture before
 *
 * Forgets them all.
 */
void
cloth_merge_clear (ClothMerge * self)
{
  memset (self->n, 0, self->n_points);
}

/* @self: estimates of a picture
 * @point: which point
 * @x: column, px
 * @y: row, px
 * @cov: covariance xx, xy, yy, px²; all 0 when it is not stated, which counts as 1 px²
 *   each
 *
 * Adds an estimate. One that is equal to an earlier one is the same measurement and adds
 * nothing; so does one that is not finite, or whose covariance is not positive definite,
 * and each beyond the fourth.
 */
void
cloth_merge_add (ClothMerge * self, guint point, gdouble x, gdouble y,
    const gdouble cov[3])
{
  Estimate e = { x, y, {cov[0], cov[1], cov[2]} };
  Estimate *have = self->estimates + MAX_ESTIMATES * (gsize) point;

  if (cov[0] == 0. && cov[1] == 0. && cov[2] == 0.)
    e.cov[0] = e.cov[2] = 1.;
  if (!isfinite (x) || !isfinite (y) || !isfinite (e.cov[0])
      || !isfinite (e.cov[2]) || !(e.cov[0] > 0.)
      || !(e.cov[0] * e.cov[2] - e.cov[1] * e.cov[1] > 0.)
      || self->n[point] == MAX_ESTIMATES)
    return;
  for (guint i = 0; i < self->n[point]; i++)
    if (have[i].x == x && have[i].y == y && have[i].cov[0] == e.cov[0]
        && have[i].cov[1] == e.cov[1] && have[i].cov[2] == e.cov[2])
      return;
  have[self->n[point]++] = e;
}

/* FALSE when they contradict each other. */
static gboolean
merge (const Estimate * estimates, guint n, gdouble threshold,
    gdouble error_floor, Estimate * out)
{
  gdouble a = 0., b = 0., c = 0., p = 0., q = 0., det;

  for (guint i = 0; i < n; i++) {
    const Estimate *e = &estimates[i];
    gdouble d = n * (e->cov[0] * e->cov[2] - e->cov[1] * e->cov[1]);
    gdouble ixx = e->cov[2] / d, ixy = -e->cov[1] / d, iyy = e->cov[0] / d;

    a += ixx;
    b += ixy;
    c += iyy;
    p += ixx * e->x + ixy * e->y;
    q += ixy * e->x + iyy * e->y;
  }
  det = a * c - b * b;
  out->cov[0] = c / det;
  out->cov[1] = -b / det;
  out->cov[2] = a / det;
  out->x = out->cov[0] * p + out->cov[1] * q;
  out->y = out->cov[1] * p + out->cov[2] * q;
  for (guint i = 0; i < n; i++) {
    const Estimate *e = &estimates[i];
    gdouble x = e->x - out->x, y = e->y - out->y;
    gdouble xx = e->cov[0] + error_floor, yy = e->cov[2] + error_floor;
    gdouble d = xx * yy - e->cov[1] * e->cov[1];

    /* false also when it is NaN */
    if (!(x * x * yy - 2. * x * y * e->cov[1] + y * y * xx <=
            threshold * threshold * d))
      return FALSE;
  }
  return TRUE;
}

/* @self: estimates of a picture
 * @threshold: distance from the common place, in an estimate's own standard deviations,
 *   above which the estimates contradict each other
 * @error_floor: variance on top of an estimate's own, px², in that comparison; it is not
 *   in the merged covariance
 * @view: (out): what the picture says of each point; its arrays belong to @self until
 *   the next cloth_merge_finish ()
 *
 * Weighs the estimates of a point by their inverse covariances. They come from the same
 * pixels, so they do not make each other more certain: the merged covariance is that of
 * covariance intersection with equal weights (Julier & Uhlmann, A non-divergent
 * estimation algorithm in the presence of unknown correlations, 1997). Points without an
 * estimate and those whose estimates contradict each other are not seen (NaN).
 */
void
cloth_merge_finish (ClothMerge * self, gdouble threshold,
    gdouble error_floor, ClothTriangulateView * view)
{
  gdouble *plane[5];

  for (guint k = 0; k < 5; k++)
    plane[k] = self->planes + k * (gsize) self->n_points;
  for (guint i = 0; i < self->n_points; i++) {
    const Estimate *have = self->estimates + MAX_ESTIMATES * (gsize) i;
    Estimate one = { NAN, NAN, {1., 0., 1.} };

    if (self->n[i] == 1)
      one = have[0];
    else if (self->n[i] > 1 && !merge (have, self->n[i], threshold, error_floor,
            &one))
      one.x = one.y = NAN;
    plane[0][i] = one.x;
    plane[1][i] = one.y;
    plane[2][i] = one.cov[0];
    plane[3][i] = one.cov[1];
    plane[4][i] = one.cov[2];
  }
  view->x = plane[0];
  view->y = plane[1];
  view->xx = plane[2];
  view->xy = plane[3];
  view->yy = plane[4];
}
