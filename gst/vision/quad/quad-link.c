/* Quad tracker: squares found by linking, placed on the board with the help of memory.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>

#include "gst/vision/quad/quad-private.h"

/* Patches looked at in a picture, largest first. */
#define MAX_PATCHES 48
/* Different poses that the vertices of one patch may vote for. */
#define MAX_VOTES 12
/* Log-likelihood of one vertex near its guess, and of all of them together. */
#define VOTE 2.0f
#define MAX_VOTE 14.0f
/* More than a few stray vertices. */
#define STRONG_VOTE 3.0f
/* A vertex votes for a guess this near, in squares. */
#define VOTE_REACH 0.5f
/* Corners are looked for this far from where they were in the last picture, px, and so many
 * must be where they are expected. */
#define MAX_STEP 40.0f
#define LEAST_AGREE 4
/* A vertex this near a guess is that vertex, in squares. */
#define SURE_REACH 0.3f
/* The edge of something bright looks like cloth where the board would go on now and then,
 * so a larger lead than CLOTH_POSE_MIN_LEAD is asked where the memory knows the board but
 * not there, and most of one against the memory. */
#define NEW_LEAD 4.0f
#define SURE_LEAD 8.0f
/* Where neither memory nor a seed says so much for a pose, what is seen must. */
#define KNOWN 1.0f
/* Evidence like that of four, three and one cells that show the board's end. */
#define EVIDENT 11.9f
#define FAIR 8.9f
#define HINT 2.9f
/* Evidence that is enough where the board has a code. */
#define READ 5.9f
/* The least cells that show the board's end, for a hint. */
#define LEAST_RIM 2
/* Cells around a patch of which nothing is known, for each that shows the board's end: with
 * no memory, and when the board was just seen. */
#define HIDDEN 2
#define HIDDEN_LATER 3
/* A patch with less evidence than that is joined from the board and something else. */
#define MIXED -15.0f
/* Pictures in a row that may speak against the memory before they are believed. */
#define MAX_DOUBTS 2
/* Squares over which vertices are reckoned from those known, what each square takes from
 * their weight, and patches after which it is done. */
#define RECKON_STEPS 4
#define RECKON_FADE 0.5f
#define RECKON_PATCHES 6
/* Seeds looked at for one patch. */
#define MAX_SEEDS 4
/* Log-likelihood of a seed whose place on the board was given, and of one without. */
#define SEED 40.0f
#define SEED_WITHOUT_PLACE 4.0f

/* Rotation of a patch whose +i runs along (@dx, @dy) where the board's columns run along
 * (@bx, @by). */
static gint
rotation_between (gfloat dx, gfloat dy, gfloat bx, gfloat by)
{
  gfloat angle = atan2f (dx * by - dy * bx, dx * bx + dy * by);
  gint quarters = (gint) lrintf (angle / (gfloat) G_PI_2);

  return (4 - (quarters & 3)) & 3;
}

/* Direction of the patch's +i at vertex (@i, @j). */
static gboolean
patch_direction (const ClothPatch * patch, gint i, gint j, gfloat * dx,
    gfloat * dy)
{
  gint at = j * patch->columns + i;
  gint from = i > 0 && patch->kind[at - 1] ? at - 1 : at;
  gint to = i + 1 < patch->columns && patch->kind[at + 1] ? at + 1 : at;

  *dx = patch->x[to] - patch->x[from];
  *dy = patch->y[to] - patch->y[from];
  return from != to;
}

static inline gboolean
is_guessed (const ClothQuadVertex * vertex)
{
  return vertex->guessed || vertex->reckoned > 0;
}

static gboolean
guess_direction (ClothQuadTracker * tracker, gint column, gint row,
    gfloat * dx, gfloat * dy)
{
  const ClothQuadVertex *at = cloth_quad_vertex (tracker, column, row);
  const ClothQuadVertex *from = column > 0
      && is_guessed (&at[-1]) ? at - 1 : at;
  const ClothQuadVertex *to = column < tracker->pattern.columns
      && is_guessed (&at[1]) ? at + 1 : at;

  *dx = to->guess_x - from->guess_x;
  *dy = to->guess_y - from->guess_y;
  return from != to;
}

static void
add_vote (ClothPose * votes, guint * n, const ClothPose * vote)
{
  guint k;

  for (k = 0; k < *n; k++)
    if (votes[k].rotation == vote->rotation && votes[k].column == vote->column
        && votes[k].row == vote->row)
      break;
  if (k == MAX_VOTES) {
    /* The weakest gives way, and its weight with it. */
    k = 0;
    for (guint m = 1; m < *n; m++)
      if (votes[m].weight < votes[k].weight)
        k = m;
    if (votes[k].weight >= vote->weight) {
      votes[k].weight -= vote->weight;
      return;
    }
    votes[k] = *vote;
    return;
  }
  if (k == *n) {
    votes[(*n)++] = *vote;
    return;
  }
  votes[k].weight += vote->weight;
}

/* Finds the remembered vertex nearest to each corner of the patch, once for all who ask. */
static void
recall_all (ClothQuadTracker * tracker)
{
  const ClothPatch *patch = &tracker->patch;
  const gint n = patch->rows * patch->columns;
  gfloat reach = 0;

  for (guint k = 0; k < tracker->guess_vertex->len; k++)
    reach = MAX (reach, VOTE_REACH * tracker->vertices[g_array_index
            (tracker->guess_vertex, gint, k)].size);
  g_array_set_size (tracker->recalls, (guint) n);
  for (gint at = 0; at < n; at++) {
    ClothQuadRecall *own = &g_array_index (tracker->recalls, ClothQuadRecall,
        at);
    ClothNear near;

    *own = (ClothQuadRecall) {
    -1, 0};
    if (!patch->kind[at] || reach == 0
        || !cloth_point_grid_nearest (tracker->guesses, patch->x[at],
            patch->y[at], reach, &near, 1))
      continue;
    own->vertex = g_array_index (tracker->guess_vertex, gint, near.index);
    own->distance = sqrtf (near.distance2)
        / tracker->vertices[own->vertex].size;
  }
}

/* Whether black squares of the patch come onto black ones of the board. */
static gboolean
is_same_colour (const ClothQuadTracker * tracker, const ClothPose * pose)
{
  gint column, row;

  cloth_pose_cell (pose, 0, 0, &column, &row);
  return cloth_pattern_is_black (&tracker->pattern, column & 1, row & 1)
      == cloth_patch_is_black (&tracker->patch, 0, 0);
}

/* What the remembered vertices say of the place of the patch. */
static guint
vote_by_memory (ClothQuadTracker * tracker, ClothPose votes[MAX_VOTES])
{
  const ClothPatch *patch = &tracker->patch;
  gint columns = tracker->pattern.columns + 1;
  guint n = 0, voters = 0;
  gfloat sum = 0, fresh = 0;

  for (gint j = 0; j < patch->rows; j++)
    for (gint i = 0; i < patch->columns; i++) {
      const gint at = j * patch->columns + i;
      const ClothQuadRecall *near = &g_array_index (tracker->recalls,
          ClothQuadRecall, at);
      const gint vertex = near->vertex;
      const ClothQuadVertex *guess = &tracker->vertices[MAX (vertex, 0)];
      gfloat dx, dy, bx, by;
      ClothPose vote;
      gint column, row;

      if (patch->kind[at] != CLOTH_VERTEX_SADDLE || vertex < 0
          || near->distance > VOTE_REACH
          || !patch_direction (patch, i, j, &dx, &dy)
          || !guess_direction (tracker, vertex % columns, vertex / columns,
              &bx, &by))
        continue;
      vote.rotation = rotation_between (dx, dy, bx, by);
      vote.column = vote.row = 0;
      cloth_pose_vertex (&vote, i, j, &column, &row);
      vote.column = vertex % columns - column;
      vote.row = vertex / columns - row;
      if (!is_same_colour (tracker, &vote))
        continue;
      vote.weight = guess->weight * (1 - near->distance / VOTE_REACH);
      add_vote (votes, &n, &vote);
      fresh += guess->weight;
      voters++;
    }
  for (guint k = 0; k < n; k++)
    sum += votes[k].weight;
  /* Many that agree say little more than a few: they err, and grow old, together. */
  for (guint k = 0; k < n; k++)
    votes[k].weight = votes[k].weight / MAX (sum, 1e-6f)
        * MIN (VOTE * votes[k].weight, MAX_VOTE * fresh / (gfloat) voters);
  return n;
}

/* What a square given by the user says of it. */
static guint
vote_by_seed (ClothQuadTracker * tracker, const ClothQuadSeed * seed,
    ClothPose * vote)
{
  const ClothPatch *patch = &tracker->patch;
  const ClothPattern *pattern = &tracker->pattern;
  gfloat sx = 0, sy = 0, nearest = cloth_quad_shortest (seed->x, seed->y) / 2;
  gint best = -1, column, row, wanted_column, wanted_row;
  gfloat dx, dy;

  for (gint k = 0; k < 4; k++) {
    sx += seed->x[k] / 4;
    sy += seed->y[k] / 4;
  }
  for (gint at = 0; at < patch->rows * patch->columns; at++) {
    gfloat cx, cy;

    if (!patch->square[at])
      continue;
    cx = (patch->x[at] + patch->x[at + patch->columns + 1]) / 2;
    cy = (patch->y[at] + patch->y[at + patch->columns + 1]) / 2;
    if (hypotf (cx - sx, cy - sy) < nearest) {
      nearest = hypotf (cx - sx, cy - sy);
      best = at;
    }
  }
  if (best < 0)
    return 0;
  dx = patch->x[best + 1] - patch->x[best];
  dy = patch->y[best + 1] - patch->y[best];
  *vote = (ClothPose) {
  rotation_between (dx, dy, seed->x[1] - seed->x[0],
        seed->y[1] - seed->y[0]), 0, 0, SEED};
  wanted_column = seed->column;
  wanted_row = seed->row;
  if (seed->column < 0) {
    /* As in the paper: a square in the middle of the pattern. */
    wanted_column = pattern->columns / 2;
    wanted_row = pattern->rows / 2;
    if (cloth_pattern_is_black (pattern, wanted_column, wanted_row)
        != cloth_patch_is_black (patch, best % patch->columns,
            best / patch->columns))
      wanted_column--;
    vote->weight = SEED_WITHOUT_PLACE;
  }
  cloth_pose_cell (vote, best % patch->columns, best / patch->columns,
      &column, &row);
  vote->column = wanted_column - column;
  vote->row = wanted_row - row;
  return 1;
}

/* What the memory says of vertex (@i, @j) of the patch under a pose: 1 yes, -1 no, 0
 * nothing. */
static gint
recall (ClothQuadTracker * tracker, const ClothPose * pose, gint i, gint j)
{
  const ClothQuadRecall *near = &g_array_index (tracker->recalls,
      ClothQuadRecall, j * tracker->patch.columns + i);
  gint column, row;

  if (near->vertex < 0 || near->distance > SURE_REACH)
    return 0;
  cloth_pose_vertex (pose, i, j, &column, &row);
  return column >= 0 && column <= tracker->pattern.columns
      && near->vertex == row * (tracker->pattern.columns + 1) + column ? 1 : -1;
}

/* The same of the cell (@i, @j): for less against. Even is against: a square has all of its
 * corners right. */
static gint
recall_square (ClothQuadTracker * tracker, const ClothPose * pose,
    gint i, gint j)
{
  gint sum = 0;
  gboolean against = FALSE;

  for (gint k = 0; k < 4; k++) {
    const gint says = recall (tracker, pose,
        i + cloth_quad_corner_column[k], j + cloth_quad_corner_row[k]);

    sum += says;
    against |= says < 0;
  }
  return sum == 0 && against ? -1 : sum;
}

/* Takes one square of a placed patch. */
static void
take_square (ClothQuadTracker * tracker, const ClothPose * pose, gint i, gint j)
{
  const ClothPatch *patch = &tracker->patch;
  const ClothQuadParams *params = tracker->params;
  gboolean black = cloth_patch_is_black (patch, i, j);
  gint column, row;
  gfloat x[4], y[4], cov[4][3], confidence;
  ClothQuadCell *cell;

  cloth_pose_cell (pose, i, j, &column, &row);
  cell = cloth_quad_cell (tracker, column, row);
  if (!cell || !cell->wanted || cell->found)
    return;
  for (gint k = 0; k < 4; k++) {
    gint li = i + cloth_quad_corner_column[k];
    gint lj = j + cloth_quad_corner_row[k];
    gint from = lj * patch->columns + li, c, r, to;

    cloth_pose_vertex (pose, li, lj, &c, &r);
    /* An inner corner that is no saddle is where a fold cuts the square. */
    if (patch->kind[from] == CLOTH_VERTEX_RIM
        && cloth_quad_is_inner (tracker, c, r))
      return;
    to = r == row ? c - column : 3 - (c - column);
    x[to] = patch->x[from];
    y[to] = patch->y[from];
    for (gint m = 0; m < 3; m++)
      cov[to][m] = patch->cov[3 * from + m];
  }
  confidence = black ? patch->confidence[j * patch->columns + i]
      : cloth_quad_confidence (tracker->image, x, y, params->alpha, FALSE);
  if (confidence < params->c_low)
    return;
  /* Of a doubtful one the memory, if there is any, must know. */
  if (confidence < params->c_high && tracker->guess_vertex->len > 0
      && recall_square (tracker, pose, i, j) < (cell->age == 0 ? 3 : 1))
    return;
  cloth_quad_take (tracker, cell, black, x, y, cov, confidence);
}

/* Takes the squares of the patch that the memory puts where the pose does, by at
 * least @least corners. */
static void
take_patch (ClothQuadTracker * tracker, const ClothPose * pose, gint least)
{
  const ClothPatch *patch = &tracker->patch;

  for (gint j = 0; j + 1 < patch->rows; j++)
    for (gint i = 0; i + 1 < patch->columns; i++)
      if (patch->square[j * patch->columns + i]
          && recall_square (tracker, pose, i, j) >= least)
        take_square (tracker, pose, i, j);
  for (gint j = 0; j < patch->rows; j++)
    for (gint i = 0; i < patch->columns; i++) {
      gint from = j * patch->columns + i, column, row;
      ClothQuadVertex *vertex;

      if (!patch->kind[from]
          || recall (tracker, pose, i, j) < MIN (least, 1))
        continue;
      cloth_pose_vertex (pose, i, j, &column, &row);
      if (column < 0 || row < 0 || column > tracker->pattern.columns
          || row > tracker->pattern.rows)
        continue;
      vertex = cloth_quad_vertex (tracker, column, row);
      if (vertex->seen)
        continue;
      vertex->seen = TRUE;
      vertex->x = patch->x[from];
      vertex->y = patch->y[from];
    }
}

/* Remembers which board vertex each corner of the patch is, -1: its patch could not be
 * placed. @from: where its corners were noted already, the number of those noted if they
 * were not. */
static void
note_corners (ClothQuadTracker * tracker, const ClothPose * pose, guint from)
{
  const ClothPatch *patch = &tracker->patch;

  for (gint j = 0; j < patch->rows; j++)
    for (gint i = 0; i < patch->columns; i++) {
      gint at = j * patch->columns + i, column, row, vertex = -1;

      if (!patch->kind[at])
        continue;
      if (pose) {
        cloth_pose_vertex (pose, i, j, &column, &row);
        if (column >= 0 && row >= 0 && column <= tracker->pattern.columns
            && row <= tracker->pattern.rows)
          vertex = row * (tracker->pattern.columns + 1) + column;
      }
      if (from < tracker->corner_vertex->len) {
        g_array_index (tracker->corner_vertex, gint, from++) = vertex;
        continue;
      }
      cloth_point_grid_add (tracker->corners, patch->x[at], patch->y[at]);
      g_array_append_val (tracker->corner_vertex, vertex);
      from++;
    }
}

static void
forget (ClothQuadTracker * tracker)
{
  gint n = tracker->pattern.columns * tracker->pattern.rows;

  for (gint k = 0; k < n; k++) {
    tracker->cells[k].age = G_MAXUINT;
    tracker->cells[k].run = 0;
  }
  n = (tracker->pattern.columns + 1) * (tracker->pattern.rows + 1);
  for (gint k = 0; k < n; k++) {
    tracker->vertices[k].guessed = FALSE;
    tracker->vertices[k].reckoned = 0;
  }
  cloth_point_grid_clear (tracker->guesses, tracker->image->width,
      tracker->image->height, 1);
  g_array_set_size (tracker->guess_vertex, 0);
  for (guint k = 0; k < tracker->recalls->len; k++)
    g_array_index (tracker->recalls, ClothQuadRecall, k).vertex = -1;
}

static void
index_guesses (ClothQuadTracker * tracker)
{
  gint n = (tracker->pattern.columns + 1) * (tracker->pattern.rows + 1);

  cloth_point_grid_clear (tracker->guesses, tracker->image->width,
      tracker->image->height, (guint) n);
  g_array_set_size (tracker->guess_vertex, 0);
  for (gint k = 0; k < n; k++)
    if (is_guessed (&tracker->vertices[k])) {
      cloth_point_grid_add (tracker->guesses, tracker->vertices[k].guess_x,
          tracker->vertices[k].guess_y);
      g_array_append_val (tracker->guess_vertex, k);
    }
}

static inline gboolean
is_known (const ClothQuadVertex * vertex, guint8 step)
{
  return vertex->seen || vertex->guessed || (vertex->reckoned
      && vertex->reckoned < step);
}

/* Vertices that nobody remembers lie straight on from those known by now, if at all. */
static void
reckon_guesses (ClothQuadTracker * tracker)
{
  static const gint dc[4] = { -1, 1, 0, 0 }, dr[4] = { 0, 0, -1, 1 };
  gint columns = tracker->pattern.columns + 1, rows = tracker->pattern.rows + 1;
  gfloat weight = 1;

  for (guint8 step = 1; step <= RECKON_STEPS; step++) {
    weight *= RECKON_FADE;
    for (gint k = 0; k < columns * rows; k++) {
      ClothQuadVertex *own = &tracker->vertices[k];
      gfloat x = 0, y = 0, size = 0;
      gint n = 0;

      if (is_known (own, step))
        continue;
      for (gint way = 0; way < 4; way++) {
        gint column = k % columns + 2 * dc[way], row =
            k / columns + 2 * dr[way];
        const ClothQuadVertex *near, *far;
        gfloat nx, ny, fx, fy;

        if (column < 0 || row < 0 || column >= columns || row >= rows)
          continue;
        near = cloth_quad_vertex (tracker, column - dc[way], row - dr[way]);
        far = cloth_quad_vertex (tracker, column, row);
        if (!is_known (near, step) || !is_known (far, step))
          continue;
        nx = near->seen ? near->x : near->guess_x;
        ny = near->seen ? near->y : near->guess_y;
        fx = far->seen ? far->x : far->guess_x;
        fy = far->seen ? far->y : far->guess_y;
        x += 2 * nx - fx;
        y += 2 * ny - fy;
        size += hypotf (nx - fx, ny - fy);
        n++;
      }
      if (!n)
        continue;
      own->reckoned = step;
      own->guess_x = x / (gfloat) n;
      own->guess_y = y / (gfloat) n;
      own->size = MAX (size / (gfloat) n, 1.0f);
      own->weight = weight;
    }
  }
}

/* Whether what speaks against the memory is not believed yet: it has to do so in several
 * pictures in a row, each of which counts once, however many patches say so. */
static gboolean
doubt (ClothQuadTracker * tracker)
{
  if (!tracker->doubted)
    tracker->doubts++;
  tracker->doubted = TRUE;
  return tracker->doubts <= MAX_DOUBTS;
}

/* Counts the cells around the patch that show the board's end, and those of which nothing
 * is known though the board goes on there; of the colour that the cloth has not. */
static void
count_rim (ClothQuadTracker * tracker, const ClothPose * pose,
    gint * n_rim, gint * n_hidden)
{
  const ClothPatch *patch = &tracker->patch;
  gint rim[2] = { 0 }, hidden[2] = { 0 };
  gboolean black;

  for (gint j = 0; j + 1 < patch->rows; j++)
    for (gint i = 0; i + 1 < patch->columns; i++) {
      const gint n = patch->columns, at = j * n + i;
      gint column, row;

      if (patch->square[at] || !((i > 0 && patch->square[at - 1])
              || (j > 0 && patch->square[at - n]) || patch->square[at + 1]
              || patch->square[at + n]))
        continue;
      black = cloth_patch_is_black (patch, i, j);
      cloth_pose_cell (pose, i, j, &column, &row);
      if (cloth_quad_cell (tracker, column, row))
        hidden[black]++;
      else
        rim[black] += patch->inside[at] < 0;
    }
  black = rim[1] == rim[0] ? hidden[1] > hidden[0] : rim[1] > rim[0];
  *n_rim = rim[black];
  *n_hidden = hidden[black];
}

/* Where the refused patches of the last picture put what this one does, the evidence for
 * that; else 0. */
static gfloat
evidence_before (ClothQuadTracker * tracker, const ClothPose * pose)
{
  const ClothPatch *patch = &tracker->patch;
  gfloat evidence = G_MAXFLOAT;
  gint agree = 0, against = 0;

  if (!tracker->pending_corner->len)
    return 0;
  for (gint j = 0; j < patch->rows; j++)
    for (gint i = 0; i < patch->columns; i++) {
      const gint at = j * patch->columns + i;
      const ClothQuadPending *before;
      gint column, row;
      ClothNear near;

      if (patch->kind[at] != CLOTH_VERTEX_SADDLE
          || !cloth_point_grid_nearest (tracker->pending, patch->x[at],
              patch->y[at], MAX_STEP, &near, 1))
        continue;
      before = &g_array_index (tracker->pending_corner, ClothQuadPending,
          near.index);
      if (sqrtf (near.distance2) > VOTE_REACH * before->size)
        continue;
      cloth_pose_vertex (pose, i, j, &column, &row);
      if (before->vertex != row * (tracker->pattern.columns + 1) + column) {
        against++;
        continue;
      }
      agree++;
      evidence = MIN (evidence, before->evidence);
    }
  return agree >= LEAST_AGREE && agree > 2 * against ? evidence : 0;
}

/* Keeps a patch refused for want of @evidence, which pictures have added up, in mind. */
static void
note_pending (ClothQuadTracker * tracker, const ClothPose * pose,
    gfloat evidence)
{
  const ClothPatch *patch = &tracker->patch;

  for (gint j = 0; j + 1 < patch->rows; j++)
    for (gint i = 0; i + 1 < patch->columns; i++) {
      const gint at = j * patch->columns + i;
      ClothQuadPending own = {.evidence = evidence };
      gint column, row;

      if (patch->kind[at] != CLOTH_VERTEX_SADDLE || !patch->kind[at + 1])
        continue;
      cloth_pose_vertex (pose, i, j, &column, &row);
      own.vertex = row * (tracker->pattern.columns + 1) + column;
      own.size = hypotf (patch->x[at + 1] - patch->x[at],
          patch->y[at + 1] - patch->y[at]);
      cloth_point_grid_add (tracker->pending_now, patch->x[at], patch->y[at]);
      g_array_append_val (tracker->pending_corner_now, own);
    }
}

/* Whether what was seen alone tells where the patch lies. Something else has any size, and
 * goes on where the board would end: so of a plain board the rim must be seen, and not too
 * much of what is around the patch be hidden. Other checkerboards are taken for the board
 * mostly when nothing is remembered: then more is asked, or less a picture but in several
 * that follow each other. */
static gboolean
is_evident (ClothQuadTracker * tracker, const ClothPose * pose)
{
  const gfloat evidence = pose->evidence;
  gint rim, hidden;
  gfloat before;

  if (tracker->pattern.code)
    return evidence >= READ;
  if (evidence < HINT)
    return FALSE;
  if (pose->whole)
    return TRUE;
  count_rim (tracker, pose, &rim, &hidden);
  if (evidence >= EVIDENT && hidden <= HIDDEN * rim + 1)
    return TRUE;
  if (tracker->guess_vertex->len > 0) {
    if (evidence >= FAIR && rim > 0)
      return evidence >= EVIDENT || hidden <= HIDDEN_LATER * rim + 2;
    if (rim >= LEAST_RIM && hidden <= HIDDEN_LATER * rim)
      return TRUE;
  } else {
    if (hidden <= HIDDEN * (rim - LEAST_RIM))
      return rim > LEAST_RIM;
    if (rim < LEAST_RIM || hidden > HIDDEN * rim)
      return FALSE;
  }
  before = evidence_before (tracker, pose);
  if (before > 0 && before + evidence >= FAIR)
    return TRUE;
  note_pending (tracker, pose, before + evidence);
  return FALSE;
}

/* Places the patch that was just built. Linking may have joined pieces on both sides of a
 * fold: @other is the place that memory knows of the second piece, weight 0 for none. */
static gboolean
place (ClothQuadTracker * tracker, gboolean first, ClothPose * pose,
    ClothPose * other)
{
  ClothPose votes[MAX_VOTES + MAX_SEEDS];
  guint n_memory, n;
  ClothPoseWeights weights = cloth_pose_cloth;
  gfloat agrees = 0, known = 0;
  gboolean evident;

  recall_all (tracker);
  n = n_memory = vote_by_memory (tracker, votes);
  for (guint s = 0; s < tracker->seeds->len && n < n_memory + MAX_SEEDS; s++)
    n += vote_by_seed (tracker,
        &g_array_index (tracker->seeds, ClothQuadSeed, s), &votes[n]);
  /* With nothing to go by, a plain board that looks the same after a turn is taken the way
   * it is most upright; from then on the memory tells which way that was. */
  weights.twins = first && n == 0 && tracker->guess_vertex->len == 0;
  if (!cloth_pose_finder_run (tracker->pose_finder, &tracker->patch, &weights,
          votes, n, pose)
      || pose->weight < CLOTH_POSE_MIN_LEAD)
    return FALSE;
  for (guint v = 0; v < n; v++)
    if (votes[v].rotation == pose->rotation
        && votes[v].column == pose->column && votes[v].row == pose->row)
      known += votes[v].weight;
  evident = known < KNOWN && is_evident (tracker, pose);
  if (known < KNOWN && !evident)
    return FALSE;
  for (guint v = 0; v < n_memory; v++)
    if (votes[v].rotation == pose->rotation
        && votes[v].column == pose->column && votes[v].row == pose->row)
      agrees = votes[v].weight;
    else if (votes[v].weight > other->weight)
      *other = votes[v];
  /* What the largest patch shows overrules the memory: it had slipped. The others must
   * fit to what is known by then, or show their place beyond doubt. */
  if (!first && pose->weight < SURE_LEAD && (agrees == 0 ? !evident
          || other->weight > KNOWN : other->weight > agrees))
    return FALSE;
  /* A board that was just seen is hardly anywhere else. */
  if (first && agrees == 0 && tracker->guess_vertex->len > 0
      && pose->weight < NEW_LEAD && doubt (tracker))
    return FALSE;
  /* Where it knows both places well, the patch is joined over a fold. */
  if (first && other->weight > agrees && other->weight > STRONG_VOTE
      && agrees <= STRONG_VOTE) {
    if (pose->weight < SURE_LEAD && doubt (tracker))
      return FALSE;
    forget (tracker);
    other->weight = 0;
  }
  return TRUE;
}

static void
swap_pending (ClothQuadTracker * tracker)
{
  ClothPointGrid *grid = tracker->pending;
  GArray *corners = tracker->pending_corner;

  tracker->pending = tracker->pending_now;
  tracker->pending_corner = tracker->pending_corner_now;
  tracker->pending_now = grid;
  tracker->pending_corner_now = corners;
}

/* Places one patch and takes its squares, if it can be told where it lies. */
static gboolean
try_patch (ClothQuadTracker * tracker, const ClothLinkPatch * link,
    guint n_placed, guint from)
{
  const ClothPatchParams params = { tracker->params->alpha,
    tracker->params->c_low, -3.0f, 0.25f, FALSE, tracker->pattern.code != NULL
  };
  ClothPose pose, other = { 0 };

  cloth_patch_build (&tracker->patch, tracker->image, tracker->saddles, link,
      &params);
  if (!place (tracker, n_placed == 0, &pose, &other)) {
    note_corners (tracker, NULL, from);
    return FALSE;
  }
  note_corners (tracker, &pose, from);
  take_patch (tracker, &pose, pose.evidence < MIXED ? 3 : 0);
  if (other.weight > STRONG_VOTE)
    take_patch (tracker, &other, 3);
  /* The others are looked for where the first one's motion has brought them. */
  if (n_placed == 0)
    cloth_quad_spread_shift (tracker);
  if (n_placed < RECKON_PATCHES)
    reckon_guesses (tracker);
  index_guesses (tracker);
  return TRUE;
}

void
cloth_quad_link (ClothQuadTracker * tracker)
{
  const ClothLinkPatch *links;
  guint order[MAX_PATCHES], refused[MAX_PATCHES], from[MAX_PATCHES];
  guint n_links, n, n_placed = 0, n_refused = 0, n_again = 0;

  tracker->doubted = FALSE;
  cloth_point_grid_clear (tracker->pending_now, tracker->image->width,
      tracker->image->height, 1);
  g_array_set_size (tracker->pending_corner_now, 0);
  index_guesses (tracker);
  cloth_point_grid_clear (tracker->corners, tracker->image->width,
      tracker->image->height, tracker->n_saddles);
  g_array_set_size (tracker->corner_vertex, 0);
  n_links = cloth_linker_run (tracker->linker, tracker->image,
      tracker->logarithm, tracker->saddles, tracker->n_saddles, &links, NULL);
  n = cloth_link_largest (links, n_links, order, MAX_PATCHES);
  for (guint k = 0; k < n; k++) {
    from[n_refused] = tracker->corner_vertex->len;
    if (try_patch (tracker, &links[order[k]], n_placed, from[n_refused])) {
      n_again = n_refused;
      n_placed++;
    } else {
      refused[n_refused++] = order[k];
    }
  }
  /* Those placed after one that was refused may tell more of its place. */
  for (guint k = 0; k < n_again; k++)
    n_placed += try_patch (tracker, &links[refused[k]], n_placed, from[k]);
  if (!tracker->doubted)
    tracker->doubts = 0;
  swap_pending (tracker);
}
