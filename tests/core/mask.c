/* The silhouette before a known background: scenes whose truth is drawn, with shadows, noise
 * and none; runs, pieces and erosion against searches pixel by pixel.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/mask/mask.h"

#include <math.h>
#include <string.h>

#include "gst/math/random.h"
#include "gst/vision/mask/bits.h"

/* ---- bits and runs ---- */

static gint
n_words (gint width)
{
  return (width + 63) / 64;
}

static guint8 *
random_mask (gint width, gint height, guint percent, guint64 seed)
{
  guint8 *mask = g_malloc0 (width * height + 8);
  ClothRandom random;

  cloth_random_init (&random, seed);
  for (gint i = 0; i < width * height; i++)
    mask[i] = cloth_random_below (&random, 100) < percent;
  return mask;
}

static guint64 *
to_bits (const guint8 * mask, gint width, gint height)
{
  guint64 *bits = g_new0 (guint64, n_words (width) * height);

  for (gint y = 0; y < height; y++) {
    g_autofree guint8 *row = g_malloc (width + 8);

    memset (row, 0xff, width + 8);
    memcpy (row, mask + y * width, width);
    cloth_bits_pack (row, width, bits + y * n_words (width));
  }
  return bits;
}

static gboolean
is_set (const guint64 * bits, gint width, gint x, gint y)
{
  return bits[y * n_words (width) + x / 64] >> x % 64 & 1;
}

/* Whether all pixels of the square about a place are @what, as far as they are in the
 * picture. */
static gboolean
is_all (const guint8 * mask, gint width, gint height, gint x, gint y,
    gint radius, guint8 what)
{
  for (gint v = MAX (y - radius, 0); v <= MIN (y + radius, height - 1); v++)
    for (gint u = MAX (x - radius, 0); u <= MIN (x + radius, width - 1); u++)
      if (mask[v * width + u] != what)
        return FALSE;
  return TRUE;
}

static const gint sizes[][2] = { {1, 1}, {1, 9}, {7, 1}, {63, 11}, {64, 12},
{65, 13}, {130, 40}, {192, 31}
};

static void
test_bits (void)
{
  for (guint i = 0; i < G_N_ELEMENTS (sizes); i++)
    for (gint radius = 0; radius < 4; radius++) {
      const gint width = sizes[i][0], height = sizes[i][1];
      g_autofree guint8 *mask = random_mask (width, height, 93, i);
      g_autofree guint8 *eroded = g_malloc (width * height);
      g_autofree guint64 *bits = to_bits (mask, width, height);
      g_autofree guint64 *open = to_bits (mask, width, height);
      g_autofree guint64 *spare = g_new (guint64, n_words (width) * height);

      cloth_bits_erode (bits, spare, width, height, radius);
      cloth_bits_open (open, spare, width, height, radius);
      for (gint y = 0; y < height; y++)
        for (gint x = 0; x < width; x++) {
          eroded[y * width + x] = is_all (mask, width, height, x, y, radius, 1);
          g_assert_cmpint (is_set (bits, width, x, y), ==,
              eroded[y * width + x]);
        }
      for (gint y = 0; y < height; y++) {
        for (gint x = 0; x < width; x++)
          g_assert_cmpint (is_set (open, width, x, y), ==, !is_all (eroded,
                  width, height, x, y, radius, 0));
        for (gint x = width; x < 64 * n_words (width); x++)
          g_assert_false (is_set (open, width, x, y)
              || is_set (bits, width, x, y));
      }
    }
}

static guint8 *
paint (const ClothRun * runs, guint n, gint width, gint height)
{
  guint8 *mask = g_malloc0 (width * height);

  for (guint i = 0; i < n; i++) {
    g_assert_cmpint (runs[i].row, <, height);
    g_assert_cmpint (runs[i].begin, <, runs[i].end);
    g_assert_cmpint (runs[i].end, <=, width);
    if (i > 0 && runs[i].row == runs[i - 1].row)
      g_assert_cmpint (runs[i].begin, >, runs[i - 1].end);
    else if (i > 0)
      g_assert_cmpint (runs[i].row, >, runs[i - 1].row);
    memset (mask + runs[i].row * width + runs[i].begin, 1,
        runs[i].end - runs[i].begin);
  }
  return mask;
}

/* The pixels of the piece of @what about a place become @mark. Returns: how many; negative
 * when it touches the border. */
static gint
flood (guint8 * mask, gint width, gint height, gint start, guint8 what,
    guint8 mark, gboolean diagonal)
{
  g_autoptr (GArray) stack = g_array_new (FALSE, FALSE, sizeof (gint));
  gboolean border = FALSE;
  gint n = 0;

  mask[start] = mark;
  g_array_append_val (stack, start);
  while (stack->len > 0) {
    const gint at = g_array_index (stack, gint, stack->len - 1);
    const gint x = at % width, y = at / width;

    g_array_set_size (stack, stack->len - 1);
    n++;
    border |= x == 0 || y == 0 || x == width - 1 || y == height - 1;
    for (gint k = 0; k < 9; k++) {
      const gint u = x + k % 3 - 1, v = y + k / 3 - 1, to = v * width + u;

      if (u < 0 || v < 0 || u >= width || v >= height || mask[to] != what
          || (k % 2 == 0 && !diagonal))
        continue;
      mask[to] = mark;
      g_array_append_val (stack, to);
    }
  }
  return border ? -n : n;
}

static void
replace (guint8 * mask, gint n, guint8 what, guint8 by)
{
  for (gint i = 0; i < n; i++)
    if (mask[i] == what)
      mask[i] = by;
}

static void
test_pieces (void)
{
  const guint least = 9, most = 5;

  for (guint i = 0; i < G_N_ELEMENTS (sizes); i++)
    for (guint percent = 0; percent <= 100; percent += 20) {
      const gint width = sizes[i][0], height = sizes[i][1], n = width * height;
      g_autofree guint8 *truth = random_mask (width, height, percent, i + 50);
      g_autofree guint64 *bits = to_bits (truth, width, height);
      g_autoptr (GArray) runs = g_array_new (FALSE, FALSE, sizeof (ClothRun));
      g_autoptr (GArray) gaps = g_array_new (FALSE, FALSE, sizeof (ClothRun));
      g_autoptr (GArray) pieces = cloth_runs_new_pieces ();
      g_autofree guint8 *all = NULL, *found = NULL, *other = NULL;

      g_assert_true (cloth_runs_of_bits (runs, bits, width, height));
      all = paint ((ClothRun *) runs->data, runs->len, width, height);
      g_assert_cmpmem (all, n, truth, n);
      cloth_runs_complement (runs, gaps, width, height);
      other = paint ((ClothRun *) gaps->data, gaps->len, width, height);
      for (gint k = 0; k < n; k++)
        g_assert_cmpint (other[k], ==, !truth[k]);

      for (gint k = 0; k < n; k++)
        if (truth[k] == 1) {
          const gint size = flood (truth, width, height, k, 1, 2, TRUE);

          replace (truth, n, 2, ABS (size) >= (gint) least ? 3 : 0);
        }
      replace (truth, n, 3, 1);
      for (gint k = 0; k < n; k++)
        if (truth[k] == 0) {
          const gint size = flood (truth, width, height, k, 0, 2, FALSE);

          replace (truth, n, 2, size > 0 && size <= (gint) most ? 1 : 4);
        }
      replace (truth, n, 4, 0);
      cloth_runs_drop (runs, pieces, least);
      cloth_runs_fill (runs, gaps, pieces, most, width, height);
      found = paint ((ClothRun *) runs->data, runs->len, width, height);
      g_assert_cmpmem (found, n, truth, n);
    }
}

/* More runs than can be kept. */
static void
test_runs_cut (void)
{
  const gint width = 16384, height = 140;
  g_autofree guint64 *bits = g_new (guint64, width / 64 * height);
  g_autoptr (GArray) runs = g_array_new (FALSE, FALSE, sizeof (ClothRun));

  memset (bits, 0x55, (gsize) width / 8 * height);
  g_assert_false (cloth_runs_of_bits (runs, bits, width, height));
  g_assert_cmpuint (runs->len, ==, CLOTH_RUNS_MAX);
}

/* ---- scenes ---- */

#define WIDTH 333
#define HEIGHT 251
#define STRIDE 352
#define CHROMA_WIDTH ((WIDTH + 1) / 2)
#define CHROMA_HEIGHT ((HEIGHT + 1) / 2)

/* @noise: standard deviation, grey levels
 * @cloth: contrast of its print, grey levels; negative: there is none
 * @tint: of the cloth's chroma
 * @texture: contrast of the background
 * @shadow: light of the background's left third
 * @x: where the cloth's middle is
 */
typedef struct
{
  gdouble noise, cloth, tint, texture, shadow, x;
  guint64 seed;
} Scene;

/* A picture that owns its pixels, in planes or, as NV12 has it, with mixed chroma. */
typedef struct
{
  ClothPlanarImage view;
  guint8 *data;
} Picture;

static void
picture_free (Picture * picture)
{
  g_free (picture->data);
  g_free (picture);
}

G_DEFINE_AUTOPTR_CLEANUP_FUNC (Picture, picture_free);

/* An ellipse that is longer than wide. */
static gboolean
is_cloth (const Scene * scene, gdouble x, gdouble y)
{
  const gdouble dx = (x - scene->x) / 60, dy = (y - 120) / 80;

  return scene->cloth >= 0 && dx * dx + dy * dy < 1;
}

static gdouble
light (const Scene * scene, gint x, gint y)
{
  const gdouble ground = 110 + 0.1 * x + scene->texture *
      sin (0.31 * x + 0.2 * y) * cos (0.17 * x - 0.4 * y);

  if (is_cloth (scene, x, y))
    return 90 + scene->cloth * (((x / 2) ^ (y / 2)) & 1) + 0.2 * y;
  return ground * (x < WIDTH / 3 ? scene->shadow : 1);
}

static guint8
grey (gdouble value)
{
  return (guint8) CLAMP (value + 0.5, 0, 255);
}

/* What lies beyond the rows is as bright as can be. */
static Picture *
draw (const Scene * scene, gint step)
{
  Picture *picture = g_new0 (Picture, 1);
  guint8 *chroma;
  ClothRandom random;

  cloth_random_init (&random, scene->seed);
  picture->data = g_malloc (STRIDE * (HEIGHT + 2 * CHROMA_HEIGHT));
  memset (picture->data, 255, STRIDE * (HEIGHT + 2 * CHROMA_HEIGHT));
  for (gint y = 0; y < HEIGHT; y++)
    for (gint x = 0; x < WIDTH; x++)
      picture->data[y * STRIDE + x] = grey (light (scene, x, y) +
          scene->noise * cloth_random_gaussian (&random));
  chroma = picture->data + STRIDE * HEIGHT;
  picture->view = (ClothPlanarImage) { {
  picture->data, WIDTH, HEIGHT, STRIDE}
  , {
  chroma, chroma + (step == 2 ? 1 : STRIDE * CHROMA_HEIGHT)}
  , STRIDE, step, {
  1, 1}
  };
  for (gint y = 0; y < CHROMA_HEIGHT; y++)
    for (gint x = 0; x < CHROMA_WIDTH; x++)
      for (gint c = 0; c < 2; c++) {
        gdouble value = 6 - 12 * c;

        if (is_cloth (scene, 2 * x + 0.5, 2 * y + 0.5))
          value = value * 0.9 + scene->tint;
        else if (2 * x < WIDTH / 3)
          value *= scene->shadow;
        chroma[y * STRIDE + x * step + c * (step == 2 ? 1 :
                STRIDE * CHROMA_HEIGHT)] = grey (128 + value +
            0.5 * scene->noise * cloth_random_gaussian (&random));
      }
  return picture;
}

/* A ring of 2 px about the cloth, as a share of it. */
#define EDGE 0.04

static const Scene empty = { 0, -1, 0, 10, 1, 0, 1 };
static const Scene usual = { 1.5, 60, 0, 10, 0.6, 170, 2 };

/* Pixels that are cloth and are not found, and the other way round, as shares of the
 * cloth. */
typedef struct
{
  gdouble missed, wrong;
} Errors;

static Errors
compare (const Scene * scene, const ClothMask * mask)
{
  guint n_runs, n = 0, n_missed = 0, n_wrong = 0;
  const ClothRun *runs = cloth_mask_get_runs (mask, &n_runs);
  g_autofree guint8 *found = paint (runs, n_runs, WIDTH, HEIGHT);

  for (gint y = 0; y < HEIGHT; y++)
    for (gint x = 0; x < WIDTH; x++) {
      const gboolean cloth = is_cloth (scene, x, y);

      n += cloth;
      n_missed += cloth && !found[y * WIDTH + x];
      n_wrong += !cloth && found[y * WIDTH + x];
    }
  n = MAX (n, 1);
  g_test_message ("%u runs, %.2f%% missed, %.2f%% wrong", n_runs,
      100. * n_missed / n, 100. * n_wrong / n);
  return (Errors) {
  (gdouble) n_missed / n, (gdouble) n_wrong / n};
}

static Errors
run (const Scene * ground, const Scene * scene, const ClothMaskParams * params)
{
  const ClothMaskParams usual_params = cloth_mask_default_params ();
  g_autoptr (ClothMask) mask = cloth_mask_new ();
  g_autoptr (Picture) background = draw (ground, 1);
  g_autoptr (Picture) film = draw (scene, 1);

  cloth_mask_set_background (mask, &background->view);
  g_assert_true (cloth_mask_has_background (mask, &film->view));
  cloth_mask_run (mask, params ? params : &usual_params, &film->view, NULL,
      CLOTH_SIMD_BEST);
  g_assert_false (cloth_mask_was_cut (mask));
  return compare (scene, mask);
}

/* Shadow or glow, noise or none, in either picture. */
static void
test_scenes (void)
{
  static const gdouble noises[] = { 0, 0.5, 1.5, 4 };
  static const gdouble shadows[] = { 1, 0.45, 1.12 };

  for (guint i = 0; i < G_N_ELEMENTS (noises); i++)
    for (guint j = 0; j < G_N_ELEMENTS (shadows); j++) {
      Scene ground = empty, scene = usual;
      Errors errors;

      ground.noise = scene.noise = noises[i];
      scene.shadow = shadows[j];
      g_test_message ("noise %g, light %g", noises[i], shadows[j]);
      errors = run (&ground, &scene, NULL);
      g_assert_cmpfloat (errors.missed, <, EDGE);
      g_assert_cmpfloat (errors.wrong, <, EDGE);

      scene.cloth = -1;
      errors = run (&ground, &scene, NULL);
      g_assert_cmpfloat (errors.wrong, ==, 0);
    }
}

/* What coding does to a background's chroma. */
static void
shift_chroma (Picture * picture, gint cb, gint cr)
{
  guint8 *chroma = picture->data + STRIDE * HEIGHT;

  for (gint i = 0; i < STRIDE * CHROMA_HEIGHT; i++) {
    chroma[i] = (guint8) (chroma[i] + cb);
    chroma[STRIDE * CHROMA_HEIGHT + i] =
        (guint8) (chroma[STRIDE * CHROMA_HEIGHT + i] + cr);
  }
}

static Errors
run_coded (const Scene * ground, const Scene * scene, gint cb, gint cr)
{
  const ClothMaskParams params = cloth_mask_default_params ();
  g_autoptr (ClothMask) mask = cloth_mask_new ();
  g_autoptr (Picture) background = draw (ground, 1);
  g_autoptr (Picture) film = draw (scene, 1);

  shift_chroma (background, cb, cr);
  cloth_mask_set_background (mask, &background->view);
  cloth_mask_run (mask, &params, &film->view, NULL, CLOTH_SIMD_BEST);
  return compare (scene, mask);
}

/* A background that has lost its noise, and whose colour is off, of a film that has both. */
static void
test_coded (void)
{
  /* of the film and of the background */
  static const gdouble noises[][2] = { {0.3, 0}, {1, 0}, {1.5, 0.5}, {4, 1.3} };
  static const gint shifts[][2] = { {0, 0}, {3, 0}, {-2, 3}, {-3, -3} };
  Scene ground = empty, plain = { 1, 0, 10, 0, 1, 170, 3 };

  ground.texture = 0;
  for (guint i = 0; i < G_N_ELEMENTS (noises); i++)
    for (guint j = 0; j < G_N_ELEMENTS (shifts); j++) {
      Scene scene = usual;
      Errors errors;

      scene.texture = 0;
      scene.noise = noises[i][0];
      ground.noise = noises[i][1];
      g_test_message ("noise %g, %g, colour off by %d, %d", noises[i][0],
          noises[i][1], shifts[j][0], shifts[j][1]);
      errors = run_coded (&ground, &scene, shifts[j][0], shifts[j][1]);
      g_assert_cmpfloat (errors.missed, <, EDGE);
      g_assert_cmpfloat (errors.wrong, <, EDGE);

      scene.cloth = -1;
      errors = run_coded (&ground, &scene, shifts[j][0], shifts[j][1]);
      g_assert_cmpfloat (errors.wrong, ==, 0);

      /* a cloth that its colour alone tells: that is not taken for an error of the ground */
      if (ground.noise > plain.noise)
        continue;
      errors = run_coded (&ground, &plain, shifts[j][0], shifts[j][1]);
      g_assert_cmpfloat (errors.missed, <, EDGE);
      g_assert_cmpfloat (errors.wrong, <, EDGE);
    }
}

/* Light beyond the bounds is something else. */
static void
test_bounds (void)
{
  Scene scene = usual;
  ClothMaskParams params = cloth_mask_default_params ();

  scene.cloth = -1;
  scene.shadow = 0.3;
  g_assert_cmpfloat (run (&empty, &scene, NULL).wrong, >, 0.9);
  params.shadow = 0.25;
  g_assert_cmpfloat (run (&empty, &scene, &params).wrong, ==, 0);
  scene.shadow = 1.3;
  g_assert_cmpfloat (run (&empty, &scene, NULL).wrong, >, 0.9);
  params.glow = 1.4;
  g_assert_cmpfloat (run (&empty, &scene, &params).wrong, ==, 0);
}

/* A plain cloth before a plain wall is like a shadow on it, but for its colour or a range of
 * luma that the wall has not. */
static void
test_plain (void)
{
  Scene ground = empty, scene = { 0, 0, 0, 0, 1, 170, 3 };
  ClothMaskParams params = cloth_mask_default_params ();

  ground.texture = 0;
  g_assert_cmpfloat (run (&ground, &scene, NULL).missed, >, 0.5);
  scene.tint = 10;
  g_assert_cmpfloat (run (&ground, &scene, NULL).missed, <, EDGE);
  scene.noise = ground.noise = 1;
  g_assert_cmpfloat (run (&ground, &scene, NULL).missed, <, EDGE);
  params.significance = 1000;
  g_assert_cmpfloat (run (&ground, &scene, &params).missed, >, 0.5);
}

/* Without a background the ranges are all there is. */
static void
test_ranges (void)
{
  Scene scene = { 0, 0, 40, 0, 1, 170, 4 };
  g_autoptr (ClothMask) mask = cloth_mask_new ();
  g_autoptr (Picture) film = draw (&scene, 1);
  g_autoptr (Picture) mixed = draw (&scene, 2);
  ClothPlanarImage plain = film->view;
  ClothMaskParams params = cloth_mask_default_params ();
  const ClothRun *runs;
  Errors errors;
  guint n;

  g_assert_false (cloth_mask_has_background (mask, &film->view));
  cloth_mask_run (mask, &params, &film->view, NULL, CLOTH_SIMD_BEST);
  runs = cloth_mask_get_runs (mask, &n);
  g_assert_cmpuint (n, ==, HEIGHT);
  g_assert_cmpuint (runs[7].begin, ==, 0);
  g_assert_cmpuint (runs[7].end, ==, WIDTH);

  params.low[1] = 150;
  for (gint k = 0; k < 2; k++) {
    cloth_mask_run (mask, &params, k ? &mixed->view : &film->view, NULL,
        CLOTH_SIMD_BEST);
    errors = compare (&scene, mask);
    g_assert_cmpfloat (errors.missed, <, EDGE);
    g_assert_cmpfloat (errors.wrong, <, EDGE);
  }
  params.high[2] = 150;
  cloth_mask_run (mask, &params, &film->view, NULL, CLOTH_SIMD_BEST);
  g_assert_cmpfloat (compare (&scene, mask).missed, ==, 1);
  params.high[2] = 255;
  params.low[0] = 200;
  params.high[0] = 100;
  cloth_mask_run (mask, &params, &film->view, NULL, CLOTH_SIMD_BEST);
  g_assert_cmpfloat (compare (&scene, mask).missed, ==, 1);

  /* grey pictures have no chroma to be out of its range */
  plain.chroma[0] = plain.chroma[1] = NULL;
  params.low[0] = 90;
  params.high[0] = 255;
  cloth_mask_run (mask, &params, &plain, NULL, CLOTH_SIMD_BEST);
  g_assert_cmpfloat (compare (&scene, mask).missed, ==, 0);
}

static void
assert_same (ClothMask * mask, ClothMask * other)
{
  guint a, b;
  const ClothRun *runs = cloth_mask_get_runs (mask, &a);
  const ClothRun *others = cloth_mask_get_runs (other, &b);

  g_assert_cmpuint (a, >, 100);
  g_assert_cmpmem (runs, a * sizeof (ClothRun), others, b * sizeof (ClothRun));
}

/* Nothing but the picture matters: neither instructions nor threads, nor how its chroma
 * lies, nor what the mask has seen before. */
static void
test_same (void)
{
  const ClothSimd levels[] = { CLOTH_SIMD_SCALAR, CLOTH_SIMD_AVX2,
    CLOTH_SIMD_AVX512
  };
  Scene far = usual;
  g_autoptr (ClothMask) mask = cloth_mask_new ();
  g_autoptr (ClothMask) other = cloth_mask_new ();
  g_autoptr (Picture) background = draw (&empty, 1);
  g_autoptr (Picture) film = draw (&usual, 1);
  g_autoptr (Picture) mixed = draw (&usual, 2);
  g_autoptr (Picture) before = NULL;
  ClothMaskParams params = cloth_mask_default_params ();

  far.x = 60;
  before = draw (&far, 1);
  for (params.radius = 1; params.radius <= 7; params.radius += 2) {
    cloth_mask_set_background (mask, &background->view);
    cloth_mask_run (mask, &params, &film->view, NULL, CLOTH_SIMD_SCALAR);
    cloth_mask_set_background (other, &before->view);
    cloth_mask_set_background (other, &background->view);
    for (guint l = 0; l < G_N_ELEMENTS (levels); l++)
      for (guint threads = 1; threads < 4; threads++) {
        g_autoptr (ClothPool) pool = cloth_pool_new (threads);

        cloth_mask_run (other, &params, &before->view, pool, levels[l]);
        cloth_mask_run (other, &params, threads & 1 ? &film->view :
            &mixed->view, pool, levels[l]);
        assert_same (mask, other);
      }
  }
}

/* A cloth that moves through the picture is not in the median of its places. */
static void
test_learn (void)
{
  const ClothSimd levels[] = { CLOTH_SIMD_SCALAR, CLOTH_SIMD_BEST };

  for (guint l = 0; l < G_N_ELEMENTS (levels); l++) {
    g_autoptr (ClothMask) mask = cloth_mask_new ();
    const ClothMaskParams params = cloth_mask_default_params ();
    Scene scene = usual;
    g_autoptr (Picture) film = NULL;
    Errors errors;

    scene.shadow = 1;
    for (guint i = 0; i < 20; i++) {
      g_autoptr (Picture) picture = NULL;

      scene.x = 40 + 130 * (i % 3);
      scene.seed = i;
      picture = draw (&scene, 1);
      cloth_mask_learn (mask, &picture->view, levels[l]);
    }
    scene.x = 100;
    film = draw (&scene, 1);
    cloth_mask_run (mask, &params, &film->view, NULL, levels[l]);
    errors = compare (&scene, mask);
    g_assert_cmpfloat (errors.missed, <, EDGE);
    g_assert_cmpfloat (errors.wrong, <, EDGE);

    cloth_mask_forget (mask);
    g_assert_false (cloth_mask_has_background (mask, &film->view));
  }
}

/* Of one picture and of two the background is the first, byte by byte the lower. */
static void
test_learn_few (void)
{
  g_autoptr (ClothMask) mask = cloth_mask_new ();
  const ClothMaskParams params = cloth_mask_default_params ();
  g_autoptr (Picture) ground = draw (&empty, 1);
  g_autoptr (Picture) film = draw (&usual, 1);
  guint n;

  cloth_mask_learn (mask, &film->view, CLOTH_SIMD_BEST);
  cloth_mask_run (mask, &params, &film->view, NULL, CLOTH_SIMD_BEST);
  cloth_mask_get_runs (mask, &n);
  g_assert_cmpuint (n, ==, 0);
  cloth_mask_learn (mask, &film->view, CLOTH_SIMD_BEST);
  cloth_mask_learn (mask, &ground->view, CLOTH_SIMD_BEST);
  cloth_mask_run (mask, &params, &film->view, NULL, CLOTH_SIMD_BEST);
  cloth_mask_get_runs (mask, &n);
  g_assert_cmpuint (n, ==, 0);
}

/* ---- what can't be ---- */

static void
test_parameters (void)
{
  g_autoptr (ClothMask) mask = cloth_mask_new ();
  g_autoptr (ClothMask) other = cloth_mask_new ();
  g_autoptr (Picture) background = draw (&empty, 1);
  g_autoptr (Picture) film = draw (&usual, 1);
  ClothMaskParams least = cloth_mask_default_params (), bad = least;

  cloth_mask_set_background (mask, &background->view);
  cloth_mask_set_background (other, &background->view);
  least.radius = 1;
  least.shadow = 0;
  least.glow = 1;
  least.significance = 0;
  least.thin = 0;
  bad.radius = -5;
  bad.shadow = bad.glow = bad.significance = NAN;
  bad.thin = -1;
  cloth_mask_run (mask, &least, &film->view, NULL, CLOTH_SIMD_BEST);
  cloth_mask_run (other, &bad, &film->view, NULL, CLOTH_SIMD_BEST);
  assert_same (mask, other);

  least = bad = cloth_mask_default_params ();
  least.radius = CLOTH_MASK_MAX_RADIUS;
  least.shadow = 1;
  least.glow = 10;
  bad.radius = G_MAXINT;
  bad.shadow = INFINITY;
  bad.glow = 1e300;
  cloth_mask_run (mask, &least, &film->view, NULL, CLOTH_SIMD_BEST);
  cloth_mask_run (other, &bad, &film->view, NULL, CLOTH_SIMD_BEST);
  assert_same (mask, other);

  bad = cloth_mask_default_params ();
  bad.least = bad.hole = G_MAXUINT32;
  cloth_mask_run (other, &bad, &film->view, NULL, CLOTH_SIMD_BEST);
  cloth_mask_get_runs (other, &bad.least);
  g_assert_cmpuint (bad.least, ==, 0);
}

/* Small pictures, larger ones after them, backgrounds of another size or without colour. */
static void
test_sizes (void)
{
  static const gint edges[][2] = { {1, 1}, {2, 3}, {1, 200}, {300, 1}, {31, 33},
  {65, 64}, {WIDTH, HEIGHT}, {3, 3}
  };
  g_autoptr (ClothMask) mask = cloth_mask_new ();
  g_autoptr (ClothPool) pool = cloth_pool_new (3);
  g_autoptr (Picture) background = draw (&empty, 1);
  g_autoptr (Picture) film = draw (&usual, 1);
  ClothMaskParams params = cloth_mask_default_params ();
  guint n;

  params.radius = 7;
  params.thin = 32;
  params.least = 0;
  for (guint i = 0; i < G_N_ELEMENTS (edges); i++)
    for (gint colours = 0; colours < 4; colours++) {
      ClothPlanarImage a = background->view, b = film->view;

      a.luma.width = b.luma.width = edges[i][0];
      a.luma.height = b.luma.height = edges[i][1];
      if (colours & 1)
        a.chroma[0] = a.chroma[1] = NULL;
      if (colours & 2)
        b.chroma[0] = b.chroma[1] = NULL;
      cloth_mask_set_background (mask, &a);
      cloth_mask_run (mask, &params, &b, pool, CLOTH_SIMD_BEST);
      cloth_mask_run (mask, &params, &a, pool, CLOTH_SIMD_BEST);
      cloth_mask_get_runs (mask, &n);
      g_assert_cmpuint (n, ==, 0);
      cloth_mask_learn (mask, &b, CLOTH_SIMD_BEST);
      cloth_mask_run (mask, &params, &b, pool, CLOTH_SIMD_BEST);
      cloth_mask_get_runs (mask, &n);
      g_assert_cmpuint (n, ==, 0);
    }
  g_assert_false (cloth_mask_has_background (mask, &film->view));
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/mask/bits", test_bits);
  g_test_add_func ("/mask/pieces", test_pieces);
  g_test_add_func ("/mask/runs-cut", test_runs_cut);
  g_test_add_func ("/mask/scenes", test_scenes);
  g_test_add_func ("/mask/coded", test_coded);
  g_test_add_func ("/mask/bounds", test_bounds);
  g_test_add_func ("/mask/plain", test_plain);
  g_test_add_func ("/mask/ranges", test_ranges);
  g_test_add_func ("/mask/same", test_same);
  g_test_add_func ("/mask/learn", test_learn);
  g_test_add_func ("/mask/learn-few", test_learn_few);
  g_test_add_func ("/mask/parameters", test_parameters);
  g_test_add_func ("/mask/sizes", test_sizes);
  return g_test_run ();
}
