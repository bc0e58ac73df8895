/* Decides what the gap would be if the simulation lacked nothing: over time, and for each vertex
 * and frame.
 *
 * Model: the null is the gap of the model on the baseline, without one that of the other force model.
 * Its squared gap in a window is log-normal. Where the null moves as the take does, the expected
 * distance is that of the same vertex at about the same time, else its mean as long after the
 * beginning of a window. Noise is the least.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/localise/null-distribution.h"

#include <math.h>
#include <string.h>

#include "gst/gap/localise/localisation.h"

/* Frames to either side that a vertex's expected distance is averaged over. */
#define HALF_FRAMES 2
/* Of the bootstrap of a window's gap. */
#define N_DRAWS 200
/* So many times as much of the null is expected where no gap is found. */
#define DOUBT_ALIKE 3.3
#define DOUBT_OTHER 1.5
/* Normal quantile of a band of 95%. */
#define BAND 1.96

/* Frames since the beginning of each frame's window. */
static guint *
list_phases (const ClothWindowedGap * e)
{
  guint *phases = g_new0 (guint, e->n_frames);

  for (guint frame = 2; frame < e->n_frames; frame++)
    phases[frame] = e->window[frame] == e->window[frame - 1] ?
        phases[frame - 1] + 1 : 0;
  return phases;
}

/* Of the same motion: the null's own distance at about that time of that window; NaN once it has
 * ended. */
static gdouble
square_there (const ClothWindowedGap * null, guint frame, guint v)
{
  guint end = MIN (frame + HALF_FRAMES, null->n_frames - 1), n = 0;
  gdouble sum = 0.;

  if (frame >= null->n_frames)
    return NAN;
  for (guint i = MAX (frame, HALF_FRAMES) - HALF_FRAMES; i <= end; i++) {
    gdouble square = null->squares[(gsize) i * null->n + v];

    if (i && null->window[i] == null->window[frame] && isfinite (square)) {
      sum += square;
      n++;
    }
  }
  return n ? sum / n : NAN;
}

/* Of another motion: its mean as long after the beginning of a window, [phases][n]. */
static gdouble *
pool (const ClothWindowedGap * null, guint * n_phases)
{
  g_autofree guint *phases = list_phases (null), *counts = NULL;
  gdouble *squares;

  *n_phases = 1;
  for (guint frame = 0; frame < null->n_frames; frame++)
    *n_phases = MAX (*n_phases, phases[frame] + 1);
  squares = g_new0 (gdouble, (gsize) * n_phases * null->n);
  counts = g_new0 (guint, (gsize) * n_phases * null->n);
  for (guint frame = 1; frame < null->n_frames; frame++)
    for (guint v = 0; v < null->n; v++) {
      gdouble square = null->squares[(gsize) frame * null->n + v];
      gsize to = (gsize) phases[frame] * null->n + v;

      if (isfinite (square)) {
        squares[to] += square;
        counts[to]++;
      }
    }
  for (gsize i = 0; i < (gsize) * n_phases * null->n; i++)
    squares[i] = counts[i] ? squares[i] / counts[i] : NAN;
  return squares;
}

static void
fill_sigma (const ClothWindowedGap * null, gboolean same_motion,
    const ClothRecording * r, const guint * phases, ClothGapPlayback * p)
{
  guint n_phases;
  g_autofree gdouble *pooled = pool (null, &n_phases);
  gdouble noise = isfinite (r->sigma) ? cloth_recording_noise_square (r) : 0.;

  p->sigma = g_new (gfloat, (gsize) r->n_frames * r->n);
  for (guint frame = 0; frame < r->n_frames; frame++) {
    guint phase = MIN (phases[frame], n_phases - 1);

    for (guint v = 0; v < r->n; v++) {
      gdouble square = same_motion ? square_there (null, MAX (frame, 1), v) :
          NAN;

      if (isnan (square))
        square = pooled[(gsize) phase * r->n + v];
      p->sigma[(gsize) frame * r->n + v] = (gfloat) sqrt (MAX (square, noise));
    }
  }
}

/* Log-normal: from the gap of window @w of the null by chance of which parts of the cloth
 * are in it, twice, because the take's is by chance, too. */
static void
find_band_there (ClothWindowedGap * null, guint w, guint64 seed, gdouble * low,
    gdouble * high)
{
  g_autofree gboolean *one = g_new0 (gboolean, null->n_windows);
  g_autofree gdouble *draws = g_new (gdouble, N_DRAWS);
  gdouble centre, sum = 0.;

  one[w] = TRUE;
  centre = log (cloth_windowed_gap_square (null, one));
  cloth_windowed_gaps_interval (&null, 1, one, seed, N_DRAWS, draws);
  for (guint d = 0; d < N_DRAWS; d++)
    sum += pow (log (draws[d]) - centre, 2.);
  *low = exp (0.5 * (centre - BAND * sqrt (2. * sum / N_DRAWS)));
  *high = exp (0.5 * (centre + BAND * sqrt (2. * sum / N_DRAWS)));
}

/* Log-normal: what another window of the null would have. */
static void
find_band (ClothWindowedGap * null, guint64 seed, gdouble * low, gdouble * high)
{
  g_autofree gboolean *one = g_new0 (gboolean, null->n_windows);
  gdouble sum = 0., squares = 0., sigma;
  guint n = 0;

  if (null->n_windows < 3) {
    find_band_there (null, 0, seed, low, high);
    return;
  }
  for (guint w = 0; w < null->n_windows; w++) {
    gdouble centre;

    one[w] = TRUE;
    centre = log (cloth_windowed_gap_square (null, one));
    one[w] = FALSE;
    if (!isfinite (centre))
      continue;
    sum += centre;
    squares += centre * centre;
    n++;
  }
  sum /= n;
  sigma = sqrt (MAX (squares - n * sum * sum, 0.) / MAX (n - 1, 1) *
      (1. + 1. / n));
  *low = exp (0.5 * (sum - BAND * sigma));
  *high = exp (0.5 * (sum + BAND * sigma));
}

static void
fill_series (ClothWindowedGap * null, gboolean same_motion, guint64 seed,
    ClothGapSeries * s)
{
  gdouble low, high;

  s->null_low = g_new (gdouble, s->n);
  s->null_high = g_new (gdouble, s->n);
  find_band (null, seed, &low, &high);
  for (guint w = 0; w < s->n; w++) {
    if (same_motion && w < null->n_windows)
      find_band_there (null, w, seed, &low, &high);
    s->null_low[w] = low;
    s->null_high[w] = high;
  }
}

/* Where no gap is found only a residual that is larger than all of the null has a place:
 * at times variability brings back as much of it. */
static void
fill_region (const ClothDiagnosis * d)
{
  const ClothRecording *r = cloth_diagnosis_recording (d, 0);
  const ClothNudgedResidual take = { r, d->nudged };
  ClothNudgedResidual nulls[G_N_ELEMENTS (d->nulls)];
  g_autoptr (ClothLocalisation) region = NULL;
  ClothLocalisationOptions options;

  for (guint i = 0; i < d->n_nulls; i++)
    nulls[i] = (ClothNudgedResidual) {
    cloth_diagnosis_recording (d, d->null_recordings[i]), d->nulls[i]->nudged};
  cloth_localisation_options_init (&options);
  options.seed = d->options->seed;
  if (d->result->verdict == CLOTH_GAP_NO_GAP)
    options.doubt = d->null_alike ? DOUBT_ALIKE : DOUBT_OTHER;
  region = cloth_localisation_new (&take, nulls, d->n_nulls, d->null_alike,
      &options);
  d->result->region = g_array_ref (region->vertices);
  if (region->onset)
    d->result->onset_s = r->times[region->onset];
}

/* Fills what the null is known for, once the gap is measured and judged. */
void
cloth_diagnosis_fill_null_distribution (ClothDiagnosis * d)
{
  const ClothRecording *r = cloth_diagnosis_recording (d, 0);
  g_autofree guint *windows = NULL, *phases = NULL;
  ClothWindowedGap *null;
  gboolean same_motion;
  guint i;

  if (!d->n_nulls)
    return;
  i = MIN (d->floor_null, d->n_nulls - 1);
  null = d->nulls[i];
  same_motion = d->null_alike || d->null_recordings[i] == 0;
  windows = cloth_rollout_list_windows (r, CLOTH_DIAGNOSIS_WINDOW_S);
  phases = list_phases (&(ClothWindowedGap) {
      .n_frames = r->n_frames,.window = windows}
  );
  fill_sigma (null, same_motion, r, phases, &d->result->playback);
  fill_series (null, same_motion, d->options->seed, &d->result->series);
  if (d->nudged)
    fill_region (d);
}
