/* A recording beside the pictures that it was made from: which picture belongs to which frame,
 * and how each camera is assumed to be.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/camera/view.h"

#include <math.h>

/* A picture belongs to the nearest frame; of several the nearest picture is that of the frame. */
static void
place_pictures (ClothCameraView * v)
{
  const ClothRecording *r = v->recording;

  for (guint i = 0; i < v->observations->list->len; i++) {
    const ClothObservation *observation =
        &g_array_index (v->observations->list, ClothObservation, i), **place;
    const gdouble late =
        v->observations->rig->cameras[observation->camera].offset_s;
    const gint frame = cloth_recording_find_frame (r, observation->time_s -
        late);

    if (frame < 0)
      continue;
    place = cloth_camera_picture (v, (guint) frame, observation->camera);
    if (!*place || fabs (observation->time_s - late - r->times[frame]) <
        fabs ((*place)->time_s - late - r->times[frame]))
      *place = observation;
  }
}

/* @recording: the points' recorded positions; kept by reference
 * @observations: what was seen of it; kept by reference
 *
 * Finds the picture of each frame. What the pictures say of unseen points, and which pictures
 * are stale, is not known yet: see cloth_camera_view_new ().
 *
 * Returns: (transfer full): both side by side, the cameras being as the rig says
 */
ClothCameraView *
cloth_camera_view_match (const ClothRecording * recording,
    const ClothObservations * observations)
{
  ClothCameraView *v = g_new0 (ClothCameraView, 1);
  gsize n = (gsize) recording->n_frames * observations->rig->n_cameras;

  v->recording = recording;
  v->observations = observations;
  v->captures = g_new (ClothCapture, observations->rig->n_cameras);
  v->lost = g_new (gboolean, observations->rig->n_cameras);
  v->pictures = g_new0 (const ClothObservation *, n);
  v->stale = g_new0 (gboolean, n);
  cloth_camera_view_reset (v);
  place_pictures (v);
  v->y = g_memdup2 (recording->y, 3 * (gsize) recording->n *
      recording->n_frames * sizeof *v->y);
  return v;
}

/* @view: a recording beside its pictures
 *
 * Assumes the cameras to be as the rig says.
 */
void
cloth_camera_view_reset (ClothCameraView * view)
{
  for (guint c = 0; c < view->observations->rig->n_cameras; c++) {
    cloth_capture_init (&view->captures[c],
        &view->observations->rig->cameras[c]);
    view->lost[c] = FALSE;
  }
}

/* @view: a recording beside its pictures
 * @camera: a camera, or the number of cameras: all
 * @effect: an effect that moves points
 * @values: its parameters
 *
 * Assumes one more effect to act on cameras.
 */
void
cloth_camera_view_apply (ClothCameraView * view, guint camera,
    const ClothEffect * effect, const gdouble * values)
{
  guint n = view->observations->rig->n_cameras;

  for (guint c = camera < n ? camera : 0; c < n && (c == camera
          || camera == n); c++) {
    if (effect->test == CLOTH_EFFECT_TEST_REPEAT)
      view->lost[c] = TRUE;
    else
      cloth_capture_add_effect (&view->captures[c], effect->id, values, NULL);
  }
}

/* @view: (nullable) (transfer full): what cloth_camera_view_new () made
 */
void
cloth_camera_view_free (ClothCameraView * view)
{
  if (!view)
    return;
  g_free (view->y);
  g_free (view->captures);
  g_free (view->lost);
  g_free (view->pictures);
  g_free (view->stale);
  g_free (view);
}

/* @view: a recording beside its pictures
 * @camera: a camera
 * @sigma: (out): standard deviation of a share of so many pictures
 *
 * Returns: the share of its pictures that show the one before once more
 */
gdouble
cloth_camera_view_stale_share (const ClothCameraView * view, guint camera,
    gdouble * sigma)
{
  guint n = 0, stale = 0;
  gdouble share;

  for (guint f = 0; f < view->recording->n_frames; f++) {
    n += *cloth_camera_picture (view, f, camera) != NULL;
    stale += *cloth_camera_stale (view, f, camera);
  }
  share = n ? (gdouble) stale / n : 0.;
  *sigma = n ? sqrt (share * (1. - share) / n) : 0.;
  return share;
}
