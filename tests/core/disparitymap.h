/* Maps of disparities whose truth is a formula.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/disparity/disparity.h"

#include <math.h>
#include <string.h>

#define OUTSIDE CLOTH_DISPARITY_OUTSIDE
#define HOLE CLOTH_DISPARITY_HOLE
#define MEASURED CLOTH_DISPARITY_MEASURED
#define FILLED CLOTH_DISPARITY_FILLED

typedef gdouble (*Formula) (gdouble x, gdouble y);

static inline gdouble
plane (gdouble x, gdouble y)
{
  return 80 + 0.071 * x - 0.043 * y;
}

/* A map with a margin of its own beside each row. */
static inline ClothDisparityMap
make_map (gint width, gint height, Formula formula)
{
  const gint stride = width + 5;
  ClothDisparityMap map = { g_new (gfloat, stride * height),
    g_malloc (stride * height), width, height, stride
  };

  for (gint y = 0; y < height; y++)
    for (gint x = 0; x < stride; x++) {
      map.disparities[y * stride + x] =
          x < width ? (gfloat) formula (x, y) : -7;
      map.states[y * stride + x] = x < width ? MEASURED : 99;
    }
  return map;
}

static inline void
free_map (ClothDisparityMap * map)
{
  for (gint y = 0; y < map->height; y++)
    for (gint x = map->width; x < map->stride; x++) {
      g_assert_cmpint (map->states[y * map->stride + x], ==, 99);
      g_assert_cmpfloat (map->disparities[y * map->stride + x], ==, -7);
    }
  g_free (map->disparities);
  g_free (map->states);
}

/* The greatest and the mean square error of what is known. */
static inline void
measure (const ClothDisparityMap * map, Formula formula, gdouble * most,
    gdouble * rms)
{
  gdouble sum = 0;
  guint n = 0;

  *most = 0;
  for (gint y = 0; y < map->height; y++)
    for (gint x = 0; x < map->width; x++) {
      const gint at = y * map->stride + x;
      gdouble error;

      if (map->states[at] < MEASURED)
        continue;
      error = fabs ((gdouble) map->disparities[at] - formula (x, y));
      g_assert_true (isfinite (error));
      *most = MAX (*most, error);
      sum += error * error;
      n++;
    }
  *rms = sqrt (sum / MAX (n, 1));
  g_test_message ("%u disparities: greatest error %.5f px, RMS %.5f", n, *most,
      *rms);
}

static inline guint
count (const ClothDisparityMap * map, guint8 state)
{
  guint n = 0;

  for (gint y = 0; y < map->height; y++)
    for (gint x = 0; x < map->width; x++) {
      const gint at = y * map->stride + x;

      n += map->states[at] == state;
      g_assert_true (map->states[at] == OUTSIDE
          || isnan (map->disparities[at]) == (map->states[at] == HOLE));
    }
  return n;
}
