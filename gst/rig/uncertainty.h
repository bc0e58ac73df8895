/* How certain a calibrated camera's projections are, over its picture.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/bundle.h"

G_BEGIN_DECLS

/* Nodes of a map; odd, so that one of them is the centre. */
#define CLOTH_UNCERTAINTY_COLUMNS 33
#define CLOTH_UNCERTAINTY_ROWS 25
#define CLOTH_UNCERTAINTY_NODES \
  (CLOTH_UNCERTAINTY_COLUMNS * CLOTH_UNCERTAINTY_ROWS)

/* @distance: how far the seen boards' corners were on average, m
 * @near: standard deviation in the worst direction of where a point at @distance appears,
 *   px, row by row, from corner pixel to corner pixel; NaN where the lens is not known
 * @far: the same of a point infinitely far
 */
typedef struct {
  gdouble distance;
  gdouble near[CLOTH_UNCERTAINTY_NODES];
  gdouble far[CLOTH_UNCERTAINTY_NODES];
} ClothUncertaintyMap;

void cloth_uncertainty_map (const ClothBundle * bundle,
    const ClothBundleSpread * spread, guint camera, ClothUncertaintyMap * map);
void cloth_uncertainty_node (const ClothCamera * camera, guint node,
    gdouble px[2]);

G_END_DECLS
