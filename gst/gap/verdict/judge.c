/* Decides the verdict.
 *
 * The rest is explained when it is below 2.25 floors in variance, and when takes agree on what
 * explains it. With a twin the floor is that and what the foretold change by the effects is off by.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/verdict/judge.h"

#include <math.h>

#include "gst/gap/verdict/agreement.h"

/* What parts faults of cameras that look alike. */
static const gchar *const capture_sentence =
    "Film a board that moves with all cameras, once more with half the "
    "exposure time, and at rest: clocks, shutters and exposures show in motion "
    "only, lenses and places at rest too.";

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
  gdouble floor2 = r->noise_floor.value * r->noise_floor.value +
      d->prediction_square;
  guint accepted = d->n_accepted + cloth_diagnosis_count_faults (d);
  gdouble rest = accepted ? r->gap_after.value : r->gap_before.value;
  gboolean above = rest * rest > CLOTH_DIAGNOSIS_BAND * floor2;
  /* an effect that was supported and did not help stands for another */
  gboolean other = d->supported && rest * rest > floor2;
  gboolean clamps = are_clamps_off (d, floor2);
  gboolean contradict = r->takes_agree_p_value < CLOTH_DIAGNOSIS_CONTRADICTION;

  if (d->n_accepted)
    accept_effects (d);
  add_camera_effects (d);
  if (above || clamps || contradict || (!accepted && (d->unexplained || other)))
    r->verdict = CLOTH_GAP_UNEXPLAINED;
  else if (!accepted)
    r->verdict = CLOTH_GAP_NO_GAP;
  else
    r->verdict = is_ambiguous (r) ? CLOTH_GAP_AMBIGUOUS : CLOTH_GAP_EXPLAINED;
  if (clamps || (!accepted && d->unexplained))
    r->reason = g_steal_pointer (&d->unexplained);
  else if (contradict)
    r->reason = g_strdup ("The takes contradict each other on the accepted "
        "effects, so these are not all of it.");
  else if (!accepted && other && !above)
    r->reason = g_strdup ("An effect was asked for, but with it unseen data "
        "came no nearer.");
}
