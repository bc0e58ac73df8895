/* The topology of a mesh stream: what its streamheader says once.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/cloth/gstclothmesh.h"
#include "gst/cloth/gstclothprivate.h"

/* docs/streams.md holds the layout, byte by byte. */
#define TOPOLOGY_MAGIC "GCTP"
#define TOPOLOGY_VERSION 1
#define TOPOLOGY_HEADER 32

/* One allocation: this, uv, faces. */
struct _GstClothTopology
{
  guint n_vertices, columns, rows, n_faces;
  gfloat *uv;
  guint32 *faces;
};

G_DEFINE_BOXED_TYPE (GstClothTopology, gst_cloth_topology,
    gst_cloth_topology_ref, gst_cloth_topology_unref);

static gboolean
check_counts (guint n_vertices, guint columns, guint rows, guint n_faces,
    GError ** error)
{
  if (n_vertices < 1 || n_vertices > GST_CLOTH_MAX_VERTICES
      || n_faces > GST_CLOTH_MAX_FACES) {
    g_set_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_LIMIT,
        "A mesh of %u vertices and %u faces; between 1 and %d vertices and at "
        "most %d faces are possible", n_vertices, n_faces,
        GST_CLOTH_MAX_VERTICES, GST_CLOTH_MAX_FACES);
    return FALSE;
  }
  if ((columns || rows) && (guint64) columns * rows != n_vertices) {
    g_set_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE,
        "A grid of %u columns by %u rows of vertices has not %u vertices; "
        "give 0 by 0 for a mesh that is no grid", columns, rows, n_vertices);
    return FALSE;
  }
  return TRUE;
}

static gboolean
check_values (const GstClothTopology * topology, GError ** error)
{
  guint n = topology->n_vertices;

  for (guint i = 0; i < 2 * n; i++) {
    if (!isfinite (topology->uv[i])) {
      g_set_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE,
          "The uv of vertex %u is not finite", i / 2);
      return FALSE;
    }
  }
  for (guint i = 0; i < 4 * topology->n_faces; i++) {
    if (topology->faces[i] >= n
        && !(i % 4 == 3 && topology->faces[i] == GST_CLOTH_NO_VERTEX)) {
      g_set_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE,
          "Face %u names vertex %u of %u", i / 4, topology->faces[i], n);
      return FALSE;
    }
  }
  return TRUE;
}

static GstClothTopology *
topology_alloc (guint n_vertices, guint columns, guint rows, guint n_faces)
{
  GstClothTopology *topology = g_atomic_rc_box_alloc (sizeof (GstClothTopology)
      + 2 * sizeof (gfloat) * n_vertices + 4 * sizeof (guint32) * n_faces);

  topology->n_vertices = n_vertices;
  topology->columns = columns;
  topology->rows = rows;
  topology->n_faces = n_faces;
  topology->uv = (gfloat *) (topology + 1);
  topology->faces = (guint32 *) (topology->uv + 2 * n_vertices);
  return topology;
}

/**
 * gst_cloth_topology_new: (skip)
 * @n_vertices: vertices, 1 to #GST_CLOTH_MAX_VERTICES
 * @columns: vertices in a row when the mesh is one regular grid (vertex =
 *   row · columns + column), else 0
 * @rows: vertices in a column of that grid, else 0
 * @uv: 2·@n_vertices floats: u, v of each vertex on the flat cloth, metres; copied
 * @faces: (nullable): 4·@n_faces vertices, the last one of a triangle
 *   #GST_CLOTH_NO_VERTEX; counter-clockwise seen from the printed side; copied
 * @n_faces: faces, at most #GST_CLOTH_MAX_FACES; 0 for bare points
 * @error: return location for a #GST_CLOTH_ERROR
 *
 * Returns: (transfer full): a new topology, immutable; %NULL with @error set when a
 *   count is over its limit, the grid doesn't give @n_vertices, a uv isn't finite or a
 *   face names a vertex that isn't there
 *
 * Since: 0.1
 */
GstClothTopology *
gst_cloth_topology_new (guint n_vertices, guint columns, guint rows,
    const gfloat * uv, const guint32 * faces, guint n_faces, GError ** error)
{
  g_autoptr (GstClothTopology) topology = NULL;

  g_return_val_if_fail (uv != NULL, NULL);
  g_return_val_if_fail (faces || !n_faces, NULL);

  if (!check_counts (n_vertices, columns, rows, n_faces, error))
    return NULL;
  topology = topology_alloc (n_vertices, columns, rows, n_faces);
  memcpy (topology->uv, uv, 2 * sizeof (gfloat) * n_vertices);
  if (n_faces)
    memcpy (topology->faces, faces, 4 * sizeof (guint32) * n_faces);
  if (!check_values (topology, error))
    return NULL;
  return g_steal_pointer (&topology);
}

/**
 * gst_cloth_topology_new_from_arrays: (rename-to gst_cloth_topology_new)
 * @columns: vertices in a row when the mesh is one regular grid, else 0
 * @rows: vertices in a column of that grid, else 0
 * @uv: (array length=n_floats): u, v of each vertex on the flat cloth, metres
 * @n_floats: twice the vertices
 * @faces: (array length=n_indices) (nullable): four vertices a face
 * @n_indices: four times the faces
 * @error: return location for a #GST_CLOTH_ERROR
 *
 * gst_cloth_topology_new() for languages whose arrays know their length.
 *
 * Returns: (transfer full): a new topology
 *
 * Since: 0.1
 */
GstClothTopology *
gst_cloth_topology_new_from_arrays (guint columns, guint rows,
    const gfloat * uv, guint n_floats, const guint32 * faces, guint n_indices,
    GError ** error)
{
  if (n_floats % 2 || n_indices % 4) {
    g_set_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE,
        "%u floats of uv and %u vertices of faces; give two floats a vertex "
        "and four vertices a face", n_floats, n_indices);
    return NULL;
  }
  return gst_cloth_topology_new (n_floats / 2, columns, rows, uv, faces,
      n_indices / 4, error);
}

/**
 * gst_cloth_topology_new_grid:
 * @columns: vertices in a row, at least 2
 * @rows: vertices in a column, at least 2
 * @width_m: from the first to the last column on the flat cloth, metres
 * @height_m: from the first to the last row on the flat cloth, metres
 * @error: return location for a #GST_CLOTH_ERROR
 *
 * A regular grid of rectangles. Vertex (column, row) is number row·@columns + column
 * and lies at uv = (column·@width_m/(@columns−1), row·@height_m/(@rows−1)); row 0 is
 * the top edge. Face (column, row) is number row·(@columns−1) + column; its vertices
 * are top-left, bottom-left, bottom-right, top-right.
 *
 * Returns: (transfer full): a new topology; %NULL with @error set when a count or a
 *   size is out of range
 *
 * Since: 0.1
 */
GstClothTopology *
gst_cloth_topology_new_grid (guint columns, guint rows, gfloat width_m,
    gfloat height_m, GError ** error)
{
  GstClothTopology *topology;
  guint32 *face;

  if (columns < 2 || rows < 2
      || (guint64) columns * rows > GST_CLOTH_MAX_VERTICES) {
    g_set_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_LIMIT,
        "A grid of %u columns by %u rows of vertices; at least 2 by 2 and at "
        "most %d vertices are possible", columns, rows, GST_CLOTH_MAX_VERTICES);
    return NULL;
  }
  if (!(isfinite (width_m) && isfinite (height_m) && width_m > 0
          && height_m > 0)) {
    g_set_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE,
        "A cloth of %g m by %g m; give sizes over 0", width_m, height_m);
    return NULL;
  }

  topology = topology_alloc (columns * rows, columns, rows,
      (columns - 1) * (rows - 1));
  face = topology->faces;
  for (guint r = 0, i = 0; r < rows; r++) {
    for (guint c = 0; c < columns; c++, i++) {
      topology->uv[2 * i] = (gfloat) ((gdouble) width_m * c / (columns - 1));
      topology->uv[2 * i + 1] = (gfloat) ((gdouble) height_m * r / (rows - 1));
      if (r + 1 < rows && c + 1 < columns) {
        face[0] = i;
        face[1] = i + columns;
        face[2] = i + columns + 1;
        face[3] = i + 1;
        face += 4;
      }
    }
  }
  return topology;
}

/**
 * gst_cloth_topology_ref:
 * @topology: a topology
 *
 * Returns: (transfer full): the same, with one more reference
 *
 * Since: 0.1
 */
GstClothTopology *
gst_cloth_topology_ref (GstClothTopology * topology)
{
  return g_atomic_rc_box_acquire (topology);
}

/**
 * gst_cloth_topology_unref:
 * @topology: (transfer full): a topology
 *
 * Gives a reference back; the last one frees.
 *
 * Since: 0.1
 */
void
gst_cloth_topology_unref (GstClothTopology * topology)
{
  g_atomic_rc_box_release (topology);
}

/**
 * gst_cloth_topology_get_n_vertices:
 * @topology: a topology
 *
 * Returns: vertices
 *
 * Since: 0.1
 */
guint
gst_cloth_topology_get_n_vertices (const GstClothTopology * topology)
{
  return topology->n_vertices;
}

/**
 * gst_cloth_topology_get_columns:
 * @topology: a topology
 *
 * Returns: vertices in a row when the mesh is one regular grid, else 0
 *
 * Since: 0.1
 */
guint
gst_cloth_topology_get_columns (const GstClothTopology * topology)
{
  return topology->columns;
}

/**
 * gst_cloth_topology_get_rows:
 * @topology: a topology
 *
 * Returns: vertices in a column when the mesh is one regular grid, else 0
 *
 * Since: 0.1
 */
guint
gst_cloth_topology_get_rows (const GstClothTopology * topology)
{
  return topology->rows;
}

/**
 * gst_cloth_topology_get_n_faces:
 * @topology: a topology
 *
 * Returns: faces
 *
 * Since: 0.1
 */
guint
gst_cloth_topology_get_n_faces (const GstClothTopology * topology)
{
  return topology->n_faces;
}

/**
 * gst_cloth_topology_get_uv:
 * @topology: a topology
 * @n_floats: (out) (optional): twice the vertices
 *
 * Returns: (array length=n_floats) (transfer none): u, v of each vertex on the flat
 *   cloth, metres; valid as long as @topology is
 *
 * Since: 0.1
 */
const gfloat *
gst_cloth_topology_get_uv (const GstClothTopology * topology, guint * n_floats)
{
  if (n_floats)
    *n_floats = 2 * topology->n_vertices;
  return topology->uv;
}

/**
 * gst_cloth_topology_get_faces:
 * @topology: a topology
 * @n_indices: (out) (optional): four times the faces
 *
 * Returns: (array length=n_indices) (transfer none): four vertices a face, the last one
 *   of a triangle #GST_CLOTH_NO_VERTEX; valid as long as @topology is
 *
 * Since: 0.1
 */
const guint32 *
gst_cloth_topology_get_faces (const GstClothTopology * topology,
    guint * n_indices)
{
  if (n_indices)
    *n_indices = 4 * topology->n_faces;
  return topology->faces;
}

/**
 * gst_cloth_topology_to_buffer:
 * @topology: a topology
 *
 * Returns: (transfer full): a new buffer in the layout of the streamheader
 *
 * Since: 0.1
 */
GstBuffer *
gst_cloth_topology_to_buffer (const GstClothTopology * topology)
{
  gsize n_uv, n_faces, size;
  guint8 *bytes;

  g_return_val_if_fail (topology != NULL, NULL);

  n_uv = 2 * (gsize) topology->n_vertices;
  n_faces = 4 * (gsize) topology->n_faces;
  size = TOPOLOGY_HEADER + 4 * (n_uv + n_faces);
  bytes = g_malloc (size);
  memset (bytes, 0, TOPOLOGY_HEADER);
  memcpy (bytes, TOPOLOGY_MAGIC, 4);
  GST_WRITE_UINT16_LE (bytes + 4, TOPOLOGY_VERSION);
  GST_WRITE_UINT16_LE (bytes + 6, TOPOLOGY_HEADER);
  GST_WRITE_UINT32_LE (bytes + 8, topology->n_vertices);
  GST_WRITE_UINT32_LE (bytes + 12, topology->columns);
  GST_WRITE_UINT32_LE (bytes + 16, topology->rows);
  GST_WRITE_UINT32_LE (bytes + 20, topology->n_faces);
  gst_cloth_copy_le32 (bytes + TOPOLOGY_HEADER, topology->uv, n_uv);
  gst_cloth_copy_le32 (bytes + TOPOLOGY_HEADER + 4 * n_uv, topology->faces,
      n_faces);
  return gst_buffer_new_wrapped (bytes, size);
}

static GstClothTopology *
topology_parse (const guint8 * bytes, gsize size, GError ** error)
{
  g_autoptr (GstClothTopology) topology = NULL;
  guint n_vertices, columns, rows, n_faces;

  if (!gst_cloth_check_header (bytes, size, TOPOLOGY_MAGIC, TOPOLOGY_VERSION,
          TOPOLOGY_HEADER, "topology", error))
    return NULL;
  n_vertices = gst_cloth_read_u32 (bytes + 8);
  columns = gst_cloth_read_u32 (bytes + 12);
  rows = gst_cloth_read_u32 (bytes + 16);
  n_faces = gst_cloth_read_u32 (bytes + 20);
  if (!check_counts (n_vertices, columns, rows, n_faces, error)
      || !gst_cloth_check_size (size, TOPOLOGY_HEADER + 8 * (gsize) n_vertices
          + 16 * (gsize) n_faces, "topology", error))
    return NULL;

  topology = topology_alloc (n_vertices, columns, rows, n_faces);
  bytes += TOPOLOGY_HEADER;
  gst_cloth_copy_le32 (topology->uv, bytes, 2 * (gsize) n_vertices);
  gst_cloth_copy_le32 (topology->faces, bytes + 8 * (gsize) n_vertices,
      4 * (gsize) n_faces);
  if (!check_values (topology, error))
    return NULL;
  return g_steal_pointer (&topology);
}

/**
 * gst_cloth_topology_from_buffer:
 * @buffer: a buffer in the layout of the streamheader
 * @error: return location for a #GST_CLOTH_ERROR
 *
 * Returns: (transfer full): a new topology; %NULL with @error set when the bytes are no
 *   valid topology
 *
 * Since: 0.1
 */
GstClothTopology *
gst_cloth_topology_from_buffer (GstBuffer * buffer, GError ** error)
{
  GstClothTopology *topology;
  GstMapInfo map;

  g_return_val_if_fail (GST_IS_BUFFER (buffer), NULL);

  if (!gst_cloth_map (buffer, &map, error))
    return NULL;
  topology = topology_parse (map.data, map.size, error);
  gst_buffer_unmap (buffer, &map);
  return topology;
}

/**
 * gst_cloth_topology_to_caps:
 * @topology: a topology
 * @fps_n: numerator of the frames per second; 0 when they vary
 * @fps_d: denominator of the frames per second, over 0
 *
 * Returns: (transfer full): caps of a mesh stream, with @topology as streamheader
 *
 * Since: 0.1
 */
GstCaps *
gst_cloth_topology_to_caps (const GstClothTopology * topology, gint fps_n,
    gint fps_d)
{
  g_return_val_if_fail (topology != NULL, NULL);
  g_return_val_if_fail (fps_n >= 0 && fps_d > 0, NULL);

  return gst_cloth_caps_with_header (gst_caps_new_simple
      (GST_CLOTH_MESH_MEDIA_TYPE, "version", G_TYPE_INT, 1, "vertices",
          G_TYPE_INT, topology->n_vertices, "framerate", GST_TYPE_FRACTION,
          fps_n, fps_d, NULL), gst_cloth_topology_to_buffer (topology));
}

/**
 * gst_cloth_topology_from_caps:
 * @caps: fixed caps of a mesh stream
 * @error: return location for a #GST_CLOTH_ERROR
 *
 * Returns: (transfer full): the topology that the streamheader of @caps holds; %NULL
 *   with @error set when @caps are of another stream, have no streamheader, or differ
 *   from it in the number of vertices
 *
 * Since: 0.1
 */
GstClothTopology *
gst_cloth_topology_from_caps (const GstCaps * caps, GError ** error)
{
  g_autoptr (GstClothTopology) topology = NULL;
  const GstStructure *structure;
  const GValue *headers, *header;
  GstBuffer *buffer = NULL;
  gint version, vertices;

  g_return_val_if_fail (GST_IS_CAPS (caps), NULL);

  structure = gst_caps_get_size (caps) ? gst_caps_get_structure (caps, 0) :
      NULL;
  if (!structure
      || !gst_structure_has_name (structure, GST_CLOTH_MESH_MEDIA_TYPE)
      || !gst_structure_get_int (structure, "vertices", &vertices)) {
    g_set_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_CAPS,
        "These are not caps of a mesh stream (" GST_CLOTH_MESH_MEDIA_TYPE
        " with a number of vertices)");
    return NULL;
  }
  if (gst_structure_get_int (structure, "version", &version) && version != 1) {
    g_set_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VERSION,
        "The mesh stream is of version %d; this library reads version 1",
        version);
    return NULL;
  }
  headers = gst_structure_get_value (structure, "streamheader");
  if (headers && GST_VALUE_HOLDS_ARRAY (headers)
      && gst_value_array_get_size (headers) == 1) {
    header = gst_value_array_get_value (headers, 0);
    if (GST_VALUE_HOLDS_BUFFER (header))
      buffer = gst_value_get_buffer (header);
  }
  if (!buffer) {
    g_set_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_CAPS,
        "The caps of the mesh stream carry no topology; their streamheader "
        "must be an array of one buffer");
    return NULL;
  }
  if (!(topology = gst_cloth_topology_from_buffer (buffer, error)))
    return NULL;
  if (vertices < 0 || (guint) vertices != topology->n_vertices) {
    g_set_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_CAPS,
        "The caps say %d vertices, their streamheader %u", vertices,
        topology->n_vertices);
    return NULL;
  }
  return g_steal_pointer (&topology);
}
