/* The cloth simulator: many models of one scene at a time.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/sim/model.h"
#include "gst/sim/pull.h"
#include "gst/sim/scene.h"
#include "gst/sim/types.h"

G_BEGIN_DECLS

typedef struct _ClothSim ClothSim;

/* @CLOTH_SIM_OK: it moves
 * @CLOTH_SIM_DIVERGED: its numbers went beyond all measure; it stands where it was when
 *   cloth_sim_advance () last returned with it sound
 */
typedef enum {
  CLOTH_SIM_OK,
  CLOTH_SIM_DIVERGED
} ClothSimState;

gboolean cloth_sim_can_share (const ClothModel * a, const ClothModel * b);
ClothSim *cloth_sim_new (const ClothScene * scene,
    const ClothModel * const *models, guint n_models,
    const ClothSimOptions * options, GError ** error);
void cloth_sim_free (ClothSim * sim);
guint cloth_sim_get_n_models (const ClothSim * sim);
guint cloth_sim_get_n_vertices (const ClothSim * sim);
void cloth_sim_advance (ClothSim * sim, gdouble until_s);
gdouble cloth_sim_get_time (const ClothSim * sim);
gdouble cloth_sim_get_time_step (ClothSim * sim);
void cloth_sim_get_positions (const ClothSim * sim, guint model,
    gdouble * positions);
void cloth_sim_get_velocities (const ClothSim * sim, guint model,
    gdouble * velocities);
void cloth_sim_set_state (ClothSim * sim, guint model,
    const gdouble * positions, const gdouble * velocities, gdouble time_s);
void cloth_sim_copy_state (ClothSim * sim, guint model,
    const ClothSim * from, guint of);
ClothSimState cloth_sim_get_state (const ClothSim * sim, guint model,
    gdouble * since_s);
ClothSimEnergy cloth_sim_get_energy (const ClothSim * sim, guint model);
void cloth_sim_set_targets (ClothSim * sim, guint model, const gdouble * now,
    const gdouble * next, const gdouble * velocity_now,
    const gdouble * velocity_next, const gdouble * weights,
    const gdouble * matrices, gdouble gain, gdouble damping, gdouble t_now,
    gdouble t_next);
void cloth_sim_set_all_targets (ClothSim * sim, const gdouble * now,
    const gdouble * next, const gdouble * velocity_now,
    const gdouble * velocity_next, const gdouble * weights,
    const gdouble * matrices, const gdouble * gains, const gdouble * dampings, gdouble t_now,
    gdouble t_next);
gboolean cloth_sim_set_pulls (ClothSim * sim, const ClothPull * pulls, guint n,
    const ClothPullOptions * options, const gdouble * gains,
    const gdouble * dampings, gdouble t_now, gdouble t_next, GError ** error);
void cloth_sim_set_clamps (ClothSim * sim, guint model, const gdouble * paths);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothSim, cloth_sim_free)
G_END_DECLS
