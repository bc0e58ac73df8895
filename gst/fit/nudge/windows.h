/* How large the gap is, and where: simulations let go in short windows.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/features/features.h"
#include "gst/fit/nudge/rollout.h"

G_BEGIN_DECLS

/* @n: number of vertices
 * @n_frames: number of frames
 * @n_windows: number of windows
 * @window: which window leads to each frame, [n_frames]
 * @tile: in which tile of the flat cloth each vertex is, [n]
 * @squares: squared distance, [n_frames][n], m²; NaN where nothing was seen
 * @positions: simulated, [n_frames][n][3], m
 * @directions: mean square along warp, weft and normal, m²
 * @nudged: (nullable): off the recording while it was nudged to it all along,
 *   [n_frames][n][3], m; 0 where nothing was seen and in the first frame; %NULL: of a free run
 * @energy: (nullable): of its distances while it was nudged to the recording all along
 * @sound: whether the simulation held
 *
 * One model's distances from a recording.
 */
typedef struct {
  guint n;
  guint n_frames;
  guint n_windows;
  guint *window;
  guint *tile;
  gdouble *squares;
  gfloat *positions;
  gdouble directions[3];
  gfloat *nudged;
  ClothEnergySpectrum *energy;
  gboolean sound;
} ClothWindowedGap;

ClothWindowedGap **cloth_windowed_gaps_new (const ClothRecording * recording,
    const ClothModel * const *models, guint n_models, gdouble gain,
    gdouble window_s, const ClothRolloutOptions * options, GError ** error);
ClothWindowedGap **cloth_windowed_gaps_new_free (const ClothRecording * recording,
    const ClothModel * const *models, guint n_models, gdouble gain,
    gdouble lead_s, gdouble window_s, const ClothRolloutOptions * options,
    GError ** error);
void cloth_windowed_gaps_free (ClothWindowedGap ** gaps, guint n);
void cloth_windowed_gap_free (ClothWindowedGap * gap);
void cloth_windowed_gap_subtract (ClothWindowedGap * gap,
    const ClothWindowedGap * other, const ClothRecording * recording);
void cloth_windowed_gap_replace (ClothWindowedGap * gap,
    const ClothRecording * recording, const ClothWindowedGap * own,
    const ClothRecording * twin);
void cloth_windowed_gaps_align (ClothWindowedGap ** gaps, guint n);
gdouble cloth_windowed_gap_square (const ClothWindowedGap * gap,
    const gboolean * windows);
void cloth_windowed_gaps_interval (ClothWindowedGap ** gaps, guint n,
    const gboolean * windows, guint64 seed, guint n_draws, gdouble * draws);

G_END_DECLS
