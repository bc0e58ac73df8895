/* Distances of descriptors: sums of whole numbers, so that every level gives the same.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/feature/nearest-private.h"

#include <string.h>

#if CLOTH_SIMD_BITS >= 256
#include <immintrin.h>
#endif

#define LANES CLOTH_NEAREST_LANES
#define GROUPS CLOTH_NEAREST_GROUPS
#define BLOCK CLOTH_NEAREST_BLOCK
#define QUERIES CLOTH_NEAREST_QUERIES
#define INLINE static inline __attribute__((always_inline))

/* Descriptors come by their index: of equal ones the first stays. */
INLINE void
add (ClothNearestPair * pair, gint32 distance, guint32 index)
{
  if (distance < pair->distance) {
    pair->second_distance = pair->distance;
    pair->second = pair->index;
    pair->distance = distance;
    pair->index = index;
  } else if (distance < pair->second_distance) {
    pair->second_distance = distance;
    pair->second = index;
  }
}

#if CLOTH_SIMD_BITS == 0

static void
scan (const guint8 * blocks, const gint32 * offsets, guint begin, guint end,
    const guint8 * queries, ClothNearestPair * pairs)
{
  for (guint b = begin; b < end; b++)
    for (gint q = 0; q < QUERIES; q++) {
      const guint8 *query = queries + q * CLOTH_NEAREST_BYTES;
      const guint8 *block = blocks + (gsize) b * BLOCK;
      gint32 sums[LANES] = { 0 };

      for (gint g = 0; g < GROUPS; g++)
        for (gint i = 0; i < LANES; i++)
          for (gint k = 0; k < 4; k++)
            sums[i] += block[4 * (g * LANES + i) + k] * (query[4 * g + k] -
                128);
      for (guint i = 0; i < LANES; i++)
        add (&pairs[q], offsets[(gsize) b * LANES + i] - 2 * sums[i],
            b * LANES + i);
    }
}

#else

#define WIDE (CLOTH_SIMD_BITS / 32)
typedef gint32 Ints __attribute__((vector_size (4 * WIDE)));
typedef guint16 Shorts __attribute__((vector_size (4 * WIDE)));

/* A bit for each lane of @a that is less than @b. */
INLINE guint
less (Ints a, gint32 b)
{
#if CLOTH_SIMD_BITS == 512
  return _mm512_cmplt_epi32_mask ((__m512i) a, _mm512_set1_epi32 (b));
#else
  return (guint) _mm256_movemask_ps ((__m256) (a < (Ints) {
          0}
          +b));
#endif
}

/* Puts what is nearer among the pair of a query. @sums are those of the descriptors from
 * @index on. After the first few hundred there is hardly ever one. */
INLINE void
update (ClothNearestPair * pair, const gint32 * offsets, guint32 index,
    Ints sums)
{
  Ints distances;
  guint nearer;

  memcpy (&distances, offsets + index, sizeof (distances));
  distances -= 2 * sums;
  nearer = less (distances, pair->second_distance);
  for (; G_UNLIKELY (nearer); nearer &= nearer - 1) {
    const gint i = __builtin_ctz (nearer);

    add (pair, distances[i], index + (guint) i);
  }
}

#ifdef CLOTH_NEAREST_VNNI

/* Two blocks at once: sums of 16 chains hide how long each step takes. */
static void
scan (const guint8 * blocks, const gint32 * offsets, guint begin, guint end,
    const guint8 * queries, ClothNearestPair * pairs)
{
  gint32 signs[GROUPS][QUERIES];

  for (gint q = 0; q < QUERIES; q++)
    for (gint g = 0; g < GROUPS; g++) {
      gint32 four;

      memcpy (&four, queries + q * CLOTH_NEAREST_BYTES + 4 * g, 4);
      signs[g][q] = four ^ (gint32) 0x80808080;
    }
  for (guint b = begin; b < end; b += 2) {
    const guint8 *block = blocks + (gsize) b * BLOCK;
    __m512i sums[2][QUERIES];

    for (gint q = 0; q < QUERIES; q++)
      sums[0][q] = sums[1][q] = _mm512_setzero_si512 ();
    for (gint g = 0; g < GROUPS; g++) {
      const __m512i r0 = _mm512_loadu_si512 (block + 4 * LANES * g);
      const __m512i r1 = _mm512_loadu_si512 (block + BLOCK + 4 * LANES * g);

#pragma GCC unroll 8
      for (gint q = 0; q < QUERIES; q++) {
        const __m512i s = _mm512_set1_epi32 (signs[g][q]);

        sums[0][q] = _mm512_dpbusd_epi32 (sums[0][q], r0, s);
        sums[1][q] = _mm512_dpbusd_epi32 (sums[1][q], r1, s);
      }
    }
    for (gint q = 0; q < QUERIES; q++) {
      update (&pairs[q], offsets, b * LANES, (Ints) sums[0][q]);
      update (&pairs[q], offsets, (b + 1) * LANES, (Ints) sums[1][q]);
    }
  }
}

#else

/* Products of pairs of 16 bits, and their sums. */
INLINE Ints
products (Shorts a, gint32 b)
{
#if CLOTH_SIMD_BITS == 512
  return (Ints) _mm512_madd_epi16 ((__m512i) a, _mm512_set1_epi32 (b));
#else
  return (Ints) _mm256_madd_epi16 ((__m256i) a, _mm256_set1_epi32 (b));
#endif
}

/* Bytes 0 and 2, or 1 and 3, of a group as a pair of 16 bits. */
INLINE gint32
pair (const guint8 * group)
{
  return (gint32) ((guint32) (guint16) (group[0] - 128) |
      (guint32) (guint16) (group[2] - 128) << 16);
}

static void
scan (const guint8 * blocks, const gint32 * offsets, guint begin, guint end,
    const guint8 * queries, ClothNearestPair * pairs)
{
  gint32 even[GROUPS][QUERIES], odd[GROUPS][QUERIES];

  for (gint q = 0; q < QUERIES; q++)
    for (gint g = 0; g < GROUPS; g++) {
      const guint8 *group = queries + q * CLOTH_NEAREST_BYTES + 4 * g;

      even[g][q] = pair (group);
      odd[g][q] = pair (group + 1);
    }
  for (guint b = begin; b < end; b++)
    for (gint i = 0; i < LANES; i += WIDE) {
      const guint8 *block = blocks + (gsize) b * BLOCK + 4 * i;
      Ints sums[QUERIES];

      for (gint q = 0; q < QUERIES; q++)
        sums[q] = (Ints) {
        0};
      for (gint g = 0; g < GROUPS; g++) {
        Shorts bytes, low, high;

        memcpy (&bytes, block + 4 * LANES * g, sizeof (bytes));
        low = bytes & 0xff;
        high = bytes >> 8;
#pragma GCC unroll 8
        for (gint q = 0; q < QUERIES; q++)
          sums[q] += products (low, even[g][q]) + products (high, odd[g][q]);
      }
      for (gint q = 0; q < QUERIES; q++)
        update (&pairs[q], offsets, b * LANES + (guint) i, sums[q]);
    }
}

#endif
#endif

const ClothNearestKernel CLOTH_SIMD_NAME (cloth_nearest_kernel) = { scan };
