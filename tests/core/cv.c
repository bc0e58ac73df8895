/* OpenCV behind gst/cv: features of blobs whose place and size are known, disparities of a
 * picture that was shifted, resampling of ramps; and what is refused.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/cv/cv.h"

#include <math.h>
#include <string.h>

#include "gst/math/random.h"

#define WIDTH 240
#define HEIGHT 180
#define STRIDE 251

/* A Gaussian spot. */
typedef struct
{
  gdouble x, y, size;
} Blob;

static const Blob blobs[] = {
  {60.25, 50.5, 3}, {150.75, 60.125, 5}, {190, 120, 4}, {80.5, 130.875, 8}
};

static guint8
grey (gdouble value)
{
  return (guint8) CLAMP (value + 0.5, 0, 255);
}

/* @slope: how the ground rises across and down */
static void
draw_blobs (guint8 * data, gdouble contrast, const gdouble slope[2])
{
  memset (data, 255, STRIDE * HEIGHT);
  for (gint y = 0; y < HEIGHT; y++)
    for (gint x = 0; x < WIDTH; x++) {
      gdouble value = 80 + slope[0] * (x - 120) + slope[1] * (y - 90);

      for (guint i = 0; i < G_N_ELEMENTS (blobs); i++) {
        const gdouble dx = x - blobs[i].x, dy = y - blobs[i].y;

        value += contrast * exp (-(dx * dx + dy * dy) /
            (2 * blobs[i].size * blobs[i].size));
      }
      data[y * STRIDE + x] = grey (value);
    }
}

/* Index of the feature nearest to a place, within 2 px. */
static guint
find_feature (const ClothCvFeatures * features, gdouble x, gdouble y,
    gdouble scale)
{
  gdouble near = 2;
  guint best = G_MAXUINT;

  for (guint i = 0; i < features->n; i++) {
    const gdouble d = hypot (features->x[i] - x, features->y[i] - y) +
        fabs (features->scale[i] - scale);

    if (d < near) {
      near = d;
      best = i;
    }
  }
  g_assert_cmpuint (best, !=, G_MAXUINT);
  return best;
}

/* A key that D. Lowe's own program found in box.pgm. Its angles are those of a y that goes
 * up. */
typedef struct
{
  gdouble y, x, scale, angle;
  guint8 bytes[CLOTH_CV_SIFT_BYTES];
} Key;

static Key *
load_keys (const gchar * path, guint * n)
{
  g_autofree gchar *text = NULL;
  g_autoptr (GError) error = NULL;
  gchar *at;
  Key *keys;

  g_file_get_contents (path, &text, NULL, &error);
  g_assert_no_error (error);
  *n = (guint) g_ascii_strtoull (text, &at, 10);
  g_assert_cmpuint (g_ascii_strtoull (at, &at, 10), ==, CLOTH_CV_SIFT_BYTES);
  keys = g_new (Key, *n);
  for (guint i = 0; i < *n; i++) {
    Key *key = &keys[i];

    key->y = g_ascii_strtod (at, &at);
    key->x = g_ascii_strtod (at, &at);
    key->scale = g_ascii_strtod (at, &at);
    key->angle = -g_ascii_strtod (at, &at);
    for (guint k = 0; k < CLOTH_CV_SIFT_BYTES; k++)
      key->bytes[k] = (guint8) g_ascii_strtoull (at, &at, 10);
  }
  return keys;
}

/* Distance of descriptors: of 4 × 4 histograms of 8 angles; @mirrored: of one that was
 * described with its rows upside down. */
static gdouble
compare_bytes (const guint8 * a, const guint8 * b, gboolean mirrored)
{
  gint sum = 0;

  for (gint row = 0; row < 4; row++)
    for (gint k = 0; k < 32; k++) {
      const gint d = a[32 * row + k] - b[32 * (mirrored ? 3 - row : row) + k];

      sum += d * d;
    }
  return sqrt (sum);
}

/* The feature that a key is, within a pixel and a fifth of its scale; of several angles the
 * nearest. Its %n if there is none. */
static guint
find_key (const ClothCvFeatures * f, const Key * key, gdouble * turn)
{
  guint best = f->n;

  *turn = INFINITY;
  for (guint i = 0; i < f->n; i++) {
    const gdouble by = fabs (remainder (f->angle[i] - key->angle, 2 * G_PI));

    if (hypot (f->x[i] - key->x, f->y[i] - key->y) < 1
        && fabs (log (f->scale[i] / key->scale)) < log (1.2) && by < *turn) {
      *turn = by;
      best = i;
    }
  }
  return best;
}

/* Three quarters of what the inventor of the features finds is found, and is described as he
 * does it: a descriptor is 512 long, those of different things are some 500 apart. */
static void
test_sift_lowe (void)
{
  static const gint width = 324, height = 223;
  guint n, n_found = 0, n_turned = 0;
  g_autofree Key *keys = load_keys (TEST_DATA "/vlfeat_box/box.sift", &n);
  g_autofree gchar *file = NULL;
  g_autoptr (ClothCvSift) sift = cloth_cv_sift_new (NULL, NULL);
  g_autoptr (GError) error = NULL;
  gdouble sum = 0, sum_mirrored = 0;
  ClothCvPicture box = { NULL, width, height, width };
  ClothCvFeatures f;
  gsize length;

  g_file_get_contents (TEST_DATA "/vlfeat_box/box.pgm", &file, &length, &error);
  g_assert_no_error (error);
  g_assert_cmpuint (length, >, width * height);
  box.data = (const guint8 *) file + length - width * height;
  g_assert_true (cloth_cv_sift_run (sift, &box, NULL, &f, NULL));
  for (guint i = 0; i < n; i++) {
    gdouble turn;
    const guint k = find_key (&f, &keys[i], &turn);

    n_found += k < f.n;
    if (k == f.n || turn > 0.2)
      continue;
    n_turned++;
    sum += compare_bytes (f.descriptors + k * CLOTH_CV_SIFT_BYTES,
        keys[i].bytes, FALSE);
    sum_mirrored += compare_bytes (f.descriptors + k * CLOTH_CV_SIFT_BYTES,
        keys[i].bytes, TRUE);
  }
  g_test_message ("%u keys, %u features: %u found, %u with their angle, "
      "descriptors %.0f apart, mirrored %.0f", n, f.n, n_found, n_turned,
      sum / n_turned, sum_mirrored / n_turned);
  g_assert_cmpfloat (n_found, >, 0.7 * n);
  g_assert_cmpfloat (n_turned, >, 0.9 * n_found);
  g_assert_cmpfloat (sum / n_turned, <, 100);
  g_assert_cmpfloat (sum_mirrored / n_turned, >, 350);
}

/* The difference of Gaussians of σ and 2^(1/3)·σ answers a blob of size s most where
 * σ = 2^(-1/6)·s; SIFT takes pictures to be blurred by half a pixel already. */
static void
test_sift_blobs (void)
{
  g_autoptr (ClothCvSift) sift = cloth_cv_sift_new (NULL, NULL);
  g_autofree guint8 *data = g_malloc (STRIDE * HEIGHT);
  const ClothCvPicture picture = { data, WIDTH, HEIGHT, STRIDE };
  ClothCvFeatures found;
  GError *error = NULL;
  gdouble mean[2] = { 0, 0 }, flat[2] = { 0, 0 };

  draw_blobs (data, 100, flat);
  g_assert_true (cloth_cv_sift_run (sift, &picture, NULL, &found, &error));
  g_assert_no_error (error);
  for (guint i = 0; i < G_N_ELEMENTS (blobs); i++) {
    const Blob *b = &blobs[i];
    const gdouble scale = pow (2, -1 / 6.) * sqrt (b->size * b->size - 0.25);
    const guint at = find_feature (&found, b->x, b->y, scale);
    const gdouble dx = found.x[at] - b->x, dy = found.y[at] - b->y;

    g_test_message ("blob of %g px: off by %+.3f %+.3f px, scale %.3f of %.3f",
        b->size, dx, dy, found.scale[at], scale);
    g_assert_cmpfloat (hypot (dx, dy), <, 0.02 * b->size);
    g_assert_cmpfloat (fabs (found.scale[at] / scale - 1), <, 0.05);
    mean[0] += dx / G_N_ELEMENTS (blobs);
    mean[1] += dy / G_N_ELEMENTS (blobs);
  }
  g_assert_cmpfloat (fabs (mean[0]), <, 0.03);
  g_assert_cmpfloat (fabs (mean[1]), <, 0.03);
}

/* A faint blob on a steep ground: the strongest gradient is that of the ground, to one of
 * the 36 steps in which SIFT counts angles. The widest is too faint for its size. */
static void
test_sift_angles (void)
{
  static const gdouble angles[] = { 0, 0.1, 1, G_PI_2, 2.5, 4, 6 };
  const ClothCvSiftParams params = { 3, 0.005, 10, 1.6 };
  g_autoptr (ClothCvSift) sift = cloth_cv_sift_new (&params, NULL);
  g_autofree guint8 *data = g_malloc (STRIDE * HEIGHT);
  const ClothCvPicture picture = { data, WIDTH, HEIGHT, STRIDE };
  ClothCvFeatures found;

  for (guint i = 0; i < G_N_ELEMENTS (angles); i++)
    for (guint j = 0; j + 1 < G_N_ELEMENTS (blobs); j++) {
      const Blob *b = &blobs[j];
      const gdouble slope[2] = { 0.8 * cos (angles[i]), 0.8 * sin (angles[i]) };
      guint at;

      draw_blobs (data, 10, slope);
      g_assert_true (cloth_cv_sift_run (sift, &picture, NULL, &found, NULL));
      at = find_feature (&found, b->x, b->y, 0.89 * b->size);
      g_test_message ("%g px: %g for %g", b->size, found.angle[at], angles[i]);
      g_assert_cmpfloat (found.angle[at], >=, 0);
      g_assert_cmpfloat (found.angle[at], <, 2 * G_PI);
      g_assert_cmpfloat (fabs (sin ((found.angle[at] - angles[i]) / 2)), <,
          0.09);
    }
}

static void
draw_noise (guint8 * data, gint width, gint height, gint stride, guint64 seed)
{
  ClothRandom random;

  cloth_random_init (&random, seed);
  for (gint y = 0; y < height; y++)
    for (gint x = 0; x < width; x++)
      data[y * stride + x] = (guint8) cloth_random_below (&random, 256);
}

static gboolean
comes_before (const ClothCvFeatures * f, guint a, guint b)
{
  if (f->y[a] != f->y[b])
    return f->y[a] < f->y[b];
  if (f->x[a] != f->x[b])
    return f->x[a] < f->x[b];
  return f->scale[a] != f->scale[b] ? f->scale[a] < f->scale[b]
      : f->angle[a] < f->angle[b];
}

/* The same again, whatever ran between; whatever lies beyond a row; by y. */
static void
test_sift_order (void)
{
  g_autoptr (ClothCvSift) sift = cloth_cv_sift_new (NULL, NULL);
  g_autoptr (ClothCvSift) other = cloth_cv_sift_new (NULL, NULL);
  g_autofree guint8 *data = g_malloc (STRIDE * HEIGHT);
  g_autofree guint8 *dense = g_malloc (WIDTH * HEIGHT);
  const ClothCvPicture picture = { data, WIDTH, HEIGHT, STRIDE };
  const ClothCvPicture same = { dense, WIDTH, HEIGHT, WIDTH };
  const ClothCvPicture small = { dense, 33, 21, WIDTH };
  ClothCvFeatures a, b;

  memset (data, 255, STRIDE * HEIGHT);
  draw_noise (data, WIDTH, HEIGHT, STRIDE, 1);
  draw_noise (dense, WIDTH, HEIGHT, WIDTH, 1);
  g_assert_true (cloth_cv_sift_run (sift, &picture, NULL, &a, NULL));
  g_assert_true (cloth_cv_sift_run (other, &small, NULL, &b, NULL));
  g_assert_true (cloth_cv_sift_run (other, &same, NULL, &b, NULL));
  g_assert_cmpuint (a.n, >, 100);
  g_assert_cmpmem (a.x, a.n * sizeof (gfloat), b.x, b.n * sizeof (gfloat));
  g_assert_cmpmem (a.y, a.n * sizeof (gfloat), b.y, b.n * sizeof (gfloat));
  g_assert_cmpmem (a.scale, a.n * sizeof (gfloat), b.scale,
      b.n * sizeof (gfloat));
  g_assert_cmpmem (a.angle, a.n * sizeof (gfloat), b.angle,
      b.n * sizeof (gfloat));
  g_assert_cmpmem (a.descriptors, a.n * CLOTH_CV_SIFT_BYTES, b.descriptors,
      b.n * CLOTH_CV_SIFT_BYTES);
  for (guint i = 1; i < a.n; i++)
    g_assert_true (comes_before (&a, i - 1, i));
}

static void
test_sift_mask (void)
{
  g_autoptr (ClothCvSift) sift = cloth_cv_sift_new (NULL, NULL);
  g_autofree guint8 *data = g_malloc (STRIDE * HEIGHT);
  g_autofree guint8 *inside = g_malloc0 (STRIDE * HEIGHT);
  const ClothCvPicture picture = { data, WIDTH, HEIGHT, STRIDE };
  const ClothCvPicture mask = { inside, WIDTH, HEIGHT, STRIDE };
  ClothCvFeatures found;

  draw_noise (data, WIDTH, HEIGHT, STRIDE, 2);
  g_assert_true (cloth_cv_sift_run (sift, &picture, &mask, &found, NULL));
  g_assert_cmpuint (found.n, ==, 0);
  for (gint y = 0; y < HEIGHT; y++)
    memset (inside + y * STRIDE + 100, 1, 50);
  g_assert_true (cloth_cv_sift_run (sift, &picture, &mask, &found, NULL));
  g_assert_cmpuint (found.n, >, 10);
  for (guint i = 0; i < found.n; i++) {
    g_assert_cmpfloat (found.x[i], >=, 99);
    g_assert_cmpfloat (found.x[i], <=, 150);
  }
}

/* Of too many features the strongest are kept: those that a detector that asks for more
 * contrast would have found by itself, in the same order. */
static void
test_sift_keep (void)
{
  ClothCvSiftParams params = cloth_cv_sift_default_params ();
  g_autoptr (ClothCvSift) sift = cloth_cv_sift_new (&params, NULL);
  g_autoptr (ClothCvSift) strict = NULL;
  g_autofree guint8 *data = g_malloc (STRIDE * HEIGHT);
  const ClothCvPicture picture = { data, WIDTH, HEIGHT, STRIDE };
  ClothCvFeatures strong, kept;
  guint n;

  draw_noise (data, WIDTH, HEIGHT, STRIDE, 3);
  g_assert_true (cloth_cv_sift_run (sift, &picture, NULL, &kept, NULL));
  g_assert_cmpuint (cloth_cv_sift_get_n_dropped (sift), ==, 0);
  n = kept.n;
  params.contrast = 0.2;
  strict = cloth_cv_sift_new (&params, NULL);
  g_assert_true (cloth_cv_sift_run (strict, &picture, NULL, &strong, NULL));
  g_assert_cmpuint (strong.n, >, 20);
  g_assert_cmpuint (strong.n, <, n - 20);

  cloth_cv_sift_keep (sift, strong.n);
  g_assert_true (cloth_cv_sift_run (sift, &picture, NULL, &kept, NULL));
  g_assert_cmpuint (kept.n, ==, strong.n);
  g_assert_cmpuint (cloth_cv_sift_get_n_dropped (sift), ==, n - strong.n);
  g_assert_cmpmem (kept.x, kept.n * sizeof (gfloat), strong.x,
      strong.n * sizeof (gfloat));
  g_assert_cmpmem (kept.descriptors, kept.n * CLOTH_CV_SIFT_BYTES,
      strong.descriptors, strong.n * CLOTH_CV_SIFT_BYTES);

  cloth_cv_sift_keep (sift, n);
  g_assert_true (cloth_cv_sift_run (sift, &picture, NULL, &kept, NULL));
  g_assert_cmpuint (kept.n, ==, n);
  g_assert_cmpuint (cloth_cv_sift_get_n_dropped (sift), ==, 0);
}

/* Pictures in which nothing can be. */
static void
test_sift_nothing (void)
{
  static const gint sizes[][2] = { {1, 1}, {1, 100}, {100, 1}, {2, 3}, {7, 7},
  {64, 48}
  };
  g_autoptr (ClothCvSift) sift = cloth_cv_sift_new (NULL, NULL);
  g_autofree guint8 *data = g_malloc0 (STRIDE * HEIGHT);
  ClothCvFeatures found;

  for (guint i = 0; i < G_N_ELEMENTS (sizes); i++) {
    const ClothCvPicture picture = { data, sizes[i][0], sizes[i][1], STRIDE };
    GError *error = NULL;

    g_assert_true (cloth_cv_sift_run (sift, &picture, NULL, &found, &error));
    g_assert_no_error (error);
    g_assert_cmpuint (found.n, ==, 0);
  }
}

#define ASSERT_REFUSED(call, code, text) G_STMT_START { \
  GError *error = NULL; \
  g_assert_false (call); \
  g_assert_error (error, CLOTH_CV_ERROR, code); \
  g_test_message ("%s", error->message); \
  g_assert_nonnull (strstr (error->message, text)); \
  g_clear_error (&error); \
} G_STMT_END

static void
test_sift_refused (void)
{
  static const ClothCvSiftParams params[] = {
    {0, 0.04, 10, 1.6}, {9, 0.04, 10, 1.6}, {3, -1, 10, 1.6}, {3, 2, 10, 1.6},
    {3, NAN, 10, 1.6}, {3, 0.04, 0, 1.6}, {3, 0.04, INFINITY, 1.6},
    {3, 0.04, NAN, 1.6}, {3, 0.04, 10, 0.1}, {3, 0.04, 10, NAN}
  };
  static const gchar *const names[] = { "n_layers", "n_layers", "contrast",
    "contrast", "contrast", "edge", "edge", "edge", "sigma", "sigma"
  };
  g_autoptr (ClothCvSift) sift = cloth_cv_sift_new (NULL, NULL);
  guint8 data[64] = { 0 };
  const ClothCvPicture bad[] = { {NULL, 8, 8, 8}, {data, 0, 8, 8},
  {data, 8, -1, 8}, {data, 8, 8, 7}, {data, 8, 8, -8}, {data, 16385, 1, 16385},
  {data, 5000, 5000, 5000}
  };
  const ClothCvPicture good = { data, 8, 8, 8 }, other = { data, 8, 7, 8 };
  ClothCvFeatures found;

  for (guint i = 0; i < G_N_ELEMENTS (params); i++)
    ASSERT_REFUSED (cloth_cv_sift_new (&params[i], &error),
        CLOTH_CV_ERROR_PARAMETER, names[i]);
  for (guint i = 0; i < G_N_ELEMENTS (bad); i++) {
    ASSERT_REFUSED (cloth_cv_sift_run (sift, &bad[i], NULL, &found, &error),
        CLOTH_CV_ERROR_PICTURE, "");
    ASSERT_REFUSED (cloth_cv_sift_run (sift, &good, &bad[i], &found, &error),
        CLOTH_CV_ERROR_PICTURE, "");
  }
  ASSERT_REFUSED (cloth_cv_sift_run (sift, &good, &other, &found, &error),
      CLOTH_CV_ERROR_PICTURE, "mask");
  g_assert_cmpuint (found.n, ==, 0);
  g_assert_true (cloth_cv_sift_run (sift, &good, NULL, &found, NULL));
}

/* ---- block matching ---- */

/* A random print; what is at x in the left picture is at x less the shift in the right
 * one. */
static void
test_stereo_shift (void)
{
  enum
  { LEFT = 300, ROWS = 90, APART = 310 };
  static const gdouble shifts[] = { 20, 37, 30.5, 12.25 };
  g_autofree guint8 *left = g_malloc (APART * ROWS);
  g_autofree guint8 *right = g_malloc (APART * ROWS);
  g_autofree gint16 *found = g_new (gint16, LEFT * ROWS);
  const ClothCvPicture pictures[2] = { {left, LEFT, ROWS, APART},
  {right, LEFT, ROWS, APART}
  };
  ClothCvStereoParams params = cloth_cv_stereo_default_params ();
  g_autoptr (ClothCvStereo) stereo = NULL;
  ClothRandom random;
  gdouble phases[40];

  params.range = 64;
  stereo = cloth_cv_stereo_new (&params, NULL);
  cloth_random_init (&random, 3);
  for (guint i = 0; i < G_N_ELEMENTS (phases); i++)
    phases[i] = 6.2832 * cloth_random_uniform (&random);
  for (guint s = 0; s < G_N_ELEMENTS (shifts); s++) {
    guint n_seen = 0, n_wrong = 0, n = 0;
    gdouble sum = 0;

    for (gint side = 0; side < 2; side++)
      for (gint y = 0; y < ROWS; y++)
        for (gint x = 0; x < LEFT; x++) {
          const gdouble u = x + (side ? shifts[s] : 0);
          gdouble value = 128;

          for (gint k = 0; k < 40; k++)
            value += 12 * cos (phases[k] + u * (0.02 * k + 0.05) *
                cos (k * 1.7) + y * (0.02 * k + 0.05) * sin (k * 1.7));
          (side ? right : left)[y * APART + x] = grey (value);
        }
    g_assert_true (cloth_cv_stereo_run (stereo, &pictures[0], &pictures[1],
            found, NULL));
    for (gint y = 5; y < ROWS - 5; y++)
      for (gint x = 70; x < LEFT - 5; x++) {
        const gint16 d = found[y * LEFT + x];

        n++;
        g_assert_true (d >= 0 || d == CLOTH_CV_NO_DISPARITY);
        if (d < 0)
          continue;
        n_seen++;
        n_wrong += fabs (d - CLOTH_CV_STEPS * shifts[s]) > CLOTH_CV_STEPS / 2;
        sum += d / (gdouble) CLOTH_CV_STEPS - shifts[s];
      }
    g_test_message ("%g px: %.1f%% seen, %.2f%% wrong, mean off by %+.3f px",
        shifts[s], 100. * n_seen / n, 100. * n_wrong / n_seen, sum / n_seen);
    g_assert_cmpuint (n_seen, >, 95 * n / 100);
    g_assert_cmpuint (n_wrong, <=, n / 100);
    /* a parabola through three costs draws quarters towards whole pixels */
    g_assert_cmpfloat (fabs (sum / n_seen), <, 0.25);
  }
}

/* Nothing to be seen gives nothing, also where disparities begin above zero. */
static void
test_stereo_nothing (void)
{
  g_autofree guint8 *data = g_malloc0 (WIDTH * HEIGHT);
  g_autofree guint8 *noise = g_malloc (WIDTH * HEIGHT);
  g_autofree gint16 *found = g_new (gint16, WIDTH * HEIGHT);
  const ClothCvPicture picture = { noise, WIDTH, HEIGHT, WIDTH };
  const ClothCvPicture dark = { data, WIDTH, HEIGHT, WIDTH };
  ClothCvStereoParams params = cloth_cv_stereo_default_params ();
  g_autoptr (ClothCvStereo) stereo = NULL;
  guint n = 0;

  params.least = 40;
  params.range = 32;
  stereo = cloth_cv_stereo_new (&params, NULL);
  draw_noise (noise, WIDTH, HEIGHT, WIDTH, 5);
  g_assert_true (cloth_cv_stereo_run (stereo, &picture, &dark, found, NULL));
  for (gint i = 0; i < WIDTH * HEIGHT; i++) {
    g_assert_true (found[i] == CLOTH_CV_NO_DISPARITY
        || (found[i] >= 40 * CLOTH_CV_STEPS && found[i] < 72 * CLOTH_CV_STEPS));
    n += found[i] != CLOTH_CV_NO_DISPARITY;
  }
  g_assert_cmpuint (n, <, WIDTH * HEIGHT / 10);
}

static void
test_stereo_refused (void)
{
  typedef struct
  {
    gsize at;
    gint value;
    const gchar *name;
  } Change;
  static const Change changes[] = {
    {G_STRUCT_OFFSET (ClothCvStereoParams, least), -1, "least"},
    {G_STRUCT_OFFSET (ClothCvStereoParams, least), 5000, "least"},
    {G_STRUCT_OFFSET (ClothCvStereoParams, range), 0, "range"},
    {G_STRUCT_OFFSET (ClothCvStereoParams, range), 24, "multiple of 16"},
    {G_STRUCT_OFFSET (ClothCvStereoParams, window), 4, "odd"},
    {G_STRUCT_OFFSET (ClothCvStereoParams, window), -3, "window"},
    {G_STRUCT_OFFSET (ClothCvStereoParams, small_step), -1, "small_step"},
    {G_STRUCT_OFFSET (ClothCvStereoParams, large_step), 1, "large_step"},
    {G_STRUCT_OFFSET (ClothCvStereoParams, left_right), 256, "left_right"},
    {G_STRUCT_OFFSET (ClothCvStereoParams, uniqueness), 101, "uniqueness"},
    {G_STRUCT_OFFSET (ClothCvStereoParams, speckle_area), -1, "speckle_area"},
    {G_STRUCT_OFFSET (ClothCvStereoParams, speckle_step), 0, "speckle_step"}
  };
  g_autoptr (ClothCvStereo) stereo = cloth_cv_stereo_new (NULL, NULL);
  guint8 data[256] = { 0 };
  gint16 found[256];
  const ClothCvPicture a = { data, 16, 16, 16 }, b = { data, 16, 15, 16 };
  const ClothCvPicture one = { data, 1, 1, 1 }, torn = { data, 16, 16, 15 };

  for (guint i = 0; i < G_N_ELEMENTS (changes); i++) {
    ClothCvStereoParams params = cloth_cv_stereo_default_params ();

    G_STRUCT_MEMBER (gint, &params, changes[i].at) = changes[i].value;
    ASSERT_REFUSED (cloth_cv_stereo_new (&params, &error),
        CLOTH_CV_ERROR_PARAMETER, changes[i].name);
  }
  ASSERT_REFUSED (cloth_cv_stereo_run (stereo, &a, &b, found, &error),
      CLOTH_CV_ERROR_PICTURE, "right one");
  ASSERT_REFUSED (cloth_cv_stereo_run (stereo, &a, &a, found, &error),
      CLOTH_CV_ERROR_PICTURE, "too small");
  ASSERT_REFUSED (cloth_cv_stereo_run (stereo, &one, &one, found, &error),
      CLOTH_CV_ERROR_PICTURE, "too small");
  ASSERT_REFUSED (cloth_cv_stereo_run (stereo, &torn, &a, found, &error),
      CLOTH_CV_ERROR_PICTURE, "bytes apart");
  ASSERT_REFUSED (cloth_cv_stereo_run (stereo, &a, &torn, found, &error),
      CLOTH_CV_ERROR_PICTURE, "bytes apart");
}

/* OpenCV's sums have 16 bits: what is let through keeps below them, whatever the window. Black
 * and white noise of a known shift beside noise that nothing matches; more is refused. */
static void
test_stereo_sums (void)
{
  enum
  { LEFT = 500, ROWS = 80, SHIFT = 20, STRIPE = 100 };
  static const gint windows[] = { 3, 7, 19, 25, 31 };
  g_autofree guint8 *left = g_malloc (LEFT * ROWS);
  g_autofree guint8 *right = g_malloc (LEFT * ROWS);
  g_autofree gint16 *found = g_new (gint16, LEFT * ROWS);
  const ClothCvPicture a = { left, LEFT, ROWS, LEFT };
  const ClothCvPicture b = { right, LEFT, ROWS, LEFT };
  ClothRandom random;

  cloth_random_init (&random, 4);
  for (gint i = 0; i < LEFT * ROWS; i++)
    right[i] = (guint8) (255 * cloth_random_below (&random, 2));
  for (gint i = 0; i < LEFT * ROWS; i++)
    left[i] = i % LEFT >= SHIFT && i % LEFT / STRIPE % 2 == 0 ?
        right[i - SHIFT] : (guint8) (255 * cloth_random_below (&random, 2));
  for (guint k = 0; k < G_N_ELEMENTS (windows); k++) {
    const gint area = windows[k] * windows[k];
    ClothCvStereoParams params = cloth_cv_stereo_default_params ();
    g_autoptr (ClothCvStereo) stereo = NULL;
    guint n = 0, n_right = 0;

    params.range = 64;
    params.window = windows[k];
    params.large_step = 28000 - 16 * area;
    params.speckle_area = 0;
    stereo = cloth_cv_stereo_new (&params, NULL);
    g_assert_true (cloth_cv_stereo_run (stereo, &a, &b, found, NULL));
    for (gint y = 20; y < ROWS - 20; y++)
      for (gint x = 2 * STRIPE; x < 5 * STRIPE; x++)
        if (x / STRIPE % 2 == 0 && x % STRIPE > 40 && x % STRIPE < 80) {
          n++;
          n_right += ABS (found[y * LEFT + x] - CLOTH_CV_STEPS * SHIFT) <= 8;
        }
    g_test_message ("blocks of %d px: %u of %u right", windows[k], n_right, n);
    g_assert_cmpuint (n_right, ==, n);
    params.large_step++;
    ASSERT_REFUSED (cloth_cv_stereo_new (&params, &error),
        CLOTH_CV_ERROR_PARAMETER, "large_step");
  }
}

/* The smallest pictures that are let through, for the sanitizers to see. */
static void
test_stereo_smallest (void)
{
  static const gint windows[] = { 1, 3, 7, 11 };

  for (guint i = 0; i < G_N_ELEMENTS (windows); i++) {
    ClothCvStereoParams params = cloth_cv_stereo_default_params ();
    g_autoptr (ClothCvStereo) stereo = NULL;
    const gint width = 5 + 16 + windows[i] + 1, height = windows[i];
    g_autofree guint8 *data = g_malloc (width * height);
    g_autofree gint16 *found = g_new (gint16, width * height);
    const ClothCvPicture picture = { data, width, height, width };

    params.least = 5;
    params.range = 16;
    params.window = windows[i];
    stereo = cloth_cv_stereo_new (&params, NULL);
    draw_noise (data, width, height, width, 7);
    g_assert_true (cloth_cv_stereo_run (stereo, &picture, &picture, found,
            NULL));
  }
}

/* ---- resampling ---- */

static void
test_remap (void)
{
  enum
  { N = 20, TO = 13, ROWS = 7, APART = 17 };
  guint8 data[N * (N + 3)], made[ROWS * APART];
  gfloat x[TO * ROWS], y[TO * ROWS];
  const ClothCvPicture picture = { data, N, N, N + 3 };

  memset (made, 77, sizeof (made));
  for (gint v = 0; v < N; v++)
    for (gint u = 0; u < N + 3; u++)
      data[v * (N + 3) + u] = u < N ? (guint8) (8 * u + 4 * v) : 255;
  for (gint i = 0; i < TO * ROWS; i++) {
    x[i] = 1.25f + (gfloat) (i % TO);
    y[i] = 2.5f + (gfloat) (i / TO);
  }
  x[0] = NAN;
  y[1] = NAN;
  x[2] = INFINITY;
  y[3] = -INFINITY;
  x[4] = 1e30f;
  y[5] = -100;
  g_assert_true (cloth_cv_remap (&picture, x, y, TO, ROWS, made, APART, NULL));
  for (gint i = 0; i < TO * ROWS; i++)
    g_assert_cmpint (made[i / TO * APART + i % TO], ==,
        i < 6 ? 0 : (gint) (8 * x[i] + 4 * y[i]));
  for (gint v = 0; v < ROWS; v++)
    for (gint u = TO; u < APART; u++)
      g_assert_cmpint (made[v * APART + u], ==, 77);
}

/* A ramp stays one; its pixels lie where they are said to. */
static void
test_squeeze (void)
{
  enum
  { N = 60, ROWS = 30, APART = 33 };
  guint8 data[N * ROWS], made[ROWS * APART];
  const ClothCvPicture picture = { data, N, ROWS, N };

  for (gint y = 0; y < ROWS; y++)
    for (gint x = 0; x < N; x++)
      data[y * N + x] = (guint8) (4 * x);
  memset (made, 77, sizeof (made));
  g_assert_true (cloth_cv_squeeze (&picture, 30, 15, made, APART, NULL));
  for (gint y = 0; y < 15; y++) {
    for (gint x = 0; x < 30; x++)
      g_assert_cmpint (made[y * APART + x], ==, 4 * (2 * x) + 2);
    g_assert_cmpint (made[y * APART + 30], ==, 77);
  }
  g_assert_true (cloth_cv_squeeze (&picture, 24, 30, made, APART, NULL));
  for (gint x = 0; x < 24; x++)
    g_assert_cmpfloat (fabs (made[x] - 4 * ((x + 0.5) * 2.5 - 0.5)), <=, 0.6);
}

static void
test_resampling_refused (void)
{
  guint8 data[64] = { 0 }, made[64];
  gfloat place[64] = { 0 };
  const ClothCvPicture good = { data, 8, 8, 8 }, torn = { data, 8, 8, 7 };
  const ClothCvPicture none = { NULL, 8, 8, 8 };

  ASSERT_REFUSED (cloth_cv_remap (&torn, place, place, 8, 8, made, 8, &error),
      CLOTH_CV_ERROR_PICTURE, "bytes apart");
  ASSERT_REFUSED (cloth_cv_remap (&good, place, place, 8, 8, made, 7, &error),
      CLOTH_CV_ERROR_PICTURE, "bytes apart");
  ASSERT_REFUSED (cloth_cv_remap (&good, place, place, 0, 8, made, 8, &error),
      CLOTH_CV_ERROR_PICTURE, "possible");
  ASSERT_REFUSED (cloth_cv_remap (&good, place, place, 8, 8, NULL, 8, &error),
      CLOTH_CV_ERROR_PICTURE, "possible");
  ASSERT_REFUSED (cloth_cv_squeeze (&none, 4, 4, made, 4, &error),
      CLOTH_CV_ERROR_PICTURE, "possible");
  ASSERT_REFUSED (cloth_cv_squeeze (&good, 9, 4, made, 9, &error),
      CLOTH_CV_ERROR_PICTURE, "squeezed");
  ASSERT_REFUSED (cloth_cv_squeeze (&good, 4, 0, made, 9, &error),
      CLOTH_CV_ERROR_PICTURE, "possible");
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/cv/sift/blobs", test_sift_blobs);
  g_test_add_func ("/cv/sift/angles", test_sift_angles);
  g_test_add_func ("/cv/sift/lowe", test_sift_lowe);
  g_test_add_func ("/cv/sift/order", test_sift_order);
  g_test_add_func ("/cv/sift/mask", test_sift_mask);
  g_test_add_func ("/cv/sift/keep", test_sift_keep);
  g_test_add_func ("/cv/sift/nothing", test_sift_nothing);
  g_test_add_func ("/cv/sift/refused", test_sift_refused);
  g_test_add_func ("/cv/stereo/shift", test_stereo_shift);
  g_test_add_func ("/cv/stereo/nothing", test_stereo_nothing);
  g_test_add_func ("/cv/stereo/refused", test_stereo_refused);
  g_test_add_func ("/cv/stereo/smallest", test_stereo_smallest);
  g_test_add_func ("/cv/stereo/sums", test_stereo_sums);
  g_test_add_func ("/cv/remap", test_remap);
  g_test_add_func ("/cv/squeeze", test_squeeze);
  g_test_add_func ("/cv/resampling-refused", test_resampling_refused);
  return g_test_run ();
}
