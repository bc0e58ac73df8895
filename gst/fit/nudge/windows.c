/* How large the gap is, and where, with the sampling error of its mean square.
 *
 * Model: the gap of a window is recorded minus simulated, freely from the nudged state at its
 *   start. The recording is one draw of windows and of places on the cloth.
 * Assumption: windows × tiles of the cloth are independent; within one, distances need not be.
 * Formula: mean square = Σ |x − y|² / number of seen vertices and frames. Its distribution is that
 *   of sums over as many windows × tiles, drawn with replacement.
 * Reference: Efron and Tibshirani, An Introduction to the Bootstrap, 1993, section 8.6 (blocks).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/nudge/windows.h"

#include <math.h>
#include <string.h>

#include "gst/math/random.h"
#include "gst/math/vec3.h"

/* The cloth in tiles of this many along u and v, for the bootstrap. */
#define TILES 3

typedef struct
{
  const ClothRecording *recording;
  ClothWindowedGap **gaps;
  guint n;
} Gather;

/* Unit vectors along warp, weft and normal at a vertex of a grid, from what was seen. */
static gboolean
find_axes (const ClothRecording * r, guint frame, guint vertex,
    gdouble axes[3][3])
{
  const ClothTopology *t = r->scene->topology;
  guint column, row, steps[2][2];

  if (!t->columns)
    return FALSE;
  column = vertex % t->columns;
  row = vertex / t->columns;
  steps[0][0] = column ? vertex - 1 : vertex;
  steps[0][1] = column + 1 < t->columns ? vertex + 1 : vertex;
  steps[1][0] = row ? vertex - t->columns : vertex;
  steps[1][1] = row + 1 < t->rows ? vertex + t->columns : vertex;
  for (guint a = 0; a < 2; a++) {
    const gdouble *y = r->y + 3 * (gsize) frame * r->n;

    cloth_vec3_subtract (y + 3 * steps[a][1], y + 3 * steps[a][0], axes[a]);
    if (!(cloth_vec3_normalise (axes[a]) > 0.))
      return FALSE;
  }
  cloth_vec3_cross (axes[0], axes[1], axes[2]);
  return cloth_vec3_normalise (axes[2]) > 0.;
}

/* Single numbers are enough: it is a difference. */
static void
keep_nudged (const ClothRecording * r, guint frame, const gdouble * positions,
    gfloat * nudged)
{
  gsize begin = (gsize) frame * r->n;

  for (gsize i = 0; i < 3 * (gsize) r->n; i++)
    if (r->seen[begin + i / 3] > 0.)
      nudged[3 * begin + i] = (gfloat) (positions[i] - r->y[3 * begin + i]);
}

/* Also where the simulation is. @again: in place of others; what did not count doesn't now. */
static void
add_distances (ClothWindowedGap * e, const ClothRecording * r, guint frame,
    const gdouble * positions, gboolean again)
{
  for (guint v = 0; v < r->n; v++) {
    gsize at = (gsize) frame * r->n + v;
    const gboolean counts = r->seen[at] > 0. && !(again
        && isnan (e->squares[at]));
    gdouble axes[3][3], d[3];

    for (guint k = 0; k < 3; k++) {
      e->positions[3 * at + k] = (gfloat) positions[3 * v + k];
      d[k] = positions[3 * v + k] - r->y[3 * at + k];
    }
    cloth_recording_cut_blind (r, at, d);
    e->squares[at] = counts ? d[0] * d[0] + d[1] * d[1] + d[2] * d[2] : NAN;
    if (counts && find_axes (r, frame, v, axes))
      for (guint a = 0; a < 3; a++) {
        gdouble along = d[0] * axes[a][0] + d[1] * axes[a][1] +
            d[2] * axes[a][2];

        e->directions[a] += along * along;
      }
  }
}

static void
add_frame (gpointer data, guint model, guint frame, const gdouble * positions)
{
  Gather *g = data;
  const ClothRecording *r = g->recording;
  ClothWindowedGap *e = g->gaps[model % g->n];

  if (model >= g->n) {
    cloth_energy_spectrum_add (e->energy, frame, positions);
    keep_nudged (r, frame, positions, e->nudged);
    return;
  }
  add_distances (e, r, frame, positions, FALSE);
}

/* Tiles of the flat cloth, of its extents along u and v. */
static guint *
list_tiles (const ClothTopology * t)
{
  guint *tiles = g_new0 (guint, t->n_vertices);

  for (guint k = 0; k < 2; k++) {
    gfloat low = INFINITY, high = -INFINITY;

    for (guint v = 0; v < t->n_vertices; v++) {
      low = MIN (low, t->uv[2 * v + k]);
      high = MAX (high, t->uv[2 * v + k]);
    }
    for (guint v = 0; v < t->n_vertices && high > low; v++)
      tiles[v] += (k ? TILES : 1) * MIN ((guint) (TILES * (t->uv[2 * v + k] -
                  low) / (high - low)), TILES - 1);
  }
  return tiles;
}

static ClothWindowedGap *
gap_new (const ClothRecording * r, gdouble window_s)
{
  ClothWindowedGap *e = g_new0 (ClothWindowedGap, 1);
  gsize all = (gsize) r->n * r->n_frames;

  e->n = r->n;
  e->n_frames = r->n_frames;
  e->squares = g_new (gdouble, all);
  e->positions = g_new (gfloat, 3 * all);
  for (gsize i = 0; i < all; i++)
    e->squares[i] = NAN;
  for (gsize i = 0; i < 3 * all; i++)
    e->positions[i] = (gfloat) r->y[i];
  e->window = cloth_rollout_list_windows (r, window_s);
  e->n_windows = e->window[r->n_frames - 1] + 1;
  e->tile = list_tiles (r->scene->topology);
  return e;
}

/* @recording: what is compared with
 * @models: (array length=n_models): the models
 * @n_models: how many
 * @gain: of the observer that leads up to each window, 1/s²
 * @window_s: length of the windows, s
 * @options: how to simulate
 * @error: #ClothSimError
 *
 * Returns: (transfer full) (nullable) (array length=n_models): each model's distances
 */
ClothWindowedGap **
cloth_windowed_gaps_new (const ClothRecording * recording,
    const ClothModel * const *models, guint n_models, gdouble gain,
    gdouble window_s, const ClothRolloutOptions * options, GError ** error)
{
  ClothWindowedGap **gaps = g_new (ClothWindowedGap *, n_models);
  g_autofree gboolean *sound = g_new (gboolean, n_models);
  g_autofree const ClothRecording **targets = g_new (const ClothRecording *,
      n_models);
  Gather g = { recording, gaps, n_models };

  for (guint m = 0; m < n_models; m++) {
    targets[m] = recording;
    gaps[m] = gap_new (recording, window_s);
    gaps[m]->nudged = g_new0 (gfloat, 3 * (gsize) recording->n *
        recording->n_frames);
    gaps[m]->energy = cloth_energy_spectrum_new (recording);
  }
  if (!cloth_rollout_windows (targets, models, n_models, gain, window_s,
          options, add_frame, &g, sound, error)) {
    cloth_windowed_gaps_free (gaps, n_models);
    return NULL;
  }
  for (guint m = 0; m < n_models; m++)
    gaps[m]->sound = sound[m];
  return gaps;
}

/* @recording: what is compared with
 * @models: (array length=n_models): the models
 * @n_models: how many
 * @gain: of the observer that leads up to the run, 1/s²
 * @lead_s: how long it does, s; these frames don't count. 0: the run begins as the recording does
 * @window_s: length of the windows that the frames are told by, s; nothing starts anew there
 * @options: how to simulate
 * @error: #ClothSimError
 *
 * Lets the models run freely to the end.
 *
 * Returns: (transfer full) (nullable) (array length=n_models): each model's distances
 */
ClothWindowedGap **
cloth_windowed_gaps_new_free (const ClothRecording * recording,
    const ClothModel * const *models, guint n_models, gdouble gain,
    gdouble lead_s, gdouble window_s, const ClothRolloutOptions * options,
    GError ** error)
{
  ClothWindowedGap **gaps = g_new (ClothWindowedGap *, n_models);
  const gsize begin = (gsize) cloth_rollout_count_led (recording, lead_s) *
      recording->n;
  g_autofree gboolean *sound = g_new (gboolean, n_models);
  g_autofree gdouble *gains = g_new (gdouble, n_models);
  Gather g = { recording, gaps, n_models };

  for (guint m = 0; m < n_models; m++) {
    gains[m] = gain;
    gaps[m] = gap_new (recording, window_s);
  }
  if (!cloth_rollout_led (recording, models, gains, n_models, lead_s, options,
          add_frame, &g, sound, error)) {
    cloth_windowed_gaps_free (gaps, n_models);
    return NULL;
  }
  for (guint m = 0; m < n_models; m++) {
    gaps[m]->sound = sound[m];
    for (gsize i = 0; i < begin; i++)
      gaps[m]->squares[i] = NAN;
  }
  return gaps;
}

/* @gap: (nullable) (transfer full): distances
 */
void
cloth_windowed_gap_free (ClothWindowedGap * gap)
{
  if (!gap)
    return;
  g_free (gap->window);
  g_free (gap->tile);
  g_free (gap->squares);
  g_free (gap->positions);
  g_free (gap->nudged);
  cloth_energy_spectrum_free (gap->energy);
  g_free (gap);
}

/* @gaps: (nullable) (transfer full) (array length=n): distances
 * @n: how many
 */
void
cloth_windowed_gaps_free (ClothWindowedGap ** gaps, guint n)
{
  for (guint m = 0; gaps && m < n; m++)
    cloth_windowed_gap_free (gaps[m]);
  g_free (gaps);
}

/* @gap: (inout): one model's distances from a recording
 * @other: another's
 * @recording: the recording
 *
 * Makes them the distances of the two models, with the recording's noise: what the gap
 * would be if the other were reality. What did not count doesn't now.
 */
void
cloth_windowed_gap_subtract (ClothWindowedGap * gap,
    const ClothWindowedGap * other, const ClothRecording * recording)
{
  const gdouble noise = cloth_recording_noise_square (recording);
  gsize all = (gsize) gap->n * gap->n_frames;

  for (gsize i = 0; i < all; i++) {
    gdouble off[3];

    for (guint k = 0; k < 3; k++) {
      off[k] = gap->positions[3 * i + k] - other->positions[3 * i + k];
      gap->nudged[3 * i + k] -= other->nudged[3 * i + k];
    }
    cloth_recording_cut_blind (recording, i, off);
    if (!isnan (gap->squares[i]))
      gap->squares[i] = noise + off[0] * off[0] + off[1] * off[1] +
          off[2] * off[2];
  }
}

/* @gap: (inout): one model's distances from a recording
 * @recording: the recording
 * @own: our model's distances from @twin; may be @gap
 * @twin: what another simulator made of the recorded scene
 *
 * Makes them the distances of the other simulator with what @gap has more than @own:
 * x = twin + (x_gap − x_own), vertex by vertex, so that what our simulator can't do cancels. What
 * did not count doesn't now.
 */
void
cloth_windowed_gap_replace (ClothWindowedGap * gap,
    const ClothRecording * recording, const ClothWindowedGap * own,
    const ClothRecording * twin)
{
  const gsize row = 3 * (gsize) gap->n;
  g_autofree gdouble *positions = g_new (gdouble, row);
  const gboolean sound = gap->sound && own->sound;

  memset (gap->directions, 0, sizeof gap->directions);
  for (guint frame = 0; frame < gap->n_frames; frame++) {
    const gsize begin = frame * row;

    for (gsize i = 0; i < row; i++)
      positions[i] = twin->y[begin + i] + gap->positions[begin + i] -
          own->positions[begin + i];
    add_distances (gap, recording, frame, positions, TRUE);
    for (gsize i = begin; gap->nudged && i < begin + row; i++)
      gap->nudged[i] -= own->nudged[i];
  }
  gap->sound = sound;
  if (gap->energy)
    cloth_energy_spectrum_subtract (gap->energy, own->energy, gap->nudged);
}

/* @gaps: (inout) (array length=n): distances of one recording
 * @n: how many
 *
 * What does not count in one of them counts in none: models that say what was wrong with the recording are
 * held against what is known without that, which is less.
 */
void
cloth_windowed_gaps_align (ClothWindowedGap ** gaps, guint n)
{
  for (gsize i = 0; i < (gsize) gaps[0]->n * gaps[0]->n_frames; i++) {
    gdouble sum = 0.;

    for (guint m = 0; m < n; m++)
      sum += gaps[m]->squares[i];
    for (guint m = 0; m < n && isnan (sum); m++)
      gaps[m]->squares[i] = NAN;
  }
}

/* @gap: distances
 * @windows: (nullable): which windows count
 *
 * Returns: their mean square, m²; NaN when nothing was seen
 */
gdouble
cloth_windowed_gap_square (const ClothWindowedGap * gap,
    const gboolean * windows)
{
  gdouble sum = 0.;
  guint64 count = 0;

  for (guint frame = 1; frame < gap->n_frames; frame++) {
    if (windows && !windows[gap->window[frame]])
      continue;
    for (guint v = 0; v < gap->n; v++) {
      gdouble square = gap->squares[(gsize) frame * gap->n + v];

      if (isfinite (square)) {
        sum += square;
        count++;
      }
    }
  }
  return count ? sum / count : NAN;
}

/* @gaps: (array length=n): distances of the same recording, of which the same count
 * @n: how many
 * @windows: (nullable): which windows count
 * @seed: of the draws
 * @n_draws: how many
 * @draws: (out) (array): mean squares, [n_draws][n]
 *
 * Bootstrap over windows × tiles of the cloth, drawn alike for all.
 */
void
cloth_windowed_gaps_interval (ClothWindowedGap ** gaps, guint n,
    const gboolean * windows, guint64 seed, guint n_draws, gdouble * draws)
{
  guint n_windows = gaps[0]->n_windows, n_cells = 0;
  guint all = n_windows * TILES * TILES;
  g_autofree gdouble *sums = g_new0 (gdouble, (gsize) all * n);
  g_autofree gdouble *counts = g_new0 (gdouble, all);
  g_autofree guint *cells = g_new (guint, all);
  ClothRandom random;

  for (guint frame = 1; frame < gaps[0]->n_frames; frame++) {
    guint w = gaps[0]->window[frame];

    for (guint v = 0; v < gaps[0]->n; v++) {
      guint cell = w * TILES * TILES + gaps[0]->tile[v];
      gsize at = (gsize) frame * gaps[0]->n + v;

      if (!isfinite (gaps[0]->squares[at]))
        continue;
      counts[cell] += 1.;
      for (guint m = 0; m < n; m++)
        sums[(gsize) m * all + cell] += gaps[m]->squares[at];
    }
  }
  for (guint cell = 0; cell < all; cell++)
    if (counts[cell] > 0. && (!windows || windows[cell / (TILES * TILES)]))
      cells[n_cells++] = cell;
  cloth_random_init (&random, seed);
  for (guint d = 0; d < n_draws; d++) {
    gdouble count = 0.;

    for (guint m = 0; m < n; m++)
      draws[(gsize) d * n + m] = 0.;
    for (guint i = 0; i < n_cells; i++) {
      guint cell = cells[cloth_random_below (&random, n_cells)];

      count += counts[cell];
      for (guint m = 0; m < n; m++)
        draws[(gsize) d * n + m] += sums[(gsize) m * all + cell];
    }
    for (guint m = 0; m < n && count > 0.; m++)
      draws[(gsize) d * n + m] /= count;
  }
}
