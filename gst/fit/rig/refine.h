/* Cameras calibrated by the cloth that they film.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/recording/recording.h"

G_BEGIN_DECLS

/* @turned_rad: how well a calibration knows where a camera looks, about each axis (0.0005)
 * @moved_m: where it is (0.0005)
 * @focal: its focal length, relative (0.001)
 * @late_s: its clock (0.001)
 * @huber: observations further off than this many standard deviations get less weight (2)
 * @most_points: so many places are used, evenly over the film (6000)
 * @max_iterations: of Levenberg and Marquardt's method (60)
 */
typedef struct {
  gdouble turned_rad;
  gdouble moved_m;
  gdouble focal;
  gdouble late_s;
  gdouble huber;
  guint most_points;
  guint max_iterations;
} ClothRefineOptions;

#define CLOTH_REFINE_OPTIONS_DEFAULT { 5e-4, 5e-4, 1e-3, 1e-3, 2., 6000, 60 }

/* @turned_rad: rotation vector about the camera's own axes (x right, y down, z ahead)
 * @moved_m: by how much its centre moved, world axes
 * @focal: by how much its focal lengths grew, relative
 * @late_s: by how much more its clock is late
 * @turned_sd, @moved_sd, @focal_sd, @late_sd: their standard deviations
 * @n: observations of it that were used
 *
 * What changed of a camera.
 */
typedef struct {
  gdouble turned_rad[3], turned_sd[3];
  gdouble moved_m[3], moved_sd[3];
  gdouble focal, focal_sd;
  gdouble late_s, late_sd;
  guint n;
} ClothRefineCamera;

/* @chi_square: mean square of the reprojection errors over their variance, error floor included,
 *   over the degrees of freedom, of all observations that agree with others to 4 deviations
 * @contradicted: share of the observations that don't
 */
typedef struct {
  gdouble chi_square, contradicted;
} ClothRefineAgreement;

/* @rig: the cameras as the cloth has them, with standard deviations
 * @cameras: (array): what changed of each
 * @n_points: places used
 * @n_observations: observations of them
 * @error_floor: variance that was added to each observation, px²: what the refined cameras still
 *   disagree by
 * @settled: whether the numbers stopped moving; if not, they and their deviations are not the last word
 * @before: how the cameras agreed as they were
 * @after: how the refined ones do
 */
typedef struct {
  ClothRig *rig;
  ClothRefineCamera *cameras;
  guint n_points, n_observations;
  gdouble error_floor;
  gboolean settled;
  ClothRefineAgreement before, after;
} ClothRefinement;

ClothRefinement *cloth_refine_rig (const ClothObservations * observations,
    const ClothRefineOptions * options, GError ** error);
void cloth_refinement_free (ClothRefinement * refinement);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothRefinement, cloth_refinement_free)
G_END_DECLS
