/* Models: values by name, model.json there and back, everything that cannot be.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/model.h"

#include <math.h>
#include <string.h>

#include "gst/effect/effect.h"
#include "tests/core/meshpeer.h"

static ClothModel *
parse (const gchar * text, GError ** error)
{
  return cloth_model_parse (text, strlen (text), error);
}

/* The defaults that docs/formats.md promises. */
static void
test_defaults (void)
{
  static const struct
  {
    const gchar *name;
    gdouble value;
  } defaults[] = {
    {"areal_density", 0.187}, {"stretch.warp", 100}, {"stretch.weft", 100},
    {"shear", 40}, {"bending.warp", 2e-5}, {"bending.weft", 2e-5},
    {"damping.mass", 0.2}, {"damping.stiffness", 1e-3},
    {"compression_ratio", 0.02}, {"air_density", 1.2}, {"time_step", 0},
    {"effects.air_drag.coefficient", 0}, {"effects.gravity_scale.factor", 1},
  };
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothModel) model = parse ("{\"version\":1}", &error);

  g_assert_no_error (error);
  g_assert_cmpint (model->force_model, ==, CLOTH_FORCE_MEMBRANE);
  g_assert_cmpint (model->integrator, ==, CLOTH_INTEGRATOR_EXPLICIT);
  g_assert_cmpuint (model->effects->len, ==, 0);
  g_assert_cmpuint (model->free->len, ==, 0);
  for (guint i = 0; i < G_N_ELEMENTS (defaults); i++) {
    gdouble value;

    g_assert_true (cloth_model_get (model, defaults[i].name, &value, &error));
    g_assert_cmpfloat (value, ==, defaults[i].value);
  }
}

#define FULL "{\"version\":1,\"force_model\":\"mass-spring\"," \
    "\"areal_density\":0.3,\"stretch\":{\"warp\":1,\"weft\":2},\"shear\":3," \
    "\"bending\":{\"warp\":4e-5,\"weft\":5e-5}," \
    "\"damping\":{\"mass\":6,\"stiffness\":0.007},\"compression_ratio\":0.08," \
    "\"air_density\":1.09,\"integrator\":\"implicit\",\"time_step\":0.001," \
    "\"effects\":{\"wind\":{\"x\":-1.25,\"turbulence\":0.1},\"air_drag\":{}}," \
    "\"free\":[{\"name\":\"shear\",\"range\":[1,5]}," \
    "{\"name\":\"effects.wind.y\",\"range\":[-2,2]}]}"

static void
check_full (const ClothModel * model)
{
  static const struct
  {
    const gchar *name;
    gdouble value;
  } wanted[] = {
    {"areal_density", 0.3}, {"stretch.warp", 1}, {"stretch.weft", 2},
    {"shear", 3}, {"bending.warp", 4e-5}, {"bending.weft", 5e-5},
    {"damping.mass", 6}, {"damping.stiffness", 0.007},
    {"compression_ratio", 0.08}, {"air_density", 1.09}, {"time_step", 0.001},
    {"effects.wind.x", -1.25}, {"effects.wind.y", 0}, {"effects.wind.z", 0},
    {"effects.wind.coefficient", 1.5}, {"effects.wind.turbulence", 0.1},
    {"effects.air_drag.coefficient", 0},
  };
  const ClothModelFree *entry;

  g_assert_cmpint (model->force_model, ==, CLOTH_FORCE_MASS_SPRING);
  g_assert_cmpint (model->integrator, ==, CLOTH_INTEGRATOR_IMPLICIT);
  g_assert_cmpuint (model->effects->len, ==, 2);
  for (guint i = 0; i < G_N_ELEMENTS (wanted); i++) {
    gdouble value;

    g_assert_true (cloth_model_get (model, wanted[i].name, &value, NULL));
    g_assert_cmpfloat (value, ==, wanted[i].value);
  }
  g_assert_cmpuint (model->free->len, ==, 2);
  entry = &g_array_index (model->free, ClothModelFree, 1);
  g_assert_cmpstr (entry->name, ==, "effects.wind.y");
  g_assert_cmpfloat (entry->range[0], ==, -2);
  g_assert_cmpfloat (entry->range[1], ==, 2);
}

static void
test_full (void)
{
  g_autoptr (GError) error = NULL;
  g_autoptr (ClothModel) model = parse (FULL, &error);
  g_autoptr (ClothModel) copy = NULL, again = NULL;
  g_autofree gchar *json = NULL;

  g_assert_no_error (error);
  check_full (model);
  g_assert_true (cloth_model_check (model, &error));
  copy = cloth_model_copy (model);
  /* An effect that is there is changed, not added. */
  cloth_model_set_effect (model, cloth_effect_find ("wind"), NULL);
  g_assert_cmpuint (model->effects->len, ==, 2);
  g_assert_true (cloth_model_set (model, "shear", 99, &error));
  check_full (copy);
  json = cloth_model_to_json (copy);
  again = parse (json, &error);
  g_assert_no_error (error);
  check_full (again);
}

/* What we write is JSON to others, and keeps every bit of a number. */
static void
test_exact (void)
{
  static const gdouble numbers[] =
      { 0.1, 1. / 3, 2e-5, 123456789.0 / 1e4, 5e-324, 0.30000000000000004 };
  g_autoptr (ClothModel) model = cloth_model_new ();
  g_autofree gchar *json = NULL;

  for (guint i = 0; i < G_N_ELEMENTS (numbers); i++) {
    g_autoptr (ClothModel) again = NULL;
    g_autofree gchar *text = NULL;

    model->stretch_warp = numbers[i];
    text = cloth_model_to_json (model);
    again = parse (text, NULL);
    g_assert_nonnull (again);
    g_assert_cmpfloat (again->stretch_warp, ==, numbers[i]);
  }
  cloth_model_set (model, "effects.wind.x", -1. / 3, NULL);
  cloth_model_set (model, "stretch.warp", 2e-5, NULL);
  json = cloth_model_to_json (model);
  /* No more digits than it takes. */
  g_assert_nonnull (strstr (json, "\"warp\": 2e-05"));
  scratch_begin ();
  scratch_write ("model.json", json, -1);
  peer_run ("import json\nm=json.load(open('model.json'))\n"
      "assert m['version']==1 and m['force_model']=='membrane'\n"
      "assert m['effects']['wind']['x']==-1/3 and m['free']==[]\n"
      "assert m['damping']=={'mass':.2,'stiffness':.001}\n"
      "assert m['areal_density']==.187 and m['integrator']=='explicit'\n");
  scratch_end ();
}

static void
test_every_parameter (void)
{
  guint n;
  const ClothEffect *const *table = cloth_effect_table (&n);
  g_autoptr (ClothModel) model = cloth_model_new ();
  g_autoptr (GError) error = NULL;

  for (guint i = 0; i < n; i++) {
    for (guint k = 0; k < table[i]->n_parameters; k++) {
      const ClothEffectParameter *parameter = &table[i]->parameters[k];
      g_autofree gchar *name = g_strdup_printf ("effects.%s.%s",
          table[i]->id, parameter->name);
      gdouble value, range[2];

      g_assert_true (cloth_model_get (model, name, &value, &error));
      g_assert_cmpfloat (value, ==, parameter->null_value);
      g_assert_true (cloth_model_get_range (name, range, &error));
      g_assert_cmpfloat (range[0], ==, parameter->min);
      g_assert_true (cloth_model_set (model, name, parameter->max, &error));
      g_assert_true (cloth_model_get (model, name, &value, &error));
      g_assert_cmpfloat (value, ==, parameter->max);
      g_assert_false (cloth_model_set (model, name, parameter->max +
              (parameter->max - parameter->min), &error));
      g_assert_error (error, CLOTH_MODEL_ERROR, CLOTH_MODEL_ERROR_VALUE);
      g_assert_nonnull (strstr (error->message, name));
      g_clear_error (&error);
      g_assert_true (cloth_model_get (model, name, &value, &error));
      g_assert_cmpfloat (value, ==, parameter->max);
    }
  }
  g_assert_cmpuint (model->effects->len, ==, n);
}

static void
test_refused_names (void)
{
  static const gchar *const names[] = { "", "stretch", "stretch.", "warp",
    "Stretch.warp", "stretch.warp.x", "force_model", "version", "effects",
    "effects.", "effects.wind", "effects.wind.", "effects.wind.w",
    "effects.breeze.x", "effects..x", "effects.wind.x.y", "free"
  };
  g_autoptr (ClothModel) model = cloth_model_new ();

  for (guint i = 0; i < G_N_ELEMENTS (names); i++) {
    g_autoptr (GError) get = NULL, set = NULL;
    gdouble value;

    g_assert_false (cloth_model_get (model, names[i], &value, &get));
    g_assert_error (get, CLOTH_MODEL_ERROR, CLOTH_MODEL_ERROR_NAME);
    g_assert_false (cloth_model_set (model, names[i], 1, &set));
    g_assert_error (set, CLOTH_MODEL_ERROR, CLOTH_MODEL_ERROR_NAME);
  }
  g_assert_cmpuint (model->effects->len, ==, 0);
}

#define V "{\"version\":1,"

/* What the message must name. */
static const struct
{
  const gchar *json, *key;
} refused[] = {
  {"", ""}, {"[]", ""}, {"{", ""}, {"{}", "version"}, {"null", ""},
  {"{\"version\":2}", "version"}, {"{\"version\":\"1\"}", "version"},
  {V "\"stiffness\":1}", "stiffness"},
  {V "\"force_model\":\"fem\"}", "“fem”"},
  {V "\"force_model\":1}", "force_model"},
  {V "\"integrator\":\"verlet\"}", "“verlet”"},
  {V "\"areal_density\":0}", "“areal_density” is 0"},
  {V "\"areal_density\":-1}", "“areal_density” is -1"},
  {V "\"areal_density\":\"0.2\"}", "areal_density"},
  {V "\"areal_density\":1e999}", "areal_density"},
  {V "\"stretch\":100}", "“stretch”"},
  {V "\"stretch\":{\"warp\":-5}}", "“stretch.warp” is -5"},
  {V "\"stretch\":{\"warp\":null}}", "“stretch.warp”"},
  {V "\"stretch\":{\"wrap\":5}}", "“stretch.wrap”"},
  {V "\"stretch\":{\"warp\":[5]}}", "“stretch.warp”"},
  {V "\"stretch\":{\"warp\":1,\"warp\":2}}", ""},
  {V "\"shear\":{\"warp\":5}}", "“shear”"},
  {V "\"shear\":-1e-9}", "“shear” is -1e-09"},
  {V "\"bending\":{\"weft\":-2e-5}}", "“bending.weft” is -2e-05"},
  {V "\"damping\":{\"mass\":-1}}", "“damping.mass” is -1"},
  {V "\"damping\":{\"stiffness\":2}}", "“damping.stiffness” is 2"},
  {V "\"compression_ratio\":1.5}", "“compression_ratio” is 1.5"},
  {V "\"air_density\":-1.2}", "“air_density” is -1.2"},
  {V "\"time_step\":-0.001}", "“time_step” is -0.001"},
  {V "\"effects\":[]}", "effects"},
  {V "\"effects\":{\"breeze\":{}}}", "“effects.breeze”"},
  {V "\"effects\":{\"wind\":3}}", "“effects.wind”"},
  {V "\"effects\":{\"wind\":{\"u\":3}}}", "“effects.wind.u”"},
  {V "\"effects\":{\"wind\":{\"x\":300}}}", "“effects.wind.x” is 300"},
  {V "\"effects\":{\"air_drag\":{\"coefficient\":-0.1}}}",
      "“effects.air_drag.coefficient” is -0.1"},
  {V "\"effects\":{\"wind\":{\"x\":\"3\"}}}", "“effects.wind.x”"},
  {V "\"free\":{}}", "free"}, {V "\"free\":[3]}", "free"},
  {V "\"free\":[{\"name\":\"shear\"}]}", "free"},
  {V "\"free\":[{\"range\":[1,2]}]}", "free"},
  {V "\"free\":[{\"name\":3,\"range\":[1,2]}]}", "“name”"},
  {V "\"free\":[{\"name\":\"shear\",\"range\":3}]}", "item 0 of “free”"},
  {V "\"free\":[{\"name\":\"shear\",\"range\":[null,1]}]}", "“free”"},
  {V "\"free\":[{\"name\":\"shear\",\"range\":[0,1e99]}]}",
      "“shear” is 1e+99"},
  {V "\"free\":[{\"name\":\"shear\",\"range\":[1]}]}", "free"},
  {V "\"free\":[{\"name\":\"shear\",\"range\":[1,\"2\"]}]}", "free"},
  {V "\"free\":[{\"name\":\"shear\",\"range\":[2,1]}]}", "“shear”, 2 to 1"},
  {V "\"free\":[{\"name\":\"shear\",\"range\":[-2,1]}]}", "“shear” is -2"},
  {V "\"free\":[{\"name\":\"sheer\",\"range\":[1,2]}]}", "“sheer”"},
  {V "\"free\":[{\"name\":\"integrator\",\"range\":[1,2]}]}", "integrator"},
  {V "\"free\":[{\"name\":\"shear\",\"range\":[1,2],\"log\":true}]}", "log"},
  {V "\"free\":[{\"name\":\"shear\",\"range\":[1,2]},"
        "{\"name\":\"shear\",\"range\":[1,3]}]}", "“shear” is there twice"},
};

static void
test_refused (void)
{
  for (guint i = 0; i < G_N_ELEMENTS (refused); i++) {
    g_autoptr (GError) error = NULL;

    g_assert_null (parse (refused[i].json, &error));
    g_assert_nonnull (error);
    g_test_message ("%s", error->message);
    g_assert_cmpint (error->domain, ==, CLOTH_MODEL_ERROR);
    g_assert_true (g_str_has_prefix (error->message, "model.json: "));
    g_assert_nonnull (strstr (error->message, refused[i].key));
  }
}

static void
test_checked (void)
{
  g_autoptr (ClothModel) model = cloth_model_new ();
  g_autoptr (GError) error = NULL;
  gdouble x = NAN;

  g_assert_true (cloth_model_check (model, &error));
  g_assert_false (cloth_model_set (model, "shear", NAN, &error));
  g_assert_error (error, CLOTH_MODEL_ERROR, CLOTH_MODEL_ERROR_VALUE);
  g_clear_error (&error);
  model->shear = NAN;
  g_assert_false (cloth_model_check (model, &error));
  g_assert_error (error, CLOTH_MODEL_ERROR, CLOTH_MODEL_ERROR_VALUE);
  g_assert_nonnull (strstr (error->message, "“shear” is nan"));
  g_clear_error (&error);
  model->shear = 1;
  cloth_model_set_effect (model, cloth_effect_find ("air_drag"), &x);
  g_assert_false (cloth_model_check (model, &error));
  g_assert_nonnull (strstr (error->message, "effects.air_drag.coefficient"));
}

static void
test_files (void)
{
  g_autoptr (GError) error = NULL;
  g_autofree gchar *good = NULL, *bad = NULL, *none = NULL;
  g_autoptr (ClothModel) model = NULL;

  scratch_begin ();
  good = scratch_path ("good.json");
  bad = scratch_path ("bad.json");
  none = scratch_path ("none.json");
  scratch_write ("good.json", FULL, -1);
  scratch_write ("bad.json", "{\"version\":1,\"shear\":-1}", -1);
  model = cloth_model_load (good, &error);
  g_assert_no_error (error);
  check_full (model);
  g_assert_null (cloth_model_load (bad, &error));
  g_assert_error (error, CLOTH_MODEL_ERROR, CLOTH_MODEL_ERROR_VALUE);
  g_assert_nonnull (strstr (error->message, bad));
  g_clear_error (&error);
  g_assert_null (cloth_model_load (none, &error));
  g_assert_error (error, G_FILE_ERROR, G_FILE_ERROR_NOENT);
  g_clear_error (&error);
  g_assert_null (cloth_model_load ("/dev/zero", &error));
  g_assert_nonnull (error);
  scratch_end ();
}

int
main (int argc, char **argv)
{
  g_test_init (&argc, &argv, NULL);
  g_test_add_func ("/model/defaults", test_defaults);
  g_test_add_func ("/model/full", test_full);
  g_test_add_func ("/model/exact", test_exact);
  g_test_add_func ("/model/every-parameter", test_every_parameter);
  g_test_add_func ("/model/refused-names", test_refused_names);
  g_test_add_func ("/model/refused", test_refused);
  g_test_add_func ("/model/checked", test_checked);
  g_test_add_func ("/model/files", test_files);
  return g_test_run ();
}
