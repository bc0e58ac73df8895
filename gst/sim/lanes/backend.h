/* What sim.c and group.c call of each variant of the lanes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/sim/body.h"
#include "gst/sim/model.h"
#include "gst/sim/pull.h"
#include "gst/sim/types.h"

G_BEGIN_DECLS

/* What an effect of one model costs all models of its group: nothing when it only changes
 * numbers or the clamps, little when it finds forces of its own, much when forces take
 * more than one pass. */
typedef enum
{
  CLOTH_LANE_COST_NONE,
  CLOTH_LANE_COST_LOW,
  CLOTH_LANE_COST_HIGH
} ClothLaneCost;

/* Arrays are by particle, 3 numbers each. A group is n_lanes models; lanes beyond those
 * given repeat the first. */
typedef struct
{
  guint n_lanes;
  ClothLaneCost (*cost) (const ClothEffect * effect);
  gpointer (*group_new) (const ClothBody * body,
      const ClothModel * const *models, guint n_models, guint64 seed);
  void (*group_free) (gpointer group);
  /* finds out how stiff the cloth is as it is stretched now */
  void (*strain) (gpointer group);
  /* the largest step, at most @longest, of so many stages that is stable in all lanes, with its margin: of the cloth at
   * rest, or @strained as it was found to be */
  gdouble (*time_step) (gpointer group, guint stages, gdouble longest,
      gboolean strained);
  /* the whole group to a time in so many equal steps, each of so many stages */
  void (*advance) (gpointer group, gdouble until_s, guint n_steps,
      guint stages);
  /* an implicit step to a time: solves it and returns by how much it is too long, at most
   * 1 when it is not; then takes it */
  gdouble (*try_step) (gpointer group, gdouble until_s);
  void (*take_step) (gpointer group, gdouble until_s);
  void (*get) (gpointer group, guint lane, gdouble * x, gdouble * v);
  /* how long before the places the velocities are, s */
  gdouble (*lag) (gpointer group, guint lane);
  void (*set) (gpointer group, guint lane, const gdouble * x,
      const gdouble * v, gdouble lag_s);
  void (*set_time) (gpointer group, gdouble time_s);
  /* of @n lanes from @lane on; y: now, next, velocity now, velocity next; @matrices:
   * (nullable): instead of weights */
  void (*set_targets) (gpointer group, guint lane, guint n,
      const gdouble * const y[4], const gdouble * weights,
      const gdouble * matrices,
      const gdouble * gains, const gdouble * dampings, gdouble t_now,
      gdouble t_next);
  /* the same pulls in all lanes; their corners are particles, all alike of a pull at one.
   * The gains and dampings are of the group's models. Returns whether the bound of the time
   * step may be another one */
  gboolean (*set_pulls) (gpointer group, const ClothPull * pulls, guint n,
      const ClothPullOptions * options, const gdouble * gains,
      const gdouble * dampings, gdouble t_now, gdouble t_next);
  /* where a lane's clamps go, [frame][held][3]; NULL: where the body says */
  void (*set_paths) (gpointer group, guint lane, const gdouble * paths);
  /* since when the lane stands still, NaN when it moves */
  gdouble (*diverged) (gpointer group, guint lane);
  ClothSimEnergy (*energy) (gpointer group, guint lane);
} ClothLaneBackend;

G_END_DECLS
