/* Simulations of a recorded scene, drawn to the recording or let go.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/features/features.h"
#include "gst/sim/sim.h"

G_BEGIN_DECLS

/* @data: the caller's
 * @share: of the frames that are done
 *
 * Returns: whether to go on
 */
typedef gboolean (*ClothRolloutProgress) (gpointer data, gdouble share);

/* @data: the caller's
 * @recording: whose scene was simulated
 * @model: a model whose simulation diverged
 * @sound_s: when it was sound for the last time, in the recording's time
 */
typedef void (*ClothRolloutFailed) (gpointer data,
    const ClothRecording * recording, const ClothModel * model,
    gdouble sound_s);

/* @seed: of effects with chance in them
 * @threads: 0 = one for each processor
 * @progress: (nullable): told of each frame
 * @failed: (nullable): told of each model that diverged, once, in their order
 * @data: for @progress and @failed
 */
typedef struct {
  guint64 seed;
  guint threads;
  ClothRolloutProgress progress;
  ClothRolloutFailed failed;
  gpointer data;
} ClothRolloutOptions;

/* @data: the caller's
 * @model: which model
 * @frame: which frame
 * @positions: where the model has the vertices, [n][3], m
 *
 * Called from several threads at a time, of different models.
 */
typedef void (*ClothRolloutFrame) (gpointer data, guint model, guint frame,
    const gdouble * positions);

gboolean cloth_rollout_nudged (const ClothRecording * const *targets,
    const ClothModel * const *models, const gdouble * gains, guint n_models,
    const ClothRolloutOptions * options, ClothRolloutFrame on_frame,
    gpointer data, gboolean * sound, GError ** error);
gboolean cloth_rollout_follow (const ClothRecording * const *targets, guint n,
    const ClothModel * model, gdouble gain,
    const ClothRolloutOptions * options, gdouble * paths, gboolean * sound,
    GError ** error);
gboolean cloth_rollout_led (const ClothRecording * recording,
    const ClothModel * const *models, const gdouble * gains, guint n_models,
    gdouble lead_s, const ClothRolloutOptions * options,
    ClothRolloutFrame on_frame, gpointer data, gboolean * sound, GError ** error);
guint cloth_rollout_count_led (const ClothRecording * recording,
    gdouble lead_s);
gboolean cloth_rollout_free (const ClothRecording * recording,
    const ClothModel * const *models, guint n_models,
    const ClothRolloutOptions * options, ClothRolloutFrame on_frame,
    gpointer data, gboolean * sound, GError ** error);
gboolean cloth_rollout_windows (const ClothRecording * const *targets,
    const ClothModel * const *models, guint n_models, gdouble gain,
    gdouble window_s, const ClothRolloutOptions * options,
    ClothRolloutFrame on_frame, gpointer data, gboolean * sound, GError ** error);
guint *cloth_rollout_list_windows (const ClothRecording * recording,
    gdouble window_s);

/* Damping of the observer's springs: 2 ζ √gain. */
#define CLOTH_ROLLOUT_ZETA 0.5

G_END_DECLS
