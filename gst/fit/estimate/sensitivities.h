/* A recording under study: residuals of nudged simulations and their derivatives.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/estimate/candidates.h"
#include "gst/fit/estimate/normal.h"
#include "gst/fit/nudge/nudge.h"

G_BEGIN_DECLS

/* @gain: of the observer, 1/s². Of 100, 400, 1600 and 6400 /s² on cloth of 33 × 35 vertices
 *   weak ones drown in run-to-run variability, strong ones in noise
 * @n_waves: waves along u and v
 * @block_s: length of blocks of time, s
 * @highest_hz: of the features
 * @overdispersion: features are not independent: their squares count this much less
 * @rollout: how to simulate
 * @simulations: (inout): counts them
 */
typedef struct {
  gdouble gain;
  guint n_waves;
  gdouble block_s;
  gdouble highest_hz;
  gdouble overdispersion;
  ClothRolloutOptions rollout;
  guint64 simulations;
} ClothEstimateOptions;

/* @recording: the recording
 * @features: its features
 * @z: residual of the model at hand
 * @columns: its derivatives, [directions][features]
 * @m: number of directions
 * @sound: which of them could be simulated
 * @variability: what variability does to the residual: runs that should be equal to first order less
 *   their mean, [n_variability][features]
 * @n_variability: how many
 * @discrepancy: (nullable): the study whose residual is what the simulator itself is off
 *   by here too; the caller's
 * @left: (nullable): the power that is left to doubt; a fit weighs by it instead
 *   of by what it leaves itself
 */
typedef struct _ClothSensitivities {
  const ClothRecording *recording;
  ClothFeatures *features;
  gdouble *z;
  gdouble *columns;
  guint m;
  gboolean *sound;
  gdouble *variability;
  guint n_variability;
  const struct _ClothSensitivities *discrepancy;
  ClothPowerSpectrum *left;
} ClothSensitivities;

void cloth_estimate_options_init (ClothEstimateOptions * options);
ClothSensitivities *cloth_sensitivities_new (const ClothRecording * recording,
    const ClothEstimateOptions * options);
ClothSensitivities *cloth_sensitivities_copy (const ClothSensitivities * study,
    const ClothEstimateOptions * options);
void cloth_sensitivities_free (ClothSensitivities * study);
gdouble cloth_sensitivities_discrepancy_scale (const ClothSensitivities * study);
guint cloth_sensitivities_count_variability (const ClothSensitivities * study);
void cloth_sensitivities_get_variability (const ClothSensitivities * study,
    gdouble * columns);
gdouble cloth_sensitivities_get_variability_precision (const ClothSensitivities * study, guint i);
void cloth_sensitivities_take_off_discrepancy (const ClothSensitivities * study,
    gdouble * z);
gdouble *cloth_sensitivities_residual (const ClothSensitivities * study);
gboolean cloth_sensitivities_run (const ClothSensitivities * study, ClothModel ** models, guint n,
    ClothEstimateOptions * options, gdouble ** z, gboolean * sound,
    GError ** error);
gboolean cloth_sensitivities_linearise (ClothSensitivities * study,
    const ClothCandidates * candidates, const ClothModel * model,
    const guint * directions, guint m, ClothEstimateOptions * options,
    GError ** error);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothSensitivities, cloth_sensitivities_free)
G_END_DECLS
