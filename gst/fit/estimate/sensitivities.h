/* A recording under study: residuals of nudged simulations and their derivatives.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/estimate/candidates.h"
#include "gst/fit/estimate/normal.h"
#include "gst/fit/nudge/rollout.h"

G_BEGIN_DECLS

/* Gains of the observer. One is enough: of 100, 400, 1600 and 6400 /s² on cloth of 33 × 35
 * vertices weak ones drown in chaos, strong ones in noise. */
#define CLOTH_STUDY_N_GAINS 1

/**
 * ClothStudyOptions:
 * @gains: of the observer, 1/s²
 * @n_waves: waves along u and v
 * @block_s: length of blocks of time, s
 * @highest_hz: of the features
 * @overdispersion: features are not independent: their squares count this much less
 * @rollout: how to simulate
 * @simulations: (inout): counts them
 *
 * Since: 0.1
 */
typedef struct {
  gdouble gains[CLOTH_STUDY_N_GAINS];
  guint n_waves;
  gdouble block_s;
  gdouble highest_hz;
  gdouble overdispersion;
  ClothRolloutOptions rollout;
  guint64 simulations;
} ClothStudyOptions;

/**
 * ClothStudy:
 * @recording: the recording
 * @features: its features
 * @z: residual of the model at hand, per gain
 * @columns: its derivatives, [directions][features], per gain
 * @m: number of directions
 * @sound: which of them could be simulated
 * @chaos: what chaos does to the residual: runs that should be equal to first order less
 *   their mean, [n_chaos][features], per gain
 * @n_chaos: how many
 * @signature: (nullable): the study whose residual is what the simulator itself is off
 *   by here too; the caller's
 * @left: (nullable): the power that is left to doubt, per gain; a fit weighs by it instead
 *   of by what it leaves itself
 *
 * Since: 0.1
 */
typedef struct _ClothStudy {
  const ClothRecording *recording;
  ClothGapFeatures *features;
  gdouble *z[CLOTH_STUDY_N_GAINS];
  gdouble *columns[CLOTH_STUDY_N_GAINS];
  guint m;
  gboolean *sound;
  gdouble *chaos[CLOTH_STUDY_N_GAINS];
  guint n_chaos;
  const struct _ClothStudy *signature;
  ClothGapPower *left[CLOTH_STUDY_N_GAINS];
} ClothStudy;

void cloth_study_options_init (ClothStudyOptions * options);
ClothStudy *cloth_study_new (const ClothRecording * recording,
    const ClothStudyOptions * options);
ClothStudy *cloth_study_copy (const ClothStudy * study,
    const ClothStudyOptions * options);
void cloth_study_free (ClothStudy * study);
gdouble cloth_study_signature_scale (const ClothStudy * study);
guint cloth_study_count_chaos (const ClothStudy * study);
void cloth_study_get_chaos (const ClothStudy * study, guint gain,
    gdouble * columns);
gdouble cloth_study_get_chaos_precision (const ClothStudy * study, guint i);
void cloth_study_take_off_signature (const ClothStudy * study, guint gain,
    gdouble * z);
gdouble *cloth_study_residual (const ClothStudy * study, guint gain);
gboolean cloth_study_run (const ClothStudy * study, ClothModel ** models, guint n,
    ClothStudyOptions * options, gdouble ** z, gboolean * sound,
    GError ** error);
gboolean cloth_study_linearise (ClothStudy * study,
    const ClothGapCandidates * candidates, const ClothModel * model,
    const guint * directions, guint m, ClothStudyOptions * options,
    GError ** error);
ClothModel *cloth_study_fit (ClothStudy ** studies, guint n_studies,
    const ClothGapCandidates * candidates, const ClothModel * model,
    const guint * directions, const gdouble * precisions, guint m,
    const gboolean * blocks, gboolean even, gboolean begun, guint n_passes,
    ClothStudyOptions * options, gdouble * sigmas, GError ** error);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothStudy, cloth_study_free)
G_END_DECLS
