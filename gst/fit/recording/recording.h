/* A recording made ready for the diagnosis: gaps bridged, velocities, noise.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/take/take.h"
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

ClothRecording *cloth_recording_new (ClothTake * take, GError ** error);
gdouble cloth_recording_estimate_sigma (const ClothRecording * recording);
gdouble cloth_recording_longest_side (const ClothRecording * recording);
gdouble cloth_recording_find_scale (const ClothRecording * recording,
    guint corner);
gboolean cloth_recording_check (const ClothRecording * recording,
    gboolean told, GError ** error);
gboolean cloth_recording_check_other (const ClothRecording * recording,
    const ClothRecording * other, GError ** error);
void cloth_recording_find_weights (const gdouble * times, guint mask,
    gdouble at, gdouble * weights);
ClothRecording *cloth_recording_resample (const ClothRecording * recording,
    guint most);
void cloth_recording_differentiate (ClothRecording * recording);
gint cloth_recording_compare_numbers (gconstpointer a, gconstpointer b);
void cloth_recording_free (ClothRecording * recording);

/* Frames of the polynomial that the velocity comes from, and its order (Savitzky and
 * Golay, Analytical Chemistry 36, 1964). */
#define CLOTH_RECORDING_WINDOW 7
#define CLOTH_RECORDING_ORDER 4

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothRecording, cloth_recording_free)
G_END_DECLS
