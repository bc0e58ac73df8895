/* How certain a calibrated camera's projections are, over its picture.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/uncertainty.h"

#include <math.h>

#include "gst/math/linalg.h"
#include "gst/math/statistics.h"
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
  g_autofree gdouble *ratios = g_new (gdouble, 2 * N_NODES);
  guint n = 0;

  map->distance = mean_distance (bundle, camera);
  for (guint i = 0; i < N_NODES; i++) {
    gdouble px[2], Z[3] = { 0, 0, 1 }, cov[3], ratio, length;

    map->near[i] = map->far[i] = NAN;
    cloth_uncertainty_node (c, i, px);
    if (!cloth_camera_undistort_points (c, 1, px, px + 1, Z, Z + 1, NULL))
      continue;
    length = cloth_vec3_length (Z);
    for (guint j = 0; j < 3; j++)
      Z[j] /= length;
    if (cloth_bundle_spread_project (spread, camera, Z, TRUE, cov, &ratio)) {
      map->far[i] = worst_direction (cov);
      if (isfinite (ratio))
        ratios[n++] = ratio;
    }
    for (guint j = 0; j < 3; j++)
      Z[j] *= map->distance;
    if (cloth_bundle_spread_project (spread, camera, Z, FALSE, cov, &ratio)) {
      map->near[i] = worst_direction (cov);
      if (isfinite (ratio))
        ratios[n++] = ratio;
    }
  }
  map->disagreement = n ? sqrt (cloth_median (ratios, n)) : NAN;
}

/* @map: a camera's map
 * @noise: standard deviation with which a corner is seen, px
 * @away: (out): where these places are on average, in halves of the picture from its centre
 *
 * Returns: share of the picture where a point as far as the boards is predicted less
 *   certainly than one corner is seen; what is not known counts.
 */
gdouble
cloth_uncertainty_thin (const ClothUncertaintyMap * map, gdouble noise,
    gdouble away[2])
{
  guint n = 0;

  away[0] = away[1] = 0;
  for (guint i = 0; i < N_NODES; i++) {
    if (map->near[i] <= noise)
      continue;
    away[0] += 2. * (i % CLOTH_UNCERTAINTY_COLUMNS)
        / (CLOTH_UNCERTAINTY_COLUMNS - 1) - 1;
    away[1] += 2. * (i / CLOTH_UNCERTAINTY_COLUMNS)
        / (CLOTH_UNCERTAINTY_ROWS - 1) - 1;
    n++;
  }
  for (guint j = 0; j < 2; j++)
    away[j] /= MAX (n, 1);
  return (gdouble) n / N_NODES;
}

/* The quantile @p of a variance estimated from @n views, over the true one. */
static gdouble
scatter_quantile (guint n, gdouble p)
{
  gdouble low = 0, high = 1;

  while (1 - cloth_chi_square_tail (high, n - 1) < p)
    high *= 2;
  for (gint i = 0; i < 50; i++) {
    gdouble middle = 0.5 * (low + high);

    if (1 - cloth_chi_square_tail (middle, n - 1) < p)
      low = middle;
    else
      high = middle;
  }
  return high / (n - 1);
}

/* @map: a camera's map
 * @n_views: views the camera was calibrated from
 *
 * Returns: whether views disagree more than noise alone lets them in one case of twenty.
 */
gboolean
cloth_uncertainty_disagrees (const ClothUncertaintyMap * map, guint n_views)
{
  return n_views > 1 && map->disagreement * map->disagreement
      > scatter_quantile (n_views, 0.95);
}

/* Returns: the least number of views that in nineteen cases of twenty show it when errors
 * are %CLOTH_UNCERTAINTY_MISSED times as large as noise makes them.
 */
guint
cloth_uncertainty_least_views (void)
{
  guint n = 2;

  while (CLOTH_UNCERTAINTY_MISSED * CLOTH_UNCERTAINTY_MISSED
      * scatter_quantile (n, 0.05) < scatter_quantile (n, 0.95))
    n++;
  return n;
}
