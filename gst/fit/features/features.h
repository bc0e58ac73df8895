/* Residuals as few numbers: waves over the cloth, and in each block of time.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/recording/recording.h"

G_BEGIN_DECLS

/* Most waves along u and along v. */
#define CLOTH_FEATURES_MAX_WAVES_EACH 16

/* @n: number of vertices
 * @n_waves: waves over the flat cloth, orthonormal
 * @waves: their values, [n][n_waves]
 * @wave_numbers: cycles per metre, whichever way, [n_waves]
 * @bands: 0 for the longest waves, growing, [n_waves]
 * @n_bands: number of bands of waves
 * @n_blocks: blocks of time
 * @n_cosines: cosines kept of each block
 * @block_frames: length of a block
 * @cosines: [n_cosines][length of a block], orthonormal
 * @first: first frame of each block and one past the last, [n_blocks + 1]
 * @size: number of features: [n_blocks][n_cosines][n_waves][3]
 * @sigma: of a coordinate, m: features of pure noise have the variance 1
 * @whitened: the recording's noise differs from place to place, and residuals are divided by it
 *   before waves are made of them
 *
 * Discrete cosine transform over (u, v) and, block by block, over time; of cloths that
 * are no grid the same waves made orthonormal on its vertices.
 */
typedef struct {
  guint n;
  guint n_waves;
  gdouble *waves;
  gdouble *wave_numbers;
  guint *bands;
  guint n_bands;
  guint n_blocks;
  guint n_cosines;
  guint block_frames;
  gdouble *cosines;
  guint *first;
  gsize size;
  gdouble sigma;
  gboolean whitened;
} ClothFeatures;

ClothFeatures *cloth_features_new (const ClothRecording * recording,
    guint n_waves_each, gdouble block_s, gdouble highest_hz);
void cloth_features_add (const ClothFeatures * features,
    const ClothRecording * recording, guint frame, const gdouble * positions,
    gdouble * z);
void cloth_features_window (const ClothFeatures * features,
    const gdouble * z, guint part, guint n_parts, gdouble * windowed);
void cloth_features_free (ClothFeatures * features);

/* @recording: what the residual is of
 * @features: waves over the cloth and cosines over all of the time
 * @z: the residual in them, in multiples of the noise
 * @square: sum of the squared distances, m²
 * @highest_hz: half the rate of the frames
 * @resolution_hz: how far its frequencies lie apart
 *
 * Fill it frame by frame, then ask.
 */
typedef struct {
  const ClothRecording *recording;
  ClothFeatures *features;
  gdouble *z;
  gdouble square;
  gdouble highest_hz;
  gdouble resolution_hz;
} ClothEnergySpectrum;

ClothEnergySpectrum *cloth_energy_spectrum_new (const ClothRecording * recording);
void cloth_energy_spectrum_add (ClothEnergySpectrum * energy, guint frame,
    const gdouble * positions);
void cloth_energy_spectrum_subtract (ClothEnergySpectrum * energy,
    const ClothEnergySpectrum * other, const gfloat * rest);
gdouble cloth_energy_spectrum_total (const ClothEnergySpectrum * energy);
gdouble cloth_energy_spectrum_static (const ClothEnergySpectrum * energy);
void cloth_energy_spectrum_bin (const ClothEnergySpectrum * energy, const gdouble * hz,
    guint n_hz, const gdouble * waves, guint n_waves, gdouble * cells,
    gdouble * noise);
void cloth_energy_spectrum_free (ClothEnergySpectrum * energy);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothFeatures, cloth_features_free)
G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothEnergySpectrum, cloth_energy_spectrum_free)
G_END_DECLS
