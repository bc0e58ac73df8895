/* Least squares where the residual is no linear function of the unknowns.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/estimate/posterior.h"
#include "gst/fit/estimate/sensitivities.h"

G_BEGIN_DECLS

/* @linearise: finds the residual and its derivatives at the place at hand. A failure with
 *   %CLOTH_FIT_ERROR_MODEL says that the place can't be simulated
 * @accept: the place at hand is better than those before: it is to be kept, and the weights
 *   are to be those of the residual there
 * @add_data: adds the normal equations there to the posterior (%NULL: to none) and returns
 *   the cost zᵀWz
 * @move: goes @share of the @step from the place at hand, as far as bounds allow, and adds
 *   what it went to @moved
 * @restore: the place at hand is the last one that was accepted
 *
 * What is to be fitted, as functions of the caller's data.
 */
typedef struct {
  gboolean (*linearise) (gpointer data, GError ** error);
  void (*accept) (gpointer data);
  gdouble (*add_data) (gpointer data, ClothPosterior * posterior);
  void (*move) (gpointer data, const gdouble * step, gdouble share,
      gdouble * moved);
  void (*restore) (gpointer data);
} ClothGaussNewtonProblem;

/* No step of a fit is longer than this many priors. */
#define CLOTH_GAUSS_NEWTON_LONGEST_STEP 1.5
/* A step that made things worse is cut to this share. */
#define CLOTH_GAUSS_NEWTON_CUT 0.4

/* @m: number of unknowns
 * @precisions: (array length=m): of their priors, centred at the start
 * @longest: (array length=m): no step is longer than this
 * @overdispersion: features are not independent: their squares count this much less
 * @n_passes: at most so many linearisations
 * @is_linearised: the residual and its derivatives at the start are there already
 */
typedef struct {
  guint m;
  const gdouble *precisions;
  const gdouble *longest;
  gdouble overdispersion;
  guint n_passes;
  gboolean is_linearised;
} ClothGaussNewtonOptions;

/* CLOTH_FIT_EQUAL_WEIGHTS: all features weigh alike. That brings the cloth nearest, where
 *   the model can't follow it; else what is left counts as noise, class by class
 * CLOTH_FIT_IS_LINEARISED: the sensitivities are those at the start, along the directions
 */
typedef enum {
  CLOTH_FIT_DEFAULT = 0,
  CLOTH_FIT_EQUAL_WEIGHTS = 1 << 0,
  CLOTH_FIT_IS_LINEARISED = 1 << 1,
} ClothFitFlags;

gboolean cloth_gauss_newton_run (const ClothGaussNewtonProblem * problem,
    gpointer data, const ClothGaussNewtonOptions * options, gdouble * sigmas,
    GError ** error);
ClothModel *cloth_gauss_newton_fit (ClothSensitivities ** sensitivities,
    guint n, const ClothCandidates * candidates, const ClothModel * model,
    const guint * directions, const gdouble * precisions, guint m,
    const gboolean * blocks, ClothFitFlags flags, guint n_passes,
    ClothEstimateOptions * options, gdouble * sigmas, GError ** error);

G_END_DECLS
