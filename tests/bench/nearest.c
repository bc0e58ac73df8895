/* The nearest of 66,000 SIFT descriptors for each of 7,000, by all levels of vector
 * instructions, against OpenCV's matchers: the one that compares all, and k-d trees.
 *
 * The references are features of photographs of boards, turned and mirrored; the queries are
 * those of the same photographs a little smaller.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/feature/nearest.h"

#include "gst/cv/cv.h"
#include "tests/bench/clock.h"
#include "tests/common/picture.h"
#include "tests/reference/reference.h"

#define BYTES CLOTH_NEAREST_BYTES
#define N_REFERENCES 66000
#define N_QUERIES 7000
#define ROUNDS 5

/* Photographs of the left camera; the eleventh was never published. */
static const gint numbers[] = { 1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 13, 14 };

static void
add_features (GByteArray * all, ClothCvSift * sift, const guint8 * data,
    gint width, gint height, guint most)
{
  const ClothCvPicture picture = { data, width, height, width };
  ClothCvFeatures found;

  if (!cloth_cv_sift_run (sift, &picture, NULL, &found, NULL))
    g_error ("no features");
  g_byte_array_append (all, found.descriptors,
      MIN (found.n * BYTES, most * BYTES - all->len));
}

/* One of eight views: mirrored down, mirrored across, with rows as columns. */
static void
turn (const ClothImage * image, gint view, guint8 * to)
{
  for (gint y = 0; y < image->height; y++)
    for (gint x = 0; x < image->width; x++) {
      const gint u = view & 1 ? image->width - 1 - x : x;
      const gint v = view & 2 ? image->height - 1 - y : y;

      to[view & 4 ? u * image->height + v : v * image->width + u] =
          image->data[y * image->stride + x];
    }
}

static void
make_descriptors (GByteArray * references, GByteArray * queries)
{
  const ClothCvSiftParams params = { 3, 0.01, 20, 1.6 };
  g_autoptr (ClothCvSift) sift = cloth_cv_sift_new (&params, NULL);

  for (gint view = 0; view < 8; view++)
    for (guint i = 0; i < G_N_ELEMENTS (numbers); i++) {
      g_autofree gchar *path = g_strdup_printf ("%s/opencv_boards/left%02d.jpg",
          TEST_DATA, numbers[i]);
      g_autoptr (TestPicture) picture = test_picture_load (path);
      const ClothImage *image = &picture->image;
      g_autofree guint8 *turned = g_malloc (image->width * image->height);
      const gint width = view & 4 ? image->height : image->width;
      const gint height = view & 4 ? image->width : image->height;

      turn (image, view, turned);
      add_features (references, sift, turned, width, height, N_REFERENCES);
      if (view == 0) {
        const ClothCvPicture from = { turned, width, height, width };
        const gint w = width * 9 / 10, h = height * 9 / 10;
        g_autofree guint8 *small = g_malloc (w * h);

        cloth_cv_squeeze (&from, w, h, small, w, NULL);
        add_features (queries, sift, small, w, h, N_QUERIES);
      }
    }
}

static gdouble
seconds (void)
{
  return 1e-6 * (gdouble) g_get_monotonic_time ();
}

static void
time_peer (gboolean flann, const GByteArray * references,
    const GByteArray * queries, const ClothNeighbours * truth, gdouble own)
{
  const guint n = queries->len / BYTES;
  const gdouble start = seconds ();
  ClothCvMatcher *matcher = cloth_cv_matcher_new (references->data,
      references->len / BYTES, flann);
  g_autofree guint32 *nearest = g_new (guint32, n);
  const gdouble built = seconds (), began = cpu_ms ();
  guint n_right = 0;
  gdouble ms;

  if (!matcher || !cloth_cv_matcher_run (matcher, queries->data, n, nearest))
    g_error ("OpenCV failed");
  ms = cpu_ms () - began;
  for (guint i = 0; i < n; i++)
    n_right += nearest[i] == truth[i].index;
  g_print ("%s: %.0f ms, ratio to one thread %.1f; %.1f%% are the nearest; "
      "built in %.0f ms\n", flann ? "OpenCV's k-d trees" :
      "OpenCV's BFMatcher", ms, ms / own, 100. * n_right / n,
      1e3 * (built - start));
  cloth_cv_matcher_free (matcher);
}

int
main (int argc, char **argv)
{
  static const gchar *const names[] = { "scalar", "AVX2", "AVX-512", "best" };
  static const ClothSimd levels[] = { CLOTH_SIMD_SCALAR, CLOTH_SIMD_AVX2,
    CLOTH_SIMD_AVX512, CLOTH_SIMD_BEST
  };
  g_autoptr (GByteArray) references = g_byte_array_new ();
  g_autoptr (GByteArray) queries = g_byte_array_new ();
  g_autoptr (ClothNearest) nearest = NULL;
  g_autoptr (ClothPool) pool = cloth_pool_new (0);
  g_autofree ClothNeighbours *found = NULL;
  gdouble own = 0, both = G_MAXDOUBLE;
  guint n;

  test_picture_init (&argc, &argv);
  make_descriptors (references, queries);
  n = queries->len / BYTES;
  found = g_new (ClothNeighbours, n);
  nearest = cloth_nearest_new (references->data, references->len / BYTES);
  g_print ("%u descriptors among %u, best of %d\n", n, references->len / BYTES,
      ROUNDS);
  for (guint l = 0; l < G_N_ELEMENTS (levels); l++) {
    gdouble best = G_MAXDOUBLE;

    for (gint round = 0; round < (l ? ROUNDS : 1); round++) {
      const gdouble start = cpu_ms ();

      cloth_nearest_run (nearest, queries->data, n, found, NULL, levels[l]);
      best = MIN (best, cpu_ms () - start);
    }
    g_print ("%s, one thread: %.0f ms\n", names[l], best);
    own = best;
  }
  for (gint round = 0; round < ROUNDS; round++) {
    const gdouble start = seconds ();

    cloth_nearest_run (nearest, queries->data, n, found, pool, CLOTH_SIMD_BEST);
    both = MIN (both, 1e3 * (seconds () - start));
  }
  g_print ("best, %u threads: %.0f ms by the wall's clock\n",
      cloth_pool_get_n_threads (pool), both);
  time_peer (TRUE, references, queries, found, own);
  time_peer (FALSE, references, queries, found, own);
  return 0;
}
