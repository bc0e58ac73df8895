/* Least-squares refinement of cameras and board poses together.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <gio/gio.h>

#include "gst/rig/camera.h"

G_BEGIN_DECLS

/* @camera: which camera
 * @pose: which pose of the board
 * @use: whether it takes part in the fit
 * @n: points
 * @vertex: (array length=n): which vertex of the board each point is
 * @x: (array length=n): px
 * @y: (array length=n): px
 * @cov: (array) (nullable): 3·@n: covariances xx, xy, yy, px²
 *
 * What one camera sees of the board in one pose. Owns nothing.
 */
typedef struct {
  guint camera, pose;
  gboolean use;
  guint n;
  const guint *vertex;
  const gdouble *x, *y;
  const gdouble *cov;
} ClothBundleView;

/* Parameters of a camera that a fit may change; the bits of ClothBundle.free. */
#define CLOTH_BUNDLE_FOCAL 0x3u
#define CLOTH_BUNDLE_CENTRE 0xcu
#define CLOTH_BUNDLE_COEFFICIENT(i) (0x10u << (i))
#define CLOTH_BUNDLE_COEFFICIENTS 0xff0u
#define CLOTH_BUNDLE_PLACE 0x3f000u

/* @n_cameras: cameras
 * @cameras: (array length=n_cameras): in: start, out: result; K, k, R, t
 * @free: (array length=n_cameras): bits of the parameters that may change
 * @share_lens: whether all cameras have the same coefficients
 * @n_poses: poses of the board
 * @poses: (array): 12·@n_poses: row-major R, then t, board to world; in and out
 * @n_views: views
 * @views: (array length=n_views): what was seen
 * @board: (array): 3 numbers a vertex, m
 * @excess: (array length=n_cameras): standard deviation added to every covariance, px
 * @huber: points farther off than this many standard deviations get less weight
 * @max_iterations: of Levenberg and Marquardt's method
 * @cancellable: (nullable): stops it
 * @bulge: (array) (nullable): 2 numbers a vertex: how high each @warp lifts it; %NULL: the
 *   board is flat
 * @free_warp: whether @warp may change
 * @warp: how far the board's middle is lifted by a bend along its rows, and along its
 *   columns, m; in and out
 *
 * A problem of bundle adjustment.
 */
typedef struct {
  guint n_cameras;
  ClothCamera *cameras;
  guint *free;
  gboolean share_lens;
  guint n_poses;
  gdouble *poses;
  guint n_views;
  const ClothBundleView *views;
  const gdouble *board;
  const gdouble *excess;
  gdouble huber;
  guint max_iterations;
  GCancellable *cancellable;
  const gdouble *bulge;
  gboolean free_warp;
  gdouble warp[2];
} ClothBundle;

gboolean cloth_bundle_solve (ClothBundle * bundle, gdouble * cost,
    GError ** error);
void cloth_bundle_residuals (const ClothBundle * bundle, guint view,
    gdouble * dx, gdouble * dy, gdouble * distance);
gdouble cloth_bundle_excess (const ClothBundle * bundle, guint camera);

/* How certain the parameters of a solved problem are. */
typedef struct _ClothBundleSpread ClothBundleSpread;

ClothBundleSpread *cloth_bundle_spread_new (const ClothBundle * bundle,
    GError ** error);
void cloth_bundle_spread_free (ClothBundleSpread * spread);
gdouble cloth_bundle_spread_variance (const ClothBundleSpread * spread);
void cloth_bundle_spread_cameras (const ClothBundleSpread * spread,
    gdouble * covariance);
void cloth_bundle_spread_warp (const ClothBundleSpread * spread,
    gdouble sd[2]);
gboolean cloth_bundle_spread_project (const ClothBundleSpread * spread,
    guint camera, const gdouble Z[3], gboolean at_infinity, gdouble cov[3],
    gdouble * disagreement);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothBundleSpread, cloth_bundle_spread_free)

G_END_DECLS
