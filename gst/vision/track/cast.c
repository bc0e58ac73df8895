/* Where a feature without (u, v) is on a simulated cloth, and where it is drawn to.
 *
 * Model: the ray of a feature hits the simulated cloth of its frame at a place; the flow says where the
 *   feature is seen in the next frame, and the place is drawn to that ray.
 * Assumption: the simulated cloth is where the filmed one is, but for less than a feature's surroundings.
 * Method: the drawn picture of the cloth tells which triangle the pixel about the feature sees. Its exact
 *   place is where the ray meets that triangle's plane (Möller and Trumbore, 1997), brought into the
 *   triangle where the feature lies beyond its edge in the same pixel.
 * Reference: Hasler, Asbach, Rosenhahn, Ohm and Seidel, Physically based tracking of cloth, 2006,
 *   section 4.2, with a picture in place of a hierarchy of boxes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/track/cast.h"

#include <math.h>

#include "gst/math/vec3.h"

/* Weights of where the ray meets the triangle's plane; FALSE: it lies in it. */
static gboolean
meet (const ClothRay * ray, const gdouble * a, const gdouble * b,
    const gdouble * c, gdouble weight[3])
{
  gdouble e[3], f[3], s[3], p[3], q[3], det;

  cloth_vec3_subtract (b, a, e);
  cloth_vec3_subtract (c, a, f);
  cloth_vec3_subtract (ray->origin, a, s);
  cloth_vec3_cross (ray->direction, f, p);
  cloth_vec3_cross (s, e, q);
  det = cloth_vec3_dot (e, p);
  if (det == 0)
    return FALSE;
  weight[1] = cloth_vec3_dot (s, p) / det;
  weight[2] = cloth_vec3_dot (ray->direction, q) / det;
  weight[0] = 1. - weight[1] - weight[2];
  return isfinite (weight[1] + weight[2]);
}

/* @coverage: the simulated cloth as @camera sees it in the frame before, drawn by
 *   cloth_coverage_draw ()
 * @camera: the camera
 * @positions: (array): the vertices it was drawn from, m, world
 * @before: where the feature was in the frame before, px
 * @px: where it is in this frame
 * @cast: (out): what is drawn to what
 *
 * Returns: %FALSE when the feature's pixel sees no cloth, or the lens can't be undone
 */
gboolean
cloth_cast_feature (const ClothCoverage * coverage, const ClothCamera * camera,
    const gdouble * positions, const gdouble before[2], const gdouble px[2],
    ClothCast * cast)
{
  const gdouble x = floor (before[0] + 0.5), y = floor (before[1] + 0.5);
  guint32 triangle;
  ClothRay ray;
  gdouble sum = 0.;

  if (!(x >= 0 && y >= 0 && x < coverage->width && y < coverage->height))
    return FALSE;
  triangle = coverage->seen[(gsize) y * coverage->width + (gsize) x];
  if (triangle == CLOTH_COVERAGE_NONE
      || !cloth_marker_cast (camera, before, &ray)
      || !cloth_marker_cast (camera, px, &cast->ray))
    return FALSE;
  for (guint k = 0; k < 3; k++)
    cast->corner[k] = coverage->triangles[triangle][k];
  if (!meet (&ray, positions + 3 * cast->corner[0],
          positions + 3 * cast->corner[1], positions + 3 * cast->corner[2],
          cast->weight))
    return FALSE;
  for (guint k = 0; k < 3; k++) {
    cast->weight[k] = MAX (cast->weight[k], 0.);
    sum += cast->weight[k];
  }
  for (guint k = 0; k < 3; k++)
    cast->weight[k] /= sum;
  return TRUE;
}
