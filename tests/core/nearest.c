/* The nearest descriptors, against a search that compares byte by byte: every level of
 * vector instructions, every number of threads, numbers that fill no block.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/feature/nearest.h"

#include <string.h>

#include "gst/math/random.h"
#include "gst/vision/feature/nearest-private.h"

#define BYTES CLOTH_NEAREST_BYTES

static const ClothSimd levels[] = { CLOTH_SIMD_SCALAR, CLOTH_SIMD_AVX2,
  CLOTH_SIMD_AVX512, CLOTH_SIMD_BEST
};

/* @span: values of a byte, so that few make many equal distances
 *
 * One array of just this size, for the sanitizers to see what is read beyond it.
 */
static guint8 *
descriptors (guint n, guint span, guint64 seed)
{
  guint8 *data = g_malloc (MAX (n, 1) * BYTES);
  ClothRandom random;

  cloth_random_init (&random, seed);
  for (guint i = 0; i < n * BYTES; i++)
    data[i] = (guint8) (255 - cloth_random_below (&random, span));
  return data;
}

static guint32
distance (const guint8 * a, const guint8 * b)
{
  guint32 sum = 0;

  for (gint k = 0; k < BYTES; k++)
    sum += (guint32) ((a[k] - b[k]) * (a[k] - b[k]));
  return sum;
}

/* The nearest but @not. */
static void
find (const guint8 * query, const guint8 * references, guint n, guint32 not,
    guint32 * index, guint32 * least)
{
  *index = *least = CLOTH_NEAREST_NONE;
  for (guint i = 0; i < n; i++)
    if (i != not && distance (query, references + i * BYTES) < *least) {
      *index = i;
      *least = distance (query, references + i * BYTES);
    }
}

static void
check (const guint8 * references, guint n, const guint8 * queries, guint m)
{
  g_autoptr (ClothNearest) nearest = cloth_nearest_new (references, n);
  g_autofree ClothNeighbours *truth = g_new0 (ClothNeighbours, m);
  g_autofree ClothNeighbours *found = g_new0 (ClothNeighbours, m + 1);

  for (guint i = 0; i < m; i++) {
    const guint8 *query = queries + i * BYTES;
    ClothNeighbours *t = &truth[i];

    find (query, references, n, CLOTH_NEAREST_NONE, &t->index, &t->distance);
    find (query, references, n, t->index, &t->second, &t->second_distance);
  }
  for (guint l = 0; l < G_N_ELEMENTS (levels); l++)
    for (guint threads = 0; threads < 4; threads++) {
      ClothPool *pool = threads ? cloth_pool_new (threads) : NULL;

      memset (found, 0x55, m * sizeof (ClothNeighbours));
      cloth_nearest_run (nearest, queries, m, found, pool, levels[l]);
      for (guint i = 0; i < m; i++) {
        g_assert_cmpuint (found[i].index, ==, truth[i].index);
        g_assert_cmpuint (found[i].distance, ==, truth[i].distance);
        g_assert_cmpuint (found[i].second, ==, truth[i].second);
        g_assert_cmpuint (found[i].second_distance, ==,
            truth[i].second_distance);
      }
      cloth_pool_free (pool);
    }
}

/* Blocks are of 16, taken by two, stretches of 64 blocks; queries by 8, shares of 512. */
static void
test_sizes (void)
{
  static const guint sizes[][2] = { {0, 9}, {1, 1}, {1, 8}, {2, 7}, {15, 9},
  {16, 16}, {17, 3}, {31, 8}, {33, 15}, {100, 511}, {129, 513}, {1024, 10},
  {1025, 11}, {2100, 1030}, {40, 0}, {0, 0}
  };

  for (guint i = 0; i < G_N_ELEMENTS (sizes); i++) {
    g_autofree guint8 *references = descriptors (sizes[i][0], 256, i);
    g_autofree guint8 *queries = descriptors (sizes[i][1], 256, 100 + i);

    check (references, sizes[i][0], queries, sizes[i][1]);
  }
}

/* Two values in a byte: most distances are those of several; the first of them counts. */
static void
test_ties (void)
{
  static const guint spans[] = { 1, 2, 3 };

  for (guint i = 0; i < G_N_ELEMENTS (spans); i++) {
    g_autofree guint8 *references = descriptors (1500, spans[i], 3);
    g_autofree guint8 *queries = descriptors (40, spans[i], 4);

    /* the same again: the second is as near as the first */
    memcpy (references + 700 * BYTES, references, 700 * BYTES);
    memcpy (queries, references + 650 * BYTES, 20 * BYTES);
    check (references, 1500, queries, 40);
  }
}

/* The farthest that descriptors can be: no sum overflows. */
static void
test_extremes (void)
{
  guint8 references[3 * BYTES], queries[3 * BYTES];
  const guint8 values[] = { 0, 255, 128 };
  g_autoptr (ClothNearest) nearest = NULL;
  ClothNeighbours found;

  for (gint i = 0; i < 3; i++) {
    memset (references + i * BYTES, values[i], BYTES);
    memset (queries + i * BYTES, values[2 - i], BYTES);
  }
  check (references, 3, queries, 3);
  check (references + BYTES, 1, queries + 2 * BYTES, 1);
  nearest = cloth_nearest_new (references + BYTES, 1);
  cloth_nearest_run (nearest, references, 1, &found, NULL, CLOTH_SIMD_BEST);
  g_assert_cmpuint (found.distance, ==, 128 * 255 * 255);
  g_assert_cmpuint (found.second, ==, CLOTH_NEAREST_NONE);
}

/* What the processor has is what is used, and no more than was asked for. */
static void
test_levels (void)
{
  const ClothSimd best = cloth_simd_resolve (CLOTH_SIMD_BEST);

  g_assert_true (cloth_nearest_find_kernel (CLOTH_SIMD_SCALAR) ==
      &cloth_nearest_kernel_scalar);
#ifdef __x86_64__
  if (best >= CLOTH_SIMD_AVX2)
    g_assert_true (cloth_nearest_find_kernel (CLOTH_SIMD_AVX2) ==
        &cloth_nearest_kernel_avx2);
  if (best >= CLOTH_SIMD_AVX512)
    g_assert_true (cloth_nearest_find_kernel (CLOTH_SIMD_AVX512) ==
        &cloth_nearest_kernel_avx512);
  g_assert_true ((cloth_nearest_find_kernel (CLOTH_SIMD_BEST) ==
          &cloth_nearest_kernel_vnni) == (best == CLOTH_SIMD_AVX512
          && __builtin_cpu_supports ("avx512vnni")));
#endif
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/nearest/sizes", test_sizes);
  g_test_add_func ("/nearest/ties", test_ties);
  g_test_add_func ("/nearest/extremes", test_extremes);
  g_test_add_func ("/nearest/levels", test_levels);
  return g_test_run ();
}
