/* A model of a cloth: defaults, effects, values by name, limits, and its file.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/model.h"

#include <string.h>

#include "gst/file/json.h"
#include "gst/file/jsonwriter.h"

GQuark
cloth_model_error_quark (void)
{
  return g_quark_from_static_string ("cloth-model-error-quark");
}

/* Every number of model.json but those of effects. */
static const struct
{
  const gchar *name;
  const gchar *unit;
  gsize offset;
  gdouble least, most;
} keys[] = {
  {"areal_density", "kg/m²", G_STRUCT_OFFSET (ClothModel, areal_density), 1e-4,
      1e3},
  {"stretch.warp", "N/m", G_STRUCT_OFFSET (ClothModel, stretch_warp), 0, 1e7},
  {"stretch.weft", "N/m", G_STRUCT_OFFSET (ClothModel, stretch_weft), 0, 1e7},
  {"shear", "N/m", G_STRUCT_OFFSET (ClothModel, shear), 0, 1e7},
  {"bending.warp", "N·m", G_STRUCT_OFFSET (ClothModel, bending_warp), 0, 1e3},
  {"bending.weft", "N·m", G_STRUCT_OFFSET (ClothModel, bending_weft), 0, 1e3},
  {"damping.mass", "1/s", G_STRUCT_OFFSET (ClothModel, damping_mass), 0, 1e4},
  {"damping.stiffness", "s", G_STRUCT_OFFSET (ClothModel, damping_stiffness), 0,
      1},
  {"compression_ratio", "1", G_STRUCT_OFFSET (ClothModel, compression_ratio), 0,
      1},
  {"air_density", "kg/m³", G_STRUCT_OFFSET (ClothModel, air_density), 0, 2e3},
  {"time_step", "s", G_STRUCT_OFFSET (ClothModel, time_step), 0, 1},
};

/* What a dotted name stands for: a key, or a parameter of an effect. */
typedef struct
{
  const gchar *unit;
  gsize offset;
  const ClothEffect *effect;    /* NULL: the number at offset */
  guint parameter;
  gdouble least, most;
} Place;

static void
free_clear (gpointer data)
{
  g_free (((ClothModelFree *) data)->name);
}

/* Returns: (transfer full): a model with the default of every key and no effects
 */
ClothModel *
cloth_model_new (void)
{
  ClothModel *model = g_new0 (ClothModel, 1);

  model->areal_density = 0.187;
  model->stretch_warp = model->stretch_weft = 100.;
  model->shear = 40.;
  model->bending_warp = model->bending_weft = 2e-5;
  model->damping_mass = 0.2;
  model->damping_stiffness = 1e-3;
  model->compression_ratio = 0.02;
  model->air_density = 1.2;
  model->effects = g_array_new (FALSE, TRUE, sizeof (ClothModelEffect));
  model->free = g_array_new (FALSE, TRUE, sizeof (ClothModelFree));
  g_array_set_clear_func (model->free, free_clear);
  return model;
}

/* @model: a model
 *
 * Returns: (transfer full): a deep copy
 */
ClothModel *
cloth_model_copy (const ClothModel * model)
{
  ClothModel *copy = g_memdup2 (model, sizeof *model);

  copy->effects = g_array_copy (model->effects);
  copy->free = g_array_copy (model->free);
  /* which the array's copy does not take over */
  g_array_set_clear_func (copy->free, free_clear);
  for (guint i = 0; i < copy->free->len; i++) {
    ClothModelFree *entry = &g_array_index (copy->free, ClothModelFree, i);

    entry->name = g_strdup (entry->name);
  }
  return copy;
}

static ClothModelEffect *
find_effect (const ClothModel * model, const ClothEffect * effect)
{
  for (guint i = 0; i < model->effects->len; i++) {
    ClothModelEffect *present =
        &g_array_index (model->effects, ClothModelEffect, i);

    if (strcmp (present->effect->id, effect->id) == 0)
      return present;
  }
  return NULL;
}

/* @model: a model
 * @effect: an effect
 * @values: (nullable): its parameters, as many as the effect has; %NULL for its nulls
 *
 * Adds the effect, or changes it when the model has it already.
 */
void
cloth_model_set_effect (ClothModel * model, const ClothEffect * effect,
    const gdouble * values)
{
  ClothModelEffect *present = find_effect (model, effect);
  ClothModelEffect entry = { effect };

  for (guint i = 0; i < effect->n_parameters; i++)
    entry.values[i] = values ? values[i] : effect->parameters[i].null_value;
  if (present)
    *present = entry;
  else
    g_array_append_val (model->effects, entry);
}

static gboolean
no_name (GError ** error, const gchar * name, const gchar * what)
{
  g_set_error (error, CLOTH_MODEL_ERROR, CLOTH_MODEL_ERROR_NAME,
      "“%s”: %s", name, what);
  return FALSE;
}

static gboolean
find_parameter (const gchar * name, Place * place, GError ** error)
{
  const gchar *id = name + strlen ("effects.");
  const gchar *dot = strchr (id, '.');
  g_autofree gchar *effect_id = dot ? g_strndup (id, (gsize) (dot - id)) : NULL;
  g_autoptr (GString) list = NULL;
  const ClothEffect *effect = cloth_effect_find (dot ? effect_id : id);

  if (!effect)
    return no_name (error, name, "there is no such effect; "
        "gst-cloth-gap-1.0 effects lists them");
  place->effect = effect;
  list = g_string_new ("its parameters are");
  for (guint i = 0; i < effect->n_parameters; i++) {
    const ClothEffectParameter *parameter = &effect->parameters[i];

    g_string_append_printf (list, "%s %s", i ? "," : "", parameter->name);
    if (!dot || strcmp (dot + 1, parameter->name) != 0)
      continue;
    place->unit = parameter->unit;
    place->parameter = i;
    place->least = parameter->min;
    place->most = parameter->max;
    return TRUE;
  }
  return no_name (error, name, list->str);
}

static gboolean
find_place (const gchar * name, Place * place, GError ** error)
{
  g_autoptr (GString) list = NULL;

  memset (place, 0, sizeof *place);
  if (g_str_has_prefix (name, "effects."))
    return find_parameter (name, place, error);
  list = g_string_new ("there is no such number; there are");
  for (guint i = 0; i < G_N_ELEMENTS (keys); i++) {
    g_string_append_printf (list, " %s,", keys[i].name);
    if (strcmp (name, keys[i].name) != 0)
      continue;
    place->unit = keys[i].unit;
    place->offset = keys[i].offset;
    place->least = keys[i].least;
    place->most = keys[i].most;
    return TRUE;
  }
  g_string_append (list, " effects.<effect>.<parameter>");
  return no_name (error, name, list->str);
}

static gboolean
check_value (const gchar * name, gdouble value, const Place * place,
    GError ** error)
{
  /* A NaN is not in any range. */
  if (value >= place->least && value <= place->most)
    return TRUE;
  g_set_error (error, CLOTH_MODEL_ERROR, CLOTH_MODEL_ERROR_VALUE,
      "“%s” is %g; it must be from %g to %g", name, value, place->least,
      place->most);
  return FALSE;
}

/* @model: a model
 * @name: key of a number, `stretch.warp`, or of an effect's, `effects.wind.x`
 * @value: (out): its value; the null of an effect that the model has not
 * @error: #ClothModelError
 *
 * Returns: %TRUE when there is such a number
 */
gboolean
cloth_model_get (const ClothModel * model, const gchar * name,
    gdouble * value, GError ** error)
{
  const ClothModelEffect *present;
  Place place;

  if (!find_place (name, &place, error))
    return FALSE;
  if (!place.effect)
    *value = G_STRUCT_MEMBER (gdouble, model, place.offset);
  else if ((present = find_effect (model, place.effect)))
    *value = present->values[place.parameter];
  else
    *value = place.effect->parameters[place.parameter].null_value;
  return TRUE;
}

/* @model: a model
 * @name: as for cloth_model_get ()
 * @value: its new value
 * @error: #ClothModelError, naming key and value
 *
 * An effect that the model has not is added, its other parameters at their nulls.
 *
 * Returns: %TRUE when there is such a number and it may have this value; else nothing
 *   is changed
 */
gboolean
cloth_model_set (ClothModel * model, const gchar * name, gdouble value,
    GError ** error)
{
  Place place;

  if (!find_place (name, &place, error) ||
      !check_value (name, value, &place, error))
    return FALSE;
  if (!place.effect) {
    G_STRUCT_MEMBER (gdouble, model, place.offset) = value;
    return TRUE;
  }
  if (!find_effect (model, place.effect))
    cloth_model_set_effect (model, place.effect, NULL);
  find_effect (model, place.effect)->values[place.parameter] = value;
  return TRUE;
}

/* @name: as for cloth_model_get ()
 * @range: (out): least and greatest value it may have
 * @error: #ClothModelError
 *
 * Returns: %TRUE when there is such a number
 */
gboolean
cloth_model_get_range (const gchar * name, gdouble range[2], GError ** error)
{
  Place place;

  if (!find_place (name, &place, error))
    return FALSE;
  range[0] = place.least;
  range[1] = place.most;
  return TRUE;
}

/* @name: as for cloth_model_get ()
 *
 * Returns: (transfer none) (nullable): its unit in the notation of the SI, "1" for a ratio;
 *   %NULL: there is no such number
 */
const gchar *
cloth_model_get_unit (const gchar * name)
{
  Place place;

  return find_place (name, &place, NULL) ? place.unit : NULL;
}

static gboolean
check_free (const ClothModel * model, guint i, GError ** error)
{
  const ClothModelFree *entry = &g_array_index (model->free, ClothModelFree, i);
  Place place;

  if (!find_place (entry->name, &place, error) ||
      !check_value (entry->name, entry->range[0], &place, error) ||
      !check_value (entry->name, entry->range[1], &place, error)) {
    g_prefix_error (error, "free: ");
    return FALSE;
  }
  if (entry->range[0] >= entry->range[1]) {
    g_set_error (error, CLOTH_MODEL_ERROR, CLOTH_MODEL_ERROR_VALUE,
        "free: the range of “%s”, %g to %g, does not rise", entry->name,
        entry->range[0], entry->range[1]);
    return FALSE;
  }
  for (guint k = 0; k < i; k++) {
    if (strcmp (g_array_index (model->free, ClothModelFree, k).name,
            entry->name) != 0)
      continue;
    g_set_error (error, CLOTH_MODEL_ERROR, CLOTH_MODEL_ERROR_VALUE,
        "free: “%s” is there twice", entry->name);
    return FALSE;
  }
  return TRUE;
}

/* @model: a model made by hand
 * @error: #ClothModelError, naming key and value
 *
 * Returns: %TRUE when every number is one that it may have
 */
gboolean
cloth_model_check (const ClothModel * model, GError ** error)
{
  for (guint i = 0; i < G_N_ELEMENTS (keys); i++) {
    const Place place = {.least = keys[i].least,.most = keys[i].most };

    if (!check_value (keys[i].name, G_STRUCT_MEMBER (gdouble, model,
                keys[i].offset), &place, error))
      return FALSE;
  }
  for (guint i = 0; i < model->effects->len; i++) {
    const ClothModelEffect *entry =
        &g_array_index (model->effects, ClothModelEffect, i);

    for (guint k = 0; k < entry->effect->n_parameters; k++) {
      const ClothEffectParameter *parameter = &entry->effect->parameters[k];
      const Place place = {.least = parameter->min,.most = parameter->max };
      g_autofree gchar *name = g_strdup_printf ("effects.%s.%s",
          entry->effect->id, parameter->name);

      if (!check_value (name, entry->values[k], &place, error))
        return FALSE;
    }
  }
  for (guint i = 0; i < model->free->len; i++)
    if (!check_free (model, i, error))
      return FALSE;
  return TRUE;
}

/* @model: (nullable) (transfer full): a model
 */
void
cloth_model_free (ClothModel * model)
{
  if (!model)
    return;
  g_array_unref (model->effects);
  g_array_unref (model->free);
  g_free (model);
}

/* ---- model.json ---- */

#define MAX_FREE 1024

static const gchar *const force_models[] = { "membrane", "mass-spring", NULL };
static const gchar *const integrators[] = { "explicit", "implicit", NULL };

static const ClothJsonFile model_json =
    { "model.json", cloth_model_error_quark, CLOTH_MODEL_ERROR_VALUE };

static gboolean
set_number (ClothModel * model, const gchar * name, JsonNode * node,
    GError ** error)
{
  gdouble number, range[2];

  /* A name that does not exist is to be told before its value. */
  if (!cloth_model_get_range (name, range, error)) {
    g_prefix_error (error, "model.json: ");
    return FALSE;
  }
  if (!cloth_json_number (node, &number))
    return cloth_json_invalid (&model_json, error,
        "“%s” must be a number from %g to %g", name, range[0], range[1]);
  if (cloth_model_set (model, name, number, error))
    return TRUE;
  g_prefix_error (error, "model.json: ");
  return FALSE;
}

/* An object of numbers, whose names are put behind @prefix. */
static gboolean
set_numbers (ClothModel * model, const gchar * prefix, JsonNode * node,
    GError ** error)
{
  g_autoptr (GList) members = NULL;

  if (!JSON_NODE_HOLDS_OBJECT (node))
    return cloth_json_invalid (&model_json, error,
        "“%s” must be an object of numbers", prefix);
  members = json_object_get_members (json_node_get_object (node));
  for (GList * at = members; at; at = at->next) {
    g_autofree gchar *name = g_strdup_printf ("%s.%s", prefix,
        (const gchar *) at->data);

    if (!set_number (model, name,
            json_object_get_member (json_node_get_object (node), at->data),
            error))
      return FALSE;
  }
  return TRUE;
}

static gboolean
set_effects (ClothModel * model, JsonNode * node, GError ** error)
{
  g_autoptr (GList) members = NULL;

  if (!JSON_NODE_HOLDS_OBJECT (node))
    return cloth_json_invalid (&model_json, error,
        "“effects” must be an object: {name: {parameter: value}}");
  members = json_object_get_members (json_node_get_object (node));
  for (GList * at = members; at; at = at->next) {
    const ClothEffect *effect = cloth_effect_find (at->data);
    g_autofree gchar *prefix = g_strdup_printf ("effects.%s",
        (const gchar *) at->data);

    if (!effect) {
      g_set_error (error, CLOTH_MODEL_ERROR, CLOTH_MODEL_ERROR_NAME,
          "model.json: “%s”: there is no such effect; "
          "gst-cloth-gap-1.0 effects lists them", prefix);
      return FALSE;
    }
    cloth_model_set_effect (model, effect, NULL);
    if (!set_numbers (model, prefix,
            json_object_get_member (json_node_get_object (node), at->data),
            error))
      return FALSE;
  }
  return TRUE;
}

static gboolean
set_free (ClothModel * model, JsonObject * root, GError ** error)
{
  static const gchar *const allowed[] = { "name", "range", NULL };
  gboolean bad;
  JsonArray *list = cloth_json_get_list (&model_json, root, "free", MAX_FREE,
      &bad, error);

  if (bad)
    return FALSE;
  for (guint i = 0; list && i < json_array_get_length (list); i++) {
    JsonObject *object =
        cloth_json_item_object (&model_json, list, i, "free", error);
    ClothModelFree *entry;
    JsonNode *node;
    JsonArray *range;

    if (!object ||
        !cloth_json_check_keys (&model_json, object, "“free”", allowed,
            error))
      return FALSE;
    g_array_set_size (model->free, i + 1);
    entry = &g_array_index (model->free, ClothModelFree, i);
    if (!cloth_json_get_string (&model_json, object, "name", &entry->name,
            error))
      return FALSE;
    node = cloth_json_find (object, "range");
    range = node && JSON_NODE_HOLDS_ARRAY (node) ? json_node_get_array (node) :
        NULL;
    if (!entry->name || !range || json_array_get_length (range) != 2 ||
        !cloth_json_number (json_array_get_element (range, 0),
            &entry->range[0]) ||
        !cloth_json_number (json_array_get_element (range, 1),
            &entry->range[1]))
      return cloth_json_invalid (&model_json, error,
          "item %u of “free” must "
          "be {\"name\": a number of the model, \"range\": [least, most]}", i);
  }
  return TRUE;
}

/* Leaves @choice when the key is absent. */
static gboolean
get_choice (JsonObject * root, const gchar * key, const gchar * const *words,
    guint * choice, GError ** error)
{
  g_autofree gchar *word = NULL, *list = NULL;

  if (!cloth_json_get_string (&model_json, root, key, &word, error))
    return FALSE;
  if (!word)
    return TRUE;
  for (guint i = 0; words[i]; i++) {
    if (strcmp (words[i], word) != 0)
      continue;
    *choice = i;
    return TRUE;
  }
  list = g_strjoinv (" or ", (gchar **) words);
  return cloth_json_invalid (&model_json, error,
      "“%s” is “%s”; it must be %s", key, word, list);
}

static gboolean
parse_root (JsonObject * root, ClothModel * model, GError ** error)
{
  static const gchar *const allowed[] = { "version", "force_model",
    "areal_density", "stretch", "shear", "bending", "damping",
    "compression_ratio", "air_density", "integrator", "time_step", "effects",
    "free", NULL
  };
  static const gchar *const numbers[] = { "areal_density", "shear",
    "compression_ratio", "air_density", "time_step"
  };
  static const gchar *const objects[] = { "stretch", "bending", "damping" };
  guint version, force_model = 0, integrator = 0;
  JsonNode *node;

  if (!cloth_json_get_count (&model_json, root, "version", 0, G_MAXINT,
          &version, error))
    return FALSE;
  if (version != 1) {
    g_set_error (error, CLOTH_MODEL_ERROR, CLOTH_MODEL_ERROR_FORMAT,
        "model.json: version %u is not read, only 1", version);
    return FALSE;
  }
  if (!cloth_json_check_keys (&model_json, root, "model.json", allowed, error)
      || !get_choice (root, "force_model", force_models, &force_model, error)
      || !get_choice (root, "integrator", integrators, &integrator, error))
    return FALSE;
  model->force_model = (ClothForceModel) force_model;
  model->integrator = (ClothIntegrator) integrator;
  for (guint i = 0; i < G_N_ELEMENTS (numbers); i++)
    if ((node = cloth_json_find (root, numbers[i])) &&
        !set_number (model, numbers[i], node, error))
      return FALSE;
  for (guint i = 0; i < G_N_ELEMENTS (objects); i++)
    if ((node = cloth_json_find (root, objects[i])) &&
        !set_numbers (model, objects[i], node, error))
      return FALSE;
  if ((node = cloth_json_find (root, "effects")) &&
      !set_effects (model, node, error))
    return FALSE;
  if (!set_free (model, root, error))
    return FALSE;
  if (cloth_model_check (model, error))
    return TRUE;
  g_prefix_error (error, "model.json: ");
  return FALSE;
}

/* @json: the text of model.json
 * @size: its bytes
 * @error: #ClothModelError, naming key and value
 *
 * Reads and checks a model. Missing keys take their defaults, unknown ones are an
 * error.
 *
 * Returns: (transfer full): the model, or %NULL
 */
ClothModel *
cloth_model_parse (const gchar * json, gsize size, GError ** error)
{
  g_autoptr (ClothModel) model = cloth_model_new ();
  g_autoptr (GError) fault = NULL;
  g_autoptr (JsonParser) parser = cloth_json_parse (json, size, &fault);

  if (!parser) {
    g_set_error (error, CLOTH_MODEL_ERROR, CLOTH_MODEL_ERROR_FORMAT,
        "model.json: %s", fault->message);
    return NULL;
  }
  if (!parse_root (json_node_get_object (json_parser_get_root (parser)), model,
          error))
    return NULL;
  return g_steal_pointer (&model);
}

/* @path: (type filename): a model.json
 * @error: #ClothModelError, #GFileError, #ClothFileError
 *
 * Returns: (transfer full): the model, or %NULL; the message names @path
 */
ClothModel *
cloth_model_load (const gchar * path, GError ** error)
{
  gsize size;
  g_autofree gchar *text = cloth_text_file_load (path, &size, error);
  ClothModel *model = text ? cloth_model_parse (text, size, error) : NULL;

  if (text && !model)
    g_prefix_error (error, "%s: ", path);
  return model;
}

static void
write_pair (ClothJsonWriter * writer, const gchar * key,
    const gchar * const names[2], gdouble a, gdouble b)
{
  cloth_json_writer_begin_object (writer, key);
  cloth_json_writer_number (writer, names[0], a);
  cloth_json_writer_number (writer, names[1], b);
  cloth_json_writer_end_object (writer);
}

static void
write_effects (ClothJsonWriter * writer, const ClothModel * model)
{
  cloth_json_writer_begin_object (writer, "effects");
  for (guint i = 0; i < model->effects->len; i++) {
    const ClothModelEffect *entry =
        &g_array_index (model->effects, ClothModelEffect, i);

    cloth_json_writer_begin_object (writer, entry->effect->id);
    for (guint k = 0; k < entry->effect->n_parameters; k++)
      cloth_json_writer_number (writer, entry->effect->parameters[k].name,
          entry->values[k]);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_object (writer);
}

/* @model: a model
 *
 * Every key is written, numbers so that they are read as the very same.
 *
 * Returns: (transfer full): the text of its model.json
 */
gchar *
cloth_model_to_json (const ClothModel * model)
{
  static const gchar *const directions[2] = { "warp", "weft" };
  static const gchar *const dampings[2] = { "mass", "stiffness" };
  g_autoptr (ClothJsonWriter) writer = cloth_json_writer_new ();

  cloth_json_writer_set_exact (writer);
  cloth_json_writer_begin_object (writer, NULL);
  cloth_json_writer_count (writer, "version", 1);
  cloth_json_writer_string (writer, "force_model",
      force_models[model->force_model]);
  cloth_json_writer_number (writer, "areal_density", model->areal_density);
  write_pair (writer, "stretch", directions, model->stretch_warp,
      model->stretch_weft);
  cloth_json_writer_number (writer, "shear", model->shear);
  write_pair (writer, "bending", directions, model->bending_warp,
      model->bending_weft);
  write_pair (writer, "damping", dampings, model->damping_mass,
      model->damping_stiffness);
  cloth_json_writer_number (writer, "compression_ratio",
      model->compression_ratio);
  cloth_json_writer_number (writer, "air_density", model->air_density);
  cloth_json_writer_string (writer, "integrator",
      integrators[model->integrator]);
  cloth_json_writer_number (writer, "time_step", model->time_step);
  write_effects (writer, model);
  cloth_json_writer_begin_array (writer, "free");
  for (guint i = 0; i < model->free->len; i++) {
    const ClothModelFree *entry =
        &g_array_index (model->free, ClothModelFree, i);

    cloth_json_writer_begin_object (writer, NULL);
    cloth_json_writer_string (writer, "name", entry->name);
    cloth_json_writer_numbers (writer, "range", entry->range, 2);
    cloth_json_writer_end_object (writer);
  }
  cloth_json_writer_end_array (writer);
  cloth_json_writer_end_object (writer);
  return cloth_json_writer_finish (writer);
}
