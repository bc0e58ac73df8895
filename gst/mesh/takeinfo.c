/* take.json: what a take says of itself.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/takeinfo.h"

#include <math.h>

#include "gst/file/json.h"

#define MAX_OBSTACLES 1024

static gboolean
G_GNUC_PRINTF (2, 3)
invalid (GError ** error, const gchar * format, ...)
{
  g_autofree gchar *text = NULL;
  va_list arguments;

  va_start (arguments, format);
  text = g_strdup_vprintf (format, arguments);
  va_end (arguments);
  g_set_error (error, CLOTH_MESH_ERROR, CLOTH_MESH_ERROR_INVALID,
      "take.json: %s", text);
  return FALSE;
}

static gboolean
check_keys (JsonObject * object, const gchar * where,
    const gchar * const *allowed, GError ** error)
{
  g_autoptr (GList) members = json_object_get_members (object);

  for (GList * at = members; at; at = at->next) {
    if (!g_strv_contains (allowed, at->data)) {
      g_autofree gchar *list = g_strjoinv (", ", (gchar **) allowed);

      return invalid (error, "unknown key “%s” in %s; the keys are %s",
          (const gchar *) at->data, where, list);
    }
  }
  return TRUE;
}

static JsonNode *
find (JsonObject * object, const gchar * key)
{
  JsonNode *node = json_object_get_member (object, key);

  return node && !JSON_NODE_HOLDS_NULL (node) ? node : NULL;
}

static gboolean
node_number (JsonNode * node, gdouble * value)
{
  GType type = JSON_NODE_HOLDS_VALUE (node) ? json_node_get_value_type (node) :
      G_TYPE_INVALID;

  if (type == G_TYPE_INT64)
    *value = (gdouble) json_node_get_int (node);
  else if (type == G_TYPE_DOUBLE)
    *value = json_node_get_double (node);
  else
    return FALSE;
  return isfinite (*value);
}

/* Leaves @value when the key is absent or null. */
static gboolean
get_number (JsonObject * object, const gchar * key, gdouble least,
    gdouble most, gdouble * value, GError ** error)
{
  JsonNode *node = find (object, key);
  gdouble number;

  if (!node)
    return TRUE;
  if (!node_number (node, &number) || number < least || number > most)
    return invalid (error, "“%s” must be a number from %g to %g", key,
        least, most);
  *value = number;
  return TRUE;
}

static gboolean
get_count (JsonObject * object, const gchar * key, guint least, guint most,
    guint * value, GError ** error)
{
  JsonNode *node = find (object, key);
  gdouble number;

  if (!node || !node_number (node, &number) || number != floor (number) ||
      number < least || number > most)
    return invalid (error, "“%s” must be a whole number from %u to %u", key,
        least, most);
  *value = (guint) number;
  return TRUE;
}

static gboolean
get_string (JsonObject * object, const gchar * key, gchar ** value,
    GError ** error)
{
  JsonNode *node = find (object, key);

  if (!node)
    return TRUE;
  if (!JSON_NODE_HOLDS_VALUE (node) ||
      json_node_get_value_type (node) != G_TYPE_STRING)
    return invalid (error, "“%s” must be a text", key);
  *value = g_strdup (json_node_get_string (node));
  return TRUE;
}

static gboolean
get_vector (JsonObject * object, const gchar * key, gboolean needed,
    gdouble * value, GError ** error)
{
  JsonNode *node = find (object, key);
  JsonArray *array;

  if (!node && !needed)
    return TRUE;
  array = node && JSON_NODE_HOLDS_ARRAY (node) ? json_node_get_array (node) :
      NULL;
  if (!array || json_array_get_length (array) != 3)
    return invalid (error, "“%s” must be a list of three numbers", key);
  for (guint i = 0; i < 3; i++) {
    if (!node_number (json_array_get_element (array, i), &value[i]) ||
        fabs (value[i]) > 1e6)
      return invalid (error, "“%s” must be a list of three numbers", key);
  }
  return TRUE;
}

/* Returns the list, NULL when absent; @bad is set when it is something else. */
static JsonArray *
get_list (JsonObject * object, const gchar * key, guint most, gboolean * bad,
    GError ** error)
{
  JsonNode *node = find (object, key);
  JsonArray *array;

  *bad = FALSE;
  if (!node)
    return NULL;
  array = JSON_NODE_HOLDS_ARRAY (node) ? json_node_get_array (node) : NULL;
  if (!array || json_array_get_length (array) > most) {
    *bad = TRUE;
    invalid (error, "“%s” must be a list of at most %u items", key, most);
    return NULL;
  }
  return array;
}

static JsonObject *
item_object (JsonArray * array, guint i, const gchar * key, GError ** error)
{
  JsonNode *node = json_array_get_element (array, i);

  if (JSON_NODE_HOLDS_OBJECT (node))
    return json_node_get_object (node);
  invalid (error, "item %u of “%s” must be an object", i, key);
  return NULL;
}

static gboolean
parse_grid (JsonNode * node, ClothTakeInfo * info, GError ** error)
{
  static const gchar *const keys[] =
      { "columns", "rows", "width_m", "height_m", NULL };
  JsonObject *grid;

  if (!JSON_NODE_HOLDS_OBJECT (node))
    return invalid (error, "“grid” must be an object");
  grid = json_node_get_object (node);
  if (!check_keys (grid, "“grid”", keys, error) ||
      !get_count (grid, "columns", 2, CLOTH_MAX_VERTICES / 2, &info->columns,
          error) ||
      !get_count (grid, "rows", 2, CLOTH_MAX_VERTICES / 2, &info->rows, error)
      || !get_number (grid, "width_m", 1e-6, 1e6, &info->width_m, error) ||
      !get_number (grid, "height_m", 1e-6, 1e6, &info->height_m, error))
    return FALSE;
  if (info->width_m == 0 || info->height_m == 0)
    return invalid (error, "“grid” needs width_m and height_m");
  if ((guint64) info->columns * info->rows > CLOTH_MAX_VERTICES) {
    g_set_error (error, CLOTH_MESH_ERROR, CLOTH_MESH_ERROR_LIMIT,
        "take.json: a grid of %u × %u vertices; %u are accepted",
        info->columns, info->rows, CLOTH_MAX_VERTICES);
    return FALSE;
  }
  return TRUE;
}

static gboolean
parse_held (JsonObject * root, ClothTakeInfo * info, GError ** error)
{
  static const gchar *const keys[] = { "vertex", "from_s", "until_s", NULL };
  gboolean bad;
  JsonArray *list = get_list (root, "held", CLOTH_MAX_VERTICES, &bad, error);
  guint n_vertices = info->mesh ? CLOTH_MAX_VERTICES :
      info->columns * info->rows;

  if (bad)
    return FALSE;
  for (guint i = 0; list && i < json_array_get_length (list); i++) {
    JsonObject *object = item_object (list, i, "held", error);
    ClothHeld held = {.from_s = -INFINITY,.until_s = INFINITY };

    if (!object || !check_keys (object, "“held”", keys, error) ||
        !get_count (object, "vertex", 0, n_vertices - 1, &held.vertex, error)
        || !get_number (object, "from_s", -1e9, 1e9, &held.from_s, error) ||
        !get_number (object, "until_s", -1e9, 1e9, &held.until_s, error))
      return FALSE;
    if (held.from_s >= held.until_s)
      return invalid (error, "held vertex %u is let go before it is held",
          held.vertex);
    g_array_append_val (info->held, held);
  }
  return TRUE;
}

static gboolean
parse_obstacle (JsonObject * object, ClothObstacle * obstacle, GError ** error)
{
  static const gchar *const sphere_keys[] =
      { "type", "centre", "radius_m", "friction", NULL };
  static const gchar *const plane_keys[] =
      { "type", "point", "normal", "friction", NULL };
  g_autofree gchar *type = NULL;
  gdouble length;

  obstacle->friction = NAN;
  if (!get_string (object, "type", &type, error) ||
      !get_number (object, "friction", 0, 100, &obstacle->friction, error))
    return FALSE;
  if (g_strcmp0 (type, "sphere") == 0) {
    obstacle->kind = CLOTH_OBSTACLE_SPHERE;
    if (!check_keys (object, "a sphere", sphere_keys, error) ||
        !get_vector (object, "centre", TRUE, obstacle->point, error) ||
        !get_number (object, "radius_m", 1e-6, 1e6, &obstacle->radius_m, error))
      return FALSE;
    return obstacle->radius_m > 0 || invalid (error, "a sphere needs radius_m");
  }
  if (g_strcmp0 (type, "plane") != 0)
    return invalid (error, "the “type” of an obstacle is sphere or plane");
  obstacle->kind = CLOTH_OBSTACLE_PLANE;
  if (!check_keys (object, "a plane", plane_keys, error) ||
      !get_vector (object, "point", TRUE, obstacle->point, error) ||
      !get_vector (object, "normal", TRUE, obstacle->normal, error))
    return FALSE;
  length = sqrt (obstacle->normal[0] * obstacle->normal[0] +
      obstacle->normal[1] * obstacle->normal[1] +
      obstacle->normal[2] * obstacle->normal[2]);
  if (length < 1e-9)
    return invalid (error, "the “normal” of a plane has no length");
  for (guint k = 0; k < 3; k++)
    obstacle->normal[k] /= length;
  return TRUE;
}

static gboolean
parse_obstacles (JsonObject * root, ClothTakeInfo * info, GError ** error)
{
  gboolean bad;
  JsonArray *list = get_list (root, "obstacles", MAX_OBSTACLES, &bad, error);

  if (bad)
    return FALSE;
  for (guint i = 0; list && i < json_array_get_length (list); i++) {
    JsonObject *object = item_object (list, i, "obstacles", error);
    ClothObstacle obstacle = { 0 };

    if (!object || !parse_obstacle (object, &obstacle, error))
      return FALSE;
    g_array_append_val (info->obstacles, obstacle);
  }
  return TRUE;
}

static gboolean
parse_root (JsonObject * root, ClothTakeInfo * info, GError ** error)
{
  static const gchar *const keys[] = { "version", "name", "fps", "grid",
    "mesh", "held", "noise_sigma_m", "gravity", "obstacles", "notes", NULL
  };
  JsonNode *grid = find (root, "grid");
  guint version;

  if (!get_count (root, "version", 0, G_MAXINT, &version, error))
    return FALSE;
  if (version != 1) {
    g_set_error (error, CLOTH_MESH_ERROR, CLOTH_MESH_ERROR_UNSUPPORTED,
        "take.json: version %u is not read, only 1", version);
    return FALSE;
  }
  if (!check_keys (root, "take.json", keys, error) ||
      !get_string (root, "name", &info->name, error) ||
      !get_number (root, "fps", 1e-6, 1e6, &info->fps, error) ||
      !get_string (root, "mesh", &info->mesh, error) ||
      !get_number (root, "noise_sigma_m", 0, 1e6, &info->noise_sigma_m,
          error) || !get_vector (root, "gravity", FALSE, info->gravity, error)
      || !get_string (root, "notes", &info->notes, error))
    return FALSE;
  if (!grid == !info->mesh)
    return invalid (error, "give either “grid” or “mesh”");
  if (grid && !parse_grid (grid, info, error))
    return FALSE;
  return parse_held (root, info, error) && parse_obstacles (root, info, error);
}

/**
 * cloth_take_info_new:
 * @name: (nullable): name of the take
 *
 * Returns: (transfer full): a take's description with every default
 * Since: 0.1
 */
ClothTakeInfo *
cloth_take_info_new (const gchar * name)
{
  ClothTakeInfo *info = g_new0 (ClothTakeInfo, 1);

  info->name = g_strdup (name);
  info->held = g_array_new (FALSE, TRUE, sizeof (ClothHeld));
  info->obstacles = g_array_new (FALSE, TRUE, sizeof (ClothObstacle));
  info->noise_sigma_m = NAN;
  info->gravity[2] = -9.81;
  return info;
}

/**
 * cloth_take_info_parse:
 * @json: the text of take.json
 * @size: its bytes
 * @error: #ClothMeshError
 *
 * Reads and checks a description. No other file is touched. Unknown keys are an
 * error: a misspelt key would silently take its default.
 *
 * Returns: (transfer full): the description, or %NULL
 * Since: 0.1
 */
ClothTakeInfo *
cloth_take_info_parse (const gchar * json, gsize size, GError ** error)
{
  g_autoptr (ClothTakeInfo) info = NULL;
  g_autoptr (JsonParser) parser = NULL;
  g_autoptr (GError) fault = NULL;
  JsonNode *root;

  parser = cloth_json_parse (json, size, &fault);
  if (!parser) {
    invalid (error, "%s", fault->message);
    return NULL;
  }
  root = json_parser_get_root (parser);
  info = cloth_take_info_new (NULL);
  if (!parse_root (json_node_get_object (root), info, error))
    return NULL;
  if (!info->name)
    info->name = g_strdup ("");
  return g_steal_pointer (&info);
}

static void
add_number (JsonBuilder * builder, const gchar * key, gdouble value)
{
  json_builder_set_member_name (builder, key);
  if (!isfinite (value))
    json_builder_add_null_value (builder);
  else if (value == floor (value) && fabs (value) < 1e15)
    json_builder_add_int_value (builder, (gint64) value);
  else
    json_builder_add_double_value (builder, value);
}

static void
add_vector (JsonBuilder * builder, const gchar * key, const gdouble * value)
{
  json_builder_set_member_name (builder, key);
  json_builder_begin_array (builder);
  for (guint i = 0; i < 3; i++)
    json_builder_add_double_value (builder, value[i]);
  json_builder_end_array (builder);
}

static void
add_string (JsonBuilder * builder, const gchar * key, const gchar * value)
{
  json_builder_set_member_name (builder, key);
  json_builder_add_string_value (builder, value);
}

static void
add_held (JsonBuilder * builder, const GArray * held)
{
  json_builder_set_member_name (builder, "held");
  json_builder_begin_array (builder);
  for (guint i = 0; i < held->len; i++) {
    const ClothHeld *item = &g_array_index (held, ClothHeld, i);

    json_builder_begin_object (builder);
    add_number (builder, "vertex", item->vertex);
    if (isfinite (item->from_s))
      add_number (builder, "from_s", item->from_s);
    if (isfinite (item->until_s))
      add_number (builder, "until_s", item->until_s);
    json_builder_end_object (builder);
  }
  json_builder_end_array (builder);
}

static void
add_obstacles (JsonBuilder * builder, const GArray * obstacles)
{
  json_builder_set_member_name (builder, "obstacles");
  json_builder_begin_array (builder);
  for (guint i = 0; i < obstacles->len; i++) {
    const ClothObstacle *item = &g_array_index (obstacles, ClothObstacle, i);

    json_builder_begin_object (builder);
    if (item->kind == CLOTH_OBSTACLE_SPHERE) {
      add_string (builder, "type", "sphere");
      add_vector (builder, "centre", item->point);
      add_number (builder, "radius_m", item->radius_m);
    } else {
      add_string (builder, "type", "plane");
      add_vector (builder, "point", item->point);
      add_vector (builder, "normal", item->normal);
    }
    add_number (builder, "friction", item->friction);
    json_builder_end_object (builder);
  }
  json_builder_end_array (builder);
}

/**
 * cloth_take_info_to_json:
 * @info: a description
 *
 * Returns: (transfer full): the text of its take.json
 * Since: 0.1
 */
gchar *
cloth_take_info_to_json (const ClothTakeInfo * info)
{
  g_autoptr (JsonBuilder) builder = json_builder_new ();
  g_autoptr (JsonNode) root = NULL;

  json_builder_begin_object (builder);
  add_number (builder, "version", 1);
  add_string (builder, "name", info->name ? info->name : "");
  if (info->fps > 0)
    add_number (builder, "fps", info->fps);
  if (info->mesh) {
    add_string (builder, "mesh", info->mesh);
  } else {
    json_builder_set_member_name (builder, "grid");
    json_builder_begin_object (builder);
    add_number (builder, "columns", info->columns);
    add_number (builder, "rows", info->rows);
    add_number (builder, "width_m", info->width_m);
    add_number (builder, "height_m", info->height_m);
    json_builder_end_object (builder);
  }
  add_held (builder, info->held);
  add_number (builder, "noise_sigma_m", info->noise_sigma_m);
  add_vector (builder, "gravity", info->gravity);
  add_obstacles (builder, info->obstacles);
  if (info->notes)
    add_string (builder, "notes", info->notes);
  json_builder_end_object (builder);
  root = json_builder_get_root (builder);
  return json_to_string (root, TRUE);
}

/**
 * cloth_take_info_free:
 * @info: (transfer full) (nullable): a description
 *
 * Since: 0.1
 */
void
cloth_take_info_free (ClothTakeInfo * info)
{
  if (!info)
    return;
  g_free (info->name);
  g_free (info->mesh);
  g_free (info->notes);
  g_array_unref (info->held);
  g_array_unref (info->obstacles);
  g_free (info);
}
