/* The loops over the rows of a surface.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/render/surface-private.h"

#include <string.h>

#define PLACE CLOTH_SURFACE_PLACE_BITS

#define INLINE static inline __attribute__((always_inline))

typedef guint8 U8x4 __attribute__((vector_size (4)));
typedef guint8 U8x8 __attribute__((vector_size (8)));
typedef guint16 U16x4 __attribute__((vector_size (8)));
typedef guint16 U16x8 __attribute__((vector_size (16)));

/* Two neighbours of a row, all channels. */
static inline U16x8
pair (const guint32 * at)
{
  U8x8 bytes;

  memcpy (&bytes, at, sizeof bytes);
  return __builtin_convertvector (bytes, U16x8);
}

static void
fill (const ClothSurfaceSpan * span, guint32 * colours, gfloat * depths)
{
  const ClothSurfaceLevel *level = span->level;
  const gsize stride = (gsize) level->width + 1;
  gint32 u = span->u, v = span->v, light = span->light;

  for (gint x = 0; x < span->n; x++) {
    const gfloat w = span->w + (gfloat) x * span->w_step;

    if (w > depths[x]) {
      const guint32 *at = level->pixels + (gsize) (v >> PLACE) * stride +
          (u >> PLACE);
      const guint16 fx = (guint16) (u >> (PLACE - 8) & 255);
      const guint16 fy = (guint16) (v >> (PLACE - 8) & 255);
      const guint16 part = (guint16) (light >> PLACE);
      /* 255 · 256 fits into sixteen bits */
      const U16x8 both = (pair (at) * (guint16) (256 - fy) +
          pair (at + stride) * fy) >> 8;
      const U16x4 left = __builtin_shufflevector (both, both, 0, 1, 2, 3);
      const U16x4 right = __builtin_shufflevector (both, both, 4, 5, 6, 7);
      const U16x4 one = (left * (guint16) (256 - fx) + right * fx) >> 8;
      const U8x4 bytes = __builtin_convertvector ((one * part) >> 8, U8x4);
      guint32 colour;

      memcpy (&colour, &bytes, sizeof colour);
      depths[x] = w;
      colours[x] = colour | 0xff000000u;
    }
    u += span->u_step;
    v += span->v_step;
    light += span->light_step;
  }
}

static inline gint
value_of (const gint * weights, gint r, gint g, gint b)
{
  const gint value = (weights[0] * r + weights[1] * g + weights[2] * b +
      weights[3]) >> CLOTH_SURFACE_WEIGHT_BITS;

  return CLAMP (value, 0, 255);
}

INLINE void
lay_steps (const guint32 * colours, gint n,
    const gint * weights, gint opacity, guint8 * to, gint step)
{
  for (gint x = 0; x < n; x++) {
    const guint32 c = colours[x];
    const gint value = value_of (weights, c & 255, c >> 8 & 255,
        c >> 16 & 255);
    const gint part = c >> 31 ? opacity : 0;

    to[x * step] = (guint8) ((to[x * step] * (256 - part) + value * part
            + 128) >> 8);
  }
}

static void
lay (const guint32 * colours, gint n, const gint * weights,
    gint opacity, guint8 * to, gint step)
{
  if (step == 1)
    lay_steps (colours, n, weights, opacity, to, 1);
  else if (step == 4)
    lay_steps (colours, n, weights, opacity, to, 4);
  else
    lay_steps (colours, n, weights, opacity, to, step);
}

/* The mean over the covered ones of four pixels, by their share. */
INLINE void
lay_half_steps (const guint32 * upper,
    const guint32 * lower, gint n, const gint * weights, gint opacity,
    guint8 * to, gint step)
{
  /* 1 / count, 16 bits */
  static const gint inverse[5] = { 0, 65536, 32768, 21846, 16384 };

  for (gint x = 0; x < n; x++) {
    const guint32 a = upper[2 * x], b = upper[2 * x + 1];
    const guint32 c = lower[2 * x], d = lower[2 * x + 1];
    const gint count = (gint) ((a >> 31) + (b >> 31) + (c >> 31) + (d >> 31));
    const gint over = inverse[count], part = opacity * count / 4;
    const guint32 mask = 0x00ff00ff;
    /* red and blue side by side, green */
    const guint32 rb = (a & mask) + (b & mask) + (c & mask) + (d & mask);
    const guint32 g = (a >> 8 & 255) + (b >> 8 & 255) + (c >> 8 & 255) +
        (d >> 8 & 255);
    const gint value = value_of (weights, (gint) (rb & 0xffff) * over
        >> 16, (gint) g * over >> 16, (gint) (rb >> 16) * over >> 16);

    to[x * step] = (guint8) ((to[x * step] * (256 - part) + value * part
            + 128) >> 8);
  }
}

static void
lay_half (const guint32 * upper, const guint32 * lower, gint n,
    const gint * weights, gint opacity, guint8 * to, gint step)
{
  if (step == 1)
    lay_half_steps (upper, lower, n, weights, opacity, to, 1);
  else
    lay_half_steps (upper, lower, n, weights, opacity, to, step);
}

const ClothSurfaceRows CLOTH_SIMD_NAME (cloth_surface_rows) =
    { fill, lay, lay_half };
