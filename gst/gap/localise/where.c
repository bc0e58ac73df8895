/* Where the gap lies: at which vertices, in which frames and directions, in which frequencies
 * and wave lengths, and in which stage between the cloth and the comparison.
 *
 * Vertices, frames and directions are those of the gap in its windows. Frequencies and waves
 * are those of the residual of the simulation that is nudged to the recording all along: the
 * windows would show their own rate. Its discrete cosine transform over (u, v, t) is
 * orthonormal, so that energies add up (Parseval).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/localise/where.h"

#include <math.h>

/* Bands of frequencies are octaves from here on, Hz, those of the report half ones. */
#define FIRST_HZ 0.5
#define FIRST_DRAWN_HZ 0.25
/* A last band must reach this much above its beginning. */
#define LEAST_BAND 1.2
/* Where bands of waves begin, half waves along the cloth's longer side. */
static const gdouble wave_edges[] = { 0., 0.5, 1.5, 2.5, 5.5, 11.5 };

#define N_WAVE_BANDS G_N_ELEMENTS (wave_edges)
/* Rows of the report's spectrum: 0, 1, 2 … half waves. */
#define N_DRAWN_WAVES 13

static void
fill_playback (const ClothWindowedGap * before, const ClothWindowedGap * after,
    const ClothRecording * r, ClothTake * take, ClothGapPlayback * p)
{
  gsize all = (gsize) r->n * r->n_frames;

  p->take = g_strdup (r->name);
  p->topology = cloth_topology_copy (cloth_take_get_topology (take));
  p->n_frames = r->n_frames;
  p->times = g_memdup2 (r->times, r->n_frames * sizeof *r->times);
  p->recorded = g_new (gfloat, 3 * all);
  for (gsize i = 0; i < all; i++)
    for (guint k = 0; k < 3; k++)
      p->recorded[3 * i + k] = r->seen[i] > 0. ? (gfloat) r->y[3 * i + k] : NAN;
  p->before = g_memdup2 (before->positions, 3 * all * sizeof (gfloat));
  if (after)
    p->after = g_memdup2 (after->positions, 3 * all * sizeof (gfloat));
}

static void
fill_series (const ClothWindowedGap * before, const ClothWindowedGap * after,
    const ClothRecording * r, ClothGapSeries * s)
{
  g_autofree gboolean *one = g_new0 (gboolean, before->n_windows);
  g_autofree guint *counts = g_new0 (guint, before->n_windows);

  s->n = before->n_windows;
  s->times = g_new0 (gdouble, s->n);
  s->before = g_new (gdouble, s->n);
  s->after = after ? g_new (gdouble, s->n) : NULL;
  for (guint frame = 1; frame < before->n_frames; frame++) {
    s->times[before->window[frame]] += r->times[frame];
    counts[before->window[frame]]++;
  }
  for (guint w = 0; w < s->n; w++) {
    one[w] = TRUE;
    s->times[w] /= counts[w];
    s->before[w] = sqrt (cloth_windowed_gap_square (before, one));
    if (after)
      s->after[w] = sqrt (cloth_windowed_gap_square (after, one));
    one[w] = FALSE;
  }
}

/* @before: distances without the accepted effects
 * @after: (nullable): with them, where the same places count
 * @recording: what they are of
 * @take: its take
 * @result: (inout): gets the shares of vertices, frames and directions, what @after
 *   gains, the series and the playback
 */
void
cloth_windowed_gap_fill (const ClothWindowedGap * before,
    const ClothWindowedGap * after, const ClothRecording * recording,
    ClothTake * take, ClothGapResult * result)
{
  gdouble sum = 0., along = 0.;
  g_autofree gboolean *seen = g_new0 (gboolean, before->n);
  g_autofree gdouble *left = g_new0 (gdouble, before->n);

  result->n_vertices = before->n;
  result->n_frames = before->n_frames;
  result->vertices = g_new0 (gdouble, before->n);
  result->frames = g_new0 (gdouble, before->n_frames);
  for (guint frame = 1; frame < before->n_frames; frame++)
    for (guint v = 0; v < before->n; v++) {
      gsize at = (gsize) frame * before->n + v;
      gdouble square = before->squares[at];

      if (!isfinite (square))
        continue;
      seen[v] = TRUE;
      result->vertices[v] += square;
      left[v] += after ? after->squares[at] : 0.;
      result->frames[frame] += square;
      sum += square;
    }
  for (guint v = 0; v < before->n; v++)
    result->vertices[v] = seen[v] ? result->vertices[v] / sum : NAN;
  result->gained = after ? g_new (gdouble, before->n) : NULL;
  for (guint v = 0; v < before->n && after; v++)
    result->gained[v] = result->vertices[v] - left[v] / sum;
  for (guint frame = 0; frame < before->n_frames; frame++)
    result->frames[frame] /= sum;
  for (guint a = 0; a < 3; a++)
    along += before->directions[a];
  for (guint a = 0; a < 3; a++)
    result->directions[a] = along > 0. ? before->directions[a] / along : NAN;
  fill_series (before, after, recording, &result->series);
  fill_playback (before, after, recording, take, &result->playback);
}

/* Octaves, or parts of them, from @first on, or from where each holds a frequency. */
static GArray *
list_bands (const ClothEnergySpectrum * e, gdouble first, gdouble factor)
{
  GArray *edges = g_array_new (FALSE, FALSE, sizeof (gdouble));
  gdouble at = 0.;

  g_array_append_val (edges, at);
  for (at = first; at * (factor - 1.) < e->resolution_hz;)
    at *= factor;
  for (; at * LEAST_BAND < e->highest_hz; at *= factor)
    g_array_append_val (edges, at);
  return edges;
}

/* What is compared: before, after (or NULL), the floor (or NULL: white noise). */
typedef struct
{
  const ClothEnergySpectrum *before, *after, *floor;
  gdouble longest;              /* m */
} Compared;

/* Mean squares of the three, [cells] each; of what there is not NaN. */
static void
bin (const Compared * c, const gdouble * hz, guint n_hz, const gdouble * waves,
    guint n_waves, gdouble * before, gdouble * after, gdouble * floor)
{
  cloth_energy_spectrum_bin (c->before, hz, n_hz, waves, n_waves, before,
      c->floor ? NULL : floor);
  for (guint i = 0; i < n_hz * n_waves; i++)
    after[i] = NAN;
  if (c->after)
    cloth_energy_spectrum_bin (c->after, hz, n_hz, waves, n_waves, after, NULL);
  if (c->floor)
    cloth_energy_spectrum_bin (c->floor, hz, n_hz, waves, n_waves, floor, NULL);
}

static gdouble
sum (const gdouble * values, guint n)
{
  gdouble all = 0.;

  for (guint i = 0; i < n; i++)
    all += isnan (values[i]) ? 0. : values[i];
  return all;
}

static void
add_band (GArray * bands, gdouble from, gdouble to, gdouble share,
    gdouble after, gdouble over_floor)
{
  const ClothGapBand band = { from, to, share, after, over_floor };

  g_array_append_val (bands, band);
}

static void
fill_frequencies (const Compared * c, ClothGapResult * result)
{
  g_autoptr (GArray) edges = list_bands (c->before, FIRST_HZ, 2.);
  const gdouble *hz = (const gdouble *) edges->data, all_waves = 0.;
  guint n = edges->len;
  g_autofree gdouble *cells = g_new (gdouble, 3 * n);
  gdouble *before = cells, *after = cells + n, *floor = cells + 2 * n, all;

  bin (c, hz, n, &all_waves, 1, before, after, floor);
  all = sum (before, n);
  result->still = cloth_energy_spectrum_static (c->before) / all;
  for (guint i = 0; i < n; i++)
    add_band (result->bands, hz[i], i + 1 < n ? hz[i + 1] :
        c->before->highest_hz, before[i] / all, after[i] / all,
        before[i] / floor[i]);
}

/* What the waves don't hold is finer than they are. */
static void
add_rest (gdouble total, gdouble * cells)
{
  gdouble rest = total - sum (cells, N_WAVE_BANDS);
  gdouble *last = &cells[N_WAVE_BANDS - 1];

  if (rest > 1e-9 * total)
    *last = (isnan (*last) ? 0. : *last) + rest;
}

static void
fill_waves (const Compared * c, ClothGapResult * result)
{
  const guint n = N_WAVE_BANDS;
  gdouble edges[N_WAVE_BANDS], before[N_WAVE_BANDS], after[N_WAVE_BANDS];
  gdouble floor[N_WAVE_BANDS], all_hz = 0., all;
  gdouble sigma = c->before->recording->sigma;

  for (guint i = 0; i < n; i++)
    edges[i] = wave_edges[i] / (2. * c->longest);
  bin (c, &all_hz, 1, edges, n, before, after, floor);
  add_rest (cloth_energy_spectrum_total (c->before), before);
  if (c->after)
    add_rest (cloth_energy_spectrum_total (c->after), after);
  add_rest (c->floor ? cloth_energy_spectrum_total (c->floor) :
      3. * sigma * sigma, floor);
  all = sum (before, n);
  for (guint i = 0; i < n && !isnan (before[i]); i++)
    add_band (result->waves, edges[i], i + 1 < n ? edges[i + 1] : INFINITY,
        before[i] / all, after[i] / all, before[i] / floor[i]);
}

static void
fill_spectrum (const Compared * c, ClothGapSpectrum * s)
{
  g_autoptr (GArray) edges = list_bands (c->before, FIRST_DRAWN_HZ, G_SQRT2);
  gdouble waves[N_DRAWN_WAVES], still = c->before->resolution_hz / 2.;
  const gdouble *hz;
  gsize cells;

  g_array_insert_val (edges, 1, still);
  hz = (const gdouble *) edges->data;
  s->n_frequencies = edges->len;
  s->n_waves = N_DRAWN_WAVES;
  s->frequencies = g_new (gdouble, s->n_frequencies);
  s->waves = g_new (gdouble, s->n_waves);
  for (guint i = 0; i < s->n_frequencies; i++)
    s->frequencies[i] = sqrt (hz[i] * (i + 1 < edges->len ? hz[i + 1] :
            c->before->highest_hz));
  for (guint k = 0; k < N_DRAWN_WAVES; k++) {
    waves[k] = MAX (k - 0.5, 0.) / (2. * c->longest);
    s->waves[k] = k / (2. * c->longest);
  }
  cells = (gsize) s->n_frequencies * s->n_waves;
  s->before = g_new (gdouble, cells);
  s->after = g_new (gdouble, cells);
  s->null = g_new (gdouble, cells);
  bin (c, hz, s->n_frequencies, waves, s->n_waves, s->before, s->after,
      s->null);
  if (!c->after)
    g_clear_pointer (&s->after, g_free);
}

/* The gap's own mean square, m². */
static gdouble
windowed_square (const ClothGapPlayback * p)
{
  gsize n = (gsize) p->topology->n_vertices;
  gdouble squares = 0.;
  gsize seen = 0;

  for (gsize i = n; i < n * p->n_frames; i++) {
    gdouble square = 0.;

    for (guint k = 0; k < 3; k++)
      square += pow (p->before[3 * i + k] - p->recorded[3 * i + k], 2.);
    if (isfinite (square)) {
      squares += square;
      seen++;
    }
  }
  return squares / seen;
}

/* Why a stage has no share, where nothing is known of cameras. */
static const gchar *const unread[] = {
  "Whether a camera's calibration, clock or shutter is off shows in what each "
      "camera saw, and this take has positions only.",
  "How far what was found lies from what is there shows in the pictures, and "
      "this take has positions only.",
  "Whether points were taken for each other shows where cameras contradict "
      "each other, and this take has positions only.",
  "How far points lie from where the cameras have them shows in what each "
      "saw, and this take has positions only.",
};

/* What each step from the cloth to the comparison adds to the gap. Of noise that is left
 * which is not the detection's. */
static void
fill_stages (const ClothDiagnosis * d, const ClothRecording * r)
{
  static const gchar *const names[] = {
    "camera", "detection", "labels", "triangulation", "noise", "physics"
  };
  const ClothCameraErrors *e = &d->camera_errors;
  gdouble shares[] = { d->camera_mean_square, e->detection, e->labels,
    e->triangulation, cloth_recording_noise_square (r), 0.
  };
  const guint physics = G_N_ELEMENTS (names) - 1, noise = physics - 1;
  const gboolean cameras_are_alone = cloth_diagnosis_has_observations (d);
  gdouble all = windowed_square (&d->result->playback), sum = 0.;

  if (d->has_camera_errors)
    shares[noise] = MAX (shares[noise] - e->detection, 0.);
  for (guint i = d->has_camera_errors ? 0 : noise; i < physics; i++)
    sum += shares[i];
  all = MAX (all, sum);
  shares[physics] = all - sum;
  for (guint i = 0; i <= physics; i++) {
    const gboolean known = d->has_camera_errors || i >= noise;

    cloth_gap_result_add_stage (d->result, names[i],
        known ? shares[i] / all : NAN, known ? NULL : cameras_are_alone ?
        "No point was seen by two cameras at a time." : unread[i]);
  }
}

/* Fills where the gap of the first take lies, once it is measured. */
void
cloth_diagnosis_locate (ClothDiagnosis * d)
{
  const ClothRecording *r = cloth_diagnosis_recording (d, 0);
  const Compared c = { d->before, d->after, d->floor,
    cloth_recording_longest_side (r)
  };

  fill_stages (d, r);
  if (!c.before)
    return;
  fill_frequencies (&c, d->result);
  fill_waves (&c, d->result);
  fill_spectrum (&c, &d->result->spectrum);
}
