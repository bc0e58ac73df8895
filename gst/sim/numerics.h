/* What the numerics effects make of a scene before it is simulated.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/sim/halving.h"
#include "gst/sim/model.h"

G_BEGIN_DECLS

/* No mesh is halved more often. */
#define CLOTH_MAX_HALVINGS 2

typedef struct
{
  const ClothScene *scene;      /* to be simulated instead */
  gdouble step_factor;          /* of the time step */
  guint32 *kept;                /* where the scene's own vertices are, NULL = in place */
  ClothScene *turned;           /* the scene with other diagonals, or NULL */
  guint n_halvings;
  ClothHalving *halvings[CLOTH_MAX_HALVINGS];
  gdouble *values[CLOTH_MAX_HALVINGS];  /* three of each vertex of a halving */
} ClothNumerics;

gboolean cloth_numerics_agree (const ClothModel * a, const ClothModel * b);
ClothNumerics *cloth_numerics_new (const ClothScene * scene,
    const ClothModel * const *models, guint n_models, GError ** error);
const gdouble *cloth_numerics_spread (ClothNumerics * numerics, guint stride,
    const gdouble * values);
void cloth_numerics_free (ClothNumerics * numerics);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothNumerics, cloth_numerics_free)
G_END_DECLS
