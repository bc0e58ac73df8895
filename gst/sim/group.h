/* Groups of lanes: models that are computed side by side.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/sim/lanes/backend.h"

G_BEGIN_DECLS

/* @first: rank of its first model, @n: how many it has. */
typedef struct
{
  const ClothLaneBackend *backend;
  gpointer lanes;
  guint first, n;
} ClothSimGroup;

ClothSimGroup *cloth_sim_groups_new (const ClothBody * body,
    const ClothModel * const *models, guint n_models,
    const ClothSimOptions * options, guint threads, guint * group_of,
    guint * rank_of, guint * n_groups);
void cloth_sim_groups_free (ClothSimGroup * groups, guint n_groups);

G_END_DECLS
