/* How well explanations foretell what happens next: an explanation with which the simulation moves away
 * from the cloth is none, however well it follows the residual of a simulation that is drawn to it.
 *
 * Model: let go in short windows, the simulation with an explanation comes to be off the cloth by a field
 *   whose mean square in window w is V_w + V₀. It has n = 3 numbers: those of cloth that moves as a whole.
 *   V₀ is the floor, what it is off by if nothing is lacking. How large the field is nobody knows
 *   before, and what has grown by chance in one window says nothing of another, so that the size of each
 *   is integrated out:
 *     log p = Σ −n/2 log ((V_w + V₀)/V₀) + constant.
 *   An explanation of several effects has no more of it than the best of its parts has.
 *   V₀ is the gap of the baseline that the model was fitted on; of a twin, whose share in it cancels, that
 *   of the noise; with neither what the two force models differ by.
 *   The held vertices are seen where the explanation has the clamps, but for the noise and what they are
 *   off by on the reference: the same with these for V and V₀. So a fault of the clock or of the scale
 *   has to be seen on them, too.
 * Reference: Dawid, Statistical theory: the prequential approach, 1984.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/inference/prediction.h"

#include <math.h>
#include <string.h>

#include "gst/gap/inference/clamps.h"

/* So many explanations are let go. */
#define N_PREDICTED 24
/* Of cloth that moves as a whole. */
#define N_NUMBERS 3.

/* @squares: (array length=n): mean square gap of each window, m²; NaN where nothing was seen
 * @n: how many windows
 * @floor: what it would be if nothing were lacking, m²
 *
 * Returns: the logarithm of their likelihood, but for a constant
 */
gdouble
cloth_gap_find_prediction_evidence (const gdouble * squares, guint n,
    gdouble floor)
{
  gdouble sum = 0.;

  for (guint w = 0; w < n; w++)
    if (!isnan (squares[w]))
      sum -= 0.5 * N_NUMBERS * log1p (squares[w] / floor);
  return sum;
}

/* Mean square distance of two simulations, m². */
static gdouble
find_distance (const ClothWindowedGap * a, const ClothWindowedGap * b)
{
  const gsize all = 3 * (gsize) a->n * a->n_frames;
  gdouble sum = 0.;

  for (gsize i = 3 * (gsize) a->n; i < all; i++)
    sum += pow ((gdouble) a->positions[i] - b->positions[i], 2.);
  return 3. * sum / MAX (all - 3 * (gsize) a->n, 1);
}

/* What a take would be off by if nothing were lacking, m². */
static gboolean
find_floor (ClothDiagnosis * d, const ClothRecording * r, gdouble * floor,
    GError ** error)
{
  const guint n_baselines = d->options->n_baselines;
  ClothWindowedGap **gaps;

  *floor = 0.;
  for (guint i = d->n_takes; i < d->n_takes + n_baselines; i++) {
    const ClothModel *models[] = { d->model };

    gaps = cloth_diagnosis_measure_windows (d, cloth_diagnosis_recording (d,
            i), models, 1, error);
    if (!gaps)
      return FALSE;
    *floor += cloth_windowed_gap_square (gaps[0], NULL) / n_baselines;
    cloth_windowed_gaps_free (gaps, 1);
  }
  if (!n_baselines) {
    g_autoptr (ClothModel) other = cloth_diagnosis_other_model (d->model);
    const ClothModel *models[] = { d->model, other };

    gaps = cloth_diagnosis_measure_windows (d, r, models, 2, error);
    if (!gaps)
      return FALSE;
    *floor = find_distance (gaps[0], gaps[1]);
    cloth_windowed_gaps_free (gaps, 2);
  }
  return TRUE;
}

/* Mean square by which held vertices are seen off the simulated clamps, in each window, m²; NaN where
 * none is seen. */
static void
find_clamps_off (const ClothWindowedGap * gap, const ClothRecording * r,
    gdouble * squares)
{
  const guint n_held = r->scene->held->len;
  g_autofree gdouble *counts = g_new0 (gdouble, gap->n_windows);

  memset (squares, 0, gap->n_windows * sizeof *squares);
  for (gsize k = n_held; k < (gsize) r->n_frames * n_held; k++) {
    const ClothHeld *held = &g_array_index (r->scene->held, ClothHeld,
        k % n_held);
    const guint window = gap->window[k / n_held];
    const gdouble square = gap->squares[k / n_held * gap->n + held->vertex];

    if (isnan (square) || !cloth_gap_is_surely_held (r, held, k / n_held))
      continue;
    squares[window] += square;
    counts[window]++;
  }
  for (guint w = 0; w < gap->n_windows; w++)
    squares[w] = counts[w] > 0. ? squares[w] / counts[w] : NAN;
}

/* Adds what a take says. */
static gboolean
add_take (ClothDiagnosis * d, guint t, GPtrArray * models, gdouble * evidence,
    GError ** error)
{
  const ClothRecording *r = cloth_diagnosis_recording (d, t);
  const ClothRecording *twin = cloth_diagnosis_twin (d, t);
  const ClothModel *const *all = (const ClothModel * const *) models->pdata;
  const gdouble noise = cloth_recording_noise_square (r);
  ClothWindowedGap **own = NULL, **gaps;
  g_autofree gdouble *squares = NULL;
  g_autofree gboolean *one = NULL;
  gdouble floor = 0., usual = 0.;

  for (guint i = d->n_takes; i < d->studies->len; i++)
    usual = fmax (usual, 3. * cloth_gap_find_clamps_off
        (cloth_diagnosis_study (d, i)->recording, NULL));
  if (!twin && !find_floor (d, r, &floor, error))
    return FALSE;
  /* what diverges has no floor */
  if (!isfinite (floor))
    floor = 0.;
  if (twin) {
    const ClothModel *base[] = { d->model };

    own = cloth_diagnosis_measure_windows (d, twin, base, 1, error);
    if (!own)
      return FALSE;
  }
  gaps = cloth_diagnosis_measure_windows (d, r, all, models->len, error);
  if (!gaps) {
    cloth_windowed_gaps_free (own, twin != NULL);
    return FALSE;
  }
  squares = g_new (gdouble, gaps[0]->n_windows);
  one = g_new0 (gboolean, gaps[0]->n_windows);
  for (guint k = 0; k < models->len; k++) {
    g_autoptr (ClothRecording) corrected = cloth_diagnosis_correct (r, all[k]);

    if (twin)
      cloth_windowed_gap_replace (gaps[k], corrected ? corrected : r, own[0],
          twin);
    find_clamps_off (gaps[k], corrected ? corrected : r, squares);
    evidence[k] += cloth_gap_find_prediction_evidence (squares,
        gaps[k]->n_windows, usual + noise);
    for (guint w = 0; w < gaps[k]->n_windows; w++) {
      one[w] = TRUE;
      squares[w] = cloth_windowed_gap_square (gaps[k], one);
      one[w] = FALSE;
    }
    evidence[k] += gaps[k]->sound ? cloth_gap_find_prediction_evidence (squares,
        gaps[k]->n_windows, floor + noise) : -INFINITY;
  }
  cloth_windowed_gaps_free (gaps, models->len);
  cloth_windowed_gaps_free (own, twin != NULL);
  return TRUE;
}

static gint
compare_behind (gconstpointer a, gconstpointer b)
{
  const ClothGapHypothesis *x = a, *y = b;

  return x->behind < y->behind ? -1 : x->behind > y->behind;
}

static gint
compare_by_residual (gconstpointer a, gconstpointer b)
{
  const ClothGapHypothesis *x = a, *y = b;

  return x->by_residual < y->by_residual ? -1 : x->by_residual > y->by_residual;
}

/* Whether one explanation is a part of another, or this one itself. */
static gboolean
is_part (const ClothGapHypothesis * part, const ClothGapHypothesis * h)
{
  for (guint c = 0; c < part->n; c++)
    if (!cloth_gap_hypothesis_has (h, part->candidates[c]))
      return FALSE;
  return TRUE;
}

/* What prediction says for each of @n explanations. Of several effects it says no more than for the best of
 * their parts: that the whole predicts better is no merit, as of many some do by chance. Gusts, which can't
 * be repeated, predict as the part without them, and alone as well as the best. */
static void
bound_by_parts (const GArray * hypotheses, guint n, gdouble * evidence)
{
  gdouble most = -INFINITY;

  for (guint size = 2; size <= CLOTH_GAP_MAX_EFFECTS; size++)
    for (guint i = 0; i < n; i++) {
      const ClothGapHypothesis *h = &g_array_index (hypotheses,
          ClothGapHypothesis, i);
      gdouble best = -INFINITY;
      gboolean has_part = FALSE;

      if (h->n != size || h->n_winds)
        continue;
      for (guint k = 0; k < n; k++) {
        const ClothGapHypothesis *other = &g_array_index (hypotheses,
            ClothGapHypothesis, k);

        if (!other->n || other->n >= h->n || other->n_winds
            || !is_part (other, h))
          continue;
        best = fmax (best, evidence[k]);
        has_part = TRUE;
      }
      if (has_part)
        evidence[i] = fmin (evidence[i], best);
    }
  for (guint i = 0; i < n; i++)
    if (!g_array_index (hypotheses, ClothGapHypothesis, i).n_winds)
      most = fmax (most, evidence[i]);
  for (guint i = 0; i < n; i++) {
    const ClothGapHypothesis *h = &g_array_index (hypotheses,
        ClothGapHypothesis, i);

    if (!h->n_winds)
      continue;
    evidence[i] = most;
    for (guint k = 0; k < n && h->n > 1; k++) {
      const ClothGapHypothesis *other = &g_array_index (hypotheses,
          ClothGapHypothesis, k);

      if (!other->n_winds && other->n + 1 == h->n && is_part (other, h))
        evidence[i] = evidence[k];
    }
  }
}

/* @d: a diagnosis
 * @hypotheses: (inout) (element-type ClothGapHypothesis): all that were compared; then the likeliest
 *   first
 * @error: #ClothSimError, or #ClothFitError when it was stopped
 *
 * Takes into account how well the likeliest predict. Those that are not looked at predict no
 * better than any that is.
 *
 * Returns: whether they could be simulated
 */
gboolean
cloth_gap_hypotheses_predict (ClothDiagnosis * d, GArray * hypotheses,
    GError ** error)
{
  const guint n = MIN (hypotheses->len, N_PREDICTED);
  g_autoptr (GPtrArray) models =
      g_ptr_array_new_with_free_func ((GDestroyNotify) cloth_model_free);
  g_autofree gdouble *evidence = g_new0 (gdouble, n + 1);
  gdouble best = INFINITY, least = INFINITY;

  g_array_sort (hypotheses, compare_by_residual);
  for (guint i = 0; i < n; i++)
    g_ptr_array_add (models, cloth_gap_hypothesis_make_model (d,
            &g_array_index (hypotheses, ClothGapHypothesis, i)));
  for (guint t = 0; t < d->n_takes; t++)
    if (!add_take (d, t, models, evidence, error))
      return FALSE;
  bound_by_parts (hypotheses, n, evidence);
  for (guint i = 0; i < n; i++)
    if (isfinite (evidence[i]))
      least = MIN (least, evidence[i]);
  if (!isfinite (least))
    least = 0.;
  for (guint i = 0; i < hypotheses->len; i++) {
    ClothGapHypothesis *h = &g_array_index (hypotheses, ClothGapHypothesis,
        i);

    h->behind = h->by_residual - (i < n ? evidence[i] : least);
    best = MIN (best, h->behind);
  }
  for (guint i = 0; i < hypotheses->len; i++)
    g_array_index (hypotheses, ClothGapHypothesis, i).behind -= best;
  g_array_sort (hypotheses, compare_behind);
  return TRUE;
}
