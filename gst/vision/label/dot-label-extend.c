/* Labels beyond the patches: from labelled neighbours, and from picture to picture.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/label/dot-label-private.h"

#include <math.h>

/* How well a neighbour predicts where a dot lies: standard deviation as a share of the
 * lattice vector. */
#define MISS 0.15f
/* Log-odds that a dot so found needs, and rounds of looking. */
#define NEEDED 4.0f
#define ROUNDS 12
/* Below these log-odds a dot's label is taken away. */
#define DOUBTFUL 3.0f
/* Where a former dot may be, as a share of the distance of its neighbours. */
#define DRIFT 0.35f

/* --- from picture to picture --------------------------------------------------------- */

static const ClothLatticeFormer *
former_at (const ClothDotLabeller * labeller, gint column, gint row)
{
  return (guint) column < (guint) labeller->columns
      && (guint) row < (guint) labeller->rows
      ? &labeller->former[row * labeller->columns + column] : NULL;
}

/* Which label each dot had in the former picture, if dots go on as they went. */
void
cloth_dot_label_predict (ClothDotLabeller * labeller)
{
  gfloat *nearest = labeller->scratch;

  for (guint i = 0; i < labeller->n; i++) {
    labeller->predicted[i] = -1;
    nearest[i] = G_MAXFLOAT;
  }
  for (gint row = 0; row < labeller->rows; row++) {
    for (gint column = 0; column < labeller->columns; column++) {
      const ClothLatticeFormer *former = former_at (labeller, column, row);
      ClothNear near;

      if (!former->known)
        continue;
      if (cloth_point_grid_nearest (labeller->grid,
              former->x + former->motion[0], former->y + former->motion[1],
              DRIFT * former->pitch, &near, 1) == 0
          || near.distance2 >= nearest[near.index])
        continue;
      nearest[near.index] = near.distance2;
      labeller->predicted[near.index] = row * labeller->columns + column;
    }
  }
}

/* Keeps where the labels are for the next picture. */
void
cloth_dot_label_remember (ClothDotLabeller * labeller)
{
  for (gint k = 0; k < labeller->columns * labeller->rows; k++) {
    ClothLatticeFormer *former = &labeller->former[k];
    const gint holder = labeller->holders[k];
    const gboolean moved = former->known;
    const ClothLatticeNode *node;
    gfloat least = G_MAXFLOAT;

    former->known = holder >= 0 && labeller->labels[holder].column >= 0;
    if (!former->known)
      continue;
    node = &labeller->nodes[holder];
    former->motion[0] = moved ? node->x - former->x : 0;
    former->motion[1] = moved ? node->y - former->y : 0;
    former->x = node->x;
    former->y = node->y;
    for (gint slot = 0; slot < 4; slot++)
      if (node->next[slot] >= 0)
        least = MIN (least, hypotf (node->step[slot][0], node->step[slot][1]));
    former->pitch = least < G_MAXFLOAT ? least : 0;
  }
}

/* --- from neighbour to neighbour ------------------------------------------------------ */

/* Where a dot is predicted to lie. */
typedef struct
{
  gfloat x, y, pitch;
} Guess;

static const ClothLatticeNode *
holder_of (const ClothDotLabeller * labeller, gint column, gint row,
    gboolean mirrored)
{
  gint holder;

  if ((guint) column >= (guint) labeller->columns
      || (guint) row >= (guint) labeller->rows)
    return NULL;
  holder = labeller->holders[row * labeller->columns + column];
  return holder >= 0 && labeller->labels[holder].column >= 0
      && labeller->labels[holder].mirrored == mirrored
      ? &labeller->nodes[holder] : NULL;
}

static void
add_guess (Guess * guesses, guint * n, gfloat x, gfloat y, gfloat pitch)
{
  guesses[(*n)++] = (Guess) {
  x, y, pitch};
}

#define MAX_GUESSES 12

/* Where the dot of a label should be, by labelled dots around it: straight on from two in
 * a line, and the fourth corner of a square. */
static guint
guess_label (const ClothDotLabeller * labeller, gint column, gint row,
    gboolean mirrored, Guess guesses[MAX_GUESSES])
{
  static const gint ways[4][2] = { {1, 0}, {0, 1}, {-1, 0}, {0, -1} };
  const ClothLatticeNode *next[4];
  guint n = 0;

  for (gint k = 0; k < 4; k++)
    next[k] = holder_of (labeller, column + ways[k][0], row + ways[k][1],
        mirrored);
  for (gint k = 0; k < 4; k++) {
    const gint *way = ways[k], *side = ways[(k + 1) & 3];
    const ClothLatticeNode *on, *corner;

    if (!next[k])
      continue;
    on = holder_of (labeller, column + 2 * way[0], row + 2 * way[1], mirrored);
    if (on)
      add_guess (guesses, &n, 2 * next[k]->x - on->x, 2 * next[k]->y - on->y,
          hypotf (next[k]->x - on->x, next[k]->y - on->y));
    corner = holder_of (labeller, column + way[0] + side[0],
        row + way[1] + side[1], mirrored);
    if (corner && next[(k + 1) & 3]) {
      const ClothLatticeNode *a = next[k], *b = next[(k + 1) & 3];

      add_guess (guesses, &n, a->x + b->x - corner->x, a->y + b->y - corner->y,
          MIN (hypotf (a->x - corner->x, a->y - corner->y),
              hypotf (b->x - corner->x, b->y - corner->y)));
    }
  }
  return n;
}

/* Adds where the dot was in the former picture, moved as its neighbours have. */
static void
guess_by_former (const ClothDotLabeller * labeller, gint column, gint row,
    gboolean mirrored, Guess * guesses, guint * n)
{
  const ClothLatticeFormer *former = former_at (labeller, column, row);
  gfloat by[2] = { 0 };
  gint n_moved = 0;

  if (!former->known || former->pitch <= 0)
    return;
  for (gint j = -1; j <= 1; j++) {
    for (gint i = -1; i <= 1; i++) {
      const ClothLatticeFormer *other =
          former_at (labeller, column + i, row + j);
      const ClothLatticeNode *now =
          holder_of (labeller, column + i, row + j, mirrored);

      if (!other || !other->known || !now)
        continue;
      by[0] += now->x - other->x;
      by[1] += now->y - other->y;
      n_moved++;
    }
  }
  if (n_moved > 0)
    add_guess (guesses, n, former->x + by[0] / (gfloat) n_moved,
        former->y + by[1] / (gfloat) n_moved, former->pitch);
}

/* What the guesses say to a dot: Gaussians against dots strewn one a square. All but the
 * best count half, for they share their neighbours. */
static gfloat
weigh_guesses (const Guess * guesses, guint n, const ClothLatticeNode * node,
    gfloat c)
{
  gfloat best = 0, sum = 0;

  for (guint k = 0; k < n; k++) {
    const gfloat x = (node->x - guesses[k].x) / guesses[k].pitch;
    const gfloat y = (node->y - guesses[k].y) / guesses[k].pitch;
    const gfloat d2 = x * x + y * y;
    gfloat odds;

    if (!(d2 < c * c))
      continue;
    odds = -logf (2 * (gfloat) G_PI * MISS * MISS) - d2 / (2 * MISS * MISS);
    best = MAX (best, odds);
    sum += MAX (0, odds) / 2;
  }
  return best / 2 + sum;
}

/* Takes labels away from dots that lie nowhere near where the labelled dots around them
 * say, or that nothing but a wrong colour speaks for. */
void
cloth_dot_label_prune (ClothDotLabeller * labeller)
{
  const guint m = (guint) labeller->n_colours + 1;

  for (gint here = 0; here < labeller->columns * labeller->rows; here++) {
    const gint holder = labeller->holders[here];
    const ClothDotLabel *label;
    Guess guesses[MAX_GUESSES + 1];
    gfloat odds;
    guint n;

    if (holder < 0)
      continue;
    label = &labeller->labels[holder];
    n = guess_label (labeller, label->column, label->row, label->mirrored,
        guesses);
    guess_by_former (labeller, label->column, label->row, label->mirrored,
        guesses, &n);
    odds = labeller->gains[(guint) holder * m + labeller->matrix[here]]
        + weigh_guesses (guesses, n, &labeller->nodes[holder],
        labeller->params.c);
    labeller->doubtful[here] = n > 0 ? odds < DOUBTFUL : FALSE;
  }
  for (gint here = 0; here < labeller->columns * labeller->rows; here++) {
    if (labeller->holders[here] >= 0 && labeller->doubtful[here]) {
      cloth_dot_label_clear (&labeller->labels[labeller->holders[here]]);
      labeller->holders[here] = -1;
    }
  }
}

/* Looks for the dot of a label next to labelled ones. */
static gboolean
extend_to (ClothDotLabeller * labeller, gint column, gint row,
    const ClothDotLabel * from)
{
  const guint m = (guint) labeller->n_colours + 1;
  const guint8 colour = labeller->matrix[row * labeller->columns + column];
  Guess guesses[MAX_GUESSES + 1];
  guint n = guess_label (labeller, column, row, from->mirrored, guesses);
  gfloat best = -G_MAXFLOAT, second = -G_MAXFLOAT;
  gint found = -1;

  if (n == 0)
    return FALSE;
  guess_by_former (labeller, column, row, from->mirrored, guesses, &n);
  for (guint k = 0; k < MIN (n, 3); k++) {
    ClothNear near[4];
    const guint n_near = cloth_point_grid_nearest (labeller->grid, guesses[k].x,
        guesses[k].y, labeller->params.c * guesses[k].pitch, near, 4);

    for (guint i = 0; i < n_near; i++) {
      gfloat odds;

      if (near[i].index == found || labeller->labels[near[i].index].column >= 0)
        continue;
      odds = labeller->gains[(guint) near[i].index * m + colour]
          + weigh_guesses (guesses, n, &labeller->nodes[near[i].index],
          labeller->params.c);
      if (odds > best) {
        second = best;
        best = odds;
        found = near[i].index;
      } else {
        second = MAX (second, odds);
      }
    }
  }
  if (found < 0 || best < NEEDED || best - MAX (second, 0) < NEEDED / 2
      || labeller->gains[(guint) found * m + colour] <= 0)
    return FALSE;
  labeller->labels[found] = (ClothDotLabel) {
  column, row, MIN (best, from->confidence), from->mirrored, from->patch};
  labeller->holders[row * labeller->columns + column] = found;
  return TRUE;
}

/* Labels dots next to labelled ones where place and colour agree. */
void
cloth_dot_label_extend (ClothDotLabeller * labeller)
{
  static const gint ways[4][2] = { {1, 0}, {0, 1}, {-1, 0}, {0, -1} };
  const gint columns = labeller->columns, rows = labeller->rows;
  gboolean more = TRUE;

  for (guint round = 0; more && round < ROUNDS; round++) {
    more = FALSE;
    for (gint row = 0; row < rows; row++) {
      for (gint column = 0; column < columns; column++) {
        const gint here = row * columns + column;

        if (labeller->holders[here] >= 0)
          continue;
        for (gint k = 0; k < 4; k++) {
          const gint x = column + ways[k][0], y = row + ways[k][1];
          gint next;

          if ((guint) x >= (guint) columns || (guint) y >= (guint) rows)
            continue;
          next = labeller->holders[y * columns + x];
          if (next >= 0 && extend_to (labeller, column, row,
                  &labeller->labels[next])) {
            more = TRUE;
            break;
          }
        }
      }
    }
  }
}
