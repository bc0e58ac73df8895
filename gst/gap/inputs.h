/* What a diagnosis is given, and what every caller checks of it first: the names of effects as
 * people type them, and that two cloths are the same one.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/recording/recording.h"
#include "gst/mesh/topology.h"
#include "gst/sim/model.h"
#include "gst/take/take.h"

G_BEGIN_DECLS

/* A user's own simulator: gst/gap/simulator/simulator.h. */
typedef struct _ClothGapSimulator ClothGapSimulator;

/* Most runs of a user's simulator of each take, after the first, that find its numbers: for one
 * effect of one number two or three do, the others are for the base numbers. */
#define CLOTH_GAP_SIMULATOR_RUNS 20

/* @data: what cloth_gap_diagnose () was given
 * @share: of the work that is done, 0 to 1, growing
 * @what: what is being done, a few words
 *
 * Called from the thread that diagnoses.
 *
 * Returns: whether to go on
 */
typedef gboolean (*ClothGapProgress) (gpointer data, gdouble share,
    const gchar * what);

/* @baselines: (array length=n_baselines) (nullable): takes the model is accepted on; its
 *   free parameters are fitted there and then frozen
 * @n_baselines: how many
 * @hold_outs: (array length=n_hold_outs) (nullable): takes that judge, and on which
 *   nothing is fitted
 * @n_hold_outs: how many
 * @simulated: (array length=n_simulated) (nullable): what the user's simulator made of each take,
 *   then of each hold-out, its twins: the gap is recorded less simulated
 * @n_simulated: how many: of all or of none
 * @after: (array length=n_after) (nullable): the same with the effect added, of each hold-out,
 *   without any of each take
 * @n_after: how many: of all or of none; none without twins
 * @simulator: (nullable): the user's simulator, to make @simulated and @after itself and to find
 *   its numbers; then neither is given
 * @simulator_runs: at most so many runs of each take to find these
 * @observations: (nullable) (array): what the cameras saw of each take; %NULL: of none, or
 *   not of that one
 * @baseline_observations: (nullable) (array): the same of each baseline
 * @hold_out_observations: (nullable) (array): the same of each hold-out
 * @model_file: (nullable): the file the model comes from, for its name and hash
 * @effects: (array zero-terminated=1) (nullable): ids of the effects to consider; %NULL:
 *   all
 * @seed: of its random numbers
 * @threads: threads to use, 0 = one for each processor
 * @progress: (nullable): called with how far it is
 * @progress_data: for @progress
 */
typedef struct {
  ClothTake **baselines;
  guint n_baselines;
  ClothTake **hold_outs;
  guint n_hold_outs;
  ClothTake **simulated;
  guint n_simulated;
  ClothTake **after;
  guint n_after;
  ClothGapSimulator *simulator;
  guint simulator_runs;
  ClothObservations *const *observations;
  ClothObservations *const *baseline_observations;
  ClothObservations *const *hold_out_observations;
  const gchar *model_file;
  const gchar *const *effects;
  guint64 seed;
  guint threads;
  ClothGapProgress progress;
  gpointer progress_data;
} ClothGapOptions;

gchar **cloth_gap_effects_parse (const gchar * list, GError ** error);
gboolean cloth_gap_check_same_cloth (const gchar * name,
    const ClothTopology * cloth, const gchar * other_name,
    const ClothTopology * other, GError ** error);

G_END_DECLS
