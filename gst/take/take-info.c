/* take.json: what a take says of itself.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/take/take-info.h"

#include <math.h>
#include <string.h>

#include "gst/file/json.h"
#include "gst/math/vec3.h"
#include "gst/mesh/seam.h"

/* Share of its extent by which the uv of a grid may be off. */
#define GRID_ROUNDING 1e-6

static const ClothJsonFile take_json =
    { "take.json", cloth_file_error_quark, CLOTH_FILE_ERROR_INVALID };

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
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
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
        || !cloth_json_get_number (&take_json, object, "from_s", -1e11, 1e11,
            &held.from_s, error)
        || !cloth_json_get_number (&take_json, object, "until_s", -1e11, 1e11,
            &held.until_s, error))
      return FALSE;
    if (held.from_s >= held.until_s)
      return cloth_json_invalid (&take_json, error,
          "held vertex %u is let go before it is held", held.vertex);
    g_array_append_val (info->held, held);
  }
  return TRUE;
}

/* A line of vertices; the count of the first line is that of the second. */
static gboolean
parse_line (JsonNode * node, guint seam, ClothSeamLine * line, guint side,
    GError ** error)
{
  JsonArray *array = JSON_NODE_HOLDS_ARRAY (node) ?
      json_node_get_array (node) : NULL;
  guint n = array ? json_array_get_length (array) : 0;
  g_autoptr (GHashTable) seen = g_hash_table_new (NULL, NULL);

  if (n < 2)
    return cloth_json_invalid (&take_json, error,
        "a line of seam %u must be a list of at least two vertices", seam);
  if (side == 1 && n != line->n_vertices)
    return cloth_json_invalid (&take_json, error, "the lines of seam %u have "
        "%u and %u vertices; they are sewn vertex by vertex, so give both as "
        "many", seam, line->n_vertices, n);
  line->n_vertices = n;
  line->lines[side] = g_new (guint, n);
  for (guint i = 0; i < n; i++) {
    gdouble number;

    if (!cloth_json_number (json_array_get_element (array, i), &number) ||
        number != floor (number) || number < 0 || number >= CLOTH_MAX_VERTICES)
      return cloth_json_invalid (&take_json, error, "the lines of seam %u "
          "must be lists of vertices, whole numbers from 0 to %u", seam,
          CLOTH_MAX_VERTICES - 1);
    line->lines[side][i] = (guint) number;
    if (!g_hash_table_add (seen, GUINT_TO_POINTER ((guint) number)))
      return cloth_json_invalid (&take_json, error,
          "a line of seam %u has vertex %u twice", seam, (guint) number);
  }
  return TRUE;
}

static gboolean
parse_seams (JsonObject * root, ClothTakeInfo * info, GError ** error)
{
  static const gchar *const keys[] = { "lines", NULL };
  gboolean bad;
  JsonArray *list =
      cloth_json_get_list (&take_json, root, "seams", CLOTH_MAX_SEAMS,
      &bad, error);

  if (bad)
    return FALSE;
  if (list && json_array_get_length (list) > 0 && !info->mesh)
    return cloth_json_invalid (&take_json, error,
        "“seams” need a “mesh”; a grid is one piece");
  for (guint i = 0; list && i < json_array_get_length (list); i++) {
    JsonObject *object =
        cloth_json_item_object (&take_json, list, i, "seams", error);
    JsonArray *lines;
    ClothSeamLine *line;

    if (!object ||
        !cloth_json_check_keys (&take_json, object, "“seams”", keys, error))
      return FALSE;
    lines = cloth_json_get_list (&take_json, object, "lines", 2, &bad, error);
    if (bad)
      return FALSE;
    if (!lines || json_array_get_length (lines) != 2)
      return cloth_json_invalid (&take_json, error,
          "seam %u needs “lines”, a list of two lists of vertices", i);
    g_array_set_size (info->seams, i + 1);
    line = &g_array_index (info->seams, ClothSeamLine, i);
    for (guint side = 0; side < 2; side++)
      if (!parse_line (json_array_get_element (lines, side), i, line, side,
              error))
        return FALSE;
  }
  return TRUE;
}

static gboolean
parse_round (JsonObject * object,
    const gchar * what, const gchar * from, ClothObstacle * obstacle,
    GError ** error)
{
  if (!cloth_json_get_vector (&take_json, object, from, TRUE, obstacle->point,
          error) ||
      !cloth_json_get_number (&take_json, object, "radius_m", 1e-6, 1e6,
          &obstacle->radius_m, error))
    return FALSE;
  return obstacle->radius_m > 0 ||
      cloth_json_invalid (&take_json, error, "%s needs radius_m", what);
}

static gboolean
parse_plane (JsonObject * object, ClothObstacle * obstacle, GError ** error)
{
  if (!cloth_json_get_vector (&take_json, object, "point", TRUE,
          obstacle->point, error)
      || !cloth_json_get_vector (&take_json, object, "normal", TRUE,
          obstacle->normal, error))
    return FALSE;
  if (cloth_vec3_normalise (obstacle->normal) < 1e-9)
    return cloth_json_invalid (&take_json, error,
        "the “normal” of a plane has no length");
  return TRUE;
}

static gboolean
parse_mesh (JsonObject * object, ClothObstacle * obstacle, GError ** error)
{
  if (!cloth_json_get_string (&take_json, object, "mesh", &obstacle->mesh,
          error))
    return FALSE;
  return (obstacle->mesh && *obstacle->mesh) ||
      cloth_json_invalid (&take_json, error,
      "an obstacle of “type” mesh needs “mesh”, the name of an OBJ file");
}

static gboolean
parse_obstacle (JsonObject * object, ClothObstacle * obstacle, GError ** error)
{
  static const struct
  {
    const gchar *type, *what;
    const gchar *const keys[6];
  } shapes[] = {
    {"sphere", "a sphere", {"type", "centre", "radius_m", "friction", NULL}},
    {"plane", "a plane", {"type", "point", "normal", "friction", NULL}},
    {"capsule", "a capsule",
        {"type", "from", "to", "radius_m", "friction", NULL}},
    {"mesh", "a mesh", {"type", "mesh", "friction", NULL}}
  };
  g_autofree gchar *type = NULL;
  guint kind;

  obstacle->friction = NAN;
  if (!cloth_json_get_string (&take_json, object, "type", &type, error) ||
      !cloth_json_get_number (&take_json, object, "friction", 0, 100,
          &obstacle->friction, error))
    return FALSE;
  for (kind = 0; kind < G_N_ELEMENTS (shapes); kind++)
    if (g_strcmp0 (type, shapes[kind].type) == 0)
      break;
  if (kind == G_N_ELEMENTS (shapes))
    return cloth_json_invalid (&take_json, error,
        "the “type” of an obstacle " "is sphere, plane, capsule or mesh");
  obstacle->kind = (ClothObstacleKind) kind;
  if (!cloth_json_check_keys (&take_json, object, shapes[kind].what,
          shapes[kind].keys, error))
    return FALSE;
  switch (obstacle->kind) {
    case CLOTH_OBSTACLE_SPHERE:
      return parse_round (object, "a sphere", "centre", obstacle, error);
    case CLOTH_OBSTACLE_CAPSULE:
      return parse_round (object, "a capsule", "from", obstacle, error)
          && cloth_json_get_vector (&take_json, object, "to", TRUE,
          obstacle->end, error);
    case CLOTH_OBSTACLE_MESH:
      return parse_mesh (object, obstacle, error);
    default:
      return parse_plane (object, obstacle, error);
  }
}

/* Files of meshes are not touched; see cloth_obstacle_load_mesh (). */
static gboolean
parse_obstacles (JsonObject * root, GArray * obstacles, GError ** error)
{
  gboolean bad;
  JsonArray *list = cloth_json_get_list (&take_json, root, "obstacles",
      CLOTH_MAX_OBSTACLES, &bad, error);

  if (bad)
    return FALSE;
  for (guint i = 0; list && i < json_array_get_length (list); i++) {
    JsonObject *object =
        cloth_json_item_object (&take_json, list, i, "obstacles", error);
    ClothObstacle *obstacle;

    if (!object)
      return FALSE;
    g_array_set_size (obstacles, obstacles->len + 1);
    obstacle = &g_array_index (obstacles, ClothObstacle, obstacles->len - 1);
    if (!parse_obstacle (object, obstacle, error))
      return FALSE;
  }
  return TRUE;
}

static gboolean
parse_root (JsonObject * root, ClothTakeInfo * info, GError ** error)
{
  static const gchar *const keys[] = { "version", "name", "fps", "grid",
    "mesh", "held", "noise_sigma_m", "gravity", "obstacles", "seams", "notes",
    NULL
  };
  JsonNode *grid = cloth_json_find (root, "grid");
  guint version;

  if (!cloth_json_get_count (&take_json, root, "version", 0, G_MAXINT, &version,
          error))
    return FALSE;
  if (version != 1) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_UNSUPPORTED,
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
  return parse_held (root, info, error) &&
      parse_obstacles (root, info->obstacles, error) &&
      parse_seams (root, info, error);
}

/* @name: (nullable): name of the take
 *
 * Returns: (transfer full): a take's description with every default
 */
ClothTakeInfo *
cloth_take_info_new (const gchar * name)
{
  ClothTakeInfo *info = g_new0 (ClothTakeInfo, 1);

  info->name = g_strdup (name);
  info->held = g_array_new (FALSE, TRUE, sizeof (ClothHeld));
  info->obstacles = cloth_obstacles_new ();
  info->seams = cloth_seams_new ();
  info->noise_sigma_m = NAN;
  info->gravity[2] = -9.81;
  return info;
}

/* @json: the text of take.json
 * @size: its bytes
 * @error: #ClothFileError
 *
 * Reads and checks a description. No other file is touched. Unknown keys are an
 * error: a misspelt key would silently take its default.
 *
 * Returns: (transfer full): the description, or %NULL
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

/* A grid is told by its sizes, if take.json may have them and they give the same faces, and
 * the same uv but for what adding up cells or dividing the width rounds. */
static gboolean
is_grid (const ClothTopology * topology)
{
  g_autoptr (ClothTopology) grid = NULL;
  const gsize n = topology->n_vertices;
  const gfloat *last = topology->uv + 2 * (n - 1);

  if (topology->columns < 2 || topology->rows < 2 ||
      (gsize) topology->columns * topology->rows != n ||
      MIN (last[0], last[1]) < 1e-6f || MAX (last[0], last[1]) > 1e6f)
    return FALSE;
  grid = cloth_topology_new_grid (topology->columns, topology->rows, last[0],
      last[1]);
  for (gsize i = 0; i < 2 * n; i++) {
    if (!(fabs ((gdouble) grid->uv[i] - topology->uv[i]) <=
            GRID_ROUNDING * last[i % 2]))
      return FALSE;
    grid->uv[i] = topology->uv[i];
  }
  return cloth_topology_equal (grid, topology);
}

/* The shortest number that is this float32: 0.63, not 0.629999995. */
static gdouble
shortest (gfloat value)
{
  gdouble number;
  volatile gfloat narrowed;
  gint digits = 0;

  /* Nine digits are enough for any. */
  do {
    gchar format[8], text[G_ASCII_DTOSTR_BUF_SIZE];

    g_snprintf (format, sizeof format, "%%.%dg", ++digits);
    number = g_ascii_strtod (g_ascii_formatd (text, sizeof text, format, value),
        NULL);
    narrowed = (gfloat) number;
  } while (narrowed != value);
  return number;
}

/* @info: a description
 * @topology: the mesh of the take
 *
 * Sets the grid, or, where the mesh is none, the name of the file that shall hold it.
 */
void
cloth_take_info_set_mesh (ClothTakeInfo * info, const ClothTopology * topology)
{
  if (is_grid (topology)) {
    const gfloat *last = topology->uv + 2 * (gsize) (topology->n_vertices - 1);

    info->columns = topology->columns;
    info->rows = topology->rows;
    info->width_m = shortest (last[0]);
    info->height_m = shortest (last[1]);
  } else {
    info->mesh = g_strdup ("mesh.obj");
  }
}

static void
add_obstacles (JsonBuilder * builder, const GArray * obstacles)
{
  json_builder_set_member_name (builder, "obstacles");
  json_builder_begin_array (builder);
  for (guint i = 0; i < obstacles->len; i++) {
    const ClothObstacle *item = &g_array_index (obstacles, ClothObstacle, i);

    json_builder_begin_object (builder);
    switch (item->kind) {
      case CLOTH_OBSTACLE_SPHERE:
        cloth_json_add_string (builder, "type", "sphere");
        cloth_json_add_vector (builder, "centre", item->point);
        cloth_json_add_number (builder, "radius_m", item->radius_m);
        break;
      case CLOTH_OBSTACLE_PLANE:
        cloth_json_add_string (builder, "type", "plane");
        cloth_json_add_vector (builder, "point", item->point);
        cloth_json_add_vector (builder, "normal", item->normal);
        break;
      case CLOTH_OBSTACLE_CAPSULE:
        cloth_json_add_string (builder, "type", "capsule");
        cloth_json_add_vector (builder, "from", item->point);
        cloth_json_add_vector (builder, "to", item->end);
        cloth_json_add_number (builder, "radius_m", item->radius_m);
        break;
      case CLOTH_OBSTACLE_MESH:
        cloth_json_add_string (builder, "type", "mesh");
        cloth_json_add_string (builder, "mesh", item->mesh);
        break;
    }
    cloth_json_add_number (builder, "friction", item->friction);
    json_builder_end_object (builder);
  }
  json_builder_end_array (builder);
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
add_seams (JsonBuilder * builder, const GArray * seams)
{
  json_builder_set_member_name (builder, "seams");
  json_builder_begin_array (builder);
  for (guint i = 0; i < seams->len; i++) {
    const ClothSeamLine *line = &g_array_index (seams, ClothSeamLine, i);

    json_builder_begin_object (builder);
    json_builder_set_member_name (builder, "lines");
    json_builder_begin_array (builder);
    for (guint side = 0; side < 2; side++) {
      json_builder_begin_array (builder);
      for (guint k = 0; k < line->n_vertices; k++)
        json_builder_add_int_value (builder, line->lines[side][k]);
      json_builder_end_array (builder);
    }
    json_builder_end_array (builder);
    json_builder_end_object (builder);
  }
  json_builder_end_array (builder);
}

/* @info: a description
 *
 * Returns: (transfer full): the text of its take.json
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
  if (info->seams->len > 0)
    add_seams (builder, info->seams);
  if (info->notes)
    cloth_json_add_string (builder, "notes", info->notes);
  json_builder_end_object (builder);
  root = json_builder_get_root (builder);
  return json_to_string (root, TRUE);
}

/* @info: (transfer full) (nullable): a description
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
  g_array_unref (info->seams);
  g_free (info);
}

/* @info: a description
 *
 * For another take of the same scene. The files that it names have no folders any more,
 * which the other take need not have.
 *
 * Returns: (transfer full): a description
 */
ClothTakeInfo *
cloth_take_info_copy (const ClothTakeInfo * info)
{
  g_autofree gchar *json = cloth_take_info_to_json (info);
  ClothTakeInfo *copy = cloth_take_info_parse (json, strlen (json), NULL);

  if (copy->mesh) {
    g_free (copy->mesh);
    copy->mesh = g_strdup ("mesh.obj");
  }
  g_array_unref (copy->obstacles);
  copy->obstacles = cloth_obstacles_copy (info->obstacles);
  for (guint i = 0; i < copy->obstacles->len; i++) {
    ClothObstacle *item = &g_array_index (copy->obstacles, ClothObstacle, i);

    if (item->kind != CLOTH_OBSTACLE_MESH)
      continue;
    g_free (item->mesh);
    item->mesh = g_strdup_printf ("obstacle-%u.obj", i);
  }
  return copy;
}
