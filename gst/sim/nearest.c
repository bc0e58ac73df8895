/* Nearest points of triangles and edges.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/nearest.h"

#include "gst/math/vec3.h"

/* Edges at a smaller angle than the square root of this count as parallel. */
#define PARALLEL 1e-6

/* @a: a corner, and @b and @c
 * @point: a point
 * @weights: (out): the nearest point of the triangle is their sum over the corners
 *
 * By the region of Voronoi that @point is in (Ericson, Real-Time Collision Detection,
 * 2005, section 5.1.5).
 *
 * Returns: on what it lies: 0, 1, 2 a corner; 3, 4, 5 the edge ab, bc, ca;
 *   %CLOTH_NEAREST_FACE
 */
guint
cloth_nearest_on_triangle (const gdouble * a, const gdouble * b,
    const gdouble * c, const gdouble * point, gdouble weights[3])
{
  gdouble ab[3], ac[3], ap[3], bp[3], cp[3], va, vb, vc;
  gdouble d1, d2, d3, d4, d5, d6;
  guint feature;

  cloth_vec3_subtract (b, a, ab);
  cloth_vec3_subtract (c, a, ac);
  cloth_vec3_subtract (point, a, ap);
  cloth_vec3_subtract (point, b, bp);
  cloth_vec3_subtract (point, c, cp);
  d1 = cloth_vec3_dot (ab, ap);
  d2 = cloth_vec3_dot (ac, ap);
  d3 = cloth_vec3_dot (ab, bp);
  d4 = cloth_vec3_dot (ac, bp);
  d5 = cloth_vec3_dot (ab, cp);
  d6 = cloth_vec3_dot (ac, cp);
  vc = d1 * d4 - d3 * d2;
  vb = d5 * d2 - d1 * d6;
  va = d3 * d6 - d5 * d4;
  weights[0] = weights[1] = weights[2] = 0.;
  if (d1 <= 0. && d2 <= 0.)
    feature = 0;
  else if (d3 >= 0. && d4 <= d3)
    feature = 1;
  else if (d6 >= 0. && d5 <= d6)
    feature = 2;
  else if (vc <= 0. && d1 >= 0. && d3 <= 0.)
    feature = 3;
  else if (vb <= 0. && d2 >= 0. && d6 <= 0.)
    feature = 5;
  else if (va <= 0. && d4 - d3 >= 0. && d5 - d6 >= 0.)
    feature = 4;
  else
    feature = CLOTH_NEAREST_FACE;
  switch (feature) {
    case 3:
      weights[1] = d1 / (d1 - d3);
      weights[0] = 1. - weights[1];
      break;
    case 4:
      weights[2] = (d4 - d3) / ((d4 - d3) + (d5 - d6));
      weights[1] = 1. - weights[2];
      break;
    case 5:
      weights[2] = d2 / (d2 - d6);
      weights[0] = 1. - weights[2];
      break;
    case CLOTH_NEAREST_FACE:
      weights[1] = vb / (va + vb + vc);
      weights[2] = vc / (va + vb + vc);
      weights[0] = 1. - weights[1] - weights[2];
      break;
    default:
      weights[feature] = 1.;
  }
  return feature;
}

/* @a0: where the first edge starts; it ends at @a1
 * @b0: where the second edge starts; it ends at @b1
 * @s: (out): share of the first edge at which it is nearest to the second
 * @t: (out): share of the second edge there
 *
 * After Ericson, section 5.1.9.
 *
 * Returns: whether both points lie within their edges; of parallel edges, which have many
 *   nearest points, one is an end
 */
gboolean
cloth_nearest_of_edges (const gdouble * a0, const gdouble * a1,
    const gdouble * b0, const gdouble * b1, gdouble * s, gdouble * t)
{
  gdouble a[3], b[3], r[3], aa, bb, ab, ar, br, det;

  cloth_vec3_subtract (a1, a0, a);
  cloth_vec3_subtract (b1, b0, b);
  cloth_vec3_subtract (a0, b0, r);
  aa = cloth_vec3_dot (a, a);
  bb = cloth_vec3_dot (b, b);
  ab = cloth_vec3_dot (a, b);
  ar = cloth_vec3_dot (a, r);
  br = cloth_vec3_dot (b, r);
  det = aa * bb - ab * ab;
  *s = det > PARALLEL * aa * bb ? (ab * br - ar * bb) / det : 0.;
  *s = CLAMP (*s, 0., 1.);
  *t = bb > 0. ? (ab * *s + br) / bb : 0.;
  if (*t > 0. && *t < 1.)
    return *s > 0. && *s < 1.;
  *t = CLAMP (*t, 0., 1.);
  *s = aa > 0. ? CLAMP ((ab * *t - ar) / aa, 0., 1.) : 0.;
  return FALSE;
}
