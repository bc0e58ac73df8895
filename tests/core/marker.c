/* Markers from rays: places in closed form, each filter by itself, and what is refused.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/vision/track/marker.h"

#define TIGHT 1e-12

static ClothRay
ray (gdouble x, gdouble y, gdouble z, gdouble dx, gdouble dy, gdouble dz)
{
  const gdouble length = sqrt (dx * dx + dy * dy + dz * dz);

  return (ClothRay) { {
  x, y, z}
  , {
  dx / length, dy / length, dz / length}
  };
}

static void
assert_at (const ClothMarker * marker, gdouble x, gdouble y, gdouble z)
{
  g_assert_cmpfloat_with_epsilon (marker->position[0], x, TIGHT);
  g_assert_cmpfloat_with_epsilon (marker->position[1], y, TIGHT);
  g_assert_cmpfloat_with_epsilon (marker->position[2], z, TIGHT);
}

/* Two rays at right angles that pass each other 2 mm apart: the marker is in the middle. */
static void
test_two (void)
{
  const ClothMarkerParams params = cloth_marker_default_params ();
  const ClothRay rays[2] =
      { ray (-1, 0, 0.001, 1, 0, 0), ray (0.25, -2, -0.001, 0, 1, 0) };
  ClothMarker marker;

  g_assert_cmpint (cloth_marker_find (&params, 2, rays, &marker), ==,
      CLOTH_MARKER_FOUND);
  assert_at (&marker, 0.25, 0, 0);
  g_assert_cmpfloat_with_epsilon (marker.distance, 0.002, TIGHT);
  g_assert_cmpfloat (marker.spread, ==, 0.);
  g_assert_cmpuint (marker.n_pairs, ==, 1);
}

/* Rays along the three axes, each 3 mm beside the origin: pairs x y, x z, y z have the midpoints
 * (0, 0.003, 0.0015), (0.0015, 0, 0.003) … by hand. */
static void
test_three (void)
{
  const ClothMarkerParams params = { 1., 1., 0.02 };
  const ClothRay rays[3] = { ray (-1, 0.003, 0, 1, 0, 0),
    ray (0, -1, 0.003, 0, 1, 0), ray (0.003, 0, -1, 0, 0, 1)
  };
  ClothMarker marker;

  /* x y: x ray has y = 0.003, z = 0; y ray x = 0, z = 0.003: (0, 0.003, 0.0015)
   * x z: z ray has x = 0.003, y = 0: (0.003, 0.0015, 0)
   * y z: (0.0015, 0, 0.003) */
  g_assert_cmpint (cloth_marker_find (&params, 3, rays, &marker), ==,
      CLOTH_MARKER_FOUND);
  assert_at (&marker, 0.0015, 0.0015, 0.0015);
  g_assert_cmpfloat_with_epsilon (marker.distance, 0.003, TIGHT);
  /* variance of 0, 1.5 and 3 mm */
  g_assert_cmpfloat_with_epsilon (marker.spread, 0.0015 * sqrt (2. / 3.),
      TIGHT);
  g_assert_cmpuint (marker.n_pairs, ==, 3);
}

/* A parallel pair is passed over, the others count. */
static void
test_passed_over (void)
{
  const ClothMarkerParams params = cloth_marker_default_params ();
  const ClothRay rays[3] = { ray (-1, 0, 0, 1, 0, 0), ray (-2, 0.001, 0, 1, 0,
        0), ray (0, -1, 0, 0, 1, 0)
  };
  ClothMarker marker;

  g_assert_cmpint (cloth_marker_find (&params, 3, rays, &marker), ==,
      CLOTH_MARKER_FOUND);
  g_assert_cmpuint (marker.n_pairs, ==, 2);
  assert_at (&marker, 0, 0.0005, 0);
}

static void
test_refused (void)
{
  const ClothMarkerParams params = cloth_marker_default_params ();
  const ClothRay parallel[2] = { ray (0, 0, 0, 1, 0, 0),
    ray (0, 1, 0, 1, 0.01, 0)
  };
  const ClothRay behind[2] = { ray (1, 0, 0, 1, 0, 0), ray (0, -1, 0, 0, 1,
        0)
  };
  const ClothRay distant[2] = { ray (-1, 0, 0.003, 1, 0, 0),
    ray (0, -1, -0.0021, 0, 1, 0)
  };
  ClothMarker marker;

  g_assert_cmpint (cloth_marker_find (&params, 0, NULL, &marker), ==,
      CLOTH_MARKER_FEW);
  g_assert_cmpint (cloth_marker_find (&params, 1, parallel, &marker), ==,
      CLOTH_MARKER_FEW);
  g_assert_cmpint (cloth_marker_find (&params, 2, parallel, &marker), ==,
      CLOTH_MARKER_PARALLEL);
  g_assert_cmpint (cloth_marker_find (&params, 2, behind, &marker), ==,
      CLOTH_MARKER_BEHIND);
  g_assert_cmpint (cloth_marker_find (&params, 2, distant, &marker), ==,
      CLOTH_MARKER_DISTANT);
  g_assert_cmpfloat_with_epsilon (marker.distance, 0.0051, TIGHT);
}

/* Rays in one plane have segments of no length, and yet midpoints far apart: two enclose 3°, the
 * third crosses them where they are 10.4 and 15.7 cm away from their own meeting. */
static void
test_spread (void)
{
  const ClothMarkerParams params = cloth_marker_default_params ();
  const ClothRay rays[3] = { ray (0, 0, 0, 1, 0, 0),
    ray (0, -0.05, 0, cos (0.05), sin (0.05), 0), ray (0.9, -1, 0, 0, 1, 0)
  };
  ClothMarker marker;

  g_assert_cmpint (cloth_marker_find (&params, 3, rays, &marker), ==,
      CLOTH_MARKER_SPREAD);
  g_assert_cmpfloat (marker.distance, <, TIGHT);
  g_assert_cmpfloat (marker.spread, >, 0.04);
}

/* The ray of a pixel goes through the point that is seen there. */
static void
test_cast (void)
{
  /* looks along +y from (0.5, -2, 1); columns go along +x, rows down */
  const ClothCamera camera = {.width = 640,.height = 480,
    .K = {600, 0, 320, 0, 500, 240, 0, 0, 1},
    .R = {1, 0, 0, 0, 0, -1, 0, 1, 0},
    .t = {-0.5, 1, 2}
  };
  const gdouble px[2] = { 320 + 600 * 0.1, 240 + 500 * 0.2 };
  const gdouble outside[2] = { NAN, 3. };
  ClothRay ray;
  gdouble far;

  g_assert_true (cloth_marker_cast (&camera, px, &ray));
  g_assert_cmpfloat_with_epsilon (ray.origin[0], 0.5, TIGHT);
  g_assert_cmpfloat_with_epsilon (ray.origin[1], -2., TIGHT);
  g_assert_cmpfloat_with_epsilon (ray.origin[2], 1., TIGHT);
  far = 3. / ray.direction[1];
  g_assert_cmpfloat_with_epsilon (ray.origin[0] + far * ray.direction[0],
      0.5 + 0.3, TIGHT);
  g_assert_cmpfloat_with_epsilon (ray.origin[2] + far * ray.direction[2],
      1. - 0.6, TIGHT);
  g_assert_false (cloth_marker_cast (&camera, outside, &ray));
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/marker/two", test_two);
  g_test_add_func ("/marker/three", test_three);
  g_test_add_func ("/marker/passed-over", test_passed_over);
  g_test_add_func ("/marker/refused", test_refused);
  g_test_add_func ("/marker/spread", test_spread);
  g_test_add_func ("/marker/cast", test_cast);
  return g_test_run ();
}
