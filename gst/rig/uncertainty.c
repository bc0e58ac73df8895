/* How certain a calibrated camera's projections are, over its picture.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/uncertainty.h"

#include <math.h>

#include "gst/math/linalg.h"
#include "gst/math/vec3.h"

#define N_NODES CLOTH_UNCERTAINTY_NODES

/* @camera: a camera
 * @node: which node of its map
 * @px: (out): where that is, px
 */
void
cloth_uncertainty_node (const ClothCamera * camera, guint node, gdouble px[2])
{
  px[0] = (camera->width - 1.) * (node % CLOTH_UNCERTAINTY_COLUMNS)
      / (CLOTH_UNCERTAINTY_COLUMNS - 1);
  px[1] = (camera->height - 1.) * (node / CLOTH_UNCERTAINTY_COLUMNS)
      / (CLOTH_UNCERTAINTY_ROWS - 1);
}

/* Root of the larger eigenvalue. */
static gdouble
worst_direction (const gdouble cov[3])
{
  gdouble middle = 0.5 * (cov[0] + cov[2]), half = 0.5 * (cov[0] - cov[2]);

  return sqrt (fmax (0, middle + hypot (half, cov[1])));
}

static gdouble
mean_distance (const ClothBundle * b, guint camera)
{
  const ClothCamera *c = &b->cameras[camera];
  gdouble sum = 0;
  guint n = 0;

  for (guint v = 0; v < b->n_views; v++) {
    const ClothBundleView *view = &b->views[v];
    const gdouble *P = b->poses + 12 * (gsize) view->pose;

    for (guint i = 0; view->use && view->camera == camera && i < view->n; i++) {
      gdouble X[3], Z[3];

      cloth_mat3_vec (P, b->board + 3 * (gsize) view->vertex[i], X);
      for (guint j = 0; j < 3; j++)
        X[j] += P[9 + j];
      cloth_mat3_vec (c->R, X, Z);
      for (guint j = 0; j < 3; j++)
        Z[j] += c->t[j];
      sum += cloth_vec3_length (Z);
      n++;
    }
  }
  return n ? sum / n : NAN;
}

/* @bundle: a solved problem
 * @spread: its
 * @camera: which camera
 * @map: (out): filled
 */
void
cloth_uncertainty_map (const ClothBundle * bundle,
    const ClothBundleSpread * spread, guint camera, ClothUncertaintyMap * map)
{
  const ClothCamera *c = &bundle->cameras[camera];

  map->distance = mean_distance (bundle, camera);
  for (guint i = 0; i < N_NODES; i++) {
    gdouble px[2], Z[3] = { 0, 0, 1 }, cov[3], length;

    map->near[i] = map->far[i] = NAN;
    cloth_uncertainty_node (c, i, px);
    if (!cloth_camera_undistort_points (c, 1, px, px + 1, Z, Z + 1, NULL))
      continue;
    length = cloth_vec3_length (Z);
    for (guint j = 0; j < 3; j++)
      Z[j] /= length;
    if (cloth_bundle_spread_project (spread, camera, Z, TRUE, cov))
      map->far[i] = worst_direction (cov);
    for (guint j = 0; j < 3; j++)
      Z[j] *= map->distance;
    if (cloth_bundle_spread_project (spread, camera, Z, FALSE, cov))
      map->near[i] = worst_direction (cov);
  }
}
