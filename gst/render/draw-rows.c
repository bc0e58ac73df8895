/* The loops over the rows of lines and quadrilaterals.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/render/draw-private.h"

#include <math.h>
#include <string.h>

#define CHUNK CLOTH_DRAW_CHUNK

typedef guint8 U8 __attribute__((vector_size (CHUNK)));
typedef guint16 U16 __attribute__((vector_size (2 * CHUNK)));

#define INLINE static inline __attribute__((always_inline))

/* First and last sample of [low, high] pixels, kept inside the grid; safe for any
 * finite numbers. */
INLINE void
clip_range (gfloat low, gfloat high, gfloat offset, gfloat per_sample,
    gint size, gint * first, gint * last)
{
  gfloat a = (low - offset) * per_sample, b = (high - offset) * per_sample;

  a = CLAMP (a, 0.0f, (gfloat) size);
  b = CLAMP (b, -1.0f, (gfloat) (size - 1));
  /* ceil and floor, which plain SSE2 lacks; adding 1 keeps floor from below zero */
  *first = (gint) a + ((gfloat) (gint) a < a);
  *last = (gint) (b + 1) - 1;
}

/* Sixteen bits hold 255 · 256 + 128. */
static inline guint8
mix (guint8 old, guint16 value, guint16 coverage)
{
  return (guint8) ((guint16) (old * (guint16) (256 - coverage) +
          value * coverage + 128) >> 8);
}

static inline void
mix_chunk (guint8 * p, const U16 * value, const U16 * coverage)
{
  U8 bytes;
  U16 old;

  memcpy (&bytes, p, sizeof bytes);
  old = __builtin_convertvector (bytes, U16);
  old = (old * (256 - *coverage) + *value * *coverage + 128) >> 8;
  bytes = __builtin_convertvector (old, U8);
  memcpy (p, &bytes, sizeof bytes);
}

/* Interleaved components: each has its value and its coverage in its own bytes, and the
 * bytes of others have none. */
static inline void
mix_packed (guint8 * p, const guint16 * coverage,
    const ClothDrawInk * ink, const gint step)
{
  guint16 spread[4 * CHUNK];

  for (gint i = 0; i < CHUNK; i++)
    for (gint j = 0; j < step; j++)
      spread[step * i + j] = (guint16) (coverage[i] * ink->own[j]);
  for (gint i = 0; i < step; i++) {
    U16 value, own;

    memcpy (&value, ink->value + CHUNK * i, sizeof value);
    memcpy (&own, spread + CHUNK * i, sizeof own);
    mix_chunk (p + CHUNK * i, &value, &own);
  }
}

/* Blends @n coverages (0 … 256) at sample (x, y) of every component; those up to the whole
 * chunk are 0 and change nothing. */
static inline void
blend (const ClothDrawGroup * group, const ClothDrawInk * ink, gint x,
    gint y, const guint16 * coverage, gint n)
{
  guint8 *first = ink->data + (gsize) y * (gsize) ink->stride +
      (gsize) x * (gsize) ink->step;
  /* Strictly: the picture may end with the last component's last sample. */
  const gint room = group->width - x - CHUNK;

  if (ink->step == 4 && room > 0) {
    mix_packed (first, coverage, ink, 4);
    return;
  }
  if (ink->step == 3 && room > 0) {
    mix_packed (first, coverage, ink, 3);
    return;
  }
  if (ink->step == 2 && room > 0) {
    mix_packed (first, coverage, ink, 2);
    return;
  }
  for (gint k = 0; k < ink->n; k++) {
    const ClothComponent *c = &ink->components[k];
    const guint16 value = ink->values[k];
    guint8 *p = c->data + (gsize) y * (gsize) c->stride +
        (gsize) x * (gsize) c->step;

    if (c->step == 1 && room >= 0) {
      const U16 values = value - (U16) { 0 };
      U16 own;

      memcpy (&own, coverage, sizeof own);
      mix_chunk (p, &values, &own);
      continue;
    }
    for (gint i = 0; i < n; i++)
      p[i * c->step] = mix (p[i * c->step], value, coverage[i]);
  }
}

static void
line (const ClothDrawGroup * group, const ClothDrawInk * ink,
    const ClothDrawLine * line)
{
  const gfloat per_x = 1 / group->scale_x, per_y = 1 / group->scale_y;
  const gfloat radius = line->radius, ux = line->ux, uy = line->uy;
  const gfloat scale_x = group->scale_x, length = line->length;
  const gfloat start = group->offset_x - line->x0;
  const gfloat strength = line->strength, most = line->most;
  guint16 coverage[CHUNK];
  gint row_first, row_last;

  clip_range (MIN (line->y0, line->y1) - radius, MAX (line->y0, line->y1) +
      radius, group->offset_y, per_y, group->height, &row_first, &row_last);
  for (gint y = row_first; y <= row_last; y++) {
    const gfloat py = group->offset_y + (gfloat) y * group->scale_y - line->y0;
    const gfloat row_along = py * uy, row_across = py * ux;
    gfloat low = MIN (line->x0, line->x1) - radius;
    gfloat high = MAX (line->x0, line->x1) + radius;
    gint first, last;

    if (line->strip > 0) {
      const gfloat centre = line->x0 + py * line->slope;

      low = MAX (low, centre - line->strip * radius);
      high = MIN (high, centre + line->strip * radius);
    }
    clip_range (low, high, group->offset_x, per_x, group->width, &first, &last);
    for (gint x = first; x <= last; x += CHUNK) {
      const gint n = MIN (CHUNK, last - x + 1);

#pragma GCC unroll 1
      for (gint i = 0; i < CHUNK; i++) {
        const gfloat qx = start + (gfloat) (x + i) * scale_x;
        const gfloat along = qx * ux + row_along;
        const gfloat across = qx * uy - row_across;
        gfloat beyond = along - length, c;

        /* how far past either end */
        beyond = beyond > -along ? beyond : -along;
        beyond = beyond > 0 ? beyond : 0;
        c = sqrtf (across * across + beyond * beyond);
        c = (radius - c) * strength;
        c = c < 0 ? 0 : c;
        c = c > most ? most : c;
        coverage[i] = (guint16) (i < n ? (gint) c : 0);
      }
      blend (group, ink, x, y, coverage, n);
    }
  }
}

static void
quad (const ClothDrawGroup * group, const ClothDrawInk * ink,
    const ClothDrawQuad * quad)
{
  const gfloat per_x = 1 / group->scale_x, per_y = 1 / group->scale_y;
  const gfloat offset_x = group->offset_x, scale_x = group->scale_x;
  const gfloat soft = group->softness, margin = 0.5f * soft;
  const gfloat full = quad->full, strength = full / soft;
  const gfloat nx0 = quad->nx[0], nx1 = quad->nx[1];
  const gfloat nx2 = quad->nx[2], nx3 = quad->nx[3];
  guint16 coverage[CHUNK], inside[CHUNK];
  gint row_first, row_last;

  for (gint i = 0; i < CHUNK; i++)
    inside[i] = (guint16) (gint) full;
  clip_range (quad->top - margin, quad->bottom + margin, group->offset_y,
      per_y, group->height, &row_first, &row_last);
  for (gint row = row_first; row <= row_last; row++) {
    const gfloat py = group->offset_y + (gfloat) row * group->scale_y;
    gfloat rest[4], outer[4], inner[4];
    gfloat low = -1e9f, high = 1e9f, inner_low = -1e9f, inner_high = 1e9f;
    gint first, last, inner_first, inner_last;

    for (gint k = 0; k < 4; k++) {
      rest[k] = quad->ny[k] * py + quad->d[k] + margin;
      outer[k] = -rest[k] / quad->nx[k];
      inner[k] = (soft - rest[k]) / quad->nx[k];
    }
    for (gint k = 0; k < 4; k++) {
      /* the row's part with any coverage, and within it the part with all */
      if (quad->nx[k] > 1e-6f) {
        low = MAX (low, outer[k]);
        inner_low = MAX (inner_low, inner[k]);
      } else if (quad->nx[k] < -1e-6f) {
        high = MIN (high, outer[k]);
        inner_high = MIN (inner_high, inner[k]);
      } else if (rest[k] < soft) {
        inner_high = -1e9f;
      }
    }
    clip_range (low, high, offset_x, per_x, group->width, &first, &last);
    clip_range (inner_low, inner_high, offset_x, per_x, group->width,
        &inner_first, &inner_last);
    for (gint x = first; x <= last; x += CHUNK) {
      const gint n = MIN (CHUNK, last - x + 1);
      const gint from = inner_first - x, to = inner_last - x;

      if (from <= 0 && to >= CHUNK - 1) {
        blend (group, ink, x, row, inside, CHUNK);
        continue;
      }
#pragma GCC unroll 1
      for (gint i = 0; i < CHUNK; i++) {
        const gfloat px = offset_x + (gfloat) (x + i) * scale_x;
        gfloat a = nx0 * px + rest[0], b = nx1 * px + rest[1];
        gfloat e = nx2 * px + rest[2], f = nx3 * px + rest[3];

        a = a < b ? a : b;
        e = e < f ? e : f;
        a = (a < e ? a : e) * strength;
        a = a < 0 ? 0 : a;
        a = a > full || (i >= from && i <= to) ? full : a;
        coverage[i] = (guint16) (i < n ? (gint) a : 0);
      }
      blend (group, ink, x, row, coverage, n);
    }
  }
}

const ClothDrawRows CLOTH_SIMD_NAME (cloth_draw_rows) = { line, quad };
