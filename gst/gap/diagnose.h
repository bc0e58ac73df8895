/* The diagnosis: where a simulation departs from recordings, and which effect it lacks.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/gap/result.h"
#include "gst/gap/sights.h"
#include "gst/mesh/take.h"
#include "gst/sim/model.h"

G_BEGIN_DECLS

/**
 * ClothGapError:
 * @CLOTH_GAP_ERROR_TAKE: a take can't be diagnosed at all
 * @CLOTH_GAP_ERROR_EFFECT: an effect that the library doesn't have
 * @CLOTH_GAP_ERROR_MODEL: the model is impossible
 * @CLOTH_GAP_ERROR_CANCELLED: the progress function asked to stop
 *
 * Since: 0.1
 */
typedef enum {
  CLOTH_GAP_ERROR_TAKE,
  CLOTH_GAP_ERROR_EFFECT,
  CLOTH_GAP_ERROR_MODEL,
  CLOTH_GAP_ERROR_CANCELLED
} ClothGapError;

#define CLOTH_GAP_ERROR (cloth_gap_error_quark ())
GQuark cloth_gap_error_quark (void);

/**
 * ClothGapProgress:
 * @data: what cloth_gap_diagnose () was given
 * @share: of the work that is done, 0 to 1, growing
 * @what: what is being done, a few words
 *
 * Called from the thread that diagnoses.
 *
 * Returns: whether to go on
 * Since: 0.1
 */
typedef gboolean (*ClothGapProgress) (gpointer data, gdouble share,
    const gchar * what);

/**
 * ClothGapOptions:
 * @baselines: (array length=n_baselines) (nullable): takes the model is accepted on; its
 *   free parameters are fitted there and then frozen
 * @n_baselines: how many
 * @hold_outs: (array length=n_hold_outs) (nullable): takes that judge, and on which
 *   nothing is fitted
 * @n_hold_outs: how many
 * @sights: (nullable) (array): what the cameras saw of each take; %NULL: of none, or
 *   not of that one
 * @baseline_sights: (nullable) (array): the same of each baseline
 * @hold_out_sights: (nullable) (array): the same of each hold-out
 * @model_file: (nullable): the file the model comes from, for its name and hash
 * @effects: (array zero-terminated=1) (nullable): ids of the effects to consider; %NULL:
 *   all
 * @seed: of its random numbers
 * @threads: threads to use, 0 = one for each processor
 * @progress: (nullable): told how far it is
 * @progress_data: for @progress
 *
 * Since: 0.1
 */
typedef struct {
  ClothTake **baselines;
  guint n_baselines;
  ClothTake **hold_outs;
  guint n_hold_outs;
  ClothSights *const *sights;
  ClothSights *const *baseline_sights;
  ClothSights *const *hold_out_sights;
  const gchar *model_file;
  const gchar *const *effects;
  guint64 seed;
  guint threads;
  ClothGapProgress progress;
  gpointer progress_data;
} ClothGapOptions;

ClothGapResult *cloth_gap_diagnose (ClothTake ** takes, guint n_takes,
    const ClothModel * model, const ClothGapOptions * options,
    GError ** error);

G_END_DECLS
