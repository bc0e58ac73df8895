/* How a residual's energy spreads over frequencies and wave lengths.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/features/features.h"

G_BEGIN_DECLS

/**
 * ClothGapEnergy:
 * @recording: what the residual is of
 * @features: waves over the cloth and cosines over all of the time
 * @z: the residual in them, in multiples of the noise
 * @square: sum of the squared distances, m²
 * @highest_hz: half the rate of the frames
 * @resolution_hz: how far its frequencies lie apart
 *
 * Fill it frame by frame, then ask.
 *
 * Since: 0.1
 */
typedef struct {
  const ClothRecording *recording;
  ClothGapFeatures *features;
  gdouble *z;
  gdouble square;
  gdouble highest_hz;
  gdouble resolution_hz;
} ClothGapEnergy;

ClothGapEnergy *cloth_gap_energy_new (const ClothRecording * recording);
void cloth_gap_energy_add (ClothGapEnergy * energy, guint frame,
    const gdouble * positions);
gdouble cloth_gap_energy_total (const ClothGapEnergy * energy);
gdouble cloth_gap_energy_static (const ClothGapEnergy * energy);
void cloth_gap_energy_bin (const ClothGapEnergy * energy, const gdouble * hz,
    guint n_hz, const gdouble * waves, guint n_waves, gdouble * cells,
    gdouble * noise);
void cloth_gap_energy_free (ClothGapEnergy * energy);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothGapEnergy, cloth_gap_energy_free)
G_END_DECLS
