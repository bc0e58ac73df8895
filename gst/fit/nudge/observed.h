/* A recording made of what cameras saw, without a mesh.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/nudge/rollout.h"
#include "gst/fit/recording/recording.h"

G_BEGIN_DECLS

/* @places: vertices times frames
 * @triangulated: of them those whose rays meet
 * @single: those of which only the place across one camera's ray is known: others did not see
 *   them, or along nearly the same line
 * @contradicted: those that the cameras contradict each other about; they count as not seen
 * @outlined: those that no camera located, but that lie on the outline of a silhouette
 * @torn: those that no cloth can be at, with the others where they are; they count as not seen
 * @along: of the motion of the single ones the share, of its mean square, that lies along their
 *   rays and is the model's own
 * @error_floor: variance that was added to each observation, px², as the cameras agree
 */
typedef struct {
  gsize places;
  gsize triangulated;
  gsize single;
  gsize contradicted;
  gsize outlined;
  gsize torn;
  gdouble along;
  gdouble error_floor;
} ClothObservedCounts;

ClothRecording *cloth_recording_new_observed (ClothTake * take,
    const ClothObservations * observations, const ClothModel * model,
    gdouble gain, const ClothRolloutOptions * options,
    ClothObservedCounts * counts, GError ** error);

G_END_DECLS
