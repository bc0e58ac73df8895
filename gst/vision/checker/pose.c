/* Where on the board a patch lies.
 *
 * Every way to lay the patch on the board is scored by what speaks for and against it:
 * squares that would stick out over the rim, cells just beyond the patch that show cloth
 * where the board should go on, the dots of a coded board, the caller's memory, and, as a
 * plain checkerboard may look the same upside down, that it is more often upright.
 *
 * All but the dots counts alike wherever on the board it lies, so two summed-area tables
 * of the patch give it for any pose at once. Dots are read in a scattered order, and
 * a pose is given up as soon as even the rest of them could not save it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/checker/pose.h"

#include <math.h>
#include <string.h>

#include "gst/math/statistics.h"

/* Log-likelihoods are summed as whole numbers: exact, and the same in any order. */
#define STEPS 64
/* A rim is straight when its corners are this near to a line, in squares. */
#define EVEN 0.2f
/* Squares by which a patch may stick out: clutter may have joined it. */
#define SLACK 1
/* Dots read between two looks at the bound, and of a pose at first. */
#define CHUNK 16
#define PROBE 256
/* Share by which these agree from which all are read at once. */
#define PROMISING 0.5f
/* Share of the board's squares from which on a patch is the whole board. */
#define WHOLE 0.75f
/* Of the poses that these dots leave, all of them are read for so many at most. */
#define MOST_READ 64
/* Vertices of a patch each way: sums stay within 32 bits. */
#define MOST_VERTICES 1024

/* Cloth folds, and a fold cuts squares anywhere, so that a corner which is no saddle says
 * nothing; but an inner corner beyond the rim can't be. */
const ClothPoseWeights cloth_pose_cloth = {
  .square_outside = -6,
  .corner_outside = -6,
  .found_corners = TRUE,
  .upright = 3,
  .least = -G_MAXFLOAT,
  .rim_refuses = 1,
};

/* A rigid board ends where its rim is seen. The edge of what covers it looks like a rim
 * now and then, and a corner of it like a saddle. A single picture gives no lead to what
 * is upright. */
const ClothPoseWeights cloth_pose_rigid = {
  .square_outside = -6,
  .corner_outside = -2.5f,
  .cut_rim = -3,
  .cut_corner = -0.5f,
  .upright = 3,
  .twins = TRUE,
  .least = -26,
  .rim_refuses = 0.55f,
};

typedef struct
{
  gint16 i, j;
  gint32 weight;                /* for a dot, less for none */
  gint32 rest;                  /* of the sizes of the weights from here on */
} Dot;

typedef struct
{
  ClothPose pose;               /* weight: of the votes, then of all evidence as well */
  gint32 score;                 /* of the tables and the dots read */
  guint n_read;
  gint32 hope;                  /* of the dots read, what they promise of all */
} Hypothesis;

struct _ClothPoseFinder
{
  ClothPattern pattern;
  gboolean coded;
  gint8 *code;                  /* 1, -1, and 0 for SLACK squares around the board */
  gint stride;

  gint columns, rows;           /* of the tables */
  gint32 *cells, *corners;      /* of what they add when they lie on the board */
  gsize capacity;
  gint32 off;                   /* what they add when none does */
  gint box[4];                  /* of the squares */
  GArray *found, *dots;         /* Dot, as they lie and scattered */
  GArray *hypotheses, *put_off; /* Hypothesis, all of whose dots are read, and the others */
};

static const gint turn_i[4] = { 1, 0, -1, 0 };
static const gint turn_j[4] = { 0, 1, 0, -1 };

/* @pose: a pose
 * @i: column of a vertex of the patch
 * @j: row of it
 * @column: (out): column of the same vertex on the board
 * @row: (out): row of it
 */
void
cloth_pose_vertex (const ClothPose * pose, gint i, gint j,
    gint * column, gint * row)
{
  const gint c = turn_i[pose->rotation], s = turn_j[pose->rotation];

  *column = pose->column + c * i - s * j;
  *row = pose->row + s * i + c * j;
}

/* @pose: a pose
 * @i: column of a cell of the patch, right of vertex @i
 * @j: row of it
 * @column: (out): column of the same cell on the board
 * @row: (out): row of it
 */
void
cloth_pose_cell (const ClothPose * pose, gint i, gint j,
    gint * column, gint * row)
{
  cloth_pose_vertex (pose, i, j, column, row);
  /* The cell's first corner is another one after a turn. */
  if (pose->rotation == 1 || pose->rotation == 2)
    (*column)--;
  if (pose->rotation >= 2)
    (*row)--;
}

/* How far vertex (@i, @j) lies beyond the one before it, seen from inside the patch, over
 * the distance of that from the one before; 0 when not all three were seen. */
static gfloat
stride_out (const ClothPatch * patch, gint i, gint j, gint di, gint dj)
{
  gint n = patch->columns, at = j * n + i, step = dj * n + di;
  gfloat length;

  if (i < 0 || j < 0 || i >= n || j >= patch->rows || i - 2 * di < 0
      || j - 2 * dj < 0 || i - 2 * di >= n || j - 2 * dj >= patch->rows
      || !patch->kind[at] || !patch->kind[at - step]
      || !patch->kind[at - 2 * step])
    return 0;
  length = hypotf (patch->x[at - step] - patch->x[at - 2 * step],
      patch->y[at - step] - patch->y[at - 2 * step]);
  return hypotf (patch->x[at] - patch->x[at - step],
      patch->y[at] - patch->y[at - step]) / MAX (length, 1e-3f);
}

/* Whether a corner that is no saddle continues the grid as the one beside it does: a rim
 * is as straight as the grid, the edge of what covers the board is not. */
static gboolean
is_rim (const ClothPatch * patch, gint i, gint j)
{
  for (gint side = 0; side < 4; side++) {
    gint di = turn_i[side], dj = turn_j[side];
    gfloat own = stride_out (patch, i, j, di, dj);

    if (own == 0 || (i + di >= 0 && i + di < patch->columns && j + dj >= 0
            && j + dj < patch->rows
            && patch->kind[(j + dj) * patch->columns + i + di]))
      continue;
    for (gint way = -1; way <= 1; way += 2) {
      gfloat beside = stride_out (patch, i - way * dj, j + way * di, di, dj);

      if (beside > 0 && fabsf (beside - own) < EVEN * MAX (own, beside))
        return TRUE;
    }
  }
  return FALSE;
}

/* What a vertex adds to a pose under which four squares meet there, and to one under
 * which they don't: not even on the board's rim. */
static void
weigh_corner (const ClothPatch * patch, const ClothPoseWeights * weights,
    gint i, gint j, gfloat * on, gfloat * off)
{
  const gint at = j * patch->columns + i;

  *on = *off = 0;
  if (patch->linked[at] || (weights->found_corners
          && patch->kind[at] == CLOTH_VERTEX_SADDLE))
    *off = weights->corner_outside;
  else if (patch->kind[at] >= CLOTH_VERTEX_UNSURE
      && (weights->cut_rim != 0 || weights->cut_corner != 0))
    *on = is_rim (patch, i, j) ? weights->cut_rim : weights->cut_corner;
}

static inline gint32
steps (gfloat weight)
{
  return (gint32) lrintf (STEPS * weight);
}

static void
make_room (ClothPoseFinder * finder, const ClothPatch * patch)
{
  const gsize n = (gsize) (patch->columns + 1) * (gsize) (patch->rows + 1);

  finder->columns = patch->columns + 1;
  finder->rows = patch->rows + 1;
  if (n <= finder->capacity)
    return;
  finder->cells = g_renew (gint32, finder->cells, n);
  finder->corners = g_renew (gint32, finder->corners, n);
  finder->capacity = n;
}

/* The squares' extent; FALSE for a patch that has none, or is larger than any board. */
static gboolean
measure (ClothPoseFinder * finder, const ClothPatch * patch)
{
  gint *box = finder->box;

  box[0] = box[1] = G_MAXINT;
  box[2] = box[3] = G_MININT;
  for (gint j = 0; j + 1 < patch->rows; j++)
    for (gint i = 0; i + 1 < patch->columns; i++)
      if (patch->square[j * patch->columns + i]) {
        box[0] = MIN (box[0], i);
        box[1] = MIN (box[1], j);
        box[2] = MAX (box[2], i);
        box[3] = MAX (box[3], j);
      }
  return box[0] <= box[2] && patch->columns <= MOST_VERTICES
      && patch->rows <= MOST_VERTICES;
}

/* Sums what the cells and corners say, and collects the dots. */
static void
gather (ClothPoseFinder * finder, const ClothPatch * patch,
    const ClothPoseWeights * weights)
{
  const gint n = patch->columns + 1;

  make_room (finder, patch);
  finder->off = 0;
  g_array_set_size (finder->found, 0);
  memset (finder->cells, 0, sizeof (gint32) * (gsize) n);
  memset (finder->corners, 0, sizeof (gint32) * (gsize) n);
  for (gint j = 0; j < patch->rows; j++) {
    gint32 *cell = finder->cells + (j + 1) * n;
    gint32 *corner = finder->corners + (j + 1) * n;
    gint32 cells = 0, corners = 0;

    cell[0] = corner[0] = 0;
    for (gint i = 0; i < patch->columns; i++) {
      const gint at = j * patch->columns + i;
      const gboolean has_cell = i + 1 < patch->columns && j + 1 < patch->rows;
      gfloat on = 0, off = 0;

      if (has_cell) {
        weigh_corner (patch, weights, i, j, &on, &off);
        corners += steps (on) - steps (off);
        finder->off += steps (off);
        on = patch->square[at] ? 0 : patch->inside[at];
        off = patch->square[at] ? weights->square_outside : 0;
        cells += steps (on) - steps (off);
        finder->off += steps (off);
      }
      cell[i + 1] = cell[i + 1 - n] + cells;
      corner[i + 1] = corner[i + 1 - n] + corners;
      if (has_cell && finder->coded && patch->square[at]
          && steps (patch->bit[at])) {
        Dot dot = { (gint16) i, (gint16) j, steps (patch->bit[at]), 0 };

        g_array_append_val (finder->found, dot);
      }
    }
  }
}

/* Dots side by side may belong to another piece of cloth: takes them from all over. */
static void
scatter (ClothPoseFinder * finder)
{
  const guint n = finder->found->len;
  const guint step = cloth_coprime_step (MAX (1, (guint) (0.618 * n)), n);
  guint at = 0;
  gint32 rest = 0;

  g_array_set_size (finder->dots, n);
  for (guint k = 0; k < n; k++, at = (at + step) % n)
    g_array_index (finder->dots, Dot, k) =
        g_array_index (finder->found, Dot, at);
  for (guint k = n; k-- > 0;) {
    Dot *dot = &g_array_index (finder->dots, Dot, k);

    rest += ABS (dot->weight);
    dot->rest = rest;
  }
}

/* Sum over the part of a table that two opposite cells, or vertices, of the board span. */
static gint32
table_sum (const ClothPoseFinder * finder, const gint32 * table,
    const gint a[2], const gint b[2])
{
  const gint n = finder->columns;
  const gint x0 = CLAMP (MIN (a[0], b[0]), 0, n - 1);
  const gint y0 = CLAMP (MIN (a[1], b[1]), 0, finder->rows - 1);
  const gint x1 = CLAMP (MAX (a[0], b[0]) + 1, x0, n - 1);
  const gint y1 = CLAMP (MAX (a[1], b[1]) + 1, y0, finder->rows - 1);

  return table[y1 * n + x1] - table[y0 * n + x1] - table[y1 * n + x0]
      + table[y0 * n + x0];
}

/* All evidence but the dots. */
static gint32
score_extent (const ClothPoseFinder * finder, const ClothPose * pose)
{
  const gint c = turn_i[pose->rotation], s = turn_j[pose->rotation];
  const gint columns = finder->pattern.columns, rows = finder->pattern.rows;
  gint32 score = finder->off;
  gint end[2][2];

  /* Where the patch has the board's first and last cell, and first and last vertex. */
  for (gint inner = 0; inner < 2; inner++) {
    const gint moved_column = !inner && (pose->rotation == 1
        || pose->rotation == 2);
    const gint moved_row = !inner && pose->rotation >= 2;

    if (inner && (columns < 2 || rows < 2))
      continue;
    for (gint k = 0; k < 2; k++) {
      gint u = (k ? columns - 1 : inner) + moved_column - pose->column;
      gint v = (k ? rows - 1 : inner) + moved_row - pose->row;

      end[k][0] = c * u + s * v;
      end[k][1] = -s * u + c * v;
    }
    score += table_sum (finder, inner ? finder->corners : finder->cells,
        end[0], end[1]);
  }
  return score;
}

/* Reads dots up to @to and adds what they say; FALSE when the rest can't bring the score
 * to @least any more. */
static gboolean
read_dots (const ClothPoseFinder * finder, Hypothesis * hypothesis, guint to,
    gint64 least)
{
  const Dot *dots = (const Dot *) finder->dots->data;
  const gint c = turn_i[hypothesis->pose.rotation];
  const gint s = turn_j[hypothesis->pose.rotation];
  const gint along_i = c + s * finder->stride;
  const gint along_j = c * finder->stride - s;
  const gint8 *code = finder->code;
  gint column, row;

  cloth_pose_cell (&hypothesis->pose, 0, 0, &column, &row);
  column += SLACK + row * finder->stride + SLACK * finder->stride;
  while (hypothesis->n_read < to) {
    const guint end = MIN (hypothesis->n_read + CHUNK, to);

    if (hypothesis->score + (gint64) dots[hypothesis->n_read].rest < least)
      return FALSE;
    for (; hypothesis->n_read < end; hypothesis->n_read++) {
      const Dot *dot = &dots[hypothesis->n_read];

      hypothesis->score += dot->weight
          * code[column + dot->i * along_i + dot->j * along_j];
    }
  }
  return hypothesis->score + (gint64) (to <
      finder->dots->len ? dots[to].rest : 0)
      >= least;
}

/* The way the board's columns run in the picture under a rotation, as the cosine of the
 * angle to +x. */
static gfloat
uprightness (const ClothPatch * patch, gint rotation)
{
  gfloat dx = 0, dy = 0;
  gint n = patch->columns;

  for (gint j = 0; j < patch->rows; j++)
    for (gint i = 0; i + 1 < n; i++) {
      gint at = j * n + i;
      gint along = (rotation & 1) ? n : 1;

      if ((rotation & 1) && j + 1 >= patch->rows)
        continue;
      if (!patch->kind[at] || !patch->kind[at + along])
        continue;
      dx += patch->x[at + along] - patch->x[at];
      dy += patch->y[at + along] - patch->y[at];
    }
  if (dx == 0 && dy == 0)
    return 0;
  /* Rotation 1 sends the patch's -j onto the board's columns, 2 its -i, 3 its +j. */
  return (rotation == 1 || rotation == 2 ? -dx : dx) / hypotf (dx, dy);
}

/* Whether two poses differ by a turn that leaves a plain board as it looks. */
static gboolean
are_twins (const ClothPattern * pattern, const ClothPose * a,
    const ClothPose * b)
{
  gboolean square = pattern->columns == pattern->rows;
  ClothPose turned = *a;

  for (gint quarter = 1; quarter < 4; quarter++) {
    /* The board turned about its middle: (c, r) becomes (rows - r, c). */
    turned = (ClothPose) {
    (turned.rotation + 1) & 3, (quarter & 1 ? pattern->rows
          : pattern->columns) - turned.row, turned.column};
    if ((quarter & 1) && !(square && (pattern->columns & 1)))
      continue;
    if (quarter == 2 && ((pattern->columns + pattern->rows) & 1))
      continue;
    if (turned.rotation == b->rotation && turned.column == b->column
        && turned.row == b->row)
      return TRUE;
  }
  return FALSE;
}

/* What corners that linking did not join, and that lie on the board's rim, add: what is
 * beside the board, like a plate that it is glued on, may give them the look of inner ones. */
static gfloat
found_on_rim (const ClothPoseFinder * finder, const ClothPatch * patch,
    const ClothPoseWeights * weights, const ClothPose * pose)
{
  const gint columns = finder->pattern.columns, rows = finder->pattern.rows;
  gfloat sum = 0;

  for (gint j = 0; j + 1 < patch->rows && weights->found_corners; j++)
    for (gint i = 0; i + 1 < patch->columns; i++) {
      const gint at = j * patch->columns + i;
      gint column, row;

      if (patch->linked[at] || patch->kind[at] != CLOTH_VERTEX_SADDLE)
        continue;
      cloth_pose_vertex (pose, i, j, &column, &row);
      if (column >= 0 && row >= 0 && column <= columns && row <= rows
          && (column % columns == 0 || row % rows == 0))
        sum += weights->corner_outside;
    }
  return sum;
}

/* Whether a straight rim runs along more than @share of a line of the board that lies
 * within: the board seen is smaller. A corner there that looks like a saddle counts half:
 * what is beside the board may give it the look. */
static gboolean
ends_early (const ClothPoseFinder * finder, const ClothPatch * patch,
    const ClothPose * pose, gfloat share)
{
  const gint columns = finder->pattern.columns, rows = finder->pattern.rows;

  for (gint along = 0; along < 2; along++)
    for (gint line = 0; line < (along ? patch->rows : patch->columns); line++) {
      const gint n = along ? patch->columns : patch->rows;
      const gint length = ((pose->rotation & 1) == along ? rows : columns) - 1;
      gint on_rim = 0;

      for (gint k = 0; k < n; k++) {
        const gint i = along ? k : line, j = along ? line : k;
        const gint at = j * patch->columns + i;
        gint column, row;

        cloth_pose_vertex (pose, i, j, &column, &row);
        if (column > 0 && row > 0 && column < columns && row < rows
            && !patch->linked[at] && is_rim (patch, i, j))
          on_rim += patch->kind[at] == CLOTH_VERTEX_SADDLE ? 1 : 2;
      }
      if ((gfloat) on_rim > 2 * share * (gfloat) length)
        return TRUE;
    }
  return FALSE;
}

/* Poses under one rotation that colour and the patch's extent allow, but for some
 * overhang. */
typedef struct
{
  gint rotation;
  gint column[2], row[2];       /* first and last */
  gint odd;                     /* column + row */
} Range;

static Range
range_of (const ClothPoseFinder * finder, const ClothPatch * patch,
    gint rotation)
{
  const ClothPattern *pattern = &finder->pattern;
  const ClothPose turned = { rotation };
  const gint *box = finder->box;
  gint c0, r0, c1, r1;

  cloth_pose_cell (&turned, box[0], box[1], &c0, &r0);
  cloth_pose_cell (&turned, box[2], box[3], &c1, &r1);
  /* The board cell that the box's first cell falls on must have its colour. */
  return (Range) {
    rotation, {
    -SLACK - MIN (c0, c1), pattern->columns - 1 + SLACK - MAX (c0, c1)}
    , {
    -SLACK - MIN (r0, r1), pattern->rows - 1 + SLACK - MAX (r0, r1)}
    , cloth_pattern_is_black (pattern, c0 & 1, r0 & 1)
        != cloth_patch_is_black (patch, box[0], box[1])
  };
}

static gboolean
is_in (const Range * range, const ClothPose * pose)
{
  return pose->column >= range->column[0]
      && pose->column <= range->column[1]
      && pose->row >= range->row[0] && pose->row <= range->row[1]
      && ((pose->column + pose->row) & 1) == range->odd;
}

static inline gboolean
is_same (const ClothPose * a, const ClothPose * b)
{
  return a->rotation == b->rotation && a->column == b->column
      && a->row == b->row;
}

/* Adds a hypothesis all of whose dots were read. */
static void
take (ClothPoseFinder * finder, Hypothesis * hypothesis, gfloat * most)
{
  hypothesis->pose.weight += (gfloat) hypothesis->score / STEPS;
  *most = MAX (*most, hypothesis->pose.weight);
  g_array_append_val (finder->hypotheses, *hypothesis);
}

static gint
compare_hope (gconstpointer a, gconstpointer b)
{
  gint32 of_a = ((const Hypothesis *) a)->hope, of_b =
      ((const Hypothesis *) b)->hope;

  return (of_a < of_b) - (of_a > of_b);
}

/* Scores the poses that may come within @margin of the best; how many there are in
 * all. */
static guint
score_all (ClothPoseFinder * finder, const ClothPatch * patch,
    const ClothPose * votes, guint n_votes, gfloat margin)
{
  const guint n_dots = finder->dots->len;
  const gint32 all = n_dots ? g_array_index (finder->dots, Dot, 0).rest : 0;
  gfloat most = -1e9f;          /* times STEPS fits 64 bits */
  guint n_voted, n_put_off, n = 0;
  Range ranges[4];

  g_array_set_size (finder->hypotheses, 0);
  g_array_set_size (finder->put_off, 0);
  for (gint rotation = 0; rotation < 4; rotation++)
    ranges[rotation] = range_of (finder, patch, rotation);
  /* What is voted for first: if it is right, most others are ruled out at once. */
  for (guint k = 0; k < n_votes; k++) {
    Hypothesis hypothesis = { votes[k] };
    guint same = 0;

    if (!is_in (&ranges[votes[k].rotation & 3], &votes[k]))
      continue;
    while (same < finder->hypotheses->len && !is_same (&votes[k],
            &g_array_index (finder->hypotheses, Hypothesis, same).pose))
      same++;
    if (same < finder->hypotheses->len) {
      Hypothesis *other = &g_array_index (finder->hypotheses, Hypothesis, same);

      other->pose.weight += votes[k].weight;
      most = MAX (most, other->pose.weight);
      continue;
    }
    hypothesis.score = score_extent (finder, &hypothesis.pose);
    read_dots (finder, &hypothesis, n_dots, G_MININT64);
    take (finder, &hypothesis, &most);
  }
  n_voted = finder->hypotheses->len;
  for (gint rotation = 0; rotation < 4; rotation++) {
    const Range *range = &ranges[rotation];

    for (gint row = range->row[0]; row <= range->row[1]; row++)
      for (gint column = range->column[0] + ((range->column[0] + row
                  + range->odd) & 1); column <= range->column[1]; column += 2) {
        const gint64 least = (gint64) ((most - margin) * STEPS);
        Hypothesis hypothesis = { {rotation, column, row} };
        guint voted = 0;
        gint32 extent;

        n++;
        extent = hypothesis.score = score_extent (finder, &hypothesis.pose);
        if (extent + (gint64) all < least)
          continue;
        while (voted < n_voted && !is_same (&hypothesis.pose,
                &g_array_index (finder->hypotheses, Hypothesis, voted).pose))
          voted++;
        if (voted < n_voted
            || !read_dots (finder, &hypothesis, MIN (n_dots, PROBE), least))
          continue;
        if (hypothesis.n_read < n_dots) {
          const gint32 rest =
              g_array_index (finder->dots, Dot, hypothesis.n_read).rest;
          const gfloat agree = (gfloat) (hypothesis.score - extent)
              / (gfloat) (all - rest);

          hypothesis.hope = hypothesis.score + (gint32) (agree * (gfloat) rest);
          if (agree < PROMISING) {
            g_array_append_val (finder->put_off, hypothesis);
            continue;
          }
          if (!read_dots (finder, &hypothesis, n_dots, least))
            continue;
        }
        take (finder, &hypothesis, &most);
      }
  }
  g_array_sort (finder->put_off, compare_hope);
  n_put_off = MIN (finder->put_off->len, MOST_READ);
  for (guint k = 0; k < n_put_off; k++) {
    Hypothesis *hypothesis = &g_array_index (finder->put_off, Hypothesis, k);

    if (read_dots (finder, hypothesis, n_dots,
            (gint64) ((most - margin) * STEPS)))
      take (finder, hypothesis, &most);
  }
  return n;
}

/* @finder: of the board
 * @patch: a patch of it
 * @weights: what the evidence weighs
 * @votes: (array length=n_votes) (nullable): poses the caller believes in, weight =
 *   log-likelihood
 * @n_votes: how many
 * @best: (out): the best pose; weight = its lead over the next best
 *
 * The lead is over the poses whose dots were all read. Where a first reading of 256
 * dots finds less than half of them in agreement, a pose waits, and only the 64 most
 * hopeful of those that wait are read to the end: a lead over one of the others, which
 * would have to agree far better in the dots that are left, is not counted and may be
 * overstated. With no more than 256 dots in the patch all that matter are read.
 *
 * Returns: whether the patch fits the board anywhere
 */
gboolean
cloth_pose_finder_run (ClothPoseFinder * finder, const ClothPatch * patch,
    const ClothPoseWeights * weights, const ClothPose * votes,
    guint n_votes, ClothPose * best)
{
  gfloat prior[4] = { 0 }, most = -G_MAXFLOAT, score;
  const Hypothesis *list;
  guint first = 0, n;

  if (!measure (finder, patch))
    return FALSE;
  gather (finder, patch, weights);
  scatter (finder);
  n = score_all (finder, patch, votes, n_votes,
      CLOTH_POSE_MOST_LEAD + 2 * weights->upright);
  if (!finder->hypotheses->len)
    return FALSE;
  list = (const Hypothesis *) finder->hypotheses->data;
  for (gint rotation = 0; rotation < 4 && !finder->coded; rotation++)
    prior[rotation] = weights->upright * uprightness (patch, rotation);
  for (guint k = 0; k < finder->hypotheses->len; k++) {
    const ClothPose *own = &list[k].pose;

    if (own->weight + prior[own->rotation] > most) {
      most = own->weight + prior[own->rotation];
      first = k;
    }
  }
  if ((gfloat) list[first].score / STEPS < weights->least
      || (weights->rim_refuses < 1 && ends_early (finder, patch,
              &list[first].pose, weights->rim_refuses)))
    return FALSE;
  *best = list[first].pose;
  /* What fits one way only hangs over on both sides. */
  best->weight = best->evidence =
      n > 1 ? CLOTH_POSE_MOST_LEAD : -weights->square_outside;
  for (guint k = 0; k < finder->hypotheses->len; k++) {
    const ClothPose *own = &list[k].pose;
    const gboolean twin = !finder->coded
        && are_twins (&finder->pattern, best, own);
    gfloat lead = list[first].pose.weight - own->weight;

    if (k == first)
      continue;
    if (!weights->twins)
      lead = most - own->weight - prior[own->rotation];
    /* Of two that look the same either is right: the more upright one was taken. */
    if (!weights->twins || !twin)
      best->weight = MIN (best->weight, lead);
    if (!twin)
      best->evidence = MIN (best->evidence, (gfloat) (list[first].score
              - list[k].score) / STEPS);
  }
  score = (gfloat) list[first].score / STEPS;
  best->whole = (gfloat) patch->n_squares
      >= WHOLE * (gfloat) (finder->pattern.columns * finder->pattern.rows);
  if (best->whole)
    score -= found_on_rim (finder, patch, weights, best);
  best->evidence += MIN (score, 0.0f);
  return TRUE;
}

/* @pattern: the board; copied
 *
 * Returns: (transfer full): what places patches on that board; it keeps its memory from
 *   patch to patch.
 */
ClothPoseFinder *
cloth_pose_finder_new (const ClothPattern * pattern)
{
  ClothPoseFinder *finder = g_new0 (ClothPoseFinder, 1);

  finder->pattern = *pattern;
  finder->pattern.code = NULL;
  finder->coded = pattern->code != NULL;
  finder->found = g_array_new (FALSE, FALSE, sizeof (Dot));
  finder->dots = g_array_new (FALSE, FALSE, sizeof (Dot));
  finder->hypotheses = g_array_new (FALSE, FALSE, sizeof (Hypothesis));
  finder->put_off = g_array_new (FALSE, FALSE, sizeof (Hypothesis));
  if (!finder->coded)
    return finder;
  finder->stride = pattern->columns + 2 * SLACK;
  finder->code = g_new0 (gint8, (gsize) finder->stride
      * (gsize) (pattern->rows + 2 * SLACK));
  for (gint row = 0; row < pattern->rows; row++)
    for (gint column = 0; column < pattern->columns; column++)
      finder->code[(row + SLACK) * finder->stride + column + SLACK] =
          pattern->code[row * pattern->columns + column] ? 1 : -1;
  return finder;
}

/* @finder: (transfer full): the finder
 */
void
cloth_pose_finder_free (ClothPoseFinder * finder)
{
  g_free (finder->code);
  g_free (finder->cells);
  g_free (finder->corners);
  g_array_unref (finder->found);
  g_array_unref (finder->dots);
  g_array_unref (finder->hypotheses);
  g_array_unref (finder->put_off);
  g_free (finder);
}
