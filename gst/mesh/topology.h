/* Which vertices make a face, where each lies on the flat cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/file/file.h"

G_BEGIN_DECLS

/* Limits on untrusted input. */
#define CLOTH_MAX_VERTICES 1000000u
#define CLOTH_MAX_FACES 2000000u

/* Fourth index of a triangle. */
#define CLOTH_NO_VERTEX 0xffffffffu

/* @n_vertices: number of vertices
 * @columns: vertices of a row when the mesh is one regular grid, else 0
 * @rows: rows of vertices of a grid, else 0
 * @uv: 2 numbers a vertex, metres on the flat cloth; zeros when unknown
 * @n_faces: number of faces
 * @faces: 4 indices a face, the last %CLOTH_NO_VERTEX for a triangle
 *
 * What stays the same over a sequence of meshes.
 */
typedef struct {
  guint n_vertices;
  guint columns;
  guint rows;
  gfloat *uv;
  guint n_faces;
  guint32 *faces;
} ClothTopology;

/* @face: 4 indices of a face
 *
 * Returns: how many corners it has, 3 or 4
 */
static inline guint
cloth_face_corners (const guint32 * face)
{
  return face[3] == CLOTH_NO_VERTEX ? 3 : 4;
}

/* @CLOTH_VERTEX_UNSEEN: not seen: the position is NaN
 * @CLOTH_VERTEX_MEASURED: measured by three or more views
 * @CLOTH_VERTEX_TWO_VIEWS: measured by two
 * @CLOTH_VERTEX_FILLED: interpolated
 * @CLOTH_VERTEX_PREDICTED: carried on in time or simulated
 *
 * The values of `GstClothVertexState`.
 */
typedef enum {
  CLOTH_VERTEX_UNSEEN,
  CLOTH_VERTEX_MEASURED,
  CLOTH_VERTEX_TWO_VIEWS,
  CLOTH_VERTEX_FILLED,
  CLOTH_VERTEX_PREDICTED
} ClothVertexState;

/* @fps: frames a second, 0 when unknown
 * @columns: vertices of a row of a grid, or 0
 * @rows: rows of a grid, or 0
 *
 * What OBJ and PLY have no field for. It travels in a comment, which other programs
 * skip: `gst-cloth fps 30000/1001 grid 33 35`.
 */
typedef struct {
  gdouble fps;
  guint columns;
  guint rows;
} ClothMeshNote;

/* @positions: 3 numbers a vertex, metres, NaN when not seen
 * @states: a #ClothVertexState a vertex
 * @covariances: (nullable): 6 numbers a vertex, m², NaN where not known
 *
 * One frame of a sequence.
 */
typedef struct {
  const gfloat *positions;
  const guint8 *states;
  const gfloat *covariances;
} ClothMeshFrame;

/* @n_vertices: vertices of a line
 * @lines: two lines of vertices on the edges of the cloth; each vertex of the first is
 *   sewn to the one at its place in the second
 */
typedef struct {
  guint n_vertices;
  guint *lines[2];
} ClothSeamLine;

ClothTopology *cloth_topology_new (guint n_vertices, guint n_faces);
ClothTopology *cloth_topology_new_grid (guint columns, guint rows,
    gfloat width_m, gfloat height_m);
ClothTopology *cloth_topology_copy (const ClothTopology * topology);
gboolean cloth_topology_equal (const ClothTopology * a, const ClothTopology * b);
gboolean cloth_topology_check (const ClothTopology * topology, GError ** error);
void cloth_topology_free (ClothTopology * topology);

gboolean cloth_positions_check (const gfloat * positions, guint n_vertices,
    GError ** error);
gboolean cloth_states_check (const guint8 * states, guint n_vertices,
    GError ** error);

gchar *cloth_mesh_note_format (const ClothTopology * topology, gint fps_n,
    gint fps_d);
gboolean cloth_mesh_note_parse (const gchar * text, ClothMeshNote * note);
void cloth_mesh_note_apply (const ClothMeshNote * note,
    ClothTopology * topology);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothTopology, cloth_topology_free)
G_END_DECLS
