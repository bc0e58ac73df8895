/* The corner model: exactness, scatter and own covariance, refusals.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/corner/corner.h"

#include "tests/core/checker.h"

static ClothImage
view (const guint8 * data)
{
  return (ClothImage) {
  data, CHECKER_SIZE, CHECKER_SIZE, CHECKER_SIZE};
}

/* Without noise only the rounding to whole levels is left. */
static void
test_exact (void)
{
  static const gdouble bound[] = { 0.01, 0.02, 0.02 };
  g_autoptr (GRand) rand = g_rand_new_with_seed (3);
  g_autofree gfloat *picture = g_new (gfloat, CHECKER_SIZE * CHECKER_SIZE);
  guint8 data[CHECKER_SIZE * CHECKER_SIZE];
  ClothCornerParams params = cloth_corner_default_params ();

  params.radius = 6;
  for (CheckerKind kind = CHECKER_X; kind <= CHECKER_T; kind++) {
    gdouble worst = 0, worst_blur = 0;

    for (gint i = 0; i < 12; i++) {
      CheckerCorner c = checker_random (kind, rand);
      const ClothImage image = view (data);
      ClothCornerFit fit;
      gdouble box = c.blur * c.blur + 1.0 / 12.0, cross;

      checker_render (&c, picture);
      checker_expose (picture, 0, rand, data);
      g_assert_true (cloth_corner_refine (&image,
              (gfloat) (c.x + g_rand_double_range (rand, -0.7, 0.7)),
              (gfloat) (c.y + g_rand_double_range (rand, -0.7, 0.7)), &params,
              CLOTH_SIMD_BEST, &fit));
      worst = MAX (worst, hypot (fit.x - c.x, fit.y - c.y));
      worst_blur = MAX (worst_blur, fabs (fit.blur - sqrt (box)));
      g_assert_cmpfloat_with_epsilon (fit.contrast, 160, 4);
      /* The edges are known up to half turns and their order. */
      cross = MIN (fabs (sin (fit.theta[0] - c.theta[0])),
          fabs (sin (fit.theta[0] - c.theta[1])));
      g_assert_cmpfloat (cross, <, 0.02);
    }
    g_test_message ("kind %d: error at most %.4f px, of the blur %.4f px",
        kind, worst, worst_blur);
    g_assert_cmpfloat (worst, <, bound[kind]);
    g_assert_cmpfloat (worst_blur, <, 0.03);
  }
}

static void
test_scatter (void)
{
  g_autoptr (GRand) rand = g_rand_new_with_seed (4);
  g_autofree gfloat *picture = g_new (gfloat, CHECKER_SIZE * CHECKER_SIZE);
  guint8 data[CHECKER_SIZE * CHECKER_SIZE];
  static const gfloat radii[] = { 3, 5, 8 };

  for (CheckerKind kind = CHECKER_X; kind <= CHECKER_L; kind++) {
    CheckerScatter scatter[G_N_ELEMENTS (radii)] = { {0}
    };
    gdouble rms = 0;
    guint evaluations = 0;

    for (gint i = 0; i < 40; i++) {
      CheckerCorner c = checker_random (kind, rand);
      checker_render (&c, picture);
      for (gint draw = 0; draw < 15; draw++) {
        const ClothImage image = view (data);
        checker_expose (picture, 3, rand, data);
        for (guint r = 0; r < G_N_ELEMENTS (radii); r++) {
          ClothCornerParams params = cloth_corner_default_params ();
          ClothCornerFit fit;
          params.radius = radii[r];
          params.known_angles = TRUE;
          params.theta[0] = (gfloat) c.theta[0] + 0.1f;
          params.theta[1] = (gfloat) c.theta[1] - 0.1f;
          g_assert_true (cloth_corner_refine (&image, (gfloat) c.x + 0.3f,
                  (gfloat) c.y - 0.2f, &params, CLOTH_SIMD_BEST, &fit));
          checker_scatter_add (&scatter[r], fit.x - c.x, fit.y - c.y, fit.cov);
          if (radii[r] == 8) {
            rms += fit.rms;
            evaluations += (guint) fit.iterations;
          }
        }
      }
    }
    for (guint r = 0; r < G_N_ELEMENTS (radii); r++) {
      gdouble sigma = checker_scatter_sigma (&scatter[r]);
      gdouble claimed = checker_scatter_claimed (&scatter[r]);
      g_test_message ("%s, noise 3, radius %g: scatter %.4f px, claimed %.4f "
          "px (%.3f), chi2 %.3f, worst %.3f px", kind ? "L" : "checker",
          radii[r], sigma, claimed, claimed / sigma,
          scatter[r].chi2 / (2.0 * scatter[r].n), scatter[r].worst);
      g_assert_cmpfloat (claimed / sigma, >, 0.85);
      g_assert_cmpfloat (claimed / sigma, <, 1.2);
    }
    if (kind == CHECKER_X)
      g_assert_cmpfloat (checker_scatter_sigma (&scatter[2]), <=, 0.012);
    g_test_message ("residual %.3f grey levels, %.1f evaluations",
        rms / scatter[2].n, (gdouble) evaluations / scatter[2].n);
    /* The residual tells the noise that was put in, with that of rounding. */
    g_assert_cmpfloat_with_epsilon (rms / scatter[2].n, sqrt (9 + 1.0 / 12),
        0.05);
  }
}

static void
test_levels (void)
{
  g_autoptr (GRand) rand = g_rand_new_with_seed (5);
  g_autofree gfloat *picture = g_new (gfloat, CHECKER_SIZE * CHECKER_SIZE);
  guint8 data[CHECKER_SIZE * CHECKER_SIZE];
  ClothSimd best = cloth_simd_resolve (CLOTH_SIMD_BEST);

  for (gint i = 0; i < 20; i++) {
    CheckerCorner c = checker_random (i % 3, rand);
    const ClothImage image = view (data);
    ClothCornerParams params = cloth_corner_default_params ();
    ClothCornerFit fit[3];

    memset (fit, 0, sizeof (fit));
    params.radius = (gfloat) (2 + i % 10);
    checker_render (&c, picture);
    checker_expose (picture, 5, rand, data);
    for (ClothSimd level = CLOTH_SIMD_SCALAR; level <= best; level++) {
      gboolean found = cloth_corner_refine (&image, (gfloat) c.x, (gfloat) c.y,
          &params, level, &fit[level]);
      if (!found)
        memset (&fit[level], 0, sizeof (fit[level]));
      g_assert_cmpmem (&fit[level], sizeof (fit[0]), &fit[0], sizeof (fit[0]));
    }
  }
}

/* Edges that a camera blurred before its gamma: dark squares look smaller, and the outer
 * corner moves inwards, until the fit knows of it. */
static void
test_gamma (void)
{
  g_autoptr (GRand) rand = g_rand_new_with_seed (16);
  g_autofree gfloat *picture = g_new (gfloat, CHECKER_SIZE * CHECKER_SIZE);
  guint8 data[CHECKER_SIZE * CHECKER_SIZE];
  gdouble error[2] = { 0 };

  for (gint i = 0; i < 10; i++) {
    CheckerCorner c = checker_random (CHECKER_L, rand);
    const ClothImage image = view (data);

    checker_render (&c, picture);
    for (gint k = 0; k < CHECKER_SIZE * CHECKER_SIZE; k++)
      picture[k] = 255 * sqrtf (picture[k] / 255);
    checker_expose (picture, 0, rand, data);
    for (gint linear = 0; linear < 2; linear++) {
      ClothCornerParams params = cloth_corner_default_params ();
      ClothCornerFit fit;
      params.linear_light = linear;
      g_assert_true (cloth_corner_refine (&image, (gfloat) c.x, (gfloat) c.y,
              &params, CLOTH_SIMD_BEST, &fit));
      error[linear] = MAX (error[linear], hypot (fit.x - c.x, fit.y - c.y));
    }
  }
  g_test_message ("outer corners under gamma 2: off by up to %.3f px, with "
      "gamma told %.3f px", error[0], error[1]);
  g_assert_cmpfloat (error[0], >, 0.1);
  g_assert_cmpfloat (error[1], <, 0.05);
}

/* Near the picture's border the window is cut; the corner is still found. */
static void
test_border (void)
{
  g_autoptr (GRand) rand = g_rand_new_with_seed (6);
  g_autofree gfloat *picture = g_new (gfloat, CHECKER_SIZE * CHECKER_SIZE);
  guint8 data[CHECKER_SIZE * CHECKER_SIZE];
  CheckerCorner c = checker_random (CHECKER_X, rand);
  ClothCornerParams params = cloth_corner_default_params ();
  ClothCornerFit fit;

  checker_render (&c, picture);
  checker_expose (picture, 1, rand, data);
  for (gint cut = 16; cut <= 19; cut++) {
    const ClothImage image = { data + cut * CHECKER_SIZE + cut,
      CHECKER_SIZE - cut, CHECKER_SIZE - cut, CHECKER_SIZE
    };
    g_assert_true (cloth_corner_refine (&image, (gfloat) c.x - (gfloat) cut,
            (gfloat) c.y - (gfloat) cut, &params, CLOTH_SIMD_BEST, &fit));
    g_assert_cmpfloat (hypot (fit.x + cut - c.x, fit.y + cut - c.y), <, 0.1);
  }
}

static void
test_refusals (void)
{
  guint8 data[CHECKER_SIZE * CHECKER_SIZE];
  const ClothImage image = view (data), dot = { data, 1, 1, CHECKER_SIZE };
  const ClothImage small = { data, 3, 3, CHECKER_SIZE };
  ClothCornerParams params = cloth_corner_default_params ();
  g_autoptr (GRand) rand = g_rand_new_with_seed (7);
  g_autofree gfloat *picture = g_new (gfloat, CHECKER_SIZE * CHECKER_SIZE);
  CheckerCorner c = checker_random (CHECKER_X, rand);
  ClothCornerFit fit;

  memset (data, 90, sizeof (data));
  g_assert_false (cloth_corner_refine (&image, 20, 20, &params,
          CLOTH_SIMD_BEST, &fit));
  g_assert_false (cloth_corner_refine (&dot, 0, 0, &params, CLOTH_SIMD_BEST,
          &fit));
  g_assert_false (cloth_corner_refine (&small, 1, 1, &params, CLOTH_SIMD_BEST,
          &fit));

  checker_render (&c, picture);
  checker_expose (picture, 0, rand, data);
  g_assert_true (cloth_corner_refine (&image, 20, 20, &params,
          CLOTH_SIMD_BEST, &fit));
  g_assert_false (cloth_corner_refine (&image, -1, 20, &params,
          CLOTH_SIMD_BEST, &fit));
  g_assert_false (cloth_corner_refine (&image, 20, CHECKER_SIZE, &params,
          CLOTH_SIMD_BEST, &fit));
  g_assert_false (cloth_corner_refine (&image, NAN, 20, &params,
          CLOTH_SIMD_BEST, &fit));
  g_assert_false (cloth_corner_refine (&image, 20, INFINITY, &params,
          CLOTH_SIMD_BEST, &fit));
  /* farther than it may move */
  params.max_shift = 0.3f;
  g_assert_false (cloth_corner_refine (&image, (gfloat) c.x + 1.5f,
          (gfloat) c.y, &params, CLOTH_SIMD_BEST, &fit));
  params = cloth_corner_default_params ();
  params.known_angles = TRUE;
  g_assert_false (cloth_corner_refine (&image, 20, 20, &params,
          CLOTH_SIMD_BEST, &fit));
  params.theta[1] = NAN;
  g_assert_false (cloth_corner_refine (&image, 20, 20, &params,
          CLOTH_SIMD_BEST, &fit));
  /* brought into range */
  params = cloth_corner_default_params ();
  params.radius = NAN;
  params.blur = -1;
  cloth_corner_refine (&image, 20, 20, &params, CLOTH_SIMD_BEST, &fit);
  params.radius = 1e9f;
  params.blur = 1e9f;
  cloth_corner_refine (&image, 20, 20, &params, CLOTH_SIMD_BEST, &fit);
}

/* Texture without any corner: whatever comes is finite. */
static void
test_noise (void)
{
  guint8 data[CHECKER_SIZE * CHECKER_SIZE];
  const ClothImage image = view (data);
  ClothCornerParams params = cloth_corner_default_params ();
  g_autoptr (GRand) rand = g_rand_new_with_seed (8);
  guint found = 0;

  for (guint i = 0; i < sizeof (data); i++)
    data[i] = (guint8) g_rand_int_range (rand, 0, 256);
  for (gint i = 0; i < 500; i++) {
    ClothCornerFit fit;
    gfloat x = (gfloat) g_rand_double_range (rand, 0, CHECKER_SIZE - 1);
    gfloat y = (gfloat) g_rand_double_range (rand, 0, CHECKER_SIZE - 1);

    params.radius = (gfloat) g_rand_double_range (rand, 2, 12);
    if (!cloth_corner_refine (&image, x, y, &params, CLOTH_SIMD_BEST, &fit))
      continue;
    found++;
    g_assert_true (isfinite (fit.x + fit.y + fit.cov[0] + fit.cov[1] +
            fit.cov[2] + fit.blur + fit.contrast + fit.rms));
    g_assert_cmpfloat (fabs (fit.x - x), <=, params.max_shift + 1e-3);
    g_assert_cmpfloat (fit.cov[0] * fit.cov[2] - fit.cov[1] * fit.cov[1], >=,
        0);
  }
  g_test_message ("%u of 500 places of pure noise pass as corners", found);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/corner/exact", test_exact);
  g_test_add_func ("/corner/scatter", test_scatter);
  g_test_add_func ("/corner/levels", test_levels);
  g_test_add_func ("/corner/gamma", test_gamma);
  g_test_add_func ("/corner/border", test_border);
  g_test_add_func ("/corner/refusals", test_refusals);
  g_test_add_func ("/corner/noise", test_noise);
  return g_test_run ();
}
