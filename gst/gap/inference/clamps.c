/* Whether what is held was where the clamps' log has it. A clamp that is seen is an observation: off
 * its logged path it leads the cloth elsewhere than the simulation's.
 *
 * Model: the held vertices' distances from their paths are N(0, v) on the take, and N(0, v₀) on the
 *   reference, where they are no more than noise and what simulators and clamps usually do.
 * Formula: with n distances, of which φ count as one,
 *   log BF = n/2φ (v/v₀ − 1 − log (v/v₀)) − ½ log (n/φ)  if v > v₀  (likelihood ratio; Schwarz 1978).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/inference/clamps.h"

#include <math.h>
#include <string.h>

#include "gst/fit/recording/recording.h"
#include "gst/math/vec3.h"

/* @square: mean square of the distances, by coordinate, m²
 * @usual: that of the reference, or of the noise if that is more, m²
 * @n: how many there are that are independent
 *
 * Returns: logarithm of the Bayes factor for clamps that were elsewhere than usual
 */
gdouble
cloth_gap_find_clamps_evidence (gdouble square, gdouble usual, gdouble n)
{
  const gdouble ratio = square / usual;

  if (!(ratio > 1.) || !(n > 1.))
    return -INFINITY;
  return 0.5 * n * (ratio - 1. - log (ratio)) - 0.5 * log (n);
}

/* @recording: a recording
 * @held: what is held in it
 * @frame: a frame
 *
 * Returns: whether it was held then: simulators and people let go a little earlier or later than the
 *   log has it
 */
gboolean
cloth_gap_is_surely_held (const ClothRecording * recording,
    const ClothHeld * held, gsize frame)
{
  const ClothRecording *r = recording;
  const gdouble margin = 1.5 * (r->times[r->n_frames - 1] - r->times[0]) /
      (r->n_frames - 1);

  return r->times[frame] >= held->from_s + margin
      && r->times[frame] <= held->until_s - margin;
}

/* Where clamp @i is so long after the recording's beginning, if it holds then and that is known. */
static gboolean
find_place (const ClothRecording * r, guint i, gdouble after_s,
    gdouble place[3])
{
  const ClothScene *scene = r->scene;
  const gdouble time = r->times[0] + after_s;
  const gint frame = cloth_recording_find_frame (r, time);
  const gdouble *path;
  gdouble share;

  if (frame < 0 || !cloth_held_holds (&g_array_index (scene->held, ClothHeld,
              i), time))
    return FALSE;
  path = scene->clamps + 3 * ((gsize) cloth_recording_find_between (r, time,
          (guint) frame, &share) * scene->held->len + i);
  for (guint k = 0; k < 3; k++)
    place[k] = share > 0. ? path[k] + share * (path[3 * scene->held->len + k] -
        path[k]) : path[k];
  return isfinite (place[0] + place[1] + place[2]);
}

/* @a: a recording
 * @b: another
 *
 * Returns: mean square of what their clamps move differently, from where they are at first, over the times at
 *   which both hold, m²; %G_MAXDOUBLE when no two ever do, but 0 when neither has any
 */
gdouble
cloth_gap_find_clamps_distance (const ClothRecording * a,
    const ClothRecording * b)
{
  const guint n = MIN (a->scene->held->len, b->scene->held->len);
  gdouble sum = 0., count = 0.;

  for (guint i = 0; i < n; i++) {
    gdouble first[3] = { 0. };
    gboolean began = FALSE;

    for (guint f = 0; f < a->n_frames; f++) {
      const gdouble after_s = a->times[f] - a->times[0];
      gdouble x[3], y[3];

      if (!find_place (a, i, after_s, x) || !find_place (b, i, after_s, y))
        continue;
      cloth_vec3_subtract (x, y, x);
      if (!began)
        memcpy (first, x, sizeof first);
      began = TRUE;
      cloth_vec3_subtract (x, first, x);
      sum += cloth_vec3_dot (x, x);
      count += 1.;
    }
  }
  return count > 0. ? sum / count :
      a->scene->held->len + b->scene->held->len ? G_MAXDOUBLE : 0.;
}

/* @recording: a recording
 * @n: (out) (optional): how many coordinates were seen
 *
 * Returns: mean square by which the held vertices are seen off their clamps' paths, by coordinate, m²
 */
gdouble
cloth_gap_find_clamps_off (const ClothRecording * recording, gdouble * n)
{
  const ClothRecording *r = recording;
  const guint n_held = r->scene->held->len;
  gdouble sum = 0., count = 0.;

  for (gsize k = 0; k < (gsize) r->n_frames * n_held; k++) {
    const ClothHeld *held = &g_array_index (r->scene->held, ClothHeld,
        k % n_held);
    const gsize at = k / n_held * r->n + held->vertex;

    /* a path that was found in the cloth is no log */
    if (r->seen[at] == 0. || cloth_scene_is_found (r->scene, k)
        || !cloth_gap_is_surely_held (r, held, k / n_held))
      continue;
    for (guint c = 0; c < 3; c++) {
      const gdouble off = r->y[3 * at + c] - r->scene->clamps[3 * k + c];

      sum += off * off;
    }
    count += 3.;
  }
  if (n)
    *n = count;
  return count > 0. ? sum / count : 0.;
}

/* @d: a diagnosis
 * @log_bayes_factor: (out): logarithm of the Bayes factor for clamps that were elsewhere than logged,
 *   of the take that shows it most
 *
 * Returns: (transfer full) (nullable): what is seen, a sentence; %NULL without a reference, or when
 *   nothing is held
 */
gchar *
cloth_diagnosis_find_clamps_off (const ClothDiagnosis * d,
    gdouble * log_bayes_factor)
{
  gdouble usual = 0., n;
  gchar *sentence = NULL;

  *log_bayes_factor = -INFINITY;
  for (guint i = d->n_takes; i < d->studies->len; i++)
    usual = fmax (usual, cloth_gap_find_clamps_off (cloth_diagnosis_study (d,
                i)->recording, &n));
  for (guint i = 0; i < d->n_takes && d->studies->len > d->n_takes; i++) {
    const ClothRecording *r = cloth_diagnosis_recording (d, i);
    const gdouble off = cloth_gap_find_clamps_off (r, &n);
    const gdouble least = fmax (usual, r->sigma * r->sigma);
    const gdouble evidence = cloth_gap_find_clamps_evidence (off, least,
        n / d->study.overdispersion);

    if (!(evidence > *log_bayes_factor))
      continue;
    *log_bayes_factor = evidence;
    g_free (sentence);
    sentence = g_strdup_printf ("The clamps of %s are seen %.1f mm off their "
        "logged paths, %s %.1f mm.", r->name, 1e3 * sqrt (3. * off),
        d->twins->len ? "in the simulation" : "on the baseline",
        1e3 * sqrt (3. * least));
  }
  return sentence;
}
