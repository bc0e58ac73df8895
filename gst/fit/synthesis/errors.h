/* How far off fitted numbers are.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/estimate/estimate.h"
#include "gst/fit/nudge/nudge.h"

G_BEGIN_DECLS

/* Of a fitted number, where the logarithm of what is positive by its nature stands for it.
 *
 * @sigma: standard deviation of the fitted number, as the model's mesh has it; NaN: not known
 * @finer: what it is on a mesh twice as fine; NaN: not known
 * @finer_sigma: standard deviation of that, as the cloth has it, whatever the mesh
 */
typedef struct {
  gdouble sigma;
  gdouble finer, finer_sigma;
} ClothSynthesisError;

gboolean cloth_synthesis_straighten (ClothRecording ** recordings, guint n,
    const ClothModel * model, gdouble gain, const ClothRolloutOptions * rollout,
    GError ** error);
gboolean cloth_synthesis_find_errors (ClothRecording ** recordings, guint n,
    const ClothCandidates * candidates, const ClothModel * model,
    ClothEstimateOptions * options, ClothSynthesisError * errors,
    GError ** error);

G_END_DECLS
