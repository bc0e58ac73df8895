/* Connected spots of a picture above a threshold.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/image.h"

G_BEGIN_DECLS

/* The most runs of bright pixels looked at in one picture. */
#define CLOTH_DOT_MAX_RUNS 4000000

/* Pixels from @start to before @end of row @y, all above the threshold. */
typedef struct {
  gint32 parent;                /* earlier run of the same spot, or itself */
  gint32 next;                  /* next run of the spot, -1: the last */
  gint16 y, start, end;
} ClothDotRun;

/* A connected spot and its moments about the first pixel of its first run. */
typedef struct {
  gint32 first, last;           /* of its runs */
  gint16 left, top, right, bottom;      /* inclusive */
  gint64 n, sx, sy, sxx, sxy, syy;
  guint8 step;                  /* how often its threshold was raised */
} ClothDotSpot;

void cloth_dot_runs_of_bits (GArray * runs, const guint16 * bits,
    gint n_tiles, gint y);
void cloth_dot_runs_of_spot (GArray * runs, const ClothDotSpot * spot,
    const ClothImage * image, guint8 threshold);
void cloth_dot_spots (GArray * runs, guint first_run, GArray * spots);
gdouble cloth_dot_spot_shape (const ClothDotSpot * spot,
    const ClothDotRun * runs, gdouble * x, gdouble * y, gdouble shape[3]);

G_END_DECLS
