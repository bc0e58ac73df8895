/* What lies about a spot: the ground around it, the colour inside, noise.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/dot/dot-private.h"

G_BEGIN_DECLS

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

void cloth_dot_find_rows (const ClothDotDetector * detector,
    const ClothDotCandidate * spot, ClothDotRows * rows);
gboolean cloth_dot_look_around (const ClothDotDetector * detector,
    const ClothDotCandidate * spot, const ClothDotRows * rows, ClothDot * dot,
    ClothDotBends * bends);

G_END_DECLS
