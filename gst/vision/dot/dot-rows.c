/* Dot detection, per pixel: bounds of tiles, bits above a threshold. Whole numbers only,
 * so that vectors and portable C give the same.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/dot/dot-rows.h"

#include <string.h>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#define TILE CLOTH_DOT_TILE

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

#ifdef __SSE2__
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

/* Least and greatest luma of the tiles in row @tile_row; the last ones may be cut. */
void
cloth_dot_tile_bounds (const ClothImage * image, gint tile_row,
    guint8 * least, guint8 * most, ClothSimd level)
{
  const gint y0 = tile_row * TILE;
  const gint rows = MIN (TILE, image->height - y0);
  const guint8 *data = image->data + (gsize) y0 * (gsize) image->stride;

  for (gint x = 0, t = 0; x < image->width; x += TILE, t++) {
#ifdef __SSE2__
    if (level != CLOTH_SIMD_SCALAR && x + TILE <= image->width) {
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

/* For each tile's 16 pixels of a row a bit for each that is above the tile's threshold,
 * the leftmost lowest. */
void
cloth_dot_row_bits (const guint8 * row, gint width,
    const guint8 * thresholds, guint16 * bits, ClothSimd level)
{
  for (gint x = 0, t = 0; x < width; x += TILE, t++) {
#ifdef __SSE2__
    if (level != CLOTH_SIMD_SCALAR && x + TILE <= width) {
      bits[t] = tile_bits (row + x, thresholds[t]);
      continue;
    }
#endif
    bits[t] = span_bits (row + x, MIN (TILE, width - x), thresholds[t]);
  }
}
