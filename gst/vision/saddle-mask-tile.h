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

/* Along a row: from bytes to even and odd columns of 16 bits. For odd columns the same
 * pairs of bytes serve with the weights moved by one. */
INLINE void
NAME (across) (guint16 * out, gint n, gint from, gint to, const guint8 * line,
    const gint8 * taps, const gint n_pairs)
{
  VEC even[CLOTH_SADDLE_MAX_RADIUS + 1], odd[CLOTH_SADDLE_MAX_RADIUS + 1];

  for (gint k = 0; k < n_pairs; k++) {
    even[k] = PAIR (taps[2 * k], taps[2 * k + 1]);
    odd[k] = PAIR (k > 0 ? taps[2 * k - 1] : 0, taps[2 * k]);
  }
  for (gint i = from; i < to; i += LANES) {
    VEC in = LOAD (line + 2 * i);
    VEC a = MUL_BYTES (in, even[0]), b = MUL_BYTES (in, odd[0]);
#pragma GCC unroll 16
    for (gint k = 1; k < n_pairs; k++) {
      in = LOAD (line + 2 * i + 2 * k);
      a = ADD (a, MUL_BYTES (in, even[k]));
      b = ADD (b, MUL_BYTES (in, odd[k]));
    }
    STORE (out + i, a);
    STORE (out + n + i, b);
  }
}

/* Across rows, two of them at once: the middle row and those at equal distances,
 * averaged in pairs. */
INLINE void
NAME (down) (guint16 * out0, guint16 * out1, gint n, guint16 * const *rows,
    const guint16 * weights, const gint radius)
{
  VEC weight[CLOTH_SADDLE_MAX_RADIUS + 1];
  const guint16 *row[2 * CLOTH_SADDLE_MAX_RADIUS + 2];

  /* Copies the compiler knows nobody else writes to. */
  for (gint k = 0; k <= radius; k++)
    weight[k] = SET (weights[k]);
  for (gint k = 0; k <= 2 * radius + 1; k++)
    row[k] = rows[k];
  for (gint i = 0; i < 2 * n; i += LANES) {
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

/* Two determinants, one above the other, from four rows that follow each other. */
INLINE void
NAME (determinants) (VEC * out, const guint16 * const *at, gssize before,
    gssize after)
{
  VEC left[4], middle[4], right[4];

  for (gint k = 0; k < 4; k++) {
    left[k] = LOAD (at[k] + before);
    middle[k] = LOAD (at[k]);
    right[k] = LOAD (at[k] + after);
  }
  for (gint k = 0; k < 2; k++) {
    VEC twice = ADD (middle[1 + k], middle[1 + k]);
    VEC fxx = SUB (ADD (left[1 + k], right[1 + k]), twice);
    VEC fyy = SUB (ADD (middle[k], middle[2 + k]), twice);
    VEC fxy = SUB (SUB (right[2 + k], right[k]), SUB (left[2 + k], left[k]));
    out[k] = SUB (MUL_HIGH (TIMES_4 (fxx), TIMES_4 (fyy)), MUL_HIGH (fxy,
            fxy));
  }
}

INLINE VEC
NAME (determinant) (const guint16 * a, const guint16 * b, const guint16 * c,
    gssize before, gssize after)
{
  VEC twice = ADD (LOAD (b), LOAD (b));
  VEC fyy = SUB (ADD (LOAD (a), LOAD (c)), twice);
  VEC fxx = SUB (ADD (LOAD (b + before), LOAD (b + after)), twice);
  VEC fxy = SUB (SUB (LOAD (c + after), LOAD (a + after)),
      SUB (LOAD (c + before), LOAD (a + before)));

  return SUB (MUL_HIGH (TIMES_4 (fxx), TIMES_4 (fyy)), MUL_HIGH (fxy, fxy));
}

/* Two rows of bits and determinants. Determinants are always written, and kept if a bit
 * is set. */
INLINE void
NAME (rows) (ClothSaddleMask * mask, gint row, gint word_0, gint words, gint n,
    gint threshold, const gint h, guint16 * const *smooth)
{
  const gssize odd = n;
  /* From an even column its neighbours at h, then from an odd one. */
  const gssize even_before = h % 2 ? odd - (h + 1) / 2 : -(h / 2);
  const gssize even_after = h % 2 ? odd + (h - 1) / 2 : h / 2;
  const gssize odd_before = h % 2 ? -odd - (h - 1) / 2 : -(h / 2);
  const gssize odd_after = h % 2 ? -odd + (h + 1) / 2 : h / 2;
  const VEC bound = SET (-threshold);
  const gsize first = (gsize) row * (gsize) mask->words + (gsize) word_0;
  guint64 *bits[2] = { mask->bits + first, mask->bits + first + mask->words };
  guint32 *block = mask->blocks + (gsize) (row / 2) * (gsize) mask->words + (gsize) word_0;
  guint32 next = mask->n_blocks;

  for (gint w = 0; w < words; w++) {
    guint64 word[2] = { 0, 0 };
    for (gint part = 0; part < 32; part += LANES) {
      gint i = MARGIN / 2 + 32 * w + part;
      VEC e[2], o[2];

      if (h == 1) {
        const guint16 *even_at[4] = { smooth[0] + i, smooth[1] + i,
          smooth[2] + i, smooth[3] + i
        };
        const guint16 *odd_at[4] = { even_at[0] + odd, even_at[1] + odd,
          even_at[2] + odd, even_at[3] + odd
        };
        NAME (determinants) (e, even_at, even_before, even_after);
        NAME (determinants) (o, odd_at, odd_before, odd_after);
      } else {
        for (gint k = 0; k < 2; k++) {
          const guint16 *a = smooth[k] + i, *b = smooth[h + k] + i;
          const guint16 *c = smooth[2 * h + k] + i;
          e[k] = NAME (determinant) (a, b, c, even_before, even_after);
          o[k] = NAME (determinant) (a + odd, b + odd, c + odd, odd_before,
              odd_after);
        }
      }
      for (gint k = 0; k < 2; k++) {
        gint16 *det = mask->det + 64 * ((gsize) next + (gsize) k) + part;

        word[k] |= (guint64) BITS_BELOW (e[k], o[k], bound) << (2 * part);
        STORE (det, e[k]);
        STORE (det + 32, o[k]);
      }
    }
    /* A branch would often be guessed wrongly. */
    block[w] = next;
    next += word[0] | word[1] ? 2 : 0;
    bits[0][w] = word[0];
    bits[1][w] = word[1];
  }
  mask->n_blocks = next;
}

/* Straight from the picture where whole vectors lie in it, else by a copy with the border
 * repeated. */
INLINE void
NAME (image_row) (guint16 * out, gint n, gint x, gint y,
    const ClothImage * image, guint8 * line, const gint8 * taps, const gint r)
{
  const guint8 *row = image->data + (gsize) CLAMP (y, 0, image->height - 1) *
      (gsize) image->stride;
  gint inside = image->width - x - 2 * r - 2 * LANES;
  gint from = MIN (x < 0 ? (-x + 2 * LANES - 1) / (2 * LANES) * LANES : 0, n);
  gint to = inside < 0 ? from :
      CLAMP ((inside / (2 * LANES) + 1) * LANES, from, n);

  if (y >= 0 && y + 4 < image->height) {
    /* The rows after this one are not in the cache yet. */
    for (gint i = from; i < to; i += 32)
      __builtin_prefetch (row + 4 * (gsize) image->stride + x + 2 * i);
  }
  cloth_saddle_copy_row (line, image, x, y, 2 * from + 2 * r);
  NAME (across) (out, n, 0, from, line, taps, r + 1);
  NAME (across) (out, n, from, to, row + x, taps, r + 1);
  cloth_saddle_copy_row (line + 2 * to, image, x + 2 * to, y,
      2 * (n - to) + 2 * r);
  NAME (across) (out, n, to, n, line, taps, r + 1);
}

INLINE void
NAME (tile_of) (ClothSaddleMask * mask, const ClothSaddleKernel * kernel,
    const ClothImage * image, gint threshold, gint word, gint words,
    guint8 * scratch, const gint r, const gint h)
{
  const gint n = CLOTH_SADDLE_TILE_LANES (words);
  const gsize row_size = CLOTH_SADDLE_TILE_ROW (words);
  const gint x = mask->x + 64 * word - MARGIN;
  const gint line_size = 2 * n + 2 * r + 2;
  guint16 *smooth[2 * CLOTH_SADDLE_MAX_STEP + 2];
  guint16 *ring[2 * CLOTH_SADDLE_MAX_RADIUS + 2];
  guint8 *line;

  /* Of the smoothed rows the columns inside the margin are aligned: they are read far
   * oftener than written. */
  for (gint k = 0; k < 2 * h + 2; k++)
    smooth[k] = (guint16 *) scratch + row_size * (gsize) k + 32 - MARGIN / 2;
  scratch += 2 * (row_size * (gsize) (2 * h + 2) + 32);
  for (gint k = 0; k < 2 * r + 2; k++)
    ring[k] = (guint16 *) scratch + row_size * (gsize) k;
  line = scratch + 2 * row_size * (gsize) (2 * r + 2);
  memset (line, 0, (gsize) line_size + 64);

  /* Two rows a round; the pass down lags 2r rows behind, the determinant 2h more. */
  for (gint i = 0; i < mask->height + 2 * (h + r); i += 2) {
    guint16 *oldest[2] = { ring[0], ring[1] };
    gint row = i - 2 * r - 2 * h;

    memmove (ring, ring + 2, sizeof (guint16 *) * (gsize) (2 * r));
    for (gint k = 0; k < 2; k++) {
      ring[2 * r + k] = oldest[k];
      NAME (image_row) (oldest[k], n, x - r, mask->y - h - r + i + k, image,
          line, kernel->across, r);
    }
    if (i < 2 * r)
      continue;

    oldest[0] = smooth[0];
    oldest[1] = smooth[1];
    memmove (smooth, smooth + 2, sizeof (guint16 *) * (gsize) (2 * h));
    smooth[2 * h] = oldest[0];
    smooth[2 * h + 1] = oldest[1];
    NAME (down) (oldest[0], oldest[1], n, ring, kernel->down, r);
    if (row < 0)
      continue;

    /* The mask has room for the row after an odd number. */
    NAME (rows) (mask, row, word, words, n, threshold, h, smooth);
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
