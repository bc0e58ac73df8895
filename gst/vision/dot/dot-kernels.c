/* What dot detection does to every pixel: bounds of tiles, bits above a threshold, rows of
 * ellipses, sums about and over dots. Sums are of whole numbers, or lane by lane in one
 * order.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/dot/dot-private.h"

#include <math.h>
#include <string.h>

#if CLOTH_SIMD_BITS >= 256
#include <emmintrin.h>
#endif

#define TILE CLOTH_DOT_TILE
#define INLINE static inline __attribute__((always_inline))

static void
span_bounds (const guint8 * row, gint n, guint8 * least, guint8 * most)
{
  for (gint i = 0; i < n; i++) {
    *least = MIN (*least, row[i]);
    *most = MAX (*most, row[i]);
  }
}

static guint16
span_bits (const guint8 * row, gint n, guint8 threshold)
{
  guint bits = 0;

  for (gint i = 0; i < n; i++)
    bits |= (guint) (row[i] > threshold) << i;
  return (guint16) bits;
}

#if CLOTH_SIMD_BITS >= 256
static guint8
lowest_byte (__m128i v)
{
  v = _mm_min_epu8 (v, _mm_srli_si128 (v, 8));
  v = _mm_min_epu8 (v, _mm_srli_si128 (v, 4));
  v = _mm_min_epu8 (v, _mm_srli_si128 (v, 2));
  v = _mm_min_epu8 (v, _mm_srli_si128 (v, 1));
  return (guint8) _mm_cvtsi128_si32 (v);
}

static void
tile_bounds (const guint8 * data, gint stride, gint rows, guint8 * least,
    guint8 * most)
{
  __m128i low = _mm_set1_epi8 (-1), high = _mm_setzero_si128 ();

  for (gint y = 0; y < rows; y++, data += stride) {
    const __m128i v = _mm_loadu_si128 ((const __m128i *) data);

    low = _mm_min_epu8 (low, v);
    high = _mm_max_epu8 (high, v);
  }
  *least = lowest_byte (low);
  *most = (guint8) ~ lowest_byte (_mm_xor_si128 (high, _mm_set1_epi8 (-1)));
}

static guint16
tile_bits (const guint8 * data, guint8 threshold)
{
  const __m128i v = _mm_loadu_si128 ((const __m128i *) data);
  const __m128i above = _mm_subs_epu8 (v, _mm_set1_epi8 ((gchar) threshold));

  return (guint16) ~ _mm_movemask_epi8 (_mm_cmpeq_epi8 (above,
          _mm_setzero_si128 ()));
}
#endif

static void
find_bounds (const ClothImage * image, gint tile_row, guint8 * least,
    guint8 * most)
{
  const gint y0 = tile_row * TILE;
  const gint rows = MIN (TILE, image->height - y0);
  const guint8 *data = image->data + (gsize) y0 * (gsize) image->stride;

  for (gint x = 0, t = 0; x < image->width; x += TILE, t++) {
#if CLOTH_SIMD_BITS >= 256
    if (x + TILE <= image->width) {
      tile_bounds (data + x, image->stride, rows, &least[t], &most[t]);
      continue;
    }
#endif
    least[t] = 255;
    most[t] = 0;
    for (gint y = 0; y < rows; y++)
      span_bounds (data + (gsize) y * (gsize) image->stride + x,
          MIN (TILE, image->width - x), &least[t], &most[t]);
  }
}

static void
find_bits (const guint8 * row, gint width, const guint8 * thresholds,
    guint16 * bits)
{
  for (gint x = 0, t = 0; x < width; x += TILE, t++) {
#if CLOTH_SIMD_BITS >= 256
    if (x + TILE <= width) {
      bits[t] = tile_bits (row + x, thresholds[t]);
      continue;
    }
#endif
    bits[t] = span_bits (row + x, MIN (TILE, width - x), thresholds[t]);
  }
}

/* Without branches, so that the compiler makes vectors of it; √, +, · and / are rounded
 * alike in all of them. */
static void
find_rows (const ClothDotEllipse * ellipse, gdouble cx, gdouble cy, gint y0,
    gint n, gint width, gint * restrict first, gint * restrict last)
{
  for (gint i = 0; i < n; i++) {
    const gdouble dy = (y0 + i) - cy;
    const gdouble middle = cx + ellipse->slope * dy;
    const gdouble square = ellipse->widest - ellipse->narrowing * dy * dy;
    const gdouble half = sqrt (square > 0 ? square : 0);
    /* beyond the ellipse from behind the picture's end, so that nothing is left */
    const gint none = square < 0 ? width : 0;
    const gint from = cloth_dot_ceil_place (middle - half);
    const gint to = cloth_dot_floor_place (middle + half);

    first[i] = MAX (none, from);
    last[i] = MIN (width - 1, to);
  }
}

/* Pixels of a row that are looked at together: columns are summed by themselves, down as
 * many rows as their sums have room for. */
#define WIDE 32
#define NARROW 16
#define BLOCK 255

typedef guint8 Wide __attribute__((vector_size (WIDE)));
typedef guint8 Narrow __attribute__((vector_size (NARROW)));
typedef gint16 Shorts __attribute__((vector_size (2 * NARROW)));
typedef guint16 Sums __attribute__((vector_size (2 * NARROW)));
typedef gint32 Ints __attribute__((vector_size (2 * NARROW)));

/* Halves, for GCC 12 keeps in memory what is longer than a register. */
#define LOW_BYTES(v) __builtin_shufflevector (v, v, 0, 1, 2, 3, 4, 5, 6, 7, \
    8, 9, 10, 11, 12, 13, 14, 15)
#define HIGH_BYTES(v) __builtin_shufflevector (v, v, 16, 17, 18, 19, 20, 21, \
    22, 23, 24, 25, 26, 27, 28, 29, 30, 31)
#define LOW_INTS(v) __builtin_convertvector (__builtin_shufflevector (v, v, \
    0, 1, 2, 3, 4, 5, 6, 7), Ints)
#define HIGH_INTS(v) __builtin_convertvector (__builtin_shufflevector (v, v, \
    8, 9, 10, 11, 12, 13, 14, 15), Ints)

/* Loaded from WIDE − n on: n lanes that count. */
static const guint8 counting[2 * WIDE] = {
  255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255,
  255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255,
  255, 255
};

INLINE Wide
lanes_before (guint8 n)
{
  Wide mask;

  memcpy (&mask, counting + WIDE - n, WIDE);
  return mask;
}

/* How many lanes, counted from column @x on, are before each row's column. */
INLINE void
find_lanes (const gint * columns, gint n, gint x, guint8 lanes[BLOCK])
{
  for (gint i = 0; i < n; i++) {
    const gint lane = columns[i] - x;

    lanes[i] = (guint8) CLAMP (lane, 0, WIDE);
  }
}

static void
add_ring (const ClothImage * luma, const ClothDotCandidate * spot,
    const ClothDotRows * rows, guint8 most, ClothDotTally * tally)
{
  const gint left = MAX (0, (gint) floor (spot->x - rows->ring.width));
  const gint right = MIN (luma->width,
      (gint) ceil (spot->x + rows->ring.width) + 1);

  for (gint x = left; x < right; x += WIDE) {
    const gsize room = (gsize) MIN (WIDE, luma->width - x);

    for (gint at = 0; at < rows->n; at += BLOCK) {
      const gint n = MIN (rows->n - at, BLOCK);
      const guint8 *row = luma->data
          + (gsize) (rows->y0 + at) * (gsize) luma->stride + x;
      guint8 first[BLOCK], from[BLOCK], to[BLOCK], end[BLOCK];
      Sums low = { 0 }, high = { 0 };
      Wide counts = { 0 };
      guint16 column_sums[WIDE];
      guint8 column_counts[WIDE];

      find_lanes (rows->around.first + at, n, x, first);
      find_lanes (rows->weighed.first + at, n, x, from);
      find_lanes (rows->weighed.last + at, n, x - 1, to);
      find_lanes (rows->around.last + at, n, x - 1, end);
      for (gint i = 0; i < n; i++, row += luma->stride) {
        const Wide ring = lanes_before (end[i]) & ~lanes_before (first[i]);
        const Wide window = lanes_before (to[i]) & ~lanes_before (from[i]);
        Wide v = { 0 }, dark, seen;

        if (room == WIDE)
          memcpy (&v, row, WIDE);
        else
          memcpy (&v, row, room);
        dark = (Wide) (v <= most) & ring & ~window;
        seen = v & dark;
        low += __builtin_convertvector (LOW_BYTES (seen), Sums);
        high += __builtin_convertvector (HIGH_BYTES (seen), Sums);
        counts -= dark;
      }
      memcpy (column_sums, &low, sizeof low);
      memcpy (column_sums + NARROW, &high, sizeof high);
      memcpy (column_counts, &counts, sizeof counts);
      for (gint k = 0; k < WIDE; k++) {
        tally->sum += column_sums[k];
        tally->n += column_counts[k];
      }
    }
  }
}

INLINE Shorts
load_shorts (const guint8 * from)
{
  Narrow bytes;

  memcpy (&bytes, from, NARROW);
  return __builtin_convertvector (bytes, Shorts);
}

INLINE gint
bend_at (const guint8 * above, const guint8 * row, const guint8 * below)
{
  return above[-1] - 2 * above[0] + above[1]
      - 2 * (row[-1] - 2 * row[0] + row[1])
      + below[-1] - 2 * below[0] + below[1];
}

static void
add_inside (const ClothImage * luma, const ClothDotRows * rows,
    ClothDotTally * tally, ClothDotBends * bends)
{
  static const Shorts lane = { 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14,
    15
  };
  Ints sums = { 0 }, squares = { 0 }, more = { 0 };
  gint32 columns[3][NARROW / 2];

  for (gint i = 0; i < rows->inside_n; i++) {
    const gint y = rows->inside_y0 + i;
    const gint first = rows->inside.first[i], last = rows->inside.last[i];
    const guint8 *row = luma->data + (gsize) y * (gsize) luma->stride;
    const guint8 *above = row - luma->stride, *below = row + luma->stride;
    gint x = first;

    if (first > last)
      continue;
    tally->n += last - first + 1;
    if (y < 1 || y > luma->height - 2) {
      for (; x <= last; x++)
        tally->sum += row[x];
      continue;
    }
    bends->count += MAX (0, MIN (luma->width - 2, last) - MAX (1, first) + 1);
    if (first >= 1)
      for (; x <= last && x + NARROW < luma->width; x += NARROW) {
        const Shorts inside = lane <= (gint16) MIN (last - x, NARROW);
        const Shorts middle = load_shorts (row + x);
        const Shorts bend = inside & (load_shorts (above + x - 1)
            + load_shorts (above + x + 1) + load_shorts (below + x - 1)
            + load_shorts (below + x + 1) + 4 * middle
            - 2 * (load_shorts (above + x) + load_shorts (below + x)
                + load_shorts (row + x - 1) + load_shorts (row + x + 1)));
        const Shorts seen = middle & inside;
        const Ints left = LOW_INTS (bend), right = HIGH_INTS (bend);

        sums += LOW_INTS (seen) + HIGH_INTS (seen);
        squares += left * left;
        more += right * right;
      }
    for (; x <= last; x++) {
      tally->sum += row[x];
      if (x >= 1 && x <= luma->width - 2) {
        const gint bend = bend_at (above + x, row + x, below + x);

        bends->sum += bend * bend;
      }
    }
  }
  memcpy (columns[0], &sums, sizeof sums);
  memcpy (columns[1], &squares, sizeof squares);
  memcpy (columns[2], &more, sizeof more);
  for (gint k = 0; k < NARROW / 2; k++) {
    tally->sum += columns[0][k];
    bends->sum += (gint64) columns[1][k] + columns[2][k];
  }
}

/* Lanes that are summed apart; the order of the sums is the same on every machine. */
#define LANES 8

typedef gfloat Floats __attribute__((vector_size (4 * LANES)));
typedef guint8 Bytes __attribute__((vector_size (2 * LANES)));
typedef guint64 Pair __attribute__((vector_size (2 * LANES)));
typedef gint16 LowShorts __attribute__((vector_size (2 * LANES)));

/* Sums of 1, x, y, x², xy, y², lane by lane. */
typedef struct
{
  Floats m[6];
} Moments;

/* Adds columns at @x, by their sums of 1, y, y². */
INLINE void
add_columns (Moments * sum, Floats x, const Floats column[3])
{
  sum->m[0] += column[0];
  sum->m[1] += column[0] * x;
  sum->m[2] += column[1];
  sum->m[3] += column[0] * (x * x);
  sum->m[4] += column[1] * x;
  sum->m[5] += column[2];
}

INLINE void
total (const Moments * sum, gdouble m[6])
{
  for (gint k = 0; k < 6; k++) {
    const Floats v = sum->m[k];
    const Floats a = v + __builtin_shufflevector (v, v, 4, 5, 6, 7, 0, 1, 2, 3);
    const Floats b = a + __builtin_shufflevector (a, a, 2, 3, 0, 1, 6, 7, 4, 5);

    m[k] = b[0] + b[1];
  }
}

/* By way of 16 bits, for which compilers know instructions. */
INLINE Floats
floats_of_bytes (Bytes bytes)
{
  const Shorts shorts = __builtin_convertvector (bytes, Shorts);
  const LowShorts half = __builtin_shufflevector (shorts, shorts, 0, 1, 2, 3,
      4, 5, 6, 7);

  return __builtin_convertvector (__builtin_convertvector (half, Ints), Floats);
}

static void
weigh (const ClothDotWeighing * weighing, gdouble shares[6], gdouble edges[6])
{
  static const Ints lane = { 0, 1, 2, 3, 4, 5, 6, 7 };
  static const Floats one = { 1, 1, 1, 1, 1, 1, 1, 1 }, zero = { 0 };
  const ClothImage *luma = weighing->luma;
  Moments all_shares = { 0 }, all_edges = { 0 };

  for (gint x = weighing->left; x <= weighing->right; x += LANES) {
    const Floats dx = __builtin_convertvector (lane + (x - weighing->x0),
        Floats);
    const gsize room = (gsize) MIN (LANES, luma->width - x);
    const guint8 *row = luma->data
        + (gsize) weighing->top * (gsize) luma->stride + x;
    Floats share[3] = { 0 }, edge[3] = { 0 };
    Floats dy = zero + (gfloat) (weighing->top - weighing->y0);

    for (gint i = 0; i < weighing->n; i++, row += luma->stride, dy += one) {
      const Ints inside = (lane >= weighing->first[i] - x)
          & (lane <= weighing->last[i] - x);
      const Floats dy2 = dy * dy;
      Bytes bytes = { 0 };
      Floats raw, s;
      Ints above, below, e;

      if (room == LANES) {
        guint64 eight;

        memcpy (&eight, row, LANES);
        bytes = (Bytes) (Pair) {
        eight};
      } else {
        memcpy (&bytes, row, room);
      }
      raw = (floats_of_bytes (bytes) - weighing->foot) * weighing->gain;
      above = inside & (raw > zero);
      below = raw < one;
      e = above & below;
      s = (Floats) ((((Ints) raw & below) | ((Ints) one & ~below)) & above);
      share[0] += s;
      share[1] += s * dy;
      share[2] += s * dy2;
      edge[0] += (Floats) ((Ints) one & e);
      edge[1] += (Floats) ((Ints) dy & e);
      edge[2] += (Floats) ((Ints) dy2 & e);
    }
    add_columns (&all_shares, dx, share);
    add_columns (&all_edges, dx, edge);
  }
  total (&all_shares, shares);
  total (&all_edges, edges);
}

const ClothDotKernels CLOTH_SIMD_NAME (cloth_dot_kernels) = {
  find_bounds, find_bits, find_rows, add_ring, add_inside, weigh
};
