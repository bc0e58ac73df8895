/* The nearest of many descriptors: all are compared, in the order in which the processor's
 * caches and its products of bytes like it best.
 *
 * A k-d tree (best-bin-first, as in Pritchard and Heidrich 2003, 4.2.1) looks at fewer of
 * them, but in the time that this takes misses one in ten of the nearest.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/feature/nearest.h"

#include <string.h>

#include "gst/vision/feature/nearest-private.h"

#define LANES CLOTH_NEAREST_LANES
#define QUERIES CLOTH_NEAREST_QUERIES
/* Blocks that stay in the second cache while a share of the queries is held against them:
 * 128 KiB, of queries 64 KiB. */
#define STRETCH 64
#define SHARE 512

struct _ClothNearest
{
  guint n, n_blocks;            /* an even number of blocks */
  guint8 *blocks;
  gint32 *offsets;
};

typedef struct
{
  const ClothNearest *nearest;
  const ClothNearestKernel *kernel;
  const guint8 *queries;
  guint n;
  ClothNeighbours *found;
} Search;

/* @descriptors: (array): @n times %CLOTH_NEAREST_BYTES, which are copied
 * @n: how many, also none
 *
 * Returns: (transfer full): reference descriptors, for any number of threads at a time
 */
ClothNearest *
cloth_nearest_new (const guint8 * descriptors, guint n)
{
  ClothNearest *nearest = g_new0 (ClothNearest, 1);
  const guint n_blocks = n / LANES + (n % LANES != 0);

  nearest->n = n;
  nearest->n_blocks = n_blocks + n_blocks % 2;
  nearest->blocks = g_aligned_alloc0 (MAX (nearest->n_blocks, 1),
      CLOTH_NEAREST_BLOCK, 64);
  nearest->offsets = g_new (gint32, (gsize) nearest->n_blocks * LANES);
  for (gsize i = 0; i < (gsize) nearest->n_blocks * LANES; i++) {
    guint8 *to = nearest->blocks + i / LANES * CLOTH_NEAREST_BLOCK +
        4 * (i % LANES);
    gint32 squares = 0, sum = 0;

    nearest->offsets[i] = G_MAXINT32;
    if (i >= n)
      continue;
    for (gint k = 0; k < CLOTH_NEAREST_BYTES; k++) {
      const gint32 value = descriptors[i * CLOTH_NEAREST_BYTES + (gsize) k];

      to[k / 4 * 4 * LANES + k % 4] = (guint8) value;
      squares += value * value;
      sum += value;
    }
    nearest->offsets[i] = squares - 256 * sum;
  }
  return nearest;
}

/* @nearest: (nullable) (transfer full): reference descriptors
 */
void
cloth_nearest_free (ClothNearest * nearest)
{
  if (!nearest)
    return;
  g_aligned_free (nearest->blocks);
  g_free (nearest->offsets);
  g_free (nearest);
}

/* @level: vector instructions that may be used at most
 *
 * Returns: the kernel of the highest level that is not above @level and that the processor
 *   has; VNNI is above AVX-512, but has no name of its own
 */
const ClothNearestKernel *
cloth_nearest_find_kernel (ClothSimd level)
{
#ifdef __x86_64__
  if (level == CLOTH_SIMD_BEST
      && cloth_simd_resolve (level) == CLOTH_SIMD_AVX512
      && __builtin_cpu_supports ("avx512vnni"))
    return &cloth_nearest_kernel_vnni;
#endif
  return CLOTH_SIMD_TABLE (cloth_nearest_kernel, level);
}

/* Holds @n queries against the blocks from @first to @last. */
static void
search_stretch (const Search * search, const guint8 * queries, guint n,
    guint first, guint last, ClothNearestPair * pairs)
{
  const ClothNearest *nearest = search->nearest;

  for (guint i = 0; i < n; i += QUERIES) {
    const guint8 *from = queries + i * CLOTH_NEAREST_BYTES;
    guint8 filled[QUERIES * CLOTH_NEAREST_BYTES] = { 0 };

    if (n - i < QUERIES)
      from = memcpy (filled, from, (n - i) * CLOTH_NEAREST_BYTES);
    search->kernel->scan (nearest->blocks, nearest->offsets, first, last, from,
        pairs + i);
  }
}

static void
finish (const ClothNearestPair * pair, const guint8 * query,
    ClothNeighbours * found)
{
  gint32 square = 0;

  for (gint k = 0; k < CLOTH_NEAREST_BYTES; k++)
    square += query[k] * query[k];
  *found = (ClothNeighbours) {
  CLOTH_NEAREST_NONE, CLOTH_NEAREST_NONE, CLOTH_NEAREST_NONE,
        CLOTH_NEAREST_NONE};
  if (pair->distance != G_MAXINT32) {
    found->index = pair->index;
    found->distance = (guint32) (pair->distance + square);
  }
  if (pair->second_distance != G_MAXINT32) {
    found->second = pair->second;
    found->second_distance = (guint32) (pair->second_distance + square);
  }
}

static void
search_shares (gpointer data, guint begin, guint end, guint worker)
{
  const Search *search = data;
  const guint n_blocks = search->nearest->n_blocks;
  ClothNearestPair pairs[SHARE];

  for (guint share = begin; share < end; share++) {
    const guint first = share * SHARE, n = MIN (SHARE, search->n - first);
    const guint8 *queries =
        search->queries + (gsize) first * CLOTH_NEAREST_BYTES;

    for (guint i = 0; i < SHARE; i++)
      pairs[i].distance = pairs[i].second_distance = G_MAXINT32;
    for (guint block = 0; block < n_blocks; block += STRETCH)
      search_stretch (search, queries, n, block, MIN (block + STRETCH,
              n_blocks), pairs);
    for (guint i = 0; i < n; i++)
      finish (&pairs[i], queries + i * CLOTH_NEAREST_BYTES,
          &search->found[first + i]);
  }
}

/* @nearest: reference descriptors
 * @queries: (array): @n times %CLOTH_NEAREST_BYTES
 * @n: how many
 * @found: (out caller-allocates) (array length=n): the two nearest of each;
 *   %CLOTH_NEAREST_NONE where there are fewer
 * @pool: (nullable): threads that share the queries
 * @level: vector instructions that may be used at most
 *
 * The result depends on neither @pool nor @level.
 */
void
cloth_nearest_run (const ClothNearest * nearest, const guint8 * queries,
    guint n, ClothNeighbours * found, ClothPool * pool, ClothSimd level)
{
  Search search = { nearest, cloth_nearest_find_kernel (level), queries, n,
    found
  };

  cloth_pool_run_one_by_one (pool, search_shares, &search,
      n / SHARE + (n % SHARE != 0));
}
