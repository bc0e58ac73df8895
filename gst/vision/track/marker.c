/* A point of the cloth in space: where the rays of several cameras meet.
 *
 * Model: two rays o_i + s d_i have a shortest connecting segment. The marker is the mean of the
 *   midpoints of these segments over all pairs of rays.
 * Assumption: each ray is as good as any other. Where covariances are known, cloth_triangulator_run ()
 *   is the better estimate.
 * Formula: with c = d_1 · d_2, w = o_1 − o_2, the segment begins at s_1 = (c (d_2·w) − d_1·w) / (1 − c²)
 *   and ends at s_2 = (d_2·w − c (d_1·w)) / (1 − c²).
 * Filters: a distance of two rays that is too long says that they see different things. From three
 *   rays on the variances of the midpoints along the axes tell what lengths of segments don't: that
 *   midpoints of short segments lie far apart, as they do where rays are nearly parallel.
 * Reference: Hasler, Asbach, Rosenhahn, Ohm and Seidel, Physically based tracking of cloth, 2006,
 *   section 4 and figure 3.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/track/marker.h"

#include <string.h>

#include "gst/math/vec3.h"

/* Returns: the usual ones. The paper names no numbers.
 */
ClothMarkerParams
cloth_marker_default_params (void)
{
  return (ClothMarkerParams) {
  0.005, 0.005, 0.02};
}

/* @camera: a camera
 * @px: a place of its picture, as filmed, px
 * @ray: (out): of what it shows there, world
 *
 * Returns: %FALSE where the lens can't be undone; @ray is left alone
 */
gboolean
cloth_marker_cast (const ClothCamera * camera, const gdouble px[2],
    ClothRay * ray)
{
  const gdouble *R = camera->R, *t = camera->t;
  gdouble x, y;

  if (cloth_camera_undistort_points (camera, 1, &px[0], &px[1], &x, &y,
          NULL) != 1)
    return FALSE;
  for (guint k = 0; k < 3; k++) {
    ray->origin[k] = -(R[k] * t[0] + R[3 + k] * t[1] + R[6 + k] * t[2]);
    ray->direction[k] = R[k] * x + R[3 + k] * y + R[6 + k];
  }
  cloth_vec3_normalise (ray->direction);
  return TRUE;
}

/* The segment between two rays; FALSE: they are parallel. @along: where it is on each, m */
static gboolean
connect (const ClothMarkerParams * p, const ClothRay * a, const ClothRay * b,
    gdouble along[2], gdouble middle[3], gdouble * length)
{
  const gdouble c = cloth_vec3_dot (a->direction, b->direction);
  gdouble cross[3], from[3], to[3], w[3], da, db, sine2;

  cloth_vec3_cross (a->direction, b->direction, cross);
  sine2 = cloth_vec3_dot (cross, cross);
  if (!(sine2 > sin (p->angle) * sin (p->angle)))
    return FALSE;
  cloth_vec3_subtract (a->origin, b->origin, w);
  da = cloth_vec3_dot (a->direction, w);
  db = cloth_vec3_dot (b->direction, w);
  along[0] = (c * db - da) / sine2;
  along[1] = (db - c * da) / sine2;
  memcpy (from, a->origin, sizeof from);
  memcpy (to, b->origin, sizeof to);
  cloth_vec3_add_scaled (from, along[0], a->direction);
  cloth_vec3_add_scaled (to, along[1], b->direction);
  for (guint k = 0; k < 3; k++)
    middle[k] = 0.5 * (from[k] + to[k]);
  cloth_vec3_subtract (from, to, w);
  *length = cloth_vec3_length (w);
  return TRUE;
}

/* @params: when rays don't meet
 * @n: rays
 * @rays: (array length=n): of one feature, each of another camera
 * @marker: (out): what they give; of use where the result is %CLOTH_MARKER_FOUND, and its
 *   @distance and @spread also where that is %CLOTH_MARKER_DISTANT or %CLOTH_MARKER_SPREAD
 *
 * Pairs of parallel rays are passed over: they say nothing of the distance.
 *
 * Returns: whether there is a marker, and why not
 */
ClothMarkerResult
cloth_marker_find (const ClothMarkerParams * params, guint n,
    const ClothRay * rays, ClothMarker * marker)
{
  gdouble sum[3] = { 0 }, first[3] = { 0 }, square[3] = { 0 };

  *marker = (ClothMarker) {
  0};
  if (n < 2)
    return CLOTH_MARKER_FEW;
  for (guint i = 0; i < n; i++)
    for (guint j = i + 1; j < n; j++) {
      gdouble along[2], middle[3], length;

      if (!connect (params, &rays[i], &rays[j], along, middle, &length))
        continue;
      if (along[0] <= 0 || along[1] <= 0)
        return CLOTH_MARKER_BEHIND;
      if (marker->n_pairs++ == 0)
        memcpy (first, middle, sizeof first);
      marker->distance = MAX (marker->distance, length);
      /* from the first midpoint on, or the squares would lose all digits */
      for (guint k = 0; k < 3; k++) {
        sum[k] += middle[k] - first[k];
        square[k] += (middle[k] - first[k]) * (middle[k] - first[k]);
      }
    }
  if (marker->n_pairs == 0)
    return CLOTH_MARKER_PARALLEL;
  for (guint k = 0; k < 3; k++) {
    const gdouble mean = sum[k] / marker->n_pairs;
    const gdouble variance = square[k] / marker->n_pairs - mean * mean;

    marker->position[k] = first[k] + mean;
    marker->spread = MAX (marker->spread, sqrt (MAX (variance, 0.)));
  }
  if (marker->distance > params->distance)
    return CLOTH_MARKER_DISTANT;
  return marker->spread > params->spread ? CLOTH_MARKER_SPREAD :
      CLOTH_MARKER_FOUND;
}
