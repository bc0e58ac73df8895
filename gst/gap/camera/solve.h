/* All frames of a recording beside its pictures: the part of the residual that no movement of
 * the cloth explains, its normal equations for the cameras' faults, and the points solved again.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/estimate/estimate.h"
#include "gst/gap/camera/view.h"

G_BEGIN_DECLS

/* @detection: of the points in the pictures, from their covariances, scaled by how well the
 *   pictures agree
 * @labels: of points of which one picture contradicts the others
 * @triangulation: distance of the recorded points from where the pictures have them
 *
 * Mean squares of the errors that the steps before the diagnosis leave in the recording, m².
 */
typedef struct {
  gdouble detection;
  gdouble labels;
  gdouble triangulation;
} ClothCameraErrors;

ClothCameraView *cloth_camera_view_new (const ClothRecording * recording,
    const ClothObservations * observations, guint threads);
void cloth_camera_view_solve_unseen (ClothCameraView * view, guint threads);
ClothNormalEquations *cloth_camera_view_linearise (ClothCameraView * view,
    guint threads, ClothCameraErrors * errors);
gdouble cloth_camera_view_displacement (ClothCameraView * view, guint threads);
gdouble cloth_camera_view_correct (ClothCameraView * view, guint threads,
    ClothRecording * corrected);

G_END_DECLS
