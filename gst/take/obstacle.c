/* What the cloth may touch: reading, writing, copying.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/take/obstacle.h"

#include <math.h>
#include <string.h>

#include "gst/mesh/formats/formats.h"

static void
obstacle_clear (gpointer data)
{
  ClothObstacle *obstacle = data;

  g_free (obstacle->mesh);
  g_free (obstacle->points);
  g_free (obstacle->triangles);
}

/* Returns: (transfer full) (element-type ClothObstacle): an empty list, which frees
 *   what its items own
 */
GArray *
cloth_obstacles_new (void)
{
  GArray *obstacles = g_array_new (FALSE, TRUE, sizeof (ClothObstacle));

  g_array_set_clear_func (obstacles, obstacle_clear);
  return obstacles;
}

/* @obstacles: (element-type ClothObstacle): obstacles
 *
 * Returns: (transfer full) (element-type ClothObstacle): a deep copy
 */
GArray *
cloth_obstacles_copy (const GArray * obstacles)
{
  GArray *copies = cloth_obstacles_new ();

  for (guint i = 0; i < obstacles->len; i++) {
    ClothObstacle copy = g_array_index (obstacles, ClothObstacle, i);

    copy.mesh = g_strdup (copy.mesh);
    copy.points = g_memdup2 (copy.points, 3 * (gsize) copy.n_points *
        sizeof *copy.points);
    copy.triangles = g_memdup2 (copy.triangles, 3 * (gsize) copy.n_triangles *
        sizeof *copy.triangles);
    g_array_append_val (copies, copy);
  }
  return copies;
}

static gboolean
parse_round (const ClothJsonFile * file, JsonObject * object,
    const gchar * what, const gchar * from, ClothObstacle * obstacle,
    GError ** error)
{
  if (!cloth_json_get_vector (file, object, from, TRUE, obstacle->point,
          error) ||
      !cloth_json_get_number (file, object, "radius_m", 1e-6, 1e6,
          &obstacle->radius_m, error))
    return FALSE;
  return obstacle->radius_m > 0 ||
      cloth_json_invalid (file, error, "%s needs radius_m", what);
}

static gboolean
parse_plane (const ClothJsonFile * file, JsonObject * object,
    ClothObstacle * obstacle, GError ** error)
{
  gdouble *normal = obstacle->normal, length;

  if (!cloth_json_get_vector (file, object, "point", TRUE, obstacle->point,
          error) ||
      !cloth_json_get_vector (file, object, "normal", TRUE, normal, error))
    return FALSE;
  length = sqrt (normal[0] * normal[0] + normal[1] * normal[1] +
      normal[2] * normal[2]);
  if (length < 1e-9)
    return cloth_json_invalid (file, error,
        "the “normal” of a plane has no length");
  for (guint k = 0; k < 3; k++)
    normal[k] /= length;
  return TRUE;
}

static gboolean
parse_mesh (const ClothJsonFile * file, JsonObject * object,
    ClothObstacle * obstacle, GError ** error)
{
  if (!cloth_json_get_string (file, object, "mesh", &obstacle->mesh, error))
    return FALSE;
  return (obstacle->mesh && *obstacle->mesh) ||
      cloth_json_invalid (file, error,
      "an obstacle of “type” mesh needs “mesh”, the name of an OBJ file");
}

static gboolean
parse_obstacle (const ClothJsonFile * file, JsonObject * object,
    ClothObstacle * obstacle, GError ** error)
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
  if (!cloth_json_get_string (file, object, "type", &type, error) ||
      !cloth_json_get_number (file, object, "friction", 0, 100,
          &obstacle->friction, error))
    return FALSE;
  for (kind = 0; kind < G_N_ELEMENTS (shapes); kind++)
    if (g_strcmp0 (type, shapes[kind].type) == 0)
      break;
  if (kind == G_N_ELEMENTS (shapes))
    return cloth_json_invalid (file, error, "the “type” of an obstacle "
        "is sphere, plane, capsule or mesh");
  obstacle->kind = (ClothObstacleKind) kind;
  if (!cloth_json_check_keys (file, object, shapes[kind].what,
          shapes[kind].keys, error))
    return FALSE;
  switch (obstacle->kind) {
    case CLOTH_OBSTACLE_SPHERE:
      return parse_round (file, object, "a sphere", "centre", obstacle, error);
    case CLOTH_OBSTACLE_CAPSULE:
      return parse_round (file, object, "a capsule", "from", obstacle, error)
          && cloth_json_get_vector (file, object, "to", TRUE, obstacle->end,
          error);
    case CLOTH_OBSTACLE_MESH:
      return parse_mesh (file, object, obstacle, error);
    default:
      return parse_plane (file, object, obstacle, error);
  }
}

/* @file: whose object it is
 * @root: the object that may have the key `obstacles`
 * @obstacles: (element-type ClothObstacle): what is read is appended here
 * @error: as @file says
 *
 * Files of meshes are not touched; see cloth_obstacle_load_mesh ().
 *
 * Returns: %TRUE when every item is an obstacle
 */
gboolean
cloth_obstacles_parse (const ClothJsonFile * file, JsonObject * root,
    GArray * obstacles, GError ** error)
{
  gboolean bad;
  JsonArray *list = cloth_json_get_list (file, root, "obstacles",
      CLOTH_MAX_OBSTACLES, &bad, error);

  if (bad)
    return FALSE;
  for (guint i = 0; list && i < json_array_get_length (list); i++) {
    JsonObject *object =
        cloth_json_item_object (file, list, i, "obstacles", error);
    ClothObstacle *obstacle;

    if (!object)
      return FALSE;
    g_array_set_size (obstacles, obstacles->len + 1);
    obstacle = &g_array_index (obstacles, ClothObstacle, obstacles->len - 1);
    if (!parse_obstacle (file, object, obstacle, error))
      return FALSE;
  }
  return TRUE;
}

/* @obstacles: (element-type ClothObstacle): obstacles
 * @builder: is within an object; gets the key `obstacles`
 */
void
cloth_obstacles_build (const GArray * obstacles, JsonBuilder * builder)
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

/* @obstacle: an obstacle of the kind mesh
 * @folder: where its file is
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Reads the triangles; quads are cut in two. No path leads out of @folder.
 *
 * Returns: %TRUE when there is at least one triangle and every corner is finite
 */
gboolean
cloth_obstacle_load_mesh (ClothObstacle * obstacle, const gchar * folder,
    GError ** error)
{
  g_autofree gchar *path = cloth_path_inside (folder, obstacle->mesh, error);
  g_autoptr (ClothObj) obj = path ? cloth_obj_read (path, error) : NULL;
  const ClothTopology *topology;
  guint32 *triangle;

  if (!obj)
    return FALSE;
  topology = obj->topology;
  if (topology->n_faces == 0) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID,
        "%s: an obstacle needs faces", obstacle->mesh);
    return FALSE;
  }
  obstacle->n_points = topology->n_vertices;
  obstacle->points = g_new (gdouble, 3 * (gsize) topology->n_vertices);
  for (gsize i = 0; i < 3 * (gsize) topology->n_vertices; i++) {
    obstacle->points[i] = obj->positions[i];
    if (!isfinite (obstacle->points[i])) {
      g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_INVALID,
          "%s: point %u has no finite place", obstacle->mesh, (guint) (i / 3));
      return FALSE;
    }
  }
  obstacle->triangles = g_new (guint32, 6 * (gsize) topology->n_faces);
  triangle = obstacle->triangles;
  for (guint i = 0; i < topology->n_faces; i++) {
    const guint32 *face = topology->faces + 4 * (gsize) i;

    memcpy (triangle, face, 3 * sizeof *triangle);
    triangle += 3;
    if (face[3] == CLOTH_NO_VERTEX)
      continue;
    triangle[0] = face[0];
    triangle[1] = face[2];
    triangle[2] = face[3];
    triangle += 3;
  }
  obstacle->n_triangles = (guint) ((triangle - obstacle->triangles) / 3);
  return TRUE;
}
