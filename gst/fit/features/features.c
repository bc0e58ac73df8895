/* Residuals as few numbers, and how their energy spreads over frequencies and wave lengths.
 *
 * Model: a residual over the cloth (u, v) and a block of time t is a sum of products of cosines
 *   cos π k (i + ½) / n, one factor for each of u, v and t: a discrete cosine transform.
 * Assumption: what an effect does is in long waves and low frequencies; only these are kept.
 *   What was not seen counts as equal to the recording.
 * Formula: feature = Σ Λ^½ residual · cosines, with Λ^½ = I/σ where the noise is the same everywhere, and the cosines orthonormal on the vertices, so
 *   that noise has the variance 1 in each feature and energies add up (Parseval). On cloth
 *   that is no grid the waves are made orthonormal one after the other (Gram and Schmidt).
 *   The first cosine over time is what stands still.
 * Reference: Ahmed, Natarajan and Rao, Discrete cosine transform, 1974.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/features/features.h"

#include <math.h>
#include <string.h>

#include "gst/fit/features/features-private.h"

/* A wave that the others make up to this share of its length is left out. */
#define DEPENDENT 1e-3

static void
extent (const ClothTopology * t, guint k, gdouble * low, gdouble * high)
{
  *low = INFINITY;
  *high = -INFINITY;
  for (guint v = 0; v < t->n_vertices; v++) {
    *low = MIN (*low, t->uv[2 * v + k]);
    *high = MAX (*high, t->uv[2 * v + k]);
  }
}

/* cos π k (i + ½) / n on a grid, and between its lines. Returns its cycles per metre. */
static gdouble
fill_wave (const ClothTopology * t, guint ku, guint kv, gdouble * wave)
{
  gdouble low[2], high[2];
  guint lines[2] = { t->columns, t->rows };
  guint waves[2] = { ku, kv };
  gdouble per_metre = 0.;

  for (guint k = 0; k < 2; k++) {
    extent (t, k, &low[k], &high[k]);
    if (!lines[k])
      lines[k] = MAX (2, (guint) sqrt (t->n_vertices));
    if (waves[k])
      per_metre = hypot (per_metre, waves[k] * (1. - 1. / lines[k]) / 2. /
          (high[k] - low[k]));
  }
  for (guint v = 0; v < t->n_vertices; v++) {
    gdouble at[2];

    for (guint k = 0; k < 2; k++)
      at[k] = ((t->uv[2 * v + k] - low[k]) / (high[k] - low[k]) *
          (lines[k] - 1) + 0.5) / lines[k];
    wave[v] = cos (G_PI * ku * at[0]) * cos (G_PI * kv * at[1]);
  }
  return per_metre;
}

/* Gram–Schmidt against the waves before, twice for rounding's sake. */
static gboolean
orthonormalise (const ClothFeatures * f, const gdouble * waves, gdouble * wave)
{
  gdouble before = 0., after = 0.;

  for (guint v = 0; v < f->n; v++)
    before += wave[v] * wave[v];
  for (guint pass = 0; pass < 2; pass++)
    for (guint w = 0; w < f->n_waves; w++) {
      const gdouble *other = waves + (gsize) w * f->n;
      gdouble share = 0.;

      for (guint v = 0; v < f->n; v++)
        share += other[v] * wave[v];
      for (guint v = 0; v < f->n; v++)
        wave[v] -= share * other[v];
    }
  for (guint v = 0; v < f->n; v++)
    after += wave[v] * wave[v];
  if (!(after > DEPENDENT * DEPENDENT * before))
    return FALSE;
  for (guint v = 0; v < f->n; v++)
    wave[v] /= sqrt (after);
  return TRUE;
}

static void
make_waves (ClothFeatures * f, const ClothTopology * t, guint each)
{
  g_autofree gdouble *waves = g_new (gdouble, (gsize) each * each * f->n);

  f->bands = g_new (guint, (gsize) each * each);
  f->wave_numbers = g_new (gdouble, (gsize) each * each);
  for (guint kv = 0; kv < each; kv++)
    for (guint ku = 0; ku < each; ku++) {
      gdouble *wave = waves + (gsize) f->n_waves * f->n;
      guint k = MAX (ku, kv);
      gdouble per_metre = fill_wave (t, ku, kv, wave);

      if (!orthonormalise (f, waves, wave))
        continue;
      /* 0, 1, 2, 3, 4–5, 6–7 … */
      f->bands[f->n_waves] = k < 4 ? k : 2 + k / 2;
      f->wave_numbers[f->n_waves] = per_metre;
      f->n_bands = MAX (f->n_bands, f->bands[f->n_waves] + 1);
      f->n_waves++;
    }
  f->waves = g_new (gdouble, (gsize) f->n * f->n_waves);
  for (guint v = 0; v < f->n; v++)
    for (guint w = 0; w < f->n_waves; w++)
      f->waves[(gsize) v * f->n_waves + w] = waves[(gsize) w * f->n + v];
}

/* @recording: what they are of
 * @n_waves_each: waves along u and along v, at most %CLOTH_FEATURES_MAX_WAVES_EACH
 * @block_s: length of a block of time, s
 * @highest_hz: highest frequency that is kept
 *
 * Returns: (transfer full): the features
 */
ClothFeatures *
cloth_features_new (const ClothRecording * recording, guint n_waves_each,
    gdouble block_s, gdouble highest_hz)
{
  ClothFeatures *f = g_new0 (ClothFeatures, 1);
  gdouble frame_s = cloth_recording_get_frame_s (recording);

  f->n = recording->n;
  f->sigma = recording->sigma;
  f->whitened = recording->noise != NULL;
  make_waves (f, recording->scene->topology, MIN (n_waves_each,
          CLOTH_FEATURES_MAX_WAVES_EACH));
  f->block_frames = CLAMP ((guint) round (block_s / frame_s), 4,
      recording->n_frames);
  f->n_blocks = recording->n_frames / f->block_frames;
  f->first = g_new (guint, f->n_blocks + 1);
  for (guint b = 0; b <= f->n_blocks; b++)
    f->first[b] = recording->n_frames - (f->n_blocks - b) * f->block_frames;
  f->n_cosines = CLAMP ((guint) ceil (2. * f->block_frames * frame_s *
          highest_hz), 1, f->block_frames);
  f->cosines = g_new (gdouble, (gsize) f->n_cosines * f->block_frames);
  for (guint k = 0; k < f->n_cosines; k++)
    for (guint i = 0; i < f->block_frames; i++)
      f->cosines[(gsize) k * f->block_frames + i] =
          cos (G_PI * k * (i + 0.5) / f->block_frames) *
          sqrt ((k ? 2. : 1.) / f->block_frames);
  f->size = 3 * (gsize) f->n_blocks * f->n_cosines * f->n_waves;
  return f;
}

/* @features: the features
 * @recording: the recording
 * @frame: one of its frames
 * @positions: simulated in this frame, [n][3], m
 * @z: (inout): features of simulated less recorded; start with zeros
 *
 * Adds a frame's part. What was not seen counts as equal.
 */
void
cloth_features_add (const ClothFeatures * features,
    const ClothRecording * recording, guint frame, const gdouble * positions,
    gdouble * z)
{
  guint n_waves = features->n_waves, block = 0, at;
  gsize begin = (gsize) frame * features->n;
  gdouble sums[3][CLOTH_FEATURES_MAX_WAVES];

  if (frame < features->first[0])
    return;
  while (frame >= features->first[block + 1])
    block++;
  at = frame - features->first[block];
  CLOTH_SIMD_TABLE (cloth_projection, CLOTH_SIMD_BEST)->project (features,
      recording, begin, positions, sums);
  for (guint c = 0; c < features->n_cosines; c++) {
    gdouble cosine = features->cosines[(gsize) c * features->block_frames + at];
    gdouble *to = z + 3 * ((gsize) block * features->n_cosines + c) * n_waves;

    for (guint w = 0; w < n_waves; w++)
      for (guint k = 0; k < 3; k++)
        to[3 * w + k] += cosine * sums[k][w];
  }
}

/* @features: the features
 * @z: features
 * @part: which part of every block of time
 * @n_parts: of how many, at most as many as a block has frames
 * @windowed: (out) (array): what is left of @z when all that is outside this part of the
 *   blocks is 0; of all parts the sum is @z
 */
void
cloth_features_window (const ClothFeatures * features, const gdouble * z,
    guint part, guint n_parts, gdouble * windowed)
{
  const guint n = features->n_cosines, frames = features->block_frames;
  const gsize size = 3 * (gsize) features->n_waves;
  g_autofree gdouble *shares = g_new0 (gdouble, (gsize) n * n);

  for (guint c = 0; c < n; c++)
    for (guint k = 0; k < n; k++)
      for (guint i = part * frames / n_parts;
          i < (part + 1) * frames / n_parts; i++)
        shares[(gsize) c * n + k] += features->cosines[(gsize) c * frames +
            i] * features->cosines[(gsize) k * frames + i];
  memset (windowed, 0, features->size * sizeof *windowed);
  for (guint b = 0; b < features->n_blocks; b++)
    for (guint c = 0; c < n; c++)
      for (guint k = 0; k < n; k++) {
        const gdouble *from = z + ((gsize) b * n + k) * size;
        gdouble *to = windowed + ((gsize) b * n + c) * size;

        for (gsize i = 0; i < size; i++)
          to[i] += shares[(gsize) c * n + k] * from[i];
      }
}

/* @features: (nullable) (transfer full): the features
 */
void
cloth_features_free (ClothFeatures * features)
{
  if (!features)
    return;
  g_free (features->waves);
  g_free (features->wave_numbers);
  g_free (features->bands);
  g_free (features->cosines);
  g_free (features->first);
  g_free (features);
}

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
  /* lengths, however well they are known */
  e->features->whitened = FALSE;
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

/* @energy: (inout): the energy of a residual
 * @other: that of another one at the same vertices and times
 * @rest: their difference, [n_frames][n][3], m
 *
 * Makes it the energy of the difference.
 */
void
cloth_energy_spectrum_subtract (ClothEnergySpectrum * energy,
    const ClothEnergySpectrum * other, const gfloat * rest)
{
  const ClothFeatures *f = energy->features;
  const gsize row = 3 * (gsize) f->n;
  const gdouble scale = other->features->sigma / f->sigma;

  for (gsize i = 0; i < f->size; i++)
    energy->z[i] -= scale * other->z[i];
  energy->square = 0.;
  for (gsize i = f->first[0] * row; i < f->first[f->n_blocks] * row; i++)
    energy->square += (gdouble) rest[i] * rest[i];
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
