/* What single cameras saw of a cloth's vertices: rays, and points on them.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/recording/rays.h"

#include <math.h>
#include <string.h>

#include "gst/math/vec3.h"

/* @n: number of vertices
 *
 * Returns: (transfer full): rays of which none is seen
 */
ClothRays *
cloth_rays_new (guint n)
{
  ClothRays *rays = g_new0 (ClothRays, 1);

  rays->n = n;
  rays->centres = g_new0 (gdouble, 3 * (gsize) n);
  rays->directions = g_new (gdouble, 3 * (gsize) n);
  rays->spreads = g_new (gdouble, n);
  rays->scratch = g_new (gdouble, 6 * (gsize) n);
  cloth_rays_clear (rays);
  return rays;
}

/* @rays: rays
 *
 * Forgets them: none is seen.
 */
void
cloth_rays_clear (ClothRays * rays)
{
  for (guint i = 0; i < rays->n; i++)
    cloth_rays_drop (rays, i);
}

/* @rays: rays
 * @vertex: of which there is to be none
 */
void
cloth_rays_drop (ClothRays * rays, guint vertex)
{
  for (guint k = 0; k < 3; k++)
    rays->directions[3 * (gsize) vertex + k] = NAN;
  rays->spreads[vertex] = NAN;
}

/* @rays: rays
 * @vertex: which
 *
 * Returns: whether it was seen
 */
gboolean
cloth_rays_has (const ClothRays * rays, guint vertex)
{
  return !isnan (rays->directions[3 * (gsize) vertex]);
}

/* @x, @y: X/Z and Y/Z in the camera's frame, @c: their covariance xx, xy, yy. A step of
 * (x, y) turns the direction by what of it is across, over the length of (x, y, 1): the
 * trace of the direction's covariance is that of Σ less its part along. */
static void
cast_one (ClothRays * rays, const ClothCamera * camera, guint vertex,
    gdouble x, gdouble y, const gdouble c[3])
{
  const gdouble *R = camera->R;
  gdouble square = x * x + y * y + 1., length = sqrt (square);
  gdouble along = (x * x * c[0] + 2. * x * y * c[1] + y * y * c[2]) / square;
  gdouble *d = rays->directions + 3 * (gsize) vertex;

  for (guint k = 0; k < 3; k++)
    d[k] = (R[k] * x + R[3 + k] * y + R[6 + k]) / length;
  rays->spreads[vertex] = sqrt ((c[0] + c[2] - along) / 2. / square);
}

/* @rays: where they go
 * @camera: the camera, with its lens
 * @view: what it saw, element i of vertex i; its covariances must not be %NULL
 *
 * The rays of a picture. Vertices that were not seen, and those at pixels that the lens
 * can't have made, have none.
 */
void
cloth_rays_cast (ClothRays * rays, const ClothCamera * camera,
    const ClothTriangulateView * view)
{
  gsize n = rays->n;
  gdouble *x = rays->scratch, *y = x + n, *j = y + n, centre[3];

  /* camera's centre: −Rᵀt */
  for (guint k = 0; k < 3; k++)
    centre[k] = -(camera->R[k] * camera->t[0] +
        camera->R[3 + k] * camera->t[1] + camera->R[6 + k] * camera->t[2]);
  cloth_camera_undistort_points (camera, (guint) n, view->x, view->y, x, y, j);
  for (guint i = 0; i < n; i++) {
    gdouble ux = j[i], uy = j[n + i], vx = j[2 * n + i], vy = j[3 * n + i];
    gdouble a = view->xx[i], b = view->xy[i], c = view->yy[i];
    const gdouble covariance[3] = {
      ux * ux * a + 2. * ux * uy * b + uy * uy * c,
      ux * vx * a + (ux * vy + uy * vx) * b + uy * vy * c,
      vx * vx * a + 2. * vx * vy * b + vy * vy * c
    };

    memcpy (rays->centres + 3 * (gsize) i, centre, sizeof centre);
    cast_one (rays, camera, i, x[i], y[i], covariance);
  }
}

/* @rays: rays of as many vertices as @from
 * @from: rays
 * @vertex: of which the ray is taken over
 */
void
cloth_rays_take (ClothRays * rays, const ClothRays * from, guint vertex)
{
  const gsize at = 3 * (gsize) vertex;

  memcpy (rays->centres + at, from->centres + at, 3 * sizeof *rays->centres);
  memcpy (rays->directions + at, from->directions + at,
      3 * sizeof *rays->directions);
  rays->spreads[vertex] = from->spreads[vertex];
}

/* @to: rays of as many vertices
 * @from: rays
 */
void
cloth_rays_copy (ClothRays * to, const ClothRays * from)
{
  memcpy (to->centres, from->centres,
      3 * (gsize) from->n * sizeof *to->centres);
  memcpy (to->directions, from->directions,
      3 * (gsize) from->n * sizeof *to->directions);
  memcpy (to->spreads, from->spreads, from->n * sizeof *to->spreads);
}

/* @rays: rays
 * @vertex: which
 * @v: a vector of the world
 * @across: (out): its part across the ray; may be @v; NaN when there is no ray
 *
 * Returns: its part along the ray
 */
gdouble
cloth_rays_split (const ClothRays * rays, guint vertex, const gdouble v[3],
    gdouble across[3])
{
  const gdouble *d = rays->directions + 3 * (gsize) vertex;
  gdouble along = cloth_vec3_dot (v, d);

  for (guint k = 0; k < 3; k++)
    across[k] = v[k] - along * d[k];
  return along;
}

/* @rays: rays
 * @reference: where the vertices may be, 3 numbers a vertex, metres; NaN when not known
 * @positions: (inout): the place on each ray that is nearest to its reference; NaN where that is
 *   missing, or lies behind the camera. Of vertices without a ray they stay
 *
 * Across the rays a position is what the camera saw, with a standard deviation of its
 * distance from the camera times the ray's spread; along them it is the reference's.
 */
void
cloth_rays_lift (const ClothRays * rays, const gdouble * reference,
    gdouble * positions)
{
  for (guint i = 0; i < rays->n; i++) {
    const gdouble *d = rays->directions + 3 * (gsize) i;
    const gdouble *c = rays->centres + 3 * (gsize) i;
    gdouble v[3], along;

    if (!cloth_rays_has (rays, i))
      continue;
    cloth_vec3_subtract (reference + 3 * (gsize) i, c, v);
    along = cloth_rays_split (rays, i, v, v);
    for (guint k = 0; k < 3; k++)
      positions[3 * (gsize) i + k] = along > 0. ? c[k] + along * d[k] : NAN;
  }
}

/* @rays: (nullable) (transfer full): rays
 */
void
cloth_rays_free (ClothRays * rays)
{
  if (!rays)
    return;
  g_free (rays->centres);
  g_free (rays->directions);
  g_free (rays->spreads);
  g_free (rays->scratch);
  g_free (rays);
}
