/* The waves of what is off in a frame.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/features/features-private.h"

#include <string.h>

/* What is off in a frame, on each wave. Sums over vertices stay in their order, waves are
 * side by side: all instruction sets give the same bits. */
static void
project (const ClothFeatures * features,
    const ClothRecording * recording, gsize begin, const gdouble * positions,
    gdouble sums[3][CLOTH_FEATURES_MAX_WAVES])
{
  guint n_waves = features->n_waves;

  memset (sums, 0, 3 * sizeof *sums);
  for (guint v = 0; v < features->n; v++) {
    const gdouble *wave = features->waves + (gsize) v * n_waves;
    gdouble off[3];

    if (recording->seen[begin + v] == 0.)
      continue;
    for (guint k = 0; k < 3; k++)
      off[k] = positions[3 * v + k] - recording->y[3 * (begin + v) + k];
    if (features->whitened) {
      const gdouble *s = recording->noise->white + 6 * (begin + v);
      const gdouble a[3] = { off[0], off[1], off[2] };

      off[0] = s[0] * a[0] + s[5] * a[1] + s[4] * a[2];
      off[1] = s[5] * a[0] + s[1] * a[1] + s[3] * a[2];
      off[2] = s[4] * a[0] + s[3] * a[1] + s[2] * a[2];
    } else {
      for (guint k = 0; k < 3; k++)
        off[k] /= features->sigma;
    }
    for (guint k = 0; k < 3; k++)
      for (guint w = 0; w < n_waves; w++)
        sums[k][w] += wave[w] * off[k];
  }
}

const ClothProjection CLOTH_SIMD_NAME (cloth_projection) = { project };
