/* What cameras saw against where the points are said to be: the part of the residual that
 * no movement of the cloth accounts for, and what each camera effect would make of it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/estimate/candidates.h"
#include "gst/fit/estimate/normal.h"
#include "gst/fit/recording/observations.h"
#include "gst/rig/capture.h"

G_BEGIN_DECLS

/* @recording: where the points are said to be; its positions may be moved
 * @observations: what was seen of it
 * @y: the positions: the recording's, or where the pictures have a point that is missing
 *   there; NaN where neither tells, [n_frames][n][3], m
 * @captures: how each camera is taken to be, the rig's at first
 * @pictures: the picture of each frame by each camera, or %NULL, [n_frames][n_cameras]
 * @stale: whether it shows the picture before once more, [n_frames][n_cameras]
 * @lost: of each camera whether pictures are taken to be lost, so that @stale counts
 *
 * A recording beside its pictures.
 */
typedef struct {
  const ClothRecording *recording;
  const ClothObservations *observations;
  gdouble *y;
  ClothCapture *captures;
  const ClothObservation **pictures;
  gboolean *stale;
  gboolean *lost;
} ClothCameraView;

/* @detection: of the places in the pictures, by their covariances and how well they agree
 * @labels: where a picture contradicts the others
 * @triangulation: how far points lie from where the pictures have them
 *
 * Mean squares of what the steps before it leave in the recording, m².
 */
typedef struct {
  gdouble detection;
  gdouble labels;
  gdouble triangulation;
} ClothCameraErrors;

ClothCandidates *cloth_camera_candidates_new (const ClothRig * rig,
    const gchar * const *effects);
const gchar *cloth_camera_why_not (const ClothEffect * effect);
guint cloth_camera_of_candidate (const ClothCandidate * candidate);

ClothCameraView *cloth_camera_view_new (const ClothRecording * recording,
    const ClothObservations * observations, guint threads);
void cloth_camera_view_apply (ClothCameraView * view, guint camera,
    const ClothEffect * effect, const gdouble * values);
void cloth_camera_view_reset (ClothCameraView * view);
void cloth_camera_view_solve_unseen (ClothCameraView * view, guint threads);
ClothNormalEquations *cloth_camera_view_linearise (ClothCameraView * view,
    guint threads, ClothCameraErrors * errors);
gdouble cloth_camera_view_stale_share (const ClothCameraView * view,
    guint camera, gdouble * sigma);
gdouble cloth_camera_view_displacement (ClothCameraView * view, guint threads);
gdouble cloth_camera_view_correct (ClothCameraView * view, guint threads,
    ClothRecording * corrected);
void cloth_camera_view_free (ClothCameraView * view);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothCameraView, cloth_camera_view_free)
G_END_DECLS
