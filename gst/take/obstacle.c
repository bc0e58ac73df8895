/* What the cloth may touch.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/take/obstacle.h"

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

/* @obstacle: an obstacle of the kind mesh
 * @folder: where its file is
 * @error: #ClothFileError, #GIOErrorEnum
 *
 * Reads the triangles; quads are cut in two. No path leads out of @folder.
 *
 * Returns: %TRUE when there is at least one triangle; every corner is finite then
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
  if (topology->n_faces == 0)
    return cloth_file_invalid (error,
        "%s: an obstacle needs faces", obstacle->mesh);
  obstacle->n_points = topology->n_vertices;
  obstacle->points = g_new (gdouble, 3 * (gsize) topology->n_vertices);
  for (gsize i = 0; i < 3 * (gsize) topology->n_vertices; i++)
    obstacle->points[i] = obj->positions[i];
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
