/* What a recording is.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/math/random.h"
#include "gst/sim/scene.h"

G_BEGIN_DECLS

/* @n: number of places, vertices of all frames
 * @white: root of the inverse covariance of each, xx, yy, zz, yz, xz, xy, 1/m
 * @draw: along which directions anything is known of it, and the observer draws it, likewise: a
 *   projector
 * @square: mean square of the error, m²
 *
 * Noise that differs from place to place and from direction to direction; shared by recordings
 * that are made of one, if their places are the same.
 */
typedef struct {
  gsize n;
  gdouble *white;
  gdouble *draw;
  gdouble square;
} ClothRecordingNoise;

/* @name: of the take
 * @scene: what a simulation of it needs
 * @n: number of vertices
 * @n_frames: number of frames
 * @times: their times, s
 * @sigma: usual standard deviation of a coordinate, m
 * @noise: (nullable): when it differs from place to place
 * @y: positions, [n_frames][n][3], m; bridged where nothing was seen
 * @velocity: their derivative, m/s
 * @targets: (nullable): what draws a simulation in place of @y, on straight lines from frame to frame
 * @seen: 1 where a vertex was seen, less where outlines alone tell of it, which draw less strongly, 0 where
 *   nothing does, [n_frames][n]
 * @start: (nullable): where the cloth is in the first frame, [n][3], NaN where that isn't known, rather than what
 *   was seen there
 * @between: of a twin, standard deviation of what its own frames leave unknown of a coordinate at the recording's
 *   times, where that is more than noise, m
 * @simulated: places that nobody saw are where a simulation has them, and no bridges: filling in leaves them
 */
typedef struct {
  gchar *name;
  ClothScene *scene;
  guint n;
  guint n_frames;
  gdouble *times;
  gdouble sigma;
  ClothRecordingNoise *noise;
  gdouble *y;
  gdouble *velocity;
  gdouble *targets;
  gdouble *seen;
  gfloat *start;
  gdouble between;
  gboolean simulated;
} ClothRecording;

ClothRecordingNoise *cloth_recording_noise_new (gsize n);
ClothRecordingNoise *cloth_recording_noise_ref (ClothRecordingNoise * noise);
void cloth_recording_noise_unref (ClothRecordingNoise * noise);
gdouble cloth_recording_get_frame_s (const ClothRecording * recording);
void cloth_recording_free (ClothRecording * recording);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothRecording, cloth_recording_free)

G_END_DECLS
