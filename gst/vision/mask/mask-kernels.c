/* What the silhouette does to every pixel. Sums are of whole numbers, the rest pixel by
 * pixel.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/mask/mask-private.h"

#include <string.h>

#define INLINE static inline __attribute__((always_inline))
/* Pixels that are looked at together. */
#define CHUNK 64

static void
add_row (const guint8 * film, const guint8 * ground, gint width, gint32 sign,
    gint32 * const sums[3])
{
  gint32 *restrict ff = sums[0], *restrict fg = sums[1], *restrict gg = sums[2];

  for (gint x = 0; x < width; x++) {
    const gint32 f = film[x], g = ground[x];

    ff[x] += sign * (f * f);
    fg[x] += sign * (f * g);
    gg[x] += sign * (g * g);
  }
}

/* Sums of @n windows that begin with the columns from @from on. */
INLINE void
window (const gint32 * from, gint radius, gint n, gfloat * restrict to)
{
  gint32 total[CHUNK] = { 0 };

  for (gint k = 0; k <= 2 * radius; k++)
    for (gint i = 0; i < n; i++)
      total[i] += from[i + k];
  for (gint i = 0; i < n; i++)
    to[i] = (gfloat) total[i];
}

/* The gain a that makes Σ(f − a·g)² least is Σfg / Σg². */
INLINE void
test_luma (const ClothMaskTest * test, gint32 * const sums[3], gint x, gint n,
    gfloat * restrict gains, guint8 * restrict hits)
{
  const gfloat shadow = test->shadow, glow = test->glow;
  const gfloat *limits = test->limits + x;
  gfloat ff[CHUNK], fg[CHUNK], gg[CHUNK];

  window (sums[0] + x, test->radius, n, ff);
  window (sums[1] + x, test->radius, n, fg);
  window (sums[2] + x, test->radius, n, gg);
  for (gint i = 0; i < n; i++) {
    const gfloat best = fg[i] / (gg[i] > 1 ? gg[i] : 1);
    const gfloat bright = best > shadow ? best : shadow;
    const gfloat gain = bright < glow ? bright : glow;

    gains[x + i] = gain;
    hits[x + i] = ff[i] - gain * (2 * fg[i] - gain * gg[i]) > limits[i];
  }
}

static void
test_row (const ClothMaskTest * test, gint32 * const sums[3], gint width,
    gfloat * gains, guint8 * hits)
{
  gint x = 0;

  /* the compiler makes better vectors of a number that it knows */
  for (; x + CHUNK <= width; x += CHUNK)
    test_luma (test, sums, x, CHUNK, gains, hits);
  test_luma (test, sums, x, width - x, gains, hits);
}

static void
test_chroma (const ClothMaskTest * test, gint32 * const sums[4], gint width,
    const gfloat * gains, guint8 * hits)
{
  for (gint x = 0; x < width; x += CHUNK) {
    const gint n = MIN (CHUNK, width - x);
    gfloat off[CHUNK] = { 0 };

    for (gint c = 0; c < 4; c += 2) {
      const gfloat bias = test->bias[c / 2];
      gfloat film[CHUNK], ground[CHUNK];

      window (sums[c] + x, test->radius, n, film);
      window (sums[c + 1] + x, test->radius, n, ground);
      for (gint i = 0; i < n; i++) {
        const gfloat d = film[i] - gains[x + i] * ground[i] - bias;

        off[i] += d * d;
      }
    }
    for (gint i = 0; i < n; i++)
      hits[x + i] = off[i] > test->limits[x + i];
  }
}

/* Sorts the samples of each byte by exchanges of neighbours (odd–even transposition). */
static void
median (guint8 * const *samples, guint n, gsize size, guint8 * to)
{
  for (gsize x = 0; x < size; x += CHUNK) {
    const gsize some = MIN (CHUNK, size - x);
    guint8 sorted[CLOTH_MASK_SAMPLES][CHUNK] = { {0} };

    for (guint k = 0; k < n; k++)
      memcpy (sorted[k], samples[k] + x, some);
    for (guint turn = 0; turn < n; turn++)
      for (guint k = turn & 1; k + 1 < n; k += 2)
        for (gint i = 0; i < CHUNK; i++) {
          const guint8 a = sorted[k][i], b = sorted[k + 1][i];

          sorted[k][i] = MIN (a, b);
          sorted[k + 1][i] = MAX (a, b);
        }
    memcpy (to + x, sorted[(n - 1) / 2], some);
  }
}

const ClothMaskKernels CLOTH_SIMD_NAME (cloth_mask_kernels) = {
  add_row, test_row, test_chroma, median
};
