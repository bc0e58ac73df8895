/* One frame of a mesh stream. The payload *is* the wire's bytes on a little-endian host,
 * so writing and reading a buffer copy nothing.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/cloth/gstclothmesh.h"
#include "gst/cloth/gstclothprivate.h"

/* docs/streams.md holds the layout, byte by byte. */
#define MESH_MAGIC "GCMB"
#define MESH_VERSION 1
#define MESH_HEADER 32
#define MESH_HAS_COVARIANCES 1u

struct _GstClothMesh
{
  guint n_vertices;
  guint64 sequence;
  const gfloat *positions;
  const gfloat *covariances;
  const guint8 *states;
  /* the buffer the arrays lie in, mapped; else they lie behind this struct */
  GstBuffer *buffer;
  GstMapInfo map;
};

G_DEFINE_BOXED_TYPE (GstClothMesh, gst_cloth_mesh, gst_cloth_mesh_ref,
    gst_cloth_mesh_unref);

static gsize
mesh_size (guint n_vertices, gboolean covariances)
{
  return MESH_HEADER + (gsize) n_vertices *(covariances ? 37 : 13);
}

/* Puts the arrays at @body, which holds them as the wire does. */
static void
mesh_place (GstClothMesh * mesh, const guint8 * body, gboolean covariances)
{
  gsize n = mesh->n_vertices;

  mesh->positions = (const gfloat *) body;
  mesh->covariances = covariances ? mesh->positions + 3 * n : NULL;
  mesh->states = body + 4 * n * (covariances ? 9 : 3);
}

static GstClothMesh *
mesh_alloc (guint64 sequence, guint n_vertices, gboolean covariances,
    gboolean with_bytes)
{
  GstClothMesh *mesh = g_atomic_rc_box_alloc (sizeof (GstClothMesh)
      + (with_bytes ? mesh_size (n_vertices, covariances) : 0));

  mesh->n_vertices = n_vertices;
  mesh->sequence = sequence;
  mesh->buffer = NULL;
  if (with_bytes) {
    guint8 *bytes = (guint8 *) (mesh + 1);

    memset (bytes, 0, MESH_HEADER);
    memcpy (bytes, MESH_MAGIC, 4);
    GST_WRITE_UINT16_LE (bytes + 4, MESH_VERSION);
    GST_WRITE_UINT16_LE (bytes + 6, MESH_HEADER);
    GST_WRITE_UINT64_LE (bytes + 8, sequence);
    GST_WRITE_UINT32_LE (bytes + 16, n_vertices);
    GST_WRITE_UINT32_LE (bytes + 20, covariances ? MESH_HAS_COVARIANCES : 0);
    mesh_place (mesh, bytes + MESH_HEADER, covariances);
  }
  return mesh;
}

/**
 * gst_cloth_mesh_new: (skip)
 * @sequence: number of the frame
 * @n_vertices: vertices, 1 to #GST_CLOTH_MAX_VERTICES
 * @positions: 3·@n_vertices floats: x, y, z of each vertex, metres, world frame (z up,
 *   right-handed); NaN when unseen; copied
 * @states: @n_vertices bytes, each a #GstClothVertexState; copied
 * @covariances: (nullable): 6·@n_vertices floats: xx, xy, xz, yy, yz, zz of each vertex,
 *   m², NaN where not known; copied
 *
 * A vertex is either known in full or unseen: where @states says unseen or a coordinate
 * isn't finite, the copy's state becomes unseen and its floats NaN.
 *
 * Returns: (transfer full): a new mesh, immutable
 *
 * Since: 0.1
 */
GstClothMesh *
gst_cloth_mesh_new (guint64 sequence, guint n_vertices,
    const gfloat * positions, const guint8 * states, const gfloat * covariances)
{
  GstClothMesh *mesh;
  gfloat *p, *c;
  guint8 *s;

  g_return_val_if_fail (positions != NULL && states != NULL, NULL);
  g_return_val_if_fail (n_vertices >= 1
      && n_vertices <= GST_CLOTH_MAX_VERTICES, NULL);

  mesh = mesh_alloc (sequence, n_vertices, covariances != NULL, TRUE);
  p = (gfloat *) mesh->positions;
  c = (gfloat *) mesh->covariances;
  s = (guint8 *) mesh->states;
  memcpy (p, positions, 3 * sizeof (gfloat) * n_vertices);
  memcpy (s, states, n_vertices);
  if (c)
    memcpy (c, covariances, 6 * sizeof (gfloat) * n_vertices);

  for (gsize i = 0; i < n_vertices; i++) {
    if (s[i] == GST_CLOTH_VERTEX_UNSEEN || s[i] > GST_CLOTH_VERTEX_PREDICTED
        || !isfinite (p[3 * i]) || !isfinite (p[3 * i + 1])
        || !isfinite (p[3 * i + 2])) {
      s[i] = GST_CLOTH_VERTEX_UNSEEN;
      for (guint k = 0; k < 3; k++)
        p[3 * i + k] = NAN;
      for (guint k = 0; c && k < 6; k++)
        c[6 * i + k] = NAN;
    }
    for (guint k = 0; c && k < 6; k++)
      if (!isfinite (c[6 * i + k]))
        c[6 * i + k] = NAN;
  }
  return mesh;
}

/**
 * gst_cloth_mesh_new_from_arrays: (rename-to gst_cloth_mesh_new)
 * @sequence: number of the frame
 * @positions: (array length=n_positions): x, y, z of each vertex, metres
 * @n_positions: three times the vertices
 * @states: (array length=n_states): a #GstClothVertexState byte a vertex
 * @n_states: the vertices
 * @covariances: (array length=n_covariances) (nullable): six floats a vertex, m²
 * @n_covariances: six times the vertices
 * @error: return location for a #GST_CLOTH_ERROR
 *
 * gst_cloth_mesh_new() for languages whose arrays know their length.
 *
 * Returns: (transfer full): a new mesh; %NULL with @error set when the lengths don't
 *   agree
 *
 * Since: 0.1
 */
GstClothMesh *
gst_cloth_mesh_new_from_arrays (guint64 sequence, const gfloat * positions,
    guint n_positions, const guint8 * states, guint n_states,
    const gfloat * covariances, guint n_covariances, GError ** error)
{
  if (n_states < 1 || n_states > GST_CLOTH_MAX_VERTICES
      || n_positions != 3 * n_states
      || (covariances && n_covariances != 6 * n_states)) {
    g_set_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE,
        "%u floats of positions, %u states and %u floats of covariances; give "
        "3, 1 and 6 (or none) a vertex, of 1 to %d vertices", n_positions,
        n_states, n_covariances, GST_CLOTH_MAX_VERTICES);
    return NULL;
  }
  return gst_cloth_mesh_new (sequence, n_states, positions, states,
      covariances);
}

/**
 * gst_cloth_mesh_ref:
 * @mesh: a mesh
 *
 * Returns: (transfer full): the same, with one more reference
 *
 * Since: 0.1
 */
GstClothMesh *
gst_cloth_mesh_ref (GstClothMesh * mesh)
{
  return g_atomic_rc_box_acquire (mesh);
}

static void
mesh_clear (gpointer data)
{
  GstClothMesh *mesh = data;

  if (mesh->buffer) {
    gst_buffer_unmap (mesh->buffer, &mesh->map);
    gst_buffer_unref (mesh->buffer);
  }
}

/**
 * gst_cloth_mesh_unref:
 * @mesh: (transfer full): a mesh
 *
 * Gives a reference back; the last one frees.
 *
 * Since: 0.1
 */
void
gst_cloth_mesh_unref (GstClothMesh * mesh)
{
  g_atomic_rc_box_release_full (mesh, mesh_clear);
}

/**
 * gst_cloth_mesh_get_sequence:
 * @mesh: a mesh
 *
 * Returns: number of the frame
 *
 * Since: 0.1
 */
guint64
gst_cloth_mesh_get_sequence (const GstClothMesh * mesh)
{
  return mesh->sequence;
}

/**
 * gst_cloth_mesh_get_n_vertices:
 * @mesh: a mesh
 *
 * Returns: vertices
 *
 * Since: 0.1
 */
guint
gst_cloth_mesh_get_n_vertices (const GstClothMesh * mesh)
{
  return mesh->n_vertices;
}

/**
 * gst_cloth_mesh_get_positions:
 * @mesh: a mesh
 * @n_floats: (out) (optional): three times the vertices
 *
 * Returns: (array length=n_floats) (transfer none): x, y, z of each vertex, metres,
 *   world frame; all three NaN when unseen; valid as long as @mesh is
 *
 * Since: 0.1
 */
const gfloat *
gst_cloth_mesh_get_positions (const GstClothMesh * mesh, guint * n_floats)
{
  if (n_floats)
    *n_floats = 3 * mesh->n_vertices;
  return mesh->positions;
}

static void
mesh_release (gpointer mesh)
{
  gst_cloth_mesh_unref (mesh);
}

/**
 * gst_cloth_mesh_get_points:
 * @mesh: a mesh
 *
 * The positions for languages whose lists of numbers are slow. Nothing is copied: the bytes are
 * those of @mesh, which they keep alive.
 *
 * Returns: (transfer full): float32 [vertices][3]: x, y, z of each vertex, metres, world
 *   frame; all three NaN when unseen
 *
 * Since: 0.2
 */
GBytes *
gst_cloth_mesh_get_points (GstClothMesh * mesh)
{
  return g_bytes_new_with_free_func (mesh->positions,
      3 * sizeof (gfloat) * (gsize) mesh->n_vertices, mesh_release,
      gst_cloth_mesh_ref (mesh));
}

/**
 * gst_cloth_mesh_get_states:
 * @mesh: a mesh
 * @n_states: (out) (optional): the vertices
 *
 * Returns: (array length=n_states) (transfer none): a #GstClothVertexState a vertex;
 *   valid as long as @mesh is
 *
 * Since: 0.1
 */
const guint8 *
gst_cloth_mesh_get_states (const GstClothMesh * mesh, guint * n_states)
{
  if (n_states)
    *n_states = mesh->n_vertices;
  return mesh->states;
}

/**
 * gst_cloth_mesh_get_covariances:
 * @mesh: a mesh
 * @n_floats: (out) (optional): six times the vertices, or 0
 *
 * Returns: (array length=n_floats) (transfer none) (nullable): xx, xy, xz, yy, yz, zz of
 *   each vertex, m², NaN where not known; %NULL when the mesh has none; valid as long
 *   as @mesh is
 *
 * Since: 0.1
 */
const gfloat *
gst_cloth_mesh_get_covariances (const GstClothMesh * mesh, guint * n_floats)
{
  if (n_floats)
    *n_floats = mesh->covariances ? 6 * mesh->n_vertices : 0;
  return mesh->covariances;
}

#if G_BYTE_ORDER != G_LITTLE_ENDIAN
static GstBuffer *
mesh_to_swapped_buffer (const GstClothMesh * mesh)
{
  gsize size = mesh_size (mesh->n_vertices, mesh->covariances != NULL);
  guint8 *bytes = g_memdup2 ((const guint8 *) mesh->positions - MESH_HEADER,
      size);

  gst_cloth_copy_le32 (bytes + MESH_HEADER, mesh->positions,
      (gsize) mesh->n_vertices * (mesh->covariances ? 9 : 3));
  return gst_buffer_new_wrapped (bytes, size);
}
#endif

/**
 * gst_cloth_mesh_to_buffer:
 * @mesh: a mesh
 *
 * Returns: (transfer full): a new buffer in the layout of the mesh stream; its memory is
 *   read-only and is that of @mesh, which it keeps alive
 *
 * Since: 0.1
 */
GstBuffer *
gst_cloth_mesh_to_buffer (const GstClothMesh * mesh)
{
  g_return_val_if_fail (mesh != NULL, NULL);

#if G_BYTE_ORDER == G_LITTLE_ENDIAN
  {
    gsize size = mesh_size (mesh->n_vertices, mesh->covariances != NULL);
    guint8 *bytes = (guint8 *) mesh->positions - MESH_HEADER;

    return gst_buffer_new_wrapped_full (GST_MEMORY_FLAG_READONLY, bytes, size,
        0, size, gst_cloth_mesh_ref ((GstClothMesh *) mesh), mesh_release);
  }
#else
  return mesh_to_swapped_buffer (mesh);
#endif
}

static gboolean
check_values (const GstClothMesh * mesh, GError ** error)
{
  for (gsize i = 0; i < mesh->n_vertices; i++) {
    const gfloat *p = &mesh->positions[3 * i];
    guint8 state = mesh->states[i];

    if (state > GST_CLOTH_VERTEX_PREDICTED) {
      g_set_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE,
          "Vertex %" G_GSIZE_FORMAT " has the unknown state %u", i, state);
      return FALSE;
    }
    if (state == GST_CLOTH_VERTEX_UNSEEN ? !(isnan (p[0]) && isnan (p[1])
            && isnan (p[2])) : !(isfinite (p[0]) && isfinite (p[1])
            && isfinite (p[2]))) {
      g_set_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE,
          "Vertex %" G_GSIZE_FORMAT " is %s, but its position is (%g, %g, %g)",
          i, state == GST_CLOTH_VERTEX_UNSEEN ? "unseen" : "seen", p[0], p[1],
          p[2]);
      return FALSE;
    }
    for (gsize k = 6 * i; mesh->covariances && k < 6 * i + 6; k++) {
      if (isinf (mesh->covariances[k])) {
        g_set_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE,
            "Vertex %" G_GSIZE_FORMAT " has an infinite covariance", i);
        return FALSE;
      }
    }
  }
  return TRUE;
}

/**
 * gst_cloth_mesh_from_buffer:
 * @buffer: a buffer of a mesh stream
 * @error: return location for a #GST_CLOTH_ERROR
 *
 * Reads a frame. Nothing is copied when the memory of @buffer is in one piece: the mesh
 * then keeps @buffer mapped and alive. Compare the number of vertices with that of the
 * topology before use.
 *
 * Returns: (transfer full): a new mesh; %NULL with @error set when the bytes are no
 *   valid mesh
 *
 * Since: 0.1
 */
GstClothMesh *
gst_cloth_mesh_from_buffer (GstBuffer * buffer, GError ** error)
{
  g_autoptr (GstClothMesh) mesh = NULL;
  GstMapInfo map;
  guint64 sequence;
  guint n_vertices, flags;
  gboolean covariances, in_place;

  g_return_val_if_fail (GST_IS_BUFFER (buffer), NULL);

  if (!gst_cloth_map (buffer, &map, error))
    return NULL;
  if (!gst_cloth_check_header (map.data, map.size, MESH_MAGIC, MESH_VERSION,
          MESH_HEADER, "mesh", error))
    goto bad;
  sequence = gst_cloth_read_u64 (map.data + 8);
  n_vertices = gst_cloth_read_u32 (map.data + 16);
  flags = gst_cloth_read_u32 (map.data + 20);
  covariances = (flags & MESH_HAS_COVARIANCES) != 0;
  if (n_vertices < 1 || n_vertices > GST_CLOTH_MAX_VERTICES) {
    g_set_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_LIMIT,
        "A mesh of %u vertices; between 1 and %d are possible", n_vertices,
        GST_CLOTH_MAX_VERTICES);
    goto bad;
  }
  if (flags & ~MESH_HAS_COVARIANCES) {
    g_set_error (error, GST_CLOTH_ERROR, GST_CLOTH_ERROR_VALUE,
        "The mesh has flags 0x%x that version 1 doesn't know", flags);
    goto bad;
  }
  if (!gst_cloth_check_size (map.size, mesh_size (n_vertices, covariances),
          "mesh", error))
    goto bad;

  in_place = G_BYTE_ORDER == G_LITTLE_ENDIAN
      && ((guintptr) map.data % sizeof (gfloat)) == 0;
  mesh = mesh_alloc (sequence, n_vertices, covariances, !in_place);
  if (in_place) {
    mesh->buffer = gst_buffer_ref (buffer);
    mesh->map = map;
    mesh_place (mesh, map.data + MESH_HEADER, covariances);
  } else {
    gsize words = (gsize) n_vertices * (covariances ? 9 : 3);

    gst_cloth_copy_le32 ((gpointer) mesh->positions, map.data + MESH_HEADER,
        words);
    memcpy ((gpointer) mesh->states, map.data + MESH_HEADER + 4 * words,
        n_vertices);
    gst_buffer_unmap (buffer, &map);
  }
  return check_values (mesh, error) ? g_steal_pointer (&mesh) : NULL;

bad:
  gst_buffer_unmap (buffer, &map);
  return NULL;
}
