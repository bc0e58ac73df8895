/* Calibration of cameras from views of a board.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/rig/bundle.h"
#include "gst/rig/rig.h"
#include "gst/rig/uncertainty.h"

G_BEGIN_DECLS

/* @n_cameras: cameras, 1 to %CLOTH_RIG_MAX_CAMERAS
 * @cameras: (array length=n_cameras): of each, name, width, height and lens
 * @n_vertices: vertices of the board
 * @board: (array): 3 numbers a vertex, m; the board is flat: the third is 0
 * @n_poses: poses of the board; views of different cameras with the same pose were taken
 *   at the same moment
 * @n_views: views
 * @views: (array length=n_views): what each camera saw in each pose; at most one each
 * @n_symmetries: turns after which the board looks the same, 0 for none
 * @symmetries: (array) (nullable): for each of them @n_vertices numbers: the vertex that
 *   each vertex is turned onto. Cameras may have numbered the same pose from different
 *   ends; they are brought to agree
 */
typedef struct {
  guint n_cameras;
  const ClothCamera *cameras;
  guint n_vertices;
  const gdouble *board;
  guint n_poses;
  guint n_views;
  const ClothBundleView *views;
  guint n_symmetries;
  const guint *symmetries;
} ClothCalibrateInput;

/* @CLOTH_CALIBRATE_WORLD_CAMERA: the first camera's centre; x to its right, y along its
 *   view, z up in its picture
 * @CLOTH_CALIBRATE_WORLD_BOARD: vertex 0 of the board as the first pose shows it; x along
 *   its rows, z towards the first camera
 *
 * Where the world's origin and axes lie.
 */
typedef enum {
  CLOTH_CALIBRATE_WORLD_CAMERA,
  CLOTH_CALIBRATE_WORLD_BOARD
} ClothCalibrateWorld;

/* @intrinsics_only: views of different cameras were not taken at the same moments: don't
 *   place the cameras
 * @share_lens: all cameras have the same distortion coefficients
 * @warp: the board may be bent: how is estimated, too
 * @world: where the world lies
 * @huber: corners farther off than this many standard deviations get less weight
 * @leave_out: every so many poses one is left out for the check; 0: no check
 * @max_iterations: most iterations of each fit
 */
typedef struct {
  gboolean intrinsics_only;
  gboolean share_lens;
  gboolean warp;
  ClothCalibrateWorld world;
  gdouble huber;
  guint leave_out;
  guint max_iterations;
} ClothCalibrateParams;

/* @n_views: views used
 * @n_shared: of these, views that other cameras saw at the same moment
 * @n_points: corners used
 * @rms: root mean square reprojection error, px: of the distance, over all corners used
 * @left_out_rms: the same on views that took no part in the fit but for their own pose; NaN
 *   without the check
 * @excess: what the corners scatter beyond their own covariances, px, one axis
 * @n_outliers: corners farther off than chance takes any of them, in 19 calibrations of 20
 * @map: how certain its projections are
 */
typedef struct {
  guint n_views, n_shared, n_points, n_outliers;
  gdouble rms;
  gdouble left_out_rms;
  gdouble excess;
  ClothUncertaintyMap map;
} ClothCalibrateCamera;

/* @rig: the cameras, with standard deviations
 * @placed: whether the cameras' places were determined
 * @rms: root mean square reprojection error, px
 * @left_out_rms: as in #ClothCalibrateCamera, over all cameras
 * @warp: how far the board's middle is lifted off the plane of its rim, by a bend along its
 *   rows and by one along its columns, m; 0 when it was taken for flat
 * @warp_sd: standard deviations of @warp
 * @variance: variance of the standardised residuals, by which the deviations are scaled
 * @cameras: (array): one a camera
 * @view_rms: (array): one a view of the input, px; NaN: unused, too few corners
 * @dx: (array): one a corner of the input, view after view: seen minus predicted, px; NaN:
 *   unused
 * @dy: (array): likewise
 * @outlier: (array): likewise, whether it is one
 * @n_poses: poses below
 * @poses: (array): 12 numbers a pose of the input: R and t, board to world; NaN: unused,
 *   all NaN when not @placed
 */
typedef struct {
  ClothRig *rig;
  gboolean placed;
  gdouble rms, left_out_rms;
  gdouble warp[2], warp_sd[2];
  gdouble variance;
  ClothCalibrateCamera *cameras;
  gdouble *view_rms;
  gdouble *dx, *dy;
  gboolean *outlier;
  guint n_poses;
  gdouble *poses;
} ClothCalibration;

/* What goes on, and how far it is, 0 to 1. */
typedef void (*ClothCalibrateProgress) (const gchar * stage, gdouble fraction,
    gpointer user_data);

void cloth_calibrate_params_init (ClothCalibrateParams * params);
ClothCalibration *cloth_calibrate (const ClothCalibrateInput * input,
    const ClothCalibrateParams * params, ClothCalibrateProgress progress,
    gpointer user_data, GCancellable * cancellable, GError ** error);
void cloth_calibration_free (ClothCalibration * calibration);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothCalibration, cloth_calibration_free)
G_END_DECLS
