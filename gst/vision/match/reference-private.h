/* Reference features by where they lie.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/match/reference.h"

G_BEGIN_DECLS

/* Edge of a bin, px. */
#define CLOTH_REFERENCE_BIN 8

/* @features: sorted by side, row of bins, column of bins
 * @seen: (array): angles in the views themselves
 * @columns: of bins
 * @rows: of bins
 * @starts: (array): first feature of each bin, and one past the last of all
 * @nearest: those that are compared with seeds
 * @of_nearest: (array): which they are
 */
struct _ClothReference
{
  ClothReferenceFeatures features;
  gfloat *x, *y, *scale, *angle, *seen;
  guint8 *view, *side, *descriptors;
  gint columns, rows;
  guint *starts;
  ClothNearest *nearest;
  guint *of_nearest;
  gdouble metres_per_pixel, repeated;
};

/* Column or row of the bin of @value; what lies outside of the picture is in the first and
 * last. */
static inline gint
cloth_reference_bin (gdouble value, gint n)
{
  const gdouble bin = value / CLOTH_REFERENCE_BIN;

  return bin > 0 ? (bin < n - 1 ? (gint) bin : n - 1) : 0;
}

G_END_DECLS
