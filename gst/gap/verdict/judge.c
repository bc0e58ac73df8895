/* Decides the verdict from the posterior.
 *
 *   unexplained: takes contradict each other on what acts; or chance acts that can't be simulated again, and the
 *     accepted effects leave more than the floor; or clamps were elsewhere than logged, beside accepted
 *     effects by a fifth of the gap's power at least; or an unknown field is likelier than not, beside a
 *     baseline or a twin, has a fifth of the gap's or the floor's power at least, and the accepted effects
 *     leave more than the floor; or the simulation with what is likeliest to act is not surely nearer to the cloth,
 *     whose gap is above the floor of a baseline or a twin;
 *   explained: effects act, and no other explanation is among those that have 95% together;
 *   ambiguous: effects act, and others would do as well;
 *   no_gap: it is likelier than not that nothing acts, and there is a baseline or a twin to say so;
 *   undecidable: an effect is likelier than nothing, but that nothing acts is not refuted; or there is
 *     neither baseline nor twin, and nothing acts that could be seen, or something unknown does, which may be
 *     what any simulation of this cloth is off by.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/verdict/judge.h"

#include <math.h>

#include "gst/gap/inference/clamps.h"
#include "gst/gap/verdict/agreement.h"

/* A rest is more than the floor when this share of draws at most says otherwise. */
#define NO_REST 0.05

/* What parts faults of cameras that look alike. */
static const gchar *const capture_sentence =
    "Film a board that moves with all cameras, once more with half the "
    "exposure time, and at rest: clocks, shutters and exposures show in motion "
    "only, lenses and places at rest too.";

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

/* @result: a result
 *
 * Returns: whether another effect would do as well as one that is accepted
 */
gboolean
cloth_gap_result_is_ambiguous (const ClothGapResult * result)
{
  for (guint i = 0; i < result->effects->len; i++) {
    const ClothGapEffect *e = &g_array_index (result->effects, ClothGapEffect,
        i);

    if (e->accepted && e->group >= 0)
      return TRUE;
  }
  return FALSE;
}

/* Whether the accepted effects leave no more than the floor: then there is nothing left to explain. */
static gboolean
leaves_nothing (const ClothDiagnosis * d)
{
  return d->n_accepted && d->result->rest_p_value > NO_REST;
}

/* Whether something unknown acts that is worth a word: its power is held against the gap's, or the
 * floor's where that is more. */
static gboolean
is_unlike_all (const ClothDiagnosis * d)
{
  const gdouble gap = d->result->gap_before.value;
  const gdouble floor = d->result->noise_floor.value;
  const gdouble share = d->unknown_share *
      (gap < floor ? gap * gap / (floor * floor) : 1.);

  return d->result->rivals.force_field +
      d->result->rivals.displacement_field > 0.5
      && share > CLOTH_DIAGNOSIS_LEAST_SHARE && !leaves_nothing (d);
}

/* Whether clamps that were elsewhere than logged are worth a word: beside accepted effects their power is
 * held against the gap's, too. */
static gboolean
are_clamps_off (const ClothDiagnosis * d)
{
  gdouble most = 0.;

  for (guint t = 0; t < d->n_takes; t++)
    most = fmax (most, 3. * cloth_gap_find_clamps_off
        (cloth_diagnosis_recording (d, t), NULL));
  return d->clamps_off && !(d->n_accepted && most <
      CLOTH_DIAGNOSIS_LEAST_SHARE * pow (d->result->gap_before.value, 2.));
}

/* The likeliest effect, if it is likelier that effects act than that nothing does. */
static const ClothEffect *
find_likely (const ClothDiagnosis * d)
{
  return d->result->effects->len && d->result->rivals.none_acts <
      0.5 * (1. - d->unknown_probability) ?
      g_array_index (d->result->effects, ClothGapEffect, 0).effect : NULL;
}

void
cloth_diagnosis_decide (ClothDiagnosis * d)
{
  ClothGapResult *r = d->result;
  const ClothEffect *likely = find_likely (d);
  const gboolean is_unlike = is_unlike_all (d);
  const gboolean clamps_off = are_clamps_off (d);
  const gboolean unknown = clamps_off
      || (is_unlike && cloth_diagnosis_n_references (d));
  const gboolean by_chance = d->chance && !leaves_nothing (d);
  const gboolean contradict =
      r->takes_agree_p_value < CLOTH_DIAGNOSIS_CONTRADICTION;

  for (guint i = 0; i < r->effects->len; i++) {
    ClothGapEffect *e = &g_array_index (r->effects, ClothGapEffect, i);

    if (e->accepted)
      e->shrink = r->shrink;
  }
  add_camera_effects (d);
  /* what is not worth a word has none to say later */
  if (!clamps_off)
    g_clear_pointer (&d->clamps_off, g_free);
  if (!by_chance)
    d->chance = NULL;
  if (unknown || contradict || by_chance) {
    r->verdict = CLOTH_GAP_UNEXPLAINED;
    r->reason = contradict ? g_strdup ("The takes contradict each other on the "
        "accepted effects, so these are not all of it.") : clamps_off ?
        g_strdup (d->clamps_off) : by_chance ?
        g_strdup_printf ("It is likely that %s acts, which changes by chance: "
        "no simulation can repeat it.",
        d->chance->id) :
        g_strdup_printf
        ("%.0f%% of the gap is more than simulators differ by when "
        "nothing acts, and no effect of the library is like it: %s.",
        100. * d->unknown_share,
        r->rivals.force_field >
        r->rivals.displacement_field ? "it spreads as an unknown force would" :
        "it spreads as places that were measured wrong would");
  } else if (is_unlike) {
    r->verdict = CLOTH_GAP_UNDECIDABLE;
    r->reason = g_strdup_printf ("%.0f%% of the gap is more than our "
        "simulators differ by and like no effect of the library, but without a "
        "baseline or what your simulator made of the scene nobody knows what "
        "a simulation of this cloth is off by when nothing acts.",
        100. * d->unknown_share);
  } else if (d->n_accepted || cloth_diagnosis_count_faults (d)) {
    r->verdict =
        cloth_gap_result_is_ambiguous (r) ? CLOTH_GAP_AMBIGUOUS :
        CLOTH_GAP_EXPLAINED;
  } else if (d->taken_back) {
    r->verdict = cloth_diagnosis_n_references (d) ? CLOTH_GAP_UNEXPLAINED :
        CLOTH_GAP_UNDECIDABLE;
    r->reason = g_strdup_printf ("The residual speaks for %s, but the "
        "simulation with it is not surely nearer to the cloth.",
        d->taken_back->id);
  } else if (likely) {
    r->verdict = CLOTH_GAP_UNDECIDABLE;
    r->reason = g_strdup_printf ("It is likelier than not that an effect acts, "
        "%s first of all, but that nothing does is not refuted: a second "
        "recording of the motion, or a longer one, would tell.", likely->id);
  } else if (cloth_diagnosis_n_references (d)) {
    r->verdict = CLOTH_GAP_NO_GAP;
  } else {
    r->verdict = CLOTH_GAP_UNDECIDABLE;
    r->reason = g_strdup ("No effect shows, but without a baseline or what "
        "your simulator made of the scene small ones could not: see the "
        "detection limits.");
  }
}
