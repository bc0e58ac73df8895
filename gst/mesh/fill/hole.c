/* One hole of a mesh: a thin plate held by the vertices around it.
 *
 * With A the second differences that touch the hole, split into the columns of its own
 * vertices x and of the ring's b, the plate is the x with the least |A_x x + A_b b|²:
 * A_xᵀA_x x = −A_xᵀA_b b. If second differences were independent with variance 1, (A_xᵀA_x)⁻¹
 * would be the covariance of x: the same factor tells the place and how sure it is.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/fill/hole.h"

#include <math.h>
#include <string.h>

#include "gst/math/band.h"

/* Steps along edges from the hole to where its statistics are taken, and how many
 * vertices and second differences at most. */
#define REACH 5
#define MOST_REGION 160
#define MOST_AROUND 400
/* Multiplications that a factor may take; a plate could not fill a larger hole. */
#define MOST_WORK 4e9
/* The leverage is computed up to this many right-hand sides times unknowns; beyond, it is
 * taken to be that of a wide hole. */
#define MOST_LEVERAGE 20000
#define WIDE_LEVERAGE 1.0

/* Numbers the vertices that @index has as the hole's, level by level of a breadth-first walk
 * from @start, so that coupled ones have near numbers. Returns the last vertex. */
static guint
walk (const ClothStencils * stencils, guint n, guint start, gint * index,
    guint * order)
{
  guint done = 0, filled = 0;

  order[filled++] = start;
  index[start] = 0;
  while (done < filled) {
    guint v = order[done++];

    for (guint i = stencils->of_start[v]; i < stencils->of_start[v + 1]; i++) {
      const ClothStencil *stencil = &stencils->stencils[stencils->of[i]];

      for (guint k = 0; k < CLOTH_STENCIL_SIZE; k++) {
        guint w = stencil->vertex[k];

        if (w != CLOTH_NO_VERTEX && index[w] == -2) {
          index[w] = (gint) filled;
          order[filled++] = w;
        }
      }
    }
  }
  g_assert (filled == n);
  return order[n - 1];
}

/* The stencils of the hole, with the ring numbered from −3 down. */
static void
collect (ClothHole * self, const ClothStencils * stencils, gint * index)
{
  GArray *ring = g_array_new (FALSE, FALSE, sizeof (guint));
  GArray *local = g_array_new (FALSE, FALSE, sizeof (gint));
  GArray *weight = g_array_new (FALSE, FALSE, sizeof (gfloat));

  for (guint i = 0; i < self->n; i++) {
    guint v = self->vertices[i];

    for (guint j = stencils->of_start[v]; j < stencils->of_start[v + 1]; j++) {
      const ClothStencil *stencil = &stencils->stencils[stencils->of[j]];
      gboolean first = TRUE;
      guint size = stencil->vertex[3] == CLOTH_NO_VERTEX ? 3 : 4;
      gint at[CLOTH_STENCIL_SIZE] = { 0, };
      gfloat w[CLOTH_STENCIL_SIZE] = { 0, };

      /* each stencil once, at its lowest unknown */
      for (guint k = 0; k < size; k++)
        first = first && !(index[stencil->vertex[k]] >= 0
            && index[stencil->vertex[k]] < (gint) i);
      if (!first)
        continue;
      for (guint k = 0; k < size; k++) {
        guint vertex = stencil->vertex[k];

        if (index[vertex] == -1) {
          index[vertex] = -3 - (gint) ring->len;
          g_array_append_val (ring, vertex);
        }
        at[k] = index[vertex];
        w[k] = stencil->weight[k];
      }
      g_array_append_vals (local, at, CLOTH_STENCIL_SIZE);
      g_array_append_vals (weight, w, CLOTH_STENCIL_SIZE);
    }
  }
  self->n_stencils = local->len / CLOTH_STENCIL_SIZE;
  self->n_ring = ring->len;
  self->ring = (guint *) (gpointer) g_array_free (ring, FALSE);
  self->local = (gint *) (gpointer) g_array_free (local, FALSE);
  self->weight = (gfloat *) (gpointer) g_array_free (weight, FALSE);
}

static gboolean
factor (ClothHole * self)
{
  for (guint s = 0; s < self->n_stencils; s++)
    for (guint a = 0; a < CLOTH_STENCIL_SIZE; a++)
      for (guint b = 0; b < a; b++) {
        gint i = self->local[4 * s + a], j = self->local[4 * s + b];

        if (i >= 0 && j >= 0)
          self->bandwidth = MAX (self->bandwidth, (guint) ABS (i - j));
      }
  if ((gdouble) self->n * self->bandwidth * self->bandwidth > MOST_WORK)
    return FALSE;
  self->factor = g_new0 (gdouble, (gsize) self->n * (self->bandwidth + 1));
  for (guint s = 0; s < self->n_stencils; s++)
    for (guint a = 0; a < CLOTH_STENCIL_SIZE; a++)
      for (guint b = 0; b < CLOTH_STENCIL_SIZE; b++) {
        gint i = self->local[4 * s + a], j = self->local[4 * s + b];

        if (i >= j && j >= 0)
          CLOTH_BAND (self->factor, self->bandwidth, i, j) +=
              (gdouble) self->weight[4 * s + a] * self->weight[4 * s + b];
      }
  return cloth_band_factor (self->n, self->bandwidth, self->factor);
}

static void
find_leverage (ClothHole * self)
{
  gdouble *unit;

  self->leverage = g_new0 (gdouble, self->n);
  if (self->n_ring * self->n > MOST_LEVERAGE) {
    for (guint i = 0; i < self->n; i++)
      self->leverage[i] = WIDE_LEVERAGE;
    return;
  }
  /* all columns of the map from ring to hole at once */
  unit = g_new0 (gdouble, (gsize) self->n * self->n_ring);
  for (guint s = 0; s < self->n_stencils; s++)
    for (guint a = 0; a < CLOTH_STENCIL_SIZE; a++)
      for (guint b = 0; b < CLOTH_STENCIL_SIZE; b++) {
        gint i = self->local[4 * s + a], j = self->local[4 * s + b];

        if (i >= 0 && j <= -3)
          unit[(gsize) i * self->n_ring + (-3 - j)] -=
              (gdouble) self->weight[4 * s + a] * self->weight[4 * s + b];
      }
  cloth_band_solve (self->n, self->bandwidth, self->factor, self->n_ring, unit);
  for (guint i = 0; i < self->n; i++)
    for (guint k = 0; k < self->n_ring; k++)
      self->leverage[i] += unit[(gsize) i * self->n_ring + k]
          * unit[(gsize) i * self->n_ring + k];
  g_free (unit);
}

/* Vertices and second differences around the hole. Uses −2 for what is in the region but
 * not in the ring. */
static void
look_around (ClothHole * self, const ClothStencils * stencils, gint * index)
{
  GArray *region = g_array_new (FALSE, FALSE, sizeof (guint));
  GArray *around = g_array_new (FALSE, FALSE, sizeof (guint));
  guint begin = 0;

  g_array_append_vals (region, self->ring, self->n_ring);
  for (guint step = 2; step < REACH; step++) {
    guint end = region->len;

    for (guint i = begin; i < end && region->len < MOST_REGION; i++) {
      guint v = g_array_index (region, guint, i);

      for (guint j = stencils->near_start[v]; j < stencils->near_start[v + 1];
          j++)
        if (index[stencils->near[j]] == -1) {
          index[stencils->near[j]] = -2;
          g_array_append_val (region, stencils->near[j]);
        }
    }
    begin = end;
  }
  for (guint i = 0; i < region->len && around->len < MOST_AROUND; i++) {
    guint v = g_array_index (region, guint, i);

    for (guint j = stencils->of_start[v]; j < stencils->of_start[v + 1]; j++) {
      const ClothStencil *stencil = &stencils->stencils[stencils->of[j]];
      gboolean inside = stencil->vertex[0] == v;

      for (guint k = 0; k < CLOTH_STENCIL_SIZE; k++)
        inside = inside && (stencil->vertex[k] == CLOTH_NO_VERTEX
            || index[stencil->vertex[k]] <= -2);
      if (inside)
        g_array_append_val (around, stencils->of[j]);
    }
  }
  self->n_region = region->len;
  self->region = (guint *) (gpointer) g_array_free (region, FALSE);
  self->n_around = around->len;
  self->around = (guint *) (gpointer) g_array_free (around, FALSE);
}

/* @stencils: the mesh's
 * @n: number of unknown vertices
 * @found: (array length=n): the unknown vertices: all that stencils connect
 * @index: (inout): −1 for every vertex of the mesh; it is used and given back so
 *
 * Returns: (transfer full): the hole with its factor
 */
ClothHole *
cloth_hole_new (const ClothStencils * stencils, guint n, const guint * found,
    gint * index)
{
  ClothHole *self = g_new0 (ClothHole, 1);
  guint last;

  self->n = n;
  self->found = g_memdup2 (found, n * sizeof *found);
  self->vertices = g_new (guint, n);
  for (guint i = 0; i < n; i++)
    index[found[i]] = -2;
  last = walk (stencils, n, found[0], index, self->vertices);
  /* once more, from what is farthest away: levels become narrower */
  for (guint i = 0; i < n; i++)
    index[found[i]] = -2;
  walk (stencils, n, last, index, self->vertices);
  collect (self, stencils, index);
  self->anchored = self->n_ring >= 3 && factor (self);
  if (self->anchored) {
    self->variance = g_new (gdouble, n);
    cloth_band_inverse_diagonal (n, self->bandwidth, self->factor,
        self->variance);
    find_leverage (self);
  } else {
    g_clear_pointer (&self->factor, g_free);
  }
  look_around (self, stencils, index);
  for (guint i = 0; i < n; i++)
    index[found[i]] = -1;
  for (guint i = 0; i < self->n_region; i++)
    index[self->region[i]] = -1;
  return self;
}

/* @hole: an anchored hole
 * @ring: (array): 3·n_ring: the places of the ring
 * @solution: (out) (array): 3·n: those of the hole's vertices, in the order of
 *   #ClothHole.vertices
 */
void
cloth_hole_solve (const ClothHole * hole, const gdouble * ring,
    gdouble * solution)
{
  memset (solution, 0, 3 * hole->n * sizeof *solution);
  for (guint s = 0; s < hole->n_stencils; s++) {
    const gint *local = &hole->local[4 * s];
    const gfloat *weight = &hole->weight[4 * s];
    gdouble value[3] = { 0, };

    for (guint k = 0; k < CLOTH_STENCIL_SIZE; k++)
      if (local[k] <= -3)
        for (guint c = 0; c < 3; c++)
          value[c] += weight[k] * ring[3 * (-3 - local[k]) + c];
    for (guint k = 0; k < CLOTH_STENCIL_SIZE; k++)
      if (local[k] >= 0)
        for (guint c = 0; c < 3; c++)
          solution[3 * local[k] + c] -= weight[k] * value[c];
  }
  cloth_band_solve (hole->n, hole->bandwidth, hole->factor, 3, solution);
}

/* @hole: (transfer full) (nullable): a hole
 */
void
cloth_hole_free (ClothHole * hole)
{
  if (!hole)
    return;
  g_free (hole->found);
  g_free (hole->vertices);
  g_free (hole->ring);
  g_free (hole->variance);
  g_free (hole->leverage);
  g_free (hole->region);
  g_free (hole->around);
  g_free (hole->local);
  g_free (hole->weight);
  g_free (hole->factor);
  g_free (hole);
}
