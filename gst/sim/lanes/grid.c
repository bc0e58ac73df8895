/* The sheet of rows and columns, where most time is spent: its membrane and its bending
 * in one pass, and the step of its particles with them.
 *
 * On such a grid a triangle's x_u is that of its edge along u and its x_v that of its
 * edge along v, so stretch belongs to edges, each for its two triangles, and only shear
 * to triangles. Folds are differences of neighbouring edges' x_u or x_v. So all forces
 * are forces along edges: a particle's is the sum over its four edges, put together where
 * the pass leaves it behind; nothing is scattered. The law is that of membrane.c and
 * bending.c to the rounding.
 *
 * The pass goes row by row and keeps one row of edges at hand, which fits into the
 * nearest cache. When row r + 1 is at work, row r − 1 is complete and can move.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/lanes/motion.h"

struct _ClothLaneGrid
{
  guint columns, rows;
  /* Edges from a column to the next, from a row to the next (m); what lies half way to
   * the neighbours on both sides of a column, of a row. */
  ClothReal *du, *inverse_u, *width;
  ClothReal *dv, *inverse_v, *height;
  /* of a fold across a column, per edge on its left and on its right: 1/(width du) */
  ClothReal *fold_left, *fold_right;
  /* of each cell: its right angles are top right and bottom left */
  guint8 *turned;
  /* Of a row, by column: forces along the edges to the right and down, z of the latter,
   * and what is known of the forces on the particles above. */
  ClothLane3 *along_u, *along_v, *down, *force;
};

/* What is to be done with a particle whose force is known. */
typedef enum
{
  STORE,                        /* into f */
  MOVE,                         /* a step */
  MOVE_NUDGED,
  STAGE,                        /* a stage of a step */
  STAGE_OTHERS                  /* with other forces */
} Mode;

/* ∂x/∂u or ∂x/∂v of an edge, β times that of the velocity, and both together. */
typedef struct
{
  ClothLane x[3], w[3], z[3];
} Edge;

static gboolean
find_cells (ClothLaneGrid * grid, const ClothBody * body)
{
  guint columns = grid->columns, cells = (columns - 1) * (grid->rows - 1);
  const gdouble *uv = body->uv;
  g_autofree guint8 *corners = g_new0 (guint8, cells);

  if (body->n_right != body->n_triangles || body->n_triangles != 2 * cells)
    return FALSE;
  for (guint i = 0; i < body->n_triangles; i++) {
    const guint32 *p = body->triangles[i].particle;
    guint column = p[0] % columns, row = p[0] / columns;
    guint left = MIN (column, p[1] % columns), top = MIN (row, p[2] / columns);

    if (p[1] / columns != row || p[2] % columns != column
        || MAX (column, p[1] % columns) != left + 1
        || MAX (row, p[2] / columns) != top + 1
        || !(uv[2 * (left + 1)] > uv[2 * left])
        || !(uv[2 * (gsize) columns * (top + 1) + 1] >
            uv[2 * (gsize) columns * top + 1]))
      return FALSE;
    corners[top * (columns - 1) + left] |=
        1 << (2 * (row - top) + column - left);
  }
  for (guint i = 0; i < cells; i++) {
    if (corners[i] != 0x9 && corners[i] != 0x6)
      return FALSE;
    grid->turned[i] = corners[i] == 0x6;
  }
  return TRUE;
}

/* Lengths of the edges of a line, their inverses, and half of both neighbours'. */
static void
measure_line (const gdouble * uv, gsize stride, guint n, ClothReal * length,
    ClothReal * inverse, ClothReal * width)
{
  for (guint i = 0; i + 1 < n; i++) {
    gdouble d = uv[(i + 1) * stride] - uv[i * stride];

    length[i] = (ClothReal) d;
    inverse[i] = (ClothReal) (1. / d);
    width[i] += (ClothReal) (0.5 * d);
    width[i + 1] += (ClothReal) (0.5 * d);
  }
}

/* The grid of a body; NULL when it is another mesh. */
ClothLaneGrid *CLOTH_LANE_NAME (cloth_lane_grid_new) (const ClothBody * body)
{
  ClothLaneGrid * grid;
  guint columns = body->columns, rows = body->rows;
  ClothLane3 **lines[4];

  if (columns < 2 || rows < 2 || body->n_particles != body->n_vertices)
    return NULL;
  grid = g_new0 (ClothLaneGrid, 1);
  grid->columns = columns;
  grid->rows = rows;
  grid->turned = g_new (guint8, (columns - 1) * (rows - 1));
  if (!find_cells (grid, body)) {
    g_free (grid->turned);
    g_free (grid);
    return NULL;
  }
  grid->du = g_new0 (ClothReal, 5 * columns + 3 * rows);
  grid->inverse_u = grid->du + columns;
  grid->width = grid->inverse_u + columns;
  grid->fold_left = grid->width + columns;
  grid->fold_right = grid->fold_left + columns;
  grid->dv = grid->fold_right + columns;
  grid->inverse_v = grid->dv + rows;
  grid->height = grid->inverse_v + rows;
  measure_line (body->uv, 2, columns, grid->du, grid->inverse_u, grid->width);
  measure_line (body->uv + 1, 2 * columns, rows, grid->dv, grid->inverse_v,
      grid->height);
  for (guint i = 1; i + 1 < columns; i++) {
    grid->fold_left[i] = grid->inverse_u[i - 1] / grid->width[i];
    grid->fold_right[i] = grid->inverse_u[i] / grid->width[i];
  }
  lines[0] = &grid->along_u;
  lines[1] = &grid->along_v;
  lines[2] = &grid->down;
  lines[3] = &grid->force;
  for (guint i = 0; i < G_N_ELEMENTS (lines); i++)
    *lines[i] = g_aligned_alloc0 (columns, sizeof (ClothLane3), 64);
  return grid;
}

void CLOTH_LANE_NAME (cloth_lane_grid_free) (ClothLaneGrid * grid)
{
  if (!grid)
    return;
  g_free (grid->du);
  g_free (grid->turned);
  g_aligned_free (grid->along_u);
  g_aligned_free (grid->along_v);
  g_aligned_free (grid->down);
  g_aligned_free (grid->force);
  g_free (grid);
}

/* One by one: a copy of the whole would go through memory, slowly. */
CLOTH_LANE_INLINE void
copy (const Edge * from, Edge * to)
{
  for (guint k = 0; k < 3; k++) {
    to->x[k] = from->x[k];
    to->w[k] = from->w[k];
    to->z[k] = from->z[k];
  }
}

CLOTH_LANE_INLINE void
measure (const ClothLaneState * state, guint from, guint to, ClothLane inverse,
    ClothLane inverse_beta, Edge * edge)
{
  for (guint k = 0; k < 3; k++) {
    edge->x[k] = (state->x[to][k] - state->x[from][k]) * inverse;
    edge->w[k] = (state->v[to][k] - state->v[from][k]) * inverse_beta;
    edge->z[k] = edge->x[k] + edge->w[k];
  }
}

/* Tensions of n edges by their stretch, of a stiffness each: side by side, so that their
 * chains of operations overlap. A compression_ratio is at most 1. */
CLOTH_LANE_INLINE void
stretch (guint n, const Edge * const *edges, const ClothLane * stiffness,
    ClothLane ratio, ClothLane * tension)
{
  ClothLane half = cloth_lane_set (0.5), square[2], rate[2];

  for (guint k = 0; k < 3; k++) {
    for (guint i = 0; i < n; i++) {
      const Edge *e = edges[i];

      square[i] = k ? square[i] + e->x[k] * e->x[k] : e->x[0] * e->x[0];
      rate[i] = k ? rate[i] + e->x[k] * e->w[k] : e->x[0] * e->w[0];
    }
  }
  for (guint i = 0; i < n; i++)
    square[i] = square[i] * half - half;
  for (guint i = 0; i < n; i++)
    rate[i] += cloth_lane_max (square[i], ratio * square[i]);
  for (guint i = 0; i < n; i++)
    tension[i] = stiffness[i] * rate[i];
}

/* Adds the forces of two triangles' shear along their edges u[i] and v[i], which meet at
 * right angles. */
CLOTH_LANE_INLINE void
shear (const Edge * const u[2], const Edge * const v[2], ClothLane stiffness_u,
    ClothLane stiffness_v, ClothLane * const force_u[2],
    ClothLane * const force_v[2])
{
  ClothLane strain[2];

  for (guint k = 0; k < 3; k++) {
    for (guint i = 0; i < 2; i++) {
      ClothLane part = u[i]->x[k] * v[i]->z[k] + u[i]->w[k] * v[i]->x[k];

      strain[i] = k ? strain[i] + part : part;
    }
  }
  for (guint i = 0; i < 2; i++) {
    ClothLane s_u = stiffness_u * strain[i], s_v = stiffness_v * strain[i];

    for (guint k = 0; k < 3; k++) {
      force_u[i][k] += s_u * v[i]->x[k];
      force_v[i][k] += s_v * u[i]->x[k];
    }
  }
}

/* The forces along two edges in a line by the fold between them. */
CLOTH_LANE_INLINE void
fold (const ClothLane before[3], const ClothLane after[3],
    ClothLane stiffness_before, ClothLane stiffness_after,
    ClothLane force_before[3], ClothLane force_after[3])
{
  for (guint k = 0; k < 3; k++) {
    ClothLane y = before[k] - after[k];

    force_before[k] += stiffness_before * y;
    force_after[k] -= stiffness_after * y;
  }
}

CLOTH_LANE_INLINE void
finish (ClothLaneState * state, const ClothLaneStage * stage, guint particle,
    const ClothLane force[3], Mode mode)
{
  if (mode == STORE) {
    for (guint k = 0; k < 3; k++)
      state->f[particle][k] = force[k];
  } else if (mode == MOVE || mode == MOVE_NUDGED) {
    cloth_lane_move (state, &stage->motion, particle, force,
        mode == MOVE_NUDGED);
  } else {
    ClothLane all[3];

    for (guint k = 0; k < 3; k++)
      all[k] = mode == STAGE ? force[k] : force[k] + state->others[particle][k];
    cloth_lane_stage (state, stage, particle, all);
  }
}

/* Forces along the edges of the first row, without what is below it. */
CLOTH_LANE_INLINE void
first_row (ClothLaneState * state)
{
  ClothLaneGrid *grid = state->grid;
  ClothLane warp = state->stretch_warp * grid->height[0];
  ClothLane bend = state->bending_warp * grid->height[0];
  Edge before, edge;
  const Edge *const edges[] = { &edge };

  for (guint c = 0; c + 1 < grid->columns; c++) {
    ClothLane *force = grid->along_u[c], tension;

    measure (state, c, c + 1, cloth_lane_set (grid->inverse_u[c]),
        state->beta * grid->inverse_u[c], &edge);
    stretch (1, edges, &warp, state->compression_ratio, &tension);
    for (guint k = 0; k < 3; k++)
      force[k] = tension * edge.x[k];
    if (c > 0)
      fold (before.z, edge.z, bend * grid->fold_left[c],
          bend * grid->fold_right[c], grid->along_u[c - 1], force);
    copy (&edge, &before);
  }
}

/* What all columns share in a row. */
typedef struct
{
  guint r;
  ClothLane inverse_v, beta_v;
  ClothLane warp, shear_u, shear_v, bend, bend_up, bend_down, twist;
} Row;

/* What a column leaves for the next: the vertical edge, the lower edge on its left, the
 * forces along them so far, and what is still to be taken from its upper particle's. */
typedef struct
{
  Edge down, across;
  ClothLane down_force[3], across_force[3], taken[3];
} Column;

/* The cell on the left of column @c, its lower and right edges, and the particle above
 * the cell's upper right corner. */
CLOTH_LANE_INLINE void
cell (ClothLaneState * state, const ClothLaneStage * stage, const Row * row,
    guint c, gboolean first, Mode mode, Column * column)
{
  ClothLaneGrid *grid = state->grid;
  guint i = row->r * grid->columns + c;
  ClothLane width = cloth_lane_set (grid->width[c]), stiffness[2], tension[2];
  ClothLane inverse_u, beta_u, shear_v;
  ClothLane down_force[3], across_force[3], top_force[3], up[3];
  Edge down, across, top;
  const Edge *const stretched[2] = { &down, &across };

  measure (state, i, i + grid->columns, row->inverse_v, row->beta_v, &down);
  stiffness[0] = state->stretch_weft * width;
  if (!first) {
    inverse_u = cloth_lane_set (grid->inverse_u[c - 1]);
    beta_u = state->beta * inverse_u;
    shear_v = row->shear_v * grid->du[c - 1];
    measure (state, i + grid->columns - 1, i + grid->columns, inverse_u, beta_u,
        &across);
    measure (state, i - 1, i, inverse_u, beta_u, &top);
    stiffness[1] = row->warp;
  }
  stretch (first ? 1 : 2, stretched, stiffness, state->compression_ratio,
      tension);
  for (guint k = 0; k < 3; k++) {
    down_force[k] = tension[0] * down.x[k];
    up[k] = cloth_lane_set (0.);
  }
  if (row->r > 0) {
    ClothLane above[3];

    for (guint k = 0; k < 3; k++)
      up[k] = grid->along_v[c][k];
    fold (grid->down[c], down.z, row->bend_up * width, row->bend_down * width,
        up, down_force);
    for (guint k = 0; k < 3; k++)
      above[k] = grid->force[c][k] + up[k];
    finish (state, stage, i - grid->columns, above, mode);
  }
  for (guint k = 0; k < 3; k++)
    grid->down[c][k] = down.z[k];
  if (!first) {
    const Edge *const u[2] = { &top, &across };
    ClothLane *const force_u[2] = { top_force, across_force };
    const Edge *const falling[2] = { &column->down, &down };
    ClothLane *const falling_force[2] = { column->down_force, down_force };
    const Edge *const rising[2] = { &down, &column->down };
    ClothLane *const rising_force[2] = { down_force, column->down_force };

    for (guint k = 0; k < 3; k++)
      across_force[k] = tension[1] * across.x[k];
    if (c > 1) {
      fold (column->across.z, across.z, row->bend * grid->fold_left[c - 1],
          row->bend * grid->fold_right[c - 1], column->across_force,
          across_force);
      for (guint k = 0; k < 3; k++)
        grid->along_u[c - 2][k] = column->across_force[k];
    }
    for (guint k = 0; k < 3; k++) {
      ClothLane pull = row->twist * (across.z[k] - top.z[k]);

      across_force[k] += pull;
      top_force[k] = grid->along_u[c - 1][k] - pull;
    }
    if (grid->turned[(gsize) row->r * (grid->columns - 1) + c - 1])
      shear (u, rising, row->shear_u, shear_v, force_u, rising_force);
    else
      shear (u, falling, row->shear_u, shear_v, force_u, falling_force);
    for (guint k = 0; k < 3; k++) {
      grid->along_v[c - 1][k] = column->down_force[k];
      grid->force[c - 1][k] = top_force[k] - column->taken[k];
      up[k] += top_force[k];
      column->across_force[k] = across_force[k];
    }
    copy (&across, &column->across);
  }
  copy (&down, &column->down);
  for (guint k = 0; k < 3; k++) {
    column->down_force[k] = down_force[k];
    column->taken[k] = up[k];
  }
}

/* The cells between rows @r and @r + 1, their lower and vertical edges, and the particles
 * of row @r − 1. */
CLOTH_LANE_INLINE void
cells (ClothLaneState * state, const ClothLaneStage * stage, guint r, Mode mode)
{
  ClothLaneGrid *grid = state->grid;
  guint last = grid->columns - 1;
  Column column;
  Row row;

  row.r = r;
  row.inverse_v = cloth_lane_set (grid->inverse_v[r]);
  row.beta_v = state->beta * row.inverse_v;
  row.warp = state->stretch_warp * grid->height[r + 1];
  row.shear_v = state->shear * cloth_lane_set (0.5);
  row.shear_u = row.shear_v * grid->dv[r];
  row.bend = state->bending_warp * grid->height[r + 1];
  row.bend_down = state->bending_weft * grid->inverse_v[r] / grid->height[r];
  row.bend_up = r > 0 ? state->bending_weft * grid->inverse_v[r - 1] /
      grid->height[r] : cloth_lane_set (0.);
  row.twist = (state->bending_warp + state->bending_weft) * grid->inverse_v[r];
  cell (state, stage, &row, 0, TRUE, mode, &column);
  for (guint c = 1; c <= last; c++)
    cell (state, stage, &row, c, FALSE, mode, &column);
  for (guint k = 0; k < 3; k++) {
    grid->along_u[last - 1][k] = column.across_force[k];
    grid->along_v[last][k] = column.down_force[k];
    grid->force[last][k] = -column.taken[k];
  }
}

/* The particles of the last two rows. */
CLOTH_LANE_INLINE void
last_rows (ClothLaneState * state, const ClothLaneStage * stage, Mode mode)
{
  ClothLaneGrid *grid = state->grid;
  guint columns = grid->columns, last = (grid->rows - 1) * columns;

  for (guint c = 0; c < columns; c++) {
    ClothLane above[3], force[3];

    for (guint k = 0; k < 3; k++) {
      above[k] = grid->force[c][k] + grid->along_v[c][k];
      force[k] = -grid->along_v[c][k];
      if (c + 1 < columns)
        force[k] += grid->along_u[c][k];
      if (c > 0)
        force[k] -= grid->along_u[c - 1][k];
    }
    finish (state, stage, last + c - columns, above, mode);
    finish (state, stage, last + c, force, mode);
  }
}

CLOTH_LANE_INLINE void
sweep (ClothLaneState * state, const ClothLaneStage * stage, Mode mode)
{
  first_row (state);
  for (guint r = 0; r + 1 < state->grid->rows; r++)
    cells (state, stage, r, mode);
  last_rows (state, stage, mode);
}

/* Puts the forces of membrane and bending into f. */
void CLOTH_LANE_NAME (cloth_lane_grid_forces) (ClothLaneState * state)
{
  sweep (state, NULL, STORE);
}

/* A step by the forces of membrane, bending and observer alone. */
void CLOTH_LANE_NAME (cloth_lane_grid_step) (ClothLaneState * state)
{
  ClothLaneStage stage;

  cloth_lane_stage_init (state, state->dt, 1., 0., &stage);
  if (state->has_targets)
    sweep (state, &stage, MOVE_NUDGED);
  else
    sweep (state, &stage, MOVE);
}

/* A stage of a step by these and by the others that don't change in it. */
void CLOTH_LANE_NAME (cloth_lane_grid_stage) (ClothLaneState * state,
    gdouble h, gdouble mu, gdouble nu)
{
  ClothLaneStage stage;

  cloth_lane_stage_init (state, h, mu, nu, &stage);
  if (state->has_others)
    sweep (state, &stage, STAGE_OTHERS);
  else
    sweep (state, &stage, STAGE);
}
