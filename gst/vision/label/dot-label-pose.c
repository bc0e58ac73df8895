/* Patches of the lattice in the array: the likelihood of all their dots decides.
 *
 * Each dot says how much likelier each colour is than any: log ((1 − ε) n p + ε), where p
 * is its share among the n colours and ε the share of dots that have any colour at all. A
 * placing of a patch turns, mirrors and shifts it over the array and adds up what its
 * dots say to the colours there. Dots of random colours give a sum that is below zero but
 * for one in exp (sum).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/label/dot-label-private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Dots about the middle of a patch that choose the placings that all its dots judge. */
#define N_PROBES 25
/* Of those, the first that are asked of all placings. */
#define N_FIRST 6
/* A placing so far behind the best is given up, nats. */
#define BEHIND 12.0f
/* Most placings that all dots judge. */
#define N_JUDGED 32
#define TURNS 8
/* What a place that the former picture predicts must have before random colours: as if
 * it were one of ten. */
#define PREDICTED 2.3f
/* What each neighbour adds to the log-odds that a dot fits or not, and how often all are
 * asked. */
#define COUPLING 1.0f
#define ROUNDS 4
/* Dots of a patch about which its placing is looked for, one after another. */
#define TRIES 6
/* Labelled dots that tell how often colours are wrong, how fast that is learnt, and
 * within what bounds. */
#define ENOUGH 50
#define LEARNING 0.3f
/* What is left of how dots looked, picture by picture. */
#define FADING 0.9f
/* Dots of wrong colours are labelled more rarely. */
#define MISSED 1.5f
#define LEAST_ERROR 0.03f
#define MOST_ERROR 0.45f

typedef ClothLatticeCandidate Candidate;

static void
along_of_turn (guint8 turn, gint8 along[2][2])
{
  static const gint8 ways[4][2] = { {1, 0}, {0, 1}, {-1, 0}, {0, -1} };
  const gint8 sign = turn & 4 ? -1 : 1;

  along[0][0] = ways[turn & 3][0];
  along[0][1] = ways[turn & 3][1];
  along[1][0] = (gint8) (-sign * along[0][1]);
  along[1][1] = (gint8) (sign * along[0][0]);
}

/* Colour of the array; n_colours where it has no dot. */
static inline guint
colour_at (const ClothDotLabeller * labeller, gint column, gint row)
{
  return (guint) column < (guint) labeller->columns
      && (guint) row < (guint) labeller->rows
      ? labeller->matrix[row * labeller->columns + column]
      : (guint) labeller->n_colours;
}

static inline void
cell_in_array (const ClothLatticePlace * place, const gint32 cell[2],
    gint at[2])
{
  for (gint c = 0; c < 2; c++)
    at[c] = place->origin[c] + cell[0] * place->along[0][c]
        + cell[1] * place->along[1][c];
}

/* What dot @i says to lying in @cell of a patch at @place. */
static inline gfloat
gain_at (const ClothDotLabeller * labeller, const ClothLatticePlace * place,
    guint i)
{
  gint at[2];

  cell_in_array (place, labeller->nodes[i].cell, at);
  return labeller->gains[i * (guint) (labeller->n_colours + 1)
      + colour_at (labeller, at[0], at[1])];
}

/* Turns likelihoods into log-odds; takes all labels away. */
void
cloth_dot_label_weigh (ClothDotLabeller * labeller,
    const gfloat * log_likelihoods)
{
  const guint m = (guint) labeller->n_colours;
  const gfloat any = labeller->error;

  for (guint i = 0; i < labeller->n; i++) {
    const gfloat *from = log_likelihoods + i * m;
    gfloat *to = labeller->gains + i * (m + 1);
    gfloat most = -G_MAXFLOAT, sum = 0;

    cloth_dot_label_clear (&labeller->labels[i]);
    for (guint k = 0; k < m; k++)
      most = MAX (most, from[k]);
    for (guint k = 0; k < m; k++)
      sum += to[k] = expf (from[k] - most);
    for (guint k = 0; k < m; k++)
      to[k] = sum >= 1 && sum <= (gfloat) m
          ? logf ((1 - any) * (gfloat) m * to[k] / sum + any) : 0;
    to[m] = logf (any);
  }
}

/* Whether a link leads to where the patch has its neighbour. */
static gboolean
is_true_link (const ClothDotLabeller * labeller, const ClothLatticeNode * node,
    gint slot)
{
  const ClothLatticeNode *next;
  gint32 cell[2];
  guint8 turn;

  if (node->next[slot] < 0)
    return FALSE;
  next = &labeller->nodes[node->next[slot]];
  if (next->patch != node->patch)
    return FALSE;
  cloth_dot_label_step (node, slot, cell, &turn);
  return cell[0] == next->cell[0] && cell[1] == next->cell[1]
      && turn == next->turn;
}

/* --- searching the whole array ------------------------------------------------------ */

static guint
knit (const ClothLatticeNode * node)
{
  return (guint) node->squares[0] + node->squares[1] + node->squares[2]
      + node->squares[3];
}

/* The dot that is best knit, and whose neighbours are, among those that were no probes
 * yet; G_MAXUINT without any. */
static guint
find_anchor (const ClothDotLabeller * labeller, const ClothLatticePatch * patch)
{
  guint anchor = G_MAXUINT, most = 0;

  for (guint k = 0; k < patch->n; k++) {
    const guint i = labeller->members[patch->first + k];
    const ClothLatticeNode *node = &labeller->nodes[i];
    guint sum = 1 + 2 * knit (node);

    if (node->probed)
      continue;
    for (gint slot = 0; slot < 4; slot++)
      if (node->next[slot] >= 0)
        sum += knit (&labeller->nodes[node->next[slot]]);
    if (sum > most) {
      most = sum;
      anchor = i;
    }
  }
  return anchor;
}

/* The dots of the patch nearest to @anchor, it first. */
static guint
choose_probes (const ClothDotLabeller * labeller,
    const ClothLatticePatch * patch, guint anchor, guint probes[N_PROBES])
{
  const gint32 *middle = labeller->nodes[anchor].cell;
  const guint all = MIN (N_PROBES, patch->n);
  guint n = 0;

  for (gint reach = 0; n < all; reach++) {
    for (guint k = 0; k < patch->n && n < all; k++) {
      const guint i = labeller->members[patch->first + k];
      const gint32 *cell = labeller->nodes[i].cell;

      if (abs (cell[0] - middle[0]) + abs (cell[1] - middle[1]) == reach)
        probes[n++] = i;
    }
  }
  return n;
}

/* Asks the first probes of every placing that gives the anchor a colour that it looks
 * like; keeps those that may come near the best. */
static void
ask_all (ClothDotLabeller * labeller, const guint * probes, guint n)
{
  const guint m = (guint) labeller->n_colours + 1;
  const gint32 *middle = labeller->nodes[probes[0]].cell;
  const gint pad = CLOTH_DOT_LABEL_PAD, stride = labeller->columns + 2 * pad;
  const gfloat *gains[N_FIRST];
  Candidate *candidates;
  gfloat best = -G_MAXFLOAT;
  guint n_kept = 0;

  g_array_set_size (labeller->candidates,
      (guint) (TURNS * labeller->columns * labeller->rows));
  candidates = (Candidate *) (gpointer) labeller->candidates->data;
  for (guint k = 0; k < n; k++)
    gains[k] = labeller->gains + probes[k] * m;
  for (guint8 turn = 0; turn < (labeller->params.mirrored ? 8 : 4); turn++) {
    gint8 along[2][2];
    gint by[N_FIRST];

    along_of_turn (turn, along);
    for (guint k = 0; k < n; k++) {
      const gint32 *cell = labeller->nodes[probes[k]].cell;
      const gint x = CLAMP (cell[0] - middle[0], -pad, pad);
      const gint y = CLAMP (cell[1] - middle[1], -pad, pad);

      by[k] = x * along[0][0] + y * along[1][0]
          + stride * (x * along[0][1] + y * along[1][1]);
    }
    for (gint colour = 0; colour < labeller->n_colours; colour++) {
      if (gains[0][colour] < 0)
        continue;
      for (guint i = labeller->of_colour[colour];
          i < labeller->of_colour[colour + 1]; i++) {
        const ClothLatticeCell cell = labeller->cells[i];
        const guint8 *colours = labeller->padded
            + (cell.row + pad) * stride + pad + cell.column;
        gfloat score = gains[0][colour];

        for (guint k = 1; k < n; k++)
          score += gains[k][colours[by[k]]];
        best = MAX (best, score);
        candidates[n_kept] = (Candidate) {
        score, cell.column, cell.row, turn};
        n_kept += score > best - BEHIND;
      }
    }
  }
  g_array_set_size (labeller->candidates, n_kept);
}

/* Keeps the candidates that are not far behind. */
static void
thin_out (ClothDotLabeller * labeller)
{
  Candidate *candidates = (Candidate *) (gpointer) labeller->candidates->data;
  gfloat best = -G_MAXFLOAT;
  guint n = 0;

  for (guint k = 0; k < labeller->candidates->len; k++)
    best = MAX (best, candidates[k].score);
  for (guint k = 0; k < labeller->candidates->len; k++)
    if (candidates[k].score > best - BEHIND)
      candidates[n++] = candidates[k];
  g_array_set_size (labeller->candidates, n);
}

static int
compare_candidates (gconstpointer a, gconstpointer b)
{
  const Candidate *x = a, *y = b;

  if (x->score != y->score)
    return x->score > y->score ? -1 : 1;
  if (x->turn != y->turn)
    return x->turn - y->turn;
  return x->row != y->row ? x->row - y->row : x->column - y->column;
}

static ClothLatticePlace
place_of_candidate (const Candidate * candidate, const gint32 middle[2])
{
  ClothLatticePlace place = {.origin = {candidate->column, candidate->row},
  .mirrored = (candidate->turn & 4) != 0
  };

  along_of_turn (candidate->turn, place.along);
  for (gint c = 0; c < 2; c++)
    place.origin[c] -= middle[0] * place.along[0][c]
        + middle[1] * place.along[1][c];
  return place;
}

static gfloat
score_of_place (const ClothDotLabeller * labeller,
    const ClothLatticePatch * patch, const ClothLatticePlace * place)
{
  gfloat score = 0;

  for (guint k = 0; k < patch->n; k++)
    score += gain_at (labeller, place, labeller->members[patch->first + k]);
  return score;
}

/* Candidates for the placing of a patch by the dots about @anchor, the best first; by
 * how much it leads before the next best and before random colours. */
static gfloat
search (ClothDotLabeller * labeller, const ClothLatticePatch * patch,
    guint anchor)
{
  const guint m = (guint) labeller->n_colours + 1;
  const gfloat n_places = (gfloat) (TURNS * labeller->columns * labeller->rows);
  const gint32 *middle = labeller->nodes[anchor].cell;
  const Candidate *candidates;
  guint probes[N_PROBES], n;
  gfloat lead = BEHIND;

  n = choose_probes (labeller, patch, anchor, probes);
  /* Where others have been asked as well, only a wrong colour of the anchor can hide the
   * placing. */
  for (guint k = 0; k < (patch->n > N_PROBES ? n : 1); k++)
    labeller->nodes[probes[k]].probed = TRUE;
  ask_all (labeller, probes, MIN (n, N_FIRST));
  for (guint k = N_FIRST; k < n; k++) {
    const gint32 *cell = labeller->nodes[probes[k]].cell;
    gint8 along[2][2];
    gint by[TURNS][2];

    for (guint8 turn = 0; turn < TURNS; turn++) {
      along_of_turn (turn, along);
      for (gint c = 0; c < 2; c++)
        by[turn][c] = (cell[0] - middle[0]) * along[0][c]
            + (cell[1] - middle[1]) * along[1][c];
    }
    for (guint i = 0; i < labeller->candidates->len; i++) {
      Candidate *candidate =
          &g_array_index (labeller->candidates, Candidate, i);

      candidate->score += labeller->gains[probes[k] * m
          + colour_at (labeller, candidate->column + by[candidate->turn][0],
              candidate->row + by[candidate->turn][1])];
    }
    thin_out (labeller);
  }
  qsort (labeller->candidates->data, labeller->candidates->len,
      sizeof (Candidate), compare_candidates);
  candidates = (const Candidate *) (gpointer) labeller->candidates->data;
  if (labeller->candidates->len == 0)
    return -G_MAXFLOAT;
  if (labeller->candidates->len > 1)
    lead = candidates[0].score - candidates[1].score;
  return MIN (lead, candidates[0].score - logf (n_places));
}

/* Where the former picture's labels put a patch, by those of @anchor and two of its
 * neighbours. FALSE if they don't say. */
static gboolean
predict (const ClothDotLabeller * labeller, guint anchor,
    ClothLatticePlace * place)
{
  const ClothLatticeNode *node = &labeller->nodes[anchor];
  const gint32 here = labeller->predicted[anchor];
  gboolean known[2] = { FALSE, FALSE };

  if (here < 0)
    return FALSE;
  for (gint slot = 0; slot < 4; slot++) {
    const gint way = (slot - node->turn) & 3;
    gint by[2];
    gint32 there;

    if (!is_true_link (labeller, node, slot))
      continue;
    there = labeller->predicted[node->next[slot]];
    if (there < 0)
      continue;
    by[0] = there % labeller->columns - here % labeller->columns;
    by[1] = there / labeller->columns - here / labeller->columns;
    if (abs (by[0]) + abs (by[1]) != 1)
      return FALSE;
    for (gint c = 0; c < 2; c++)
      place->along[way & 1][c] = (gint8) (way & 2 ? -by[c] : by[c]);
    known[way & 1] = TRUE;
  }
  if (!known[0] || !known[1] || place->along[0][0] * place->along[1][0]
      + place->along[0][1] * place->along[1][1] != 0)
    return FALSE;
  place->mirrored = place->along[0][0] * place->along[1][1]
      - place->along[0][1] * place->along[1][0] < 0;
  place->origin[0] = here % labeller->columns;
  place->origin[1] = here / labeller->columns;
  for (gint c = 0; c < 2; c++)
    place->origin[c] -= node->cell[0] * place->along[0][c]
        + node->cell[1] * place->along[1][c];
  return !place->mirrored || labeller->params.mirrored;
}

/* How sure it is that the patch lies at the first of the candidates and not at another
 * of them, or nowhere. */
static gfloat
judge (const ClothDotLabeller * labeller, const ClothLatticePatch * patch,
    const gint32 middle[2])
{
  const gfloat n_places = (gfloat) (TURNS * labeller->columns * labeller->rows);
  const Candidate *candidates =
      (const Candidate *) (gpointer) labeller->candidates->data;
  gfloat first = 0, second = logf (n_places);

  for (guint k = 0; k < MIN (labeller->candidates->len, N_JUDGED); k++) {
    const ClothLatticePlace place = place_of_candidate (&candidates[k], middle);
    const gfloat score = score_of_place (labeller, patch, &place);

    if (k == 0)
      first = score;
    else
      second = MAX (second, score);
  }
  return first - second;
}

/* The most that the dots of a patch could say to any placing. */
static gfloat
most_of_patch (const ClothDotLabeller * labeller,
    const ClothLatticePatch * patch)
{
  const guint m = (guint) labeller->n_colours;
  gfloat sum = 0;

  for (guint k = 0; k < patch->n; k++) {
    const gfloat *gains = labeller->gains
        + labeller->members[patch->first + k] * (m + 1);
    gfloat most = gains[0];

    for (guint c = 1; c < m; c++)
      most = MAX (most, gains[c]);
    sum += most;
  }
  return sum;
}

/* --- what doesn't fit ------------------------------------------------------------------ */

/* Mean of @from over a dot and its neighbours in its patch. */
static gfloat
blur (const ClothDotLabeller * labeller, const gfloat * from, guint i)
{
  const ClothLatticeNode *node = &labeller->nodes[i];
  gfloat sum = from[i];
  gint n = 1;

  for (gint slot = 0; slot < 4; slot++) {
    if (node->linked & 1 << slot) {
      sum += from[node->next[slot]];
      n++;
    }
  }
  return sum / (gfloat) n;
}

/* What speaks for a dot's fitting: its own colour, and its neighbours by @fit. */
static gfloat
speak_for (const ClothDotLabeller * labeller, const gfloat * gain,
    const gfloat * fit, guint i)
{
  const ClothLatticeNode *node = &labeller->nodes[i];
  gfloat sum = gain[i];

  for (gint slot = 0; slot < 4; slot++)
    if (node->linked & 1 << slot)
      sum += fit[node->next[slot]] >= 0 ? COUPLING : -COUPLING;
  return sum;
}

/* Makes a new patch of what hangs together with dot @i of patch @number by true links
 * among dots whose @fit has the same sign. */
static void
split (ClothDotLabeller * labeller, guint i, const gfloat * fit,
    guint * n_queue)
{
  ClothLatticeNode *nodes = labeller->nodes;
  ClothLatticePatch piece = { *n_queue, 0 };
  const gint32 to = (gint32) labeller->patches->len;

  labeller->queue[(*n_queue)++] = i;
  nodes[i].probed = TRUE;
  for (guint q = piece.first; q < *n_queue; q++) {
    const ClothLatticeNode *node = &nodes[labeller->queue[q]];

    for (gint slot = 0; slot < 4; slot++) {
      const gint next = node->next[slot];

      if (node->linked & 1 << slot && !nodes[next].probed
          && (fit[next] < 0) == (fit[i] < 0)) {
        nodes[next].probed = TRUE;
        labeller->queue[(*n_queue)++] = (guint) next;
      }
    }
  }
  piece.n = *n_queue - piece.first;
  for (guint q = piece.first; q < *n_queue; q++)
    nodes[labeller->queue[q]].patch = to;
  g_array_append_val (labeller->patches, piece);
}

/* Parts patch @number into pieces that fit its placing and pieces that don't: each
 * becomes a patch of its own. Whether a dot fits depends on its colour and on whether its
 * neighbours do (iterated conditional modes, Besag 1986). */
static void
cut_misfits (ClothDotLabeller * labeller, guint number,
    const ClothLatticePlace * place)
{
  ClothLatticeNode *nodes = labeller->nodes;
  const ClothLatticePatch whole =
      g_array_index (labeller->patches, ClothLatticePatch, number);
  guint *members = labeller->members + whole.first;
  const guint n_patches = labeller->patches->len;
  gfloat *gain = labeller->scratch, *once = gain + labeller->n;
  gfloat *twice = once + labeller->n, *swap;
  guint n_queue = 0;

  for (guint k = 0; k < whole.n; k++) {
    ClothLatticeNode *node = &nodes[members[k]];

    gain[members[k]] = gain_at (labeller, place, members[k]);
    node->probed = FALSE;
    node->linked = 0;
    for (guint8 slot = 0; slot < 4; slot++)
      node->linked |= (guint8) (is_true_link (labeller, node, slot) << slot);
  }
  for (guint k = 0; k < whole.n; k++)
    once[members[k]] = blur (labeller, gain, members[k]);
  for (guint k = 0; k < whole.n; k++)
    twice[members[k]] = blur (labeller, once, members[k]);
  for (guint round = 0; round < ROUNDS; round++) {
    for (guint k = 0; k < whole.n; k++)
      once[members[k]] = speak_for (labeller, gain, twice, members[k]);
    swap = once;
    once = twice;
    twice = swap;
  }
  for (guint k = 0; k < whole.n; k++)
    if (!nodes[members[k]].probed)
      split (labeller, members[k], twice, &n_queue);
  memcpy (members, labeller->queue, whole.n * sizeof *members);
  for (guint k = n_patches; k < labeller->patches->len; k++)
    g_array_index (labeller->patches, ClothLatticePatch, k).first +=
        whole.first;
  g_array_index (labeller->patches, ClothLatticePatch, number).n = 0;
}

/* --- labels --------------------------------------------------------------------------- */

static void
label_patch (ClothDotLabeller * labeller, guint number,
    const ClothLatticePlace * place, gfloat confidence)
{
  const ClothLatticePatch *patch =
      &g_array_index (labeller->patches, ClothLatticePatch, number);

  for (guint k = 0; k < patch->n; k++) {
    const guint i = labeller->members[patch->first + k];
    gint at[2];

    cell_in_array (place, labeller->nodes[i].cell, at);
    if (colour_at (labeller, at[0], at[1]) == (guint) labeller->n_colours)
      continue;
    labeller->labels[i] = (ClothDotLabel) {
    at[0], at[1], confidence, place->mirrored, number};
  }
}

/* Each label at most once: of two dots the surer patch's keeps it. */
static void
keep_unique (ClothDotLabeller * labeller)
{
  const gint n_labels = labeller->columns * labeller->rows;

  for (gint k = 0; k < n_labels; k++)
    labeller->holders[k] = -1;
  for (guint i = 0; i < labeller->n; i++) {
    ClothDotLabel *label = &labeller->labels[i], *other;
    gint32 *holder;

    if (label->column < 0)
      continue;
    holder = &labeller->holders[label->row * labeller->columns + label->column];
    other = *holder < 0 ? NULL : &labeller->labels[*holder];
    if (!other || other->confidence < label->confidence) {
      if (other)
        cloth_dot_label_clear (other);
      *holder = (gint32) i;
      continue;
    }
    cloth_dot_label_clear (label);
  }
}

/* Counts how dots look whose labels say what colour they have, and learns how often the
 * two differ. */
void
cloth_dot_label_compare (ClothDotLabeller * labeller)
{
  guint n = 0, n_wrong = 0;

  for (gint a = 0; a < labeller->n_colours; a++)
    for (gint b = 0; b < labeller->n_colours; b++)
      labeller->looks[a][b] *= FADING;
  for (gint k = 0; k < labeller->columns * labeller->rows; k++) {
    const guint8 colour = labeller->matrix[k];
    guint look;

    if (labeller->holders[k] < 0)
      continue;
    look = cloth_dot_label_look (labeller, (guint) labeller->holders[k]);
    labeller->looks[colour][look] += 1;
    n++;
    n_wrong += look != colour;
  }
  if (n >= ENOUGH)
    labeller->error +=
        LEARNING * (CLAMP (MISSED * (gfloat) n_wrong / (gfloat) n, LEAST_ERROR,
            MOST_ERROR) - labeller->error);
}

/* Parts patch @number by what fits @place, and labels the piece that @anchor is in if it
 * is sure enough. The place is the first of the candidates, or the one that was predicted,
 * which then needs @expected more than random colours give. */
static void
settle (ClothDotLabeller * labeller, guint number, guint anchor,
    const ClothLatticePlace * place, gfloat expected)
{
  const gint32 middle[2] = { labeller->nodes[anchor].cell[0],
    labeller->nodes[anchor].cell[1]
  };
  ClothLatticePatch *piece;
  gfloat confidence;

  cut_misfits (labeller, number, place);
  number = (guint) labeller->nodes[anchor].patch;
  piece = &g_array_index (labeller->patches, ClothLatticePatch, number);
  piece->done = TRUE;
  confidence = expected > 0
      ? score_of_place (labeller, piece, place) - expected
      : judge (labeller, piece, middle);
  if (confidence >= labeller->params.lead)
    label_patch (labeller, number, place, confidence);
}

/* Places a patch where the former picture had it, if its colours say so too. */
static gboolean
place_as_predicted (ClothDotLabeller * labeller, guint number)
{
  const ClothLatticePatch *patch =
      &g_array_index (labeller->patches, ClothLatticePatch, number);
  guint tries = 0;

  for (guint k = 0; k < patch->n && tries < TRIES; k++) {
    const guint anchor = labeller->members[patch->first + k];
    guint probes[N_PROBES], n;
    ClothLatticePlace place = { 0 };
    gfloat score = 0;

    if (!predict (labeller, anchor, &place))
      continue;
    tries++;
    n = choose_probes (labeller, patch, anchor, probes);
    for (guint i = 0; i < n; i++)
      score += gain_at (labeller, &place, probes[i]);
    if (score < labeller->params.lead + PREDICTED)
      continue;
    settle (labeller, number, anchor, &place, PREDICTED);
    return TRUE;
  }
  return FALSE;
}

/* Places a patch by a search of the whole array. */
static void
place_by_search (ClothDotLabeller * labeller, guint number)
{
  const ClothLatticePatch patch =
      g_array_index (labeller->patches, ClothLatticePatch, number);

  for (guint i = 0; i < patch.n; i++)
    labeller->nodes[labeller->members[patch.first + i]].probed = FALSE;
  for (guint try = 0; try < (patch.n > N_PROBES ? TRIES : TRIES / 2); try++) {
    const guint anchor = find_anchor (labeller, &patch);
    ClothLatticePlace place;

    if (anchor == G_MAXUINT)
      return;
    if (search (labeller, &patch, anchor) < labeller->params.lead)
      continue;
    place = place_of_candidate (&g_array_index (labeller->candidates,
            Candidate, 0), labeller->nodes[anchor].cell);
    settle (labeller, number, anchor, &place, 0);
    return;
  }
}

/* Places the patches and labels their dots. */
void
cloth_dot_label_place (ClothDotLabeller * labeller)
{
  const gfloat n_places = (gfloat) (TURNS * labeller->columns * labeller->rows);
  const gfloat needed = labeller->params.lead + logf (n_places);

  /* There may come more. */
  for (guint k = 0; k < labeller->patches->len; k++) {
    const ClothLatticePatch *patch =
        &g_array_index (labeller->patches, ClothLatticePatch, k);
    const gfloat most = most_of_patch (labeller, patch);

    if (patch->done || most < labeller->params.lead + PREDICTED)
      continue;
    if (!place_as_predicted (labeller, k) && most >= needed)
      place_by_search (labeller, k);
  }
  keep_unique (labeller);
}
