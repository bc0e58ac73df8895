/* The experiment that would tell effects apart which a recording can't.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/design/motion.h"
#include "gst/fit/estimate/estimate.h"

G_BEGIN_DECLS

/* The expected log Bayes factor is given up to here: beyond, the linear theory means no more
 * than that the effects are told apart. Of captures that reach it the first is taken, the
 * easiest. */
#define CLOTH_EXPERIMENT_MOST_LOG_BAYES_FACTOR 100.
/* A capture that is expected to bring less is not worth filming: odds of 20 to 1. */
#define CLOTH_EXPERIMENT_LEAST_LOG_BAYES_FACTOR 3.
/* Twice the frame rate must bring so many times the log Bayes factor: it takes another camera. */
#define CLOTH_EXPERIMENT_FASTER 1.5
/* Rates above this are not doubled, and none is simulated that is higher, 1/s. */
#define CLOTH_EXPERIMENT_MOST_FPS 120.
/* Grids of more lines are simulated with so many along u and along v: twice the features'
 * waves. */
#define CLOTH_EXPERIMENT_MOST_LINES 17

/* @recording: a take: its cloth, clamps, frame rate and noise are those of the captures
 * @model: the model, with what is known to act and not in question
 * @candidates: its free numbers
 * @precisions: (array): of the free numbers
 * @discrepancy_variance: (nullable): mean squares of what the simulator itself is off by, in the
 *   noise of @recording; %NULL: nothing
 *
 * Where effects are to be told apart.
 */
typedef struct {
  const ClothRecording *recording;
  const ClothModel *model;
  const ClothCandidates *candidates;
  const gdouble *precisions;
  const ClothPowerSpectrum *discrepancy_variance;
} ClothExperiment;

/* @motion: what is filmed
 * @fps: at how many frames a second
 * @log_bayes_factor: logarithm of the Bayes factor to expect between those two of the effects
 *   that it tells apart worst; NaN: it could not be simulated
 *
 * What one capture would bring.
 */
typedef struct {
  ClothStageMotion motion;
  gdouble fps;
  gdouble log_bayes_factor;
} ClothTrial;

GArray *cloth_experiment_try (const ClothExperiment * experiment,
    const ClothModelEffect * members, guint n_members,
    ClothEstimateOptions * options, GError ** error);
const ClothTrial *cloth_experiment_choose (const GArray * trials);

G_END_DECLS
