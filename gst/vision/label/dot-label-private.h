/* What the parts of dot labelling share.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/label/dot-label.h"
#include "gst/vision/pointgrid.h"

G_BEGIN_DECLS

/* A dot's place in the lattice. Its four slots follow each other by quarter turns in the
 * picture, the sense the same for all; slot k of one dot may be slot m of another. */
typedef struct
{
  gfloat x, y;
  gfloat shape[3];              /* second moments of its area, px², without blur */
  gfloat step[4][2];            /* to the neighbour of each slot, px; predicted if none */
  gint32 next[4];               /* neighbour of each slot, -1: none */
  guint8 back[4];               /* the slot of the neighbour that leads back */
  guint8 squares[4];            /* closed squares that the link is a side of */
  gboolean sound;               /* numbers that can be used */
  gboolean probed;              /* it helped to look for the placing */
  gint32 patch;                 /* -1: none */
  gint32 cell[2];               /* in the patch */
  guint8 linked;                /* bit k: slot k leads to where the patch has it */
  guint8 turn;                  /* slot of the patch's direction 0 */
} ClothLatticeNode;

/* Most dots around one that are looked at for neighbours. */
#define CLOTH_DOT_LABEL_NEAR 32

/* Dots about a patch's anchor that are asked of all placings lie no farther from it. */
#define CLOTH_DOT_LABEL_PAD 8

/* The dots around a dot, which way they lie on the cloth but for some angle
 * (unit vectors) and how far, in pitches. */
typedef struct
{
  gint32 near[CLOTH_DOT_LABEL_NEAR];
  gfloat way[CLOTH_DOT_LABEL_NEAR][2];
  gfloat distance[CLOTH_DOT_LABEL_NEAR];
  guint n;
} ClothLatticeAround;

/* A connected piece of the lattice: members[first … first + n − 1]. */
typedef struct
{
  guint first, n;
  gboolean done;                /* it is placed, or can't be */
} ClothLatticePatch;

/* A placing: the anchor dot in the array, and how the patch is turned about it. */
typedef struct
{
  gfloat score;
  gint16 column, row;
  guint8 turn;                  /* quarter turns, plus 4 when mirrored */
} ClothLatticeCandidate;

/* A place in the array. */
typedef struct
{
  gint16 column, row;
} ClothLatticeCell;

/* Cells (column, row) of a patch lie in the array at @origin + column·@along[0] +
 * row·@along[1]. */
typedef struct
{
  gint32 origin[2];
  gint8 along[2][2];
  gboolean mirrored;
} ClothLatticePlace;

/* Where a label was in the former picture. */
typedef struct
{
  gboolean known;
  gfloat x, y;
  gfloat motion[2];             /* since the picture before, px */
  gfloat pitch;                 /* distance of its nearest neighbour, px */
} ClothLatticeFormer;

/* Two lattice vectors at a dot, px: along a row of the array and along a column. */
typedef struct
{
  gfloat u[2], v[2];
} ClothLatticeFrame;

struct _ClothDotLabeller
{
  gint columns, rows, n_colours;
  guint8 *matrix;
  guint8 *padded;               /* with n_colours on a rim CLOTH_DOT_LABEL_PAD wide */
  guint8 *doubtful;             /* of each label */
  ClothLatticeCell *cells;      /* the array's, colour by colour */
  guint of_colour[CLOTH_DOT_COLOURS_MAX + 1];   /* where each colour's begin */
  gint32 *holders;              /* of each label: its dot, -1: none */
  ClothDotLabelParams params;
  ClothLatticeFormer *former;   /* of each label */
  gfloat error;                 /* share of dots of another colour than their label's;
                                 * 0: not known yet */
  gfloat looks[CLOTH_DOT_COLOURS_MAX][CLOTH_DOT_COLOURS_MAX];

  GHashTable *windows;          /* by their colours; for the paper's way only */

  /* Of the picture at hand; room for @n_room dots. */
  guint n, n_room;
  ClothPointGrid *grid;
  ClothLatticeNode *nodes;
  ClothLatticeAround *around;
  gfloat *gains;                /* n·(n_colours + 1): log-odds of each colour against any, the
                                 * last where the array has no dot */
  ClothDotLabel *labels;
  gint32 *predicted;             /* label of each dot by the former picture, -1: none */
  guint *members;               /* dots, patch by patch */
  guint *queue;
  ClothLatticeFrame *frames;
  guint n_members;
  GArray *patches;
  GArray *candidates;
  gfloat *scratch;
};

/* Where the neighbour of @slot lies in the patch, and how it is turned there. */
static inline void
cloth_dot_label_step (const ClothLatticeNode * node, gint slot, gint32 cell[2],
    guint8 * turn)
{
  static const gint8 ways[4][2] = { {1, 0}, {0, 1}, {-1, 0}, {0, -1} };
  const gint way = (slot - node->turn) & 3;

  cell[0] = node->cell[0] + ways[way][0];
  cell[1] = node->cell[1] + ways[way][1];
  /* Its slot back is the way back. */
  *turn = (guint8) ((node->back[slot] - (way ^ 2)) & 3);
}

/* The colour that dot @i looks most like. */
static inline guint
cloth_dot_label_look (const ClothDotLabeller * labeller, guint i)
{
  const gfloat *gains = labeller->gains
      + i * (guint) (labeller->n_colours + 1);
  guint best = 0;

  for (guint k = 1; k < (guint) labeller->n_colours; k++)
    if (gains[k] > gains[best])
      best = k;
  return best;
}

static inline void
cloth_dot_label_clear (ClothDotLabel * label)
{
  *label = (ClothDotLabel) {
  -1, -1, 0, FALSE, G_MAXUINT};
}

void cloth_dot_label_start (ClothDotLabeller * labeller, const ClothDot * dots);
void cloth_dot_label_link (ClothDotLabeller * labeller, const ClothDot * dots);
void cloth_dot_label_grow (ClothDotLabeller * labeller);
void cloth_dot_label_weigh (ClothDotLabeller * labeller,
    const gfloat * log_likelihoods);
void cloth_dot_label_place (ClothDotLabeller * labeller);
void cloth_dot_label_predict (ClothDotLabeller * labeller);
void cloth_dot_label_compare (ClothDotLabeller * labeller);
void cloth_dot_label_prune (ClothDotLabeller * labeller);
void cloth_dot_label_extend (ClothDotLabeller * labeller);
void cloth_dot_label_remember (ClothDotLabeller * labeller);
void cloth_dot_label_as_paper (ClothDotLabeller * labeller);

G_END_DECLS
