/* Point grid: the nearest points against brute force; places that are no numbers.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/pointgrid.h"

#include <math.h>
#include <stdlib.h>

#define MOST 64

typedef struct
{
  gfloat x, y;
} Place;

static gint
by_distance (gconstpointer a, gconstpointer b)
{
  const ClothNear *p = a, *q = b;

  return p->distance2 != q->distance2 ? (p->distance2 > q->distance2 ? 1 : -1)
      : p->index - q->index;
}

/* All points within the radius, sorted. */
static GArray *
brute_force (const Place * places, guint n, gfloat x, gfloat y, gfloat radius)
{
  GArray *all = g_array_new (FALSE, FALSE, sizeof (ClothNear));

  for (guint k = 0; k < n; k++) {
    gfloat dx = places[k].x - x, dy = places[k].y - y;
    ClothNear near = { dx * dx + dy * dy, (gint) k };

    if (near.distance2 <= radius * radius)
      g_array_append_val (all, near);
  }
  g_array_sort (all, by_distance);
  return all;
}

static guint
compare (const ClothPointGrid * grid, const Place * places, guint n, gfloat x,
    gfloat y, gfloat radius, guint most)
{
  g_autoptr (GArray) truth = brute_force (places, n, x, y, radius);
  ClothNear near[MOST];
  guint found = cloth_point_grid_nearest (grid, x, y, radius, near, most);

  g_assert_cmpuint (found, ==, MIN (truth->len, most));
  for (guint k = 0; k < found; k++) {
    const ClothNear *expected = &g_array_index (truth, ClothNear, k);

    g_assert_cmpint (near[k].index, ==, expected->index);
    g_assert_cmpfloat (near[k].distance2, ==, expected->distance2);
  }
  return found;
}

static gfloat
within (GRand * rand, gdouble from, gdouble to)
{
  return (gfloat) g_rand_double_range (rand, from, to);
}

/* Any size of picture, any number of points, wrongly announced; some lie on whole pixels,
 * so that many are equally near, some in a heap, some outside the picture. */
static void
test_brute_force (void)
{
  static const gint sizes[][2] = { {640, 480}, {1, 1}, {3, 2000}, {5000, 7} };
  static const guint counts[] = { 1, 2, 30, 500 };
  g_autoptr (ClothPointGrid) grid = cloth_point_grid_new ();
  g_autoptr (GRand) rand = g_rand_new_with_seed (1);
  guint found = 0;

  for (guint trial = 0; trial < 96; trial++) {
    gint width = sizes[trial % 4][0], height = sizes[trial % 4][1];
    guint n = counts[trial / 4 % 4];
    guint expected = trial % 3 == 0 ? n : trial % 3 == 1 ? 0 : 20 * n;
    g_autofree Place *places = g_new (Place, n);

    cloth_point_grid_clear (grid, width, height, expected);
    for (guint k = 0; k < n; k++) {
      gdouble beyond = k % 7 == 0 ? 60 : 0;

      places[k].x = within (rand, -beyond, width - 1 + beyond + 0.01);
      places[k].y = within (rand, -beyond, height - 1 + beyond + 0.01);
      if (trial & 1) {
        places[k].x = rintf (places[k].x / 4) * 4;
        places[k].y = rintf (places[k].y / 4) * 4;
      }
      if (k % 5 == 1) {
        places[k].x = places[0].x + (gfloat) (k % 3);
        places[k].y = places[0].y;
      }
      cloth_point_grid_add (grid, places[k].x, places[k].y);
    }
    for (guint ask = 0; ask < 60; ask++) {
      static const gfloat radii[] = { 0, 3, 17.5f, 80, 4000 };
      gfloat x = within (rand, -80, width + 80);
      gfloat y = within (rand, -80, height + 80);

      if (ask % 3 == 0) {
        x = places[ask % n].x;
        y = places[ask % n].y;
      }
      found += compare (grid, places, n, x, y, radii[ask % 5],
          1 + ask % 2 * (MOST - 1));
    }
  }
  g_test_message ("%u neighbours as by brute force", found);
  g_assert_cmpuint (found, >, 1000);
}

static void
test_empty (void)
{
  g_autoptr (ClothPointGrid) grid = cloth_point_grid_new ();
  ClothNear near[2];

  cloth_point_grid_clear (grid, 640, 480, 100);
  g_assert_cmpuint (cloth_point_grid_nearest (grid, 3, 4, 1e9f, near, 2), ==,
      0);
  cloth_point_grid_add (grid, 3, 4);
  g_assert_cmpuint (cloth_point_grid_nearest (grid, 3, 4, 1e9f, near, 0), ==,
      0);
  g_assert_cmpuint (cloth_point_grid_nearest (grid, 3, 4, 1e9f, near, 2), ==,
      1);
  /* What was there is gone. */
  cloth_point_grid_clear (grid, 320, 200, 0);
  g_assert_cmpuint (cloth_point_grid_nearest (grid, 3, 4, 1e9f, near, 2), ==,
      0);
}

/* A point that is no number is never found and costs the others nothing. */
static void
test_no_numbers (void)
{
  static const gfloat odd[] = { NAN, INFINITY, -INFINITY, 1e38f, -1e38f };
  g_autoptr (ClothPointGrid) grid = cloth_point_grid_new ();
  const Place good = { 100, 50 };
  ClothNear near[MOST];

  cloth_point_grid_clear (grid, 640, 480, 2);
  for (guint k = 0; k < G_N_ELEMENTS (odd); k++) {
    cloth_point_grid_add (grid, odd[k], 50);
    cloth_point_grid_add (grid, 100, odd[k]);
    cloth_point_grid_add (grid, odd[k], odd[G_N_ELEMENTS (odd) - 1 - k]);
  }
  cloth_point_grid_add (grid, good.x, good.y);
  g_assert_cmpuint (cloth_point_grid_nearest (grid, 101, 50, 1e6f, near, MOST),
      ==, 1);
  g_assert_cmpint (near[0].index, ==, 3 * G_N_ELEMENTS (odd));
  g_assert_cmpfloat (near[0].distance2, ==, 1);
  /* Nothing is near what is no number or not finite. */
  for (guint k = 0; k < 3; k++) {
    g_assert_cmpuint (cloth_point_grid_nearest (grid, odd[k], 50, 100, near,
            1), ==, 0);
    g_assert_cmpuint (cloth_point_grid_nearest (grid, 100, odd[k], 100, near,
            1), ==, 0);
  }
  g_assert_cmpuint (cloth_point_grid_nearest (grid, 100, 50, NAN, near, 1), ==,
      0);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/pointgrid/brute-force", test_brute_force);
  g_test_add_func ("/pointgrid/empty", test_empty);
  g_test_add_func ("/pointgrid/no-numbers", test_no_numbers);
  return g_test_run ();
}
