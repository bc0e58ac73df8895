/* Baselines that see the same scene mirrored and turned; disparities that pictures of waves
 * refine; what can't be.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "tests/core/disparitymap.h"

/* ---- baselines ---- */

#define WIDTH 60
#define HEIGHT 40

/* Pairs to the right, to the left (mirrored), and below (rows as columns) with a baseline of
 * three quarters. */
static void
make_pairs (gint16 * right, gint16 * left, gint16 * below,
    ClothDisparityPair * pairs)
{
  static const gdouble mirrored[9] = { -1, 0, WIDTH - 1, 0, 1, 0, 0, 0, 1 };
  static const gdouble turned[9] = { 0, 1, 0, 1, 0, 0, 0, 0, 1 };

  for (gint y = 0; y < HEIGHT; y++)
    for (gint x = 0; x < WIDTH; x++) {
      const gdouble d = 32 + 0.25 * x + 0.5 * y;

      right[y * WIDTH + x] = (gint16) (16 * d);
      left[y * WIDTH + WIDTH - 1 - x] = (gint16) (16 * d);
      below[x * HEIGHT + y] = (gint16) (12 * d);
    }
  pairs[0] = cloth_disparity_pair (right, WIDTH, HEIGHT);
  pairs[1] = cloth_disparity_pair (left, WIDTH, HEIGHT);
  pairs[2] = cloth_disparity_pair (below, HEIGHT, WIDTH);
  memcpy (pairs[1].place, mirrored, sizeof (mirrored));
  memcpy (pairs[2].place, turned, sizeof (turned));
  pairs[2].unit[2] = 4 / 3.;
}

static gdouble
ramp (gdouble x, gdouble y)
{
  return 32 + 0.25 * x + 0.5 * y;
}

static void
test_merge (void)
{
  g_autofree gint16 *right = g_new (gint16, WIDTH * HEIGHT);
  g_autofree gint16 *left = g_new (gint16, WIDTH * HEIGHT);
  g_autofree gint16 *below = g_new (gint16, WIDTH * HEIGHT);
  ClothDisparityMap map = make_map (WIDTH, HEIGHT, plane);
  ClothDisparityPair pairs[3];
  gdouble most, rms;

  make_pairs (right, left, below, pairs);
  map.states[0] = OUTSIDE;
  right[5] = -16;               /* hidden from one, then from all */
  right[6] = left[WIDTH - 1 - 6] = below[6 * HEIGHT] = -16;
  left[WIDTH - 1 - 7] += 20;    /* another surface */
  left[WIDTH - 1 - 8] += 6;     /* a bit off */
  g_assert_true (cloth_disparity_merge (pairs, 3, 1, &map, NULL, NULL));
  g_assert_cmpuint (count (&map, OUTSIDE), ==, 1);
  g_assert_cmpint (map.states[6], ==, HOLE);
  g_assert_cmpint (map.states[7], ==, HOLE);
  g_assert_cmpuint (count (&map, HOLE), ==, 2);
  /* weights 1, 1 and 9/16 */
  g_assert_cmpfloat_with_epsilon (map.disparities[8], 34 + 6 / 16. / 2.5625,
      1e-5);
  map.disparities[8] = 34;
  measure (&map, ramp, &most, &rms);
  g_assert_cmpfloat (most, <, 1e-5);
  free_map (&map);
}

/* Of a pair that is turned about its own axes places lie between pixels, and the depth is
 * another one: the disparity of a plane of the first stays linear. */
static void
test_merge_turned (void)
{
  g_autofree gint16 *found = g_new (gint16, WIDTH * HEIGHT);
  ClothDisparityPair pair = cloth_disparity_pair (found, WIDTH, HEIGHT);
  ClothDisparityMap map = make_map (WIDTH, HEIGHT, plane);
  gdouble most, rms;

  pair.place[2] = 0.5;
  pair.place[5] = -0.25;
  pair.unit[0] = 0.001;
  pair.offset = 2;
  for (gint y = 0; y < HEIGHT; y++)
    for (gint x = 0; x < WIDTH; x++)
      found[y * WIDTH + x] = (gint16) lrint (16 * (ramp (x - 0.5, y + 0.25)
              / (1 + 0.001 * (x - 0.5)) - 2));
  g_assert_true (cloth_disparity_merge (&pair, 1, 1, &map, NULL, NULL));
  g_assert_cmpuint (count (&map, HOLE), ==, HEIGHT);
  measure (&map, ramp, &most, &rms);
  g_assert_cmpfloat (most, <, 0.5);
  g_assert_cmpfloat (rms, <, 0.05);
  free_map (&map);
}

static void
test_check (void)
{
  gint16 left[2 * 10] = { 0 }, right[2 * 10] = { 0 };

  for (gint i = 0; i < 20; i++) {
    left[i] = 3 * 16 + 7;
    right[i] = 3 * 16;
  }
  left[8] = -16;
  right[9 - 6] = 5 * 16;        /* seen from column 9 */
  right[9 - 4] = -16;           /* from column 7 */
  g_assert_true (cloth_disparity_check (left, right, 10, 2, -16, 16, NULL));
  for (gint x = 0; x < 10; x++) {
    g_assert_cmpint (left[x], ==, x < 3 || x > 6 ? -16 : 55);
    g_assert_cmpint (left[10 + x], ==, x < 3 ? -16 : 55);
  }
}

static void
test_border (void)
{
  gint16 found[100] = { 0 };
  ClothDisparityPair pair = cloth_disparity_pair (found, 10, 10);
  ClothDisparityBorder border;

  for (gint i = 0; i < 100; i++)
    found[i] = (gint16) (i < 20 ? -16 : 16 * (10 + i / 5) + i % 16);
  g_assert_true (cloth_disparity_border (&pair, 14, 29, &border, NULL));
  g_assert_cmpfloat_with_epsilon (border.least, 5 / 80., 1e-9);
  g_assert_cmpfloat_with_epsilon (border.most, 10 / 80., 1e-9);
  for (gint i = 0; i < 100; i++)
    found[i] = -16;
  g_assert_true (cloth_disparity_border (&pair, 14, 29, &border, NULL));
  g_assert_cmpfloat (border.least, ==, 0);
  g_assert_cmpfloat (border.most, ==, 0);
}

/* ---- pictures ---- */

/* A picture of many waves, of any place. */
static gdouble
waves (gdouble x, gdouble y)
{
  return 128 + 25 * sin (0.7 * x + 0.2 * y) + 25 * sin (0.31 * x - 0.83 * y)
      + 20 * sin (-0.47 * x + 0.5 * y + 1) + 15 * sin (1.1 * x + 0.4 * y + 2);
}

/* What a camera sees there of which the middle camera sees waves () and which sees p at
 * p + plane (p)·shift: one of the two components of @shift is 0. */
static void
draw_waves (guint8 * data, gint width, gint height, gdouble across,
    gdouble down)
{
  for (gint y = 0; y < height; y++)
    for (gint x = 0; x < width; x++) {
      const gdouble u = (x - across * plane (0, y)) / (1 + across * 0.071);
      const gdouble v = (y - down * plane (x, 0)) / (1 - down * 0.043);

      data[y * width + x] = (guint8) lrint (waves (across == 0 ? x : u,
              down == 0 ? y : v));
    }
}

static void
test_refine (void)
{
  static const gdouble shifts[][2] = { {-1, 0}, {1, 0}, {0, 0.75}, {0, -1} };
  const gint w = 300, h = 280;
  const gsize n = (gsize) (w * h);
  g_autofree guint8 *middle = g_malloc (n);
  const ClothImage image = { middle, w, h, w };
  ClothRefineParams params = cloth_refine_default_params ();
  g_autoptr (ClothRefine) self = cloth_refine_new ();
  guint8 *data[4];
  ClothRefineView views[4];

  draw_waves (middle, w, h, 0, 0);
  for (guint k = 0; k < 4; k++) {
    data[k] = g_malloc (n);
    draw_waves (data[k], w, h, shifts[k][0], shifts[k][1]);
    views[k] = (ClothRefineView) { {
    data[k], w, h, w}
    , {
    shifts[k][0], shifts[k][1]}
    };
  }
  for (guint k = 0; k < 4; k++)
    for (guint both = 0; both < 2; both++) {
      ClothDisparityMap map = make_map (w, h, plane), again;
      g_autoptr (ClothPool) pool = cloth_pool_new (3);
      gdouble most, rms;

      /* only what the others see, and not up to the border of a window */
      for (gint y = 0; y < h; y++)
        for (gint x = 0; x < w; x++)
          if (x < 125 || x > w - 125 || y < 125 || y > h - 125)
            map.states[y * map.stride + x] = OUTSIDE;
          else
            map.disparities[y * map.stride + x] += (gfloat) (0.45 * cos (x
                    / 20.));
      again = map;
      again.disparities = g_memdup2 (map.disparities, sizeof (gfloat)
          * (gsize) (map.stride * h));
      measure (&map, plane, &most, &rms);
      g_assert_cmpfloat (rms, >, 0.2);
      g_assert_true (cloth_refine_run (self, &params, &image, &views[both ? 0 :
                  k], both ? 4 : 1, &map, NULL, NULL));
      measure (&map, plane, &most, &rms);
      g_assert_cmpfloat (rms, <, 0.05);
      g_assert_true (cloth_refine_run (self, &params, &image, &views[both ? 0 :
                  k], both ? 4 : 1, &again, pool, NULL));
      g_assert_cmpmem (again.disparities, sizeof (gfloat) * (gsize) (map.stride
              * h), map.disparities, sizeof (gfloat) * (gsize) (map.stride
              * h));
      g_free (again.disparities);

      /* and many more rounds don't shake it */
      params.rounds = 40;
      g_assert_true (cloth_refine_run (self, &params, &image, &views[both ? 0 :
                  k], both ? 4 : 1, &map, pool, NULL));
      params.rounds = 4;
      measure (&map, plane, &most, &rms);
      g_assert_cmpfloat (rms, <, 0.05);
      free_map (&map);
    }
  for (guint k = 0; k < 4; k++)
    g_free (data[k]);
}

/* A window without texture moves nothing; nor do pictures of a pixel, or maps of nothing. */
static void
test_refine_little (void)
{
  static const gint sizes[][2] = { {1, 1}, {1, 9}, {9, 1}, {30, 20} };
  g_autofree guint8 *grey = g_malloc0 (1000);
  const ClothRefineParams params = cloth_refine_default_params ();
  g_autoptr (ClothRefine) self = cloth_refine_new ();

  for (guint i = 0; i < G_N_ELEMENTS (sizes); i++) {
    const gint w = sizes[i][0], h = sizes[i][1];
    const ClothImage image = { grey, w, h, w };
    const ClothRefineView view = { image, {-0.125, 0} };
    ClothDisparityMap map = make_map (w, h, plane);
    gdouble most, rms;

    g_assert_true (cloth_refine_run (self, &params, &image, &view, 1, &map,
            NULL, NULL));
    measure (&map, plane, &most, &rms);
    g_assert_cmpfloat (most, <, 1e-5);
    /* disparities that aren't numbers are seen nowhere */
    for (gint x = 0; x < w; x++)
      map.disparities[x] = x % 2 ? NAN : INFINITY;
    g_assert_true (cloth_refine_run (self, &params, &image, &view, 1, &map,
            NULL, NULL));
    g_assert_false (isfinite (map.disparities[0]));
    for (gint y = 0; y < h; y++)
      memset (map.states + y * map.stride, OUTSIDE, (gsize) w);
    g_assert_true (cloth_refine_run (self, &params, &image, &view, 1, &map,
            NULL, NULL));
    free_map (&map);
  }
}

static void
refuse_refine (const ClothRefineParams * params, gint width, gint stride,
    guint n_views, gdouble shift)
{
  static guint8 grey[64];
  const ClothImage good = { grey, 8, 8, 8 };
  const ClothImage bad = { grey, width, 8, stride };
  const ClothRefineView view = { good, {-1, shift} }, odd = { bad, {-1, 0} };
  g_autoptr (ClothRefine) self = cloth_refine_new ();
  ClothDisparityMap map = make_map (8, 8, plane);
  GError *error = NULL;

  g_assert_false (cloth_refine_run (self, params, &bad, &view, n_views, &map,
          NULL, &error));
  g_assert_true (error && error->domain == CLOTH_DISPARITY_ERROR);
  g_clear_error (&error);
  if (stride < width) {
    g_assert_false (cloth_refine_run (self, params, &good, &odd, 1, &map,
            NULL, &error));
    g_assert_error (error, CLOTH_DISPARITY_ERROR, CLOTH_DISPARITY_ERROR_MAP);
    g_clear_error (&error);
  }
  free_map (&map);
}

static void
test_refused_pictures (void)
{
  const ClothRefineParams good = cloth_refine_default_params ();
  ClothRefineParams params;

  refuse_refine (&good, 8, 7, 1, 0);
  refuse_refine (&good, 7, 8, 1, 0);
  refuse_refine (&good, 0, 8, 1, 0);
  refuse_refine (&good, 8, 8, 0, 0);
  refuse_refine (&good, 8, 8, 8, 0);
  refuse_refine (&good, 8, 8, 1, NAN);
#define REFUSED(field, value) G_STMT_START { \
    params = good; \
    params.field = value; \
    refuse_refine (&params, 8, 8, 1, 0); \
  } G_STMT_END
  REFUSED (radius, 0);
  REFUSED (radius, 65);
  REFUSED (rounds, 101);
  REFUSED (outlier, 0);
  REFUSED (outlier, NAN);
  REFUSED (damping, -1);
  REFUSED (damping, NAN);
  REFUSED (most, -1);
  REFUSED (most, 5);
#undef REFUSED
}

static void
test_refused_pairs (void)
{
  gint16 found[64] = { 0 };
  const ClothDisparityPair good = cloth_disparity_pair (found, 8, 8);
  ClothDisparityPair pairs[9];
  ClothDisparityMap map = make_map (8, 8, plane);
  GError *error = NULL;

#define REFUSED(call) G_STMT_START { \
    g_assert_false (call); \
    g_assert_error (error, CLOTH_DISPARITY_ERROR, \
        CLOTH_DISPARITY_ERROR_PARAMETER); \
    g_clear_error (&error); \
  } G_STMT_END

  for (gint i = 0; i < 9; i++)
    pairs[i] = good;
  REFUSED (cloth_disparity_merge (pairs, 0, 1, &map, NULL, &error));
  REFUSED (cloth_disparity_merge (pairs, 9, 1, &map, NULL, &error));
  REFUSED (cloth_disparity_merge (pairs, 1, 0, &map, NULL, &error));
  REFUSED (cloth_disparity_merge (pairs, 1, NAN, &map, NULL, &error));
  REFUSED (cloth_disparity_check (found, found, 8, 8, -16, -1, &error));
  pairs[1].steps = 0;
  REFUSED (cloth_disparity_merge (pairs, 2, 1, &map, NULL, &error));
  pairs[1] = good;
  pairs[1].place[4] = NAN;
  REFUSED (cloth_disparity_merge (pairs, 2, 1, &map, NULL, &error));
  pairs[1] = good;
  pairs[1].unit[2] = INFINITY;
  REFUSED (cloth_disparity_merge (pairs, 2, 1, &map, NULL, &error));
  pairs[1] = good;
  pairs[1].offset = NAN;
  REFUSED (cloth_disparity_merge (pairs, 2, 1, &map, NULL, &error));
#undef REFUSED
  /* places beyond numbers, and behind the camera, are outside */
  for (gint i = 0; i < 3; i++) {
    pairs[0] = good;
    pairs[0].place[i == 0 ? 2 : i == 1 ? 8 : 6] = i == 0 ? 1e300 : -1e300;
    g_assert_true (cloth_disparity_merge (pairs, 1, 1, &map, NULL, NULL));
    g_assert_cmpuint (count (&map, MEASURED), <=, 8);
  }
  free_map (&map);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/disparitypairs/merge", test_merge);
  g_test_add_func ("/disparitypairs/merge-turned", test_merge_turned);
  g_test_add_func ("/disparitypairs/check", test_check);
  g_test_add_func ("/disparitypairs/border", test_border);
  g_test_add_func ("/disparitypairs/refine", test_refine);
  g_test_add_func ("/disparitypairs/refine-little", test_refine_little);
  g_test_add_func ("/disparitypairs/refused-pictures", test_refused_pictures);
  g_test_add_func ("/disparitypairs/refused-pairs", test_refused_pairs);
  return g_test_run ();
}
