/* A camera that looks at something from a chosen side.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/orbit.h"

#include <math.h>
#include <string.h>

/* Focal length over the shorter side of the picture: 37° of view. */
#define FOCAL_LENGTH 1.5
/* Space around the sphere: cloth moves on from where it was first seen. */
#define MARGIN 1.2
#define LEAST_RADIUS 1e-6
#define DEGREE (G_PI / 180)

/* @orbit: (out): level, from −y, 1 m about the origin
 */
void
cloth_orbit_init (ClothOrbit * orbit)
{
  *orbit = (ClothOrbit) {
  .radius = 1};
}

/* @orbit: its centre and radius are set
 * @n_points: how many
 * @points: 3 numbers a point, m; NaN where unknown
 *
 * Puts the sphere about the middle of the points' bounding box.
 *
 * Returns: %FALSE, and @orbit is as before, when no point is known
 */
gboolean
cloth_orbit_frame (ClothOrbit * orbit, guint n_points, const gdouble * points)
{
  gdouble low[3], high[3], centre[3], most = 0;
  gboolean any = FALSE;

  for (gsize i = 0; i < n_points; i++) {
    const gdouble *p = points + 3 * i;

    if (!isfinite (p[0]) || !isfinite (p[1]) || !isfinite (p[2]))
      continue;
    for (guint k = 0; k < 3; k++) {
      low[k] = any ? MIN (low[k], p[k]) : p[k];
      high[k] = any ? MAX (high[k], p[k]) : p[k];
    }
    any = TRUE;
  }
  if (!any)
    return FALSE;
  for (guint k = 0; k < 3; k++)
    centre[k] = (low[k] + high[k]) / 2;
  for (gsize i = 0; i < n_points; i++) {
    const gdouble *p = points + 3 * i;
    const gdouble x = p[0] - centre[0], y = p[1] - centre[1];
    const gdouble z = p[2] - centre[2], square = x * x + y * y + z * z;

    if (isfinite (square))
      most = MAX (most, square);
  }
  memcpy (orbit->centre, centre, sizeof centre);
  orbit->radius = MAX (sqrt (most), LEAST_RADIUS);
  return TRUE;
}

/* @orbit: where from
 * @width: of the picture, px
 * @height: of the picture, px
 * @camera: (out): a pinhole camera whose picture stands upright, z up
 */
void
cloth_orbit_camera (const ClothOrbit * orbit, gint width, gint height,
    ClothCamera * camera)
{
  const gdouble sa = sin (orbit->azimuth * DEGREE);
  const gdouble ca = cos (orbit->azimuth * DEGREE);
  const gdouble se = sin (orbit->elevation * DEGREE);
  const gdouble ce = cos (orbit->elevation * DEGREE);
  /* right, down, forward */
  const gdouble R[9] = { ca, sa, 0, sa * se, -ca * se, -ce, -sa * ce, ca * ce,
    -se
  };
  const gdouble half = atan (0.5 / FOCAL_LENGTH);
  const gdouble distance = orbit->distance > 0 ? orbit->distance :
      MARGIN * orbit->radius / sin (half);
  const gdouble f = FOCAL_LENGTH * MIN (width, height);

  *camera = (ClothCamera) {
  .width = width,.height = height};
  camera->K[0] = camera->K[4] = f;
  camera->K[2] = (width - 1) / 2.0;
  camera->K[5] = (height - 1) / 2.0;
  camera->K[8] = 1;
  memcpy (camera->R, R, sizeof R);
  for (guint i = 0; i < 3; i++) {
    camera->t[i] = i == 2 ? distance : 0;
    for (guint k = 0; k < 3; k++)
      camera->t[i] -= R[3 * i + k] * orbit->centre[k];
  }
}
