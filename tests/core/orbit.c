/* The free view: everything in the picture, from the side asked for, upright.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/orbit.h"

#include <math.h>

#define N 200

/* C = −Rᵀ t */
static void
centre_of (const ClothCamera * camera, gdouble centre[3])
{
  for (guint k = 0; k < 3; k++)
    centre[k] = -(camera->R[k] * camera->t[0] + camera->R[3 + k] *
        camera->t[1] + camera->R[6 + k] * camera->t[2]);
}

static void
test_all_is_seen (void)
{
  g_autoptr (GRand) random = g_rand_new_with_seed (3);
  gdouble points[3 * N];
  ClothOrbit orbit;

  cloth_orbit_init (&orbit);
  for (guint i = 0; i < N; i++) {
    points[3 * i] = g_rand_double_range (random, 4, 4.3);
    points[3 * i + 1] = g_rand_double_range (random, -2, -1);
    points[3 * i + 2] = g_rand_double_range (random, 0, 2);
  }
  points[3 * 7] = NAN;
  g_assert_true (cloth_orbit_frame (&orbit, N, points));
  for (gint azimuth = -180; azimuth <= 360; azimuth += 45)
    for (gint elevation = -90; elevation <= 90; elevation += 30) {
      ClothCamera camera;

      orbit.azimuth = azimuth;
      orbit.elevation = elevation;
      cloth_orbit_camera (&orbit, azimuth % 2 ? 300 : 700, 400, &camera);
      for (guint i = 0; i < N; i++) {
        gdouble px[2];

        if (i == 7)
          continue;
        g_assert_true (cloth_camera_project (&camera, points + 3 * i, px, NULL,
                NULL));
        g_assert_true (px[0] > 0 && px[0] < camera.width - 1 && px[1] > 0 &&
            px[1] < camera.height - 1);
      }
    }
}

static void
test_sides (void)
{
  static const struct
  {
    gdouble azimuth, elevation, place[3];
  } cases[] = {
    {0, 0, {1, -1, 3}}, {90, 0, {3, 1, 3}}, {180, 0, {1, 3, 3}},
    {-90, 0, {-1, 1, 3}}, {0, 90, {1, 1, 5}}, {45, 0, {1 + M_SQRT2, 1 - M_SQRT2,
            3}}, {0, 30, {1, 1 - 1.7320508075688772, 4}}
  };

  for (guint i = 0; i < G_N_ELEMENTS (cases); i++) {
    const ClothOrbit orbit = { {1, 1, 3}, 1, cases[i].azimuth,
    cases[i].elevation, 2
    };
    const gdouble above[3] = { 1, 1, 3.1 };
    gdouble centre[3], px[2], middle[2];
    ClothCamera camera;

    cloth_orbit_camera (&orbit, 640, 480, &camera);
    centre_of (&camera, centre);
    for (guint k = 0; k < 3; k++)
      g_assert_cmpfloat_with_epsilon (centre[k], cases[i].place[k], 1e-9);
    g_assert_true (cloth_camera_project (&camera, orbit.centre, middle, NULL,
            NULL));
    g_assert_cmpfloat_with_epsilon (middle[0], 319.5, 1e-9);
    g_assert_cmpfloat_with_epsilon (middle[1], 239.5, 1e-9);
    g_assert_true (cloth_camera_project (&camera, above, px, NULL, NULL));
    g_assert_cmpfloat_with_epsilon (px[0], 319.5, 1e-9);
    /* a rotation, no mirror */
    for (guint k = 0; k < 3; k++) {
      const gdouble *a = camera.R + 3 * k, *b = camera.R + 3 * ((k + 1) % 3);
      const gdouble *c = camera.R + 3 * ((k + 2) % 3);

      for (guint j = 0; j < 3; j++)
        g_assert_cmpfloat_with_epsilon (c[j], a[(j + 1) % 3] * b[(j + 2) % 3] -
            a[(j + 2) % 3] * b[(j + 1) % 3], 1e-12);
    }
    if (cases[i].elevation < 90)
      g_assert_cmpfloat (px[1], <, 239);
  }
}

/* Nothing known leaves it as it is; a single point is no distance of 0. */
static void
test_nothing_known (void)
{
  const gdouble none[6] = { NAN, NAN, NAN, 1, INFINITY, 2 };
  const gdouble one[3] = { 1, 2, 3 };
  ClothOrbit orbit;
  ClothCamera camera;
  gdouble px[2];

  cloth_orbit_init (&orbit);
  g_assert_false (cloth_orbit_frame (&orbit, 2, none));
  g_assert_cmpfloat (orbit.radius, ==, 1);
  g_assert_false (cloth_orbit_frame (&orbit, 0, none));
  g_assert_true (cloth_orbit_frame (&orbit, 1, one));
  cloth_orbit_camera (&orbit, 1, 1, &camera);
  g_assert_true (cloth_camera_project (&camera, one, px, NULL, NULL));
  g_assert_cmpfloat_with_epsilon (px[0], 0, 1e-6);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/orbit/all-is-seen", test_all_is_seen);
  g_test_add_func ("/orbit/sides", test_sides);
  g_test_add_func ("/orbit/nothing-known", test_nothing_known);
  return g_test_run ();
}
