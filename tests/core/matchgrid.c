/* Vertices of a grid in films of closed form: waves under maps of first and second order,
 * from behind, folded, dimmed, noisy; what can't be.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/match/match.h"

#include <math.h>
#include <string.h>

#include "gst/math/random.h"

/* The flat picture, 1 mm a pixel, and its grid. */
#define SIZE 300
#define STEP 20
#define COUNT (SIZE / STEP + 1)
#define N (COUNT * COUNT)
#define WAVES 60
#define WIDTH 330
#define MATCHES 900

typedef struct
{
  gdouble kx, ky, phase, height;
} Wave;

/* A film of the waves, and what is true of it. */
typedef struct
{
  Wave waves[WAVES];
  guint8 flat[SIZE * SIZE], film[WIDTH * WIDTH];
  ClothImage reference, picture;
  ClothGridMatch matches[2 * MATCHES];
  guint n_matches;
} Scene;

/* The place of the flat picture that a place of the film shows, px; FALSE: none. */
typedef gboolean (*Map) (gdouble x, gdouble y, gdouble to[2]);

static gboolean
affine (gdouble x, gdouble y, gdouble to[2])
{
  to[0] = 0.95 * (x - 160) + 0.2 * (y - 165) + 150;
  to[1] = -0.15 * (x - 160) + 1.05 * (y - 165) + 150;
  return TRUE;
}

static gboolean
mirrored (gdouble x, gdouble y, gdouble to[2])
{
  affine (x, y, to);
  to[0] = SIZE - 1 - to[0];
  return TRUE;
}

static gboolean
bent (gdouble x, gdouble y, gdouble to[2])
{
  affine (x, y, to);
  to[0] += 6e-4 * (x - 160) * (x - 160) - 3e-4 * (x - 160) * (y - 165);
  to[1] += 5e-4 * (y - 165) * (y - 165);
  return TRUE;
}

/* The right half is shown 30 px of cloth farther on. */
static gboolean
folded (gdouble x, gdouble y, gdouble to[2])
{
  to[0] = x < 165 ? x - 20 : x + 10;
  to[1] = y - 15;
  return TRUE;
}

static gdouble
get_light (const Scene * scene, const gdouble at[2])
{
  gdouble sum = 128;

  for (guint k = 0; k < WAVES; k++) {
    const Wave *w = &scene->waves[k];

    sum += w->height * sin (w->kx * at[0] + w->ky * at[1] + w->phase);
  }
  return sum;
}

static gboolean
is_on_cloth (const gdouble to[2])
{
  return to[0] >= -0.5 && to[1] >= -0.5 && to[0] <= SIZE - 0.5
      && to[1] <= SIZE - 0.5;
}

/* Matches that lie @match_noise off, px. */
static Scene *
scene_new (Map map, gdouble gain, gdouble offset, gdouble noise,
    gdouble match_noise, guint64 seed)
{
  Scene *scene = g_new0 (Scene, 1);
  ClothRandom random;

  cloth_random_init (&random, seed);
  for (guint k = 0; k < WAVES; k++) {
    const gdouble length = 6 + 10 * cloth_random_uniform (&random);
    const gdouble angle = 2 * G_PI * cloth_random_uniform (&random);

    scene->waves[k] = (Wave) {
    2 *G_PI / length * cos (angle), 2 * G_PI / length * sin (angle),
          2 * G_PI * cloth_random_uniform (&random), 6};
  }
  for (gint y = 0; y < SIZE; y++)
    for (gint x = 0; x < SIZE; x++) {
      const gdouble at[2] = { x, y };

      scene->flat[y * SIZE + x] = (guint8) CLAMP (rint (get_light (scene, at)),
          0, 255);
    }
  for (gint y = 0; y < WIDTH; y++)
    for (gint x = 0; x < WIDTH; x++) {
      gdouble to[2], light = 60;

      if (map (x, y, to) && is_on_cloth (to))
        light = gain * get_light (scene, to) + offset;
      light += noise * cloth_random_gaussian (&random);
      scene->film[y * WIDTH + x] = (guint8) CLAMP (rint (light), 0, 255);
    }
  for (guint k = 0; k < MATCHES; k++) {
    const gdouble x = WIDTH * cloth_random_uniform (&random) - 0.5;
    const gdouble y = WIDTH * cloth_random_uniform (&random) - 0.5;
    gdouble to[2];

    if (!map (x, y, to) || !is_on_cloth (to))
      continue;
    scene->matches[scene->n_matches++] = (ClothGridMatch) {
    (gfloat) (x + match_noise * cloth_random_gaussian (&random)),
          (gfloat) (y + match_noise * cloth_random_gaussian (&random)),
          (gfloat) ((to[0] + 0.5) * 1e-3), (gfloat) ((to[1] + 0.5) * 1e-3),
          1e-3f, map == mirrored};
  }
  scene->reference = (ClothImage) {
  scene->flat, SIZE, SIZE, SIZE};
  scene->picture = (ClothImage) {
  scene->film, WIDTH, WIDTH, WIDTH};
  return scene;
}

/* The film's pixels are points here, without blur, and their noise is white. */
static ClothGridParams
get_params (void)
{
  ClothGridParams params = cloth_grid_default_params ();

  params.align.blur = 0;
  params.align.correlation = 1;
  params.align.model = 0;
  params.align.floor = 0;
  params.align.done = 0.001;
  params.align.rounds = 30;
  return params;
}

static ClothGridding
run_with (const Scene * scene, const ClothGridParams * params,
    ClothGridVertex vertices[N], ClothPool * pool, ClothSimd level)
{
  const ClothGridShape shape = { COUNT, COUNT, {SIZE * 1e-3, SIZE * 1e-3} };
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothGridder) gridder = cloth_gridder_new (&shape,
      &scene->reference, &error);
  ClothGridding gridding;

  g_assert_no_error (error);
  cloth_gridder_run (gridder, params, scene->matches, scene->n_matches,
      &scene->picture, NULL, NULL, vertices, &gridding, pool, level);
  return gridding;
}

static ClothGridding
run (const Scene * scene, ClothGridVertex vertices[N])
{
  const ClothGridParams params = get_params ();

  return run_with (scene, &params, vertices, NULL, CLOTH_SIMD_BEST);
}

/* Where the film shows a vertex: the closed form the other way round. */
static gboolean
find_truth (Map map, guint vertex, gdouble at[2])
{
  const gdouble wanted[2] = { (gdouble) (vertex % COUNT) * STEP - 0.5,
    (gdouble) (vertex / COUNT) * STEP - 0.5
  };

  at[0] = at[1] = 165;
  if (map == folded) {
    at[0] = wanted[0] + 20;
    at[1] = wanted[1] + 15;
    if (at[0] >= 165)
      at[0] = wanted[0] - 10;
    if (at[0] < 165 && wanted[0] + 20 >= 165)
      return FALSE;
  } else
    for (gint k = 0; k < 200; k++) {
      gdouble to[2];

      map (at[0], at[1], to);
      at[0] += (map == mirrored ? -0.8 : 0.8) * (wanted[0] - to[0]);
      at[1] += 0.8 * (wanted[1] - to[1]);
    }
  return at[0] >= -0.5 && at[1] >= -0.5 && at[0] < WIDTH - 0.5
      && at[1] < WIDTH - 0.5;
}

/* Whether a whole window is seen around a vertex. */
static gboolean
is_inner (guint vertex, const gdouble at[2])
{
  const guint column = vertex % COUNT, row = vertex / COUNT;

  return column > 0 && row > 0 && column < COUNT - 1 && row < COUNT - 1
      && at[0] > STEP && at[1] > STEP && at[0] < WIDTH - STEP
      && at[1] < WIDTH - STEP;
}

/* RMS an axis of whole windows, χ²/2 of all that is aligned; nothing that is hidden is
 * found. */
static gdouble
measure (Map map, const ClothGridVertex vertices[N], gdouble * chi,
    gdouble * worst, guint * n_missing)
{
  gdouble sum = 0;
  guint n = 0, n_inner = 0;

  *chi = *worst = 0;
  *n_missing = 0;
  for (guint v = 0; v < N; v++) {
    const ClothGridVertex *r = &vertices[v];
    gdouble at[2], dx, dy;
    const gboolean seen = find_truth (map, v, at);

    if (r->state != CLOTH_GRID_ALIGNED) {
      *n_missing += seen;
      continue;
    }
    if (!seen)
      g_test_message ("hidden vertex %u at %.2f %.2f, sd %.3f %.3f", v, r->x,
          r->y, sqrt (r->xx), sqrt (r->yy));
    g_assert_true (seen);
    g_assert_true (r->mirrored == (map == mirrored));
    dx = r->x - at[0];
    dy = r->y - at[1];
    *worst = MAX (*worst, hypot (dx, dy));
    if (is_inner (v, at)) {
      sum += dx * dx + dy * dy;
      n_inner++;
    }
    *chi += (r->yy * dx * dx - 2 * r->xy * dx * dy + r->xx * dy * dy)
        / (r->xx * r->yy - r->xy * r->xy);
    n++;
  }
  g_assert_cmpuint (n, >, 0);
  *chi /= 2 * n;
  g_test_message ("%u aligned, %u missing, RMS %.4f px, worst %.4f, chi2/2 "
      "%.2f", n, *n_missing, sqrt (sum / (2 * n_inner)), *worst, *chi);
  return sqrt (sum / (2 * n_inner));
}

/* White noise, other light: errors are as large as their covariances say. */
static void
check_noise (Map map, gdouble gain, gdouble offset)
{
  g_autofree Scene *scene = scene_new (map, gain, offset, 6, 0.3, 1);
  static ClothGridVertex vertices[N];
  gdouble chi, worst, rms;
  guint n_missing;

  run (scene, vertices);
  rms = measure (map, vertices, &chi, &worst, &n_missing);
  g_assert_cmpuint (n_missing, <=, N / 10);
  g_assert_cmpfloat (rms, <, 0.06 / gain);
  g_assert_cmpfloat (chi, >, 0.7);
  g_assert_cmpfloat (chi, <, 1.4);
}

static void
test_affine (void)
{
  check_noise (affine, 1, 0);
}

static void
test_light (void)
{
  check_noise (affine, 0.6, 70);
}

static void
test_mirrored (void)
{
  check_noise (mirrored, 1, 0);
}

/* Without noise but grey levels: nothing draws places towards pixels. */
static void
test_exact (void)
{
  g_autofree Scene *scene = scene_new (affine, 1, 0, 0, 0.3, 2);
  static ClothGridVertex vertices[N];
  gdouble chi, worst;
  guint n_missing;

  run (scene, vertices);
  g_assert_cmpfloat (measure (affine, vertices, &chi, &worst, &n_missing), <,
      0.005);
  g_assert_cmpuint (n_missing, <=, N / 10);
}

static void
test_bent (void)
{
  g_autofree Scene *scene = scene_new (bent, 1, 0, 0, 0.3, 3);
  static ClothGridVertex vertices[N];
  gdouble chi, worst;
  guint n_missing;

  run (scene, vertices);
  g_assert_cmpfloat (measure (bent, vertices, &chi, &worst, &n_missing), <,
      0.01);
  g_assert_cmpuint (n_missing, <=, N / 10);
}

/* What a fold hides is not found, what it shows is at its place, to the fold's edge. */
static void
test_fold (void)
{
  g_autofree Scene *scene = scene_new (folded, 1, 0, 2, 0.3, 4);
  static ClothGridVertex vertices[N];
  gdouble chi, worst;
  guint n_missing;

  run (scene, vertices);
  measure (folded, vertices, &chi, &worst, &n_missing);
  g_assert_cmpfloat (worst, <, 1);
  g_assert_cmpuint (n_missing, <=, COUNT);
}

/* Matches of a fifth of the cloth: the print itself leads to the rest. */
static void
test_extend (void)
{
  g_autofree Scene *scene = scene_new (affine, 1, 0, 2, 0.3, 5);
  static ClothGridVertex vertices[N];
  gdouble chi, worst;
  guint n_missing, n = 0;

  for (guint k = 0; k < scene->n_matches; k++)
    if (scene->matches[k].u < 0.06)
      scene->matches[n++] = scene->matches[k];
  scene->n_matches = n;
  run (scene, vertices);
  measure (affine, vertices, &chi, &worst, &n_missing);
  g_assert_cmpuint (n_missing, <=, N / 10);
  g_assert_cmpfloat (worst, <, 0.2);
}

/* A cloth without a print: the matches alone tell, with their own covariance. */
static void
test_plain (void)
{
  g_autofree Scene *scene = scene_new (affine, 1, 0, 0, 0.3, 6);
  static ClothGridVertex vertices[N];
  ClothGridParams params = get_params ();
  ClothGridding gridding;
  gdouble chi = 0;

  params.noise = 0.3;
  memset (scene->film, 100, sizeof scene->film);
  gridding = run_with (scene, &params, vertices, NULL, CLOTH_SIMD_BEST);
  g_assert_cmpuint (gridding.n_aligned, ==, 0);
  g_assert_cmpuint (gridding.n_matched, >, N / 2);
  for (guint v = 0; v < N; v++) {
    const ClothGridVertex *r = &vertices[v];
    gdouble at[2];

    if (r->state != CLOTH_GRID_MATCHED)
      continue;
    find_truth (affine, v, at);
    chi += (pow (r->x - at[0], 2) / r->xx + pow (r->y - at[1], 2) / r->yy)
        / (2 * gridding.n_matched);
  }
  g_test_message ("%u matched, chi2/2 %.2f", gridding.n_matched, chi);
  g_assert_cmpfloat (chi, <, 1.5);
  g_assert_cmpfloat (chi, >, 0.4);
}

static void
assert_unseen (const ClothGridVertex vertices[N],
    const ClothGridding * gridding)
{
  for (guint v = 0; v < N; v++) {
    g_assert_cmpint (vertices[v].state, ==, CLOTH_GRID_UNSEEN);
    g_assert_true (isnan (vertices[v].x) && isnan (vertices[v].yy));
  }
  g_assert_cmpuint (gridding->n_aligned + gridding->n_matched, ==, 0);
}

/* Matches that lie: the film shows another print. */
static void
test_other_print (void)
{
  g_autofree Scene *scene = scene_new (affine, 1, 0, 2, 0.3, 7);
  g_autofree Scene *other = scene_new (affine, 1, 0, 2, 0.3, 8);
  static ClothGridVertex vertices[N];
  ClothGridding gridding;

  memcpy (scene->film, other->film, sizeof scene->film);
  gridding = run (scene, vertices);
  g_assert_cmpuint (gridding.n_aligned, <=, 2);
  g_assert_cmpuint (gridding.n_matched, ==, 0);
}

/* The negative of the print is not the print. */
static void
test_negative (void)
{
  g_autofree Scene *scene = scene_new (affine, -0.8, 220, 2, 0.3, 9);
  static ClothGridVertex vertices[N];
  const ClothGridding gridding = run (scene, vertices);

  g_assert_cmpuint (gridding.n_aligned + gridding.n_matched, <=, 2);
}

static void
test_no_matches (void)
{
  g_autofree Scene *scene = scene_new (affine, 1, 0, 0, 0, 10);
  static ClothGridVertex vertices[N];
  ClothGridding gridding;

  scene->n_matches = 0;
  gridding = run (scene, vertices);
  assert_unseen (vertices, &gridding);
  scene->n_matches = 2;
  gridding = run (scene, vertices);
  assert_unseen (vertices, &gridding);
}

static void
test_on_a_line (void)
{
  g_autofree Scene *scene = scene_new (affine, 1, 0, 0, 0, 11);
  static ClothGridVertex vertices[N];
  ClothGridding gridding;

  for (guint k = 0; k < scene->n_matches; k++) {
    ClothGridMatch *m = &scene->matches[k];
    gdouble to[2];

    m->y = m->x;
    affine (m->x, m->y, to);
    m->u = (gfloat) ((to[0] + 0.5) * 1e-3);
    m->v = (gfloat) ((to[1] + 0.5) * 1e-3);
  }
  gridding = run (scene, vertices);
  assert_unseen (vertices, &gridding);
}

/* Matches that are no numbers change nothing, nor do several at one place. */
static void
test_no_numbers (void)
{
  g_autofree Scene *scene = scene_new (affine, 1, 0, 2, 0.3, 12);
  static ClothGridVertex vertices[N], again[N];
  const guint n = scene->n_matches;

  run (scene, vertices);
  for (guint k = 0; k < 20; k++) {
    ClothGridMatch *m = &scene->matches[scene->n_matches++];

    *m = scene->matches[k];
    switch (k % 5) {
      case 0:
        m->x = NAN;
        break;
      case 1:
        m->v = INFINITY;
        break;
      case 2:
        m->metres_per_pixel = 0;
        break;
      case 3:
        m->metres_per_pixel = NAN;
        break;
    }
  }
  g_assert_cmpuint (scene->n_matches, ==, n + 20);
  run (scene, again);
  g_assert_cmpmem (vertices, sizeof vertices, again, sizeof again);
}

/* The same cloth seen twice, with as many matches: neither is believed. */
static void
test_contradicted (void)
{
  g_autofree Scene *scene = scene_new (folded, 1, 0, 0, 0.2, 13);
  static ClothGridVertex vertices[N];
  ClothGridding gridding;

  scene->n_matches = 0;
  for (gint copy = 0; copy < 2; copy++)
    for (gint y = 0; y < 24; y++)
      for (gint x = 0; x < 12; x++) {
        const gdouble to[2] = { 10 + 10 * x, 20 + 10 * y };

        scene->matches[scene->n_matches++] = (ClothGridMatch) {
        (gfloat) (to[0] + 160 * copy + 5), (gfloat) to[1],
              (gfloat) ((to[0] + 0.5) * 1e-3),
              (gfloat) ((to[1] + 0.5) * 1e-3), 1e-3f, FALSE};
      }
  gridding = run (scene, vertices);
  g_assert_cmpuint (gridding.n_contradicted, >, 20);
}

/* Matches that face the other way than they say are no cloth. */
static void
test_wrong_side (void)
{
  g_autofree Scene *scene = scene_new (affine, 1, 0, 2, 0.3, 14);
  static ClothGridVertex vertices[N];
  ClothGridding gridding;

  for (guint k = 0; k < scene->n_matches; k++)
    scene->matches[k].mirrored = TRUE;
  gridding = run (scene, vertices);
  assert_unseen (vertices, &gridding);
}

/* A break of the surface along the fold: no triangle leads over it. */
static void
test_surface (void)
{
  g_autofree Scene *scene = scene_new (folded, 1, 0, 2, 0.3, 15);
  g_autofree gfloat *points = g_new (gfloat, 3 * WIDTH * WIDTH);
  const ClothMatchSurface surface = { points, WIDTH, WIDTH, WIDTH };
  const ClothGridShape shape = { COUNT, COUNT, {SIZE * 1e-3, SIZE * 1e-3} };
  const ClothGridParams params = get_params ();
  g_autoptr (ClothGridder) gridder = cloth_gridder_new (&shape,
      &scene->reference, NULL);
  static ClothGridVertex vertices[N];
  ClothGridding gridding;
  gdouble chi, worst;
  guint n_missing;

  for (gint y = 0; y < WIDTH; y++)
    for (gint x = 0; x < WIDTH; x++) {
      gfloat *p = points + 3 * (y * WIDTH + x);

      p[0] = (gfloat) (x * 1e-3);
      p[1] = (gfloat) (y * 1e-3);
      p[2] = x < 165 ? 1 : 1.1f;
    }
  cloth_gridder_run (gridder, &params, scene->matches, scene->n_matches,
      &scene->picture, NULL, &surface, vertices, &gridding, NULL,
      CLOTH_SIMD_BEST);
  measure (folded, vertices, &chi, &worst, &n_missing);
  g_assert_cmpfloat (worst, <, 0.2);
  g_assert_cmpuint (n_missing, <=, COUNT);
  for (gsize i = 0; i < 3 * WIDTH * WIDTH; i++)
    points[i] = NAN;
  cloth_gridder_run (gridder, &params, scene->matches, scene->n_matches,
      &scene->picture, NULL, &surface, vertices, &gridding, NULL,
      CLOTH_SIMD_BEST);
  assert_unseen (vertices, &gridding);
}

/* Nothing is aligned by what the mask leaves out. */
static void
test_mask (void)
{
  g_autofree Scene *scene = scene_new (affine, 1, 0, 2, 0.3, 16);
  g_autofree guint8 *pixels = g_malloc0 (WIDTH * WIDTH);
  const ClothImage mask = { pixels, WIDTH, WIDTH, WIDTH };
  const ClothGridShape shape = { COUNT, COUNT, {SIZE * 1e-3, SIZE * 1e-3} };
  const ClothGridParams params = get_params ();
  g_autoptr (ClothGridder) gridder = cloth_gridder_new (&shape,
      &scene->reference, NULL);
  static ClothGridVertex vertices[N];
  ClothGridding gridding;

  cloth_gridder_run (gridder, &params, scene->matches, scene->n_matches,
      &scene->picture, &mask, NULL, vertices, &gridding, NULL, CLOTH_SIMD_BEST);
  g_assert_cmpuint (gridding.n_aligned, ==, 0);
  memset (pixels, 255, WIDTH * WIDTH);
  cloth_gridder_run (gridder, &params, scene->matches, scene->n_matches,
      &scene->picture, &mask, NULL, vertices, &gridding, NULL, CLOTH_SIMD_BEST);
  g_assert_cmpuint (gridding.n_aligned, >, N * 9 / 10);
}

/* A film and a print of one pixel. */
static void
test_one_pixel (void)
{
  g_autofree Scene *scene = scene_new (affine, 1, 0, 0, 0.3, 17);
  static ClothGridVertex vertices[N];
  ClothGridding gridding;

  scene->picture.width = scene->picture.height = 1;
  gridding = run (scene, vertices);
  g_assert_cmpuint (gridding.n_aligned, ==, 0);
  scene->picture.width = scene->picture.height = WIDTH;
  scene->reference.width = scene->reference.height = 1;
  gridding = run (scene, vertices);
  g_assert_cmpuint (gridding.n_aligned, ==, 0);
}

/* Parameters that can't be are brought into their ranges. */
static void
test_params (void)
{
  g_autofree Scene *scene = scene_new (affine, 1, 0, 2, 0.3, 18);
  static ClothGridVertex vertices[N];
  ClothGridParams params = get_params ();
  ClothGridding gridding;

  params.most = params.least = G_MAXUINT;
  params.radius = 1e9;
  params.align.radius = 1000;
  gridding = run_with (scene, &params, vertices, NULL, CLOTH_SIMD_BEST);
  g_assert_cmpuint (gridding.n_aligned, <=, N);
  memset (&params, 0, sizeof params);
  gridding = run_with (scene, &params, vertices, NULL, CLOTH_SIMD_BEST);
  assert_unseen (vertices, &gridding);
}

/* The same bytes by any number of threads and by all instructions. */
static void
test_same_bytes (void)
{
  g_autofree Scene *scene = scene_new (bent, 0.9, 5, 3, 0.3, 19);
  g_autoptr (ClothPool) pool = cloth_pool_new (3);
  const ClothGridParams params = get_params ();
  static ClothGridVertex one[N], other[N];

  memset (one, 0, sizeof one);
  memset (other, 0, sizeof other);
  run_with (scene, &params, one, NULL, CLOTH_SIMD_SCALAR);
  for (gint level = CLOTH_SIMD_SCALAR; level <= CLOTH_SIMD_AVX512; level++) {
    run_with (scene, &params, other, pool, (ClothSimd) level);
    g_assert_cmpmem (one, sizeof one, other, sizeof other);
  }
}

static void
test_refused (void)
{
  static const ClothGridShape shapes[] = {
    {1, 5, {1, 1}}, {5, 1, {1, 1}}, {CLOTH_GRID_MAX + 1, 5, {1, 1}},
    {5, 5, {0, 1}}, {5, 5, {1, NAN}}, {5, 5, {INFINITY, 1}}, {5, 5, {1, -1}}
  };
  const guint8 pixel = 0;
  const ClothImage image = { &pixel, 1, 1, 1 };

  for (guint k = 0; k < G_N_ELEMENTS (shapes); k++) {
    g_autoptr (GError) error = NULL;

    g_assert_null (cloth_gridder_new (&shapes[k], &image, &error));
    g_assert_error (error, CLOTH_CV_ERROR, CLOTH_CV_ERROR_PARAMETER);
  }
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/matchgrid/affine", test_affine);
  g_test_add_func ("/matchgrid/light", test_light);
  g_test_add_func ("/matchgrid/mirrored", test_mirrored);
  g_test_add_func ("/matchgrid/exact", test_exact);
  g_test_add_func ("/matchgrid/bent", test_bent);
  g_test_add_func ("/matchgrid/fold", test_fold);
  g_test_add_func ("/matchgrid/extend", test_extend);
  g_test_add_func ("/matchgrid/plain", test_plain);
  g_test_add_func ("/matchgrid/surface", test_surface);
  g_test_add_func ("/matchgrid/mask", test_mask);
  g_test_add_func ("/matchgrid/same-bytes", test_same_bytes);
  g_test_add_func ("/matchgrid/other-print", test_other_print);
  g_test_add_func ("/matchgrid/negative", test_negative);
  g_test_add_func ("/matchgrid/no-matches", test_no_matches);
  g_test_add_func ("/matchgrid/on-a-line", test_on_a_line);
  g_test_add_func ("/matchgrid/no-numbers", test_no_numbers);
  g_test_add_func ("/matchgrid/contradicted", test_contradicted);
  g_test_add_func ("/matchgrid/wrong-side", test_wrong_side);
  g_test_add_func ("/matchgrid/one-pixel", test_one_pixel);
  g_test_add_func ("/matchgrid/params", test_params);
  g_test_add_func ("/matchgrid/refused", test_refused);
  return g_test_run ();
}
