/* What a diagnosis writes: gap.json, and the page that shows it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/report/report.h"

#include <gio/gio.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "gst/file/output.h"
#include "gst/file/jsonwriter.h"
#include "gst/gap/report/arrays.h"
#include "gst/gap/report/page.h"
#include "gst/rig/rigfile.h"

static const gchar *const role_names[] = {
  "take", "baseline", "hold_out", "simulated", "simulated_after", "model"
};

/* No rival has no name. */
static const gchar *const rival_names[] = {
  NULL, "force_field", "displacement_field"
};

static const gchar *const origin_names[] = {
  "simulated", "parameter", "paper", "definition"
};

static const ClothGapEffect *
effect_at (const ClothGapResult * result, guint i)
{
  return &g_array_index (result->effects, ClothGapEffect, i);
}

/* Half an interval is none. */
static void
put_interval (ClothJsonWriter * writer, const gchar * key, gdouble low,
    gdouble high)
{
  const gdouble interval[] = { low, high };

  cloth_json_writer_numbers (writer, key,
      isfinite (low) && isfinite (high) ? interval : NULL, 2);
}

static void
put_estimate (ClothJsonWriter * writer, const gchar * key,
    const ClothGapEstimate * estimate)
{
  cloth_json_writer_begin_object (writer, key);
  cloth_json_writer_number (writer, "value", estimate->value);
  put_interval (writer, "interval", estimate->low, estimate->high);
  cloth_json_writer_end_object (writer);
}

static void
put_shrink (ClothJsonWriter * writer, const gchar * key,
    const ClothGapShrink * shrink)
{
  cloth_json_writer_begin_object (writer, key);
  put_estimate (writer, "windows", &shrink->windows);
  put_estimate (writer, "free", &shrink->free);
  cloth_json_writer_end_object (writer);
}

static void
put_takes (ClothJsonWriter * writer, const ClothGapResult * result)
{
  cloth_json_writer_begin_array (writer, "takes");
  for (guint i = 0; i < result->takes->len; i++) {
    const ClothGapMeasuredTake *take = &g_array_index (result->takes,
        ClothGapMeasuredTake, i);

    cloth_json_writer_begin_object (writer, NULL);
    cloth_json_writer_string (writer, "role", role_names[take->role]);
    cloth_json_writer_string (writer, "name", take->name);
    put_estimate (writer, "gap_before", &take->gap_before);
    put_estimate (writer, "gap_after", &take->gap_after);
    put_estimate (writer, "noise_floor", &take->noise_floor);
    put_estimate (writer, "shrink", &take->shrink);
    put_estimate (writer, "free_before", &take->free_before);
    put_estimate (writer, "free_after", &take->free_after);
    put_estimate (writer, "free_floor", &take->free_floor);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);
  cloth_json_writer_number (writer, "takes_agree_p_value",
      result->takes_agree_p_value);
}

static void
put_effect (ClothJsonWriter * writer, const ClothGapEffect * item)
{
  const ClothEffect *effect = item->effect;

  cloth_json_writer_begin_object (writer, NULL);
  cloth_json_writer_string (writer, "name", effect->id);
  cloth_json_writer_string (writer, "side",
      cloth_effect_side_name (effect->side));
  cloth_json_writer_string (writer, "camera", item->camera);
  cloth_json_writer_number (writer, "probability", item->probability);
  cloth_json_writer_number (writer, "log_bayes_factor", item->log_bayes_factor);
  cloth_json_writer_boolean (writer, "accepted", item->accepted);
  cloth_json_writer_begin_array (writer, "parameters");
  for (guint i = 0; i < effect->n_parameters; i++) {
    cloth_json_writer_begin_object (writer, NULL);
    cloth_json_writer_string (writer, "name", effect->parameters[i].name);
    cloth_json_writer_number (writer, "value", item->values[i]);
    cloth_json_writer_number (writer, "sigma", item->sigmas[i]);
    cloth_json_writer_string (writer, "unit", effect->parameters[i].unit);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);
  cloth_json_writer_number (writer, "p_value", item->p_value);
  cloth_json_writer_number (writer, "constancy_p_value",
      item->constancy_p_value);
  put_estimate (writer, "shrink", &item->shrink);
  if (item->group >= 0)
    cloth_json_writer_count (writer, "group", (guint64) item->group);
  else
    cloth_json_writer_string (writer, "group", NULL);
  cloth_json_writer_end_object (writer);
}

static void
put_sets (ClothJsonWriter * writer, const ClothGapResult * result)
{
  cloth_json_writer_begin_array (writer, "sets");
  for (guint i = 0; i < result->sets->len; i++) {
    const ClothGapSet *set = &g_array_index (result->sets, ClothGapSet, i);

    cloth_json_writer_begin_object (writer, NULL);
    cloth_json_writer_begin_array (writer, "effects");
    for (guint k = 0; k < set->effects->len; k++) {
      const ClothEffect *effect = set->effects->pdata[k];

      cloth_json_writer_string (writer, NULL, effect->id);
    }
    cloth_json_writer_end_array (writer);
    cloth_json_writer_string (writer, "rival", rival_names[set->rival]);
    cloth_json_writer_number (writer, "probability", set->probability);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);
  cloth_json_writer_begin_object (writer, "rivals");
  cloth_json_writer_number (writer, "none_acts", result->rivals.none_acts);
  cloth_json_writer_number (writer, "force_field", result->rivals.force_field);
  cloth_json_writer_number (writer, "displacement_field",
      result->rivals.displacement_field);
  cloth_json_writer_end_object (writer);
}

static void
put_groups (ClothJsonWriter * writer, const ClothGapResult * result)
{
  cloth_json_writer_begin_array (writer, "groups");
  for (guint g = 0; g < result->groups->len; g++) {
    const ClothGapGroup *group = &g_array_index (result->groups,
        ClothGapGroup, g);

    cloth_json_writer_begin_object (writer, NULL);
    cloth_json_writer_begin_array (writer, "effects");
    for (guint i = 0; i < result->effects->len; i++) {
      if (effect_at (result, i)->group == (gint) g)
        cloth_json_writer_string (writer, NULL,
            effect_at (result, i)->effect->id);
    }
    cloth_json_writer_end_array (writer);
    cloth_json_writer_string (writer, "experiment", group->experiment);
    cloth_json_writer_number (writer, "evidence", group->log_bayes_factor);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);
}

static void
put_untested (ClothJsonWriter * writer, const ClothGapResult * result)
{
  cloth_json_writer_begin_array (writer, "untested");
  for (guint i = 0; i < result->untested->len; i++) {
    const ClothGapUntested *item = &g_array_index (result->untested,
        ClothGapUntested, i);

    cloth_json_writer_begin_object (writer, NULL);
    cloth_json_writer_string (writer, "name", item->effect->id);
    cloth_json_writer_string (writer, "side",
        cloth_effect_side_name (item->effect->side));
    cloth_json_writer_string (writer, "reason", item->reason);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);
}

static void
put_limits (ClothJsonWriter * writer, const ClothGapResult * result)
{
  cloth_json_writer_begin_array (writer, "detection_limits");
  for (guint i = 0; i < result->detection_limits->len; i++) {
    const ClothGapLimit *limit = &g_array_index (result->detection_limits,
        ClothGapLimit, i);
    const ClothEffectParameter *parameter =
        &limit->effect->parameters[limit->parameter];
    g_autofree gchar *text = cloth_gap_limit_text (limit);

    cloth_json_writer_begin_object (writer, NULL);
    cloth_json_writer_string (writer, "effect", limit->effect->id);
    cloth_json_writer_string (writer, "side",
        cloth_effect_side_name (limit->effect->side));
    cloth_json_writer_string (writer, "parameter", parameter->name);
    cloth_json_writer_number (writer, "value", limit->value);
    cloth_json_writer_string (writer, "unit", parameter->unit);
    cloth_json_writer_string (writer, "text", text);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);
}

static void
put_patch (ClothJsonWriter * writer, const ClothGapResult * result)
{
  cloth_json_writer_begin_array (writer, "patch");
  for (guint i = 0; i < result->patch->len; i++) {
    const ClothGapPatch *item = &g_array_index (result->patch, ClothGapPatch,
        i);

    cloth_json_writer_begin_object (writer, NULL);
    cloth_json_writer_string (writer, "name", item->name);
    cloth_json_writer_string (writer, "text", item->text);
    cloth_json_writer_number (writer, "before", item->before);
    cloth_json_writer_number (writer, "after", item->after);
    cloth_json_writer_string (writer, "unit", item->unit);
    cloth_json_writer_number (writer, "factor", item->factor);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);
  cloth_json_writer_string (writer, "patch_simulator", result->patch_simulator);
}

static void
put_free_numbers (ClothJsonWriter * writer, const ClothGapResult * result)
{
  const gsize n = result->free_numbers->len;

  cloth_json_writer_begin_array (writer, "free_numbers");
  for (guint i = 0; i < n; i++) {
    const ClothGapFreeNumber *item = &g_array_index (result->free_numbers,
        ClothGapFreeNumber, i);

    cloth_json_writer_begin_object (writer, NULL);
    cloth_json_writer_string (writer, "name", item->name);
    cloth_json_writer_string (writer, "unit", item->unit);
    cloth_json_writer_number (writer, "value", item->value);
    cloth_json_writer_number (writer, "sigma", item->sigma);
    put_interval (writer, "range", item->low, item->high);
    cloth_json_writer_boolean (writer, "at_end", item->at_end);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);
  if (!result->free_correlation) {
    cloth_json_writer_string (writer, "free_correlation", NULL);
    return;
  }
  cloth_json_writer_begin_array (writer, "free_correlation");
  for (gsize i = 0; i < n; i++)
    cloth_json_writer_numbers (writer, NULL, result->free_correlation + i * n,
        n);
  cloth_json_writer_end_array (writer);
}

static void
put_bands (ClothJsonWriter * writer, const gchar * key, const gchar * from,
    const gchar * to, const GArray * bands)
{
  cloth_json_writer_begin_array (writer, key);
  for (guint i = 0; i < bands->len; i++) {
    const ClothGapBand *band = &g_array_index (bands, ClothGapBand, i);

    cloth_json_writer_begin_object (writer, NULL);
    cloth_json_writer_number (writer, from, band->from);
    cloth_json_writer_number (writer, to, band->to);
    cloth_json_writer_number (writer, "share", band->share);
    cloth_json_writer_number (writer, "after", band->after);
    cloth_json_writer_number (writer, "over_floor", band->over_floor);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);
}

static void
put_region (ClothJsonWriter * writer, const GArray * region)
{
  if (!region) {
    cloth_json_writer_string (writer, "region", NULL);
    return;
  }
  cloth_json_writer_begin_array (writer, "region");
  for (guint i = 0; i < region->len; i++)
    cloth_json_writer_count (writer, NULL, g_array_index (region, guint, i));
  cloth_json_writer_end_array (writer);
}

static void
put_where (ClothJsonWriter * writer, const ClothGapResult * result)
{
  static const gchar *const directions[] = { "warp", "weft", "normal" };

  cloth_json_writer_begin_object (writer, "where");
  cloth_json_writer_string (writer, "take", result->playback.take);
  cloth_json_writer_number (writer, "onset_s", result->onset_s);
  put_region (writer, result->region);
  cloth_json_writer_begin_object (writer, "directions");
  for (guint i = 0; i < 3; i++)
    cloth_json_writer_number (writer, directions[i], result->directions[i]);
  cloth_json_writer_end_object (writer);
  cloth_json_writer_number (writer, "static", result->still);
  put_bands (writer, "bands", "from_hz", "to_hz", result->bands);
  put_bands (writer, "waves", "from_per_m", "to_per_m", result->waves);
  cloth_json_writer_begin_array (writer, "stages");
  for (guint i = 0; i < result->stages->len; i++) {
    const ClothGapStage *stage = &g_array_index (result->stages,
        ClothGapStage, i);

    cloth_json_writer_begin_object (writer, NULL);
    cloth_json_writer_string (writer, "name", stage->name);
    cloth_json_writer_number (writer, "share", stage->share);
    cloth_json_writer_string (writer, "reason", stage->reason);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);
  cloth_json_writer_numbers (writer, "vertices", result->vertices,
      result->n_vertices);
  cloth_json_writer_numbers (writer, "gained", result->gained,
      result->n_vertices);
  cloth_json_writer_numbers (writer, "frames", result->frames,
      result->n_frames);
  cloth_json_writer_end_object (writer);
}

static void
put_provenance (ClothJsonWriter * writer, const ClothGapResult * result)
{
  cloth_json_writer_begin_array (writer, "inputs");
  for (guint i = 0; i < result->inputs->len; i++) {
    const ClothGapInput *item = &g_array_index (result->inputs,
        ClothGapInput, i);

    cloth_json_writer_begin_object (writer, NULL);
    cloth_json_writer_string (writer, "role", role_names[item->role]);
    cloth_json_writer_string (writer, "name", item->name);
    cloth_json_writer_string (writer, "sha256", item->sha256);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);
  cloth_json_writer_begin_array (writer, "thresholds");
  for (guint i = 0; i < result->thresholds->len; i++) {
    const ClothGapThreshold *item = &g_array_index (result->thresholds,
        ClothGapThreshold, i);

    cloth_json_writer_begin_object (writer, NULL);
    cloth_json_writer_string (writer, "name", item->name);
    cloth_json_writer_number (writer, "value", item->value);
    cloth_json_writer_string (writer, "unit", item->unit);
    cloth_json_writer_string (writer, "origin", origin_names[item->origin]);
    cloth_json_writer_string (writer, "reason", item->reason);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);
  cloth_json_writer_begin_array (writer, "failures");
  for (guint i = 0; i < result->failures->len; i++) {
    const ClothGapNote *item = &g_array_index (result->failures,
        ClothGapNote, i);

    cloth_json_writer_begin_object (writer, NULL);
    cloth_json_writer_string (writer, "run", item->name);
    cloth_json_writer_string (writer, "what", item->text);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);
  cloth_json_writer_number (writer, "seconds", result->seconds);
  cloth_json_writer_count (writer, "simulations", result->simulations);
  cloth_json_writer_count (writer, "seed", result->seed);
  cloth_json_writer_begin_array (writer, "versions");
  for (guint i = 0; i < result->versions->len; i++) {
    const ClothGapNote *item = &g_array_index (result->versions,
        ClothGapNote, i);

    cloth_json_writer_begin_object (writer, NULL);
    cloth_json_writer_string (writer, "name", item->name);
    cloth_json_writer_string (writer, "version", item->text);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);
}

/* @result: a result
 *
 * docs/gap.schema.json describes it. `<`, `>` and `&` are written as escapes.
 *
 * Returns: (transfer full): the text of gap.json
 */
gchar *
cloth_gap_result_to_json (const ClothGapResult * result)
{
  g_autoptr (ClothJsonWriter) writer = cloth_json_writer_new ();
  g_autofree gchar *summary = cloth_gap_result_summary (result);

  cloth_json_writer_begin_object (writer, NULL);
  cloth_json_writer_count (writer, "version", 2);
  cloth_json_writer_string (writer, "verdict",
      cloth_gap_verdict_name (result->verdict));
  cloth_json_writer_string (writer, "summary", summary);
  cloth_json_writer_string (writer, "reason", result->reason);
  cloth_json_writer_begin_array (writer, "notes");
  for (guint i = 0; i < result->notes->len; i++)
    cloth_json_writer_string (writer, NULL, result->notes->pdata[i]);
  cloth_json_writer_end_array (writer);
  put_estimate (writer, "gap_before", &result->gap_before);
  put_estimate (writer, "gap_after", &result->gap_after);
  put_estimate (writer, "noise_floor", &result->noise_floor);
  put_estimate (writer, "shrink", &result->shrink);
  cloth_json_writer_number (writer, "rest_p_value", result->rest_p_value);
  cloth_json_writer_string (writer, "held_out",
      result->held_out_takes ? "takes" : "blocks");
  put_takes (writer, result);
  cloth_json_writer_boolean (writer, "has_simulated", result->has_simulated);
  put_shrink (writer, "predicted_shrink", &result->predicted_shrink);
  put_shrink (writer, "measured_shrink", &result->measured_shrink);
  cloth_json_writer_begin_array (writer, "effects");
  for (guint i = 0; i < result->effects->len; i++)
    put_effect (writer, effect_at (result, i));
  cloth_json_writer_end_array (writer);
  put_sets (writer, result);
  put_groups (writer, result);
  put_untested (writer, result);
  put_limits (writer, result);
  put_patch (writer, result);
  put_free_numbers (writer, result);
  put_where (writer, result);
  put_provenance (writer, result);
  cloth_json_writer_end_object (writer);
  return cloth_json_writer_finish (writer);
}

/* @result: a result
 * @path: where gap.json shall be
 * @error: #GIOErrorEnum
 *
 * The file appears whole or not at all.
 *
 * Returns: %TRUE when it is there
 */
gboolean
cloth_gap_result_write_json (const ClothGapResult * result,
    const gchar * path, GError ** error)
{
  g_autofree gchar *text = cloth_gap_result_to_json (result);

  return cloth_file_write_text (path, text, error);
}

/* @result: a result
 * @path: where report.html shall be
 * @error: #GIOErrorEnum
 *
 * Writes a page that shows @result. It needs no other file and no network. It appears
 * whole or not at all. Long or fine playbacks are thinned: the file has at most 9 MB.
 *
 * Returns: %TRUE when it is there
 */
gboolean
cloth_gap_report_write (const ClothGapResult * result, const gchar * path,
    GError ** error)
{
  g_autofree gchar *json = cloth_gap_result_to_json (result);
  g_autofree gchar *arrays = cloth_gap_report_arrays (result);
  g_autofree gchar *summary = cloth_gap_result_summary (result);
  const ClothPagePart parts[] = { {"gap", json}, {"arrays", arrays} };

  return cloth_page_write (path, "report", summary, "gap.json says the same.",
      parts, G_N_ELEMENTS (parts), error);
}

/* Without a model none of an earlier diagnosis stays. */
static gboolean
write_model (const ClothModel * model, const gchar * folder, GError ** error)
{
  g_autofree gchar *path = g_build_filename (folder, "fitted.json", NULL);
  g_autofree gchar *text = model ? cloth_model_to_json (model) : NULL;

  if (text)
    return cloth_file_write_text (path, text, error);
  g_unlink (path);
  return TRUE;
}

/* Beside the take's own rig.json, which stays, should this be its folder. */
static gboolean
write_rig (const ClothRig * rig, const gchar * folder, GError ** error)
{
  g_autofree gchar *path = g_build_filename (folder, "rig-refined.json", NULL);

  if (rig)
    return cloth_rig_save (rig, path, error);
  g_unlink (path);
  return TRUE;
}

/* @result: what was found
 * @folder: where to; made with its parents when it is not there
 * @error: #GIOErrorEnum
 *
 * Writes gap.json and report.html, and, where something was fitted, fitted.json: the model
 * with it; where cameras had faults rig-refined.json, the rig without them. Each is written whole
 * or not at all.
 *
 * Returns: %TRUE when all are there
 */
gboolean
cloth_gap_result_write (const ClothGapResult * result, const gchar * folder,
    GError ** error)
{
  g_autofree gchar *json = g_build_filename (folder, "gap.json", NULL);
  g_autofree gchar *report = g_build_filename (folder, "report.html", NULL);

  return cloth_folder_make (folder, error) &&
      write_model (result->model, folder, error) &&
      write_rig (result->rig, folder, error) &&
      cloth_gap_report_write (result, report, error) &&
      cloth_gap_result_write_json (result, json, error);
}
