/* What bends in a mesh: its neighbours and the second differences of a thin plate.
 *
 * The plate's energy is ∫ p_uu² + 2 p_uv² + p_vv², with the flat cloth's u and v. Of quads
 * it takes the second differences along the two lines of the grid, found through pairs of
 * quads that share an edge, and the twist of each quad; at the mesh's border a line's
 * weight halves, as the strip that it stands for does. Where triangles meet, it takes the
 * jump of the normal derivative across their edge with the weight that M. Bergou et al.,
 * “A Quadratic Bending Model for Inextensible Surfaces” (2006), give it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/stencil.h"

#include <math.h>
#include <stdlib.h>

#include "gst/mesh/side.h"

typedef struct
{
  const ClothTopology *topology;
  const guint *same;
  gboolean has_uv;
  gdouble edge;
  GArray *sides;                /* ClothSide, between vertices as they are sewn */
  GArray *stencils;             /* ClothStencil */
} Builder;

static guint
corners (const ClothTopology * topology, guint face)
{
  return topology->faces[4 * (gsize) face + 3] == CLOTH_NO_VERTEX ? 3 : 4;
}

static guint
corner (const ClothTopology * topology, guint face, guint side)
{
  return topology->faces[4 * (gsize) face + side % corners (topology, face)];
}

static gdouble
flat_length (const Builder * self, guint a, guint b)
{
  const gfloat *uv = self->topology->uv;

  if (!self->has_uv)
    return 1;
  return hypot ((gdouble) uv[2 * a] - uv[2 * b],
      (gdouble) uv[2 * a + 1] - uv[2 * b + 1]);
}

/* Stencils of the same vertices in the same order become neighbours. */
static gint
compare_stencils (gconstpointer pa, gconstpointer pb)
{
  const ClothStencil *x = pa, *y = pb;

  for (guint i = 0; i < CLOTH_STENCIL_SIZE; i++)
    if (x->vertex[i] != y->vertex[i])
      return x->vertex[i] < y->vertex[i] ? -1 : 1;
  return 0;
}

static void
add (Builder * self, const guint vertex[4], const gdouble weight[4],
    gdouble energy)
{
  ClothStencil stencil;

  if (!isfinite (energy))
    return;
  for (guint i = 0; i < CLOTH_STENCIL_SIZE; i++) {
    if (!isfinite (weight[i]))
      return;
    stencil.vertex[i] = vertex[i] == CLOTH_NO_VERTEX ? vertex[i]
        : self->same[vertex[i]];
    /* a face that has a vertex twice */
    for (guint k = 0; k < i; k++)
      if (stencil.vertex[k] == stencil.vertex[i])
        return;
    stencil.weight[i] = (gfloat) (sqrt (energy) * weight[i]);
  }
  g_array_append_val (self->stencils, stencil);
}

/* One side's half of the line a, @middle, b, whose pieces are @near and @far long; @across
 * is the width of a strip beside it. */
static void
add_line (Builder * self, guint a, guint middle, guint b, gdouble near,
    gdouble far, gdouble across)
{
  gdouble step = 2 * near * far / (near + far);
  gdouble weight[4] = { step / near, -step / near - step / far, step / far, 0 };
  guint vertex[4] = { a, middle, b, CLOTH_NO_VERTEX };

  if (self->same[a] > self->same[b]) {
    vertex[0] = b;
    vertex[2] = a;
    weight[0] = step / far;
    weight[2] = step / near;
  }
  add (self, vertex, weight, across * self->edge * self->edge
      / (2 * step * step * step));
}

/* The uv of a corner, and the cotangent at it of the angle to two others. */
static gdouble
cotangent (const Builder * self, guint at, guint a, guint b)
{
  const gfloat *uv = self->topology->uv;
  gdouble p[2], q[2], cross;

  if (!self->has_uv)
    return 1 / sqrt (3);
  for (guint i = 0; i < 2; i++) {
    p[i] = (gdouble) uv[2 * a + i] - uv[2 * at + i];
    q[i] = (gdouble) uv[2 * b + i] - uv[2 * at + i];
  }
  cross = fabs (p[0] * q[1] - p[1] * q[0]);
  return (p[0] * q[0] + p[1] * q[1]) / cross;
}

static gdouble
flat_area (const Builder * self, guint a, guint b, guint c)
{
  const gfloat *uv = self->topology->uv;
  gdouble p[2], q[2];

  if (!self->has_uv)
    return sqrt (3) / 4;
  for (guint i = 0; i < 2; i++) {
    p[i] = (gdouble) uv[2 * b + i] - uv[2 * a + i];
    q[i] = (gdouble) uv[2 * c + i] - uv[2 * a + i];
  }
  return fabs (p[0] * q[1] - p[1] * q[0]) / 2;
}

/* The jump across an edge: from the face of x, with its corners a, b and c, to that of y,
 * where a and b may be other vertices sewn to them. */
static void
add_hinge (Builder * self, const guint x[3], const guint y[3])
{
  guint vertex[4] = { x[0], x[1], x[2], y[2] };
  gdouble xa = cotangent (self, x[1], x[0], x[2]);
  gdouble xb = cotangent (self, x[0], x[1], x[2]);
  gdouble ya = cotangent (self, y[1], y[0], y[2]);
  gdouble yb = cotangent (self, y[0], y[1], y[2]);
  gdouble weight[4] = { xa + ya, xb + yb, -xa - xb, -ya - yb };
  gdouble area = flat_area (self, x[0], x[1], x[2])
      + flat_area (self, y[0], y[1], y[2]);

  add (self, vertex, weight, 3 * self->edge * self->edge / area);
}

/* What two faces that share an edge have of the plate's energy. */
static void
add_pair (Builder * self, const ClothSide * x, const ClothSide * y)
{
  const ClothTopology *topology = self->topology;
  guint nx = corners (topology, x->face), ny = corners (topology, y->face);
  /* the ends of the edge, as each face has them, and the corners beyond them; of a triangle
   * these are one */
  guint ax = corner (topology, x->face, x->number);
  guint bx = corner (topology, x->face, x->number + 1);
  guint ay = corner (topology, y->face, y->number);
  guint by = corner (topology, y->face, y->number + 1);
  guint beyond_ax = corner (topology, x->face, x->number + nx - 1);
  guint beyond_bx = corner (topology, x->face, x->number + 2);
  guint beyond_ay = corner (topology, y->face, y->number + ny - 1);
  guint beyond_by = corner (topology, y->face, y->number + 2);

  if (self->same[ax] != self->same[ay]) {
    guint swap[2] = { ay, beyond_ay };

    ay = by;
    by = swap[0];
    beyond_ay = beyond_by;
    beyond_by = swap[1];
  }
  if (nx == 4 && ny == 4) {
    gdouble across = flat_length (self, ax, bx);

    add_line (self, beyond_ax, ax, beyond_ay, flat_length (self, beyond_ax, ax),
        flat_length (self, beyond_ay, ay), across);
    add_line (self, beyond_bx, bx, beyond_by, flat_length (self, beyond_bx, bx),
        flat_length (self, beyond_by, by), across);
  } else {
    const guint three_x[3] = { ax, bx, beyond_bx };
    const guint three_y[3] = { ay, by, beyond_by };

    add_hinge (self, three_x, three_y);
  }
}

static void
find_sides (Builder * self)
{
  const ClothTopology *topology = self->topology;

  for (guint face = 0; face < topology->n_faces; face++)
    for (guint side = 0; side < corners (topology, face); side++) {
      ClothSide found = cloth_side (self->same[corner (topology, face, side)],
          self->same[corner (topology, face, side + 1)], face, side);

      if (found.a != found.b)
        g_array_append_val (self->sides, found);
    }
  g_array_sort (self->sides, cloth_side_compare);
}

static gdouble
side_length (const Builder * self, const ClothSide * side)
{
  return flat_length (self, corner (self->topology, side->face, side->number),
      corner (self->topology, side->face, side->number + 1));
}

/* The mean length of an edge: the unit of the stencils. */
static void
measure (Builder * self)
{
  gdouble sum = 0;
  guint n = 0;

  self->has_uv = TRUE;
  for (guint i = 0; i < self->sides->len; i++) {
    const ClothSide *side = &g_array_index (self->sides, ClothSide, i);

    if (i > 0 && cloth_side_same_edge (side, side - 1))
      continue;
    sum += side_length (self, side);
    n++;
  }
  self->has_uv = sum > 0;
  self->edge = self->has_uv ? sum / n : 1;
}

static void
add_faces (Builder * self)
{
  const ClothTopology *topology = self->topology;

  for (guint face = 0; face < topology->n_faces; face++) {
    const guint32 *v = &topology->faces[4 * (gsize) face];
    guint vertex[4] = { v[0], v[1], v[2], v[3] };
    gdouble weight[4] = { 1, -1, 1, -1 }, area;

    if (v[3] == CLOTH_NO_VERTEX)
      continue;
    area = self->has_uv ? flat_area (self, v[0], v[1], v[2])
        + flat_area (self, v[0], v[2], v[3]) : 1;
    add (self, vertex, weight, 2 * self->edge * self->edge / area);
  }
}

static void
add_pairs (Builder * self)
{
  for (guint i = 0; i + 1 < self->sides->len; i++) {
    const ClothSide *x = &g_array_index (self->sides, ClothSide, i);

    if (cloth_side_same_edge (x, x + 1) && x->face != x[1].face) {
      add_pair (self, x, x + 1);
      /* a third face at this edge bends nothing further */
      while (i + 1 < self->sides->len && cloth_side_same_edge (x, x + 1)) {
        i++;
        x++;
      }
    }
  }
}

/* Halves of the same line become one. */
static void
merge (Builder * self)
{
  ClothStencil *all = (ClothStencil *) (gpointer) self->stencils->data;
  guint kept = 0;

  g_array_sort (self->stencils, compare_stencils);
  for (guint i = 0; i < self->stencils->len; i++) {
    if (kept > 0 && compare_stencils (&all[i], &all[kept - 1]) == 0) {
      for (guint k = 0; k < CLOTH_STENCIL_SIZE; k++) {
        gfloat *w = &all[kept - 1].weight[k];

        *w = copysignf (hypotf (*w, all[i].weight[k]), *w);
      }
    } else {
      all[kept++] = all[i];
    }
  }
  g_array_set_size (self->stencils, kept);
}

static void
index_stencils (ClothStencils * self)
{
  guint *at = g_new0 (guint, self->n_vertices + 1);

  self->of_start = g_new0 (guint, self->n_vertices + 1);
  for (guint i = 0; i < self->n; i++)
    for (guint k = 0; k < CLOTH_STENCIL_SIZE; k++)
      if (self->stencils[i].vertex[k] != CLOTH_NO_VERTEX)
        self->of_start[self->stencils[i].vertex[k] + 1]++;
  for (guint i = 0; i < self->n_vertices; i++)
    at[i + 1] = self->of_start[i + 1] += self->of_start[i];
  self->of = g_new (guint, self->of_start[self->n_vertices] + 1);
  for (guint i = 0; i < self->n; i++)
    for (guint k = 0; k < CLOTH_STENCIL_SIZE; k++)
      if (self->stencils[i].vertex[k] != CLOTH_NO_VERTEX)
        self->of[at[self->stencils[i].vertex[k]]++] = i;
  g_free (at);
}

static void
index_neighbours (ClothStencils * self, const Builder * builder)
{
  guint *at = g_new0 (guint, self->n_vertices + 1), n;

  self->near_start = g_new0 (guint, self->n_vertices + 1);
  for (guint pass = 0; pass < 2; pass++) {
    for (guint i = 0; i < builder->sides->len; i++) {
      const ClothSide *side = &g_array_index (builder->sides, ClothSide, i);

      if (i > 0 && cloth_side_same_edge (side, side - 1))
        continue;
      if (pass == 0) {
        self->near_start[side->a + 1]++;
        self->near_start[side->b + 1]++;
      } else {
        gfloat length = builder->has_uv ? (gfloat) side_length (builder, side)
            : 0;

        self->length[at[side->a]] = self->length[at[side->b]] = length;
        self->near[at[side->a]++] = side->b;
        self->near[at[side->b]++] = side->a;
      }
    }
    if (pass == 1)
      break;
    for (guint i = 0; i < self->n_vertices; i++)
      at[i + 1] = self->near_start[i + 1] += self->near_start[i];
    n = self->near_start[self->n_vertices];
    self->near = g_new (guint, n + 1);
    self->length = g_new (gfloat, n + 1);
  }
  g_free (at);
}

static void
index_lines (ClothStencils * self)
{
  GArray *line = g_array_new (FALSE, FALSE, sizeof (guint));

  self->line_start = g_new0 (guint, self->n_vertices + 1);
  for (guint v = 0; v < self->n_vertices; v++) {
    for (guint i = self->of_start[v]; i < self->of_start[v + 1]; i++) {
      const ClothStencil *stencil = &self->stencils[self->of[i]];

      if (stencil->vertex[3] == CLOTH_NO_VERTEX && stencil->vertex[1] == v) {
        g_array_append_val (line, stencil->vertex[0]);
        g_array_append_val (line, stencil->vertex[2]);
      }
    }
    self->line_start[v + 1] = line->len;
  }
  self->line = (guint *) (gpointer) g_array_free (line, FALSE);
}

/* Which vertices are one: the lowest of each. */
static guint *
sew (const ClothTopology * topology, const GArray * seams)
{
  guint *same = g_new (guint, topology->n_vertices);

  for (guint v = 0; v < topology->n_vertices; v++)
    same[v] = v;
  for (guint s = 0; seams && s < seams->len; s++) {
    const ClothSeamLine *line = &g_array_index (seams, ClothSeamLine, s);

    for (guint i = 0; i < line->n_vertices; i++) {
      guint a = line->lines[0][i], b = line->lines[1][i];

      while (same[a] != a)
        a = same[a];
      while (same[b] != b)
        b = same[b];
      same[MAX (a, b)] = MIN (a, b);
    }
  }
  /* lower ones are settled before */
  for (guint v = 0; v < topology->n_vertices; v++)
    same[v] = same[same[v]];
  return same;
}

/* @topology: a mesh of quads, triangles or both, checked; without uv (all zeros) every
 *   edge is taken to be as long as any other
 * @seams: (nullable) (element-type ClothSeamLine): which vertices are sewn to which;
 *   across a seam each face keeps its own measures
 *
 * Returns: (transfer full): its neighbours and second differences
 */
ClothStencils *
cloth_stencils_new (const ClothTopology * topology, const GArray * seams)
{
  ClothStencils *self = g_new0 (ClothStencils, 1);
  Builder builder = { topology, };

  builder.same = self->same = sew (topology, seams);

  builder.sides = g_array_new (FALSE, FALSE, sizeof (ClothSide));
  builder.stencils = g_array_new (FALSE, FALSE, sizeof (ClothStencil));
  find_sides (&builder);
  measure (&builder);
  add_faces (&builder);
  add_pairs (&builder);
  merge (&builder);
  self->n_vertices = topology->n_vertices;
  self->edge_m = builder.edge;
  self->n = builder.stencils->len;
  self->stencils = (ClothStencil *) (gpointer) g_array_free (builder.stencils,
      FALSE);
  index_stencils (self);
  index_neighbours (self, &builder);
  index_lines (self);
  g_array_unref (builder.sides);
  return self;
}

/* @stencils: (transfer full) (nullable): stencils
 */
void
cloth_stencils_free (ClothStencils * stencils)
{
  if (!stencils)
    return;
  g_free (stencils->same);
  g_free (stencils->stencils);
  g_free (stencils->of_start);
  g_free (stencils->of);
  g_free (stencils->near_start);
  g_free (stencils->near);
  g_free (stencils->length);
  g_free (stencils->line_start);
  g_free (stencils->line);
  g_free (stencils);
}

/* @stencil: a stencil
 * @positions: 3 numbers a vertex, metres
 * @value: (out): its second difference, metres; NaN when a vertex is not seen
 */
void
cloth_stencil_apply (const ClothStencil * stencil, const gfloat * positions,
    gdouble value[3])
{
  guint n = stencil->vertex[3] == CLOTH_NO_VERTEX ? 3 : 4;

  value[0] = value[1] = value[2] = 0;
  for (guint k = 0; k < n; k++) {
    const gfloat *p = positions + 3 * (gsize) stencil->vertex[k];

    for (guint i = 0; i < 3; i++)
      value[i] += (gdouble) stencil->weight[k] * p[i];
  }
}
