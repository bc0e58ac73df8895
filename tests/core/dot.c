/* Dot detection against pictures drawn here, whose dots' centres are known exactly.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/dot/dot.h"

#include <math.h>
#include <string.h>

#include "gst/vision/dot/dot-spots.h"

#define SUB 4
/* Width of the edge's blur, px. */
#define BLUR 0.7

/* A picture as light, before noise and rounding. */
typedef struct
{
  gint width, height;
  gdouble *light;
  guint8 *data;
} Canvas;

typedef struct
{
  gdouble x, y, a, b, angle;
} Drawn;

static Canvas *
canvas_new (gint width, gint height, gdouble ground)
{
  Canvas *canvas = g_new (Canvas, 1);

  *canvas = (Canvas) {
  width, height, g_new (gdouble, (gsize) width * (gsize) height),
        g_new (guint8, (gsize) width * (gsize) height)};
  for (gint i = 0; i < width * height; i++)
    canvas->light[i] = ground;
  return canvas;
}

static void
canvas_free (Canvas * canvas)
{
  g_free (canvas->light);
  g_free (canvas->data);
  g_free (canvas);
}

G_DEFINE_AUTOPTR_CLEANUP_FUNC (Canvas, canvas_free);

/* An ellipse with a soft edge, the mean of SUB·SUB points a pixel: it looks the same
 * from both sides of its centre, so that is exact. */
static void
draw (Canvas * canvas, Drawn dot, gdouble contrast)
{
  const gdouble c = cos (dot.angle), s = sin (dot.angle);
  const gdouble reach = MAX (dot.a, dot.b) + 5 * BLUR;

  for (gint y = MAX (0, (gint) floor (dot.y - reach));
      y <= MIN (canvas->height - 1, (gint) ceil (dot.y + reach)); y++) {
    for (gint x = MAX (0, (gint) floor (dot.x - reach));
        x <= MIN (canvas->width - 1, (gint) ceil (dot.x + reach)); x++) {
      gdouble sum = 0;

      for (gint k = 0; k < SUB * SUB; k++) {
        const gdouble dx = x + (k % SUB + 0.5) / SUB - 0.5 - dot.x;
        const gdouble dy = y + (k / SUB + 0.5) / SUB - 0.5 - dot.y;
        const gdouble u = c * dx + s * dy, v = -s * dx + c * dy;
        const gdouble r = hypot (u / dot.a, v / dot.b);
        const gdouble slope = r > 0 ? hypot (u / (dot.a * dot.a),
            v / (dot.b * dot.b)) / r : 1;

        sum += 0.5 * erfc ((r - 1) / slope / (BLUR * G_SQRT2));
      }
      canvas->light[y * canvas->width + x] += contrast * sum / (SUB * SUB);
    }
  }
}

static gdouble
gaussian (GRand * rand)
{
  return sqrt (-2 * log (1 - g_rand_double (rand)))
      * cos (2 * G_PI * g_rand_double (rand));
}

static ClothPlanarImage
expose (Canvas * canvas, gdouble noise, guint32 seed)
{
  g_autoptr (GRand) rand = g_rand_new_with_seed (seed);

  for (gint i = 0; i < canvas->width * canvas->height; i++) {
    const gdouble grey =
        canvas->light[i] + (noise > 0 ? noise * gaussian (rand) : 0);

    canvas->data[i] = (guint8) CLAMP (floor (grey + 0.5), 0, 255);
  }
  return (ClothPlanarImage) {
    {
    canvas->data, canvas->width, canvas->height, canvas->width}
  };
}

static const ClothDot *
nearest (const ClothDot * dots, guint n, gdouble x, gdouble y)
{
  const ClothDot *best = NULL;

  for (guint i = 0; i < n; i++) {
    if (!best || hypot (dots[i].x - x, dots[i].y - y)
        < hypot (best->x - x, best->y - y))
      best = &dots[i];
  }
  return best;
}

typedef struct
{
  guint n;
  gdouble sum, most, chi, noise;
} Score;

/* A lattice of dots of half-axes @a, @b at all sub-pixel places, as many pictures as
 * asked for. */
static Score
score_lattice (gdouble a, gdouble b, gdouble angle, gdouble contrast,
    gdouble noise, guint pictures)
{
  const ClothDotParams params = cloth_dot_default_params ();
  g_autoptr (ClothDotDetector) detector = cloth_dot_detector_new ();
  const gdouble pitch = MAX (a, b) * 2 * 20 / 13;
  g_autoptr (GRand) rand = g_rand_new_with_seed (7);
  Score score = { 0 };

  for (guint k = 0; k < pictures; k++) {
    g_autoptr (Canvas) canvas = canvas_new (301, 303, 20);
    const gint side = (gint) ((300 - 2 * pitch) / pitch);
    g_autofree Drawn *truth = g_new (Drawn, side * side);
    ClothPlanarImage image;
    const ClothDot *dots;
    guint n;

    for (gint i = 0; i < side * side; i++) {
      truth[i] = (Drawn) {
      (i % side + 1.5) * pitch + g_rand_double (rand),
            (i / side + 1.5) * pitch + g_rand_double (rand), a, b, angle};
      draw (canvas, truth[i], contrast);
    }
    image = expose (canvas, noise, k);
    cloth_dot_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
    dots = cloth_dot_detector_get_dots (detector, &n);
    g_assert_cmpuint (n, ==, (guint) (side * side));
    score.noise = cloth_dot_detector_get_noise (detector);
    for (gint i = 0; i < side * side; i++) {
      const ClothDot *dot = nearest (dots, n, truth[i].x, truth[i].y);
      const gdouble dx = dot->x - truth[i].x, dy = dot->y - truth[i].y;
      const gdouble det = dot->cov[0] * dot->cov[2] - dot->cov[1] * dot->cov[1];

      g_assert_false (dot->touches);
      score.sum += dx * dx + dy * dy;
      score.most = MAX (score.most, hypot (dx, dy));
      score.chi += (dx * dx * dot->cov[2] - 2 * dx * dy * dot->cov[1]
          + dy * dy * dot->cov[0]) / det;
      score.n++;
    }
  }
  return score;
}

/* The first bound is the specification's; for discs the others are 1.25 times what the
 * noise allows any method (Cramér–Rao: σ·√(2·BLUR/(√π·radius))/contrast), where noise
 * rules. The covariance is within 20% of the scatter. */
static void
test_accuracy (void)
{
  const struct
  {
    gdouble a, b, angle, contrast, noise, most;
  } cases[] = {
    {6, 6, 0, 100, 3, 0.015}, {6, 3, 0.5, 100, 3, 0.015 * 1.6},
    {3, 3, 0, 100, 3, 0.03}, {10, 10, 0, 60, 3, 0.0175},
    {6, 6, 0, 180, 1.5, 0.006}, {8, 2.5, 2, 100, 2, 0.02},
  };

  for (gsize i = 0; i < G_N_ELEMENTS (cases); i++) {
    const Score score = score_lattice (cases[i].a, cases[i].b, cases[i].angle,
        cases[i].contrast, cases[i].noise, 8);
    const gdouble rms = sqrt (score.sum / (2 * score.n));
    const gdouble ratio = sqrt (score.chi / (2 * score.n));

    g_test_message ("half-axes %g and %g px, contrast %g, noise %g: %u dots, "
        "%.4f px RMS each way, %.3f of its own σ; noise taken for %.2f",
        cases[i].a, cases[i].b, cases[i].contrast, cases[i].noise, score.n,
        rms, ratio, score.noise);
    g_assert_cmpfloat (rms, <=, cases[i].most);
    g_assert_cmpfloat (ratio, >, 0.8);
    g_assert_cmpfloat (ratio, <, 1.2);
  }
}

/* Without noise what is left is the method's own. */
static void
test_bias (void)
{
  const gdouble radii[] = { 2.5, 3, 4, 6, 9, 15 };

  for (gsize i = 0; i < G_N_ELEMENTS (radii); i++) {
    const Score score = score_lattice (radii[i], radii[i], 0, 120, 0, 2);
    const Score oblique = score_lattice (radii[i], MAX (2, radii[i] / 2.5),
        0.7, 120, 0, 2);

    g_test_message ("radius %g px: %.4f px RMS each way, at most %.4f; seen "
        "askew %.4f, %.4f", radii[i], sqrt (score.sum / (2 * score.n)),
        score.most, sqrt (oblique.sum / (2 * oblique.n)), oblique.most);
    g_assert_cmpfloat (score.most, <, radii[i] < 4 ? 0.08 : 0.02);
    g_assert_cmpfloat (oblique.most, <, radii[i] < 4 ? 0.08 : 0.04);
  }
}

/* A fold's shadow over the dots and a bright wall beside them. */
static void
test_shading (void)
{
  const ClothDotParams params = cloth_dot_default_params ();
  g_autoptr (ClothDotDetector) detector = cloth_dot_detector_new ();
  g_autoptr (Canvas) canvas = canvas_new (400, 200, 0);
  ClothPlanarImage image;
  const ClothDot *dots;
  gdouble sum = 0;
  guint n;

  for (gint k = 0; k < 15 * 8; k++)
    draw (canvas, (Drawn) {
        25.3 + k % 15 * 20.1, 25.2 + k / 15 * 20.07, 6, 6, 0}
      , 150);
  /* Black is not quite black. From light to a third of it within 60 px. */
  for (gint y = 0; y < 200; y++) {
    for (gint x = 0; x < 400; x++) {
      gdouble *at = &canvas->light[y * 400 + x];

      *at = (*at + 12) * (1 - 0.65 / (1 + exp (-(x - 150.0) / 12)));
      if (x > 330)
        *at = 210;
    }
  }
  image = expose (canvas, 2, 1);
  cloth_dot_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
  dots = cloth_dot_detector_get_dots (detector, &n);
  g_assert_cmpuint (n, ==, 15 * 8);
  for (gint k = 0; k < 15 * 8; k++) {
    const gdouble x = 25.3 + k % 15 * 20.1, y = 25.2 + k / 15 * 20.07;
    const ClothDot *dot = nearest (dots, n, x, y);

    sum += pow (dot->x - x, 2) + pow (dot->y - y, 2);
    g_assert_cmpfloat (hypot (dot->x - x, dot->y - y), <, 0.3);
  }
  g_test_message ("shaded: %.4f px RMS each way", sqrt (sum / (2 * n)));
  g_assert_cmpfloat (sqrt (sum / (2 * n)), <, 0.08);
}

static void
test_shape_and_colour (void)
{
  const ClothDotParams params = cloth_dot_default_params ();
  g_autoptr (ClothDotDetector) detector = cloth_dot_detector_new ();
  g_autoptr (Canvas) canvas = canvas_new (63, 47, 25);
  guint8 cb[32 * 24], cr[32 * 24], both[2 * 32 * 24];
  ClothPlanarImage image;
  const ClothDot *dots;
  guint n;

  draw (canvas, (Drawn) {
      30.25, 20.5, 10, 5, 0.3}, 130);
  memset (cb, 128, sizeof cb);
  memset (cr, 128, sizeof cr);
  for (gint i = 0; i < 32 * 24; i++) {
    if (i % 32 > 8 && i % 32 < 23) {
      cb[i] = 60;
      cr[i] = 200;
    }
    both[2 * i] = cb[i];
    both[2 * i + 1] = cr[i];
  }
  image = expose (canvas, 0, 0);
  cloth_dot_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
  dots = cloth_dot_detector_get_dots (detector, &n);
  g_assert_cmpuint (n, ==, 1);
  g_assert_cmpfloat_with_epsilon (dots[0].background, 25, 1);
  g_assert_cmpfloat_with_epsilon (dots[0].colour[0], 155, 1);
  g_assert_cmpfloat (dots[0].colour[1], ==, 128);
  g_assert_cmpfloat_with_epsilon (dots[0].area, G_PI * 50, 3);
  /* Quarter squares of the half-axes, turned. */
  g_assert_cmpfloat_with_epsilon (dots[0].shape[0],
      25 * pow (cos (0.3), 2) + 6.25 * pow (sin (0.3), 2), 0.6);
  g_assert_cmpfloat_with_epsilon (dots[0].shape[1],
      18.75 * sin (0.3) * cos (0.3), 0.4);
  g_assert_cmpfloat_with_epsilon (dots[0].shape[2],
      25 * pow (sin (0.3), 2) + 6.25 * pow (cos (0.3), 2), 0.4);
  for (gint nv12 = 0; nv12 < 2; nv12++) {
    image.chroma[0] = nv12 ? both : cb;
    image.chroma[1] = nv12 ? both + 1 : cr;
    image.chroma_step = nv12 ? 2 : 1;
    image.chroma_stride = nv12 ? 64 : 32;
    image.chroma_shift[0] = image.chroma_shift[1] = 1;
    cloth_dot_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
    dots = cloth_dot_detector_get_dots (detector, &n);
    g_assert_cmpuint (n, ==, 1);
    g_assert_cmpfloat (dots[0].colour[1], ==, 60);
    g_assert_cmpfloat (dots[0].colour[2], ==, 200);
  }
}

/* Dots that run into each other are two, or three. */
static void
test_touching (void)
{
  const ClothDotParams params = cloth_dot_default_params ();
  g_autoptr (ClothDotDetector) detector = cloth_dot_detector_new ();

  for (gdouble gap = 1; gap < 4; gap += 0.25) {
    g_autoptr (Canvas) canvas = canvas_new (80, 60, 20);
    const gdouble x[3] = { 20.3, 20.3 + 12 + gap, 20.3 + 24 + 2 * gap };
    ClothPlanarImage image;
    const ClothDot *dots;
    guint n;

    for (gint i = 0; i < 3; i++)
      draw (canvas, (Drawn) {
          x[i], 30.1, 6, 6, 0}
        , i == 1 ? 150 : 90);
    image = expose (canvas, 2, 3);
    cloth_dot_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
    dots = cloth_dot_detector_get_dots (detector, &n);
    g_assert_cmpuint (n, ==, 3);
    for (gint i = 0; i < 3; i++) {
      const ClothDot *dot = nearest (dots, n, x[i], 30.1);

      g_test_message ("gap %g: off by %+.3f, %+.3f%s", gap, dot->x - x[i],
          dot->y - 30.1, dot->touches ? ", cut apart" : "");
      g_assert_cmpfloat (hypot (dot->x - x[i], dot->y - 30.1), <, 0.3);
    }
  }
}

/* A dot is found where it is whole, and nowhere else; odd sizes; no dot is read beyond
 * the picture. */
static void
test_border (void)
{
  const ClothDotParams params = cloth_dot_default_params ();
  g_autoptr (ClothDotDetector) detector = cloth_dot_detector_new ();

  for (gdouble x = -7; x < 44; x += 0.5) {
    g_autoptr (Canvas) canvas = canvas_new (37, 29, 20);
    ClothPlanarImage image;
    const ClothDot *dots;
    guint n;

    draw (canvas, (Drawn) {
        x, 14.2, 5, 5, 0}, 120);
    image = expose (canvas, 0, 0);
    cloth_dot_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
    dots = cloth_dot_detector_get_dots (detector, &n);
    if (x < 5 || x > 31)
      g_assert_cmpuint (n, ==, 0);
    if (x > 7.5 && x < 28.5)
      g_assert_cmpuint (n, ==, 1);
    if (n == 1)
      g_assert_cmpfloat (hypot (dots[0].x - x, dots[0].y - 14.2), <, 0.02);
  }
}

/* Equal bits for all instruction sets, for the sum over all that was drawn too. */
static void
test_levels (void)
{
  const ClothDotParams params = cloth_dot_default_params ();
  g_autoptr (ClothDotDetector) a = cloth_dot_detector_new ();
  g_autoptr (ClothDotDetector) b = cloth_dot_detector_new ();
  g_autoptr (GRand) rand = g_rand_new_with_seed (5);
  guint total = 0;

  for (guint k = 0; k < 60; k++) {
    const gint width = k < 20 ? 1 + (gint) k : g_rand_int_range (rand, 1, 200);
    const gint height = k < 20 ? 20 - (gint) k : g_rand_int_range (rand, 1, 90);
    g_autoptr (Canvas) canvas = canvas_new (width, height, 20);
    ClothPlanarImage image;
    const ClothDot *dots[2];
    guint n[2];

    for (gint i = 0; i < 15; i++)
      draw (canvas, (Drawn) {
          g_rand_double (rand) * width, g_rand_double (rand) * height,
          g_rand_double_range (rand, 2, 9), g_rand_double_range (rand, 2, 9),
          g_rand_double (rand)}
        , g_rand_double_range (rand, 20, 200));
    image = expose (canvas, k % 3 * 4, k);
    /* A copy that ends with its last pixel, for the sanitiser. */
    if (k % 2) {
      g_autofree guint8 *tight =
          g_memdup2 (canvas->data, (gsize) width * (gsize) height);

      image.luma.data = tight;
      cloth_dot_detector_run (a, &params, &image, CLOTH_SIMD_SCALAR);
      cloth_dot_detector_run (b, &params, &image, CLOTH_SIMD_BEST);
    } else {
      cloth_dot_detector_run (a, &params, &image, CLOTH_SIMD_SCALAR);
      cloth_dot_detector_run (b, &params, &image, CLOTH_SIMD_AVX2);
    }
    dots[0] = cloth_dot_detector_get_dots (a, &n[0]);
    dots[1] = cloth_dot_detector_get_dots (b, &n[1]);
    g_assert_cmpmem (dots[0], n[0] * sizeof (ClothDot), dots[1],
        n[1] * sizeof (ClothDot));
    total += n[0];
  }
  g_assert_cmpuint (total, >, 100);
}

/* What is no dot gives none, and nothing crashes. */
static void
test_no_dots (void)
{
  static const gchar *const what[] = { "black", "white", "noise", "stripes",
    "large disc", "small specks", "checkerboard", "ramp", "faint dots", "cross"
  };
  const ClothDotParams params = cloth_dot_default_params ();
  g_autoptr (ClothDotDetector) detector = cloth_dot_detector_new ();

  for (gsize k = 0; k < G_N_ELEMENTS (what); k++) {
    g_autoptr (Canvas) canvas = canvas_new (201, 199, 20);
    ClothPlanarImage image;
    guint n;

    for (gint i = 0; i < 201 * 199; i++) {
      const gint x = i % 201, y = i / 201;
      gdouble *at = &canvas->light[i];

      if (k == 1)
        *at = 255;
      else if (k == 3)
        *at = x / 5 % 2 ? 200 : 20;
      else if (k == 5)
        *at = x % 9 == 0 && y % 9 == 0 ? 200 : 20;
      else if (k == 6)
        *at = (x + y) % 2 ? 200 : 20;
      else if (k == 7)
        *at = x;
      else if (k == 9)
        *at = ABS (x - 100) < 2 || ABS (y - 100) < 2 ? 200 : 20;
    }
    if (k == 4)
      draw (canvas, (Drawn) {
          100, 100, 40, 40, 0}
        , 150);
    for (gint i = 0; k == 8 && i < 9; i++)
      draw (canvas, (Drawn) {
          20 + 18 * i, 100, 6, 6, 0}
        , 12);
    image = expose (canvas, k == 2 ? 5 : 0, 1);
    cloth_dot_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
    cloth_dot_detector_get_dots (detector, &n);
    g_test_message ("%s: %u", what[k], n);
    g_assert_cmpuint (n, ==, 0);
    g_assert_cmpfloat (cloth_dot_detector_get_noise (detector), ==, 0);
    g_assert_false (cloth_dot_detector_was_cut (detector));
  }
}

/* Parameters out of range are brought into it. */
static void
test_wild_parameters (void)
{
  const gfloat wild[] = { NAN, -INFINITY, INFINITY, 0, -1, 1e30f };
  g_autoptr (ClothDotDetector) detector = cloth_dot_detector_new ();
  g_autoptr (Canvas) canvas = canvas_new (120, 60, 20);
  ClothPlanarImage image;

  for (gint i = 0; i < 5; i++)
    draw (canvas, (Drawn) {
        15 + 20 * i, 30, 6, 6, 0}
      , 150);
  image = expose (canvas, 5, 1);
  for (gsize i = 0; i < G_N_ELEMENTS (wild); i++) {
    for (gint k = 0; k < 5; k++) {
      ClothDotParams params = cloth_dot_default_params ();
      guint n;

      if (k == 0)
        params.contrast = wild[i];
      else if (k == 1)
        params.share = wild[i];
      else if (k == 2)
        params.min_area = wild[i];
      else if (k == 3)
        params.max_diameter = i % 2 ? G_MININT : G_MAXINT;
      else
        params.roundness = wild[i];
      cloth_dot_detector_run (detector, &params, &image, CLOTH_SIMD_BEST);
      cloth_dot_detector_get_dots (detector, &n);
      g_assert_cmpuint (n, <=, 60);
    }
  }
}

/* Spots and their moments against a flood fill, on random bitmaps. */
static void
test_spots (void)
{
  g_autoptr (GRand) rand = g_rand_new_with_seed (3);
  g_autoptr (GArray) runs = g_array_new (FALSE, FALSE, sizeof (ClothDotRun));
  g_autoptr (GArray) spots = g_array_new (FALSE, FALSE, sizeof (ClothDotSpot));

  for (gint round = 0; round < 200; round++) {
    enum
    { W = 48, H = 20 };
    gboolean on[H][W];
    guint n_seen = 0;

    g_array_set_size (runs, 0);
    g_array_set_size (spots, 0);
    for (gint y = 0; y < H; y++) {
      guint16 bits[W / 16] = { 0 };

      for (gint x = 0; x < W; x++) {
        on[y][x] = g_rand_int_range (rand, 0, 200) < round;
        bits[x / 16] |= (guint16) (on[y][x] << (x % 16));
      }
      cloth_dot_runs_of_bits (runs, bits, W / 16, y);
    }
    cloth_dot_spots (runs, 0, spots);
    for (gint at = 0; at < W * H; at++) {
      gint stack[4 * W * H], top = 0;
      gint64 n = 0, sx = 0, sxy = 0, syy = 0, of_runs = 0;
      const ClothDotSpot *spot;

      if (!on[at / W][at % W])
        continue;
      stack[top++] = at;
      while (top > 0) {
        const gint p = stack[--top], x = p % W, y = p / W;

        if (!on[y][x])
          continue;
        on[y][x] = FALSE;
        n++;
        sx += x - at % W;
        sxy += (x - at % W) * (y - at / W);
        syy += (y - at / W) * (y - at / W);
        if (x > 0)
          stack[top++] = p - 1;
        if (x < W - 1)
          stack[top++] = p + 1;
        if (y > 0)
          stack[top++] = p - W;
        if (y < H - 1)
          stack[top++] = p + W;
      }
      /* In the order of their first pixels, as they are met here. */
      g_assert_cmpuint (n_seen, <, spots->len);
      spot = &g_array_index (spots, ClothDotSpot, n_seen++);
      g_assert_cmpint (spot->n, ==, n);
      g_assert_cmpint (spot->sx, ==, sx);
      g_assert_cmpint (spot->sxy, ==, sxy);
      g_assert_cmpint (spot->syy, ==, syy);
      for (gint32 k = spot->first; k >= 0;) {
        const ClothDotRun *run = &g_array_index (runs, ClothDotRun, k);

        of_runs += run->end - run->start;
        k = run->next;
      }
      g_assert_cmpint (of_runs, ==, n);
    }
    g_assert_cmpuint (n_seen, ==, spots->len);
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/dot/accuracy", test_accuracy);
  g_test_add_func ("/dot/bias", test_bias);
  g_test_add_func ("/dot/shading", test_shading);
  g_test_add_func ("/dot/shape-and-colour", test_shape_and_colour);
  g_test_add_func ("/dot/touching", test_touching);
  g_test_add_func ("/dot/border", test_border);
  g_test_add_func ("/dot/levels", test_levels);
  g_test_add_func ("/dot/no-dots", test_no_dots);
  g_test_add_func ("/dot/wild-parameters", test_wild_parameters);
  g_test_add_func ("/dot/spots", test_spots);
  return g_test_run ();
}
