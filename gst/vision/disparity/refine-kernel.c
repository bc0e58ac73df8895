/* Pictures of cameras beside each other, row by row, some pixels at a time.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/disparity/refine-private.h"

#include <math.h>
#include <string.h>

#define LANES 16

static inline __attribute__((always_inline))
     void compare_some (const ClothRefineRow * row, gint x, gint n)
{
  gdouble way[LANES];
  gint32 left[LANES], seen[LANES], samples[4][LANES] = { 0 };

  for (gint i = 0; i < n; i++) {
    const gdouble at = x + i + (gdouble) row->disparities[x + i] * row->shift;
    const gdouble below = floor (at);
    /* also 0 for what is no number */
    const gint32 within = (below >= 1) & (below + 2 < row->width)
        & (row->states[x + i] >= row->known);

    seen[i] = within;
    left[i] = (gint32) (within ? below : 1);
    way[i] = within ? at - below : 0;
  }
  for (gint i = 0; i < n; i++) {
    guint8 four[4];

    if (seen[i] && row->shown)
      seen[i] = row->shown[left[i] + (way[i] >= 0.5)] != 0;
    if (!seen[i])
      continue;
    memcpy (four, row->there + left[i] - 1, sizeof (four));
    for (gint k = 0; k < 4; k++)
      samples[k][i] = four[k];
  }
  for (gint i = 0; i < n; i++) {
    const gdouble s[4] = { samples[0][i], samples[1][i], samples[2][i],
      samples[3][i]
    };
    gdouble slope;
    const gdouble value = cloth_refine_cubic (s, way[i], &slope);
    const gfloat difference = (gfloat) (row->here[x + i] - value);
    const gfloat gradient = (gfloat) (row->shift * slope);

    row->count[x + i] = (gfloat) seen[i];
    row->gradient[x + i] = seen[i] ? gradient : NAN;
    row->difference[x + i] = seen[i] ? difference : 0;
  }
}

static void
compare (const ClothRefineRow * row, gint begin, gint end)
{
  gint x = begin;

  /* whole ones by themselves: a number that is known is worth a loop without branches */
  for (; x + LANES <= end; x += LANES)
    compare_some (row, x, LANES);
  if (x < end)
    compare_some (row, x, end - x);
}

const ClothRefineKernel CLOTH_SIMD_NAME (cloth_refine_kernel) = { compare };
