/* The equations of the least squared Laplacian, sixteen pixels at a time.
 *
 * With h and v, 1 where a second difference counts and else 0, the energy is half the sum of
 *
 *   l² ,  l = h·(west − 2·x + east) + v·(north − 2·x + south)
 *
 * Its derivative by x has 13 terms: that of x's own l, times −2·(h + v), and those of the
 * four neighbours' that contain x.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/disparity/disparity-private.h"

#include <string.h>

#define INLINE static inline __attribute__((always_inline))
#define CHUNK CLOTH_DISPARITY_CHUNK

typedef gfloat F16 __attribute__((vector_size (64)));
typedef gint32 I16 __attribute__((vector_size (64)));

/* What there is to know of a phase: how far the pixels beside are. */
typedef struct
{
  gint south, east, west, east2, west2;
} Way;

#define AT(plane, offset) ({ \
    F16 value_; \
    memcpy (&value_, (plane) + (offset), sizeof (value_)); \
    value_; })

/* Bit by bit @a where the mask is set, else @b. */
INLINE F16
choose (I16 mask, F16 a, F16 b)
{
  return (F16) ((mask & (I16) a) | (~mask & (I16) b));
}

static gint
offset (const ClothDisparityPlanes * planes, gint phase, gint columns)
{
  const gint at = phase + columns + 3;

  return (at % 3 - phase) * planes->phase + at / 3 - 1;
}

static Way
get_way (const ClothDisparityPlanes * planes, gint phase)
{
  return (Way) {
    3 *planes->phase, offset (planes, phase, 1), offset (planes, phase, -1),
        offset (planes, phase, 2), offset (planes, phase, -2)
  };
}

/* The derivative at the 16 pixels from @x on. */
INLINE void
differentiate (const gfloat * x, const gfloat * h, const gfloat * v,
    const Way * way, gboolean whole, F16 * result)
{
  const gint s = way->south, e = way->east, w = way->west;
  const F16 here = AT (x, 0), north = AT (x, -s), south = AT (x, s);
  const F16 west = AT (x, w), east = AT (x, e);
  const F16 far_w = AT (x, way->west2), far_e = AT (x, way->east2);
  const F16 far_n = AT (x, -2 * s), far_s = AT (x, 2 * s);
  const F16 nw = AT (x, w - s), ne = AT (x, e - s), sw = AT (x, w + s),
      se = AT (x, e + s);

  if (whole) {
    *result = (far_w + far_e) + (far_n + far_s)
        + 2 * ((nw + ne) + (sw + se))
        - 8 * ((west + east) + (north + south)) + 20 * here;
  } else {
    const F16 hh = AT (h, 0), vv = AT (v, 0), hw = AT (h, w), he = AT (h, e);
    const F16 vn = AT (v, -s), vs = AT (v, s);
    const F16 own = hh * ((west + east) - 2 * here)
        + vv * ((north + south) - 2 * here);
    const F16 of_w = ((far_w + here) - 2 * west)
        + AT (v, w) * ((nw + sw) - 2 * west);
    const F16 of_e = ((far_e + here) - 2 * east)
        + AT (v, e) * ((ne + se) - 2 * east);
    const F16 of_n = ((far_n + here) - 2 * north)
        + AT (h, -s) * ((nw + ne) - 2 * north);
    const F16 of_s = ((far_s + here) - 2 * south)
        + AT (h, s) * ((sw + se) - 2 * south);

    *result = (hw * of_w + he * of_e) + (vn * of_n + vs * of_s)
        - 2 * (hh + vv) * own;
  }
}

static void
pack (const ClothDisparityPlanes * planes, const gfloat * from, gint width,
    gint y, gfloat * plane)
{
  gfloat *to = plane + (gssize) y * 3 * planes->phase;
  const gint thirds = width / 3;

  for (gint k = 0; k < thirds; k++) {
    to[k] = from[3 * k];
    to[k + planes->phase] = from[3 * k + 1];
    to[k + 2 * planes->phase] = from[3 * k + 2];
  }
  for (gint x = 3 * thirds; x < width; x++)
    to[x / 3 + x % 3 * planes->phase] = from[x];
}

static void
unpack (const ClothDisparityPlanes * planes, const gfloat * plane, gint width,
    gint y, gfloat * to)
{
  const gfloat *from = plane + (gssize) y * 3 * planes->phase;
  const gint thirds = width / 3;

  for (gint k = 0; k < thirds; k++) {
    to[3 * k] = from[k];
    to[3 * k + 1] = from[k + planes->phase];
    to[3 * k + 2] = from[k + 2 * planes->phase];
  }
  for (gint x = 3 * thirds; x < width; x++)
    to[x] = from[x / 3 + x % 3 * planes->phase];
}

/* A busy chunk: its first pixel, and whether all second differences about it count. */
typedef struct
{
  gssize at;
  const Way *way;
  gboolean whole;
} Chunk;

INLINE Chunk
get_chunk (const ClothDisparityPlanes * planes, const Way * ways, gint y,
    gint i)
{
  const guint16 busy = planes->busy[(gssize) 3 * y * planes->chunks + i];
  const gint number = busy / 2, phase = number / planes->chunks;

  return (Chunk) {
  ((gssize) 3 * y + phase) * planes->phase
        + CHUNK * (number - phase * planes->chunks), &ways[phase], busy % 2};
}

static void
get_ways (const ClothDisparityPlanes * planes, Way * ways)
{
  for (gint phase = 0; phase < 3; phase++)
    ways[phase] = get_way (planes, phase);
}

static void
prepare (const ClothDisparityPlanes * planes, gint y)
{
  guint16 *busy = planes->busy + (gssize) 3 * y * planes->chunks;
  gint n = 0;

  for (gint p = 0; p < 3; p++) {
    const Way way = get_way (planes, p);
    const gint s = way.south;
    const gssize line = (gssize) 3 * y + p;

    for (gint c = 0; c < planes->chunks; c++) {
      const gssize at = line * planes->phase + CHUNK * c;
      const gfloat *h = planes->h + at, *v = planes->v + at;
      const F16 own = AT (h, 0) + AT (v, 0);
      const F16 around = (AT (h, way.west) + AT (h, way.east))
          + (AT (v, -s) + AT (v, s));
      const F16 diagonal = 4 * own * own + around;
      const F16 all = (own + around)
          + ((AT (h, -s) + AT (h, s)) + (AT (v, way.west) + AT (v, way.east)));
      gboolean whole = TRUE, idle = TRUE;

      for (gint i = 0; i < CHUNK; i++) {
        gfloat *gain = planes->gain + at + i;

        *gain = *gain > 0 && diagonal[i] > 0 ? 1 / diagonal[i] : 0;
        idle &= *gain == 0;
        whole &= all[i] == 10;
      }
      if (!idle)
        busy[n++] = (guint16) (2 * (p * planes->chunks + c) + whole);
    }
  }
  planes->n_busy[y] = n;
}

static void
relax (const ClothDisparityPlanes * planes, gint y, gfloat relaxation)
{
  Way ways[3];

  get_ways (planes, ways);
  for (gint i = 0; i < planes->n_busy[y]; i++) {
    const Chunk c = get_chunk (planes, ways, y, i);
    const gfloat *h = planes->h + c.at, *v = planes->v + c.at;
    const F16 low = AT (planes->low, c.at), high = AT (planes->high, c.at);
    gfloat *x = planes->x + c.at;
    F16 slope, to;

    if (c.whole)
      differentiate (x, h, v, c.way, TRUE, &slope);
    else
      differentiate (x, h, v, c.way, FALSE, &slope);
    to = AT (x, 0) - relaxation * AT (planes->gain, c.at) * slope;
    to = choose (to < low, low, to);
    to = choose (to > high, high, to);
    memcpy (x, &to, sizeof (to));
  }
}

INLINE gdouble
total (const F16 * sums)
{
  gdouble sum = 0;

  for (gint i = 0; i < CHUNK; i++)
    sum += (gdouble) (*sums)[i];
  return sum;
}

/* The derivative by what is to be found; 0 by the rest. */
INLINE F16
differentiate_busy (const ClothDisparityPlanes * planes, const gfloat * plane,
    const Chunk * c)
{
  F16 slope;

  differentiate (plane + c->at, planes->h + c->at, planes->v + c->at, c->way,
      FALSE, &slope);
  return (F16) ((AT (planes->gain, c->at) > 0) & (I16) slope);
}

static gdouble
residual (const ClothDisparityPlanes * planes, gint y)
{
  F16 sums = { 0 };
  Way ways[3];

  get_ways (planes, ways);
  for (gint i = 0; i < planes->n_busy[y]; i++) {
    const Chunk c = get_chunk (planes, ways, y, i);
    const F16 left = -differentiate_busy (planes, planes->x, &c);

    sums += left * left * AT (planes->gain, c.at);
    memcpy (planes->residual + c.at, &left, sizeof (left));
  }
  return total (&sums);
}

static gdouble
apply (const ClothDisparityPlanes * planes, gint y)
{
  F16 sums = { 0 };
  Way ways[3];

  get_ways (planes, ways);
  for (gint i = 0; i < planes->n_busy[y]; i++) {
    const Chunk c = get_chunk (planes, ways, y, i);
    const F16 product = differentiate_busy (planes, planes->direction, &c);

    sums += product * AT (planes->direction, c.at);
    memcpy (planes->product + c.at, &product, sizeof (product));
  }
  return total (&sums);
}

static gdouble
step (const ClothDisparityPlanes * planes, gint y, gfloat length)
{
  F16 sums = { 0 };
  Way ways[3];

  get_ways (planes, ways);
  for (gint i = 0; i < planes->n_busy[y]; i++) {
    const gssize at = get_chunk (planes, ways, y, i).at;
    gfloat *x = planes->x + at, *r = planes->residual + at;
    const F16 moved = AT (x, 0) + length * AT (planes->direction, at);
    const F16 left = AT (r, 0) - length * AT (planes->product, at);

    sums += left * left * AT (planes->gain, at);
    memcpy (x, &moved, sizeof (moved));
    memcpy (r, &left, sizeof (left));
  }
  return total (&sums);
}

static void
turn (const ClothDisparityPlanes * planes, gint y, gfloat share)
{
  Way ways[3];

  get_ways (planes, ways);
  for (gint i = 0; i < planes->n_busy[y]; i++) {
    const gssize at = get_chunk (planes, ways, y, i).at;
    gfloat *to = planes->direction + at;
    const F16 next = AT (planes->gain, at) * AT (planes->residual, at)
        + share * AT (to, 0);

    memcpy (to, &next, sizeof (next));
  }
}

const ClothDisparityKernels CLOTH_SIMD_NAME (cloth_disparity_kernels) = {
  pack, unpack, prepare, relax, residual, apply, step, turn
};
