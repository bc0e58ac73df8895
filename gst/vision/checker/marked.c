/* Checkerboards with a marker in each white square (ChArUco): of what is seen of them, each corner
 * is known by the markers beside it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/checker/marked.h"

#include <math.h>
#include <string.h>

#include "gst/rig/planar.h"

struct _ClothMarkedBoard
{
  gdouble marker;               /* edge, in squares */
  guint n_markers;
  guint *squares;               /* of each marker: row·columns + column */
  guint *seen;                  /* of each marker: how often in this picture */
  /* of each vertex, what the markers beside it foretell */
  guint *n_told;
  gdouble *place;               /* x, y, px; the sum */
  gdouble *reach;               /* how far off it may be, px; the least */
  gdouble margin;               /* px */
  gboolean is_contradicted;     /* by another marker, in this picture */
  guint *taken;                 /* of each vertex, which saddle it took */
  ClothBoardView view;
};

/* @pattern: the board without its markers
 * @marker: edge of a marker over that of a square, in (0, 1)
 *
 * The white squares hold the markers in the middle of each, numbered from 0 row by row.
 *
 * Returns: (transfer full): what finds the board; it keeps its memory from picture to picture
 */
ClothMarkedBoard *
cloth_marked_board_new (const ClothPattern * pattern, gdouble marker)
{
  ClothMarkedBoard *board = g_new0 (ClothMarkedBoard, 1);
  guint n_squares = (guint) (pattern->columns * pattern->rows), n;

  board->marker = marker;
  board->squares = g_new (guint, n_squares);
  board->seen = g_new0 (guint, n_squares);
  for (guint i = 0; i < n_squares; i++) {
    if (!cloth_pattern_is_black (pattern, (gint) i % pattern->columns,
            (gint) i / pattern->columns))
      board->squares[board->n_markers++] = i;
  }
  cloth_board_view_init (&board->view, pattern);
  n = (guint) (board->view.columns * board->view.rows);
  board->n_told = g_new0 (guint, n);
  board->place = g_new (gdouble, 2 * n);
  board->reach = g_new (gdouble, n);
  board->taken = g_new (guint, n);
  return board;
}

/* @board: (transfer full): the board
 */
void
cloth_marked_board_free (ClothMarkedBoard * board)
{
  g_free (board->squares);
  g_free (board->seen);
  g_free (board->n_told);
  g_free (board->place);
  g_free (board->reach);
  g_free (board->taken);
  cloth_board_view_clear (&board->view);
  g_free (board);
}

/* A corner of the square around a marker. A second marker that tells a place more than half a
 * square, of @half px, away means another corner. */
static void
tell (ClothMarkedBoard * board, guint vertex, gdouble x, gdouble y,
    gdouble reach, gdouble half)
{
  guint n = board->n_told[vertex]++;
  gdouble *place = board->place + 2 * vertex;

  if (n == 0) {
    place[0] = x;
    place[1] = y;
    board->reach[vertex] = reach;
    return;
  }
  board->reach[vertex] = fmin (board->reach[vertex], reach);
  if (hypot (place[0] / n - x, place[1] / n - y) > half)
    board->is_contradicted = TRUE;
  place[0] += x;
  place[1] += y;
}

/* The square's corners lie outside those of its marker, in the same plane. Half of the way between
 * both is how far off a corner may be. */
static gboolean
tell_square (ClothMarkedBoard * board, guint square, const gfloat * corners)
{
  const gint vertices = board->view.columns, columns = vertices - 1;
  const guint first = (guint) ((gint) square / columns * vertices
      + (gint) square % columns);
  const guint vertex[4] = { first, first + 1, first + (guint) vertices + 1,
    first + (guint) vertices
  };
  static const gdouble X[4] = { -1, 1, 1, -1 }, Y[4] = { -1, -1, 1, 1 };
  gdouble x[4], y[4], H[9], at[8], half = HUGE_VAL;

  for (guint k = 0; k < 4; k++) {
    x[k] = corners[2 * k];
    y[k] = corners[2 * k + 1];
  }
  if (!cloth_planar_homography (4, X, Y, x, y, H))
    return FALSE;
  for (guint k = 0; k < 4; k++) {
    gdouble u = X[k] / board->marker, v = Y[k] / board->marker;
    gdouble w = H[6] * u + H[7] * v + H[8];

    /* A square that reaches behind the camera. */
    if (!(w * H[8] > 0))
      return FALSE;
    at[2 * k] = (H[0] * u + H[1] * v + H[2]) / w;
    at[2 * k + 1] = (H[3] * u + H[4] * v + H[5]) / w;
  }
  for (guint k = 0; k < 4; k++)
    half = fmin (half, 0.5 * hypot (at[2 * k] - at[(2 * k + 2) & 7],
            at[2 * k + 1] - at[(2 * k + 3) & 7]));
  for (guint k = 0; k < 4; k++) {
    gdouble reach = 0.5 * hypot (at[2 * k] - x[k], at[2 * k + 1] - y[k]);

    tell (board, vertex[k], at[2 * k], at[2 * k + 1], reach, half);
    /* Along an edge; the reach is half of the way across the corner. */
    board->margin = fmin (board->margin, G_SQRT2 * reach);
  }
  return TRUE;
}

/* @board: the board
 * @n: markers found in a picture
 * @ids: (array length=n): their numbers
 * @corners: (array): of each the top left corner, as it is printed, and the others clockwise, x and
 *   y, px, [n][4][2]
 *
 * Begins a picture. Markers that the board doesn't have are left out, and those that are seen twice.
 *
 * Returns: how many of the markers are the board's
 */
guint
cloth_marked_board_set_markers (ClothMarkedBoard * board, guint n,
    const gint * ids, const gfloat * corners)
{
  guint n_vertices = (guint) (board->view.columns * board->view.rows), own = 0;

  memset (board->seen, 0, board->n_markers * sizeof *board->seen);
  memset (board->n_told, 0, n_vertices * sizeof *board->n_told);
  board->margin = HUGE_VAL;
  board->is_contradicted = FALSE;
  for (guint i = 0; i < n; i++)
    if (ids[i] >= 0 && (guint) ids[i] < board->n_markers)
      board->seen[ids[i]]++;
  for (guint i = 0; i < n; i++)
    if (ids[i] >= 0 && (guint) ids[i] < board->n_markers
        && board->seen[ids[i]] == 1
        && tell_square (board, board->squares[ids[i]], corners + 8 * i))
      own++;
  return own;
}

/* @board: the board, its markers set
 *
 * Returns: how near the markers come to the edges of their squares in this picture, px: a corner is
 *   best fitted in a window whose radius is no larger. Infinite without markers
 */
gdouble
cloth_marked_board_get_margin (const ClothMarkedBoard * board)
{
  return board->margin;
}

static gint
compare_numbers (gconstpointer a, gconstpointer b)
{
  const guint m = *(const guint *) a, n = *(const guint *) b;

  return m < n ? -1 : m > n;
}

/* Whether one saddle is two corners: a misread marker that shares no corner with others puts its own
 * where those have theirs. */
static gboolean
is_taken_twice (ClothMarkedBoard * board)
{
  const ClothBoardView *view = &board->view;
  guint n = 0;

  for (guint v = 0; v < (guint) (view->columns * view->rows); v++)
    if (view->seen[v] != CLOTH_VERTEX_UNKNOWN)
      board->taken[n++] = board->taken[v];
  qsort (board->taken, n, sizeof *board->taken, compare_numbers);
  for (guint i = 1; i < n; i++)
    if (board->taken[i] == board->taken[i - 1])
      return TRUE;
  return FALSE;
}

/* @board: the board, its markers set
 * @saddles: (array length=n_saddles): the picture's refined saddles
 * @n_saddles: how many
 * @view: (out) (transfer none): the board's inner corners; belongs to the board and is valid until
 *   its next call
 *
 * Takes for each corner the saddle that is nearest to where the markers beside it put it.
 *
 * Returns: whether the board was found. It was not where markers contradict each other: they are of
 *   another board, or one was misread, and which can't be told
 */
gboolean
cloth_marked_board_find (ClothMarkedBoard * board,
    const ClothSaddle * saddles, guint n_saddles, const ClothBoardView ** view)
{
  ClothBoardView *out = &board->view;
  const guint columns = (guint) out->columns, rows = (guint) out->rows;

  *view = out;
  cloth_board_view_forget (out);
  if (board->is_contradicted)
    return FALSE;
  for (guint v = 0; v < columns * rows; v++) {
    guint n = board->n_told[v], column = v % columns, row = v / columns;
    gdouble nearest = board->reach[v];

    if (n == 0 || column == 0 || row == 0 || column + 1 == columns
        || row + 1 == rows)
      continue;
    for (guint i = 0; i < n_saddles; i++) {
      gdouble away = hypot (saddles[i].x - board->place[2 * v] / n,
          saddles[i].y - board->place[2 * v + 1] / n);

      if (!(away < nearest))
        continue;
      nearest = away;
      board->taken[v] = i;
      out->seen[v] = CLOTH_VERTEX_SADDLE;
      out->x[v] = saddles[i].x;
      out->y[v] = saddles[i].y;
      memcpy (out->cov + 3 * v, saddles[i].cov, sizeof saddles[i].cov);
    }
    out->n_seen += out->seen[v] != CLOTH_VERTEX_UNKNOWN;
  }
  if (is_taken_twice (board)) {
    board->is_contradicted = TRUE;
    cloth_board_view_forget (out);
  }
  return out->n_seen > 0;
}

/* @board: the board, in whose last picture it was looked for
 *
 * Returns: whether it was not found there because markers contradict each other
 */
gboolean
cloth_marked_board_is_contradicted (const ClothMarkedBoard * board)
{
  return board->is_contradicted;
}
