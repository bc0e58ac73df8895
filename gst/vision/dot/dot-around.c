/* What lies about a spot: the ground around it, the colour inside, noise. Whole numbers
 * only, so that all instruction sets give the same.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/dot/dot-around.h"

#include <math.h>
#include <string.h>

#include "gst/vision/dot/dot-rows.h"

#define TILE CLOTH_DOT_TILE
#define MARGIN CLOTH_DOT_MARGIN
/* How far the ring in which the ground is looked for goes beyond the window, px. */
#define RING 2.0
/* Half-axes of the inside, of the spot's. */
#define INSIDE 0.5
/* Fewest pixels that give the ground. */
#define MIN_GROUND 8
/* Least luma of a dot above its ground over the ground: the noise of a bright wall gives
 * spots as well. */
#define LEAST_WEBER 0.25f
/* Least share of the ring about a spot that was cut from another that is ground. */
#define LEAST_GROUND 0.5f

#define INLINE static inline __attribute__((always_inline))

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

/* Where the ellipses about @spot are. */
void
cloth_dot_find_rows (const ClothDotDetector * detector,
    const ClothDotCandidate * spot, ClothDotRows * rows)
{
  const ClothImage *luma = &detector->image->luma;
  const ClothDotEllipse inside = cloth_dot_ellipse (&spot->axes, INSIDE, 0);
  gint y1;

  rows->window = cloth_dot_ellipse (&spot->axes, 1, MARGIN);
  rows->ring = cloth_dot_ellipse (&spot->axes, 1, MARGIN + RING);
  rows->y0 = MAX (0, (gint) ceil (spot->y - rows->ring.height));
  y1 = MIN (luma->height - 1, (gint) floor (spot->y + rows->ring.height));
  rows->n = CLAMP (y1 - rows->y0 + 1, 0, CLOTH_DOT_MAX_ROWS);
  rows->inside_y0 = MAX (0, (gint) floor (spot->y - inside.height));
  y1 = MIN (luma->height - 1, (gint) ceil (spot->y + inside.height));
  rows->inside_n = CLAMP (y1 - rows->inside_y0 + 1, 0, CLOTH_DOT_MAX_ROWS);
  cloth_dot_ellipse_rows (&inside, spot->x, spot->y, rows->inside_y0,
      rows->inside_n, luma->width, rows->inside.first, rows->inside.last,
      detector->level);
  cloth_dot_ellipse_rows (&rows->window, spot->x, spot->y, rows->y0, rows->n,
      luma->width, rows->weighed.first, rows->weighed.last, detector->level);
  cloth_dot_ellipse_rows (&rows->ring, spot->x, spot->y, rows->y0, rows->n,
      luma->width, rows->around.first, rows->around.last, detector->level);
}

/* --- kernels ------------------------------------------------------------------------ */

typedef struct
{
  gint64 sum, n;
} Tally;

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

/* Sums and counts the ring's pixels that are not above @most. */
INLINE void
add_ring (const ClothImage * luma, const ClothDotCandidate * spot,
    const ClothDotRows * rows, guint8 most, Tally * tally)
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

/* Sums the inside's pixels, and what of noise is there. */
INLINE void
add_inside (const ClothImage * luma, const ClothDotRows * rows, Tally * tally,
    ClothDotBends * bends)
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

static void
add_ring_plain (const ClothImage * luma, const ClothDotCandidate * spot,
    const ClothDotRows * rows, guint8 most, Tally * tally)
{
  add_ring (luma, spot, rows, most, tally);
}

static void
add_inside_plain (const ClothImage * luma, const ClothDotRows * rows,
    Tally * tally, ClothDotBends * bends)
{
  add_inside (luma, rows, tally, bends);
}

#if defined (__x86_64__) && defined (__GNUC__)
#pragma GCC push_options
#pragma GCC target ("avx2")
static void
add_ring_avx2 (const ClothImage * luma, const ClothDotCandidate * spot,
    const ClothDotRows * rows, guint8 most, Tally * tally)
{
  add_ring (luma, spot, rows, most, tally);
}

static void
add_inside_avx2 (const ClothImage * luma, const ClothDotRows * rows,
    Tally * tally, ClothDotBends * bends)
{
  add_inside (luma, rows, tally, bends);
}

#pragma GCC pop_options
#else
#define add_ring_avx2 add_ring_plain
#define add_inside_avx2 add_inside_plain
#endif

/* --- what comes of them --------------------------------------------------------------- */

static Tally
tally_ring (const ClothDotDetector * detector, const ClothDotCandidate * spot,
    const ClothDotRows * rows, guint8 most)
{
  Tally tally = { 0 };

  if (detector->level >= CLOTH_SIMD_AVX2)
    add_ring_avx2 (&detector->image->luma, spot, rows, most, &tally);
  else
    add_ring_plain (&detector->image->luma, spot, rows, most, &tally);
  return tally;
}

/* Does a spot that was cut from another stand out? Where a wall's noise was cut there is
 * hardly any ground about it. */
static gboolean
is_apart (const ClothDotDetector * detector, const ClothDotCandidate * spot,
    const ClothDotRows * rows, const ClothDot * dot)
{
  const guint8 middle = (guint8) ((dot->colour[0] + dot->background) / 2);
  const Tally dark = tally_ring (detector, spot, rows, middle);
  const Tally all = tally_ring (detector, spot, rows, 255);

  return (gfloat) dark.n >= LEAST_GROUND * (gfloat) all.n;
}

static gint64
sum_chroma (const ClothDotImage * image, const ClothDotRows * rows, gint k)
{
  gint64 sum = 0;

  for (gint i = 0; i < rows->inside_n; i++) {
    const guint8 *chroma = image->chroma[k]
        + (gsize) ((rows->inside_y0 + i) >> image->chroma_shift[1])
        * (gsize) image->chroma_stride;

    for (gint x = rows->inside.first[i]; x <= rows->inside.last[i]; x++)
      sum += chroma[(x >> image->chroma_shift[0]) * image->chroma_step];
  }
  return sum;
}

/* Luma of the ground, mean colour of the inside, noise. FALSE when there is no inside or
 * too little contrast. */
gboolean
cloth_dot_look_around (const ClothDotDetector * detector,
    const ClothDotCandidate * spot, const ClothDotRows * rows, ClothDot * dot,
    ClothDotBends * bends)
{
  const ClothDotImage *image = detector->image;
  Tally ground, bright = { 0 };

  if (detector->level >= CLOTH_SIMD_AVX2)
    add_inside_avx2 (&image->luma, rows, &bright, bends);
  else
    add_inside_plain (&image->luma, rows, &bright, bends);
  if (bright.n == 0)
    return FALSE;
  ground = tally_ring (detector, spot, rows, spot->threshold);
  dot->background = ground.n >= MIN_GROUND
      ? (gfloat) ground.sum / (gfloat) ground.n
      : (gfloat) detector->low[(gint) spot->y / TILE * detector->columns
      + (gint) spot->x / TILE];
  dot->colour[0] = (gfloat) bright.sum / (gfloat) bright.n;
  if (dot->colour[0] - dot->background < MAX (detector->params.contrast,
          LEAST_WEBER * dot->background))
    return FALSE;
  for (gint k = 0; k < 2; k++)
    dot->colour[1 + k] = image->chroma[k]
        ? (gfloat) sum_chroma (image, rows, k) / (gfloat) bright.n : 128;
  return !spot->touches || is_apart (detector, spot, rows, dot);
}
