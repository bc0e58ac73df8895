/* One tile of the hyperbolic mask by vector instructions.
 *
 * Even and odd columns lie apart: the pass along rows multiplies pairs of neighbouring
 * bytes, which gives every second column, and what the later steps add or multiply stands
 * in equal lanes. A tile is as wide as lets its rows stay in the first-level cache.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/corner/saddle-mask-private.h"

#if CLOTH_SIMD_BITS >= 256

#include <immintrin.h>
#include <string.h>

/* Columns left of a tile's first one that the differences may reach. */
#define MARGIN CLOTH_SADDLE_TILE_MARGIN
#define INLINE static inline __attribute__((always_inline))

#if CLOTH_SIMD_BITS == 512
#define LANES 32
#define VEC __m512i
#define LOAD(p) _mm512_loadu_si512 ((const void *) (p))
#define STORE(p, v) _mm512_storeu_si512 ((void *) (p), (v))
#define SET(v) _mm512_set1_epi16 ((gint16) (v))
#define PAIR(a, b) \
  _mm512_set1_epi16 ((gint16) (((guint8) (b)) << 8 | (guint8) (a)))
#define ADD _mm512_add_epi16
#define SUB _mm512_sub_epi16
#define AVERAGE _mm512_avg_epu16
#define MUL_BYTES _mm512_maddubs_epi16
#define MUL_HIGH _mm512_mulhi_epi16
#define MUL_HIGH_U _mm512_mulhi_epu16
#define TIMES_4(v) _mm512_slli_epi16 ((v), 2)
/* Spread by the scalar unit, which has nothing else to do. */
#define BITS_BELOW(a, b, bound) \
  (_pdep_u64 (_mm512_cmpgt_epi16_mask ((bound), (a)), 0x5555555555555555) | \
      _pdep_u64 (_mm512_cmpgt_epi16_mask ((bound), (b)), 0xaaaaaaaaaaaaaaaa))
#else
#define LANES 16
#define VEC __m256i
#define LOAD(p) _mm256_loadu_si256 ((const __m256i *) (p))
#define STORE(p, v) _mm256_storeu_si256 ((__m256i *) (p), (v))
#define SET(v) _mm256_set1_epi16 ((gint16) (v))
#define PAIR(a, b) \
  _mm256_set1_epi16 ((gint16) (((guint8) (b)) << 8 | (guint8) (a)))
#define ADD _mm256_add_epi16
#define SUB _mm256_sub_epi16
#define AVERAGE _mm256_avg_epu16
#define MUL_BYTES _mm256_maddubs_epi16
#define MUL_HIGH _mm256_mulhi_epi16
#define MUL_HIGH_U _mm256_mulhi_epu16
#define TIMES_4(v) _mm256_slli_epi16 ((v), 2)
#define BITS_BELOW(a, b, bound) \
  ((guint32) _mm256_movemask_epi8 (_mm256_blendv_epi8 ( \
          _mm256_cmpgt_epi16 ((bound), (a)), \
          _mm256_cmpgt_epi16 ((bound), (b)), \
          _mm256_set1_epi16 ((gint16) 0xff00))))
#endif

/* Along a row: from bytes to even and odd columns of 16 bits. For odd columns the same
 * pairs of bytes serve with the weights moved by one. */
INLINE void
across_of (guint16 * out, gint n, const guint8 * line,
    const VEC * weights, const gint n_pairs)
{
  for (gint i = 0; i < n; i += LANES) {
    VEC in = LOAD (line + 2 * i);
    VEC a = MUL_BYTES (in, weights[0]), b = MUL_BYTES (in, weights[1]);
#pragma GCC unroll 16
    for (gint k = 1; k < n_pairs; k++) {
      in = LOAD (line + 2 * i + 2 * k);
      a = ADD (a, MUL_BYTES (in, weights[2 * k]));
      b = ADD (b, MUL_BYTES (in, weights[2 * k + 1]));
    }
    STORE (out + i, a);
    STORE (out + n + i, b);
  }
}

/* Here and below: loops of known length for the widths most asked for. */
INLINE void
across (guint16 * out, gint n, const guint8 * line, const VEC * weights,
    gint n_pairs)
{
  if (n_pairs == 5)
    across_of (out, n, line, weights, 5);
  else if (n_pairs == 4)
    across_of (out, n, line, weights, 4);
  else
    across_of (out, n, line, weights, n_pairs);
}

/* Across rows, two of them at once: the middle row and those at equal distances,
 * averaged in pairs. Meanwhile the bytes @soon, of the picture's rows that come next, are
 * called into the cache, one line at a time: all at once they would wait for each other. */
INLINE void
down_of (guint16 * out0, guint16 * out1, gint n,
    guint16 * const *rows, const guint16 * weights,
    const guint8 * const *soon, const gint radius)
{
  VEC weight[CLOTH_SADDLE_MAX_RADIUS + 1];
  const guint16 *row[2 * CLOTH_SADDLE_MAX_RADIUS + 2];

  /* Copies the compiler knows nobody else writes to. */
  for (gint k = 0; k <= radius; k++)
    weight[k] = SET (weights[k]);
  for (gint k = 0; k <= 2 * radius + 1; k++)
    row[k] = rows[k];
  for (gint half = 0; half < 2; half++) {
    for (gint j = 0; j < n; j += LANES) {
      const gint i = half * n + j;

      __builtin_prefetch (soon[half] + 2 * j);
      VEC sum0 = MUL_HIGH_U (LOAD (row[radius] + i), weight[0]);
      VEC sum1 = MUL_HIGH_U (LOAD (row[radius + 1] + i), weight[0]);
#pragma GCC unroll 16
      for (gint k = 1; k <= radius; k++) {
        VEC pair0 = AVERAGE (LOAD (row[radius - k] + i),
            LOAD (row[radius + k] + i));
        VEC pair1 = AVERAGE (LOAD (row[radius + 1 - k] + i),
            LOAD (row[radius + 1 + k] + i));
        sum0 = ADD (sum0, MUL_HIGH_U (pair0, weight[k]));
        sum1 = ADD (sum1, MUL_HIGH_U (pair1, weight[k]));
      }
      STORE (out0 + i, sum0);
      STORE (out1 + i, sum1);
    }
  }
}

INLINE void
down (guint16 * out0, guint16 * out1, gint n, guint16 * const *rows,
    const guint16 * weights, const guint8 * const *soon, gint radius)
{
  if (radius == 4)
    down_of (out0, out1, n, rows, weights, soon, 4);
  else if (radius == 3)
    down_of (out0, out1, n, rows, weights, soon, 3);
  else
    down_of (out0, out1, n, rows, weights, soon, radius);
}

/* From the smoothed values of a column and those left and right of it, in three rows. */
INLINE VEC
determinant (VEC up, VEC here, VEC down, VEC left, VEC right,
    VEC left_rise, VEC right_rise)
{
  VEC twice = ADD (here, here);
  VEC fxx = SUB (ADD (left, right), twice);
  VEC fyy = SUB (ADD (up, down), twice);
  VEC fxy = SUB (right_rise, left_rise);

  return SUB (MUL_HIGH (TIMES_4 (fxx), TIMES_4 (fyy)), MUL_HIGH (fxy, fxy));
}

/* The same at @b, with the rows @a above and @c below it. */
INLINE VEC
determinant_at (const guint16 * a, const guint16 * b, const guint16 * c,
    gssize before, gssize after)
{
  return determinant (LOAD (a), LOAD (b), LOAD (c), LOAD (b + before),
      LOAD (b + after), SUB (LOAD (c + before), LOAD (a + before)),
      SUB (LOAD (c + after), LOAD (a + after)));
}

/* Two rows of bits and determinants. Determinants are always written, and kept if a bit
 * is set. */
INLINE void
rows_of (ClothSaddleMask * mask, gint y, gint word, gint words, gint n,
    gint threshold, const gint h, guint16 * const *smooth)
{
  const gssize odd = n;
  /* From an even column its neighbours at h, then from an odd one. */
  const gssize even_before = h % 2 ? odd - (h + 1) / 2 : -(h / 2);
  const gssize even_after = h % 2 ? odd + (h - 1) / 2 : h / 2;
  const gssize odd_before = h % 2 ? -odd - (h - 1) / 2 : -(h / 2);
  const gssize odd_after = h % 2 ? -odd + (h + 1) / 2 : h / 2;
  const VEC bound = SET (-threshold);
  const guint16 *row[2 * CLOTH_SADDLE_MAX_STEP + 2];
  const gsize first = (gsize) y * (gsize) mask->words + (gsize) word;
  guint64 *bits = mask->bits + first;
  gint16 *det = mask->det;
  guint32 *block =
      mask->blocks + (gsize) (y / 2) * (gsize) mask->words + (gsize) word;
  guint32 next = mask->n_blocks;

  for (gint k = 0; k < 2 * h + 2; k++)
    row[k] = smooth[k];

  for (gint w = 0; w < words; w++) {
    guint64 word_0 = 0, word_1 = 0;

    for (gint part = 0; part < 32; part += LANES) {
      const gint i = MARGIN / 2 + 32 * w + part;
      gint16 *out = det + 64 * (gsize) next + part;
      VEC d0, d1, d2, d3;

      if (h == 1) {
        /* By name and not in arrays, so that compilers keep them in registers: the even
         * columns, the odd ones, those left of the even, those right of the odd. */
        const guint16 *r0 = row[0] + i, *r1 = row[1] + i;
        const guint16 *r2 = row[2] + i, *r3 = row[3] + i;
        VEC e0 = LOAD (r0), e1 = LOAD (r1), e2 = LOAD (r2), e3 = LOAD (r3);
        VEC o0 = LOAD (r0 + odd), o1 = LOAD (r1 + odd);
        VEC o2 = LOAD (r2 + odd), o3 = LOAD (r3 + odd);
        VEC left_1 = LOAD (r1 + odd - 1), left_2 = LOAD (r2 + odd - 1);
        VEC right_1 = LOAD (r1 + 1), right_2 = LOAD (r2 + 1);

        d0 = determinant (e0, e1, e2, left_1, o1,
            SUB (left_2, LOAD (r0 + odd - 1)), SUB (o2, o0));
        d1 = determinant (o0, o1, o2, e1, right_1, SUB (e2, e0),
            SUB (right_2, LOAD (r0 + 1)));
        d2 = determinant (e1, e2, e3, left_2, o2,
            SUB (LOAD (r3 + odd - 1), left_1), SUB (o3, o1));
        d3 = determinant (o1, o2, o3, e2, right_2, SUB (e3, e1),
            SUB (LOAD (r3 + 1), right_1));
      } else {
        const guint16 *a = row[0] + i, *b = row[h] + i, *c = row[2 * h] + i;

        d0 = determinant_at (a, b, c, even_before, even_after);
        d1 = determinant_at (a + odd, b + odd, c + odd, odd_before, odd_after);
        a = row[1] + i;
        b = row[h + 1] + i;
        c = row[2 * h + 1] + i;
        d2 = determinant_at (a, b, c, even_before, even_after);
        d3 = determinant_at (a + odd, b + odd, c + odd, odd_before, odd_after);
      }
      word_0 |= (guint64) BITS_BELOW (d0, d1, bound) << (2 * part);
      word_1 |= (guint64) BITS_BELOW (d2, d3, bound) << (2 * part);
      STORE (out, d0);
      STORE (out + 32, d1);
      STORE (out + 64, d2);
      STORE (out + 96, d3);
    }
    /* A branch would often be guessed wrongly. */
    block[w] = next;
    next += word_0 | word_1 ? 2 : 0;
    bits[w] = word_0;
    bits[mask->words + w] = word_1;
  }
  mask->n_blocks = next;
}

INLINE void
rows (ClothSaddleMask * mask, gint row, gint word, gint words, gint n,
    gint threshold, gint h, guint16 * const *smooth)
{
  if (h == 1)
    rows_of (mask, row, word, words, n, threshold, 1, smooth);
  else
    rows_of (mask, row, word, words, n, threshold, h, smooth);
}

/* Pixels [x, x + n) of row y, the picture's border repeated outwards. */
INLINE void
copy_row (guint8 * out, const ClothImage * image, gint x, gint y, gint n)
{
  const guint8 *row = image->data + (gsize) CLAMP (y, 0, image->height - 1) *
      (gsize) image->stride;
  const gint size = 2 * LANES;
  gint from = CLAMP (-x, 0, n), to = CLAMP (image->width - x, from, n);

  if (from > 0)
    memset (out, row[0], (gsize) from);
  if (to - from >= size) {
    for (gint i = from; i <= to - size; i += size)
      STORE (out + i, LOAD (row + x + i));
    STORE (out + to - size, LOAD (row + x + to - size));
  } else {
    memcpy (out + from, row + x + from, (gsize) (to - from));
  }
  if (to < n)
    memset (out + to, row[image->width - 1], (gsize) (n - to));
}

static void
run (ClothSaddleMask * mask, const ClothSaddleKernel * kernel,
    const ClothImage * image, gint threshold, gint word, gint words,
    guint8 * scratch)
{
  const gint r = kernel->radius, h = kernel->step;
  const gint n = CLOTH_SADDLE_TILE_LANES (words);
  const gsize row_size = CLOTH_SADDLE_TILE_ROW (words);
  const gint x = mask->x + 64 * word - MARGIN;
  const gint top = mask->y - h - r;
  guint16 *smooth[2 * CLOTH_SADDLE_MAX_STEP + 2];
  guint16 *ring[2 * CLOTH_SADDLE_MAX_RADIUS + 2];
  VEC weights[2 * CLOTH_SADDLE_MAX_RADIUS + 2];
  guint8 *line[4];

  for (gint k = 0; k <= r; k++) {
    const gint8 *taps = kernel->across + 2 * k;

    weights[2 * k] = PAIR (taps[0], taps[1]);
    weights[2 * k + 1] = PAIR (k > 0 ? taps[-1] : 0, taps[0]);
  }
  /* Of the smoothed rows the columns inside the margin are aligned: they are read far
   * oftener than written. */
  for (gint k = 0; k < 2 * h + 2; k++)
    smooth[k] = (guint16 *) scratch + row_size * (gsize) k + 32 - MARGIN / 2;
  scratch += 2 * (row_size * (gsize) (2 * h + 2) + 32);
  for (gint k = 0; k < 2 * r + 2; k++)
    ring[k] = (guint16 *) scratch + row_size * (gsize) k;
  scratch += 2 * row_size * (gsize) (2 * r + 2);
  for (gint k = 0; k < 4; k++)
    line[k] = scratch + CLOTH_SADDLE_TILE_LINE (words) * (gsize) k;
  for (gint k = 0; k < 2; k++)
    copy_row (line[k], image, x - r, top + k, 2 * n + 2 * r);

  /* Two rows a round; the pass down lags 2r rows behind, the determinant 2h more. */
  for (gint i = 0; i < mask->height + 2 * (h + r); i += 2) {
    guint16 *oldest[2] = { ring[0], ring[1] };
    const guint8 *soon[2];
    gint row = i - 2 * r - 2 * h;

    memmove (ring, ring + 2, sizeof (guint16 *) * (gsize) (2 * r));
    for (gint k = 0; k < 2; k++) {
      /* Copied a round before it is read: a load can't wait for a store that it meets
       * half way. */
      copy_row (line[(i + 2) % 4 + k], image, x - r, top + i + 2 + k,
          2 * n + 2 * r);
      ring[2 * r + k] = oldest[k];
      across (oldest[k], n, line[i % 4 + k], weights, r + 1);
      soon[k] = image->data + MAX (x - r, 0) + (gsize) CLAMP (top + i + 6 + k,
          0, image->height - 1) * (gsize) image->stride;
    }
    if (i < 2 * r)
      continue;

    oldest[0] = smooth[0];
    oldest[1] = smooth[1];
    memmove (smooth, smooth + 2, sizeof (guint16 *) * (gsize) (2 * h));
    smooth[2 * h] = oldest[0];
    smooth[2 * h + 1] = oldest[1];
    down (oldest[0], oldest[1], n, ring, kernel->down, soon, r);
    if (row < 0)
      continue;

    /* The mask has room for the row after an odd number. */
    rows (mask, row, word, words, n, threshold, h, smooth);
  }
}

const ClothSaddleTile CLOTH_SIMD_NAME (cloth_saddle_tile) = { run };

#else
const ClothSaddleTile CLOTH_SIMD_NAME (cloth_saddle_tile) = { NULL };
#endif
