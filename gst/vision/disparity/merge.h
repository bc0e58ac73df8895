/* Disparities of one or more baselines on the pixels of one picture.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/pool.h"
#include "gst/vision/disparity/map.h"

G_BEGIN_DECLS

/* @disparities: (not nullable): of the left picture of a rectified pair, 1/@steps px
 * @width: pixels a row
 * @height: rows
 * @stride: elements from one row to the next, >= @width
 * @steps: steps of one pixel, 1 to 256
 * @none: what stands for no disparity
 * @place: a homography, by rows: from pixels of the map to pixels of this picture. Mirrored
 *   pictures (the other camera lies to the left) and those whose rows are columns (it lies
 *   above or below) are such too
 * @unit: disparities of this pair times @unit[0]·x + @unit[1]·y + @unit[2] are disparities
 *   of the first pair at the map's pixel (x, y). Pairs that are turned alike: 0, 0 and the
 *   ratio of focal length times baseline, of the first over this. Else the first two say by
 *   how much its depth, along another axis, is another one
 * @offset: added before, px: of rectified pictures with unlike principal points
 */
typedef struct {
  const gint16 *disparities;
  gint width, height, stride;
  gint steps;
  gint16 none;
  gdouble place[9], unit[3];
  gdouble offset;
} ClothDisparityPair;

/* @least: share of the disparities of a pair that lie within a pixel of the least that was
 *   looked for, or below it
 * @most: of the greatest, or above it
 *
 * Much of either says that the range is too small.
 */
typedef struct {
  gdouble least, most;
} ClothDisparityBorder;

ClothDisparityPair cloth_disparity_pair (const gint16 * disparities,
    gint width, gint height);
gboolean cloth_disparity_check (gint16 * left, const gint16 * right,
    gint width, gint height, gint16 none, gint most, GError ** error);
gboolean cloth_disparity_border (const ClothDisparityPair * pair, gdouble least,
    gdouble most, ClothDisparityBorder * border, GError ** error);
gboolean cloth_disparity_merge (const ClothDisparityPair * pairs,
    guint n_pairs, gdouble most, ClothDisparityMap * map, ClothPool * pool,
    GError ** error);

G_END_DECLS
