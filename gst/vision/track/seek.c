/* A described feature found again in a part of a picture.
 *
 * Model: what was described before looks most alike to one of its earlier descriptors. It is told from
 *   others if the next best feature, at another place, is clearly less alike: the ratio of Lowe.
 * Assumption: it is no further away than cloth moves. So a motif that a print repeats further away does
 *   not compete: among all features of a picture the ratio would refuse every motif that is repeated.
 * Reference: D. Lowe, Distinctive image features from scale-invariant keypoints, 2004, section 7.1.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/track/seek.h"

#include <math.h>

/* Features that may be described at one place. */
#define MOST 16

/* @a: (array fixed-size=128): a descriptor
 * @b: (array fixed-size=128): another
 *
 * Returns: the square of their Euclidean distance
 */
guint32
cloth_seek_distance (const guint8 * a, const guint8 * b)
{
  guint32 sum = 0;

  for (guint i = 0; i < CLOTH_CV_SIFT_BYTES; i++) {
    const gint d = a[i] - b[i];

    sum += (guint32) (d * d);
  }
  return sum;
}

/* The first feature whose row is not above @y; they are sorted by rows. */
static guint
find_row (const ClothCvFeatures * features, gdouble y)
{
  guint low = 0, high = features->n;

  while (low < high) {
    const guint middle = low + (high - low) / 2;

    if (features->y[middle] < y)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* How far a feature is from the most alike of the descriptors. */
static guint32
compare (const ClothCvFeatures * features, guint feature, guint n,
    const guint8 * const *descriptors)
{
  guint32 least = G_MAXUINT32;

  for (guint k = 0; k < n; k++)
    least = MIN (least, cloth_seek_distance (descriptors[k],
            features->descriptors + (gsize) feature * CLOTH_CV_SIFT_BYTES));
  return least;
}

/* A feature in reach, and how unlike it is. */
typedef struct
{
  guint feature;
  guint32 distance;
} Found;

/* The most alike features within @reach of @middle, of equal ones the first; at most @most. Returns: how
 * many */
static guint
list_best (const ClothCvFeatures * features, const gdouble middle[2],
    gdouble reach, guint n, const guint8 * const *descriptors, guint most,
    Found * best)
{
  guint n_best = 0;

  for (guint i = find_row (features, middle[1] - reach);
      i < features->n && features->y[i] <= middle[1] + reach; i++) {
    guint at = n_best;
    guint32 distance;

    if (!(hypot (features->x[i] - middle[0],
                features->y[i] - middle[1]) <= reach))
      continue;
    distance = compare (features, i, n, descriptors);
    if (n_best == most && distance >= best[most - 1].distance)
      continue;
    if (n_best < most)
      n_best++;
    else
      at--;
    for (; at > 0 && best[at - 1].distance > distance; at--)
      best[at] = best[at - 1];
    best[at] = (Found) {
    i, distance};
  }
  return n_best;
}

/* @features: of a picture
 * @middle: where to look, px
 * @reach: how far from it, px
 * @ratio: greatest distance of the best as a share of that of the next best at another place
 * @n: descriptors, at least 1
 * @descriptors: (array length=n): what it looked like before
 * @distance: (out): squared distance of the best feature to the most alike of them
 *
 * Returns: the feature, or %CLOTH_SEEK_NONE
 */
guint
cloth_seek_run (const ClothCvFeatures * features, const gdouble middle[2],
    gdouble reach, gdouble ratio, guint n, const guint8 * const *descriptors,
    guint32 * distance)
{
  Found best[MOST];
  const guint n_best = list_best (features, middle, reach, n, descriptors, MOST,
      best);
  guint second = 1;

  if (n_best == 0)
    return CLOTH_SEEK_NONE;
  *distance = best[0].distance;
  while (second < n_best && hypot (features->x[best[second].feature] -
          features->x[best[0].feature], features->y[best[second].feature] -
          features->y[best[0].feature]) < CLOTH_SEEK_SAME_PX)
    second++;
  /* alone in reach; or its double in a crowd that nobody can tell apart */
  if (second == n_best)
    return n_best < MOST ? best[0].feature : CLOTH_SEEK_NONE;
  return *distance < ratio * ratio * best[second].distance ? best[0].feature :
      CLOTH_SEEK_NONE;
}
