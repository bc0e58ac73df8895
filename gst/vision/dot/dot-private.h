/* What the parts of dot detection share.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/dot/dot-ellipse.h"
#include "gst/vision/dot/dot.h"

G_BEGIN_DECLS

/* Half-axes of the window that is weighed are longer than the spot's by this, px: the
 * blur of the edge. */
#define CLOTH_DOT_MARGIN 1.5

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
  const ClothDotImage *image;
  ClothDotParams params;
  gint columns, rows;           /* of tiles */
  guint8 *least, *most, *low, *threshold;
  ClothSimd level;              /* that may be used */
  gboolean cut;
  gfloat noise;
};

void cloth_dot_measure (ClothDotDetector * detector);

G_END_DECLS
