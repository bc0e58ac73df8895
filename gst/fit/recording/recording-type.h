/* What a recording is.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/sim/scene.h"

G_BEGIN_DECLS

/* @name: of the take
 * @scene: what a simulation of it needs
 * @n: number of vertices
 * @n_frames: number of frames
 * @times: their times, s
 * @sigma: standard deviation of a coordinate, m
 * @y: positions, [n_frames][n][3], m; bridged where nothing was seen
 * @velocity: their derivative, m/s
 * @seen: 1 where a vertex was seen, else 0, [n_frames][n]
 */
typedef struct {
  gchar *name;
  ClothScene *scene;
  guint n;
  guint n_frames;
  gdouble *times;
  gdouble sigma;
  gdouble *y;
  gdouble *velocity;
  gdouble *seen;
} ClothRecording;

void cloth_recording_free (ClothRecording * recording);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothRecording, cloth_recording_free)

G_END_DECLS
