/* take.json: what a take says of itself.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/takeinfo.h"

#include <math.h>

#include "gst/file/jsonvalue.h"

#define MAX_OBSTACLES 1024

static const ClothJsonFile take_json =
    { "take.json", cloth_mesh_error_quark, CLOTH_MESH_ERROR_INVALID };

static gboolean
parse_grid (JsonNode * node, ClothTakeInfo * info, GError ** error)
{
  static const gchar *const keys[] =
      { "columns", "rows", "width_m", "height_m", NULL };
  JsonObject *grid;

  if (!JSON_NODE_HOLDS_OBJECT (node))
    return cloth_json_invalid (&take_json, error,
        "“grid” must be an object");
  grid = json_node_get_object (node);
  if (!cloth_json_check_keys (&take_json, grid, "“grid”", keys, error) ||
      !cloth_json_get_count (&take_json, grid, "columns", 2,
          CLOTH_MAX_VERTICES / 2, &info->columns, error)
      || !cloth_json_get_count (&take_json, grid, "rows", 2,
          CLOTH_MAX_VERTICES / 2, &info->rows, error)
      || !cloth_json_get_number (&take_json, grid, "width_m", 1e-6, 1e6,
          &info->width_m, error)
      || !cloth_json_get_number (&take_json, grid, "height_m", 1e-6, 1e6,
          &info->height_m, error))
    return FALSE;
  if (info->width_m == 0 || info->height_m == 0)
    return cloth_json_invalid (&take_json, error,
        "“grid” needs width_m and height_m");
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
  JsonArray *list =
      cloth_json_get_list (&take_json, root, "held", CLOTH_MAX_VERTICES, &bad,
      error);
  guint n_vertices =
      info->mesh ? CLOTH_MAX_VERTICES : info->columns * info->rows;

  if (bad)
    return FALSE;
  for (guint i = 0; list && i < json_array_get_length (list); i++) {
    JsonObject *object =
        cloth_json_item_object (&take_json, list, i, "held", error);
    ClothHeld held = {.from_s = -INFINITY,.until_s = INFINITY };

    if (!object
        || !cloth_json_check_keys (&take_json, object, "“held”", keys,
            error)
        || !cloth_json_get_count (&take_json, object, "vertex", 0,
            n_vertices - 1, &held.vertex, error)
        || !cloth_json_get_number (&take_json, object, "from_s", -1e9, 1e9,
            &held.from_s, error)
        || !cloth_json_get_number (&take_json, object, "until_s", -1e9, 1e9,
            &held.until_s, error))
      return FALSE;
    if (held.from_s >= held.until_s)
      return cloth_json_invalid (&take_json, error,
          "held vertex %u is let go before it is held", held.vertex);
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
  if (!cloth_json_get_string (&take_json, object, "type", &type, error) ||
      !cloth_json_get_number (&take_json, object, "friction", 0, 100,
          &obstacle->friction, error))
    return FALSE;
  if (g_strcmp0 (type, "sphere") == 0) {
    obstacle->kind = CLOTH_OBSTACLE_SPHERE;
    if (!cloth_json_check_keys (&take_json, object, "a sphere", sphere_keys,
            error)
        || !cloth_json_get_vector (&take_json, object, "centre", TRUE,
            obstacle->point, error)
        || !cloth_json_get_number (&take_json, object, "radius_m", 1e-6, 1e6,
            &obstacle->radius_m, error))
      return FALSE;
    return obstacle->radius_m > 0
        || cloth_json_invalid (&take_json, error, "a sphere needs radius_m");
  }
  if (g_strcmp0 (type, "plane") != 0)
    return cloth_json_invalid (&take_json, error,
        "the “type” of an obstacle is sphere or plane");
  obstacle->kind = CLOTH_OBSTACLE_PLANE;
  if (!cloth_json_check_keys (&take_json, object, "a plane", plane_keys, error)
      || !cloth_json_get_vector (&take_json, object, "point", TRUE,
          obstacle->point, error)
      || !cloth_json_get_vector (&take_json, object, "normal", TRUE,
          obstacle->normal, error))
    return FALSE;
  length = sqrt (obstacle->normal[0] * obstacle->normal[0] +
      obstacle->normal[1] * obstacle->normal[1] +
      obstacle->normal[2] * obstacle->normal[2]);
  if (length < 1e-9)
    return cloth_json_invalid (&take_json, error,
        "the “normal” of a plane has no length");
  for (guint k = 0; k < 3; k++)
    obstacle->normal[k] /= length;
  return TRUE;
}

static gboolean
parse_obstacles (JsonObject * root, ClothTakeInfo * info, GError ** error)
{
  gboolean bad;
  JsonArray *list =
      cloth_json_get_list (&take_json, root, "obstacles", MAX_OBSTACLES, &bad,
      error);

  if (bad)
    return FALSE;
  for (guint i = 0; list && i < json_array_get_length (list); i++) {
    JsonObject *object =
        cloth_json_item_object (&take_json, list, i, "obstacles", error);
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
  JsonNode *grid = cloth_json_find (root, "grid");
  guint version;

  if (!cloth_json_get_count (&take_json, root, "version", 0, G_MAXINT, &version,
          error))
    return FALSE;
  if (version != 1) {
    g_set_error (error, CLOTH_MESH_ERROR, CLOTH_MESH_ERROR_UNSUPPORTED,
        "take.json: version %u is not read, only 1", version);
    return FALSE;
  }
  if (!cloth_json_check_keys (&take_json, root, "take.json", keys, error) ||
      !cloth_json_get_string (&take_json, root, "name", &info->name, error) ||
      !cloth_json_get_number (&take_json, root, "fps", 1e-6, 1e6, &info->fps,
          error)
      || !cloth_json_get_string (&take_json, root, "mesh", &info->mesh, error)
      || !cloth_json_get_number (&take_json, root, "noise_sigma_m", 0, 1e6,
          &info->noise_sigma_m, error)
      || !cloth_json_get_vector (&take_json, root, "gravity", FALSE,
          info->gravity, error)
      || !cloth_json_get_string (&take_json, root, "notes", &info->notes,
          error))
    return FALSE;
  if (!grid == !info->mesh)
    return cloth_json_invalid (&take_json, error,
        "give either “grid” or “mesh”");
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
    cloth_json_invalid (&take_json, error, "%s", fault->message);
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
add_held (JsonBuilder * builder, const GArray * held)
{
  json_builder_set_member_name (builder, "held");
  json_builder_begin_array (builder);
  for (guint i = 0; i < held->len; i++) {
    const ClothHeld *item = &g_array_index (held, ClothHeld, i);

    json_builder_begin_object (builder);
    cloth_json_add_number (builder, "vertex", item->vertex);
    if (isfinite (item->from_s))
      cloth_json_add_number (builder, "from_s", item->from_s);
    if (isfinite (item->until_s))
      cloth_json_add_number (builder, "until_s", item->until_s);
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
      cloth_json_add_string (builder, "type", "sphere");
      cloth_json_add_vector (builder, "centre", item->point);
      cloth_json_add_number (builder, "radius_m", item->radius_m);
    } else {
      cloth_json_add_string (builder, "type", "plane");
      cloth_json_add_vector (builder, "point", item->point);
      cloth_json_add_vector (builder, "normal", item->normal);
    }
    cloth_json_add_number (builder, "friction", item->friction);
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
  cloth_json_add_number (builder, "version", 1);
  cloth_json_add_string (builder, "name", info->name ? info->name : "");
  if (info->fps > 0)
    cloth_json_add_number (builder, "fps", info->fps);
  if (info->mesh) {
    cloth_json_add_string (builder, "mesh", info->mesh);
  } else {
    json_builder_set_member_name (builder, "grid");
    json_builder_begin_object (builder);
    cloth_json_add_number (builder, "columns", info->columns);
    cloth_json_add_number (builder, "rows", info->rows);
    cloth_json_add_number (builder, "width_m", info->width_m);
    cloth_json_add_number (builder, "height_m", info->height_m);
    json_builder_end_object (builder);
  }
  add_held (builder, info->held);
  cloth_json_add_number (builder, "noise_sigma_m", info->noise_sigma_m);
  cloth_json_add_vector (builder, "gravity", info->gravity);
  add_obstacles (builder, info->obstacles);
  if (info->notes)
    cloth_json_add_string (builder, "notes", info->notes);
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
