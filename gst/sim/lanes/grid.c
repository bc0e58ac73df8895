/* The sheet of even rows and columns, where most time is spent: its membrane and its
 * bending in one pass, and the step of its particles with them.
 *
 * On such a grid a triangle's x_u is that of its edge along u and its x_v that of its
 * edge along v, so stretch belongs to edges, each for its two triangles, and only shear
 * to triangles. Folds are differences of neighbouring edges. So all forces are forces
 * along edges: a particle's is the sum over its four edges, put together where the pass
 * leaves it behind; nothing is scattered. Edges are not divided by their lengths at rest:
 * stiffnesses are, once a row. The law is that of membrane.c and bending.c to the
 * rounding.
 *
 * The pass goes row by row and keeps one row of edges at hand, which fits into the
 * nearest cache. When row r + 1 is at work, row r − 1 is complete and can move.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/sim/lanes/motion.h"

/* Of an edge the difference x of its ends' places, and z that of these and β times their
 * velocities. Its square is |x|² and twice β times its rate, x·(2z − x). Its force is
 * tension times x, and what is not along it. */
typedef struct
{
  ClothLane x[3], z[3], square, tension, force[3];
} Edge;

/* What a row leaves for the next of a column: its edge to the left, of that above z and
 * the whole force, and what is known of the force on the particle above. */
typedef struct
{
  ClothLane x[3], square, tension, along_u[3];
  ClothLane down_z[3], along_v[3], force[3];
} Column;

struct _ClothLaneGrid
{
  guint columns, rows;
  gdouble du, dv;               /* edges on the average, m */
  /* squares of a row's and of a column's, m²: what is not quite even, or rounded, is
   * at rest where it should be */
  ClothReal *square_u, *square_v;
  /* of each cell: its right angles are top right and bottom left */
  guint8 *turned;
  Column *line;                 /* of the row at work, by column */
};

/* What is to be done with a particle whose force is known. */
typedef enum
{
  STORE,                        /* into f */
  MOVE,                         /* a step */
  MOVE_NUDGED,
  MOVE_OTHERS,                  /* with other forces */
  MOVE_NUDGED_OTHERS,
  STAGE,                        /* a stage of a step */
  STAGE_OTHERS                  /* with other forces */
} Mode;

/* Which cells are turned; FALSE when these are no cells cut in two. */
static gboolean
find_cells (ClothLaneGrid * grid, const ClothBody * body)
{
  guint columns = grid->columns, cells = (columns - 1) * (grid->rows - 1);
  g_autofree guint8 *corners = g_new0 (guint8, cells);

  for (guint i = 0; i < body->n_triangles; i++) {
    const guint32 *p = body->triangles[i].particle;
    guint column = p[0] % columns, row = p[0] / columns;
    guint left = MIN (column, p[1] % columns), top = MIN (row, p[2] / columns);

    if (p[1] / columns != row || p[2] % columns != column
        || MAX (column, p[1] % columns) != left + 1
        || MAX (row, p[2] / columns) != top + 1)
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

/* The squares of the edges of a line; returns their mean length. */
static gdouble
measure_line (const gdouble * uv, gsize stride, guint n, ClothReal * square)
{
  for (guint i = 0; i + 1 < n; i++) {
    gdouble d = uv[(i + 1) * stride] - uv[i * stride];

    square[i] = (ClothReal) (d * d);
  }
  return (uv[(n - 1) * stride] - uv[0]) / (n - 1);
}

/* The grid of a body; NULL when it is another mesh. */
ClothLaneGrid *CLOTH_LANE_NAME (cloth_lane_grid_new) (const ClothBody * body)
{
  ClothLaneGrid * grid;
  guint columns = body->columns, rows = body->rows;

  if (!body->even || body->n_particles != body->n_vertices)
    return NULL;
  grid = g_new0 (ClothLaneGrid, 1);
  grid->columns = columns;
  grid->rows = rows;
  grid->square_u = g_new0 (ClothReal, columns);
  grid->square_v = g_new0 (ClothReal, rows);
  grid->du = measure_line (body->uv, 2, columns, grid->square_u);
  grid->dv = measure_line (body->uv + 1, 2 * columns, rows, grid->square_v);
  grid->turned = g_new (guint8, (columns - 1) * (rows - 1));
  grid->line = g_aligned_alloc0 (columns, sizeof *grid->line, 64);
  if (!find_cells (grid, body)) {
    CLOTH_LANE_NAME (cloth_lane_grid_free) (grid);
    return NULL;
  }
  return grid;
}

void CLOTH_LANE_NAME (cloth_lane_grid_free) (ClothLaneGrid * grid)
{
  if (!grid)
    return;
  g_free (grid->square_u);
  g_free (grid->square_v);
  g_free (grid->turned);
  g_aligned_free (grid->line);
  g_free (grid);
}

/* Of edges along u, or along v: their stiffness against stretch and against folds across
 * them, at the sheet's sides and within. */
typedef struct
{
  ClothLane stretch[2], fold[2];
} Kind;

static void
kind_init (Kind * kind, ClothLane stretch, ClothLane bend, gdouble length,
    gdouble width)
{
  ClothReal cube = (ClothReal) (width / (length * length * length));

  kind->stretch[1] = stretch * cloth_lane_set (0.5) * cube;
  kind->fold[1] = bend * cube;
  kind->stretch[0] = kind->stretch[1] * cloth_lane_set (0.5);
  kind->fold[0] = kind->fold[1] * cloth_lane_set (0.5);
}

/* What all rows share. */
typedef struct
{
  Kind u, v;
  ClothLane shear, twist;
} Stiffness;

static void
stiffness_init (const ClothLaneState * state, Stiffness * stiffness)
{
  gdouble du = state->grid->du, dv = state->grid->dv;
  ClothReal cell = (ClothReal) (1. / (du * dv));

  kind_init (&stiffness->u, state->stretch_warp, state->bending_warp, du, dv);
  kind_init (&stiffness->v, state->stretch_weft, state->bending_weft, dv, du);
  stiffness->shear = state->shear * cloth_lane_set (0.25) * cell;
  stiffness->twist = (state->bending_warp + state->bending_weft) * cell;
}

/* Of @n edges their differences and tensions by their stretch from @rest, squares: side
 * by side, so that their chains of operations overlap. A compression_ratio is at most 1. */
CLOTH_LANE_INLINE void
measure (const ClothLaneState * state, guint n, const gsize * from, gsize to,
    const ClothReal * rest, const ClothLane * const *stiffness,
    Edge * const *edges)
{
  ClothLane square[2], product[2];

  for (guint k = 0; k < 3; k++) {
    for (guint i = 0; i < n; i++) {
      ClothLane x = state->x[to][k] - state->x[from[i]][k];
      ClothLane z = x + (state->v[to][k] - state->v[from[i]][k]) * state->beta;

      square[i] = k ? square[i] + x * x : x * x;
      product[i] = k ? product[i] + x * z : x * z;
      edges[i]->x[k] = x;
      edges[i]->z[k] = z;
    }
  }
  for (guint i = 0; i < n; i++)
    edges[i]->square = product[i] + product[i] - square[i];
  for (guint i = 0; i < n; i++) {
    ClothLane longer = square[i] - cloth_lane_set (rest[i]);
    ClothLane rate = edges[i]->square - square[i];

    edges[i]->tension = *stiffness[i] *
        (cloth_lane_max (longer, state->compression_ratio * longer) + rate);
  }
}

/* The shear of the two triangles of a cell: of one whose right angle is between a and b
 * x_u·x_v, which with its third side h is ± ½ (|a|² + |b|² − |h|²). So it changes the
 * tensions of the sides. The third one, which both share, is the sum of @lies and @lower
 * when the cell is @turned, else their difference; its force goes along these. Returns
 * the tension of the upper side, whose square is @top_square. */
CLOTH_LANE_INLINE ClothLane
shear (gboolean turned, ClothLane top_square, Edge * lies, Edge * upper,
    Edge * lower, ClothLane stiffness)
{
  ClothLane x[3], square, product, z, tension[2];

  for (guint k = 0; k < 3; k++) {
    x[k] = turned ? lies->x[k] + lower->x[k] : lies->x[k] - lower->x[k];
    z = turned ? lies->z[k] + lower->z[k] : lies->z[k] - lower->z[k];
    square = k ? square + x[k] * x[k] : x[k] * x[k];
    product = k ? product + x[k] * z : x[k] * z;
  }
  square = product + product - square;
  tension[0] = stiffness * (top_square + upper->square - square);
  tension[1] = stiffness * (lies->square + lower->square - square);
  upper->tension += tension[0];
  lower->tension += tension[1];
  lies->tension += tension[1];
  for (guint k = 0; k < 3; k++) {
    ClothLane push = (tension[0] + tension[1]) * x[k];

    lies->force[k] -= push;
    lower->force[k] = turned ? lower->force[k] - push : lower->force[k] + push;
  }
  return tension[0];
}

/* Adds the forces along two edges in a line by the fold between them. */
CLOTH_LANE_INLINE void
fold (const ClothLane before[3], const ClothLane after[3], ClothLane stiffness,
    ClothLane force_before[3], ClothLane force_after[3])
{
  for (guint k = 0; k < 3; k++) {
    ClothLane pull = stiffness * (before[k] - after[k]);

    force_before[k] += pull;
    force_after[k] -= pull;
  }
}

CLOTH_LANE_INLINE void
finish (ClothLaneState * state, const ClothLaneStage * stage, guint particle,
    const ClothLane force[3], Mode mode)
{
  ClothLane all[3];

  if (mode == STORE) {
    for (guint k = 0; k < 3; k++)
      state->f[particle][k] = force[k];
    return;
  }
  for (guint k = 0; k < 3; k++)
    all[k] = mode == MOVE_OTHERS || mode == MOVE_NUDGED_OTHERS
        || mode == STAGE_OTHERS ? force[k] + state->others[particle][k] :
        force[k];
  if (mode == STAGE || mode == STAGE_OTHERS)
    cloth_lane_stage (state, stage, particle, all);
  else
    cloth_lane_move (state, &stage->motion, particle, all,
        mode == MOVE_NUDGED || mode == MOVE_NUDGED_OTHERS);
}

CLOTH_LANE_INLINE void
copy (const ClothLane from[3], ClothLane to[3])
{
  for (guint k = 0; k < 3; k++)
    to[k] = from[k];
}

/* Edges of the first row and the forces along them, without what is below it. */
CLOTH_LANE_INLINE void
first_row (ClothLaneState * state, const Stiffness * stiffness)
{
  ClothLaneGrid *grid = state->grid;
  const ClothLane *const stretch = &stiffness->u.stretch[0];
  ClothLane zero[3] = { 0 };
  Edge edge[2];

  for (gsize c = 1; c < grid->columns; c++) {
    Column *column = &grid->line[c];
    Edge *const at = &edge[c % 2];
    const gsize left = c - 1;

    measure (state, 1, &left, c, &grid->square_u[left], &stretch, &at);
    copy (at->x, column->x);
    column->square = at->square;
    column->tension = at->tension;
    copy (zero, column->along_u);
    if (c > 1)
      fold (edge[(c - 1) % 2].z, at->z, stiffness->u.fold[0],
          column[-1].along_u, column->along_u);
  }
}

/* The cell on the left of column @c in row @r, its lower and right edges, and the
 * particle above the cell's upper right corner. @down and @across, which were those of
 * the column on the left, become this one's. */
CLOTH_LANE_INLINE void
cell (ClothLaneState * state, const ClothLaneStage * stage,
    const Stiffness * stiffness, gsize r, gsize c, gboolean first, Mode mode,
    Edge * down, Edge * across)
{
  ClothLaneGrid *grid = state->grid;
  const guint inner[2] = { !first && c + 1 < grid->columns,
    r + 2 < grid->rows
  };
  const ClothLane *const stretch[2] = { &stiffness->v.stretch[inner[0]],
    &stiffness->u.stretch[inner[1]]
  };
  const ClothReal rest[2] = { grid->square_v[r],
    first ? 0 : grid->square_u[c - 1]
  };
  gsize columns = grid->columns, i = r * columns + c;
  const gsize from[2] = { i, i + columns - 1 };
  Column *right = &grid->line[c], *left = right - 1;
  ClothLane up[3], top_force[3];
  Edge falls, lies;
  Edge *const edges[2] = { &falls, &lies };

  measure (state, first ? 1 : 2, from, i + columns, rest, stretch, edges);
  for (guint k = 0; k < 3; k++)
    up[k] = falls.force[k] = lies.force[k] = cloth_lane_set (0.);
  if (r > 0) {
    ClothLane above[3];

    copy (right->along_v, up);
    fold (right->down_z, falls.z, stiffness->v.fold[inner[0]], up, falls.force);
    for (guint k = 0; k < 3; k++)
      above[k] = right->force[k] + up[k];
    finish (state, stage, i - columns, above, mode);
  }
  copy (falls.z, right->down_z);
  if (!first) {
    ClothLane upper;

    if (c > 1)
      fold (across->z, lies.z, stiffness->u.fold[inner[1]], left->along_u,
          lies.force);
    for (guint k = 0; k < 3; k++) {
      ClothLane pull = stiffness->twist * (falls.z[k] - down->z[k]);

      lies.force[k] += pull;
      top_force[k] = right->along_u[k] - pull;
    }
    if (grid->turned[r * (columns - 1) + c - 1])
      upper = shear (TRUE, right->square, &lies, &falls, down,
          stiffness->shear);
    else
      upper = shear (FALSE, right->square, &lies, down, &falls,
          stiffness->shear);
    for (guint k = 0; k < 3; k++) {
      top_force[k] += (right->tension + upper) * right->x[k];
      left->along_v[k] = down->force[k] + down->tension * down->x[k];
      left->force[k] = top_force[k] - left->force[k];
      up[k] += top_force[k];
    }
    copy (lies.x, right->x);
    right->square = lies.square;
    right->tension = lies.tension;
    copy (lies.force, right->along_u);
    copy (lies.z, across->z);
  }
  copy (up, right->force);
  copy (falls.x, down->x);
  copy (falls.z, down->z);
  copy (falls.force, down->force);
  down->square = falls.square;
  down->tension = falls.tension;
}

/* The cells between rows @r and @r + 1, their lower and vertical edges, and the particles
 * of row @r − 1. */
CLOTH_LANE_INLINE void
cells (ClothLaneState * state, const ClothLaneStage * stage,
    const Stiffness * stiffness, guint r, Mode mode)
{
  ClothLaneGrid *grid = state->grid;
  Column *last = &grid->line[grid->columns - 1];
  Edge down = { 0 }, across = { 0 };

  cell (state, stage, stiffness, r, 0, TRUE, mode, &down, &across);
  for (gsize c = 1; c < grid->columns; c++)
    cell (state, stage, stiffness, r, c, FALSE, mode, &down, &across);
  for (guint k = 0; k < 3; k++) {
    last->along_v[k] = down.force[k] + down.tension * down.x[k];
    last->force[k] = -last->force[k];
  }
}

/* The particles of the last two rows. */
CLOTH_LANE_INLINE void
last_rows (ClothLaneState * state, const ClothLaneStage * stage, Mode mode)
{
  ClothLaneGrid *grid = state->grid;
  guint columns = grid->columns, last = (grid->rows - 1) * columns;

  for (guint c = 0; c < columns; c++) {
    const Column *column = &grid->line[c];
    ClothLane above[3], force[3];

    for (guint k = 0; k < 3; k++) {
      above[k] = column->force[k] + column->along_v[k];
      force[k] = -column->along_v[k];
      if (c + 1 < columns)
        force[k] += column[1].along_u[k] + column[1].tension * column[1].x[k];
      if (c > 0)
        force[k] -= column->along_u[k] + column->tension * column->x[k];
    }
    finish (state, stage, last + c - columns, above, mode);
    finish (state, stage, last + c, force, mode);
  }
}

CLOTH_LANE_INLINE void
sweep (ClothLaneState * state, const ClothLaneStage * stage, Mode mode)
{
  Stiffness stiffness;

  stiffness_init (state, &stiffness);
  first_row (state, &stiffness);
  for (guint r = 0; r + 1 < state->grid->rows; r++)
    cells (state, stage, &stiffness, r, mode);
  last_rows (state, stage, mode);
}

/* Puts the forces of membrane and bending into f. */
void CLOTH_LANE_NAME (cloth_lane_grid_forces) (ClothLaneState * state)
{
  sweep (state, NULL, STORE);
}

/* A step by the forces of membrane and bending, by the observer and by pulls, which are in the
 * others. */
void CLOTH_LANE_NAME (cloth_lane_grid_step) (ClothLaneState * state)
{
  ClothLaneStage stage;

  cloth_lane_stage_init (state, state->kick, 1., 0., &stage);
  if (state->has_targets && state->pulls.n)
    sweep (state, &stage, MOVE_NUDGED_OTHERS);
  else if (state->has_targets)
    sweep (state, &stage, MOVE_NUDGED);
  else if (state->pulls.n)
    sweep (state, &stage, MOVE_OTHERS);
  else
    sweep (state, &stage, MOVE);
}

/* A stage of a step by these and by the others that don't change in it. */
void CLOTH_LANE_NAME (cloth_lane_grid_stage) (ClothLaneState * state,
    ClothLane h, gdouble mu, gdouble nu)
{
  ClothLaneStage stage;

  cloth_lane_stage_init (state, h, mu, nu, &stage);
  if (state->has_others)
    sweep (state, &stage, STAGE_OTHERS);
  else
    sweep (state, &stage, STAGE);
}
