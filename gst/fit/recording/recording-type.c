/* What a recording is made of.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/recording/recording-type.h"

/* @n: number of places: vertices of all frames
 *
 * Returns: (transfer full): noise of places of which nothing is known
 */
ClothRecordingNoise *
cloth_recording_noise_new (gsize n)
{
  ClothRecordingNoise *noise = g_atomic_rc_box_new0 (ClothRecordingNoise);

  noise->n = n;
  noise->white = g_new0 (gdouble, 6 * n);
  noise->draw = g_new0 (gdouble, 6 * n);
  return noise;
}

/* @noise: (nullable): noise
 *
 * Returns: (transfer full) (nullable): the same
 */
ClothRecordingNoise *
cloth_recording_noise_ref (ClothRecordingNoise * noise)
{
  return noise ? g_atomic_rc_box_acquire (noise) : NULL;
}

static void
clear (gpointer data)
{
  ClothRecordingNoise *noise = data;

  g_free (noise->white);
  g_free (noise->draw);
}

/* @noise: (nullable) (transfer full): noise
 */
void
cloth_recording_noise_unref (ClothRecordingNoise * noise)
{
  if (noise)
    g_atomic_rc_box_release_full (noise, clear);
}

/* @recording: a recording of two frames at least
 *
 * Returns: how long a frame takes, s, on the average
 */
gdouble
cloth_recording_get_frame_s (const ClothRecording * recording)
{
  const ClothRecording *r = recording;

  return (r->times[r->n_frames - 1] - r->times[0]) / (r->n_frames - 1);
}

/* @recording: (nullable) (transfer full): a recording
 */
void
cloth_recording_free (ClothRecording * recording)
{
  if (!recording)
    return;
  g_free (recording->name);
  cloth_scene_free (recording->scene);
  g_free (recording->times);
  g_free (recording->y);
  g_free (recording->velocity);
  g_free (recording->targets);
  g_free (recording->seen);
  g_free (recording->start);
  cloth_recording_noise_unref (recording->noise);
  g_free (recording);
}
