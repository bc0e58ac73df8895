/* Which vertices a residual is significantly at, and from when on.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/localise/excess.h"

G_BEGIN_DECLS

/* @vertices: (element-type guint): where the residual is, growing; empty: nowhere
 * @onset: frame where it begins; 0: it is there from the beginning, or nowhere
 * @score: of the best place
 * @threshold: what chance alone reaches
 */
typedef struct {
  GArray *vertices;
  guint onset;
  gdouble score;
  gdouble threshold;
} ClothLocalisation;

ClothLocalisation *cloth_localisation_new (const ClothNudgedResidual * take,
    const ClothNudgedResidual * nulls, guint n_nulls, gboolean alike,
    const ClothLocalisationOptions * options);
void cloth_localisation_free (ClothLocalisation * region);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothLocalisation, cloth_localisation_free)
G_END_DECLS
