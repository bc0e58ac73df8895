/* How a residual's energy spreads over frequencies and wave lengths.
 *
 * A discrete cosine transform over (u, v, t) is orthonormal: energies add up (Parseval),
 * and the first cosine over time is what stands still.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/features/spectrum.h"

#include <math.h>

/* Longer takes come in blocks of at most so many frames: cosines of all times are a square
 * of them. */
#define MAX_BLOCK_FRAMES 600u

/* @recording: what the residual is of; borrowed
 *
 * Returns: (transfer full): no energy yet
 */
ClothEnergySpectrum *
cloth_energy_spectrum_new (const ClothRecording * recording)
{
  ClothEnergySpectrum *e = g_new0 (ClothEnergySpectrum, 1);
  guint n = recording->n_frames;
  guint n_blocks = (n + MAX_BLOCK_FRAMES - 1) / MAX_BLOCK_FRAMES;
  gdouble frame_s = (recording->times[n - 1] - recording->times[0]) / (n - 1);

  e->recording = recording;
  e->highest_hz = 0.5 / frame_s;
  e->features = cloth_features_new (recording, CLOTH_FEATURES_MAX_WAVES_EACH,
      n / n_blocks * frame_s, e->highest_hz);
  e->resolution_hz = 0.5 / (e->features->block_frames * frame_s);
  e->z = g_new0 (gdouble, e->features->size);
  return e;
}

/* @energy: the energy
 * @frame: a frame, each once
 * @positions: simulated in this frame, [n][3], m
 *
 * What was not seen counts as equal.
 */
void
cloth_energy_spectrum_add (ClothEnergySpectrum * energy, guint frame,
    const gdouble * positions)
{
  const ClothRecording *r = energy->recording;
  const gdouble *y = r->y + 3 * (gsize) frame * r->n;

  if (frame < energy->features->first[0])
    return;
  cloth_features_add (energy->features, r, frame, positions, energy->z);
  for (guint v = 0; v < r->n; v++) {
    if (r->seen[(gsize) frame * r->n + v] == 0.)
      continue;
    for (guint k = 0; k < 3; k++)
      energy->square += (positions[3 * v + k] - y[3 * v + k]) *
          (positions[3 * v + k] - y[3 * v + k]);
  }
}

static gdouble
count (const ClothEnergySpectrum * e)
{
  return (gdouble) e->features->n * e->features->n_blocks *
      e->features->block_frames;
}

/* @energy: the energy
 *
 * Returns: mean square of the distance over vertices and frames, m²; of it the waves hold
 *   what is not too fine for them
 */
gdouble
cloth_energy_spectrum_total (const ClothEnergySpectrum * energy)
{
  return energy->square / count (energy);
}

/* @energy: the energy
 *
 * Returns: mean square of each wave's mean over time, m²
 */
gdouble
cloth_energy_spectrum_static (const ClothEnergySpectrum * energy)
{
  const ClothFeatures *f = energy->features;
  gsize block = 3 * (gsize) f->n_cosines * f->n_waves;
  gdouble sum = 0.;

  for (guint k = 0; k < 3 * f->n_waves; k++) {
    gdouble mean = 0.;

    for (guint b = 0; b < f->n_blocks; b++)
      mean += energy->z[b * block + k] / f->n_blocks;
    sum += f->n_blocks * mean * mean;
  }
  return sum * f->sigma * f->sigma / count (energy);
}

/* The last cell that begins at @x or before; the first one also gets what is below. */
static guint
find_cell (const gdouble * edges, guint n, gdouble x)
{
  guint cell = 0;

  while (cell + 1 < n && x >= edges[cell + 1])
    cell++;
  return cell;
}

/* @energy: the energy
 * @hz: (array length=n_hz): where each band of frequencies begins, growing
 * @n_hz: how many; the last one has no end
 * @waves: (array length=n_waves): where each band of waves begins, cycles per metre
 * @n_waves: how many; the last one has no end
 * @cells: (out) (array): mean squares, [n_waves][n_hz], m²; NaN where the take is too
 *   short or the mesh too coarse to have any
 * @noise: (out) (optional) (array): what white noise would have there
 */
void
cloth_energy_spectrum_bin (const ClothEnergySpectrum * energy,
    const gdouble * hz, guint n_hz, const gdouble * waves, guint n_waves,
    gdouble * cells, gdouble * noise)
{
  const ClothFeatures *f = energy->features;
  gdouble unit = f->sigma * f->sigma / count (energy);

  for (guint i = 0; i < n_hz * n_waves; i++) {
    cells[i] = NAN;
    if (noise)
      noise[i] = NAN;
  }
  for (guint c = 0; c < f->n_cosines; c++) {
    guint column = find_cell (hz, n_hz, c * energy->resolution_hz);

    for (guint w = 0; w < f->n_waves; w++) {
      guint cell = find_cell (waves, n_waves, f->wave_numbers[w]) * n_hz +
          column;
      gdouble sum = 0.;

      for (guint b = 0; b < f->n_blocks; b++) {
        const gdouble *z = energy->z + 3 * (((gsize) b * f->n_cosines + c) *
            f->n_waves + w);

        sum += z[0] * z[0] + z[1] * z[1] + z[2] * z[2];
      }
      cells[cell] = (isnan (cells[cell]) ? 0. : cells[cell]) + unit * sum;
      if (noise)
        noise[cell] = (isnan (noise[cell]) ? 0. : noise[cell]) + unit * 3 *
            f->n_blocks;
    }
  }
}

/* @energy: (nullable) (transfer full): the energy
 */
void
cloth_energy_spectrum_free (ClothEnergySpectrum * energy)
{
  if (!energy)
    return;
  cloth_features_free (energy->features);
  g_free (energy->z);
  g_free (energy);
}
