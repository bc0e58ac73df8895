/* Where a cloth lies flat on the ground, by simulated annealing, as the paper finds it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/vision/track/flat.h"

G_BEGIN_DECLS

/* @seed: of its random numbers
 * @steps: poses that are tried (6000)
 * @hot: temperature of the first step, as a share of the silhouettes' area (0.3)
 * @cold: of the last (0.0003); in between it falls by the same factor each step
 * @differ: greatest difference of the silhouettes that is left, as a share of their area (0.1)
 */
typedef struct {
  guint64 seed;
  guint steps;
  gdouble hot, cold, differ;
} ClothAnnealParams;

ClothAnnealParams cloth_anneal_default_params (void);
gboolean cloth_anneal_find (const ClothAnnealParams * annealing,
    const ClothFlatParams * params, guint n_views, const ClothFlatView * views,
    const gdouble * near, ClothFlatPoses * poses, GError ** error);

G_END_DECLS
