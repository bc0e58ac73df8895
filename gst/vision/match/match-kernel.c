/* The nearest in feature space of the candidates in a ring.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/vision/match/match-private.h"

/* Candidates that are sifted before those that pass are compared. */
#define AT_ONCE 64
/* Added to a small number and taken away again this rounds it, without a call. */
#define ROUNDING 12582912.0f

static inline guint32
measure (const guint8 * a, const guint8 * b)
{
  gint32 sum = 0;

  for (gint k = 0; k < CLOTH_MATCH_BYTES; k++) {
    const gint16 d = (gint16) (a[k] - b[k]);

    sum += (gint32) d *d;
  }
  return (guint32) sum;
}

static void
search (const ClothMatchRing * ring, guint begin, guint end, guint32 * index,
    guint32 * distance)
{
  const ClothMatchRing r = *ring;
  const gfloat circle = (gfloat) (2 * G_PI), part = 1 / circle;
  gint32 passes[AT_ONCE];

  for (guint first = begin; first < end; first += AT_ONCE) {
    const guint n = MIN (end - first, AT_ONCE);

    for (guint k = 0; k < n; k++) {
      const guint i = first + k;
      const gfloat dx = r.x[i] - r.centre[0], dy = r.y[i] - r.centre[1];
      const gfloat square = dx * dx + dy * dy;
      const gfloat turn = r.turn - r.seen[i];
      const gfloat rounds = (turn * part + ROUNDING) - ROUNDING;

      passes[k] = (square >= r.least) & (square <= r.most)
          & (r.scale[i] >= r.low) & (r.scale[i] <= r.high)
          & (fabsf (turn - rounds * circle) <= r.turn_range);
    }
    for (guint k = 0; k < n; k++) {
      guint32 d;

      if (!passes[k])
        continue;
      d = measure (r.query, r.descriptors
          + (gsize) (first + k) * CLOTH_MATCH_BYTES);
      if (d < *distance) {
        *distance = d;
        *index = first + k;
      }
    }
  }
}

const ClothMatchKernel CLOTH_SIMD_NAME (cloth_match_kernel) = { search };
