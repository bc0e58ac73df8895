/* What a diagnosis says: its sentence, its JSON, and bytes that nobody vouches for.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/report/patch.h"
#include "gst/gap/report/report.h"

#include <math.h>
#include <string.h>

#include "gst/file/json.h"
#include "gst/file/jsonwriter.h"

static const ClothEffect air_drag = {.id = "air_drag",.side =
      CLOTH_EFFECT_PHYSICS,.n_parameters = 1,.parameters =
      {{.name = "coefficient",.unit = "1"}}
};

static const ClothEffect clamp_slip = {.id = "clamp_slip",.side =
      CLOTH_EFFECT_CLAMP
};

static const ClothEffect wind = {.id = "wind",.side = CLOTH_EFFECT_PHYSICS };

static void
assert_summary (const ClothGapResult * result, const gchar * expected)
{
  g_autofree gchar *summary = cloth_gap_result_summary (result);

  g_assert_cmpstr (summary, ==, expected);
}

/* The sentence of the specification, word by word. */
static void
test_summary (void)
{
  g_autoptr (ClothGapResult) result = cloth_gap_result_new ();
  ClothGapEffect *effect;

  assert_summary (result, "Undecidable: no reason was given.");
  result->reason = g_strdup ("the cloth hangs still; film a motion.");
  assert_summary (result, "Undecidable: the cloth hangs still; film a motion.");
  g_clear_pointer (&result->reason, g_free);

  result->verdict = CLOTH_GAP_NO_GAP;
  result->held_out_takes = TRUE;
  assert_summary (result, "No gap.");
  result->gap_before.value = 0.0031;
  assert_summary (result, "No gap: 3.1 mm on an unseen take.");
  result->noise_floor.value = 0.0015;
  assert_summary (result, "No gap: 3.1 mm on an unseen take, 2.1× the floor.");

  result->verdict = CLOTH_GAP_UNEXPLAINED;
  assert_summary (result,
      "Gap 3.1 mm, 2.1× the floor. No effect of the library explains it.");
  result->reason = g_strdup ("The clamps are elsewhere.");
  assert_summary (result,
      "Gap 3.1 mm, 2.1× the floor. No effect of the library "
      "explains it. The clamps are elsewhere.");
  g_clear_pointer (&result->reason, g_free);

  result->verdict = CLOTH_GAP_EXPLAINED;
  effect = cloth_gap_result_add_effect (result, &air_drag);
  effect->accepted = TRUE;
  assert_summary (result, "Gap 3.1 mm, 2.1× the floor. Air drag was added.");
  result->gap_after.value = 0.0016;
  assert_summary (result,
      "Gap 3.1 mm, 2.1× the floor. Air drag takes it to 1.6 mm.");
  result->shrink = (ClothGapEstimate) {
  0.84, 0.76, 0.90};
  assert_summary (result, "Gap 3.1 mm, 2.1× the floor. Air drag explains "
      "84% [76, 90] on an unseen take.");
  result->held_out_takes = FALSE;
  result->shrink.low = NAN;
  assert_summary (result, "Gap 3.1 mm, 2.1× the floor. Air drag explains "
      "84% on held-out time blocks.");

  effect = cloth_gap_result_add_effect (result, &wind);
  effect->group = 0;
  g_array_index (result->effects, ClothGapEffect, 0).group = 0;
  result->verdict = CLOTH_GAP_AMBIGUOUS;
  assert_summary (result, "Gap 3.1 mm, 2.1× the floor. Air drag (or wind) "
      "explains 84% on held-out time blocks; these data can't tell which.");

  effect = cloth_gap_result_add_effect (result, &clamp_slip);
  effect->accepted = TRUE;
  result->verdict = CLOTH_GAP_UNEXPLAINED;
  result->gap_after.value = 0.002;
  assert_summary (result, "Gap 3.1 mm, 2.1× the floor. Air drag (or wind) "
      "and clamp slip explain 84% on held-out time blocks; 2.0 mm remain that "
      "no effect of the library explains.");
}

static JsonObject *
parse (const gchar * json, JsonParser ** parser)
{
  g_autoptr (GError) error = NULL;

  *parser = cloth_json_parse (json, strlen (json), &error);
  g_assert_no_error (error);
  return json_node_get_object (json_parser_get_root (*parser));
}

static void
assert_null (JsonObject * object, const gchar * key)
{
  g_assert_true (json_object_has_member (object, key));
  g_assert_true (json_object_get_null_member (object, key));
}

static JsonObject *
first_of (JsonObject * object, const gchar * list)
{
  return json_array_get_object_element (json_object_get_array_member (object,
          list), 0);
}

/* Nothing known: every key is there, and none claims a number. */
static void
test_empty (void)
{
  g_autoptr (ClothGapResult) result = cloth_gap_result_new ();
  g_autofree gchar *json = cloth_gap_result_to_json (result);
  g_autoptr (JsonParser) parser = NULL;
  JsonObject *root = parse (json, &parser), *where;
  static const gchar *const lists[] = { "effects", "sets", "takes",
    "detection_limits", "patch", "free_numbers"
  };

  g_assert_cmpstr (json_object_get_string_member (root, "verdict"), ==,
      "undecidable");
  assert_null (root, "reason");
  assert_null (json_object_get_object_member (root, "gap_before"), "value");
  assert_null (json_object_get_object_member (root, "gap_before"), "interval");
  assert_null (root, "rest_p_value");
  where = json_object_get_object_member (root, "where");
  assert_null (where, "vertices");
  assert_null (where, "onset_s");
  assert_null (where, "region");
  assert_null (json_object_get_object_member (where, "directions"), "warp");
  for (guint i = 0; i < G_N_ELEMENTS (lists); i++)
    g_assert_cmpuint (json_array_get_length (json_object_get_array_member
            (root, lists[i])), ==, 0);
  assert_null (root, "takes_agree_p_value");
  assert_null (root, "patch_simulator");
  assert_null (root, "free_correlation");
  assert_null (json_object_get_object_member (root, "rivals"), "none_acts");
  assert_null (json_object_get_object_member (json_object_get_object_member
          (root, "measured_shrink"), "free"), "value");
  g_assert_false (json_object_get_boolean_member (root, "has_simulated"));
}

/* All that can be unknown of what is there is null, and nothing else is wrong with it. */
static void
test_unknown (void)
{
  g_autoptr (ClothGapResult) result = cloth_gap_result_new ();
  g_autofree gchar *json = NULL;
  g_autoptr (JsonParser) parser = NULL;
  JsonObject *root, *item;

  cloth_gap_result_add_take (result, CLOTH_GAP_HOLD_OUT, "");
  cloth_gap_result_add_set (result, CLOTH_GAP_RIVAL_DISPLACEMENT_FIELD, NAN);
  cloth_gap_result_add_limit (result, &air_drag, 0, NAN);
  cloth_gap_result_add_patch (result, "pressure", "pressure 3 Pa", 0, 3, "Pa");
  cloth_gap_result_add_patch (result, "wind", "add a wind", NAN, NAN, "m/s");
  cloth_gap_result_add_patch (result, "mass", "mass × −0.5", -2, 1, "kg");
  cloth_gap_result_add_free_number (result, "shear", "N/m")->low = 1;
  json = cloth_gap_result_to_json (result);
  root = parse (json, &parser);
  item = first_of (root, "takes");
  g_assert_cmpstr (json_object_get_string_member (item, "role"), ==,
      "hold_out");
  assert_null (json_object_get_object_member (item, "free_floor"), "value");
  item = first_of (root, "sets");
  g_assert_cmpstr (json_object_get_string_member (item, "rival"), ==,
      "displacement_field");
  assert_null (item, "probability");
  assert_null (first_of (root, "detection_limits"), "value");
  item = first_of (root, "patch");
  g_assert_cmpfloat (json_object_get_double_member (item, "before"), ==, 0);
  assert_null (item, "factor");
  item =
      json_array_get_object_element (json_object_get_array_member (root,
          "patch"), 1);
  assert_null (item, "after");
  assert_null (item, "factor");
  item =
      json_array_get_object_element (json_object_get_array_member (root,
          "patch"), 2);
  g_assert_cmpfloat (json_object_get_double_member (item, "factor"), ==, -0.5);
  item = first_of (root, "free_numbers");
  assert_null (item, "range");
  assert_null (item, "sigma");
}

/* Half an interval is none; infinities are not numbers of JSON. */
static void
test_numbers (void)
{
  g_autoptr (ClothGapResult) result = cloth_gap_result_new ();
  g_autofree gchar *json = NULL;
  g_autoptr (JsonParser) parser = NULL;
  JsonObject *root, *gap;
  JsonArray *vertices;

  result->gap_before = (ClothGapEstimate) {
  0.00312345678, 0.003, INFINITY};
  result->gap_after = (ClothGapEstimate) {
  -INFINITY, NAN, 1};
  result->n_vertices = 3;
  result->vertices = g_new (gdouble, 3);
  result->vertices[0] = 0.25;
  result->vertices[1] = NAN;
  result->vertices[2] = -0.0;
  result->seed = G_MAXUINT64;
  json = cloth_gap_result_to_json (result);
  g_assert_nonnull (strstr (json, "\"seed\": 18446744073709551615,"));
  g_assert_nonnull (strstr (json, "\"vertices\": [0.25, null, 0],"));
  /* Readers whose integers end at 2⁶³ would stumble over it. */
  result->seed = 7;
  g_free (json);
  json = cloth_gap_result_to_json (result);
  root = parse (json, &parser);
  gap = json_object_get_object_member (root, "gap_before");
  g_assert_cmpfloat (json_object_get_double_member (gap, "value"), ==,
      0.003123457);
  assert_null (gap, "interval");
  gap = json_object_get_object_member (root, "gap_after");
  assert_null (gap, "value");
  assert_null (gap, "interval");
  vertices = json_object_get_array_member (json_object_get_object_member (root,
          "where"), "vertices");
  g_assert_true (json_array_get_null_element (vertices, 1));
}

/* Any bytes come back as text, and none of them ends a script. */
static void
test_strings (void)
{
  static const gchar *const texts[][2] = {
    {"", ""},
    {"plain", "plain"},
    {"\"quoted\\\"", "\"quoted\\\""},
    {"</script><!--&", "</script><!--&"},
    {"\n\t\x01\x7f", "\n\t\x01\x7f"},
    {"\xe2\x80\xa8\xe2\x80\xa9", "\xe2\x80\xa8\xe2\x80\xa9"},
    {"\xf0\x9f\xa7\xb5 Stoff, 布", "\xf0\x9f\xa7\xb5 Stoff, 布"},
    {"\xff\xc0half \xe2\x82", "\xef\xbf\xbd\xef\xbf\xbdhalf "
          "\xef\xbf\xbd\xef\xbf\xbd"},
    {"\xed\xa0\x80", "\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd"},
  };

  for (guint i = 0; i < G_N_ELEMENTS (texts); i++) {
    g_autoptr (ClothJsonWriter) writer = cloth_json_writer_new ();
    g_autofree gchar *json = NULL;
    g_autoptr (JsonParser) parser = NULL;
    JsonObject *root;

    cloth_json_writer_begin_object (writer, NULL);
    cloth_json_writer_string (writer, "text", texts[i][0]);
    cloth_json_writer_begin_array (writer, "none");
    cloth_json_writer_end_array (writer);
    cloth_json_writer_begin_object (writer, "inner");
    cloth_json_writer_boolean (writer, "yes", TRUE);
    cloth_json_writer_end_object (writer);
    cloth_json_writer_end_object (writer);
    json = cloth_json_writer_finish (writer);
    g_assert_null (strpbrk (json, "<>&\x01\x7f\t"));
    g_assert_null (strstr (json, "\xe2\x80\xa8"));
    root = parse (json, &parser);
    g_assert_cmpstr (json_object_get_string_member (root, "text"), ==,
        texts[i][1]);
    g_assert_true (json_object_get_boolean_member
        (json_object_get_object_member (root, "inner"), "yes"));
  }
}

/* The comma of other languages never gets into the numbers. */
static void
test_layout (void)
{
  const gdouble numbers[] = { 1, 0.1, 1e-12, 123456789, NAN };
  g_autoptr (ClothJsonWriter) writer = cloth_json_writer_new ();
  g_autofree gchar *json = NULL;

  cloth_json_writer_begin_object (writer, NULL);
  cloth_json_writer_numbers (writer, "list", numbers, 5);
  cloth_json_writer_begin_array (writer, "rows");
  cloth_json_writer_numbers (writer, NULL, numbers, 0);
  cloth_json_writer_string (writer, NULL, NULL);
  cloth_json_writer_end_array (writer);
  cloth_json_writer_end_object (writer);
  json = cloth_json_writer_finish (writer);
  g_assert_cmpstr (json, ==, "{\n"
      "  \"list\": [1, 0.1, 1e-12, 123456789, null],\n"
      "  \"rows\": [\n    [],\n    null\n  ]\n}\n");
}

static void
assert_change (const gchar * name, gdouble before, gdouble after,
    const gchar * unit, const gchar * expected)
{
  g_autofree gchar *text = cloth_gap_change_text (name, before, after, unit);

  g_assert_cmpstr (text, ==, expected);
}

/* Plain numbers, and no ratio where there is none. */
static void
test_changes (void)
{
  assert_change ("areal_density", 0.2, 0.122, "kg/m²",
      "areal density × 0.61");
  assert_change ("stretch.warp", 100, 2000, "N/m", "stretch warp × 20");
  assert_change ("damping.mass", 0, 0.3, "1/s", "damping mass 0 → 0.3 1/s");
  assert_change ("damping.mass", 0.3, 0, "1/s", "damping mass 0.3 → 0 1/s");
  assert_change ("effects.air_drag.coefficient", NAN, 1.14, "1",
      "air drag coefficient 1.14");
  assert_change ("effects.wind.x", -0.5, -1, "m/s",
      "wind x −0.5 → −1 m/s");
  assert_change ("effects.extrinsic_drift.tilt", NAN, G_PI / 90, "rad",
      "extrinsic drift tilt 2°");
  assert_change ("effects.self_contact.thickness", NAN, 0.0015, "m",
      "self contact thickness 1.5 mm");
}

static void
assert_limit (ClothEffectParameter parameter, gdouble value,
    const gchar * expected)
{
  ClothEffect effect = {.id = "clamp_slip",.n_parameters = 1,
    .parameters = {parameter}
  };
  const ClothGapLimit limit = { &effect, 0, value };
  g_autofree gchar *text = cloth_gap_limit_text (&limit);

  g_assert_cmpstr (text, ==, expected);
}

/* On both sides of what an effect is nothing at, or on the one that nature has. */
static void
test_limits (void)
{
  assert_limit ((ClothEffectParameter) {
      .name = "z",.unit = "m"}, 0.0021, "clamp slip: z beyond ±2.1 mm");
  assert_limit ((ClothEffectParameter) {
      .name = "z",.unit = "m"}, 0.21, "clamp slip: z beyond ±0.21 m");
  assert_limit ((ClothEffectParameter) {
      .name = "rate",.unit = "1/s",.one_sided =
        TRUE}, 0.4, "clamp slip: rate above 0.4 1/s");
  assert_limit ((ClothEffectParameter) {
      .name = "factor",.unit = "1",.null_value = 1,.one_sided = TRUE}, 0.4,
      "clamp slip: factor above 1.4");
  assert_limit ((ClothEffectParameter) {
      .name = "factor",.unit = "1",.null_value =
        1}, 0.4, "clamp slip: factor below 0.6 or above 1.4");
  assert_limit ((ClothEffectParameter) {
      .name = "own_way",.unit = "1"}, NAN,
      "clamp slip: unseen, whatever its own way");
  assert_limit ((ClothEffectParameter) {
      .name = "own_way",.unit = "1"},
      INFINITY, "clamp slip: unseen, whatever its own way");
}

static const ClothGapPatch *
patch_at (const ClothGapResult * result, guint i)
{
  g_assert_cmpuint (i, <, result->patch->len);
  return &g_array_index (result->patch, ClothGapPatch, i);
}

static void
assert_patch (const ClothGapResult * result, guint i, const gchar * name,
    gdouble before, gdouble after, const gchar * text)
{
  const ClothGapPatch *patch = patch_at (result, i);

  g_assert_cmpstr (patch->name, ==, name);
  g_assert_cmpstr (patch->text, ==, text);
  g_assert_cmpint (isnan (patch->before), ==, isnan (before));
  if (!isnan (before))
    g_assert_cmpfloat (patch->before, ==, before);
  g_assert_cmpfloat (patch->after, ==, after);
}

/* The given model with the patch is the fitted one. */
static void
test_patch (void)
{
  g_autoptr (ClothGapResult) result = cloth_gap_result_new ();
  g_autoptr (ClothModel) given = cloth_model_new ();
  g_autofree gchar *patched = NULL, *fitted = NULL;
  static const gchar *const names[] = { "shear", "bending.warp",
    "damping.mass"
  };
  const gdouble wind[] = { 0, 2, 0, 1.5 };

  for (guint i = 0; i < G_N_ELEMENTS (names); i++) {
    ClothModelFree entry = { g_strdup (names[i]), {1e-6, 1000}
    };

    g_array_append_val (given->free, entry);
  }
  given->damping_mass = 0;
  cloth_model_set_effect (given, cloth_effect_find ("wind"), wind);
  result->model = cloth_model_copy (given);
  cloth_gap_result_fill_patch (result, given);
  g_assert_cmpuint (result->patch->len, ==, 0);

  cloth_model_set (result->model, "effects.wind.y", 1, NULL);
  cloth_model_set (result->model, "effects.air_drag.coefficient", 0.8, NULL);
  cloth_model_set (result->model, "shear", 60, NULL);
  cloth_model_set (result->model, "damping.mass", 0.25, NULL);
  cloth_gap_result_fill_patch (result, given);
  g_assert_cmpuint (result->patch->len, ==, 4);
  assert_patch (result, 0, "effects.wind.y", 2, 1, "wind y × 0.5");
  assert_patch (result, 1, "effects.air_drag.coefficient", NAN, 0.8,
      "air drag coefficient 0.8");
  assert_patch (result, 2, "shear", 40, 60, "shear × 1.5");
  assert_patch (result, 3, "damping.mass", 0, 0.25,
      "damping mass 0 → 0.25 1/s");
  g_assert_cmpfloat (patch_at (result, 2)->factor, ==, 1.5);
  g_assert_true (isnan (patch_at (result, 1)->factor));
  g_assert_cmpstr (patch_at (result, 2)->unit, ==, "N/m");
  /* the user's simulator has no numbers of ours, and what the model had was fitted to what it made */
  result->has_simulated = TRUE;
  cloth_gap_result_fill_patch (result, given);
  g_assert_cmpuint (result->patch->len, ==, 5);
  assert_patch (result, 4, "effects.air_drag.coefficient", NAN, 0.8,
      "air drag coefficient 0.8");
  for (guint i = 0; i < 4; i++)
    g_assert_true (cloth_model_set (given, patch_at (result, i)->name,
            patch_at (result, i)->after, NULL));
  patched = cloth_model_to_json (given);
  fitted = cloth_model_to_json (result->model);
  g_assert_cmpstr (patched, ==, fitted);
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/gapresult/summary", test_summary);
  g_test_add_func ("/gapresult/empty", test_empty);
  g_test_add_func ("/gapresult/unknown", test_unknown);
  g_test_add_func ("/gapresult/numbers", test_numbers);
  g_test_add_func ("/gapresult/strings", test_strings);
  g_test_add_func ("/gapresult/layout", test_layout);
  g_test_add_func ("/gapresult/changes", test_changes);
  g_test_add_func ("/gapresult/limits", test_limits);
  g_test_add_func ("/gapresult/patch", test_patch);
  return g_test_run ();
}
