/* A simulation that follows a recording by weak springs, frame by frame: where they
 * part, as it is filmed.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/recording/recording.h"
#include "gst/sim/model.h"
#include "gst/sim/scene.h"

G_BEGIN_DECLS

/* A frame's residual is known once this many later frames are. */
#define CLOTH_OBSERVER_LATENCY 3

typedef struct _ClothObserver ClothObserver;

/* @gain: g of the springs, 1/s² (100)
 * @damping_ratio: ζ of the springs, 1 = critically damped (0.5)
 * @window_s: length of a scored window, seconds (0.3)
 * @seed: of what is random in effects
 * @threads: threads to use, 0 = one for each processor
 * @stop: (nullable): atomic: as soon as it isn't 0, cloth_observer_pop () fails
 */
typedef struct {
  gdouble gain;
  gdouble damping_ratio;
  gdouble window_s;
  guint64 seed;
  guint threads;
  const gint *stop;
} ClothObserverOptions;

/* @from_s: when the window begins, seconds
 * @to_s: time of its last frame
 * @rms: distance of recorded and simulated, RMS over what was seen, metres; NaN when
 *   nothing was. Of rays it is that across them
 * @coverage: share of the vertices that were seen
 *
 * The gap of one window: the simulation starts where the springs have brought it and
 * then runs free.
 */
typedef struct {
  gdouble from_s;
  gdouble to_s;
  gdouble rms;
  gdouble coverage;
} ClothObserverScore;

ClothObserver *cloth_observer_new (const ClothScene * scene,
    const ClothModel * model, const ClothObserverOptions * options,
    GError ** error);
void cloth_observer_restart (ClothObserver * observer);
void cloth_observer_push (ClothObserver * observer, gdouble time_s,
    const gfloat * positions, gdouble sigma_m);
void cloth_observer_push_rays (ClothObserver * observer, gdouble time_s,
    const ClothRays * rays);
void cloth_observer_push_both (ClothObserver * observer, gdouble time_s,
    const gfloat * positions, gdouble sigma_m, const ClothRays * rays);
guint cloth_observer_get_n_waiting (const ClothObserver * observer);
gboolean cloth_observer_pop (ClothObserver * observer, gfloat * residuals,
    GError ** error);
void cloth_observer_get_drawn (const ClothObserver * observer,
    gfloat * positions);
void cloth_observer_get_lifted (const ClothObserver * observer,
    gfloat * positions, gfloat * sigmas);
gboolean cloth_observer_take_score (ClothObserver * observer, gboolean last,
    ClothObserverScore * score);
void cloth_observer_free (ClothObserver * observer);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothObserver, cloth_observer_free)
G_END_DECLS
