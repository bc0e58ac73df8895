/* Matching with a flat print, on cloths of closed form: a plane, a cylinder, a fold with a
 * step in depth; false matches, a repeated print, the back of a print; what can't be.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/match/match.h"

#include <malloc.h>
#include <math.h>
#include <string.h>

#include "gst/math/random.h"

#define BYTES CLOTH_CV_SIFT_BYTES
/* The flat picture: 0.4 m, 1 mm a pixel. */
#define SIZE 400
#define ALPHA 0.001
#define N 4000
/* The film: a pixel is 1 mm at 1 m. */
#define WIDTH 480
#define FOCAL 1000.0
#define RADIUS 0.15

/* Features that both have, with what is true of them. */
typedef struct
{
  guint n;
  gfloat x[N], y[N], scale[N], angle[N];
  guint8 view[N], side[N];
  guint8 descriptors[N * BYTES];
} Print;

typedef struct
{
  ClothCvFeatures features;
  gfloat x[N], y[N], scale[N], angle[N];
  guint8 descriptors[N * BYTES];
  guint of[N];                  /* which of the print each is */
  gfloat points[3 * WIDTH * WIDTH];
  ClothMatchSurface surface;
} Film;

/* Where a place of the cloth is in the world: z away from the camera. FALSE: hidden. */
typedef gboolean (*Shape) (gdouble u, gdouble v, gdouble point[3]);

static gboolean
plane (gdouble u, gdouble v, gdouble point[3])
{
  point[0] = u - 0.2;
  point[1] = v - 0.2;
  point[2] = 1;
  return TRUE;
}

/* About an upright axis, seen from outside. */
static gboolean
cylinder (gdouble u, gdouble v, gdouble point[3])
{
  const gdouble angle = (u - 0.2) / RADIUS;

  point[0] = RADIUS * sin (angle);
  point[1] = v - 0.2;
  point[2] = 1 + RADIUS * (1 - cos (angle));
  return fabs (angle) < 1;
}

/* The right half is 60 mm behind the left one, and 70 mm of cloth between are hidden. */
static gboolean
fold (gdouble u, gdouble v, gdouble point[3])
{
  plane (u, v, point);
  if (u > 0.2) {
    point[0] -= 0.07;
    point[2] += 0.06;
  }
  return u < 0.2 || point[0] / point[2] > 0;
}

static Print *
print_new (gint sides, guint64 seed)
{
  Print *print = g_new0 (Print, 1);
  ClothRandom random;

  cloth_random_init (&random, seed);
  print->n = N;
  for (guint i = 0; i < N; i++) {
    print->x[i] = (gfloat) (SIZE * cloth_random_uniform (&random) - 0.5);
    print->y[i] = (gfloat) (SIZE * cloth_random_uniform (&random) - 0.5);
    print->scale[i] = (gfloat) (2 + 6 * cloth_random_uniform (&random));
    print->angle[i] = (gfloat) (2 * G_PI * cloth_random_uniform (&random));
    print->side[i] = sides == 2 && i % 2;
  }
  for (guint i = 0; i < N * BYTES; i++)
    print->descriptors[i] = (guint8) cloth_random_below (&random, 100);
  return print;
}

static ClothReference *
reference_new (const Print * print)
{
  const ClothReferenceFeatures features = { print->n, SIZE, SIZE, print->x,
    print->y, print->scale, print->angle, print->view, print->side,
    print->descriptors
  };
  const gdouble cloth_m[2] = { SIZE * ALPHA, SIZE * ALPHA };
  g_autoptr (GError) error = NULL;
  ClothReference *reference = cloth_reference_new_from_features (&features,
      cloth_m, 0, &error);

  g_assert_no_error (error);
  return reference;
}

static gboolean
project (Shape shape, gdouble u, gdouble v, gdouble at[2], gdouble point[3])
{
  if (!shape (u, v, point))
    return FALSE;
  at[0] = WIDTH / 2 + FOCAL * point[0] / point[2];
  at[1] = WIDTH / 2 + FOCAL * point[1] / point[2];
  return TRUE;
}

/* @back: the camera sees the side of odd features, the world being mirrored */
static Film *
film_new (const Print * print, Shape shape, gboolean back)
{
  Film *film = g_new0 (Film, 1);
  ClothRandom random;
  guint n = 0;

  cloth_random_init (&random, 99);
  for (gsize i = 0; i < 3 * WIDTH * WIDTH; i++)
    film->points[i] = NAN;
  /* denser than pixels; what is nearer hides what is behind */
  for (gint j = 0; j < 3 * SIZE; j++)
    for (gint i = 0; i < 3 * SIZE; i++) {
      gdouble at[2], point[3];
      gfloat *to;

      if (!project (shape, (i + 0.5) * ALPHA / 3, (j + 0.5) * ALPHA / 3, at,
              point))
        continue;
      if (back)
        at[0] = WIDTH - at[0];
      to = film->points + 3 * ((gsize) rint (at[1]) * WIDTH
          + (gsize) rint (at[0]));
      if (to[2] < point[2])
        continue;
      /* on the pixel's own ray */
      to[0] = (gfloat) ((rint (at[0]) - WIDTH / 2) * point[2] / FOCAL);
      to[1] = (gfloat) ((rint (at[1]) - WIDTH / 2) * point[2] / FOCAL);
      to[2] = (gfloat) point[2];
    }
  for (guint i = 0; i < print->n; i++) {
    gdouble at[2], point[3];

    if (print->side[i] != back || !project (shape, (print->x[i] + 0.5) * ALPHA,
            (print->y[i] + 0.5) * ALPHA, at, point))
      continue;
    film->x[n] = (gfloat) (back ? WIDTH - at[0] : at[0]);
    film->y[n] = (gfloat) at[1];
    film->scale[n] = print->scale[i];
    film->angle[n] = back ? (gfloat) G_PI - print->angle[i] : print->angle[i];
    for (gint k = 0; k < BYTES; k++) {
      const gdouble value = print->descriptors[i * BYTES + k]
          + 8 * cloth_random_gaussian (&random);

      film->descriptors[n * BYTES + k] = (guint8) CLAMP (value, 0, 255);
    }
    film->of[n++] = i;
  }
  film->features = (ClothCvFeatures) {
  n, film->x, film->y, film->scale, film->angle, film->descriptors};
  film->surface = (ClothMatchSurface) {
  film->points, WIDTH, WIDTH, WIDTH};
  return film;
}

/* Whether it shows the place where it truly is, to a pixel. */
static gboolean
is_right (const ClothReference * reference, const Print * print,
    const Film * film, guint i, const ClothMatch * match)
{
  const ClothReferenceFeatures *r = cloth_reference_get_features (reference);
  const guint of = film->of[i];

  return hypotf (r->x[match->reference] - print->x[of],
      r->y[match->reference] - print->y[of]) < 1
      && r->side[match->reference] == print->side[of];
}

typedef struct
{
  ClothMatch matches[N];
  ClothGrowth growth;
  ClothVerification verification;
  guint n_right;                /* of those that are verified */
} Result;

static Result *
match (const ClothReference * reference, const Print * print,
    const Film * film, gboolean surface)
{
  const ClothGrowParams grow = cloth_grow_default_params ();
  const ClothVerifyParams verify = cloth_verify_default_params ();
  g_autoptr (ClothGrower) grower = cloth_grower_new ();
  g_autoptr (ClothVerifier) verifier = cloth_verifier_new ();
  Result *result = g_new0 (Result, 1);

  cloth_grower_run (grower, &grow, reference, &film->features,
      surface ? &film->surface : NULL, result->matches, &result->growth, NULL,
      CLOTH_SIMD_BEST);
  cloth_verifier_run (verifier, &verify, reference, &film->features,
      surface ? &film->surface : NULL, result->matches, &result->verification,
      NULL);
  for (guint i = 0; i < film->features.n; i++)
    result->n_right += result->matches[i].state == CLOTH_MATCH_MATCHED
        && is_right (reference, print, film, i, &result->matches[i]);
  return result;
}

static void
check_shape (Shape shape, gdouble least, gboolean surface)
{
  g_autofree Print *print = print_new (1, 1);
  g_autoptr (ClothReference) reference = reference_new (print);
  g_autofree Film *film = film_new (print, shape, FALSE);
  g_autofree Result *result = match (reference, print, film, surface);

  g_test_message ("%u features, %u matched, %u verified, %u right",
      film->features.n, result->growth.n_matched,
      result->verification.n_verified, result->n_right);
  g_assert_cmpuint (result->n_right, ==, result->verification.n_verified);
  g_assert_cmpfloat (result->n_right, >=, least * film->features.n);
  g_assert_true (result->growth.by_scale == !surface);
}

static void
test_plane (void)
{
  check_shape (plane, 0.99, TRUE);
  check_shape (plane, 0.99, FALSE);
}

static void
test_cylinder (void)
{
  check_shape (cylinder, 0.97, TRUE);
}

static void
test_fold (void)
{
  check_shape (fold, 0.95, TRUE);
}

/* Along a cylinder the length is r·φ; over a fold it is broken. */
static void
test_length (void)
{
  g_autofree Print *print = print_new (1, 1);
  g_autofree Film *round = film_new (print, cylinder, FALSE);
  g_autofree Film *folded = film_new (print, fold, FALSE);
  const gfloat left[2] = { 200, 240 }, right[2] = { 280, 240 };
  gdouble length, expected, at[2] = { 0, 0 }, point[3], low = 0.2, high = 0.35;
  gboolean broken;

  /* the u that is seen in column 280 */
  for (gint i = 0; i < 60; i++) {
    const gdouble middle = (low + high) / 2;

    g_assert_true (project (cylinder, middle, 0.2, at, point));
    if (at[0] < 280)
      low = middle;
    else
      high = middle;
  }
  expected = 2 * (low - 0.2);
  g_assert_true (cloth_surface_measure (&round->surface, left, right, 0.01,
          &length, &broken));
  g_assert_false (broken);
  g_assert_cmpfloat_with_epsilon (length, expected, 0.02 * expected);
  g_assert_true (cloth_surface_measure (&folded->surface, left, right, 0.01,
          &length, &broken));
  g_assert_true (broken);
}

/* Places outside of the picture, also beyond what a whole number holds, have no surface. */
static void
test_outside (void)
{
  static const gdouble far[] = { 1e6, 3e9, 1e30, INFINITY, -1.5, -3e9, -1e30,
    -INFINITY, NAN
  };
  g_autofree Print *print = print_new (1, 1);
  g_autofree Film *film = film_new (print, plane, FALSE);
  const gfloat inside[2] = { 240, 240 };
  gdouble length, point[3];
  gboolean broken;

  for (guint i = 0; i < G_N_ELEMENTS (far); i++)
    for (guint c = 0; c < 2; c++) {
      const gdouble x = c ? 240 : far[i], y = c ? far[i] : 240;
      const gfloat outside[2] = { (gfloat) x, (gfloat) y };

      g_assert_false (cloth_surface_get_point (&film->surface, x, y, 0.01,
              point));
      g_assert_false (cloth_surface_measure (&film->surface, inside, outside,
              0.01, &length, &broken));
    }
  g_assert_true (cloth_surface_get_point (&film->surface, 240, 240, 0.01,
          point));
}

/* Every tenth match is put elsewhere; every wrong one is refused, few right ones are. */
static void
test_refuse (void)
{
  g_autofree Print *print = print_new (1, 1);
  g_autoptr (ClothReference) reference = reference_new (print);
  g_autofree Film *film = film_new (print, cylinder, FALSE);
  g_autofree Result *result = match (reference, print, film, TRUE);
  const ClothVerifyParams params = cloth_verify_default_params ();
  g_autoptr (ClothVerifier) verifier = cloth_verifier_new ();
  ClothVerification again;
  guint n_wrong = 0, n_before = result->verification.n_verified;

  for (guint i = 0; i < film->features.n; i += 10) {
    if (result->matches[i].state != CLOTH_MATCH_MATCHED)
      continue;
    result->matches[i].reference = (result->matches[i].reference + N / 2) % N;
    n_wrong++;
  }
  cloth_verifier_run (verifier, &params, reference, &film->features,
      &film->surface, result->matches, &again, NULL);
  for (guint i = 0; i < film->features.n; i++)
    if (result->matches[i].state == CLOTH_MATCH_MATCHED)
      g_assert_true (is_right (reference, print, film, i, &result->matches[i]));
  g_assert_cmpuint (n_wrong, >, 100);
  g_assert_cmpfloat (again.n_verified, >=, 0.97 * (n_before - n_wrong));
}

/* Matches as they would be if the features in a disc of the print were its parts @shift px
 * farther right, and a group of their own. Counts the disc's features that are verified in
 * the end, of all @n_disc.
 *
 * Returns: how many others are verified
 */
static guint
verify_disc (const Print * print, const Film * film, gfloat shift,
    guint * n_disc, guint * n_kept)
{
  g_autofree Print *shifted = g_memdup2 (print, sizeof *print);
  g_autofree ClothMatch *matches = g_new0 (ClothMatch, film->features.n);
  g_autofree gboolean *inside = g_new0 (gboolean, N);
  const ClothVerifyParams params = cloth_verify_default_params ();
  g_autoptr (ClothVerifier) verifier = cloth_verifier_new ();
  g_autoptr (ClothReference) moved = NULL;
  const ClothReferenceFeatures *r;
  ClothVerification verification;

  for (guint i = 0; i < N; i++) {
    inside[i] = hypotf (print->x[i] - 150, print->y[i] - 200) < 30;
    shifted->x[i] += inside[i] ? shift : 0;
  }
  moved = reference_new (shifted);
  r = cloth_reference_get_features (moved);
  for (guint i = 0; i < film->features.n; i++) {
    const guint of = film->of[i];

    for (guint k = 0; k < N; k++)
      if (r->x[k] == shifted->x[of] && r->y[k] == shifted->y[of])
        matches[i] = (ClothMatch) {
        CLOTH_MATCH_MATCHED, k, 0, inside[of]
        };
  }
  cloth_verifier_run (verifier, &params, moved, &film->features,
      &film->surface, matches, &verification, NULL);
  *n_disc = *n_kept = 0;
  for (guint i = 0; i < film->features.n; i++) {
    *n_disc += inside[film->of[i]];
    *n_kept += inside[film->of[i]] && matches[i].state == CLOTH_MATCH_MATCHED;
  }
  return verification.n_verified - *n_kept;
}

/* A whole group of a wrong seed fits itself, but not its neighbours. */
static void
test_refuse_group (void)
{
  g_autofree Print *print = print_new (1, 1);
  g_autofree Film *film = film_new (print, plane, FALSE);
  guint n_disc, n_kept;

  g_assert_cmpfloat (verify_disc (print, film, 100, &n_disc, &n_kept), >,
      0.9 * (N - n_disc));
  g_assert_cmpuint (n_disc, >, 50);
  g_assert_cmpuint (n_kept, ==, 0);
}

/* So does one that has no neighbour: nothing is known of the surface around it. Another
 * group shows the place that it claims; if none does it stays. */
static void
test_refuse_alone (void)
{
  g_autofree Print *print = print_new (1, 1);
  g_autofree Film *film = film_new (print, plane, FALSE);
  guint n_disc, n_kept;

  for (gint y = 0; y < WIDTH; y++)
    for (gint x = 0; x < WIDTH; x++) {
      /* the film has the disc 40.5 px farther right and down */
      const gdouble off = hypot (x - 190.5, y - 240.5);

      if (off > 28 && off < 95)
        film->points[3 * (y * WIDTH + x) + 2] = NAN;
    }
  verify_disc (print, film, 0, &n_disc, &n_kept);
  g_assert_cmpuint (n_disc, >, 50);
  g_assert_cmpfloat (n_kept, >, 0.7 * n_disc);
  verify_disc (print, film, 130, &n_disc, &n_kept);
  g_assert_cmpuint (n_kept, ==, 0);
}

/* Each run uses the memory of those before it. */
static void
test_memory (void)
{
  g_autofree Print *print = print_new (1, 1);
  g_autoptr (ClothReference) reference = reference_new (print);
  g_autofree Film *film = film_new (print, cylinder, FALSE);
  const ClothGrowParams grow = cloth_grow_default_params ();
  const ClothVerifyParams verify = cloth_verify_default_params ();
  g_autoptr (ClothGrower) grower = cloth_grower_new ();
  g_autoptr (ClothVerifier) verifier = cloth_verifier_new ();
  g_autofree ClothMatch *matches = g_new (ClothMatch, N);
  gsize before = 0;

  for (gint round = 0; round < 12; round++) {
    ClothGrowth growth;
    ClothVerification verification;

    cloth_grower_run (grower, &grow, reference, &film->features,
        &film->surface, matches, &growth, NULL, CLOTH_SIMD_BEST);
    cloth_verifier_run (verifier, &verify, reference, &film->features,
        &film->surface, matches, &verification, NULL);
    g_assert_cmpuint (verification.n_verified, >, 1000);
    if (round == 1)
      before = mallinfo2 ().uordblks;
  }
  g_assert_cmpuint (mallinfo2 ().uordblks, ==, before);
}

/* All features of the film claim one place of the print. At most one of those that are farther
 * apart than the slack can be right, and memory doesn't grow with their square. */
static void
test_crowd (void)
{
  g_autofree Print *print = print_new (1, 1);
  g_autoptr (ClothReference) reference = reference_new (print);
  g_autofree Film *film = film_new (print, plane, FALSE);
  const ClothVerifyParams params = cloth_verify_default_params ();
  g_autoptr (ClothVerifier) verifier = cloth_verifier_new ();
  g_autofree ClothMatch *matches = g_new0 (ClothMatch, film->features.n);
  const struct mallinfo2 before = mallinfo2 ();
  ClothVerification verification;
  struct mallinfo2 after;

  for (guint i = 0; i < film->features.n; i++)
    matches[i] = (ClothMatch) {
    CLOTH_MATCH_MATCHED, 0, 10, i / 50};
  cloth_verifier_run (verifier, &params, reference, &film->features, NULL,
      matches, &verification, NULL);
  after = mallinfo2 ();
  g_test_message ("%u of %u left, %zu bytes", verification.n_verified,
      film->features.n, after.uordblks + after.hblkhd - before.uordblks
      - before.hblkhd);
  g_assert_cmpuint (verification.n_verified, <=, film->features.n / 100);
  g_assert_cmpuint (after.uordblks + after.hblkhd, <,
      before.uordblks + before.hblkhd + 1000 * film->features.n);
}

/* The back matches with features of the back, and not without them. */
static void
test_back (void)
{
  g_autofree Print *both = print_new (2, 1);
  g_autofree Print *front = g_memdup2 (both, sizeof *both);
  g_autoptr (ClothReference) reference = reference_new (both);
  g_autoptr (ClothReference) one_sided = NULL;
  g_autofree Film *film = film_new (both, cylinder, TRUE);
  g_autofree Result *result = match (reference, both, film, TRUE);
  g_autofree Result *without = NULL;

  g_assert_cmpfloat (result->n_right, >=, 0.95 * film->features.n);
  g_assert_cmpuint (result->n_right, ==, result->verification.n_verified);
  front->n = 0;
  for (guint i = 0; i < N; i += 2, front->n++) {
    front->x[front->n] = both->x[i];
    front->y[front->n] = both->y[i];
    front->scale[front->n] = both->scale[i];
    front->angle[front->n] = both->angle[i];
    front->side[front->n] = 0;
    memmove (front->descriptors + front->n * BYTES,
        both->descriptors + i * BYTES, BYTES);
  }
  one_sided = reference_new (front);
  without = match (one_sided, both, film, TRUE);
  g_assert_cmpuint (without->verification.n_verified, ==, 0);
}

/* The same for any number of threads and any instructions, and when run again. */
static void
test_same (void)
{
  g_autofree Print *print = print_new (1, 1);
  g_autoptr (ClothReference) reference = reference_new (print);
  g_autofree Film *film = film_new (print, fold, FALSE);
  g_autofree Result *result = match (reference, print, film, TRUE);
  const ClothGrowParams grow = cloth_grow_default_params ();
  const ClothVerifyParams verify = cloth_verify_default_params ();
  g_autoptr (ClothGrower) grower = cloth_grower_new ();
  g_autoptr (ClothVerifier) verifier = cloth_verifier_new ();
  static const ClothSimd levels[] = { CLOTH_SIMD_SCALAR, CLOTH_SIMD_AVX2,
    CLOTH_SIMD_AVX512, CLOTH_SIMD_BEST
  };

  for (guint l = 0; l < G_N_ELEMENTS (levels); l++)
    for (guint threads = 1; threads < 4; threads++) {
      g_autoptr (ClothPool) pool = cloth_pool_new (threads);
      g_autofree Result *again = g_new0 (Result, 1);

      cloth_grower_run (grower, &grow, reference, &film->features,
          &film->surface, again->matches, &again->growth, pool, levels[l]);
      cloth_verifier_run (verifier, &verify, reference, &film->features,
          &film->surface, again->matches, &again->verification, pool);
      g_assert_cmpmem (again->matches, sizeof again->matches, result->matches,
          sizeof result->matches);
      g_assert_cmpmem (&again->growth, sizeof again->growth, &result->growth,
          sizeof result->growth);
    }
}

/* Wrong matches of many groups: as many threads as may be refuse the same ones. */
static void
test_same_refused (void)
{
  g_autofree Print *print = print_new (1, 1);
  g_autoptr (ClothReference) reference = reference_new (print);
  g_autofree Film *film = film_new (print, fold, FALSE);
  g_autofree Result *grown = match (reference, print, film, TRUE);
  const guint n_references = cloth_reference_get_features (reference)->n;
  const ClothVerifyParams verify = cloth_verify_default_params ();
  g_autoptr (ClothVerifier) verifier = cloth_verifier_new ();
  g_autofree ClothMatch *wrong = g_memdup2 (grown->matches,
      sizeof grown->matches);
  g_autofree ClothMatch *first = NULL;
  ClothVerification expected;
  ClothRandom random;

  cloth_random_init (&random, 3);
  for (guint i = 0; i < film->features.n; i++) {
    wrong[i].group = (guint) film->features.x[i] / 40;
    if (i % 4 == 0)
      wrong[i].reference = (guint) (cloth_random_uniform (&random)
          * n_references);
  }
  first = g_memdup2 (wrong, sizeof grown->matches);
  cloth_verifier_run (verifier, &verify, reference, &film->features,
      &film->surface, first, &expected, NULL);
  g_assert_cmpuint (expected.n_verified, >, 1000);
  g_assert_cmpuint (expected.n_refused_within, >, 100);
  for (guint threads = 2; threads < 5; threads++) {
    g_autoptr (ClothPool) pool = cloth_pool_new (threads);
    g_autofree ClothMatch *again = g_memdup2 (wrong, sizeof grown->matches);
    ClothVerification counts;

    cloth_verifier_run (verifier, &verify, reference, &film->features,
        &film->surface, again, &counts, pool);
    g_assert_cmpmem (again, sizeof grown->matches, first,
        sizeof grown->matches);
    g_assert_cmpmem (&counts, sizeof counts, &expected, sizeof expected);
  }
}

/* ---- references from pictures ---- */

/* Blobs of random size and grey; the right half may be the left one again. */
static guint8 *
draw (gint width, gint height, gboolean repeated)
{
  guint8 *data = g_malloc ((gsize) width * height);
  const gint period = repeated ? width / 2 : width;
  ClothRandom random;

  memset (data, 255, (gsize) width * height);
  cloth_random_init (&random, 5);
  for (gint b = 0; b < 400; b++) {
    const gdouble x = period * cloth_random_uniform (&random);
    const gdouble y = height * cloth_random_uniform (&random);
    const gdouble a = 2 + 9 * cloth_random_uniform (&random);
    const gdouble c = 2 + 9 * cloth_random_uniform (&random);
    const guint8 grey = (guint8) cloth_random_below (&random, 220);

    for (gint j = 0; j < height; j++)
      for (gint i = 0; i < width; i++) {
        gdouble dx = fmod (i - x + 2.5 * period, period) - period / 2.0;
        const gdouble dy = j - y;

        if (dx * dx / (a * a) + dy * dy / (c * c) < 1)
          data[j * width + i] = grey;
      }
  }
  return data;
}

static ClothReference *
from_picture (gint sides, gboolean repeated, GError ** error)
{
  g_autofree guint8 *data = draw (320, 240, repeated);
  const ClothCvPicture picture = { data, 320, 240, 320 };
  ClothReferenceParams params = cloth_reference_default_params ();

  params.cloth_m[0] = 0.32;
  params.cloth_m[1] = 0.24;
  params.sides = sides;
  return cloth_reference_new (&params, &picture, NULL, error);
}

/* Features of squeezed and mirrored views lie where those of the flat one do, as far as both
 * have them: by chance that is one in twenty. */
static void
test_views (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothReference) reference = from_picture (2, FALSE, &error);
  const ClothReferenceFeatures *f;
  guint n[2][CLOTH_REFERENCE_VIEWS] = { {0} }, near[2][CLOTH_REFERENCE_VIEWS] =
      { {0} };

  g_assert_no_error (error);
  f = cloth_reference_get_features (reference);
  g_assert_cmpfloat_with_epsilon (cloth_reference_get_metres_per_pixel
      (reference), 0.001, 1e-12);
  for (guint i = 0; i < f->n; i++) {
    gboolean found = FALSE;

    for (guint k = 0; k < f->n && !found; k++)
      found = f->view[k] == 0 && f->side[k] == 0 && hypotf (f->x[k] - f->x[i],
          f->y[k] - f->y[i]) < 2 && fabsf (logf (f->scale[k]
              / f->scale[i])) < 0.7f;
    n[f->side[i]][f->view[i]]++;
    near[f->side[i]][f->view[i]] += found;
  }
  for (guint side = 0; side < 2; side++)
    for (guint view = 0; view < 5; view++) {
      g_test_message ("side %u view %u: %u of %u", side, view,
          near[side][view], n[side][view]);
      g_assert_cmpuint (n[side][view], >, 50);
      g_assert_cmpfloat (near[side][view], >, (view ? 0.2 : 0.8)
          * n[side][view]);
    }
  g_assert_cmpuint (n[0][5], ==, 0);
}

static void
test_repeated (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothReference) once = from_picture (1, FALSE, &error);
  g_autoptr (ClothReference) twice = from_picture (1, TRUE, &error);

  g_assert_no_error (error);
  g_test_message ("%g, %g", cloth_reference_get_repeated (once),
      cloth_reference_get_repeated (twice));
  g_assert_cmpfloat (cloth_reference_get_repeated (once), <, 0.1);
  g_assert_cmpfloat (cloth_reference_get_repeated (twice), >,
      CLOTH_REFERENCE_REPEATED);
}

/* ---- what can't be ---- */

static void
refuse (ClothReferenceParams params, gint width, gint height,
    const gchar * words)
{
  g_autofree guint8 *data = g_malloc0 (64 * 64);
  const ClothCvPicture picture = { data, width, height, 64 };
  g_autoptr (GError) error = NULL;

  g_assert_null (cloth_reference_new (&params, &picture, NULL, &error));
  g_assert_nonnull (error);
  g_assert_nonnull (strstr (error->message, words));
}

static void
test_bad_reference (void)
{
  ClothReferenceParams params = cloth_reference_default_params ();

  refuse (params, 64, 64, "no size");
  params.cloth_m[0] = NAN;
  params.cloth_m[1] = 1;
  refuse (params, 64, 64, "no size");
  params.cloth_m[0] = 2;
  refuse (params, 64, 64, "are no picture of");
  params.cloth_m[0] = 1;
  refuse (params, 64, 64, "no feature");
  refuse (params, 1, 1, "can't be a reference");
  params.sides = 3;
  refuse (params, 64, 64, "sides");
  params.sides = 1;
  params.noise = NAN;
  refuse (params, 64, 64, "noise");
  params.noise = 2;
  params.sift.sigma = -1;
  refuse (params, 64, 64, "sigma");
}

/* @n features of @film at these places: nothing crashes, and what is matched is allowed. */
static void
check_few (guint n, const gfloat * x, const gfloat * y)
{
  g_autofree Print *print = print_new (1, 1);
  g_autoptr (ClothReference) reference = reference_new (print);
  g_autofree Film *film = film_new (print, plane, FALSE);

  film->features.n = n;
  for (guint i = 0; i < n; i++) {
    film->x[i] = x[i];
    film->y[i] = y[i];
  }
  for (gint surface = 0; surface < 2; surface++) {
    g_autofree Result *result = match (reference, print, film, surface);

    g_assert_cmpuint (result->verification.n_verified, ==, 0);
    g_assert_cmpuint (result->growth.n_seeds, <=, n);
  }
}

static void
test_few (void)
{
  gfloat x[N], y[N];

  check_few (0, NULL, NULL);
  for (guint i = 0; i < N; i++)
    x[i] = y[i] = 240;
  check_few (1, x, y);
  check_few (500, x, y);
}

/* Matches on one line have no triangle; each neighbour along it votes. */
static void
test_line (void)
{
  g_autofree Print *print = print_new (1, 1);
  g_autofree Film *film = NULL;
  g_autoptr (ClothReference) reference = NULL;
  const ClothReferenceFeatures *r;
  ClothVerifyParams params = cloth_verify_default_params ();
  g_autoptr (ClothVerifier) verifier = cloth_verifier_new ();
  ClothMatch matches[3];
  ClothVerification verification;

  for (guint i = 0; i < 3; i++) {
    print->x[i] = (gfloat) (100 + 10 * i);
    print->y[i] = 200;
  }
  print->n = 3;
  reference = reference_new (print);
  r = cloth_reference_get_features (reference);
  film = film_new (print, plane, FALSE);
  for (guint i = 0; i < 3; i++) {
    guint k = 0;

    while (r->x[k] != print->x[film->of[i]])
      k++;
    matches[i] = (ClothMatch) {
    CLOTH_MATCH_MATCHED, k, 0, 0};
  }
  params.support = 1;
  cloth_verifier_run (verifier, &params, reference, &film->features,
      &film->surface, matches, &verification, NULL);
  g_assert_cmpuint (verification.n_verified, ==, 3);
  /* where its neighbour is */
  matches[2].reference = matches[1].reference;
  cloth_verifier_run (verifier, &params, reference, &film->features,
      &film->surface, matches, &verification, NULL);
  g_assert_cmpuint (verification.n_verified, <, 3);
}

/* A surface that isn't known anywhere, or parameters that are no numbers. */
static void
test_no_surface (void)
{
  g_autofree Print *print = print_new (1, 1);
  g_autoptr (ClothReference) reference = reference_new (print);
  g_autofree Film *film = film_new (print, plane, FALSE);
  g_autofree Result *result = NULL;
  g_autoptr (ClothGrower) grower = cloth_grower_new ();
  ClothGrowParams params = cloth_grow_default_params ();

  for (gsize i = 0; i < 3 * WIDTH * WIDTH; i++)
    film->points[i] = NAN;
  result = match (reference, print, film, TRUE);
  g_assert_cmpuint (result->verification.n_verified, ==, 0);
  params.radius = params.distance = params.turn = params.zoom = NAN;
  params.stretch.stretch = params.stretch.hidden = NAN;
  cloth_grower_run (grower, &params, reference, &film->features, NULL,
      result->matches, &result->growth, NULL, CLOTH_SIMD_BEST);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/match/plane", test_plane);
  g_test_add_func ("/match/cylinder", test_cylinder);
  g_test_add_func ("/match/fold", test_fold);
  g_test_add_func ("/match/length", test_length);
  g_test_add_func ("/match/outside", test_outside);
  g_test_add_func ("/match/refuse", test_refuse);
  g_test_add_func ("/match/refuse-group", test_refuse_group);
  g_test_add_func ("/match/refuse-alone", test_refuse_alone);
  g_test_add_func ("/match/memory", test_memory);
  g_test_add_func ("/match/crowd", test_crowd);
  g_test_add_func ("/match/back", test_back);
  g_test_add_func ("/match/same", test_same);
  g_test_add_func ("/match/same-refused", test_same_refused);
  g_test_add_func ("/match/views", test_views);
  g_test_add_func ("/match/repeated", test_repeated);
  g_test_add_func ("/match/bad-reference", test_bad_reference);
  g_test_add_func ("/match/few", test_few);
  g_test_add_func ("/match/line", test_line);
  g_test_add_func ("/match/no-surface", test_no_surface);
  return g_test_run ();
}
