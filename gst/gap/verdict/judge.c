/* Decides how large the gap is without and with the accepted effects, and the verdict.
 *
 * Model: the squared gap V is the mean over windows that judge, in which simulations run free.
 * Formulas:
 *   shrink = (V_before − V_after)/(V_before − V_floor)
 *   p-value of the rest = share of pairs of draws in which V_after is no larger than V_floor
 * Intervals are the middle 95% of a bootstrap over windows and tiles of the cloth, with the same
 * draws for all models (Davison and Hinkley 1997). An effect stays accepted when it takes a tenth
 * of V away; the rest is explained when it is below 2.25 floors in variance.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/verdict/judge.h"

#include <math.h>
#include <string.h>

#include "gst/fit/recording/recording.h"
#include "gst/gap/localise/where.h"
#include "gst/math/statistics.h"

/* Variance of a gap that is hardly larger, over that before. */
#define HARDLY_LARGER 1.05
/* What parts faults of cameras that look alike. */
static const gchar *const capture_sentence =
    "Film a board that moves with all cameras, once more with half the "
    "exposure time, and at rest: clocks, shutters and exposures show in motion "
    "only, lenses and places at rest too.";
/* A shrink is given when what is above the floor is this share of all, in variance. */
#define LEAST_ABOVE_SHARE 0.1
/* Of the bootstrap. */
#define N_DRAWS 1000

/* The windows that judge: those that end in a held-out block, or all. */
static gboolean *
judging_windows (const ClothDiagnosis * d, const ClothWindowedGap * gap)
{
  const ClothFeatures *f = cloth_diagnosis_study (d, 0)->features;
  gboolean *windows = g_new0 (gboolean, gap->n_windows);
  gboolean any = FALSE;

  for (guint frame = 1, block = 0; frame < gap->n_frames; frame++) {
    while (block + 1 < f->n_blocks && frame >= f->first[block + 1])
      block++;
    windows[gap->window[frame]] = cloth_diagnosis_is_held_out (d, block);
  }
  for (guint w = 0; w < gap->n_windows; w++)
    any |= windows[w];
  for (guint w = 0; w < gap->n_windows && !any; w++)
    windows[w] = TRUE;
  return windows;
}

/* The middle 95% of @n draws that are @stride apart. */
static ClothGapEstimate
find_interval (gdouble value, const gdouble * draws, guint n, guint stride)
{
  ClothGapEstimate e = { value };
  g_autoptr (GArray) sorted = g_array_new (FALSE, FALSE, sizeof (gdouble));

  for (guint i = 0; i < n; i++)
    g_array_append_val (sorted, draws[(gsize) i * stride]);
  g_array_sort (sorted, cloth_compare_doubles);
  e.low = g_array_index (sorted, gdouble, n / 40);
  e.high = g_array_index (sorted, gdouble, n - 1 - n / 40);
  return e;
}

/* A length from the draws of its square. */
static ClothGapEstimate
estimate (gdouble square, const gdouble * draws, guint n, guint stride)
{
  ClothGapEstimate e = find_interval (sqrt (square), draws, n, stride);

  e.low = sqrt (MAX (0., e.low));
  e.high = sqrt (MAX (0., e.high));
  return e;
}

/* Without a baseline the floor is what the two force models differ by, and the noise:
 * NaN on errors. */
static gdouble
own_floor (ClothDiagnosis * d, guint judge, const ClothWindowedGap * gap,
    ClothWindowedGap ** null, GError ** error)
{
  const ClothRecording *r = cloth_diagnosis_recording (d, judge);
  g_autoptr (ClothModel) other = cloth_diagnosis_other_model (d);
  const ClothModel *models[1] = { other };
  ClothWindowedGap **gaps;
  gdouble sum = 0.;
  gsize all = (gsize) r->n * r->n_frames, seen = 0;

  gaps = cloth_diagnosis_measure_windows (d, r, models, 1, error);
  if (!gaps)
    return NAN;
  for (gsize i = 0; i < 3 * all && gaps[0]->sound; i++) {
    gdouble off = gaps[0]->positions[i] - gap->positions[i];

    if (isnan (gap->squares[i / 3]))
      continue;
    sum += off * off;
    seen += i % 3 == 0;
  }
  if (gaps[0]->sound) {
    *null = gaps[0];
    cloth_windowed_gap_subtract (*null, gap, r);
    g_free (gaps);
  } else
    cloth_windowed_gaps_free (gaps, 1);
  return 3. * r->sigma * r->sigma + sum / MAX (seen, 1);
}

/* Keeps the gap of a simulation that lacks nothing. */
static void
keep_null (ClothDiagnosis * d, ClothWindowedGap * null, guint recording)
{
  d->nulls[d->n_nulls] = null;
  d->null_recordings[d->n_nulls++] = recording;
}

/* The floor of the simulator's own error: what the baseline shows, and on takes that move
 * otherwise what the two force models differ by there, if that is more. Its square goes
 * into @draws, too. */
static gboolean
measure_floor (ClothDiagnosis * d, guint judge, const ClothWindowedGap * gap,
    gdouble * draws, GError ** error)
{
  const ClothModel *models[1] = { d->model };
  ClothGapEstimate *result = &d->result->noise_floor;
  ClothWindowedGap **floor, *other = NULL;
  guint baseline = d->n_takes;
  const ClothSensitivities *discrepancy =
      cloth_diagnosis_study (d, 0)->discrepancy;
  gdouble square;

  /* of the first take's motion, if there is one */
  for (guint i = d->n_takes; discrepancy && i < d->studies->len; i++)
    if (cloth_diagnosis_study (d, i) == discrepancy)
      baseline = i;
  *result = (ClothGapEstimate) {
  0., NAN, NAN};
  if (d->options->n_baselines) {
    floor =
        cloth_diagnosis_measure_windows (d, cloth_diagnosis_recording (d,
            baseline), models, 1, error);
    if (!floor)
      return FALSE;
    square = cloth_windowed_gap_square (floor[0], NULL);
    cloth_windowed_gaps_interval (floor, 1, NULL, d->options->seed, N_DRAWS,
        draws);
    *result = estimate (square, draws, N_DRAWS, 1);
    if (floor[0]->sound)
      d->floor = g_steal_pointer (&floor[0]->energy);
    if (floor[0]->sound)
      keep_null (d, g_steal_pointer (&floor[0]), baseline);
    d->null_alike = discrepancy && d->n_nulls;
    cloth_windowed_gaps_free (floor, 1);
    if (cloth_diagnosis_has_discrepancies (d))
      return TRUE;
  }
  square = own_floor (d, judge, gap, &other, error);
  if (sqrt (square) > result->value) {
    *result = (ClothGapEstimate) {
    sqrt (square), NAN, NAN};
    for (guint i = 0; i < N_DRAWS; i++)
      draws[i] = square;
    d->floor_null = d->n_nulls;
  }
  if (other)
    keep_null (d, other, judge);
  return !isnan (square);
}

static gdouble
share_gone (const ClothGapResult * result, gdouble before, gdouble after)
{
  gdouble floor = result->noise_floor.value * result->noise_floor.value;

  return before - floor > LEAST_ABOVE_SHARE * before ?
      (before - after) / (before - floor) : NAN;
}

/* Of what is above the floor, the share that went; draws are @stride apart. */
static void
fill_shrink (ClothGapResult * result, gdouble before, gdouble after,
    const gdouble * draws_before, const gdouble * draws_after, guint stride)
{
  g_autofree gdouble *shrinks = g_new (gdouble, N_DRAWS);
  gdouble floor = result->noise_floor.value * result->noise_floor.value;

  if (!(before - floor > LEAST_ABOVE_SHARE * before))
    return;
  /* of draws that are all floor no share can be given either: they count as if they were as
   * little above it as one that can */
  for (guint i = 0; i < N_DRAWS; i++) {
    gdouble b = draws_before[i * stride], a = draws_after[i * stride];

    shrinks[i] = (b - a) / MAX (b - floor, LEAST_ABOVE_SHARE * before);
  }
  result->shrink = find_interval (share_gone (result, before, after), shrinks,
      N_DRAWS, 1);
}

/* How often a rest is no more than the floor, each drawn anew; draws of the rest are
 * @stride apart. The observed ones count as one draw more (Davison and Hinkley 1997, 4.2). */
static gdouble
find_rest_p_value (const gdouble * rest, guint stride, const gdouble * floor)
{
  guint count = 0;

  for (guint i = 0; i < N_DRAWS; i++)
    for (guint j = 0; j < N_DRAWS; j++)
      count += rest[i * stride] <= floor[j];
  return (1. + count) / (1. + (gdouble) N_DRAWS * N_DRAWS);
}

/* Whether an effect is large enough to be accepted. Where a discrepancy is taken off, the
 * evidence has said so of the first: the gap holds the simulator's own error too, which
 * hides it where it is no larger. */
static gboolean
is_improved (const ClothDiagnosis * d, gboolean first, gdouble before,
    gdouble after)
{
  const gdouble floor = d->result->noise_floor.value;

  return after < (1. - CLOTH_DIAGNOSIS_LEAST_SHRINK) * before
      || (first && cloth_diagnosis_has_discrepancies (d)
      && after < HARDLY_LARGER * before
      && after < CLOTH_DIAGNOSIS_BAND * floor * floor);
}

/* Where the gap of the first take lies, and what is needed to say more of it. */
static void
keep_first (ClothDiagnosis * d, ClothWindowedGap * before,
    ClothWindowedGap * after)
{
  cloth_windowed_gap_fill (before, after, cloth_diagnosis_recording (d, 0),
      d->takes[0], d->result);
  if (before->sound) {
    d->before = g_steal_pointer (&before->energy);
    d->nudged = g_steal_pointer (&before->nudged);
  }
  if (after && after->sound)
    d->after = g_steal_pointer (&after->energy);
}

/* Puts the positions that the cameras gave with their faults into a recording, or takes
 * them out again. */
static void
swap_uncorrected (ClothDiagnosis * d, guint i)
{
  ClothRecording *r = cloth_diagnosis_recording (d, i);
  gdouble *y = r->y;

  r->y = d->uncorrected[i];
  d->uncorrected[i] = y;
  cloth_recording_interpolate (r);
  cloth_recording_differentiate (r);
}

/* The models' distances from a recording: the first one's from what the cameras gave, and
 * where they had faults once more and all others' from what they would have given. */
static ClothWindowedGap **
measure_models (ClothDiagnosis * d, guint i, const ClothModel * const *models,
    guint n, GError ** error)
{
  const ClothRecording *r = cloth_diagnosis_recording (d, i);
  ClothWindowedGap **all = NULL, **others;

  if (!d->uncorrected[i])
    return cloth_diagnosis_measure_windows (d, r, models, n, error);
  swap_uncorrected (d, i);
  all = cloth_diagnosis_measure_windows (d, r, models, 1, error);
  swap_uncorrected (d, i);
  if (!all)
    return NULL;
  others = cloth_diagnosis_measure_windows (d, r, models + 1, n - 1, error);
  if (!others) {
    cloth_windowed_gaps_free (all, 1);
    return NULL;
  }
  all = g_renew (ClothWindowedGap *, all, n);
  memcpy (all + 1, others, (n - 1) * sizeof *all);
  g_free (others);
  return all;
}

/* How large the gap is before and after, on the hold-outs if there are any; the floor on
 * the baselines. Of the accepted effects those stay that shrink it enough, one after the
 * other; faults of cameras stay. */
gboolean
cloth_diagnosis_measure (ClothDiagnosis * d, GError ** error)
{
  ClothGapResult *result = d->result;
  const ClothModel *models[2 + CLOTH_DIAGNOSIS_MAX_ACCEPTED] = {
    d->model, d->model
  };
  const guint faults = cloth_diagnosis_count_faults (d) > 0;
  guint n = 1 + faults + d->n_accepted, best = faults;
  guint judge = d->options->n_hold_outs ? d->n_takes + d->options->n_baselines
      : 0;
  g_autofree gdouble *draws = g_new0 (gdouble, N_DRAWS * n);
  g_autofree gdouble *floor = g_new0 (gdouble, N_DRAWS);
  g_autofree gboolean *windows = NULL;
  ClothWindowedGap **gaps;
  gdouble v[G_N_ELEMENTS (models)];

  for (guint i = 0; i < d->n_accepted; i++)
    models[1 + faults + i] = d->with[i];
  cloth_diagnosis_begin_part (d, 0.85, 1., 0.4, "the gap in windows");
  gaps = measure_models (d, judge, models, n, error);
  if (!gaps)
    return FALSE;
  if (!judge)
    windows = judging_windows (d, gaps[0]);
  for (guint i = 0; i < n; i++)
    v[i] = cloth_windowed_gap_square (gaps[i], windows);
  if (!measure_floor (d, judge, gaps[0], floor, error)) {
    cloth_windowed_gaps_free (gaps, n);
    return FALSE;
  }
  for (guint i = best + 1; i < n; i++)
    if (is_improved (d, best == faults, v[best], v[i]))
      best = i;
  while (d->n_accepted > best - faults)
    cloth_model_free (d->with[--d->n_accepted]);
  cloth_windowed_gaps_interval (gaps, n, windows, d->options->seed, N_DRAWS,
      draws);
  result->held_out_takes = d->options->n_hold_outs > 0;
  result->gap_before = estimate (v[0], draws, N_DRAWS, n);
  if (best) {
    result->gap_after = estimate (v[best], draws + best, N_DRAWS, n);
    fill_shrink (result, v[0], v[best], draws, draws + best, n);
  }
  result->rest_p_value = find_rest_p_value (draws + best, n, floor);
  if (faults)
    d->shrink_of_faults = share_gone (result, v[0], v[1]);
  if (!judge)
    keep_first (d, gaps[0], best ? gaps[best] : NULL);
  cloth_windowed_gaps_free (gaps, n);
  if (!judge)
    return TRUE;
  models[1] = models[best];
  n = best ? 2 : 1;
  gaps = measure_models (d, 0, models, n, error);
  if (!gaps)
    return FALSE;
  keep_first (d, gaps[0], best ? gaps[1] : NULL);
  cloth_windowed_gaps_free (gaps, n);
  return TRUE;
}

/* The effects that are accepted, first in the order in which they were accepted. */
static void
accept_effects (ClothDiagnosis * d)
{
  const guint last = d->n_accepted - 1;
  GArray *effects = d->result->effects;

  for (guint c = d->n_accepted; c-- > 0;) {
    const ClothCandidate *candidate = cloth_diagnosis_accepted (d, c);
    ClothGapEffect e;
    guint i = 0;

    while (i < effects->len && g_array_index (effects, ClothGapEffect,
            i).effect != candidate->effect)
      i++;
    /* the first test may not have been able to tell it from others */
    if (i == effects->len)
      cloth_gap_result_add_effect (d->result, candidate->effect);
    e = g_array_index (effects, ClothGapEffect, i);
    e.accepted = TRUE;
    e.probability = d->probabilities[c];
    e.shrink = d->result->shrink;
    for (guint k = 0; k < candidate->effect->n_parameters; k++)
      e.values[k] = candidate->values[k];
    for (guint k = 0; k < candidate->n; k++) {
      const ClothDirection *direction =
          cloth_candidates_direction (d->candidates, candidate->first + k);
      guint p = candidate->parameters[k];

      cloth_model_get (d->with[last], direction->name, &e.values[p], NULL);
      e.sigmas[p] = CLOTH_DIAGNOSIS_SIGMA_WIDTH * d->sigmas[last][c][k];
    }
    g_array_remove_index (effects, i);
    g_array_prepend_val (effects, e);
  }
}

/* The cameras' effects among the others: what was wrong with them first, the rest behind
 * what is likelier. */
static void
add_camera_effects (ClothDiagnosis * d)
{
  GArray *effects = d->result->effects;
  gboolean alike = FALSE;

  for (guint i = 0; i < d->camera_effects->len; i++) {
    ClothGapEffect e = g_array_index (d->camera_effects, ClothGapEffect, i);
    guint at = i;

    /* a small fault is there, and yet not what the gap is about */
    if (!e.accepted && i >= d->camera_effects->len - d->n_faults +
        cloth_diagnosis_count_faults (d))
      at = effects->len;
    if (e.accepted)
      e.shrink.value = d->shrink_of_faults;
    for (; !e.accepted && at < effects->len; at++) {
      const ClothGapEffect *other = &g_array_index (effects, ClothGapEffect,
          at);

      if (!other->accepted && other->probability < e.probability)
        break;
    }
    if (e.group >= 0) {
      e.group = (gint) d->result->groups->len;
      alike = TRUE;
    }
    g_array_insert_val (effects, at, e);
  }
  if (alike)
    cloth_gap_result_add_group (d->result, capture_sentence, NAN);
}

/* Whether another effect would do as well as one that is accepted. */
static gboolean
is_ambiguous (const ClothGapResult * r)
{
  for (guint i = 0; i < r->effects->len; i++)
    if (g_array_index (r->effects, ClothGapEffect, i).accepted
        && g_array_index (r->effects, ClothGapEffect, i).group >= 0)
      return TRUE;
  return FALSE;
}

/* Whether clamps are off their paths by enough to matter, and no accepted effect moves
 * clamps. */
static gboolean
are_clamps_off (const ClothDiagnosis * d, gdouble floor2)
{
  for (guint i = 0; i < d->n_accepted; i++)
    if (cloth_diagnosis_accepted (d, i)->effect->side == CLOTH_EFFECT_CLAMP)
      return FALSE;
  return d->clamps_off > CLOTH_DIAGNOSIS_LEAST_SHRINK * floor2;
}

void
cloth_diagnosis_decide (ClothDiagnosis * d)
{
  ClothGapResult *r = d->result;
  gdouble floor2 = r->noise_floor.value * r->noise_floor.value;
  guint accepted = d->n_accepted + cloth_diagnosis_count_faults (d);
  gdouble rest = accepted ? r->gap_after.value : r->gap_before.value;
  gboolean above = rest * rest > CLOTH_DIAGNOSIS_BAND * floor2;
  /* an effect that was supported and did not help stands for another */
  gboolean other = d->supported && rest * rest > floor2;
  gboolean clamps = are_clamps_off (d, floor2);

  if (d->n_accepted)
    accept_effects (d);
  add_camera_effects (d);
  if (above || clamps || (!accepted && (d->unexplained || other)))
    r->verdict = CLOTH_GAP_UNEXPLAINED;
  else if (!accepted)
    r->verdict = CLOTH_GAP_NO_GAP;
  else
    r->verdict = is_ambiguous (r) ? CLOTH_GAP_AMBIGUOUS : CLOTH_GAP_EXPLAINED;
  if (clamps || (!accepted && d->unexplained))
    r->reason = g_steal_pointer (&d->unexplained);
  else if (!accepted && other && !above)
    r->reason = g_strdup ("An effect was asked for, but with it unseen data "
        "came no nearer.");
}
