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
