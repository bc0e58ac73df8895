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
} ClothExcess;

ClothExcess *cloth_excess_new (const ClothNudgedResidual * take,
    const ClothNudgedResidual * nulls, guint n_nulls, gboolean alike, gboolean smooth,
    const ClothLocalisationOptions * options);
ClothExcess *cloth_excess_new_null (const ClothNudgedResidual * null,
    const ClothLocalisationOptions * options);
void cloth_excess_free (ClothExcess * level);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothExcess, cloth_excess_free)
G_END_DECLS
