/* Points in space from what several cameras saw, with their covariance.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/simd.h"
#include "gst/math/pool.h"
#include "gst/rig/camera.h"

G_BEGIN_DECLS

/* Greatest number of cameras, and of points in one call. */
#define CLOTH_TRIANGULATE_MAX_CAMERAS 64
#define CLOTH_TRIANGULATE_MAX_POINTS 1000000

#define CLOTH_TRIANGULATE_ERROR (cloth_triangulate_error_quark ())
GQuark cloth_triangulate_error_quark (void);

/* @CLOTH_TRIANGULATE_ERROR_CAMERAS: fewer than 2 or more than 64 cameras
 * @CLOTH_TRIANGULATE_ERROR_CAMERA: a camera that is not finite or projects onto a line
 * @CLOTH_TRIANGULATE_ERROR_VIEWS: not as many views as cameras
 * @CLOTH_TRIANGULATE_ERROR_POINTS: more points than the limit
 */
typedef enum {
  CLOTH_TRIANGULATE_ERROR_CAMERAS,
  CLOTH_TRIANGULATE_ERROR_CAMERA,
  CLOTH_TRIANGULATE_ERROR_VIEWS,
  CLOTH_TRIANGULATE_ERROR_POINTS
} ClothTriangulateError;

/* @CLOTH_POINT_UNSEEN: not known, see #ClothPointReason
 * @CLOTH_POINT_MEASURED: three or more views agree
 * @CLOTH_POINT_TWO_VIEWS: two views: no third one checks it along the epipolar lines
 */
typedef enum {
  CLOTH_POINT_UNSEEN,
  CLOTH_POINT_MEASURED,
  CLOTH_POINT_TWO_VIEWS
} ClothPointState;

/* @CLOTH_POINT_FINE: the point is known
 * @CLOTH_POINT_FEW_VIEWS: too few cameras saw it
 * @CLOTH_POINT_PARALLEL: its rays are so near to parallel that its distance is unknown
 * @CLOTH_POINT_BEHIND: its rays meet behind a camera
 * @CLOTH_POINT_DISAGREE: the views contradict each other and no majority of them agrees
 *
 * Why a point is %CLOTH_POINT_UNSEEN.
 */
typedef enum {
  CLOTH_POINT_FINE,
  CLOTH_POINT_FEW_VIEWS,
  CLOTH_POINT_PARALLEL,
  CLOTH_POINT_BEHIND,
  CLOTH_POINT_DISAGREE
} ClothPointReason;

/* @min_views: views a point needs, >= 2
 * @threshold: normalised error, in standard deviations, above which a view disagrees
 * @max_error: reprojection error above which a view disagrees whatever its stated
 *   covariance, px at the centre of the picture; 0 switches this test off
 * @error_floor: variance added to both axes of every observation, px²: what calibration
 *   and lens model leave beyond the stated covariance
 * @huber: normalised error, in standard deviations, from which on the search for
 *   outliers gives an observation less weight
 */
typedef struct {
  guint min_views;
  gdouble threshold;
  gdouble max_error;
  gdouble error_floor;
  gdouble huber;
} ClothTriangulateParameters;

#define CLOTH_TRIANGULATE_PARAMETERS_DEFAULT { 2, 4., 0., 0., 2. }

/* @x: (nullable): columns as filmed, px, NaN where the point was not seen; %NULL when
 *   the camera has nothing for this call
 * @y: (nullable): rows as filmed, px
 * @xx: (nullable): variances of @x, px²; %NULL: 1 px² each and no covariance
 * @xy: (nullable): covariances of @x and @y, px²; %NULL: none
 * @yy: (nullable): variances of @y, px²; %NULL: as @xx
 *
 * What one camera saw: element i belongs to point i. An observation whose covariance,
 * with the error floor added, is not finite and positive definite counts as not seen.
 */
typedef struct {
  const gdouble *x, *y;
  const gdouble *xx, *xy, *yy;
} ClothTriangulateView;

/* @n_points: number of points
 * @position: x, y, z: three arrays, the unit of the cameras' translations (m), world
 *   frame; NaN where unseen
 * @covariance: xx, xy, xz, yy, yz, zz: six arrays, m²; where unseen the variances are
 *   infinite and the rest 0
 * @state: #ClothPointState
 * @reason: #ClothPointReason
 * @n_views: views used
 * @views: which: bit i for camera i
 * @n_rejected: views seen but left out because they disagree
 * @chi2: sum of squares of the normalised reprojection errors of the views used; it has
 *   2·n_views − 3 degrees of freedom. NaN where unseen
 */
typedef struct {
  guint n_points;
  gdouble *position[3];
  gdouble *covariance[6];
  guint8 *state, *reason, *n_views, *n_rejected;
  guint64 *views;
  gdouble *chi2;
} ClothTriangulation;

typedef struct _ClothTriangulator ClothTriangulator;

ClothTriangulator *cloth_triangulator_new (guint n_cameras,
    const ClothCamera * cameras, GError ** error);
ClothTriangulator *cloth_triangulator_new_projections (guint n_cameras,
    const gdouble * projections, GError ** error);
void cloth_triangulator_free (ClothTriangulator * self);

void cloth_triangulator_set_parameters (ClothTriangulator * self,
    const ClothTriangulateParameters * parameters);
void cloth_triangulator_set_pool (ClothTriangulator * self, ClothPool * pool);
void cloth_triangulator_set_simd (ClothTriangulator * self, ClothSimd simd);

gboolean cloth_triangulator_run (ClothTriangulator * self, guint n_views,
    const ClothTriangulateView * views, guint n_points,
    const ClothTriangulation ** result, GError ** error);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothTriangulator, cloth_triangulator_free)
G_END_DECLS
