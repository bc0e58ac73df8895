/* Masks of one bit a pixel: erosion and opening by squares, 64 pixels at once.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/mask/bits.h"

#include <string.h>

/* The bits of the last word that are in the picture. */
static guint64
last_bits (gint width)
{
  return width % 64 ? ((guint64) 1 << width % 64) - 1 : ~(guint64) 0;
}

/* @bytes: a row of 0 and 1; up to the next multiple of 8 there is memory, of any content
 * @width: columns
 * @bits: (out): the row
 */
void
cloth_bits_pack (const guint8 * bytes, gint width, guint64 * bits)
{
  for (gint x = 0; x < width; x += 64) {
    guint64 word = 0;

    for (gint i = 0; i < 64 && x + i < width; i += 8) {
      guint64 eight;

      memcpy (&eight, bytes + x + i, 8);
      /* the product's highest byte has one bit of each */
      eight = (GUINT64_FROM_LE (eight) & 0x0101010101010101) *
          0x0102040810204080;
      word |= eight >> 56 << i;
    }
    bits[x / 64] = word;
  }
  bits[(width - 1) / 64] &= last_bits (width);
}

/* Beyond the picture all bits are set. */
static void
erode_row (guint64 * row, gint n_words, guint64 last, gint radius)
{
  for (gint turn = 0; turn < radius; turn++) {
    guint64 left = 1;           /* the bit before this word */

    row[n_words - 1] |= ~last;
    for (gint k = 0; k < n_words; k++) {
      const guint64 word = row[k];
      const guint64 right = k + 1 < n_words ? row[k + 1] & 1 : 1;

      row[k] = word & (word << 1 | left) & (word >> 1 | right << 63);
      left = word >> 63;
    }
  }
}

/* @bits: (inout): a mask
 * @spare: memory of its size
 * @width: columns
 * @height: rows
 * @radius: pixels nearer than this to one that is not set, along rows or columns, are
 *   cleared too; the picture's border is none
 */
void
cloth_bits_erode (guint64 * bits, guint64 * spare, gint width, gint height,
    gint radius)
{
  const gint n_words = (width + 63) / 64;
  const guint64 last = last_bits (width);

  for (gint y = 0; y < height; y++)
    erode_row (bits + (gsize) y * (gsize) n_words, n_words, last, radius);
  for (gint turn = 0; turn < radius; turn++) {
    memcpy (spare, bits, (gsize) height * (gsize) n_words * 8);
    for (gsize i = 0, n = (gsize) (height - 1) * (gsize) n_words; i < n; i++) {
      bits[i] &= spare[i + (gsize) n_words];
      bits[i + (gsize) n_words] &= spare[i];
    }
  }
  for (gint y = 0; y < height; y++)
    bits[(gsize) (y + 1) * (gsize) n_words - 1] &= last;
}

static void
invert (guint64 * bits, gint width, gint height)
{
  const gint n_words = (width + 63) / 64;
  const guint64 last = last_bits (width);

  for (gint y = 0; y < height; y++, bits += n_words) {
    for (gint k = 0; k < n_words; k++)
      bits[k] = ~bits[k];
    bits[n_words - 1] &= last;
  }
}

/* @bits: (inout): a mask
 * @spare: memory of its size
 * @width: columns
 * @height: rows
 * @radius: what no square of 2·@radius + 1 px covers that is set throughout is cleared;
 *   beyond the border all is set
 */
void
cloth_bits_open (guint64 * bits, guint64 * spare, gint width, gint height,
    gint radius)
{
  if (radius == 0)
    return;
  cloth_bits_erode (bits, spare, width, height, radius);
  invert (bits, width, height);
  cloth_bits_erode (bits, spare, width, height, radius);
  invert (bits, width, height);
}
