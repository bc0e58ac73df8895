/* Residuals of nudged simulations of one recording and their derivatives.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/estimate/candidates.h"
#include "gst/fit/estimate/normal.h"
#include "gst/fit/nudge/nudge.h"

G_BEGIN_DECLS

/* @gain: of the observer, 1/s². Of 100, 400, 1600 and 6400 /s² on cloth of 33 × 35 vertices
 *   weak ones drown in run-to-run variability, strong ones in noise
 * @window_s: 0: the residual is that of a simulation that is nudged all along; else of one that is
 *   let go in windows of this length, s, for which nothing may be wrong with the recording
 * @n_waves: waves along u and v
 * @block_s: length of blocks of time, s
 * @highest_hz: of the features
 * @overdispersion: features are not independent: their squares count this much less
 * @rollout: how to simulate
 * @simulations: (inout): counts them
 */
typedef struct {
  gdouble gain;
  gdouble window_s;
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
 * @variability: run-to-run variability of the residual: runs that should be equal to first
 *   order less their mean, [n_variability][features]
 * @n_variability: how many
 * @discrepancy: (nullable): those of a recording whose residual is the simulator's own
 *   error here too; the caller's
 * @residual_variance: (nullable): variance of the features beside that of noise, class by
 *   class, that a fit weighs by; %NULL: the power that the fit itself leaves
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
  ClothPowerSpectrum *residual_variance;
} ClothSensitivities;

void cloth_estimate_options_init (ClothEstimateOptions * options);
ClothSensitivities *cloth_sensitivities_new (const ClothRecording * recording,
    const ClothEstimateOptions * options);
ClothSensitivities *cloth_sensitivities_copy (const ClothSensitivities * sensitivities,
    const ClothEstimateOptions * options);
void cloth_sensitivities_free (ClothSensitivities * sensitivities);
gdouble cloth_sensitivities_discrepancy_scale (const ClothSensitivities * sensitivities);
guint cloth_sensitivities_count_variability (const ClothSensitivities * sensitivities);
void cloth_sensitivities_get_variability (const ClothSensitivities * sensitivities,
    gdouble * columns);
gdouble cloth_sensitivities_get_variability_precision (const ClothSensitivities * sensitivities, guint i);
void cloth_sensitivities_take_off_discrepancy (const ClothSensitivities * sensitivities,
    gdouble * z);
gdouble *cloth_sensitivities_residual (const ClothSensitivities * sensitivities);
gboolean cloth_sensitivities_run (const ClothSensitivities * sensitivities,
    ClothModel ** models, guint n,
    ClothEstimateOptions * options, gdouble ** z, gboolean * sound,
    GError ** error);
gboolean cloth_sensitivities_linearise (ClothSensitivities * sensitivities,
    const ClothCandidates * candidates, const ClothModel * model,
    const guint * directions, guint m, ClothEstimateOptions * options,
    GError ** error);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothSensitivities, cloth_sensitivities_free)
G_END_DECLS
