/* The saddle detector: the mask against floating point, closed forms, scatter, limits.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/corner/saddle.h"

#include "tests/core/checker.h"

static guint8 *
noise_picture (gint stride, gint height, guint32 seed, gint low, gint high)
{
  g_autoptr (GRand) rand = g_rand_new_with_seed (seed);
  guint8 *data = g_malloc ((gsize) (stride * height));

  for (gint i = 0; i < stride * height; i++)
    data[i] = (guint8) g_rand_int_range (rand, low, high);
  return data;
}

/* everything passes but flat places */
static ClothSaddleParams
low_bound (void)
{
  ClothSaddleParams params = cloth_saddle_default_params ();

  params.epsilon = 0.5f;
  params.relative = 0;
  return params;
}

static void
assert_equal_results (ClothSaddleDetector * a, ClothSaddleDetector * b)
{
  guint na, nb;
  const ClothSaddleCandidate *ca =
      cloth_saddle_detector_get_candidates (a, &na);
  const ClothSaddleCandidate *cb =
      cloth_saddle_detector_get_candidates (b, &nb);
  const ClothSaddle *sa, *sb;

  g_assert_cmpmem (ca, na * sizeof (*ca), cb, nb * sizeof (*cb));
  sa = cloth_saddle_detector_get_saddles (a, &na);
  sb = cloth_saddle_detector_get_saddles (b, &nb);
  g_assert_cmpmem (sa, na * sizeof (*sa), sb, nb * sizeof (*sb));
  g_assert_true (cloth_saddle_detector_was_cut (a) ==
      cloth_saddle_detector_was_cut (b));
}

static void
test_levels (void)
{
  static const gint sizes[][3] = {      /* columns, rows, stride */
    {1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {5, 1, 8}, {1, 9, 3}, {7, 64, 7},
    {63, 20, 63}, {64, 21, 64}, {65, 22, 80}, {129, 31, 130}, {323, 50, 336},
    {961, 17, 961}, {2000, 9, 2048}
  };
  static const gfloat sigmas[] = { 0.5f, 0.8f, 1.2f, 1.5f, 2, 2.7f, 3.5f, 5 };
  ClothSimd best = cloth_simd_resolve (CLOTH_SIMD_BEST);
  g_autoptr (ClothSaddleDetector) reference = cloth_saddle_detector_new ();
  g_autoptr (ClothSaddleDetector) tested = cloth_saddle_detector_new ();
  guint pictures = 0;

  for (guint i = 0; i < G_N_ELEMENTS (sizes); i++) {
    /* Half of them with only black and white: the largest sums there are. */
    g_autofree guint8 *data = noise_picture (sizes[i][2], sizes[i][1], i, 0,
        256);
    if (i % 2)
      for (gint k = 0; k < sizes[i][2] * sizes[i][1]; k++)
        data[k] = data[k] < 128 ? 0 : 255;
    for (guint s = 0; s < G_N_ELEMENTS (sigmas); s++) {
      const ClothImage image = { data, sizes[i][0], sizes[i][1], sizes[i][2] };
      ClothSaddleParams params = low_bound ();

      params.sigma = sigmas[s];
      params.refine = s % 2 ? CLOTH_SADDLE_REFINE_MODEL :
          CLOTH_SADDLE_REFINE_STREAM;
      cloth_saddle_detector_run (reference, &params, &image, CLOTH_SIMD_SCALAR);
      for (ClothSimd level = CLOTH_SIMD_AVX2; level <= best; level++) {
        cloth_saddle_detector_run (tested, &params, &image, level);
        assert_equal_results (reference, tested);
        pictures++;
      }
    }
  }
  g_test_message ("%u pictures give the same bytes in all instruction sets",
      pictures);
}

/* Bytes beyond a row's end must not matter. */
static void
test_stride (void)
{
  g_autofree guint8 *packed = noise_picture (101, 60, 1, 40, 200);
  g_autofree guint8 *padded = g_malloc (144 * 60);
  const ClothImage a = { packed, 101, 60, 101 }, b = { padded, 101, 60, 144 };
  g_autoptr (ClothSaddleDetector) first = cloth_saddle_detector_new ();
  g_autoptr (ClothSaddleDetector) second = cloth_saddle_detector_new ();
  ClothSaddleParams params = low_bound ();

  memset (padded, 0xff, 144 * 60);
  for (gint y = 0; y < 60; y++)
    memcpy (padded + 144 * y, packed + 101 * y, 101);
  cloth_saddle_detector_run (first, &params, &a, CLOTH_SIMD_BEST);
  cloth_saddle_detector_run (second, &params, &b, CLOTH_SIMD_BEST);
  assert_equal_results (first, second);
}

/* The determinant by double-precision convolution, for the borders too. */
static void
reference_determinant (const guint8 * data, gint w, gint h, gdouble sigma,
    gint step, gdouble * det)
{
  gint reach = (gint) ceil (5 * sigma);
  g_autofree gdouble *a = g_new (gdouble, w * h);
  g_autofree gdouble *b = g_new (gdouble, w * h);
  gdouble sum = 0;

  for (gint k = -reach; k <= reach; k++)
    sum += exp (-0.5 * k * k / (sigma * sigma));
  for (gint pass = 0; pass < 2; pass++) {
    for (gint y = 0; y < h; y++) {
      for (gint x = 0; x < w; x++) {
        gdouble v = 0;
        for (gint k = -reach; k <= reach; k++) {
          gdouble t = exp (-0.5 * k * k / (sigma * sigma)) / sum;
          v += pass ? t * a[CLAMP (y + k, 0, h - 1) * w + x] :
              t * data[y * w + CLAMP (x + k, 0, w - 1)];
        }
        (pass ? b : a)[y * w + x] = v;
      }
    }
  }
  for (gint y = 0; y < h; y++) {
    for (gint x = 0; x < w; x++) {
      gint x0 = x - step, x1 = x + step, y0 = y - step, y1 = y + step;
      gdouble xx, yy, xy, s2 = step * step;

      det[y * w + x] = 0;
      if (x0 < 0 || y0 < 0 || x1 >= w || y1 >= h)
        continue;
      xx = (b[y * w + x0] + b[y * w + x1] - 2 * b[y * w + x]) / s2;
      yy = (b[y0 * w + x] + b[y1 * w + x] - 2 * b[y * w + x]) / s2;
      xy = (b[y1 * w + x1] - b[y1 * w + x0] - b[y0 * w + x1] + b[y0 * w +
              x0]) / (4 * s2);
      det[y * w + x] = xx * yy - xy * xy;
    }
  }
}

static void
test_reference (void)
{
  static const gfloat sigmas[] = { 0.5f, 1, 1.5f, 2.5f, 5 };
  enum
  { W = 131, H = 90 };
  g_autofree guint8 *data = noise_picture (W, H, 2, 0, 40);
  g_autofree gdouble *det = g_new (gdouble, W * H);
  const ClothImage image = { data, W, H, W };
  g_autoptr (ClothSaddleDetector) detector = cloth_saddle_detector_new ();

  /* squares of 12 px under the noise */
  for (gint y = 0; y < H; y++)
    for (gint x = 0; x < W; x++)
      data[y * W + x] = (guint8) (data[y * W + x] +
          ((x * 7 + y) / 84 + (y * 7 - x + 700) / 84) % 2 * 160 + 20);

  for (guint s = 0; s < G_N_ELEMENTS (sigmas); s++) {
    gint step = sigmas[s] < 2 ? 1 : sigmas[s] < 3.5f ? 2 : 3;
    ClothSaddleParams params = cloth_saddle_default_params ();
    const ClothSaddleCandidate *candidates;
    gdouble largest = 0, worst = 0;
    guint n, expected = 0, missed = 0;
    g_autofree gboolean *found = g_new0 (gboolean, W * H);

    reference_determinant (data, W, H, sigmas[s], step, det);
    for (gint i = 0; i < W * H; i++)
      largest = MAX (largest, -det[i]);
    params.sigma = sigmas[s];
    params.relative = 0;
    params.epsilon = (gfloat) (0.1 * largest);
    cloth_saddle_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
    candidates = cloth_saddle_detector_get_candidates (detector, &n);
    g_assert_cmpuint (n, >, 20);
    for (guint i = 0; i < n; i++) {
      gint at = (gint) candidates[i].y * W + (gint) candidates[i].x;
      found[at] = TRUE;
      worst = MAX (worst, fabs (candidates[i].response + det[at]));
    }
    for (gint i = 0; i < W * H; i++) {
      if (-det[i] > 0.2 * largest) {
        expected++;
        missed += !found[i];
      }
    }
    g_test_message ("sigma %g: %u candidates, response off by at most %.1f%% "
        "of the largest", sigmas[s], n, 100 * worst / largest);
    /* The weights have 7 or 8 bits. */
    g_assert_cmpfloat (worst, <, 0.1 * largest);
    g_assert_cmpuint (expected, >, 10);
    g_assert_cmpuint (missed, ==, 0);
  }
}

/* I = c + a sin (k u) sin (k v) in axes turned by phi: a Gaussian of width sigma turns a
 * into a exp (-k² sigma²); in the middle there is a saddle with Det = -(a k²)², bright
 * along u = v. */
static void
test_closed_form (void)
{
  enum
  { N = 48 };
  g_autoptr (GRand) rand = g_rand_new_with_seed (9);
  g_autoptr (ClothSaddleDetector) detector = cloth_saddle_detector_new ();
  gdouble worst = 0, worst_response = 0, worst_axis = 0;

  for (gint i = 0; i < 40; i++) {
    guint8 data[N * N];
    const ClothImage image = { data, N, N, N };
    ClothSaddleParams params = cloth_saddle_default_params ();
    gdouble x0 = N / 2 + g_rand_double_range (rand, -0.5, 0.5);
    gdouble y0 = N / 2 + g_rand_double_range (rand, -0.5, 0.5);
    gdouble phi = g_rand_double_range (rand, 0, G_PI), turn;
    const gdouble k = 2 * G_PI / 24, smoothed = 100 * exp (-k * k * 2.25);
    const gdouble response = smoothed * smoothed * k * k * k * k;
    const ClothSaddle *saddles, *best = NULL;
    guint n;

    for (gint y = 0; y < N; y++) {
      for (gint x = 0; x < N; x++) {
        gdouble u = (x - x0) * cos (phi) + (y - y0) * sin (phi);
        gdouble v = (y - y0) * cos (phi) - (x - x0) * sin (phi);
        data[y * N + x] =
            (guint8) CLAMP (floor (128 + 100 * sin (k * u) * sin (k * v)), 0,
            255);
      }
    }
    cloth_saddle_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
    saddles = cloth_saddle_detector_get_saddles (detector, &n);
    for (guint j = 0; j < n; j++)
      if (!best || hypot (saddles[j].x - x0, saddles[j].y - y0) <
          hypot (best->x - x0, best->y - y0))
        best = &saddles[j];
    g_assert_nonnull (best);
    worst = MAX (worst, hypot (best->x - x0, best->y - y0));
    worst_response = MAX (worst_response, fabs (best->response / response - 1));
    turn = fabs (best->axis - fmod (phi + G_PI / 4, G_PI));
    worst_axis = MAX (worst_axis, MIN (turn, G_PI - turn));
    g_assert_cmpfloat (best->axis, >=, 0);
    g_assert_cmpfloat (best->axis, <, 3.1415928f);
  }
  g_test_message ("closed-form saddles: place off by %.3f px, response by "
      "%.1f%%, axis by %.4f rad at most", worst, 100 * worst_response,
      worst_axis);
  /* The rounding to whole levels has sigma 0.29. */
  g_assert_cmpfloat (worst, <, 0.03);
  g_assert_cmpfloat (worst_response, <, 0.02);
  g_assert_cmpfloat (worst_axis, <, 0.01);
}

static void
test_nothing_there (void)
{
  enum
  { N = 100 };
  guint8 data[N * N];
  const ClothImage image = { data, N, N, N };
  g_autoptr (ClothSaddleDetector) detector = cloth_saddle_detector_new ();
  ClothSaddleParams params = low_bound ();
  guint n;

  for (gint picture = 0; picture < 5; picture++) {
    for (gint i = 0; i < N * N; i++) {
      gint x = i % N, y = i / N;
      data[i] = (guint8) (picture == 0 ? 0 : picture == 1 ? 255 :
          picture == 2 ? x : picture == 3 ? (x < 50 ? 10 : 240) : y);
    }
    for (gfloat sigma = 0.5f; sigma <= 5; sigma += 0.5f) {
      params.sigma = sigma;
      params.epsilon = 0;
      cloth_saddle_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
      cloth_saddle_detector_get_candidates (detector, &n);
      g_assert_cmpuint (n, ==, 0);
      cloth_saddle_detector_get_saddles (detector, &n);
      g_assert_cmpuint (n, ==, 0);
    }
  }
}

/* The figures of the accuracy table. */
static void
test_scatter (void)
{
  g_autoptr (GRand) rand = g_rand_new_with_seed (10);
  g_autofree gfloat *picture = g_new (gfloat, CHECKER_SIZE * CHECKER_SIZE);
  g_autoptr (ClothSaddleDetector) detector = cloth_saddle_detector_new ();
  CheckerScatter scatter[3] = { {0} };
  guint false_ones = 0;

  for (gint i = 0; i < 40; i++) {
    CheckerCorner c = checker_random (CHECKER_X, rand);

    checker_render (&c, picture);
    for (gint draw = 0; draw < 15; draw++) {
      guint8 data[CHECKER_SIZE * CHECKER_SIZE];
      const ClothImage image = { data, CHECKER_SIZE, CHECKER_SIZE,
        CHECKER_SIZE
      };
      checker_expose (picture, 3, rand, data);
      for (gint mode = CLOTH_SADDLE_REFINE_STREAM;
          mode <= CLOTH_SADDLE_REFINE_MODEL; mode++) {
        ClothSaddleParams params = cloth_saddle_default_params ();
        const ClothSaddle *saddles, *best;
        guint n;

        params.refine = mode;
        cloth_saddle_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
        saddles = best = cloth_saddle_detector_get_saddles (detector, &n);
        g_assert_cmpuint (n, >=, 1);
        false_ones += n - 1;
        for (guint j = 1; j < n; j++)
          if (saddles[j].response > best->response)
            best = &saddles[j];
        checker_scatter_add (&scatter[mode], best->x - c.x, best->y - c.y,
            best->cov);
      }
    }
  }
  for (gint mode = 1; mode < 3; mode++) {
    gdouble sigma = checker_scatter_sigma (&scatter[mode]);
    gdouble claimed = checker_scatter_claimed (&scatter[mode]);

    g_test_message ("synthetic corners, noise 3 grey levels, %s: scatter "
        "%.4f px, claimed %.4f px (%.3f), chi2 %.3f, worst %.3f px",
        mode == 1 ? "stream" : "refined", sigma, claimed, claimed / sigma,
        scatter[mode].chi2 / (2.0 * scatter[mode].n), scatter[mode].worst);
    g_assert_cmpfloat (sigma, <=, mode == 1 ? 0.02 : 0.012);
    g_assert_cmpfloat (claimed / sigma, >, 0.8);
    g_assert_cmpfloat (claimed / sigma, <, 1.2);
  }
  g_test_message ("false saddles: %u in 1200 pictures", false_ones);
  g_assert_cmpuint (false_ones, <, 12);
}

/* A board of 9 by 7 corners: one candidate at each at least, one saddle at each. */
static void
test_board (void)
{
  enum
  { W = 320, H = 260 };
  g_autofree guint8 *data = g_malloc (W * H);
  const ClothImage image = { data, W, H, W };
  g_autoptr (GRand) rand = g_rand_new_with_seed (11);
  g_autoptr (ClothSaddleDetector) detector = cloth_saddle_detector_new ();

  for (gint side = 8; side <= 28; side += 4) {
    const gdouble c = cos (0.3), s = sin (0.3);
    ClothSaddleParams params = cloth_saddle_default_params ();
    const ClothSaddleCandidate *candidates;
    const ClothSaddle *saddles;
    guint n, m, near = 0;

    for (gint y = 0; y < H; y++) {
      for (gint x = 0; x < W; x++) {
        gdouble level = 0;
        for (gint k = 0; k < 16; k++) {
          gdouble px = x + (k % 4 - 1.5) / 4 - W / 2;
          gdouble py = y + (k / 4 - 1.5) / 4 - H / 2;
          gdouble u = (px * c + py * s) / side + 5;
          gdouble v = (py * c - px * s) / side + 4;
          gboolean dark = u >= 0 && v >= 0 && u < 10 && v < 8
              && ((gint) u + (gint) v) % 2 == 0;
          level += dark ? 50 : 190;
        }
        data[y * W + x] = (guint8) CLAMP (level / 16 +
            3 * checker_normal (rand) + 0.5, 0, 255);
      }
    }
    cloth_saddle_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
    candidates = cloth_saddle_detector_get_candidates (detector, &m);
    saddles = cloth_saddle_detector_get_saddles (detector, &n);
    for (gint j = 1; j < 8; j++) {
      for (gint i = 1; i < 10; i++) {
        gdouble x = ((i - 5) * c - (j - 4) * s) * side + W / 2;
        gdouble y = ((i - 5) * s + (j - 4) * c) * side + H / 2;
        guint here = 0;
        gboolean candidate = FALSE;

        if (x < 5 || y < 5 || x > W - 6 || y > H - 6)
          continue;
        for (guint k = 0; k < m; k++)
          candidate |= hypot (candidates[k].x - x, candidates[k].y - y) < 1;
        for (guint k = 0; k < n; k++)
          here += hypot (saddles[k].x - x, saddles[k].y - y) < 1.5;
        g_assert_true (candidate);
        g_assert_cmpuint (here, ==, 1);
        near++;
      }
    }
    g_test_message ("squares of %d px: all of %u corners, %u saddles and %u "
        "candidates in all", side, near, n, m);
    g_assert_cmpuint (n, <=, near + 40);
  }
}

static void
test_region (void)
{
  enum
  { W = 200, H = 150 };
  g_autofree guint8 *data = noise_picture (W, H, 12, 0, 256);
  const ClothImage image = { data, W, H, W };
  g_autoptr (ClothSaddleDetector) whole = cloth_saddle_detector_new ();
  g_autoptr (ClothSaddleDetector) part = cloth_saddle_detector_new ();
  ClothSaddleParams params = low_bound ();
  const ClothSaddleCandidate *a, *b;
  guint na, nb, same = 0;

  params.refine = CLOTH_SADDLE_REFINE_NONE;
  cloth_saddle_detector_run (whole, &params, &image, CLOTH_SIMD_BEST);
  params.roi_x = 37;
  params.roi_y = 21;
  params.roi_width = 101;
  params.roi_height = 55;
  cloth_saddle_detector_run (part, &params, &image, CLOTH_SIMD_BEST);
  a = cloth_saddle_detector_get_candidates (whole, &na);
  b = cloth_saddle_detector_get_candidates (part, &nb);
  g_assert_cmpuint (nb, >, 0);
  for (guint i = 0; i < na; i++) {
    if (a[i].x < 37 || a[i].y < 21 || a[i].x >= 138 || a[i].y >= 76)
      continue;
    g_assert_cmpuint (same, <, nb);
    g_assert_cmpmem (&a[i], sizeof (a[i]), &b[same], sizeof (b[same]));
    same++;
  }
  g_assert_cmpuint (same, ==, nb);
}

static void
test_limits (void)
{
  enum
  { W = 900, H = 700 };
  g_autofree guint8 *data = noise_picture (W, H, 13, 0, 256);
  const ClothImage image = { data, W, H, W };
  g_autoptr (ClothSaddleDetector) detector = cloth_saddle_detector_new ();
  ClothSaddleParams params = low_bound ();
  const ClothSaddleCandidate *candidates, *before;
  gfloat weakest = G_MAXFLOAT;
  guint n;

  cloth_saddle_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
  before = cloth_saddle_detector_get_candidates (detector, &n);
  g_assert_cmpuint (n, <=, CLOTH_SADDLE_MAX);
  g_assert_cmpuint (n, >, CLOTH_SADDLE_MAX / 2);
  g_assert_true (cloth_saddle_detector_was_cut (detector));
  /* the same buffers again */
  cloth_saddle_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
  candidates = cloth_saddle_detector_get_candidates (detector, &n);
  g_assert_true (candidates == before);

  params.max_candidates = 100;
  params.max_saddles = 5;
  cloth_saddle_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
  candidates = cloth_saddle_detector_get_candidates (detector, &n);
  g_assert_cmpuint (n, <=, 100);
  g_assert_cmpuint (n, >, 0);
  g_assert_true (cloth_saddle_detector_was_cut (detector));
  for (guint i = 0; i < n; i++)
    weakest = MIN (weakest, candidates[i].response);
  g_assert_cmpfloat (weakest, >=, cloth_saddle_detector_get_epsilon (detector));
  cloth_saddle_detector_get_saddles (detector, &n);
  g_assert_cmpuint (n, <=, 5);

  params.max_candidates = 0;
  cloth_saddle_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
  cloth_saddle_detector_get_candidates (detector, &n);
  g_assert_cmpuint (n, ==, 0);
}

static void
test_bad_params (void)
{
  g_autofree guint8 *data = noise_picture (64, 64, 14, 0, 256);
  const ClothImage image = { data, 64, 64, 64 };
  g_autoptr (ClothSaddleDetector) detector = cloth_saddle_detector_new ();
  static const gfloat values[] = { -1, 0, 1e30f, -1e30f, NAN, INFINITY,
    -INFINITY
  };
  static const gint places[] = { -5, 0, 63, 64, G_MAXINT, G_MININT };
  guint n;

  for (guint i = 0; i < G_N_ELEMENTS (values); i++) {
    for (guint which = 0; which < 4; which++) {
      ClothSaddleParams params = cloth_saddle_default_params ();
      params.refine = CLOTH_SADDLE_REFINE_MODEL;
      *(which == 0 ? &params.sigma : which == 1 ? &params.epsilon :
          which == 2 ? &params.relative : &params.radius) = values[i];
      cloth_saddle_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
      cloth_saddle_detector_get_candidates (detector, &n);
      g_assert_cmpuint (n, <=, 64 * 64);
    }
  }
  for (guint i = 0; i < G_N_ELEMENTS (places); i++) {
    for (guint j = 0; j < G_N_ELEMENTS (places); j++) {
      ClothSaddleParams params = low_bound ();
      params.roi_x = places[i];
      params.roi_y = places[j];
      params.roi_width = places[j];
      params.roi_height = places[i];
      cloth_saddle_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
      cloth_saddle_detector_get_candidates (detector, &n);
      if (places[i] >= 64 || places[j] >= 64)
        g_assert_cmpuint (n, ==, 0);
    }
  }
  cloth_saddle_detector_free (NULL);
}

static void
test_noise_estimate (void)
{
  enum
  { N = 300 };
  g_autofree guint8 *data = g_malloc (N * N);
  const ClothImage image = { data, N, N, N };
  g_autoptr (ClothSaddleDetector) detector = cloth_saddle_detector_new ();
  ClothSaddleParams params = cloth_saddle_default_params ();

  for (gdouble sigma = 1; sigma <= 8; sigma *= 2) {
    g_autoptr (GRand) rand = g_rand_new_with_seed (15);
    gdouble found, expected = sqrt (sigma * sigma + 1.0 / 12);

    for (gint i = 0; i < N * N; i++)
      data[i] = (guint8) CLAMP (floor (100 + (i % N) * 0.2 +
              sigma * checker_normal (rand) + 0.5), 0, 255);
    cloth_saddle_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
    found = cloth_saddle_detector_get_noise (detector);
    g_test_message ("noise %.1f: found %.3f", sigma, found);
    g_assert_cmpfloat (fabs (found / expected - 1), <, 0.05);
  }
}

/* A clean board over the whole of a large picture: pixels of equal response by the
 * hundred thousand. */
static void
test_many (void)
{
  const gint width = 1920, height = 1080;
  g_autoptr (ClothSaddleDetector) detector = cloth_saddle_detector_new ();
  ClothSaddleParams params = cloth_saddle_default_params ();
  g_autofree guint8 *data = g_malloc (width * height);
  ClothImage image = { data, width, height, width };

  for (gint edge = 6; edge <= 12; edge += 2) {
    guint corners = (guint) ((width / edge - 3) * (height / edge - 3));
    guint n_saddles, n_candidates;

    for (gint y = 0; y < height; y++)
      for (gint x = 0; x < width; x++)
        data[y * width + x] = (x / edge + y / edge) & 1 ? 200 : 40;
    cloth_saddle_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
    cloth_saddle_detector_get_saddles (detector, &n_saddles);
    cloth_saddle_detector_get_candidates (detector, &n_candidates);
    g_test_message ("squares of %d px: %u saddles of %u, %u candidates", edge,
        n_saddles, corners, n_candidates);
    g_assert_cmpuint (n_saddles, >=, corners);
    g_assert_cmpuint (n_candidates, <=, params.max_candidates);
    g_assert_cmpuint (n_candidates, >, 0);
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/saddle/levels", test_levels);
  g_test_add_func ("/saddle/stride", test_stride);
  g_test_add_func ("/saddle/reference", test_reference);
  g_test_add_func ("/saddle/closed-form", test_closed_form);
  g_test_add_func ("/saddle/nothing-there", test_nothing_there);
  g_test_add_func ("/saddle/scatter", test_scatter);
  g_test_add_func ("/saddle/board", test_board);
  g_test_add_func ("/saddle/region", test_region);
  g_test_add_func ("/saddle/limits", test_limits);
  g_test_add_func ("/saddle/bad-params", test_bad_params);
  g_test_add_func ("/saddle/noise-estimate", test_noise_estimate);
  g_test_add_func ("/saddle/many", test_many);
  return g_test_run ();
}
