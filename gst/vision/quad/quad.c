/* Tracking the squares of a checkerboard on cloth.
 *
 * Follows "Direct Pattern Tracking On Flexible Geometry" (I. Guskov, L. Zhukov): every
 * square is tracked on its own, the grid only constrains. What is added: each picture's
 * saddles are first joined into patches of the grid, which finds squares however far they
 * moved; memory, the board's rim and its code tell where on the board a patch lies. The
 * paper's prediction, local search, consistency and extension then serve the squares that
 * linking missed, and everything when linking is off.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/quad/quad.h"

#include <math.h>
#include <string.h>

#include "gst/vision/quad/quad-private.h"

/* Pictures for which a square not seen is still given out as predicted. */
#define PREDICTED_FOR 5
/* Standard deviation of a predicted corner, in shortest edges for each picture of age. */
#define PREDICTED_SD 0.1f

static const gint diagonal_column[4] = { -1, 1, 1, -1 };
static const gint diagonal_row[4] = { -1, -1, 1, 1 };

/* Returns: the paper's constants, linking on, black squares.
 */
ClothQuadParams
cloth_quad_default_params (void)
{
  return (ClothQuadParams) {
  .alpha = 0.25f,.c_low = 0.62f,.c_high = 0.75f,.c_pred = 0.7f,.damping =
        0.9f,.consistency = 0.4f,.max_variants = 64,.link = TRUE,.squares =
        CLOTH_SQUARES_BLACK};
}

/* @pattern: the board; copied
 *
 * Returns: (transfer full): a tracker for that board. It keeps its memory from picture to
 *   picture and allocates none in steady state.
 */
ClothQuadTracker *
cloth_quad_tracker_new (const ClothPattern * pattern)
{
  ClothQuadTracker *tracker = g_new0 (ClothQuadTracker, 1);
  gsize n = (gsize) pattern->columns * (gsize) pattern->rows;

  tracker->pattern = *pattern;
  if (pattern->code)
    tracker->pattern.code = g_memdup2 (pattern->code, n);
  tracker->cells = g_new0 (ClothQuadCell, n);
  tracker->vertices = g_new0 (ClothQuadVertex,
      (gsize) (pattern->columns + 1) * (gsize) (pattern->rows + 1));
  tracker->linker = cloth_linker_new ();
  tracker->guesses = cloth_point_grid_new ();
  tracker->guess_vertex = g_array_new (FALSE, FALSE, sizeof (gint));
  tracker->recalls = g_array_new (FALSE, FALSE, sizeof (ClothQuadRecall));
  tracker->candidates = cloth_point_grid_new ();
  tracker->refined = cloth_point_grid_new ();
  tracker->claimed = cloth_point_grid_new ();
  tracker->claims = g_array_new (FALSE, FALSE, sizeof (ClothQuadClaim));
  tracker->corners = cloth_point_grid_new ();
  tracker->corner_vertex = g_array_new (FALSE, FALSE, sizeof (gint));
  tracker->pending = cloth_point_grid_new ();
  tracker->pending_now = cloth_point_grid_new ();
  tracker->pending_corner = g_array_new (FALSE, FALSE,
      sizeof (ClothQuadPending));
  tracker->pending_corner_now = g_array_new (FALSE, FALSE,
      sizeof (ClothQuadPending));
  tracker->pose_finder = cloth_pose_finder_new (pattern);
  tracker->seeds = g_array_new (FALSE, FALSE, sizeof (ClothQuadSeed));
  tracker->out =
      g_array_sized_new (FALSE, FALSE, sizeof (ClothQuad), (guint) n);
  cloth_quad_set_logarithms (tracker->logarithm);
  cloth_quad_tracker_reset (tracker);
  return tracker;
}

/* @tracker: (transfer full): the tracker
 */
void
cloth_quad_tracker_free (ClothQuadTracker * tracker)
{
  g_free (tracker->pattern.code);
  g_free (tracker->cells);
  g_free (tracker->vertices);
  g_free (tracker->logarithms);
  cloth_linker_free (tracker->linker);
  cloth_patch_clear (&tracker->patch);
  cloth_point_grid_free (tracker->guesses);
  g_array_unref (tracker->guess_vertex);
  g_array_unref (tracker->recalls);
  cloth_point_grid_free (tracker->candidates);
  cloth_point_grid_free (tracker->refined);
  cloth_point_grid_free (tracker->claimed);
  g_array_unref (tracker->claims);
  cloth_point_grid_free (tracker->corners);
  g_array_unref (tracker->corner_vertex);
  cloth_point_grid_free (tracker->pending);
  cloth_point_grid_free (tracker->pending_now);
  g_array_unref (tracker->pending_corner);
  g_array_unref (tracker->pending_corner_now);
  cloth_pose_finder_free (tracker->pose_finder);
  g_array_unref (tracker->seeds);
  g_array_unref (tracker->out);
  g_free (tracker);
}

/* @tracker: the tracker
 *
 * Forgets all squares and seeds, as at the start of another film.
 */
void
cloth_quad_tracker_reset (ClothQuadTracker * tracker)
{
  gint n = tracker->pattern.columns * tracker->pattern.rows;

  for (gint k = 0; k < n; k++) {
    tracker->cells[k].age = G_MAXUINT;
    tracker->cells[k].run = 0;
    tracker->cells[k].whole = 0;
    tracker->cells[k].shown = FALSE;
  }
  tracker->doubts = tracker->n_shades = tracker->contrary = 0;
  tracker->shade = 0;
  g_array_set_size (tracker->pending_corner, 0);
  g_array_set_size (tracker->seeds, 0);
}

/* @tracker: the tracker
 * @x: columns of the corners of one square, roughly, px: top-left, top-right,
 *   bottom-right, bottom-left as they lie on the flat board
 * @y: rows of them
 * @column: column of the square on the board, -1 when not known
 * @row: row of it
 *
 * Tells the tracker where a square lies in the next picture (section 4 of the paper). A
 * square without place on the board counts as one in the board's middle, unless rim or
 * code say otherwise.
 */
void
cloth_quad_tracker_seed (ClothQuadTracker * tracker, const gfloat x[4],
    const gfloat y[4], gint column, gint row)
{
  ClothQuadSeed seed;

  memcpy (seed.x, x, sizeof seed.x);
  memcpy (seed.y, y, sizeof seed.y);
  /* Given the other way round the ring is turned over: its first corner stays. */
  if ((x[2] - x[0]) * (y[3] - y[1]) < (y[2] - y[0]) * (x[3] - x[1])) {
    seed.x[1] = x[3];
    seed.y[1] = y[3];
    seed.x[3] = x[1];
    seed.y[3] = y[1];
  }
  seed.column = row < 0 ? -1 : column;
  seed.row = column < 0 ? -1 : row;
  g_array_append_val (tracker->seeds, seed);
  tracker->n_shades = 0;
}

/* Looks for a square at a guess and keeps it if the grid allows. */
static gboolean
try_square (ClothQuadTracker * tracker, gint column, gint row,
    const gfloat guess_x[4], const gfloat guess_y[4])
{
  ClothQuadCell *cell = cloth_quad_cell (tracker, column, row);

  if (!cloth_quad_search (tracker, column, row, guess_x, guess_y))
    return FALSE;
  cell->found = cloth_quad_is_consistent (tracker, column, row)
      && cloth_quad_claim (tracker, column, row);
  return cell->found;
}

/* Section 3.9: squares not found are looked for where a confident neighbour's
 * parallelogram puts them. One ring of squares a picture, as in the paper. */
static void
extend (ClothQuadTracker * tracker)
{
  const ClothQuadParams *params = tracker->params;
  gint columns = tracker->pattern.columns, rows = tracker->pattern.rows;

  for (gint row = 0; row < rows; row++)
    for (gint column = 0; column < columns; column++) {
      ClothQuadCell *cell = cloth_quad_cell (tracker, column, row);

      if (cell->found || !cell->wanted)
        continue;
      for (gint k = 0; k < 4; k++) {
        const ClothQuadCell *from = cloth_quad_cell (tracker,
            column + diagonal_column[k], row + diagonal_row[k]);
        const gfloat *fx, *fy;
        gfloat ux, uy, vx, vy, x[4], y[4];

        if (!from || !from->found || from->fresh
            || from->confidence <= params->c_pred)
          continue;
        fx = from->here_x;
        fy = from->here_y;
        ux = (fx[1] - fx[0] + fx[2] - fx[3]) / 2;
        uy = (fy[1] - fy[0] + fy[2] - fy[3]) / 2;
        vx = (fx[3] - fx[0] + fx[2] - fx[1]) / 2;
        vy = (fy[3] - fy[0] + fy[2] - fy[1]) / 2;
        for (gint m = 0; m < 4; m++) {
          x[m] = fx[m] - (gfloat) diagonal_column[k] * ux
              - (gfloat) diagonal_row[k] * vx;
          y[m] = fy[m] - (gfloat) diagonal_column[k] * uy
              - (gfloat) diagonal_row[k] * vy;
        }
        if (try_square (tracker, column, row, x, y)) {
          cell->confidence *= params->damping;
          cell->fresh = TRUE;
          break;
        }
      }
    }
}

/* Without linking, seeds start squares themselves. */
static void
start_seeds (ClothQuadTracker * tracker)
{
  const ClothPattern *pattern = &tracker->pattern;

  for (guint s = 0; s < tracker->seeds->len; s++) {
    const ClothQuadSeed *seed =
        &g_array_index (tracker->seeds, ClothQuadSeed, s);
    gint column = seed->column, row = seed->row;
    ClothQuadCell *cell;

    if (column < 0) {
      column = pattern->columns / 2;
      row = pattern->rows / 2;
      cell = cloth_quad_cell (tracker, column, row);
      if (!cell->wanted && column > 0)
        column--;
    }
    cell = cloth_quad_cell (tracker, column, row);
    if (!cell || !cell->wanted)
      continue;
    cloth_quad_search (tracker, column, row, seed->x, seed->y);
  }
}

static void
put_out (ClothQuadTracker * tracker, gint column, gint row,
    ClothQuadState state)
{
  const ClothQuadCell *cell = cloth_quad_cell (tracker, column, row);
  ClothQuad quad = { column, row, state,
    cloth_pattern_is_black (&tracker->pattern, column, row)
  };

  quad.confidence = state == CLOTH_QUAD_TRACKED ? cell->confidence : 0;
  memcpy (quad.x, state == CLOTH_QUAD_TRACKED ? cell->x : cell->guess_x,
      sizeof quad.x);
  memcpy (quad.y, state == CLOTH_QUAD_TRACKED ? cell->y : cell->guess_y,
      sizeof quad.y);
  if (state == CLOTH_QUAD_TRACKED) {
    memcpy (quad.cov, cell->cov, sizeof quad.cov);
  } else {
    gfloat sd = PREDICTED_SD * (gfloat) MIN (cell->age, PREDICTED_FOR + 1)
        * cloth_quad_shortest (quad.x, quad.y);

    for (gint k = 0; k < 4; k++) {
      quad.cov[k][0] = quad.cov[k][2] = sd * sd;
      quad.cov[k][1] = 0;
    }
  }
  g_array_append_val (tracker->out, quad);
}

/* Remembers what was found and gives it out. */
static void
conclude (ClothQuadTracker * tracker)
{
  gint columns = tracker->pattern.columns, rows = tracker->pattern.rows;

  g_array_set_size (tracker->out, 0);
  for (gint row = 0; row < rows; row++)
    for (gint column = 0; column < columns; column++) {
      ClothQuadCell *cell = cloth_quad_cell (tracker, column, row);

      if (cell->found) {
        if (cell->age == 0) {
          memcpy (cell->before_x, cell->x, sizeof cell->x);
          memcpy (cell->before_y, cell->y, sizeof cell->y);
          cell->run++;
        } else {
          cell->run = 1;
        }
        memcpy (cell->x, cell->here_x, sizeof cell->x);
        memcpy (cell->y, cell->here_y, sizeof cell->y);
        cell->age = 0;
        cell->shown = TRUE;
        put_out (tracker, column, row, CLOTH_QUAD_TRACKED);
        continue;
      }
      if (cell->age != G_MAXUINT && ++cell->age <= PREDICTED_FOR) {
        put_out (tracker, column, row, CLOTH_QUAD_PREDICTED);
      } else if (cell->shown) {
        put_out (tracker, column, row, CLOTH_QUAD_LOST);
        cell->shown = FALSE;
      }
      if (cell->age == G_MAXUINT)
        continue;
      if (cell->age > CLOTH_QUAD_MEMORY) {
        cell->age = G_MAXUINT;
        cell->run = 0;
        continue;
      }
      memcpy (cell->before_x, cell->x, sizeof cell->x);
      memcpy (cell->before_y, cell->y, sizeof cell->y);
      memcpy (cell->x, cell->guess_x, sizeof cell->x);
      memcpy (cell->y, cell->guess_y, sizeof cell->y);
    }
}

/* @tracker: the tracker
 * @params: parameters; may change from picture to picture
 * @image: the next picture
 * @saddles: (array length=n_saddles): its refined saddles
 * @n_saddles: how many
 * @candidates: (array length=n_candidates): its saddle candidates (paper 3.4)
 * @n_candidates: how many
 * @n_quads: (out): number of squares returned
 *
 * Tracks the board's squares into the next picture.
 *
 * Returns: (array length=n_quads) (transfer none): squares tracked, predicted and just
 *   lost, by row and column; valid until the next call
 */
const ClothQuad *
cloth_quad_tracker_run (ClothQuadTracker * tracker,
    const ClothQuadParams * params, const ClothImage * image,
    const ClothSaddle * saddles, guint n_saddles,
    const ClothSaddleCandidate * candidates, guint n_candidates,
    guint * n_quads)
{
  gint columns = tracker->pattern.columns, rows = tracker->pattern.rows;

  tracker->params = params;
  tracker->image = image;
  tracker->saddles = saddles;
  tracker->n_saddles = n_saddles;
  tracker->raw = candidates;
  tracker->n_raw = n_candidates;
  tracker->sorted = FALSE;

  cloth_quad_predict (tracker);
  if (params->link) {
    cloth_quad_link (tracker);
    cloth_quad_spread_shift (tracker);
  } else {
    start_seeds (tracker);
  }
  cloth_quad_claim_all (tracker);
  for (gint row = 0; row < rows; row++)
    for (gint column = 0; column < columns; column++) {
      ClothQuadCell *cell = cloth_quad_cell (tracker, column, row);

      if (!cell->found && cell->wanted && cell->age == 0
          && cloth_quad_search (tracker, column, row, cell->guess_x,
              cell->guess_y))
        cell->found = cloth_quad_claim (tracker, column, row);
    }
  cloth_quad_check (tracker);
  extend (tracker);
  if (params->link)
    cloth_quad_drop_short (tracker);
  g_array_set_size (tracker->seeds, 0);
  cloth_quad_learn_shade (tracker);
  conclude (tracker);
  *n_quads = tracker->out->len;
  return (const ClothQuad *) tracker->out->data;
}
