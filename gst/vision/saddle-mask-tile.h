/* One tile of the hyperbolic mask by vector instructions. Included by saddle-mask-x86.c
 * once for each instruction set, with the names of its operations defined.
 *
 * Even and odd columns lie apart: the pass along rows multiplies pairs of neighbouring
 * bytes, which gives every second column, and what the later steps add or multiply stands
 * in equal lanes. A tile is as wide as lets its rows stay in the first-level cache.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */

#define NAME_(a, b) a##_##b
#define NAME__(a, b) NAME_ (a, b)
#define NAME(a) NAME__ (a, SUFFIX)
#define INLINE TARGET static inline __attribute__((always_inline))

/* Along a row: from bytes to even and odd columns of 16 bits. */
INLINE void
NAME (across) (guint16 * out, gint n, const guint8 * line, const gint8 * taps,
    const gint n_pairs)
{
  for (gint phase = 0; phase < 2; phase++) {
    guint16 *o = out + phase * (n + GAP);
    for (gint i = 0; i < n; i += LANES) {
      const guint8 *in = line + 2 * i + phase;
      VEC sum = MUL_BYTES (LOAD (in), PAIR (taps));
#pragma GCC unroll 16
      for (gint k = 1; k < n_pairs; k++)
        sum = ADD (sum, MUL_BYTES (LOAD (in + 2 * k), PAIR (taps + 2 * k)));
      STORE (o + i, sum);
    }
  }
}

/* Across rows: the middle one and those at equal distances, averaged in pairs. */
INLINE void
NAME (down) (guint16 * out, gint n, guint16 * const *rows,
    const guint16 * weights, const gint radius)
{
  for (gint phase = 0; phase < 2; phase++) {
    gsize offset = (gsize) (phase * (n + GAP));
    for (gint i = 0; i < n; i += LANES) {
      gsize at = offset + (gsize) i;
      VEC sum = MUL_HIGH_U (LOAD (rows[radius] + at), SET (weights[0]));
#pragma GCC unroll 16
      for (gint k = 1; k <= radius; k++) {
        VEC pair = AVERAGE (LOAD (rows[radius - k] + at),
            LOAD (rows[radius + k] + at));
        sum = ADD (sum, MUL_HIGH_U (pair, SET (weights[k])));
      }
      STORE (out + at, sum);
    }
  }
}

INLINE VEC
NAME (determinant) (const guint16 * a, const guint16 * b, const guint16 * c,
    gssize before, gssize after)
{
  VEC middle = LOAD (b), twice = ADD (middle, middle);
  VEC fyy = SUB (ADD (LOAD (a), LOAD (c)), twice);
  VEC fxx = SUB (ADD (LOAD (b + before), LOAD (b + after)), twice);
  VEC fxy = SUB (SUB (LOAD (c + after), LOAD (a + after)),
      SUB (LOAD (c + before), LOAD (a + before)));

  return SUB (MUL_HIGH (TIMES_4 (fxx), TIMES_4 (fyy)), MUL_HIGH (fxy, fxy));
}

INLINE void
NAME (row) (guint64 * bits, gint16 * det, gint words, gint n, gint threshold,
    gint h, const guint16 * a, const guint16 * b, const guint16 * c)
{
  const gssize odd = n + GAP;
  /* From an even column its neighbours at h, then from an odd one. */
  const gssize even_before = h % 2 ? odd - (h + 1) / 2 : -(h / 2);
  const gssize even_after = h % 2 ? odd + (h - 1) / 2 : h / 2;
  const gssize odd_before = h % 2 ? -odd - (h - 1) / 2 : -(h / 2);
  const gssize odd_after = h % 2 ? -odd + (h + 1) / 2 : h / 2;
  const VEC bound = SET ((gint16) - threshold);

  for (gint w = 0; w < words; w++) {
    guint64 word = 0;
    for (gint part = 0; part < 32; part += LANES) {
      gint i = MARGIN / 2 + 32 * w + part;
      VEC even = NAME (determinant) (a + i, b + i, c + i, even_before,
          even_after);
      VEC uneven = NAME (determinant) (a + i + odd, b + i + odd, c + i + odd,
          odd_before, odd_after);
      if (ANY_BELOW (even, uneven, bound)) {
        word |= (guint64) BITS_BELOW (even, uneven, bound) << (2 * part);
        STORE_MIXED (det + 64 * w + 2 * part, even, uneven);
      }
    }
    bits[w] = word;
  }
}

INLINE void
NAME (tile_of) (ClothSaddleMask * mask, const ClothSaddleKernel * kernel,
    const ClothImage * image, gint threshold, gint word, gint words,
    guint8 * scratch, const gint r, const gint h)
{
  const gint n = CLOTH_SADDLE_TILE_LANES (words);
  const gsize row_size = 2 * (gsize) (n + GAP);
  const gint x = mask->x + 64 * word - MARGIN;
  const gint line_size = 2 * n + 2 * r + 2;
  guint16 *smooth[2 * CLOTH_SADDLE_MAX_STEP + 1];
  guint16 *ring[2 * CLOTH_SADDLE_MAX_RADIUS + 1];
  guint8 *line;

  /* The determinant's columns, not those of the margin, are aligned. */
  for (gint k = 0; k <= 2 * h; k++)
    smooth[k] = (guint16 *) scratch + row_size * (gsize) k + 32 - MARGIN / 2;
  for (gint k = 0; k <= 2 * r; k++)
    ring[k] = (guint16 *) scratch + row_size * (gsize) (2 * h + 1 + k) + 32 -
        MARGIN / 2;
  line = (guint8 *) ((guint16 *) scratch + row_size *
      (gsize) (2 * h + 2 * r + 2) + 64);
  memset (line + line_size, 0, 64);

  for (gint y = mask->y - h - r; y < mask->y + mask->height + h + r; y++) {
    guint16 *oldest = ring[0];
    gint below = y - r, centre = below - h;

    memmove (ring, ring + 1, sizeof (guint16 *) * (gsize) (2 * r));
    ring[2 * r] = oldest;
    cloth_saddle_copy_row (line, image, x - r, y, line_size);
    NAME (across) (oldest, n, line, kernel->across, r + 1);
    if (below < mask->y - h)
      continue;

    oldest = smooth[0];
    memmove (smooth, smooth + 1, sizeof (guint16 *) * (gsize) (2 * h));
    smooth[2 * h] = oldest;
    NAME (down) (oldest, n, ring, kernel->down, r);
    if (centre < mask->y)
      continue;

    {
      gsize at = (gsize) (centre - mask->y) * (gsize) mask->words +
          (gsize) word;
      NAME (row) (mask->bits + at, mask->det + at * 64, words, n, threshold,
          h, smooth[0], smooth[h], smooth[2 * h]);
    }
  }
}

/* Loops of known length for the widths most asked for. */
TARGET void
NAME (cloth_saddle_mask_tile) (ClothSaddleMask * mask,
    const ClothSaddleKernel * kernel, const ClothImage * image,
    gint threshold, gint word, gint words, guint8 * scratch)
{
  if (kernel->radius == 4 && kernel->step == 1)
    NAME (tile_of) (mask, kernel, image, threshold, word, words, scratch, 4,
        1);
  else if (kernel->radius == 3 && kernel->step == 1)
    NAME (tile_of) (mask, kernel, image, threshold, word, words, scratch, 3,
        1);
  else
    NAME (tile_of) (mask, kernel, image, threshold, word, words, scratch,
        kernel->radius, kernel->step);
}

#undef NAME_
#undef NAME__
#undef NAME
#undef INLINE
