/* A recording made ready for the diagnosis.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/fit/recording/recording.h"

#include <math.h>
#include <string.h>

#include "gst/fit/recording/interpolation.h"
#include "gst/fit/error.h"
#include "gst/fit/recording/outliers.h"
#include "gst/math/linalg.h"

/* Median of |x| of a normal variable over its standard deviation. */
#define MEDIAN_OF_NORMAL 0.6745
/* Variance of a fourth difference of white noise of variance 1. */
#define FOURTH_DIFFERENCE 70.
/* Noise puts two vertices no further apart than this many standard deviations of one
 * coordinate. */
#define FAR_APART 6.

static gdouble *
place (const ClothRecording * r, gdouble * of, guint frame, guint vertex)
{
  return of + 3 * ((gsize) frame * r->n + vertex);
}

/* @times: (array): of %CLOTH_RECORDING_WINDOW frames, s
 * @mask: which of them count, the first in the lowest bit
 * @at: a time, s
 * @weights: (out) (array): of each frame, 1/s; 0 of those that don't count
 *
 * Weights whose sum with the frames' values is the derivative at @at of the polynomial
 * that fits them (Savitzky and Golay 1964, for any times). One frame alone has none: NaN.
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

/* @a: a #gdouble
 * @b: another
 *
 * Returns: which is larger, for g_array_sort ()
 */
gint
cloth_recording_compare_numbers (gconstpointer a, gconstpointer b)
{
  gdouble x = *(const gdouble *) a, y = *(const gdouble *) b;

  return x < y ? -1 : x > y;
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
        y[i] = place (r, r->y, frame + i, v);
        seen *= r->seen[(gsize) (frame + i) * r->n + v];
      }
      for (guint k = 0; k < 3 && seen > 0.; k++) {
        gdouble d = fabs (y[0][k] - 4. * y[1][k] + 6. * y[2][k] -
            4. * y[3][k] + y[4][k]);

        g_array_append_val (all, d);
      }
    }
  if (!all->len)
    return NAN;
  g_array_sort (all, cloth_recording_compare_numbers);
  return g_array_index (all, gdouble, all->len / 2) / MEDIAN_OF_NORMAL /
      sqrt (FOURTH_DIFFERENCE);
}

static gboolean
load (ClothRecording * r, ClothTake * take, GError ** error)
{
  gsize row = 3 * (gsize) r->n;
  g_autofree gfloat *positions = g_new (gfloat, row);

  for (guint frame = 0; frame < r->n_frames; frame++) {
    if (!cloth_take_read_positions (take, frame, positions, error))
      return FALSE;
    r->times[frame] = cloth_take_get_time (take, frame);
    for (guint v = 0; v < r->n; v++) {
      const gfloat *p = positions + 3 * (gsize) v;
      gboolean seen = isfinite (p[0]) && isfinite (p[1]) && isfinite (p[2]);

      r->seen[(gsize) frame * r->n + v] = seen ? 1. : 0.;
      for (guint k = 0; k < 3; k++)
        place (r, r->y, frame, v)[k] = seen ? p[k] : 0.;
    }
  }
  return TRUE;
}

/* Into @row the places of a frame, and NaN where nothing was seen. */
static void
read_seen (ClothRecording * r, guint frame, gdouble * row)
{
  const gdouble *seen = r->seen + (gsize) frame * r->n;
  const gdouble *y = place (r, r->y, frame, 0);

  for (gsize i = 0; i < 3 * (gsize) r->n; i++)
    row[i] = seen[i / 3] > 0. ? y[i] : NAN;
}

/* What no cloth can be at was not seen there. Where there is more noise than was told, noise
 * is no tear: it is estimated when there seem to be any. */
static void
remove_torn (ClothRecording * r)
{
  g_autoptr (ClothOutliers) tears = cloth_outliers_new (r->scene->topology);
  g_autofree gdouble *row = g_new (gdouble, 3 * (gsize) r->n);
  gdouble sigma = r->sigma > 0. ? r->sigma : 0.;
  gboolean estimated = FALSE;

  for (guint frame = 0; frame < r->n_frames; frame++) {
    read_seen (r, frame, row);
    if (!cloth_outliers_remove (tears, FAR_APART * sigma, row))
      continue;
    if (!estimated) {
      sigma = fmax (sigma, cloth_recording_estimate_sigma (r));
      estimated = TRUE;
      read_seen (r, frame, row);
      cloth_outliers_remove (tears, FAR_APART * sigma, row);
    }
    for (guint v = 0; v < r->n; v++)
      r->seen[(gsize) frame * r->n + v] = isnan (row[3 * (gsize) v]) ? 0. : 1.;
  }
}

/* @recording: a recording
 *
 * Returns: the longer side of its flat cloth, m
 */
gdouble
cloth_recording_longest_side (const ClothRecording * recording)
{
  const ClothTopology *t = recording->scene->topology;
  gdouble longest = 0.;

  for (guint k = 0; k < 2; k++) {
    gdouble low = INFINITY, high = -INFINITY;

    for (gsize i = 0; i < t->n_vertices; i++) {
      low = MIN (low, t->uv[2 * i + k]);
      high = MAX (high, t->uv[2 * i + k]);
    }
    longest = MAX (longest, high - low);
  }
  return longest;
}

/* @take: a take
 * @error: #ClothFitError, or what reading it says
 *
 * Returns: (transfer full) (nullable): the recording
 */
ClothRecording *
cloth_recording_new (ClothTake * take, GError ** error)
{
  const ClothTakeInfo *info = cloth_take_get_info (take);
  g_autoptr (ClothRecording) r = g_new0 (ClothRecording, 1);
  gboolean told;
  gsize all;

  r->name = g_strdup (info->name);
  r->n = cloth_take_get_topology (take)->n_vertices;
  r->n_frames = cloth_take_get_n_frames (take);
  if (r->n_frames < CLOTH_RECORDING_WINDOW) {
    g_set_error (error, CLOTH_FIT_ERROR, CLOTH_FIT_ERROR_RECORDING, "%s has %u "
        "frames; a diagnosis needs motion, at least %u", r->name, r->n_frames,
        CLOTH_RECORDING_WINDOW);
    return NULL;
  }
  r->scene = cloth_scene_new_from_take (take, error);
  if (!r->scene)
    return NULL;
  all = (gsize) r->n_frames * r->n;
  r->times = g_new (gdouble, r->n_frames);
  r->y = g_new (gdouble, 3 * all);
  r->velocity = g_new (gdouble, 3 * all);
  r->seen = g_new (gdouble, all);
  if (!load (r, take, error))
    return NULL;
  r->sigma = info->noise_sigma_m;
  told = r->sigma > 0.;
  if (!told)
    r->sigma = cloth_recording_estimate_sigma (r);
  if (!cloth_recording_check (r, told, error))
    return NULL;
  remove_torn (r);
  cloth_recording_interpolate (r);
  cloth_recording_differentiate (r);
  return g_steal_pointer (&r);
}

/* @recording: (nullable) (transfer full): a recording
 */
void
cloth_recording_free (ClothRecording * recording)
{
  if (!recording)
    return;
  g_free (recording->name);
  cloth_scene_free (recording->scene);
  g_free (recording->times);
  g_free (recording->y);
  g_free (recording->velocity);
  g_free (recording->seen);
  g_free (recording);
}
