/* Surfaces of disparities whose truth is a formula: planes, paraboloids and steps, with
 * holes, in odd outlines; a real scene whose truth was measured; what can't be.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/cv/cv.h"
#include "gst/math/random.h"
#include "gst/vision/disparity/refine-private.h"
#include "tests/common/picture.h"
#include "tests/core/disparitymap.h"

static gdouble
paraboloid (gdouble x, gdouble y)
{
  return 90 - 0.002 * (x - 70) * (x - 70) - 0.0013 * (y - 50) * (y - 50);
}

/* Two planes that pass by each other. */
static gdouble
cliff (gdouble x, gdouble y)
{
  return x < 60 + 0.3 * y ? 60 + 0.05 * x : 66 + 0.03 * y;
}

static void
quantise (ClothDisparityMap * map)
{
  for (gint y = 0; y < map->height; y++)
    for (gint x = 0; x < map->width; x++)
      map->disparities[y * map->stride + x] =
          rintf (map->disparities[y * map->stride + x]);
}

static void
punch (ClothDisparityMap * map, gint left, gint top, gint width, gint height)
{
  for (gint y = top; y < top + height; y++)
    for (gint x = left; x < left + width; x++)
      map->disparities[y * map->stride + x] = NAN;
}

static void
smooth (ClothDisparityMap * map, guint sweeps)
{
  ClothDisparityParams params = cloth_disparity_default_params ();
  g_autoptr (ClothDisparity) self = cloth_disparity_new ();
  g_autoptr (GError) error = NULL;

  params.sweeps = sweeps;
  g_assert_true (cloth_disparity_smooth (self, &params, map, NULL,
          CLOTH_SIMD_BEST, &error));
  g_assert_no_error (error);
}

static void
fill (ClothDisparityMap * map, gdouble step, guint area)
{
  ClothDisparityParams params = cloth_disparity_default_params ();
  g_autoptr (ClothDisparity) self = cloth_disparity_new ();
  g_autoptr (GError) error = NULL;

  params.step = step;
  params.hole = area;
  params.tolerance = 1e-7;
  g_assert_true (cloth_disparity_fill (self, &params, map, NULL,
          CLOTH_SIMD_BEST, &error));
  g_assert_no_error (error);
}

/* ---- fractions ---- */

static void
test_plane (void)
{
  ClothDisparityMap map = make_map (170, 131, plane);
  gdouble most, rms;

  quantise (&map);
  measure (&map, plane, &most, &rms);
  g_assert_cmpfloat (rms, >, 0.25);
  smooth (&map, 30);
  measure (&map, plane, &most, &rms);
  g_assert_cmpfloat (most, <, 0.05);
  free_map (&map);
}

static void
test_paraboloid (void)
{
  ClothDisparityMap map = make_map (150, 117, paraboloid);
  gdouble before, most, rms;

  quantise (&map);
  measure (&map, paraboloid, &most, &before);
  smooth (&map, 30);
  measure (&map, paraboloid, &most, &rms);
  g_assert_cmpfloat (rms, <, 0.4 * before);
  free_map (&map);
}

/* Neither the border of an L nor its inner corner bends a plane. */
static void
test_outline (void)
{
  ClothDisparityMap map = make_map (150, 140, plane);
  gdouble most, rms;

  for (gint y = 0; y < 140; y++)
    for (gint x = 0; x < 150; x++)
      if ((x > 60 && y > 50) || x < 3 || y < 4 || x > 140)
        map.states[y * map.stride + x] = OUTSIDE;
  smooth (&map, 30);
  measure (&map, plane, &most, &rms);
  g_assert_cmpfloat (most, <, 1e-3);
  quantise (&map);
  smooth (&map, 30);
  measure (&map, plane, &most, &rms);
  g_assert_cmpfloat (most, <, 0.08);
  g_assert_cmpfloat (rms, <, 0.02);
  /* what lies outside stays as it was */
  g_assert_cmpfloat (map.disparities[100 * map.stride + 100], ==,
      rintf ((gfloat) plane (100, 100)));
  free_map (&map);
}

static void
test_step (void)
{
  ClothDisparityMap map = make_map (160, 120, cliff);
  gdouble most, rms;

  smooth (&map, 30);
  measure (&map, cliff, &most, &rms);
  g_assert_cmpfloat (most, <, 1e-3);
  quantise (&map);
  smooth (&map, 30);
  measure (&map, cliff, &most, &rms);
  /* the last stair before the cliff is any part of one: its slope is not known */
  g_assert_cmpfloat (most, <, 1.001);
  g_assert_cmpfloat (rms, <, 0.12);
  free_map (&map);
}

/* ---- holes ---- */

static void
test_fill (void)
{
  static const Formula formulas[] = { plane, paraboloid };

  for (guint i = 0; i < 2; i++) {
    ClothDisparityMap map = make_map (150, 117, formulas[i]);
    gdouble most, rms;

    punch (&map, 20, 15, 1, 1);
    punch (&map, 40, 20, 31, 37);
    punch (&map, 90, 60, 40, 12);
    punch (&map, 101, 20, 3, 60);
    fill (&map, 1.5, 2000);
    g_assert_cmpuint (count (&map, HOLE), ==, 0);
    g_assert_cmpuint (count (&map, FILLED), ==, 1 + 31 * 37 + 40 * 12 + 3 * 48);
    measure (&map, formulas[i], &most, &rms);
    g_assert_cmpfloat (most, <, 1e-3);
    free_map (&map);
  }
}

static void
test_unfilled (void)
{
  ClothDisparityMap map = make_map (160, 120, cliff);
  gdouble most, rms;

  punch (&map, 10, 10, 10, 10);
  punch (&map, 70, 60, 20, 20); /* at the cliff */
  punch (&map, 120, 20, 20, 20);        /* too large */
  punch (&map, 130, 90, 1, 1);
  fill (&map, 1.5, 399);
  g_assert_cmpuint (count (&map, FILLED), ==, 101);
  g_assert_cmpuint (count (&map, HOLE), ==, 800);
  measure (&map, cliff, &most, &rms);
  g_assert_cmpfloat (most, <, 1e-3);
  /* and holes stay away from what is smoothed */
  smooth (&map, 30);
  g_assert_cmpuint (count (&map, HOLE), ==, 800);
  measure (&map, cliff, &most, &rms);
  g_assert_cmpfloat (most, <, 1e-3);
  free_map (&map);

  /* nothing around the hole tells of the cliff in it */
  map = make_map (160, 120, cliff);
  for (gint y = 0; y < 120; y++)
    punch (&map, 55 + 3 * y / 10, y, 10, 1);
  fill (&map, 0.4, 20000);
  g_assert_cmpuint (count (&map, FILLED), ==, 0);
  g_assert_cmpuint (count (&map, HOLE), ==, 1200);
  free_map (&map);
}

/* ---- a real scene ---- */

static TestPicture *
load_half (const gchar * name)
{
  g_autofree gchar *path = g_build_filename (TEST_DATA, "aloe", name, NULL);
  g_autoptr (TestPicture) whole = test_picture_load (path);
  const ClothImage *from = &whole->image;
  TestPicture *half = test_picture_new (from->width / 2, from->height / 2, 0);
  const ClothCvPicture picture = { from->data, from->width, from->height,
    from->stride
  };

  g_assert_true (cloth_cv_squeeze (&picture, half->image.width,
          half->image.height, half->data, half->image.width, NULL));
  return half;
}

/* The truth at half the size, in whole and half pixels; NaN where it is unknown or has an
 * edge. */
static gfloat *
load_truth (gint width, gint height)
{
  g_autoptr (TestPicture) whole = test_picture_load (TEST_DATA
      "/aloe/aloeGT.png");
  const gint stride = whole->image.stride;
  gfloat *truth = g_new (gfloat, width * height);

  for (gint y = 0; y < height; y++)
    for (gint x = 0; x < width; x++) {
      const guint8 *at = whole->data + 2 * y * stride + 2 * x;
      const guint8 most = MAX (MAX (at[0], at[1]), MAX (at[stride],
              at[stride + 1]));
      const guint8 least = MIN (MIN (at[0], at[1]), MIN (at[stride],
              at[stride + 1]));

      truth[y * width + x] = least == 0 || most - least > 2 ? NAN :
          (gfloat) (at[0] + at[1] + at[stride] + at[stride + 1]) / 8;
    }
  return truth;
}

/* Of what has @state: the share that is more than a pixel off, and the RMS of the rest. */
static gdouble
measure_scene (const ClothDisparityMap * map, const gfloat * truth,
    guint8 state, gdouble * rms)
{
  guint n = 0, n_bad = 0;
  gdouble sum = 0;

  for (gint i = 0; i < map->width * map->height; i++)
    if (map->states[i] == state && !isnan (truth[i])) {
      const gdouble off = fabs ((gdouble) map->disparities[i]
          - (gdouble) truth[i]);

      n++;
      n_bad += off > 1;
      sum += off > 1 ? 0 : off * off;
    }
  g_assert_cmpuint (n, >, 0);
  *rms = sqrt (sum / (n - n_bad));
  g_test_message ("state %d: %u disparities, %.2f%% are off by more than a "
      "pixel, RMS of the others %.3f", state, n, 100. * n_bad / n, *rms);
  return n_bad / (gdouble) n;
}

static void
test_scene (void)
{
  g_autoptr (TestPicture) left = load_half ("aloeL.jpg");
  g_autoptr (TestPicture) right = load_half ("aloeR.jpg");
  const gint width = left->image.width, height = left->image.height;
  const gsize n = (gsize) width * (gsize) height;
  g_autofree gfloat *truth = load_truth (width, height);
  g_autofree gfloat *disparities = g_new (gfloat, n);
  g_autofree guint8 *states = g_malloc (n);
  g_autofree gint16 *found = g_new (gint16, n);
  ClothCvStereoParams stereo = cloth_cv_stereo_default_params ();
  g_autoptr (ClothCvStereo) matcher = NULL;
  const ClothCvPicture a = { left->data, width, height, width };
  const ClothCvPicture b = { right->data, width, height, width };
  const ClothDisparityPair pair = cloth_disparity_pair (found, width, height);
  ClothDisparityMap map = { disparities, states, width, height, width };
  ClothDisparityBorder border;
  gdouble bad, rms, bad_filled, rms_filled, bad_after, rms_after;

  stereo.least = 16;
  stereo.range = 96;
  matcher = cloth_cv_stereo_new (&stereo, NULL);
  g_assert_true (cloth_cv_stereo_run (matcher, &a, &b, found, NULL));
  g_assert_true (cloth_disparity_border (&pair, 16, 111, &border, NULL));
  g_assert_cmpfloat (MAX (border.least, border.most), <, 0.01);
  memset (states, MEASURED, n);
  g_assert_true (cloth_disparity_merge (&pair, 1, 1, &map, NULL, NULL));
  for (gsize i = 0; i < n; i++)
    disparities[i] = rintf (disparities[i]);
  bad = measure_scene (&map, truth, MEASURED, &rms);
  fill (&map, 1.5, 300);
  bad_filled = measure_scene (&map, truth, FILLED, &rms_filled);
  g_assert_cmpfloat (bad_filled, <, 0.25);
  smooth (&map, 30);
  bad_after = measure_scene (&map, truth, MEASURED, &rms_after);
  g_assert_cmpfloat (bad_after, <, 1.05 * bad);
  g_assert_cmpfloat (rms_after, <, 0.95 * rms);

  /* half of the range: much lies at its end */
  stereo.range = 16;
  cloth_cv_stereo_free (matcher);
  matcher = cloth_cv_stereo_new (&stereo, NULL);
  g_assert_true (cloth_cv_stereo_run (matcher, &a, &b, found, NULL));
  g_assert_true (cloth_disparity_border (&pair, 16, 31, &border, NULL));
  g_assert_cmpfloat (border.most, >, 0.05);
}

/* ---- the same bits ---- */

static gdouble
noisy (gdouble x, gdouble y)
{
  const guint hash = ((guint) x * 73856093u ^ (guint) y * 19349663u)
      * 1274126177u;

  return (hash >> 28) == 0 ? NAN : 70 + 6 * sin (x / 23) * cos (y / 31)
      + (hash >> 20 & 255) / 400. + (x > 150 ? 9 : 0);
}

static void
test_levels (void)
{
  static const ClothSimd levels[] = { CLOTH_SIMD_SCALAR, CLOTH_SIMD_AVX2,
    CLOTH_SIMD_AVX512
  };
  static const gint sizes[][2] = { {1, 1}, {1, 40}, {40, 1}, {2, 3}, {17, 16},
  {48, 50}, {333, 211}
  };
  g_autoptr (ClothDisparity) self = cloth_disparity_new ();
  const ClothDisparityParams params = cloth_disparity_default_params ();

  for (guint s = 0; s < G_N_ELEMENTS (sizes); s++) {
    ClothDisparityMap first = make_map (sizes[s][0], sizes[s][1], noisy);
    const gsize n = (gsize) first.stride * (gsize) first.height;

    for (guint i = 0; i < 9; i++) {
      ClothDisparityMap map = make_map (sizes[s][0], sizes[s][1], noisy);
      g_autoptr (ClothPool) pool = i < 3 ? NULL : cloth_pool_new (i - 1);

      g_assert_true (cloth_disparity_fill (self, &params, &map, pool,
              levels[i % 3], NULL));
      g_assert_true (cloth_disparity_smooth (self, &params, &map, pool,
              levels[i % 3], NULL));
      if (i == 0) {
        memcpy (first.disparities, map.disparities, n * sizeof (gfloat));
        memcpy (first.states, map.states, n);
      }
      g_assert_cmpmem (map.disparities, n * sizeof (gfloat), first.disparities,
          n * sizeof (gfloat));
      g_assert_cmpmem (map.states, n, first.states, n);
      free_map (&map);
    }
    free_map (&first);
  }
}

/* Memory that has served other maps gives the same as new memory. */
static void
test_again (void)
{
  g_autoptr (ClothDisparity) self = cloth_disparity_new ();
  const ClothDisparityParams params = cloth_disparity_default_params ();
  ClothDisparityMap first = make_map (120, 90, noisy);

  for (guint i = 0; i < 3; i++) {
    ClothDisparityMap map = make_map (120, 90, noisy);
    ClothDisparityMap other = make_map (120, 90, paraboloid);

    punch (&other, 10, 10, 30, 30);
    g_assert_true (cloth_disparity_fill (self, &params, &map, NULL,
            CLOTH_SIMD_BEST, NULL));
    g_assert_true (cloth_disparity_smooth (self, &params, &map, NULL,
            CLOTH_SIMD_BEST, NULL));
    if (i == 0)
      memcpy (first.disparities, map.disparities, sizeof (gfloat) * 125 * 90);
    g_assert_cmpmem (map.disparities, sizeof (gfloat) * 125 * 90,
        first.disparities, sizeof (gfloat) * 125 * 90);
    g_assert_true (cloth_disparity_fill (self, &params, &other, NULL,
            CLOTH_SIMD_BEST, NULL));
    free_map (&map);
    free_map (&other);
  }
  free_map (&first);
}

/* ---- what is hardly there ---- */

static void
test_little (void)
{
  static const gint sizes[][2] = { {1, 1}, {1, 9}, {9, 1}, {2, 2}, {3, 40} };

  for (guint i = 0; i < G_N_ELEMENTS (sizes); i++) {
    ClothDisparityMap map = make_map (sizes[i][0], sizes[i][1], plane);
    const guint n = (guint) (map.width * map.height);
    gdouble most, rms;

    smooth (&map, 30);
    measure (&map, plane, &most, &rms);
    g_assert_cmpfloat (most, <, 1e-3);
    map.disparities[0] = INFINITY;
    fill (&map, 1.5, 10);
    g_assert_cmpuint (count (&map, n > 1 ? FILLED : HOLE), ==, 1);
    /* nothing known, and nothing asked for */
    punch (&map, 0, 0, map.width, map.height);
    fill (&map, 1.5, 1000);
    smooth (&map, 30);
    g_assert_cmpuint (count (&map, HOLE), ==, n);
    for (gint y = 0; y < map.height; y++)
      memset (map.states + y * map.stride, OUTSIDE, (gsize) map.width);
    fill (&map, 1.5, 1000);
    smooth (&map, 30);
    g_assert_cmpuint (count (&map, OUTSIDE), ==, n);
    free_map (&map);
  }
}

/* No number stays what it isn't, however wild it is. */
static void
test_wild (void)
{
  static const gfloat wild[] = { NAN, INFINITY, -INFINITY, 1e30f, -1e30f,
    32768, -32767, 1e-40f, 32767
  };
  ClothDisparityMap map = make_map (64, 64, plane);
  ClothRandom random;

  cloth_random_init (&random, 3);
  for (guint i = 0; i < 2000; i++) {
    const guint at = cloth_random_below (&random, 64) * (guint) map.stride
        + cloth_random_below (&random, 64);

    map.disparities[at] = wild[i % G_N_ELEMENTS (wild)];
    map.states[at] = (guint8) cloth_random_below (&random, 256);
  }
  fill (&map, 1.5, 100000);
  smooth (&map, 30);
  for (gint y = 0; y < 64; y++)
    for (gint x = 0; x < 64; x++) {
      const gint at = y * map.stride + x;

      g_assert_cmpint (map.states[at], <=, FILLED);
      if (map.states[at] >= MEASURED)
        g_assert_cmpfloat (fabsf (map.disparities[at]), <, 1e6);
    }
  free_map (&map);
}

/* ---- what can't be ---- */

static void
refuse_map (gint width, gint height, gint stride)
{
  static gfloat disparities[64];
  static guint8 states[64];
  static gint16 found[64];
  g_autoptr (ClothDisparity) self = cloth_disparity_new ();
  const ClothDisparityParams params = cloth_disparity_default_params ();
  const ClothDisparityPair good = cloth_disparity_pair (found, 8, 8);
  ClothDisparityPair pair = good;
  ClothDisparityBorder border;
  ClothDisparityMap map = { disparities, states, width, height, stride };
  GError *error = NULL;

#define REFUSED(call) G_STMT_START { \
    g_assert_false (call); \
    g_assert_error (error, CLOTH_DISPARITY_ERROR, CLOTH_DISPARITY_ERROR_MAP); \
    g_clear_error (&error); \
  } G_STMT_END

  REFUSED (cloth_disparity_fill (self, &params, &map, NULL, CLOTH_SIMD_BEST,
          &error));
  REFUSED (cloth_disparity_smooth (self, &params, &map, NULL, CLOTH_SIMD_BEST,
          &error));
  REFUSED (cloth_disparity_merge (&good, 1, 1, &map, NULL, &error));
  map = (ClothDisparityMap) {
  disparities, states, 8, 8, 8};
  pair.width = width;
  pair.height = height;
  pair.stride = stride;
  REFUSED (cloth_disparity_merge (&pair, 1, 1, &map, NULL, &error));
  REFUSED (cloth_disparity_border (&pair, 0, 15, &border, &error));
  if (stride >= width)
    REFUSED (cloth_disparity_check (found, found, width, height, -16, 16,
            &error));
#undef REFUSED
}

static void
test_refused_maps (void)
{
  refuse_map (8, 8, 7);
  refuse_map (8, 8, -8);
  refuse_map (0, 8, 8);
  refuse_map (8, 0, 8);
  refuse_map (-1, 8, 8);
  refuse_map (16385, 1, 16385);
  refuse_map (16384, 1025, 16384);
  refuse_map (1, G_MAXINT, 1);
}

static void
refuse_params (const ClothDisparityParams * params, const gchar * name)
{
  g_autoptr (ClothDisparity) self = cloth_disparity_new ();
  ClothDisparityMap map = make_map (8, 8, plane);
  GError *error = NULL;

  for (gint i = 0; i < 2; i++) {
    g_assert_false (i ? cloth_disparity_fill (self, params, &map, NULL,
            CLOTH_SIMD_BEST, &error) : cloth_disparity_smooth (self, params,
            &map, NULL, CLOTH_SIMD_BEST, &error));
    g_assert_error (error, CLOTH_DISPARITY_ERROR,
        CLOTH_DISPARITY_ERROR_PARAMETER);
    g_assert_nonnull (strstr (error->message, name));
    g_clear_error (&error);
  }
  free_map (&map);
}

static void
test_refused_params (void)
{
  const ClothDisparityParams good = cloth_disparity_default_params ();
  ClothDisparityParams params;

#define REFUSED(field, value) G_STMT_START { \
    params = good; \
    params.field = value; \
    refuse_params (&params, #field); \
  } G_STMT_END

  REFUSED (step, 0);
  REFUSED (step, NAN);
  REFUSED (step, INFINITY);
  REFUSED (tolerance, 0);
  REFUSED (tolerance, NAN);
  REFUSED (half_width, -0.1);
  REFUSED (half_width, NAN);
  REFUSED (half_width, 65);
  REFUSED (narrowing, 0);
  REFUSED (narrowing, 1.01);
  REFUSED (sweeps, 10001);
  REFUSED (relaxation, 0);
  REFUSED (relaxation, 2);
#undef REFUSED
}

/* ---- rows of two pictures ---- */

/* A ramp of two grey levels a pixel beside a flat picture: what is seen of it has a formula;
 * the rest isn't seen. Each level gives the same bytes. */
static void
check_rows (guint64 seed)
{
  enum
  { WIDTH = 121 };
  guint8 here[WIDTH], there[WIDTH], shown[WIDTH], states[WIDTH];
  gfloat disparities[WIDTH], first[3][WIDTH], found[3][WIDTH];
  ClothRandom random;

  cloth_random_init (&random, seed);
  for (gint x = 0; x < WIDTH; x++) {
    here[x] = 100;
    there[x] = (guint8) (2 * x + 3);
    shown[x] = x / 10 != 5;
    states[x] = x % 17 ? CLOTH_DISPARITY_MEASURED : CLOTH_DISPARITY_HOLE;
    disparities[x] = (gfloat) (60 * cloth_random_uniform (&random) - 20);
  }
  disparities[7] = NAN;
  disparities[8] = INFINITY;
  disparities[9] = -1e30f;
  for (gint level = CLOTH_SIMD_SCALAR; level <= CLOTH_SIMD_AVX512; level++)
    for (gint hidden = 0; hidden < 2; hidden++) {
      const ClothRefineRow row = { here, there, hidden ? shown : NULL, WIDTH,
        -0.75, disparities, states, CLOTH_DISPARITY_MEASURED, found[0],
        found[1], found[2]
      };

      memset (found, 0xff, sizeof found);
      CLOTH_SIMD_TABLE (cloth_refine_kernel,
          (ClothSimd) level)->compare (&row, 2, WIDTH - 1);
      for (gint x = 2; x < WIDTH - 1; x++) {
        const gdouble at = x - 0.75 * (gdouble) disparities[x];
        const gboolean seen = states[x] == CLOTH_DISPARITY_MEASURED && at >= 1
            && at < WIDTH - 2 && (!hidden || shown[(gint) (at + 0.5)]);

        g_assert_cmpfloat (found[0][x], ==, seen);
        g_assert_cmpint (isnan (found[1][x]), ==, !seen);
        if (seen)
          g_assert_cmpfloat_with_epsilon (found[1][x], -1.5, 1e-6);
        g_assert_cmpfloat_with_epsilon (found[2][x],
            seen ? 97 - 2 * at : 0, 1e-4);
      }
      g_assert_true (isnan (found[0][1]) && isnan (found[0][WIDTH - 1]));
      if (level == CLOTH_SIMD_SCALAR && hidden)
        memcpy (first, found, sizeof first);
      else if (hidden)
        g_assert_cmpmem (found, sizeof found, first, sizeof first);
    }
}

static void
test_rows (void)
{
  for (guint64 seed = 0; seed < 50; seed++)
    check_rows (seed);
}

int
main (int argc, char **argv)
{
  test_picture_init (&argc, &argv);
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/disparity/plane", test_plane);
  g_test_add_func ("/disparity/paraboloid", test_paraboloid);
  g_test_add_func ("/disparity/outline", test_outline);
  g_test_add_func ("/disparity/step", test_step);
  g_test_add_func ("/disparity/fill", test_fill);
  g_test_add_func ("/disparity/unfilled", test_unfilled);
  g_test_add_func ("/disparity/scene", test_scene);
  g_test_add_func ("/disparity/levels", test_levels);
  g_test_add_func ("/disparity/again", test_again);
  g_test_add_func ("/disparity/little", test_little);
  g_test_add_func ("/disparity/wild", test_wild);
  g_test_add_func ("/disparity/rows", test_rows);
  g_test_add_func ("/disparity/refused-maps", test_refused_maps);
  g_test_add_func ("/disparity/refused-params", test_refused_params);
  return g_test_run ();
}
