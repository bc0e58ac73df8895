/* Vectors of three numbers: what can be said by hand, and identities.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/math/random.h"
#include "gst/math/vec3.h"

static void
test_by_hand (void)
{
  const gdouble a[3] = { 1., 2., 3. }, b[3] = { 4., -5., 6. };
  gdouble c[3];

  g_assert_cmpfloat (cloth_vec3_dot (a, b), ==, 12.);
  cloth_vec3_cross (a, b, c);
  g_assert_cmpfloat (c[0], ==, 27.);
  g_assert_cmpfloat (c[1], ==, 6.);
  g_assert_cmpfloat (c[2], ==, -13.);
  cloth_vec3_subtract (a, b, c);
  g_assert_cmpfloat (c[0], ==, -3.);
  g_assert_cmpfloat (c[1], ==, 7.);
  g_assert_cmpfloat (c[2], ==, -3.);
  cloth_vec3_subtract (c, c, c);
  cloth_vec3_add_scaled (c, -2., b);
  g_assert_cmpfloat (c[0], ==, -8.);
  g_assert_cmpfloat (c[1], ==, 10.);
  g_assert_cmpfloat (c[2], ==, -12.);
}

static void
test_length (void)
{
  gdouble a[3] = { 2., 3., 6. }, none[3] = { 0., 0., 0. };

  g_assert_cmpfloat (cloth_vec3_length (a), ==, 7.);
  g_assert_cmpfloat (cloth_vec3_normalise (a), ==, 7.);
  g_assert_cmpfloat (a[0], ==, 2. / 7.);
  g_assert_cmpfloat (a[1], ==, 3. / 7.);
  g_assert_cmpfloat (a[2], ==, 6. / 7.);
  /* what has no direction stays */
  g_assert_cmpfloat (cloth_vec3_normalise (none), ==, 0.);
  for (guint k = 0; k < 3; k++)
    g_assert_cmpfloat (none[k], ==, 0.);
}

/* |a × b|² + (a·b)² = |a|² |b|² (Lagrange); a × b is square to both. */
static void
test_identities (void)
{
  ClothRandom random;

  cloth_random_init (&random, 1);
  for (guint i = 0; i < 1000; i++) {
    gdouble a[3], b[3], c[3], along;

    for (guint k = 0; k < 3; k++) {
      a[k] = cloth_random_gaussian (&random);
      b[k] = cloth_random_gaussian (&random);
    }
    cloth_vec3_cross (a, b, c);
    along = cloth_vec3_dot (a, b);
    g_assert_cmpfloat_with_epsilon (cloth_vec3_dot (c, c) + along * along,
        cloth_vec3_dot (a, a) * cloth_vec3_dot (b, b), 1e-12);
    g_assert_cmpfloat_with_epsilon (cloth_vec3_dot (a, c), 0., 1e-13);
    g_assert_cmpfloat_with_epsilon (cloth_vec3_dot (b, c), 0., 1e-13);
  }
}

gint
main (gint argc, gchar ** argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/vec3/by-hand", test_by_hand);
  g_test_add_func ("/vec3/length", test_length);
  g_test_add_func ("/vec3/identities", test_identities);
  return g_test_run ();
}
