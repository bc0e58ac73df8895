/* What the parts of dot detection share.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/dot/dot.h"

G_BEGIN_DECLS

/* Edge of a tile, px. */
#define CLOTH_DOT_TILE 16
/* Half-axes of the window that is weighed are longer than the spot's by this, px: the
 * blur of the edge. */
#define CLOTH_DOT_MARGIN 1.5

/* Half-axes, px, and the cosine and sine of twice the angle of the longer one. */
typedef struct
{
  gdouble a, b, c, s;
} ClothDotAxes;

/* An ellipse about a centre, A·dx² + 2·B·dx·dy + C·dy² ≤ 1, as its rows need it: dx is
 * within √(widest − narrowing·dy²) of slope·dy. */
typedef struct
{
  gdouble slope, widest, narrowing;
  gdouble width, height;        /* greatest dx and dy */
} ClothDotEllipse;

/* The whole number not above (not below) @v, for what may be a place in a picture. */
#define CLOTH_DOT_FAR_AWAY 1048576

static inline gint
cloth_dot_floor_place (gdouble v)
{
  return (gint) (v + CLOTH_DOT_FAR_AWAY) - CLOTH_DOT_FAR_AWAY;
}

static inline gint
cloth_dot_ceil_place (gdouble v)
{
  return CLOTH_DOT_FAR_AWAY - (gint) (CLOTH_DOT_FAR_AWAY - v);
}

/* A spot that is taken for a dot. */
typedef struct
{
  gdouble x, y;
  gdouble shape[3];
  ClothDotAxes axes;            /* of @shape */
  guint8 threshold;
  gboolean touches;
  gint32 tile;
} ClothDotCandidate;

/* The most rows that a window and the ring about it may have. */
#define CLOTH_DOT_MAX_ROWS 512

/* From which column to which, row by row from the ring's first on. */
typedef struct
{
  gint first[CLOTH_DOT_MAX_ROWS], last[CLOTH_DOT_MAX_ROWS];
} ClothDotSpans;

/* Where the ellipses about a dot are: its inside, the window that is weighed, and that with
 * the ring in which the ground is looked for. */
typedef struct
{
  ClothDotEllipse window, ring;
  gint y0, n;                   /* of the ring */
  gint inside_y0, inside_n;
  ClothDotSpans inside, weighed, around;
} ClothDotRows;

/* Squares of what Immerkær's mask (1 −2 1) × (1 −2 1) gives (1996, “Fast noise variance
 * estimation”): shading that bends along one axis only does not show in it. */
typedef struct
{
  gint64 sum, count;
} ClothDotBends;

/* Pixels that count, and the sum of their luma. */
typedef struct
{
  gint64 sum, n;
} ClothDotTally;

/* What of a picture is weighed, and how. */
typedef struct
{
  const ClothImage *luma;
  gint x0, y0;                  /* the middle, about */
  gint left, right;             /* columns of all rows */
  gint top, n;                  /* rows */
  const gint *first, *last;     /* columns of each */
  gfloat foot, gain;
} ClothDotWeighing;

/* What is done to every pixel.
 * @find_bounds: least and greatest luma of the tiles in row @tile_row; the last ones may
 *   be cut
 * @find_bits: for each tile's 16 pixels of a row a bit for each that is above the tile's
 *   threshold, the leftmost lowest
 * @find_rows: the pixels of @n rows from @y0 on within the ellipse about (@cx, @cy) and
 *   the picture's @width: from @first to @last, none where @first is greater
 * @add_ring: sums and counts the ring's pixels that are not above @most
 * @add_inside: sums the inside's pixels, and what of noise is there
 * @weigh: sums of 1, x, y, x², xy, y²: @shares weighs each pixel by its luma, @edges counts
 *   those between foot and top */
typedef struct
{
  void (*find_bounds) (const ClothImage * image, gint tile_row,
      guint8 * least, guint8 * most);
  void (*find_bits) (const guint8 * row, gint width,
      const guint8 * thresholds, guint16 * bits);
  void (*find_rows) (const ClothDotEllipse * ellipse, gdouble cx, gdouble cy,
      gint y0, gint n, gint width, gint * first, gint * last);
  void (*add_ring) (const ClothImage * luma, const ClothDotCandidate * spot,
      const ClothDotRows * rows, guint8 most, ClothDotTally * tally);
  void (*add_inside) (const ClothImage * luma, const ClothDotRows * rows,
      ClothDotTally * tally, ClothDotBends * bends);
  void (*weigh) (const ClothDotWeighing * weighing, gdouble shares[6],
      gdouble edges[6]);
} ClothDotKernels;

CLOTH_SIMD_TABLES (ClothDotKernels, cloth_dot_kernels);

/* Where a candidate is and how wide, for those that look for neighbours. */
typedef struct
{
  gdouble x, y, a;
  guint index;
} ClothDotPlace;

struct _ClothDotDetector
{
  GArray *runs, *spots, *candidates, *dots;
  guint8 *bounds;               /* four planes of tiles */
  guint16 *bits;
  GArray *sorted;               /* the candidates' places, tile by tile */
  gint32 *heads;                /* the first of each tile; one more for the end */
  gdouble widest;               /* half-axis of all candidates, px */
  gsize n_tiles;
  /* Of the picture at hand. */
  const ClothPlanarImage *image;
  ClothDotParams params;
  gint columns, rows;           /* of tiles */
  guint8 *least, *most, *low, *threshold;
  const ClothDotKernels *kernels;
  gboolean cut;
  gfloat noise;
};

/* dot-centre.c: appends a dot for each candidate that has contrast and lies whole in the
 * picture. */
void cloth_dot_measure (ClothDotDetector * detector);

G_END_DECLS
