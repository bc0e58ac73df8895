/* A recording beside the pictures that it was made from.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/effect/effect.h"
#include "gst/fit/recording/recording.h"
#include "gst/rig/capture.h"

G_BEGIN_DECLS

/* @recording: the points' recorded positions, which may be corrected
 * @observations: what was seen of it
 * @y: the positions: the recording's, or, where a point is missing there, what the pictures
 *   say; NaN where neither knows, [n_frames][n][3], m
 * @captures: how each camera is assumed to be, at first as the rig says
 * @pictures: the picture of each frame by each camera, or %NULL, [n_frames][n_cameras]
 * @stale: whether it shows the picture before once more, [n_frames][n_cameras]
 * @lost: of each camera whether pictures are assumed to be lost, so that @stale counts
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

ClothCameraView *cloth_camera_view_match (const ClothRecording * recording,
    const ClothObservations * observations);
void cloth_camera_view_apply (ClothCameraView * view, guint camera,
    const ClothEffect * effect, const gdouble * values);
void cloth_camera_view_reset (ClothCameraView * view);
gdouble cloth_camera_view_stale_share (const ClothCameraView * view,
    guint camera, gdouble * sigma);
void cloth_camera_view_free (ClothCameraView * view);

/* The picture of a frame. */
static inline const ClothObservation **
cloth_camera_picture (const ClothCameraView * v, guint frame, guint camera)
{
  return v->pictures + (gsize) frame * v->observations->rig->n_cameras + camera;
}

/* Whether the picture of a frame shows the one before once more. */
static inline gboolean *
cloth_camera_stale (const ClothCameraView * v, guint frame, guint camera)
{
  return v->stale + (gsize) frame * v->observations->rig->n_cameras + camera;
}

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothCameraView, cloth_camera_view_free)
G_END_DECLS
