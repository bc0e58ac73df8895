/* Recordings as signals in time: their derivative and their noise.
 *
 * Model: a coordinate of a vertex is a smooth path plus white noise of one variance.
 * Assumption: within seven frames the path is nearly a polynomial of order 4; a fourth difference
 *   of five frames in a row has none of it.
 * Formula: the velocity is the derivative of the polynomial that fits the frames in least
 *   squares, a sum of the frames with weights that depend on their times only.
 *   σ = median |Δ⁴y| / 0.6745 / √70, as 1² + 4² + 6² + 4² + 1² = 70.
 * Reference: Savitzky and Golay, Analytical Chemistry 36, 1964; here for any times and with
 *   frames missing. The median makes the estimate robust (Hampel 1974).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/recording/signal.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/math/statistics.h"

/* Median of |x| of a normal variable over its standard deviation. */
#define MEDIAN_OF_NORMAL 0.6745
/* Variance of a fourth difference of white noise of variance 1. */
#define FOURTH_DIFFERENCE 70.
/* @times: (array): of %CLOTH_RECORDING_WINDOW frames, s
 * @mask: which of them count, the first in the lowest bit
 * @at: a time, s
 * @weights: (out) (array): of each frame, 1/s; 0 of those that don't count
 *
 * Weights whose sum with the frames' values is the derivative at @at of the polynomial
 * that fits them. One frame alone has none: NaN.
 */
void
cloth_recording_find_weights (const gdouble * times, guint mask, gdouble at,
    gdouble * weights)
{
  const guint all = CLOTH_RECORDING_WINDOW, order = CLOTH_RECORDING_ORDER;
  gdouble normal[(CLOTH_RECORDING_ORDER + 1) * (CLOTH_RECORDING_ORDER + 1)];
  gdouble powers[CLOTH_RECORDING_WINDOW][CLOTH_RECORDING_ORDER + 1];
  gdouble slope[CLOTH_RECORDING_ORDER + 1] = { 0., 1. }, scale = 0.;
  guint n = 0, terms;

  for (guint i = 0; i < all; i++) {
    weights[i] = 0.;
    if (!(mask >> i & 1))
      continue;
    n++;
    scale = MAX (scale, fabs (times[i] - at));
  }
  if (n < 2) {
    for (guint i = 0; i < all; i++)
      weights[i] = NAN;
    return;
  }
  /* a straight line through the first frames of a fall would be far off */
  terms = n == 2 ? 2 : MAX (3, n + order + 1 - all);
  memset (normal, 0, sizeof normal);
  for (guint i = 0; i < all; i++) {
    powers[i][0] = 1.;
    for (guint k = 1; k < terms; k++)
      powers[i][k] = powers[i][k - 1] * (times[i] - at) / scale;
    for (guint k = 0; mask >> i & 1 && k < terms; k++)
      for (guint l = 0; l < terms; l++)
        normal[k * terms + l] += powers[i][k] * powers[i][l];
  }
  if (!cloth_cholesky_factor (terms, normal))
    return;
  cloth_cholesky_solve (terms, normal, slope);
  for (guint i = 0; i < all; i++)
    for (guint k = 0; mask >> i & 1 && k < terms; k++)
      weights[i] += slope[k] * powers[i][k] / scale;
}

/* @recording: a recording with positions
 *
 * Fills its velocities.
 */
void
cloth_recording_differentiate (ClothRecording * recording)
{
  ClothRecording *r = recording;
  gsize row = 3 * (gsize) r->n;

  for (guint frame = 0; frame < r->n_frames; frame++) {
    gint begin = (gint) frame - CLOTH_RECORDING_WINDOW / 2;
    gdouble weights[CLOTH_RECORDING_WINDOW];
    gdouble *to = r->velocity + frame * row;

    begin = CLAMP (begin, 0, (gint) r->n_frames - CLOTH_RECORDING_WINDOW);
    cloth_recording_find_weights (r->times + begin,
        (1u << CLOTH_RECORDING_WINDOW) - 1, r->times[frame], weights);
    memset (to, 0, row * sizeof *to);
    for (guint i = 0; i < CLOTH_RECORDING_WINDOW; i++) {
      const gdouble *from = r->y + ((guint) begin + i) * row;

      for (gsize k = 0; k < row; k++)
        to[k] += weights[i] * from[k];
    }
  }
}

/* @recording: a recording with positions and velocities
 *
 * Fills what draws a simulation: places whose straight lines from frame to frame have the mean of the
 * curved paths, y − a Δt²/12. Else a cloth that follows bends lags inwards, which looks like a
 * force; it matters for the size of numbers that the springs nearly hide, as damping.
 */
void
cloth_recording_straighten (ClothRecording * recording)
{
  ClothRecording *r = recording;
  const gsize row = 3 * (gsize) r->n;

  g_free (r->targets);
  r->targets = g_memdup2 (r->y, r->n_frames * row * sizeof *r->y);
  for (guint f = 0; f < r->n_frames; f++) {
    const guint before = f ? f - 1 : f, after = MIN (f + 1, r->n_frames - 1);
    const gdouble share = (r->times[after] - r->times[before]) /
        ((after - before) * (after - before) * 12.);

    for (gsize i = 0; i < row; i++)
      r->targets[f * row + i] -= share * (r->velocity[after * row + i] -
          r->velocity[before * row + i]);
  }
}

/* @recording: a recording; what was not seen is left out
 *
 * Estimates white noise from the fourth differences in time of what was seen five times
 * running, by their median.
 *
 * Returns: standard deviation of a coordinate, m; NaN: nothing was seen so often
 */
gdouble
cloth_recording_estimate_sigma (const ClothRecording * recording)
{
  const ClothRecording *r = recording;
  g_autoptr (GArray) all = g_array_new (FALSE, FALSE, sizeof (gdouble));

  for (guint frame = 0; frame + 5 <= r->n_frames; frame++)
    for (guint v = 0; v < r->n; v++) {
      const gdouble *y[5];
      gdouble seen = 1.;

      for (guint i = 0; i < 5; i++) {
        y[i] = r->y + 3 * ((gsize) (frame + i) * r->n + v);
        seen *= r->seen[(gsize) (frame + i) * r->n + v];
      }
      for (guint k = 0; k < 3 && seen > 0.; k++) {
        gdouble d = fabs (y[0][k] - 4. * y[1][k] + 6. * y[2][k] -
            4. * y[3][k] + y[4][k]);

        g_array_append_val (all, d);
      }
    }
  return cloth_median ((gdouble *) all->data, all->len) / MEDIAN_OF_NORMAL /
      sqrt (FOURTH_DIFFERENCE);
}
