/* What each camera saw at any time, between its pictures too.
 *
 * Model: between pictures a vertex moves in the picture on a polynomial of time: through four of
 *   them where all have it, else on a line. Its covariance is that of their weighted sum.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/recording/views.h"

#include <math.h>
#include <string.h>

/* A picture this part of a frame away was taken in it. */
#define SAME_TIME 1e-3
/* Pictures further apart than this many frames say nothing of what was between them. */
#define MOST_BETWEEN 1.5
/* x, y, xx, xy, yy. */
#define EACH 5

static const ClothObservation *
picture (const ClothViews * v, guint i)
{
  return &g_array_index (v->observations->list, ClothObservation, v->order[i]);
}

static void
sort_pictures (ClothViews * v)
{
  const GArray *list = v->observations->list;
  const guint n_cameras = v->observations->rig->n_cameras;
  guint n = 0;

  v->first = g_new (guint, n_cameras + 1);
  v->order = g_new (guint, list->len + 1);
  /* of each camera they are in the order of time already */
  for (guint c = 0; c < n_cameras; c++) {
    v->first[c] = n;
    for (guint i = 0; i < list->len; i++)
      if (g_array_index (list, ClothObservation, i).camera == c)
        v->order[n++] = i;
  }
  v->first[n_cameras] = n;
}

/* @observations: pictures; kept by reference
 * @frame_s: usual distance of frames, s
 *
 * Returns: (transfer full): of which nothing was found yet
 */
ClothViews *
cloth_views_new (const ClothObservations * observations, gdouble frame_s)
{
  const guint n_cameras = observations->rig->n_cameras;
  ClothViews *v = g_new0 (ClothViews, 1);

  v->observations = observations;
  v->n = observations->n_vertices;
  v->frame_s = frame_s;
  v->seen = g_new (gdouble, EACH * (gsize) n_cameras * v->n);
  v->between = g_new (gdouble, EACH * (gsize) v->n);
  v->views = g_new (ClothTriangulateView, n_cameras);
  for (guint c = 0; c < n_cameras; c++) {
    gdouble *at = v->seen + EACH * (gsize) c * v->n;

    v->views[c] = (ClothTriangulateView) {
    at, at + v->n, at + 2 * v->n, at + 3 * v->n, at + 4 * v->n};
  }
  sort_pictures (v);
  return v;
}

/* Adds a picture's points with a weight; points that another picture must have, too, and has not
 * are NaN. */
static void
add_picture (const ClothObservation * from, gdouble weight, gboolean first,
    guint n, gdouble * to)
{
  guint next = 0;

  for (guint v = 0; v < n; v++) {
    const gboolean there = next < from->n && from->vertices[next] == v;

    for (guint k = 0; k < EACH; k++) {
      gdouble *at = to + (gsize) k * n + v, value = NAN;

      if (there)
        value = k < 2 ? weight * from->px[2 * (gsize) next + k] :
            weight * weight * from->covariances[3 * (gsize) next + k - 2];
      *at = (first ? 0. : *at) + value;
    }
    next += there;
  }
}

/* Adds what the polynomial through @n pictures, from the @first of a camera's on, has at a time. */
static void
interpolate (const ClothViews * v, guint first, guint n, gdouble time,
    gdouble * to)
{
  for (guint i = first; i < first + n; i++) {
    gdouble weight = 1.;

    /* Lagrange's */
    for (guint k = first; k < first + n; k++)
      if (k != i)
        weight *= (time - picture (v, k)->time_s) /
            (picture (v, i)->time_s - picture (v, k)->time_s);
    add_picture (picture (v, i), weight, i == first, v->n, to);
  }
}

/* Whether @n pictures follow each other without a hole. */
static gboolean
are_near (const ClothViews * v, guint first, guint n)
{
  for (guint i = first; i + 1 < first + n; i++)
    if (picture (v, i + 1)->time_s - picture (v, i)->time_s >
        MOST_BETWEEN * v->frame_s)
      return FALSE;
  return TRUE;
}

/* @views: views
 * @camera: a camera
 * @time_s: when, by its clock
 *
 * Finds what it saw then: its picture of then, or between pictures.
 */
void
cloth_views_find (ClothViews * views, guint camera, gdouble time_s)
{
  const gsize size = EACH * (gsize) views->n;
  gdouble *to = views->seen + camera * size;
  guint low = views->first[camera], high = views->first[camera + 1];
  const guint begin = low, end = high;

  for (gsize i = 0; i < size; i++)
    to[i] = NAN;
  if (low == high)
    return;
  while (high - low > 1) {
    guint middle = (low + high) / 2;

    if (picture (views, middle)->time_s <= time_s)
      low = middle;
    else
      high = middle;
  }
  for (guint i = low; i < MIN (low + 2, end); i++)
    if (fabs (picture (views, i)->time_s - time_s) < SAME_TIME * views->frame_s) {
      add_picture (picture (views, i), 1., TRUE, views->n, to);
      return;
    }
  if (high == end || time_s < picture (views, low)->time_s
      || !are_near (views, low, 2))
    return;
  interpolate (views, low, 2, time_s, to);
  if (low == begin || high + 1 == end || !are_near (views, low - 1, 4))
    return;
  interpolate (views, low - 1, 4, time_s, views->between);
  for (gsize i = 0; i < size; i++)
    if (isfinite (views->between[i]))
      to[i] = views->between[i];
}

/* @views: views
 * @camera: a camera
 * @axis: 0: of x, 1: of y
 *
 * Returns: (transfer none) (array): the variances of what it saw, px², which may be changed until
 *   it is looked for anew
 */
gdouble *
cloth_views_variance (ClothViews * views, guint camera, guint axis)
{
  return views->seen + (EACH * (gsize) camera + (axis ? 4 : 2)) * views->n;
}

/* @views: (nullable) (transfer full): views
 */
void
cloth_views_free (ClothViews * views)
{
  if (!views)
    return;
  g_free (views->views);
  g_free (views->seen);
  g_free (views->between);
  g_free (views->first);
  g_free (views->order);
  g_free (views);
}
