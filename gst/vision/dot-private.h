/* What the parts of dot detection share.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/dot-ellipse.h"
#include "gst/vision/dot.h"

G_BEGIN_DECLS

/* A spot that is taken for a dot. */
typedef struct
{
  gdouble x, y;
  gdouble shape[3];
  ClothDotAxes axes;            /* of @shape */
  guint8 threshold;
  gboolean touches;
  gint32 next;                  /* in its tile, -1: the last */
} ClothDotCandidate;

struct _ClothDotDetector
{
  GArray *runs, *spots, *candidates, *dots;
  guint8 *bounds;               /* four planes of tiles */
  guint16 *bits;
  gint32 *heads;                /* first candidate of each tile, -1: none */
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
