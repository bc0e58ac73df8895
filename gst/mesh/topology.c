/* Which vertices make a face, where each lies on the flat cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/topology.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* @n_vertices: number of vertices
 * @n_faces: number of faces
 *
 * Returns: (transfer full): a topology with zeroed arrays, to be filled
 */
ClothTopology *
cloth_topology_new (guint n_vertices, guint n_faces)
{
  ClothTopology *topology = g_new0 (ClothTopology, 1);

  topology->n_vertices = n_vertices;
  topology->uv = g_new0 (gfloat, 2 * (gsize) n_vertices + 1);
  topology->n_faces = n_faces;
  topology->faces = g_new0 (guint32, 4 * (gsize) n_faces + 1);
  return topology;
}

/* @columns: vertices of a row, at least 2
 * @rows: rows of vertices, at least 2
 * @width_m: from the first to the last column, metres
 * @height_m: from the first to the last row, metres
 *
 * A regular grid of quads: vertex = row * columns + column, row 0 the top edge,
 * u to the right, v down.
 *
 * Returns: (transfer full): the grid
 */
ClothTopology *
cloth_topology_new_grid (guint columns, guint rows, gfloat width_m,
    gfloat height_m)
{
  ClothTopology *topology =
      cloth_topology_new (columns * rows, (columns - 1) * (rows - 1));
  guint32 *face = topology->faces;

  topology->columns = columns;
  topology->rows = rows;
  for (guint row = 0; row < rows; row++) {
    for (guint column = 0; column < columns; column++) {
      guint vertex = row * columns + column;

      topology->uv[2 * vertex] =
          (gfloat) ((gdouble) width_m * column / (columns - 1));
      topology->uv[2 * vertex + 1] =
          (gfloat) ((gdouble) height_m * row / (rows - 1));
      if (row + 1 < rows && column + 1 < columns) {
        face[0] = vertex;
        face[1] = vertex + columns;
        face[2] = vertex + columns + 1;
        face[3] = vertex + 1;
        face += 4;
      }
    }
  }
  return topology;
}

/* @topology: a topology
 *
 * Returns: (transfer full): a deep copy
 */
ClothTopology *
cloth_topology_copy (const ClothTopology * topology)
{
  ClothTopology *copy = g_memdup2 (topology, sizeof *topology);

  copy->uv = g_memdup2 (topology->uv,
      (2 * (gsize) topology->n_vertices + 1) * sizeof *copy->uv);
  copy->faces = g_memdup2 (topology->faces,
      (4 * (gsize) topology->n_faces + 1) * sizeof *copy->faces);
  return copy;
}

/* @a: a topology
 * @b: another
 *
 * Returns: %TRUE when vertices, faces, grid and uv are the same
 */
gboolean
cloth_topology_equal (const ClothTopology * a, const ClothTopology * b)
{
  return a->n_vertices == b->n_vertices && a->n_faces == b->n_faces &&
      a->columns == b->columns && a->rows == b->rows &&
      memcmp (a->uv, b->uv, 2 * (gsize) a->n_vertices * sizeof *a->uv) == 0 &&
      memcmp (a->faces, b->faces,
      4 * (gsize) a->n_faces * sizeof *a->faces) == 0;
}

/* @topology: what a file said
 * @error: #ClothFileError
 *
 * Checks the limits, every index and every uv.
 *
 * Returns: %TRUE when all is in range
 */
gboolean
cloth_topology_check (const ClothTopology * topology, GError ** error)
{
  guint n = topology->n_vertices;

  if (n == 0 || n > CLOTH_MAX_VERTICES || topology->n_faces > CLOTH_MAX_FACES) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
        "%u vertices and %u faces: between 1 and %u vertices and at most %u "
        "faces are accepted", n, topology->n_faces, CLOTH_MAX_VERTICES,
        CLOTH_MAX_FACES);
    return FALSE;
  }
  for (gsize i = 0; i < 2 * (gsize) n; i++) {
    if (!isfinite (topology->uv[i]))
      return cloth_file_invalid (error,
          "the uv of vertex %u is no finite number", (guint) (i / 2));
  }
  for (gsize i = 0; i < 4 * (gsize) topology->n_faces; i++) {
    guint32 index = topology->faces[i];

    if (index >= n && !(i % 4 == 3 && index == CLOTH_NO_VERTEX))
      return cloth_file_invalid (error,
          "face %u names a vertex that is not there (there are %u)",
          (guint) (i / 4), n);
  }
  return TRUE;
}

/* @topology: (transfer full) (nullable): a topology
 */
void
cloth_topology_free (ClothTopology * topology)
{
  if (!topology)
    return;
  g_free (topology->uv);
  g_free (topology->faces);
  g_free (topology);
}

/* @positions: 3 numbers a vertex
 * @n_vertices: how many vertices
 * @error: #ClothFileError
 *
 * A vertex is either seen, three finite numbers, or not seen, three NaN.
 *
 * Returns: %TRUE when every vertex is one of the two
 */
gboolean
cloth_positions_check (const gfloat * positions, guint n_vertices,
    GError ** error)
{
  for (guint i = 0; i < n_vertices; i++, positions += 3) {
    /* Finite numbers of a scale of metres have a finite sum; it tells most. */
    if (isfinite (positions[0] + positions[1] + positions[2]))
      continue;
    if (isnan (positions[0]) && isnan (positions[1]) && isnan (positions[2]))
      continue;
    return cloth_file_invalid (error,
        "the position of vertex %u is neither three finite numbers nor three "
        "NaN", i);
  }
  return TRUE;
}

/* @states: a #ClothVertexState a vertex
 * @n_vertices: how many
 * @error: #ClothFileError
 *
 * Returns: %TRUE when every one is known
 */
gboolean
cloth_states_check (const guint8 * states, guint n_vertices, GError ** error)
{
  for (guint i = 0; i < n_vertices; i++) {
    if (states[i] > CLOTH_VERTEX_PREDICTED)
      return cloth_file_invalid (error,
          "vertex %u has the state %u, which is not between 0 and 4", i,
          states[i]);
  }
  return TRUE;
}

/* @topology: a topology
 * @fps_n: numerator of the frame rate, 0 when it varies
 * @fps_d: its denominator
 *
 * Returns: (transfer full): the text of the comment
 */
gchar *
cloth_mesh_note_format (const ClothTopology * topology, gint fps_n, gint fps_d)
{
  return g_strdup_printf ("gst-cloth fps %d/%d grid %u %u", fps_n, fps_d,
      topology->columns, topology->rows);
}

/* @text: a comment, without the characters that start it
 * @note: (out): set when it is one of ours
 *
 * Returns: %TRUE when it is
 */
gboolean
cloth_mesh_note_parse (const gchar * text, ClothMeshNote * note)
{
  gint fps_n, fps_d;
  guint columns, rows;

  while (*text == ' ')
    text++;
  /* Nine digits cannot overflow. */
  if (sscanf (text, "gst-cloth fps %9d/%9d grid %9u %9u", &fps_n, &fps_d,
          &columns, &rows) != 4 || fps_n < 0 || fps_d < 1)
    return FALSE;
  note->fps = (gdouble) fps_n / fps_d;
  note->columns = columns;
  note->rows = rows;
  return TRUE;
}

/* @note: a comment's contents
 * @topology: the topology read
 *
 * Marks @topology as the grid the comment claims, if the mesh has its vertices and
 * faces; another program may have cut the mesh and kept the comment.
 */
void
cloth_mesh_note_apply (const ClothMeshNote * note, ClothTopology * topology)
{
  guint64 vertices = (guint64) note->columns * note->rows;
  guint faces;

  if (note->columns < 2 || note->rows < 2 || vertices != topology->n_vertices)
    return;
  faces = (note->columns - 1) * (note->rows - 1);
  if (topology->n_faces != faces && topology->n_faces != 2 * faces)
    return;
  topology->columns = note->columns;
  topology->rows = note->rows;
}
