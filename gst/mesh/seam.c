/* Seams of the flat cloth.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/seam.h"

#include <math.h>
#include <string.h>

#include "gst/mesh/side.h"

static void
seam_clear (gpointer data)
{
  ClothSeamLine *line = data;

  g_free (line->lines[0]);
  g_free (line->lines[1]);
}

/* Returns: (transfer full) (element-type ClothSeamLine): no seams yet */
GArray *
cloth_seams_new (void)
{
  GArray *seams = g_array_new (FALSE, TRUE, sizeof (ClothSeamLine));

  g_array_set_clear_func (seams, seam_clear);
  return seams;
}

/* @topology: a mesh
 * @line: a seam of it
 * @lengths: (out): of both lines on the flat cloth
 *
 * Returns: whether they are equally long, to %CLOTH_SEAM_EASE
 */
gboolean
cloth_seam_fits (const ClothTopology * topology, const ClothSeamLine * line,
    gdouble lengths[2])
{
  for (guint side = 0; side < 2; side++) {
    lengths[side] = 0;
    for (guint i = 1; i < line->n_vertices; i++) {
      const gfloat *a = topology->uv + 2 * (gsize) line->lines[side][i - 1];
      const gfloat *b = topology->uv + 2 * (gsize) line->lines[side][i];

      lengths[side] += hypot ((gdouble) b[0] - a[0], (gdouble) b[1] - a[1]);
    }
  }
  return fabs (lengths[0] - lengths[1]) <=
      CLOTH_SEAM_EASE * MAX (lengths[0], lengths[1]);
}

/* ---- vertices ---- */

typedef struct
{
  guint32 vertex;
  gfloat uv[2];
  gsize corner;
} Corner;

static gint
compare_corners (gconstpointer a, gconstpointer b)
{
  const Corner *x = a, *y = b;

  if (x->vertex != y->vertex)
    return x->vertex < y->vertex ? -1 : 1;
  for (guint k = 0; k < 2; k++)
    if (x->uv[k] != y->uv[k])
      return x->uv[k] < y->uv[k] ? -1 : 1;
  return x->corner < y->corner ? -1 : 1;
}

/* Returns: (transfer full): of each corner the first one that has its vertex and uv */
static guint32 *
find_first (const ClothTopology * topology, const gfloat * corner_uv)
{
  const gsize n = 4 * (gsize) topology->n_faces;
  g_autoptr (GArray) corners = g_array_new (FALSE, FALSE, sizeof (Corner));
  guint32 *first = g_new (guint32, n);

  for (gsize i = 0; i < n; i++) {
    const Corner corner = { topology->faces[i], {corner_uv[2 * i],
        corner_uv[2 * i + 1]}, i
    };

    if (corner.vertex != CLOTH_NO_VERTEX)
      g_array_append_val (corners, corner);
  }
  g_array_sort (corners, compare_corners);
  for (guint i = 0; i < corners->len; i++) {
    const Corner *corner = &g_array_index (corners, Corner, i);

    first[corner->corner] = i > 0 && corner[-1].vertex == corner->vertex &&
        corner[-1].uv[0] == corner->uv[0] && corner[-1].uv[1] == corner->uv[1] ?
        first[corner[-1].corner] : (guint32) corner->corner;
  }
  return first;
}

/* The first uv keeps the vertex; each other one gets a new vertex, in the faces' order. */
static gboolean
part_vertices (ClothSplit * split, const ClothTopology * topology,
    const gfloat * corner_uv, GError ** error)
{
  const gsize n = 4 * (gsize) topology->n_faces;
  g_autofree guint32 *first = find_first (topology, corner_uv);
  g_autofree guint32 *faces = g_new (guint32, n);
  g_autofree guint8 *taken = g_new0 (guint8, topology->n_vertices);
  g_autoptr (GArray) uv = g_array_new (FALSE, FALSE, 2 * sizeof (gfloat));
  g_autoptr (GArray) sources = g_array_new (FALSE, FALSE, sizeof (guint32));

  g_array_append_vals (uv, topology->uv, topology->n_vertices);
  for (guint32 i = 0; i < topology->n_vertices; i++)
    g_array_append_val (sources, i);
  for (gsize i = 0; i < n; i++) {
    const guint32 vertex = topology->faces[i];

    faces[i] = vertex;
    if (vertex == CLOTH_NO_VERTEX)
      continue;
    if (first[i] != i) {
      faces[i] = faces[first[i]];
    } else if (taken[vertex]) {
      faces[i] = sources->len;
      g_array_append_val (sources, vertex);
      g_array_append_vals (uv, corner_uv + 2 * i, 1);
    }
    taken[vertex] = 1;
  }
  if (sources->len > CLOTH_MAX_VERTICES) {
    g_set_error (error, CLOTH_FILE_ERROR, CLOTH_FILE_ERROR_LIMIT,
        "parted at the seams of its uv the mesh has %u vertices; %u are "
        "accepted", sources->len, CLOTH_MAX_VERTICES);
    return FALSE;
  }
  split->topology = cloth_topology_new (sources->len, topology->n_faces);
  memcpy (split->topology->faces, faces, n * sizeof *faces);
  memcpy (split->topology->uv, uv->data,
      2 * (gsize) sources->len * sizeof (gfloat));
  split->sources = (guint32 *) (gpointer)
      g_array_free (g_steal_pointer (&sources), FALSE);
  return TRUE;
}

/* ---- seams ---- */

/* An edge that two faces shared: the vertices of either face at both ends. */
typedef struct
{
  guint32 at[2][2];             /* end, face */
  gboolean used;
} Edge;

/* An end of such an edge. */
typedef struct
{
  guint64 pair;                 /* its vertices, the lower one first */
  guint edge, end;
} End;

static gint
compare_ends (gconstpointer a, gconstpointer b)
{
  const End *x = a, *y = b;

  if (x->pair != y->pair)
    return x->pair < y->pair ? -1 : 1;
  return x->edge < y->edge ? -1 : x->edge > y->edge;
}

static guint64
pair_of (const guint32 at[2])
{
  return (guint64) MIN (at[0], at[1]) << 32 | MAX (at[0], at[1]);
}

static GArray *
find_edges (const ClothTopology * before, const ClothTopology * after)
{
  g_autoptr (GArray) sides = g_array_new (FALSE, FALSE, sizeof (ClothSide));
  GArray *edges = g_array_new (FALSE, TRUE, sizeof (Edge));
  const ClothSide *first = NULL;

  for (guint32 i = 0; i < before->n_faces; i++) {
    const guint32 *face = before->faces + 4 * (gsize) i;
    const guint n = cloth_face_corners (face);

    for (guint k = 0; k < n; k++) {
      const ClothSide side = cloth_side (face[k], face[(k + 1) % n], i, k);

      if (side.a != side.b)
        g_array_append_val (sides, side);
    }
  }
  g_array_sort (sides, cloth_side_compare);
  for (guint i = 0; i < sides->len; i++) {
    const ClothSide *side = &g_array_index (sides, ClothSide, i);
    Edge edge = { 0 };

    if (!first || !cloth_side_same_edge (first, side)) {
      first = side;
      continue;
    }
    for (guint f = 0; f < 2; f++) {
      const ClothSide *its = f ? side : first;
      const guint32 *old = before->faces + 4 * (gsize) its->face;
      const guint32 *now = after->faces + 4 * (gsize) its->face;
      const guint next = (its->number + 1) % cloth_face_corners (old);
      const gboolean turned = old[its->number] != its->a;

      edge.at[0][f] = now[turned ? next : its->number];
      edge.at[1][f] = now[turned ? its->number : next];
    }
    if (edge.at[0][0] != edge.at[0][1] || edge.at[1][0] != edge.at[1][1])
      g_array_append_val (edges, edge);
  }
  return edges;
}

/* The edges by their ends, and where one goes on from an end.
 *
 * @nexts: of the first end of each pair, which one is to be tried next
 */
typedef struct
{
  GArray *edges, *ends;
  guint *nexts;
  guint n_lines;
  guint *seen[2];               /* the last line that has a vertex on this side */
} Walk;

/* Returns: an end with this pair whose edge isn't used, or NULL */
static const End *
find_next (Walk * walk, guint64 pair)
{
  const GArray *ends = walk->ends;
  guint low = 0, high = ends->len;

  while (low < high) {
    const guint middle = (low + high) / 2;

    if (g_array_index (ends, End, middle).pair < pair)
      low = middle + 1;
    else
      high = middle;
  }
  for (guint * i = &walk->nexts[low]; *i < ends->len; (*i)++) {
    const End *end = &g_array_index (ends, End, *i);

    if (end->pair != pair)
      break;
    if (!g_array_index (walk->edges, Edge, end->edge).used)
      return end;
  }
  return NULL;
}

/* Adds what is sewn there; FALSE when the line has been at one of them. */
static gboolean
visit (Walk * walk, GArray * lines[2], const guint32 at[2])
{
  for (guint side = 0; side < 2; side++)
    if (walk->seen[side][at[side]] == walk->n_lines)
      return FALSE;
  for (guint side = 0; side < 2; side++) {
    const guint vertex = at[side];

    walk->seen[side][vertex] = walk->n_lines;
    g_array_append_val (lines[side], vertex);
  }
  return TRUE;
}

/* From an end as far as the seam goes on and comes to no vertex again. */
static void
add_line (Walk * walk, const End * end, GArray * seams)
{
  GArray *lines[2] = { g_array_new (FALSE, FALSE, sizeof (guint)),
    g_array_new (FALSE, FALSE, sizeof (guint))
  };
  const Edge *edge = &g_array_index (walk->edges, Edge, end->edge);
  guint32 at[2] = { edge->at[end->end][0], edge->at[end->end][1] };
  ClothSeamLine line;

  walk->n_lines++;
  visit (walk, lines, at);
  for (; end; end = find_next (walk, pair_of (at))) {
    Edge *next = &g_array_index (walk->edges, Edge, end->edge);
    const guint turned = next->at[end->end][0] != at[0];
    const guint32 other[2] = { next->at[!end->end][turned],
      next->at[!end->end][!turned]
    };

    if (!visit (walk, lines, other))
      break;
    next->used = TRUE;
    at[0] = other[0];
    at[1] = other[1];
  }
  line.n_vertices = lines[0]->len;
  for (guint side = 0; side < 2; side++)
    line.lines[side] = (guint *) (gpointer) g_array_free (lines[side], FALSE);
  g_array_append_val (seams, line);
}

static void
find_seams (ClothSplit * split, const ClothTopology * before)
{
  const guint n = split->topology->n_vertices;
  g_autoptr (GArray) edges = find_edges (before, split->topology);
  g_autoptr (GArray) ends = g_array_new (FALSE, FALSE, sizeof (End));
  g_autofree guint *nexts = NULL;
  g_autofree guint *seen = g_new0 (guint, 2 * (gsize) n);
  Walk walk = { edges, ends, NULL, 0, {seen, seen + n}
  };

  for (guint i = 0; i < edges->len; i++)
    for (guint k = 0; k < 2; k++) {
      const End end = { pair_of (g_array_index (edges, Edge, i).at[k]), i, k };

      g_array_append_val (ends, end);
    }
  g_array_sort (ends, compare_ends);
  walk.nexts = nexts = g_new (guint, ends->len + 1);
  for (guint i = 0; i <= ends->len; i++)
    nexts[i] = i;
  /* first where seams end, then those that are closed */
  for (guint closed = 0; closed < 2; closed++)
    for (guint i = 0; i < ends->len; i++) {
      const End *end = &g_array_index (ends, End, i);
      const gboolean inner = (i > 0 && end[-1].pair == end->pair)
          || (i + 1 < ends->len && end[1].pair == end->pair);

      if ((closed || !inner) && !g_array_index (edges, Edge, end->edge).used)
        add_line (&walk, end, split->seams);
    }
}

/* @topology: a mesh
 * @corner_uv: 2 numbers for each of the 4 corners of each face
 * @error: #ClothFileError
 *
 * Parts a mesh where faces give a vertex several uv. What was one edge of two faces and is two
 * now makes seams, as long as they go on.
 *
 * Returns: (transfer full): the parts, or %NULL when they have too many vertices
 */
ClothSplit *
cloth_split_new (const ClothTopology * topology, const gfloat * corner_uv,
    GError ** error)
{
  g_autoptr (ClothSplit) split = g_new0 (ClothSplit, 1);

  split->seams = cloth_seams_new ();
  if (!part_vertices (split, topology, corner_uv, error))
    return NULL;
  find_seams (split, topology);
  return g_steal_pointer (&split);
}

/* @split: (transfer full) (nullable): a mesh in parts
 */
void
cloth_split_free (ClothSplit * split)
{
  if (!split)
    return;
  cloth_topology_free (split->topology);
  g_free (split->sources);
  g_array_unref (split->seams);
  g_free (split);
}
