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

#include <float.h>
#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/math/statistics.h"

/* Median of |x| of a normal variable over its standard deviation. */
#define MEDIAN_OF_NORMAL 0.6745
/* Variance of a fourth difference of white noise of variance 1. */
#define FOURTH_DIFFERENCE 70.
/* Order of the polynomial through the frames of a path without noise. */
#define EXACT (CLOTH_RECORDING_WINDOW - 1)

/* @times: (array): of %CLOTH_RECORDING_WINDOW frames, s
 * @mask: which of them count, the first in the lowest bit
 * @at: a time, s
 * @order: of the polynomial, below %CLOTH_RECORDING_WINDOW
 * @weights: (out) (array): of each frame, 1/s; 0 of those that don't count
 *
 * Weights whose sum with the frames' values is the derivative at @at of the polynomial
 * that fits them. One frame alone has none: NaN.
 */
void
cloth_recording_find_weights (const gdouble * times, guint mask, gdouble at,
    guint order, gdouble * weights)
{
  const guint all = CLOTH_RECORDING_WINDOW;
  gdouble normal[(EXACT + 1) * (EXACT + 1)];
  gdouble powers[CLOTH_RECORDING_WINDOW][EXACT + 1];
  gdouble slope[EXACT + 1] = { 0., 1. }, scale = 0.;
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

static void
differentiate (const ClothRecording * r, const gdouble * path, guint order,
    gdouble * velocity)
{
  const gsize row = 3 * (gsize) r->n;

  for (guint frame = 0; frame < r->n_frames; frame++) {
    gint begin = (gint) frame - CLOTH_RECORDING_WINDOW / 2;
    gdouble weights[CLOTH_RECORDING_WINDOW];
    gdouble *to = velocity + frame * row;

    begin = CLAMP (begin, 0, (gint) r->n_frames - CLOTH_RECORDING_WINDOW);
    cloth_recording_find_weights (r->times + begin,
        (1u << CLOTH_RECORDING_WINDOW) - 1, r->times[frame], order, weights);
    memset (to, 0, row * sizeof *to);
    for (guint i = 0; i < CLOTH_RECORDING_WINDOW; i++) {
      const gdouble *from = path + ((guint) begin + i) * row;

      for (gsize k = 0; k < row; k++)
        to[k] += weights[i] * from[k];
    }
  }
}

/* @recording: a recording with positions
 *
 * Fills its velocities.
 */
void
cloth_recording_differentiate (ClothRecording * recording)
{
  differentiate (recording, recording->y, CLOTH_RECORDING_ORDER,
      recording->velocity);
}

/* Adds @sign times @path, moved so that straight lines from frame to frame have the mean of the curve whose
 * slopes are given: x − x″ Δt²/12. */
static void
add_straightened (const ClothRecording * r, const gdouble * path,
    const gdouble * slopes, gdouble sign, gdouble * to)
{
  const gsize row = 3 * (gsize) r->n;

  for (guint f = 0; f < r->n_frames; f++) {
    const guint before = f ? f - 1 : f, after = MIN (f + 1, r->n_frames - 1);
    const gdouble share = (r->times[after] - r->times[before]) /
        ((after - before) * (after - before) * 12.);

    for (gsize i = 0; i < row; i++)
      to[f * row + i] += sign * (path[f * row + i] - share *
          (slopes[after * row + i] - slopes[before * row + i]));
  }
}

/* @recording: (inout): a recording with positions
 * @drawn: (nullable): where the model at hand was in each frame when it was drawn to the recording,
 *   [n_frames][n][3], m
 *
 * Fills what draws a simulation, @targets and @velocity. Targets lie so that their straight lines from
 * frame to frame have the mean of the curved paths. Else a cloth that follows bends lags inwards, which
 * looks like a force.
 *
 * A polynomial that smooths noise away makes fast motions slower, too, and the springs then hold the cloth
 * back. By how much is known of @drawn, a path without noise that moves alike: T (y) + T₁ (x) − T (x), where T is
 * what smoothing makes of a path and T₁ what it should be, by polynomials through all frames.
 */
void
cloth_recording_straighten (ClothRecording * recording, const gdouble * drawn)
{
  ClothRecording *r = recording;
  const gsize all = 3 * (gsize) r->n * r->n_frames;

  cloth_recording_differentiate (r);
  g_free (r->targets);
  r->targets = g_new0 (gdouble, all);
  add_straightened (r, r->y, r->velocity, 1., r->targets);
  if (drawn) {
    g_autofree gdouble *smooth = g_new (gdouble, all);
    g_autofree gdouble *exact = g_new (gdouble, all);
    g_autofree gdouble *bent = g_new (gdouble, all);

    differentiate (r, drawn, CLOTH_RECORDING_ORDER, smooth);
    differentiate (r, drawn, EXACT, exact);
    differentiate (r, exact, EXACT, bent);
    add_straightened (r, drawn, smooth, -1., r->targets);
    add_straightened (r, drawn, exact, 1., r->targets);
    for (gsize i = 0; i < all; i++)
      r->velocity[i] -= smooth[i];
    add_straightened (r, exact, bent, 1., r->velocity);
  }
}

/* @recording: a recording; what was not seen is left out
 *
 * Estimates white noise from the fourth differences in time of what was seen five times
 * running, by their median; at least what places are rounded by, which cloth at rest doesn't show.
 *
 * Returns: standard deviation of a coordinate, m; NaN: nothing was seen so often
 */
gdouble
cloth_recording_estimate_sigma (const ClothRecording * recording)
{
  const ClothRecording *r = recording;
  g_autoptr (GArray) all = g_array_new (FALSE, FALSE, sizeof (gdouble));
  gdouble farthest = 0.;

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
        farthest = fmax (farthest, fabs (y[0][k]));
      }
    }
  if (!all->len)
    return NAN;
  return fmax (cloth_median ((gdouble *) all->data, all->len) /
      MEDIAN_OF_NORMAL / sqrt (FOURTH_DIFFERENCE),
      FLT_EPSILON * farthest / sqrt (12.));
}
