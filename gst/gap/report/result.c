/* What a diagnosis found: making it and filling it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/report/result.h"

#include <math.h>

static const ClothGapEstimate unknown = { NAN, NAN, NAN };

static const gchar *const verdict_names[] = {
  "undecidable", "no_gap", "explained", "ambiguous", "unexplained"
};

static void
clear_take (gpointer item)
{
  g_free (((ClothGapMeasuredTake *) item)->name);
}

static void
clear_set (gpointer item)
{
  g_ptr_array_unref (((ClothGapSet *) item)->effects);
}

static void
clear_patch (gpointer item)
{
  g_free (((ClothGapPatch *) item)->name);
  g_free (((ClothGapPatch *) item)->text);
  g_free (((ClothGapPatch *) item)->unit);
}

static void
clear_free_number (gpointer item)
{
  g_free (((ClothGapFreeNumber *) item)->name);
  g_free (((ClothGapFreeNumber *) item)->unit);
}

static void
clear_group (gpointer item)
{
  g_free (((ClothGapGroup *) item)->experiment);
}

static void
clear_untested (gpointer item)
{
  g_free (((ClothGapUntested *) item)->reason);
}

static void
clear_stage (gpointer item)
{
  g_free (((ClothGapStage *) item)->name);
  g_free (((ClothGapStage *) item)->reason);
}

static void
clear_note (gpointer item)
{
  g_free (((ClothGapNote *) item)->name);
  g_free (((ClothGapNote *) item)->text);
}

static void
clear_input (gpointer item)
{
  g_free (((ClothGapInput *) item)->name);
  g_free (((ClothGapInput *) item)->sha256);
}

static void
clear_threshold (gpointer item)
{
  g_free (((ClothGapThreshold *) item)->name);
  g_free (((ClothGapThreshold *) item)->unit);
  g_free (((ClothGapThreshold *) item)->reason);
}

static GArray *
new_list (gsize size, GDestroyNotify clear)
{
  GArray *list = g_array_new (FALSE, TRUE, (guint) size);

  if (clear)
    g_array_set_clear_func (list, clear);
  return list;
}

/* Returns: (transfer full): a result that knows nothing: undecidable, without effects
 */
ClothGapResult *
cloth_gap_result_new (void)
{
  ClothGapResult *result = g_new0 (ClothGapResult, 1);

  result->gap_before = result->gap_after = result->noise_floor = unknown;
  result->shrink = unknown;
  result->predicted_shrink = result->measured_shrink = (ClothGapShrink) {
  unknown, unknown};
  result->rest_p_value = result->takes_agree_p_value = NAN;
  result->onset_s = result->still = NAN;
  result->rivals = (ClothGapRivals) {
  NAN, NAN, NAN};
  for (guint i = 0; i < 3; i++)
    result->directions[i] = NAN;
  result->takes = new_list (sizeof (ClothGapMeasuredTake), clear_take);
  result->effects = new_list (sizeof (ClothGapEffect), NULL);
  result->sets = new_list (sizeof (ClothGapSet), clear_set);
  result->groups = new_list (sizeof (ClothGapGroup), clear_group);
  result->untested = new_list (sizeof (ClothGapUntested), clear_untested);
  result->detection_limits = new_list (sizeof (ClothGapLimit), NULL);
  result->patch = new_list (sizeof (ClothGapPatch), clear_patch);
  result->free_numbers = new_list (sizeof (ClothGapFreeNumber),
      clear_free_number);
  result->bands = new_list (sizeof (ClothGapBand), NULL);
  result->waves = new_list (sizeof (ClothGapBand), NULL);
  result->stages = new_list (sizeof (ClothGapStage), clear_stage);
  result->versions = new_list (sizeof (ClothGapNote), clear_note);
  result->inputs = new_list (sizeof (ClothGapInput), clear_input);
  result->thresholds = new_list (sizeof (ClothGapThreshold), clear_threshold);
  result->notes = g_ptr_array_new_with_free_func (g_free);
  result->failures = new_list (sizeof (ClothGapNote), clear_note);
  return result;
}

/* @result: a result
 * @note: a sentence
 */
void
cloth_gap_result_add_note (ClothGapResult * result, const gchar * note)
{
  g_ptr_array_add (result->notes, g_strdup (note));
}

/* @result: a result
 * @role: take, baseline or hold-out
 * @name: its name
 *
 * Returns: (transfer none): what was measured on it, all unknown yet; valid until the next
 *   take is added
 */
ClothGapMeasuredTake *
cloth_gap_result_add_take (ClothGapResult * result, ClothGapRole role,
    const gchar * name)
{
  ClothGapMeasuredTake item = {.role = role,.name = g_strdup (name),
    .gap_before = unknown,.gap_after = unknown,.noise_floor = unknown,
    .shrink = unknown,.free_before = unknown,.free_after = unknown,
    .free_floor = unknown
  };

  g_array_append_val (result->takes, item);
  return &g_array_index (result->takes, ClothGapMeasuredTake,
      result->takes->len - 1);
}

/* @result: a result
 * @effect: an effect that was tested
 *
 * Effects are added in the order of their rank.
 *
 * Returns: (transfer none): what was found of it, all unknown yet; valid until the next
 *   effect is added
 */
ClothGapEffect *
cloth_gap_result_add_effect (ClothGapResult * result,
    const ClothEffect * effect)
{
  ClothGapEffect item = {.effect = effect,.probability = NAN,
    .log_bayes_factor = NAN,.p_value = NAN,.constancy_p_value = NAN,.shrink =
        unknown,.group = -1
  };

  for (guint i = 0; i < CLOTH_EFFECT_MAX_PARAMETERS; i++)
    item.values[i] = item.sigmas[i] = NAN;
  g_array_append_val (result->effects, item);
  return &g_array_index (result->effects, ClothGapEffect,
      result->effects->len - 1);
}

/* @result: a result
 * @rival: what acts besides its effects
 * @probability: that these act and nothing else
 *
 * Sets are added in the order of their probability.
 *
 * Returns: (transfer none): it, without effects yet; valid until the next one is added
 */
ClothGapSet *
cloth_gap_result_add_set (ClothGapResult * result, ClothGapRival rival,
    gdouble probability)
{
  ClothGapSet item = { g_ptr_array_new (), rival, probability };

  g_array_append_val (result->sets, item);
  return &g_array_index (result->sets, ClothGapSet, result->sets->len - 1);
}

/* @result: a result
 * @experiment: (nullable): what would tell its effects apart, a sentence
 * @log_bayes_factor: what that is expected to bring, log Bayes factor; NaN: not known
 *
 * Its index is one less than the number of groups.
 */
void
cloth_gap_result_add_group (ClothGapResult * result, const gchar * experiment,
    gdouble log_bayes_factor)
{
  ClothGapGroup item = { g_strdup (experiment), log_bayes_factor };

  g_array_append_val (result->groups, item);
}

/* @result: a result
 * @effect: an effect that could not be tested
 * @reason: why, and what would help, a sentence
 */
void
cloth_gap_result_add_untested (ClothGapResult * result,
    const ClothEffect * effect, const gchar * reason)
{
  ClothGapUntested item = { effect, g_strdup (reason) };

  g_array_append_val (result->untested, item);
}

/* @result: a result
 * @effect: an effect
 * @parameter: which of its parameters
 * @value: how far from its null it would have shown with a probability of 95%; NaN: none
 */
void
cloth_gap_result_add_limit (ClothGapResult * result,
    const ClothEffect * effect, guint parameter, gdouble value)
{
  ClothGapLimit item = { effect, parameter, value };

  g_return_if_fail (parameter < effect->n_parameters);
  g_array_append_val (result->detection_limits, item);
}

/* @result: a result
 * @name: what is changed, as whom the patch is for calls it
 * @text: the change in plain words
 * @before: its value; NaN: it was not there
 * @after: its value to set; NaN: the simulator can't express it
 * @unit: of both
 */
void
cloth_gap_result_add_patch (ClothGapResult * result, const gchar * name,
    const gchar * text, gdouble before, gdouble after, const gchar * unit)
{
  const gdouble factor = after / before;
  ClothGapPatch item = { g_strdup (name), g_strdup (text), before, after,
    g_strdup (unit), isfinite (factor) ? factor : NAN
  };

  g_array_append_val (result->patch, item);
}

/* @result: a result
 * @name: of a free number of the model
 * @unit: its unit
 *
 * Returns: (transfer none): what was found of it, all unknown yet; valid until the next
 *   one is added
 */
ClothGapFreeNumber *
cloth_gap_result_add_free_number (ClothGapResult * result, const gchar * name,
    const gchar * unit)
{
  ClothGapFreeNumber item = { g_strdup (name), g_strdup (unit), NAN, NAN, NAN,
    NAN, FALSE
  };

  g_array_append_val (result->free_numbers, item);
  return &g_array_index (result->free_numbers, ClothGapFreeNumber,
      result->free_numbers->len - 1);
}

/* @result: a result
 * @name: of the stage
 * @share: of the gap's variance; NaN: it could not be measured
 * @reason: (nullable): why it could not, a sentence
 */
void
cloth_gap_result_add_stage (ClothGapResult * result, const gchar * name,
    gdouble share, const gchar * reason)
{
  ClothGapStage item = { g_strdup (name), share, g_strdup (reason) };

  g_array_append_val (result->stages, item);
}

/* @result: a result
 * @name: of what
 * @version: its version
 */
void
cloth_gap_result_add_version (ClothGapResult * result, const gchar * name,
    const gchar * version)
{
  ClothGapNote item = { g_strdup (name), g_strdup (version) };

  g_array_append_val (result->versions, item);
}

/* @result: a result
 * @role: what it was used for
 * @name: its name
 * @sha256: (nullable): hash of its contents, in hexadecimal digits
 */
void
cloth_gap_result_add_input (ClothGapResult * result, ClothGapRole role,
    const gchar * name, const gchar * sha256)
{
  ClothGapInput item = { role, g_strdup (name), g_strdup (sha256) };

  g_array_append_val (result->inputs, item);
}

/* @result: a result
 * @name: of the threshold
 * @value: its value
 * @unit: in the notation of the SI, "1" for a ratio
 * @origin: where it comes from
 * @reason: why it is so, a sentence
 */
void
cloth_gap_result_add_threshold (ClothGapResult * result, const gchar * name,
    gdouble value, const gchar * unit, ClothGapOrigin origin,
    const gchar * reason)
{
  ClothGapThreshold item = { g_strdup (name), value, g_strdup (unit), origin,
    g_strdup (reason)
  };

  g_array_append_val (result->thresholds, item);
}

/* @result: a result
 * @run: which simulation failed
 * @what: what happened to it
 */
void
cloth_gap_result_add_failure (ClothGapResult * result, const gchar * run,
    const gchar * what)
{
  ClothGapNote item = { g_strdup (run), g_strdup (what) };

  g_array_append_val (result->failures, item);
}

/* @verdict: a verdict
 *
 * Returns: (transfer none): its name in gap.json
 */
const gchar *
cloth_gap_verdict_name (ClothGapVerdict verdict)
{
  g_return_val_if_fail (verdict < G_N_ELEMENTS (verdict_names), NULL);
  return verdict_names[verdict];
}

/* @result: (transfer full) (nullable): a result
 */
void
cloth_gap_result_free (ClothGapResult * result)
{
  if (!result)
    return;
  g_free (result->reason);
  g_ptr_array_unref (result->notes);
  g_array_unref (result->takes);
  g_array_unref (result->effects);
  g_array_unref (result->sets);
  g_array_unref (result->groups);
  g_array_unref (result->untested);
  g_array_unref (result->detection_limits);
  g_array_unref (result->patch);
  g_free (result->patch_simulator);
  g_array_unref (result->free_numbers);
  g_free (result->free_correlation);
  g_free (result->vertices);
  g_free (result->gained);
  g_free (result->frames);
  g_clear_pointer (&result->region, g_array_unref);
  g_array_unref (result->bands);
  g_array_unref (result->waves);
  g_array_unref (result->stages);
  g_array_unref (result->versions);
  g_array_unref (result->inputs);
  g_array_unref (result->thresholds);
  g_array_unref (result->failures);
  g_free (result->series.times);
  g_free (result->series.before);
  g_free (result->series.after);
  g_free (result->series.null_low);
  g_free (result->series.null_high);
  g_free (result->spectrum.frequencies);
  g_free (result->spectrum.waves);
  g_free (result->spectrum.before);
  g_free (result->spectrum.after);
  g_free (result->spectrum.null);
  g_free (result->playback.take);
  cloth_topology_free (result->playback.topology);
  g_free (result->playback.times);
  g_free (result->playback.recorded);
  g_free (result->playback.before);
  g_free (result->playback.after);
  g_free (result->playback.sigma);
  cloth_model_free (result->model);
  cloth_rig_free (result->rig);
  g_free (result);
}
