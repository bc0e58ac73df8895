/* Finding a checkerboard, flat or bent, whole or in part, in a single picture.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/checker/board.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"
#include "gst/vision/checker/link.h"
#include "gst/vision/checker/pose.h"

/* Patches looked at, largest first. */
#define MAX_PATCHES 16
/* Fewer squares are as likely clutter. */
#define MIN_SQUARES 4
/* Share of them that are black. */
#define MIN_BLACK 0.3f
/* Distance of a corner from where a straight line of others puts it, over theirs. */
#define MAX_STRAY 0.25f
/* Lead, in log-likelihood, of the pose believed over the next best. */
#define MIN_LEAD 6.0f
/* What a flat board's homography adds for a patch it predicts. */
#define HOMOGRAPHY_WEIGHT 12.0f

struct _ClothBoardFinder
{
  ClothPattern pattern;
  ClothLinker *linker;
  ClothPatch patch;
  ClothPoseFinder *pose_finder;
  ClothBoardView view;
};

/* @view: (out): without a corner that is seen; cloth_board_view_clear () frees what it holds
 * @pattern: the board
 */
void
cloth_board_view_init (ClothBoardView * view, const ClothPattern * pattern)
{
  gsize n;

  view->columns = pattern->columns + 1;
  view->rows = pattern->rows + 1;
  n = (gsize) view->columns * (gsize) view->rows;
  view->n_seen = 0;
  view->seen = g_new0 (guint8, n);
  view->x = g_new0 (gfloat, n);
  view->y = g_new0 (gfloat, n);
  view->cov = g_new0 (gfloat, 3 * n);
}

/* @view: a view; no corner of it is seen any more
 */
void
cloth_board_view_forget (ClothBoardView * view)
{
  memset (view->seen, CLOTH_VERTEX_UNKNOWN,
      (gsize) view->columns * (gsize) view->rows);
  view->n_seen = 0;
}

/* @view: a view
 */
void
cloth_board_view_clear (ClothBoardView * view)
{
  g_free (view->seen);
  g_free (view->x);
  g_free (view->y);
  g_free (view->cov);
}

/* @pattern: the board; copied
 *
 * Returns: (transfer full): a finder for that board; it keeps its memory from picture to
 *   picture.
 */
ClothBoardFinder *
cloth_board_finder_new (const ClothPattern * pattern)
{
  ClothBoardFinder *finder = g_new0 (ClothBoardFinder, 1);

  finder->pattern = *pattern;
  if (pattern->code)
    finder->pattern.code = g_memdup2 (pattern->code,
        (gsize) pattern->columns * (gsize) pattern->rows);
  finder->linker = cloth_linker_new ();
  finder->pose_finder = cloth_pose_finder_new (pattern);
  cloth_board_view_init (&finder->view, pattern);
  return finder;
}

/* @finder: (transfer full): the finder
 */
void
cloth_board_finder_free (ClothBoardFinder * finder)
{
  g_free (finder->pattern.code);
  cloth_linker_free (finder->linker);
  cloth_patch_clear (&finder->patch);
  cloth_pose_finder_free (finder->pose_finder);
  cloth_board_view_clear (&finder->view);
  g_free (finder);
}

/* Whether four squares meet at a vertex of the board. */
static gboolean
is_inner (const ClothBoardView * view, gint column, gint row)
{
  return column > 0 && row > 0 && column < view->columns - 1
      && row < view->rows - 1;
}

/* Whether a corner lies where no row or column of the patch that leads to it would put
 * it. */
static gboolean
is_astray (const ClothPatch * patch, gint i, gint j)
{
  gboolean astray = FALSE;

  for (gint side = 0; side < 4; side++) {
    static const gint step_i[4] = { 1, 0, -1, 0 }, step_j[4] = { 0, 1, 0, -1 };
    gint i2 = i + 2 * step_i[side], j2 = j + 2 * step_j[side];
    gint at = j * patch->columns + i, a, b;
    gfloat length, away;

    if (i2 < 0 || j2 < 0 || i2 >= patch->columns || j2 >= patch->rows)
      continue;
    a = at + step_j[side] * patch->columns + step_i[side];
    b = j2 * patch->columns + i2;
    if (!patch->kind[a] || !patch->kind[b])
      continue;
    length = hypotf (patch->x[a] - patch->x[b], patch->y[a] - patch->y[b]);
    away = hypotf (2 * patch->x[a] - patch->x[b] - patch->x[at],
        2 * patch->y[a] - patch->y[b] - patch->y[at]);
    if (away < MAX_STRAY * length)
      return FALSE;
    astray = TRUE;
  }
  return astray;
}

/* Whether a corner is surely one where four squares meet: a fit may take the edge of what
 * covers the board for the other two, unless both squares of a colour were seen. */
static gboolean
is_saddle (const ClothPatch * patch, gint i, gint j)
{
  const gint n = patch->columns, at = j * n + i;

  if (is_astray (patch, i, j))
    return FALSE;
  if (patch->linked[at])
    return TRUE;
  if (patch->kind[at] != CLOTH_VERTEX_SADDLE || i == 0 || j == 0)
    return FALSE;
  return (patch->square[at] && patch->square[at - n - 1])
      || (patch->square[at - 1] && patch->square[at - n]);
}

/* Writes the placed patch's vertices into the view; vertices already there stay. */
static void
take_over (ClothBoardView * view, const ClothPatch * patch,
    const ClothPose * pose)
{
  for (gint j = 0; j < patch->rows; j++)
    for (gint i = 0; i < patch->columns; i++) {
      gint from = j * patch->columns + i, at, column, row;

      if (!patch->kind[from])
        continue;
      cloth_pose_vertex (pose, i, j, &column, &row);
      if (column < 0 || row < 0 || column >= view->columns || row >= view->rows)
        continue;
      at = row * view->columns + column;
      if (view->seen[at] || (is_inner (view, column, row)
              && !is_saddle (patch, i, j)))
        continue;
      view->seen[at] = patch->kind[from];
      view->x[at] = patch->x[from];
      view->y[at] = patch->y[from];
      for (gint m = 0; m < 3; m++)
        view->cov[3 * at + m] = patch->cov[3 * from + m];
      view->n_seen++;
    }
}

/* Homography picture → board (column, row) from the vertices in the view, by the linear
 * equations with h33 = 1 in coordinates centred on the view. FALSE when singular. */
static gboolean
fit_homography (const ClothBoardView * view, gdouble h[8], gdouble centre[3])
{
  gdouble a[64] = { 0 }, b[8] = { 0 };
  gdouble sum_x = 0, sum_y = 0, spread = 0;

  for (gint k = 0; k < view->columns * view->rows; k++)
    if (view->seen[k]) {
      sum_x += view->x[k];
      sum_y += view->y[k];
    }
  centre[0] = sum_x / view->n_seen;
  centre[1] = sum_y / view->n_seen;
  for (gint k = 0; k < view->columns * view->rows; k++)
    if (view->seen[k])
      spread += hypot (view->x[k] - centre[0], view->y[k] - centre[1]);
  centre[2] = view->n_seen / spread;
  for (gint k = 0; k < view->columns * view->rows; k++) {
    gdouble x = (view->x[k] - centre[0]) * centre[2];
    gdouble y = (view->y[k] - centre[1]) * centre[2];
    gdouble u = k % view->columns, v = k / view->columns;
    gdouble row[2][8] = {
      {x, y, 1, 0, 0, 0, -u * x, -u * y},
      {0, 0, 0, x, y, 1, -v * x, -v * y}
    };
    gdouble right[2] = { u, v };

    if (!view->seen[k])
      continue;
    for (gint e = 0; e < 2; e++)
      for (gint p = 0; p < 8; p++) {
        b[p] += row[e][p] * right[e];
        for (gint q = 0; q < 8; q++)
          a[8 * p + q] += row[e][p] * row[e][q];
      }
  }
  if (!cloth_cholesky_factor (8, a))
    return FALSE;
  cloth_cholesky_solve (8, a, b);
  for (gint p = 0; p < 8; p++)
    h[p] = b[p];
  return TRUE;
}

/* The pose of @patch that continues the plane of what is in the view, as a vote. */
static gboolean
vote_by_plane (const ClothBoardView * view, const ClothPatch * patch,
    ClothPose * vote)
{
  gdouble h[8], centre[3];
  gfloat best = -1;

  if (view->n_seen < 6 || !fit_homography (view, h, centre))
    return FALSE;
  for (gint rotation = 0; rotation < 4; rotation++) {
    ClothPose try = { rotation, 0, 0, HOMOGRAPHY_WEIGHT };
    gdouble off_u = 0, off_v = 0, spread = 0;
    guint n = 0;

    for (gint pass = 0; pass < 2; pass++) {
      for (gint j = 0; j < patch->rows; j++)
        for (gint i = 0; i < patch->columns; i++) {
          gint k = j * patch->columns + i, column, row;
          gdouble x, y, w, u, v;

          if (patch->kind[k] != CLOTH_VERTEX_SADDLE)
            continue;
          x = (patch->x[k] - centre[0]) * centre[2];
          y = (patch->y[k] - centre[1]) * centre[2];
          w = h[6] * x + h[7] * y + 1;
          if (w <= 0)
            return FALSE;
          u = (h[0] * x + h[1] * y + h[2]) / w;
          v = (h[3] * x + h[4] * y + h[5]) / w;
          cloth_pose_vertex (&try, i, j, &column, &row);
          if (pass == 0) {
            off_u += u - column;
            off_v += v - row;
            n++;
          } else {
            spread += fabs (u - column) + fabs (v - row);
          }
        }
      if (pass == 0) {
        try.column = (gint) lround (off_u / n);
        try.row = (gint) lround (off_v / n);
      }
    }
    spread /= n;
    if (spread < 0.5 && (best < 0 || spread < best)) {
      best = (gfloat) spread;
      *vote = try;
    }
  }
  return best >= 0;
}

/* Half of a board's squares are black, and black squares are looked at closely. */
static gboolean
is_board (const ClothPatch * patch)
{
  guint n = 0;

  for (gint j = 0; j < patch->rows; j++)
    for (gint i = 0; i < patch->columns; i++)
      n += patch->square[j * patch->columns + i]
          && cloth_patch_is_black (patch, i, j);
  return patch->n_squares >= MIN_SQUARES
      && (gfloat) n >= MIN_BLACK * (gfloat) patch->n_squares;
}

typedef enum
{
  OTHER,                        /* no piece of the board */
  UNPLACED,
  PLACED
} Fate;

static Fate
try_patch (ClothBoardFinder * finder, const ClothImage * image,
    const ClothSaddle * saddles, const ClothLinkPatch * link)
{
  ClothPatchParams params =
      { 0.25f, 0.62f, -1.0f, 0.4f, TRUE, finder->pattern.code != NULL };
  ClothPose vote, pose;
  guint n_votes;

  cloth_patch_build (&finder->patch, image, saddles, link, &params);
  if (!is_board (&finder->patch))
    return OTHER;
  n_votes = vote_by_plane (&finder->view, &finder->patch, &vote) ? 1 : 0;
  if (!cloth_pose_finder_run (finder->pose_finder, &finder->patch,
          &cloth_pose_rigid, &vote, n_votes, &pose))
    return UNPLACED;
  if (pose.weight < MIN_LEAD || (finder->view.n_seen && !n_votes))
    return UNPLACED;
  take_over (&finder->view, &finder->patch, &pose);
  return PLACED;
}

/* @finder: the finder
 * @image: the picture
 * @saddles: (array length=n_saddles): its refined saddles
 * @n_saddles: how many
 * @view: (out) (transfer none): the board's vertices; belongs to the finder and is valid
 *   until its next call
 *
 * Finds the board, or what is visible of it. A part is only reported when its place on
 * the board can be told: by the board's rim, by its code, or, for a flat board, by its
 * lying in one plane with a part that can. Nothing is reported when a larger piece of
 * checkerboard stays without place.
 *
 * Returns: whether the board was found
 */
gboolean
cloth_board_finder_find (ClothBoardFinder * finder, const ClothImage * image,
    const ClothSaddle * saddles, guint n_saddles, const ClothBoardView ** view)
{
  ClothBoardView *out = &finder->view;
  const ClothLinkPatch *links;
  guint order[MAX_PATCHES], n_links, n, anchor;
  Fate fate[MAX_PATCHES];

  cloth_board_view_forget (out);
  *view = out;
  n_links = cloth_linker_run (finder->linker, image, NULL, saddles, n_saddles,
      &links, NULL);
  n = anchor = cloth_link_largest (links, n_links, order, MAX_PATCHES);
  for (guint k = 0; k < n; k++) {
    fate[k] = try_patch (finder, image, saddles, &links[order[k]]);
    if (fate[k] == PLACED)
      anchor = MIN (anchor, k);
  }
  /* A larger piece goes where the plane of a smaller one puts it. If it does not lie in
   * that plane, one of them is another board, and which one can't be told. */
  for (guint k = 0; k < anchor && anchor < n; k++)
    if (fate[k] == UNPLACED
        && try_patch (finder, image, saddles, &links[order[k]]) != PLACED)
      out->n_seen = 0;
  if (!out->n_seen)
    cloth_board_view_forget (out);
  return out->n_seen > 0;
}
