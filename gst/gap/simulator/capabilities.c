/* What a user's simulator says of itself: capabilities.json.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/gap/simulator/capabilities.h"

#include <math.h>
#include <string.h>

#include "gst/file/json.h"
#include "gst/sim/model.h"

#define MAX_PARAMETERS 256
/* Names and units stand in one line of a table. */
#define MAX_WORD 64
/* Greatest number of any unit. */
#define MAX_VALUE 1e12

GQuark
cloth_simulator_error_quark (void)
{
  return g_quark_from_static_string ("cloth-simulator-error-quark");
}

static const ClothJsonFile file = { "capabilities",
  cloth_simulator_error_quark, CLOTH_SIMULATOR_ERROR_CAPABILITIES
};

static void
clear_parameter (gpointer item)
{
  ClothSimulatorParameter *parameter = item;

  g_free (parameter->name);
  g_free (parameter->unit);
  g_free (parameter->blurb);
  g_strfreev (parameter->is);
}

/* @capabilities: (nullable) (transfer full): capabilities
 */
void
cloth_simulator_capabilities_free (ClothSimulatorCapabilities * capabilities)
{
  if (!capabilities)
    return;
  g_free (capabilities->simulator);
  g_free (capabilities->version);
  g_array_unref (capabilities->parameters);
  g_free (capabilities);
}

/* @parameter: a number of a simulator
 *
 * Returns: whether it has no range and so is never changed
 */
gboolean
cloth_simulator_parameter_is_fixed (const ClothSimulatorParameter * parameter)
{
  return isnan (parameter->range[0]);
}

/* @parameter: a number of a simulator
 *
 * Returns: whether its logarithm is searched: all of its range is above 0
 */
gboolean
cloth_simulator_parameter_is_logarithmic (const ClothSimulatorParameter *
    parameter)
{
  return parameter->range[0] > 0.;
}

/* A text that fits in a line. */
static gboolean
get_word (JsonObject * object, const gchar * key, gchar ** value,
    GError ** error)
{
  if (!cloth_json_get_string (&file, object, key, value, error))
    return FALSE;
  if (*value && (!**value || strlen (*value) > MAX_WORD
          || strpbrk (*value, "\r\n\t")))
    return cloth_json_invalid (&file, error,
        "“%s” must be one line of 1 to %u bytes", key, MAX_WORD);
  return TRUE;
}

static gboolean
get_range (JsonObject * object, ClothSimulatorParameter * parameter,
    GError ** error)
{
  JsonNode *node = cloth_json_find (object, "range");
  JsonArray *range;

  parameter->range[0] = parameter->range[1] = NAN;
  if (!node)
    return TRUE;
  range = JSON_NODE_HOLDS_ARRAY (node) ? json_node_get_array (node) : NULL;
  if (!range || json_array_get_length (range) != 2 ||
      !cloth_json_number (json_array_get_element (range, 0),
          &parameter->range[0])
      || !cloth_json_number (json_array_get_element (range, 1),
          &parameter->range[1])
      || fabs (parameter->range[0]) > MAX_VALUE
      || fabs (parameter->range[1]) > MAX_VALUE
      || parameter->range[0] >= parameter->range[1])
    return cloth_json_invalid (&file, error,
        "“range” of “%s” must be [least, greatest]; leave it out of what "
        "must not be changed", parameter->name);
  if (parameter->value < parameter->range[0]
      || parameter->value > parameter->range[1])
    return cloth_json_invalid (&file, error,
        "“value” of “%s” is %g, outside of its range [%g, %g]",
        parameter->name, parameter->value, parameter->range[0],
        parameter->range[1]);
  return TRUE;
}

/* A number of model.json, or several: a text or a list of texts. */
static gboolean
get_is (JsonObject * object, ClothSimulatorParameter * parameter,
    GError ** error)
{
  g_autoptr (GStrvBuilder) names = g_strv_builder_new ();
  JsonNode *node = cloth_json_find (object, "is");
  JsonArray *list;
  guint n;

  if (!node)
    return TRUE;
  list = JSON_NODE_HOLDS_ARRAY (node) ? json_node_get_array (node) : NULL;
  n = list ? json_array_get_length (list) : 1;
  for (guint i = 0; i < n; i++) {
    JsonNode *item = list ? json_array_get_element (list, i) : node;
    gdouble range[2];

    if (!JSON_NODE_HOLDS_VALUE (item) ||
        json_node_get_value_type (item) != G_TYPE_STRING)
      return cloth_json_invalid (&file, error,
          "“is” of “%s” must be the name of a number of model.json, or a list "
          "of such names", parameter->name);
    if (!cloth_model_get_range (json_node_get_string (item), range, error)) {
      g_prefix_error (error, "capabilities: “is” of “%s”: ",
          parameter->name);
      return FALSE;
    }
    g_strv_builder_add (names, json_node_get_string (item));
  }
  if (n > 0)
    parameter->is = g_strv_builder_end (names);
  return TRUE;
}

static gboolean
parse_parameter (JsonObject * object, ClothSimulatorParameter * parameter,
    GError ** error)
{
  static const gchar *const allowed[] = { "name", "unit", "value", "range",
    "is", "scale", "blurb", NULL
  };
  JsonNode *scale = cloth_json_find (object, "scale");

  parameter->value = parameter->scale = NAN;
  if (!cloth_json_check_keys (&file, object, "“parameters”", allowed, error)
      || !get_word (object, "name", &parameter->name, error))
    return FALSE;
  if (!parameter->name)
    return cloth_json_invalid (&file, error, "a parameter has no “name”");
  if (!get_word (object, "unit", &parameter->unit, error) ||
      !cloth_json_get_string (&file, object, "blurb", &parameter->blurb, error)
      || !cloth_json_get_number (&file, object, "value", -MAX_VALUE, MAX_VALUE,
          &parameter->value, error)) {
    g_prefix_error (error, "“%s”: ", parameter->name);
    return FALSE;
  }
  if (isnan (parameter->value))
    return cloth_json_invalid (&file, error,
        "“%s” has no “value”: the one "
        "that your simulator takes by itself", parameter->name);
  if (!parameter->unit)
    parameter->unit = g_strdup ("1");
  if (scale && (!cloth_json_number (scale, &parameter->scale) ||
          parameter->scale == 0. || fabs (parameter->scale) > MAX_VALUE))
    return cloth_json_invalid (&file, error,
        "“scale” of “%s” must be a number other than 0: that of model.json "
        "over yours", parameter->name);
  return get_range (object, parameter, error) &&
      get_is (object, parameter, error);
}

/* A name stands once; so does a number of model.json, or which of two would change it? */
static gboolean
check_twice (const ClothSimulatorCapabilities * capabilities, GError ** error)
{
  g_autoptr (GHashTable) names = g_hash_table_new (g_str_hash, g_str_equal);
  g_autoptr (GHashTable) numbers = g_hash_table_new (g_str_hash, g_str_equal);

  for (guint i = 0; i < capabilities->parameters->len; i++) {
    const ClothSimulatorParameter *parameter =
        cloth_simulator_capabilities_get (capabilities, i);

    if (!g_hash_table_add (names, parameter->name))
      return cloth_json_invalid (&file, error,
          "two parameters have the name “%s”", parameter->name);
    for (guint k = 0; parameter->is && parameter->is[k]; k++)
      if (!g_hash_table_add (numbers, parameter->is[k]))
        return cloth_json_invalid (&file, error,
            "“%s” of “%s” is another parameter's already: leave “is” out of "
            "one of them", parameter->is[k], parameter->name);
  }
  return TRUE;
}

static gboolean
parse_root (JsonObject * root, ClothSimulatorCapabilities * capabilities,
    GError ** error)
{
  static const gchar *const allowed[] = { "version", "simulator",
    "simulator_version", "parameters", NULL
  };
  guint version = 0;
  gboolean bad;
  JsonArray *list;

  if (!cloth_json_get_count (&file, root, "version", 0, G_MAXINT, &version,
          error))
    return FALSE;
  if (version != 1)
    return cloth_json_invalid (&file, error,
        "version %u is not read, only 1", version);
  if (!cloth_json_check_keys (&file, root, "capabilities", allowed, error) ||
      !get_word (root, "simulator", &capabilities->simulator, error) ||
      !get_word (root, "simulator_version", &capabilities->version, error))
    return FALSE;
  if (!capabilities->simulator)
    return cloth_json_invalid (&file, error,
        "“simulator” is missing: the name of your simulator");
  list = cloth_json_get_list (&file, root, "parameters", MAX_PARAMETERS, &bad,
      error);
  if (bad)
    return FALSE;
  if (!list || json_array_get_length (list) == 0)
    return cloth_json_invalid (&file, error,
        "“parameters” is missing or empty: list the numbers of your simulator");
  for (guint i = 0; i < json_array_get_length (list); i++) {
    JsonObject *object =
        cloth_json_item_object (&file, list, i, "parameters", error);

    g_array_set_size (capabilities->parameters, i + 1);
    if (!object || !parse_parameter (object,
            &g_array_index (capabilities->parameters, ClothSimulatorParameter,
                i), error))
      return FALSE;
  }
  return check_twice (capabilities, error);
}

/* @json: the text that a simulator prints of itself
 * @size: its bytes
 * @error: #ClothSimulatorError, or #ClothModelError for a number that model.json doesn't
 *   have; key and value are named
 *
 * Reads and checks capabilities.json (docs/simulator-capabilities.schema.json).
 *
 * Returns: (transfer full) (nullable): the capabilities
 */
ClothSimulatorCapabilities *
cloth_simulator_capabilities_parse (const gchar * json, gsize size,
    GError ** error)
{
  g_autoptr (ClothSimulatorCapabilities) capabilities =
      g_new0 (ClothSimulatorCapabilities, 1);
  g_autoptr (GError) fault = NULL;
  g_autoptr (JsonParser) parser = cloth_json_parse (json, size, &fault);

  capabilities->parameters =
      g_array_new (FALSE, TRUE, sizeof (ClothSimulatorParameter));
  g_array_set_clear_func (capabilities->parameters, clear_parameter);
  if (!parser) {
    g_set_error (error, CLOTH_SIMULATOR_ERROR,
        CLOTH_SIMULATOR_ERROR_CAPABILITIES, "capabilities: %s", fault->message);
    return NULL;
  }
  if (!parse_root (json_node_get_object (json_parser_get_root (parser)),
          capabilities, error))
    return NULL;
  return g_steal_pointer (&capabilities);
}
