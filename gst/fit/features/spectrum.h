/* How a residual's energy spreads over frequencies and wave lengths.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/features/features.h"

G_BEGIN_DECLS

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
gdouble cloth_energy_spectrum_total (const ClothEnergySpectrum * energy);
gdouble cloth_energy_spectrum_static (const ClothEnergySpectrum * energy);
void cloth_energy_spectrum_bin (const ClothEnergySpectrum * energy, const gdouble * hz,
    guint n_hz, const gdouble * waves, guint n_waves, gdouble * cells,
    gdouble * noise);
void cloth_energy_spectrum_free (ClothEnergySpectrum * energy);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothEnergySpectrum, cloth_energy_spectrum_free)
G_END_DECLS
