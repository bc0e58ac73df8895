/* What a recording is made of.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/recording/noise.h"

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
  cloth_recording_noise_unref (recording->noise);
  g_free (recording);
}
