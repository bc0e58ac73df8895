/* How far a residual is above what it would be without a gap, vertex by vertex.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/localise/localisation.h"

G_BEGIN_DECLS

/* Squares of residuals over those of the null, less 1: [n_frames][n]; and whether they
 * are known. */
typedef struct {
  guint n;
  guint n_frames;
  gfloat *values;
  guint8 *known;
} ClothGapLevel;

ClothGapLevel *cloth_gap_level_new (const ClothGapLed * take,
    const ClothGapLed * nulls, guint n_nulls, gboolean alike, gboolean smooth,
    const ClothGapRegionOptions * options);
ClothGapLevel *cloth_gap_level_new_null (const ClothGapLed * null,
    const ClothGapRegionOptions * options);
void cloth_gap_level_free (ClothGapLevel * level);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothGapLevel, cloth_gap_level_free)
G_END_DECLS
