/* What the steps of the quad tracker share.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/checker/checker.h"
#include "gst/vision/pointgrid.h"
#include "gst/vision/quad/quad.h"

G_BEGIN_DECLS

/* Pictures for which a square that is no longer seen is remembered. */
#define CLOTH_QUAD_MEMORY 12

/* One square of the board. */
typedef struct {
  gboolean wanted;              /* of a colour that is tracked */
  gboolean found;               /* in this picture */
  gboolean fresh;               /* added by extension in this picture */
  gboolean refused;             /* what was seen in its place has not the print's shade */
  guint8 whole;                 /* sides of the board that it was once seen to reach, bits */
  gboolean cut;                 /* if found: something cuts it off there */
  gboolean shown;               /* tracked or predicted in the last picture */
  guint age;                    /* pictures since it was last found; G_MAXUINT: never */
  guint run;                    /* pictures in a row it was found in */
  gfloat confidence;
  gfloat shade;                 /* dark level over bright, if found; -1: not known */
  gfloat x[4], y[4];            /* in the last picture, guessed if not found there */
  gfloat before_x[4], before_y[4];      /* one picture before those */
  gfloat guess_x[4], guess_y[4];        /* predicted for this picture */
  gfloat here_x[4], here_y[4];  /* in this picture, if found */
  gfloat cov[4][3];             /* of those */
  gint claim[4];                /* of its corners, if found: number of a ClothQuadClaim */
} ClothQuadCell;

/* The remembered vertex nearest to a corner that was seen. */
typedef struct {
  gint vertex;                  /* -1: none near */
  gfloat distance;              /* squares */
} ClothQuadRecall;

/* A corner whose place on the board is thought of, but not believed yet. */
typedef struct {
  gint vertex;
  gfloat size;                  /* of the squares around it, px */
  gfloat evidence;              /* of its patch */
} ClothQuadPending;

/* A place in the picture that squares say is a vertex of the board. */
typedef struct {
  gint vertex;
  gboolean agreed;              /* several say it is that one */
  gboolean contested;           /* others say it is another one */
} ClothQuadClaim;

/* One corner of the board. */
typedef struct {
  gboolean guessed;             /* some remembered square predicts it */
  guint8 reckoned;              /* else reckoned from others, this many squares away */
  gboolean seen;                /* linked in this picture */
  gfloat guess_x, guess_y;
  gfloat size;                  /* of the squares around it, px */
  gfloat x, y;
  gfloat weight;                /* of the guess: 1 if seen in the last picture */
  gfloat freshest;              /* of the squares that make the guess */
  gfloat shift_x, shift_y;      /* seen less guessed, spread to those not seen */
  gfloat spread;                /* weight of the shift */
} ClothQuadVertex;

typedef struct {
  gfloat x[4], y[4];
  gint column, row;             /* -1: not told */
} ClothQuadSeed;

struct _ClothQuadTracker
{
  ClothPattern pattern;
  ClothQuadCell *cells;         /* rows·columns */
  ClothQuadVertex *vertices;    /* (rows + 1)·(columns + 1) */
  ClothLinker *linker;
  ClothPatch patch;
  ClothPointGrid *guesses;      /* guessed vertices */
  GArray *guess_vertex;         /* gint, vertex of each point of that grid */
  GArray *recalls;              /* ClothQuadRecall, of each vertex of the patch */
  ClothPointGrid *candidates;
  ClothPointGrid *refined;      /* saddles */
  gboolean sorted;              /* those two grids are of this picture */
  ClothPointGrid *claimed;      /* corners of the squares found, once where they agree */
  GArray *claims;               /* ClothQuadClaim, of each point of that grid */
  ClothPointGrid *corners;      /* linked saddles that were placed or rejected */
  GArray *corner_vertex;        /* gint, their board vertex, -1: on no known place */
  /* Corners of patches that were refused only for want of evidence, in the last picture
   * and in this one. */
  ClothPointGrid *pending, *pending_now;
  GArray *pending_corner, *pending_corner_now;  /* ClothQuadPending, of each point */
  guint doubts;                 /* pictures in a row that spoke against the memory */
  gboolean doubted;             /* this one did */
  gfloat shade;                 /* of the print, dark level over bright */
  guint n_shades;               /* squares that it is the mean of, 0: not known */
  guint contrary;               /* pictures in a row that spoke against it */
  guint8 logarithm[256];        /* of a grey level */
  guint8 *logarithms;           /* of the picture's levels, where they were asked for */
  gsize logarithms_size;
  ClothPoseFinder *pose_finder;
  GArray *seeds;                /* ClothQuadSeed */
  GArray *out;                  /* ClothQuad */

  /* Of the picture being worked on. */
  const ClothQuadParams *params;
  const ClothImage *image;
  const ClothSaddle *saddles;
  guint n_saddles;
  const ClothSaddleCandidate *raw;
  guint n_raw;
};

static inline ClothQuadCell *
cloth_quad_cell (ClothQuadTracker * tracker, gint column, gint row)
{
  if (column < 0 || row < 0 || column >= tracker->pattern.columns
      || row >= tracker->pattern.rows)
    return NULL;
  return &tracker->cells[row * tracker->pattern.columns + column];
}

static inline ClothQuadVertex *
cloth_quad_vertex (ClothQuadTracker * tracker, gint column, gint row)
{
  return &tracker->vertices[row * (tracker->pattern.columns + 1) + column];
}

/* Whether four squares meet at a vertex. */
static inline gboolean
cloth_quad_is_inner (const ClothQuadTracker * tracker, gint column, gint row)
{
  return column > 0 && row > 0 && column < tracker->pattern.columns
      && row < tracker->pattern.rows;
}

/* Corner k of cell (column, row) is vertex (column, row) plus these. */
static const gint cloth_quad_corner_column[4] = { 0, 1, 1, 0 };
static const gint cloth_quad_corner_row[4] = { 0, 0, 1, 1 };

gfloat cloth_quad_shortest (const gfloat x[4], const gfloat y[4]);
gfloat cloth_quad_longest (const gfloat x[4], const gfloat y[4]);

/* quad-predict.c: the guess of each square, and of each corner of the board. */
void cloth_quad_predict (ClothQuadTracker * tracker);
/* Moves the guesses of what was not found yet along with the corners around it
 * that were. */
void cloth_quad_spread_shift (ClothQuadTracker * tracker);
/* quad-link.c: places the patches found by linking and takes over their squares. */
void cloth_quad_link (ClothQuadTracker * tracker);
/* quad-search.c: looks for one square around a guess. */
gboolean cloth_quad_search (ClothQuadTracker * tracker, gint column, gint row,
    const gfloat guess_x[4], const gfloat guess_y[4]);
void cloth_quad_set_logarithms (guint8 logarithm[256]);
/* quad-shade.c: takes a square for that of a cell, unless it has not the print's shade. */
gboolean cloth_quad_take (ClothQuadTracker * tracker, ClothQuadCell * cell,
    gboolean black, const gfloat x[4], const gfloat y[4], gfloat cov[4][3],
    gfloat confidence);
/* Learns that shade from what was found in the picture. */
void cloth_quad_learn_shade (ClothQuadTracker * tracker);
/* quad-check.c: notes where the squares found have their corners. */
void cloth_quad_claim_all (ClothQuadTracker * tracker);
/* The same of one found after these; FALSE if it is refused, as most of its corners are
 * other vertices. */
gboolean cloth_quad_claim (ClothQuadTracker * tracker, gint column, gint row);
gboolean cloth_quad_is_consistent (ClothQuadTracker * tracker, gint column,
    gint row);
/* Gives up the squares that others speak against. */
void cloth_quad_check (ClothQuadTracker * tracker);
/* And those that something cuts off at the board's rim. */
void cloth_quad_drop_short (ClothQuadTracker * tracker);

G_END_DECLS
