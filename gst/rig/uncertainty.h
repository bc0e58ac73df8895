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

/* Errors so many times as large as predicted are not to be missed. */
#define CLOTH_UNCERTAINTY_MISSED 3

/* @distance: how far the seen boards' corners were on average, m
 * @near: standard deviation in the worst direction of where a point at @distance appears,
 *   px, row by row, from corner pixel to corner pixel; NaN where the lens is not known
 * @far: the same of a point infinitely far
 * @disagreement: how many times as much as by noise projections move when views are left
 *   out one by one, median over the picture; NaN with too few views
 */
typedef struct {
  gdouble distance;
  gdouble near[CLOTH_UNCERTAINTY_NODES];
  gdouble far[CLOTH_UNCERTAINTY_NODES];
  gdouble disagreement;
} ClothUncertaintyMap;

void cloth_uncertainty_map (const ClothBundle * bundle,
    const ClothBundleSpread * spread, guint camera, ClothUncertaintyMap * map);
gdouble cloth_uncertainty_thin (const ClothUncertaintyMap * map,
    gdouble noise, gdouble away[2]);
gboolean cloth_uncertainty_disagrees (const ClothUncertaintyMap * map,
    guint n_views);
guint cloth_uncertainty_least_views (void);
void cloth_uncertainty_node (const ClothCamera * camera, guint node,
    gdouble px[2]);

G_END_DECLS
