/* Residuals as few numbers.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/features/features.h"

#include <math.h>
#include <string.h>

#include "gst/math/cpu.h"

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
  gdouble span = recording->times[recording->n_frames - 1] -
      recording->times[0];
  gdouble frame_s = span / (recording->n_frames - 1);

  f->n = recording->n;
  f->sigma = recording->sigma;
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

typedef gdouble Sums[3][CLOTH_FEATURES_MAX_WAVES_EACH *
    CLOTH_FEATURES_MAX_WAVES_EACH];

/* What is off in a frame, on each wave. Sums over vertices stay in their order, waves are
 * side by side: all instruction sets give the same bits. */
static inline __attribute__((always_inline))
     void project (const ClothFeatures * features,
    const ClothRecording * recording, gsize begin, const gdouble * positions,
    Sums sums)
{
  guint n_waves = features->n_waves;

  memset (sums, 0, sizeof (Sums));
  for (guint v = 0; v < features->n; v++) {
    const gdouble *wave = features->waves + (gsize) v * n_waves;
    gdouble off[3];

    if (recording->seen[begin + v] == 0.)
      continue;
    for (guint k = 0; k < 3; k++)
      off[k] = (positions[3 * v + k] - recording->y[3 * (begin + v) + k]) /
          features->sigma;
    for (guint k = 0; k < 3; k++)
      for (guint w = 0; w < n_waves; w++)
        sums[k][w] += wave[w] * off[k];
  }
}

#define KERNEL(suffix, target_attribute) \
target_attribute static void \
project_##suffix (const ClothFeatures * features, \
    const ClothRecording * recording, gsize begin, const gdouble * positions, \
    Sums sums) \
{ \
  project (features, recording, begin, positions, sums); \
}

/* *INDENT-OFF* */
KERNEL (scalar,)
#if defined (__x86_64__) && defined (__GNUC__)
KERNEL (avx2, __attribute__((target ("avx2"))))
KERNEL (avx512, __attribute__((target ("avx512f,avx512bw,avx512dq,avx512vl"))))
/* *INDENT-ON* */
#define PROJECT(level, ...) \
  do { \
    if ((level) == CLOTH_SIMD_AVX512) \
      project_avx512 (__VA_ARGS__); \
    else if ((level) == CLOTH_SIMD_AVX2) \
      project_avx2 (__VA_ARGS__); \
    else \
      project_scalar (__VA_ARGS__); \
  } while (0)
#else
#define PROJECT(level, ...) project_scalar (__VA_ARGS__)
#endif

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
  Sums sums;

  if (frame < features->first[0])
    return;
  while (frame >= features->first[block + 1])
    block++;
  at = frame - features->first[block];
  PROJECT (cloth_simd_resolve (CLOTH_SIMD_BEST), features, recording, begin,
      positions, sums);
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
