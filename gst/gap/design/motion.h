/* Motions and conditions in which a cloth could be filmed next, as scenes.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/fit/recording/recording.h"

G_BEGIN_DECLS

/* @CLOTH_MOTION_HANG: it hangs still
 * @CLOTH_MOTION_SWAY: the clamps sway slowly, out of the sheet's plane
 * @CLOTH_MOTION_SWING: they swing from side to side, in the sheet's plane
 * @CLOTH_MOTION_LIFT: they go up and down
 * @CLOTH_MOTION_SHAKE: they shake fast, out of the sheet's plane
 * @CLOTH_MOTION_TURN: it hangs still, turned by 90° about the vertical
 * @CLOTH_MOTION_EDGE: it hangs still from its side edge: turned by 90° in its plane
 * @CLOTH_MOTION_DROP: one clamp lets go
 * @CLOTH_MOTION_FAN_OFF: it hangs still, and whatever wind there was is kept off
 * @CLOTH_MOTION_FAN_ON: it hangs still before a fan
 * @CLOTH_N_MOTIONS: how many there are
 *
 * From the easiest to film to the hardest.
 */
typedef enum {
  CLOTH_MOTION_HANG,
  CLOTH_MOTION_SWAY,
  CLOTH_MOTION_SWING,
  CLOTH_MOTION_LIFT,
  CLOTH_MOTION_SHAKE,
  CLOTH_MOTION_TURN,
  CLOTH_MOTION_EDGE,
  CLOTH_MOTION_DROP,
  CLOTH_MOTION_FAN_OFF,
  CLOTH_MOTION_FAN_ON,
  CLOTH_N_MOTIONS
} ClothStageMotion;

/* How long each is filmed, s. */
#define CLOTH_MOTION_SECONDS 2.
/* Speed of the fan's wind, m/s, horizontal and orthogonal to the sheet. */
#define CLOTH_MOTION_FAN_M_S 2.

/* @recording: the take whose cloth and clamps it has
 * @frame: of the take: from here on it is set up
 * @held: (element-type guint): vertices that are held there
 * @clamps: where, [held][3], m
 * @centre: their mean
 * @up: against gravity
 * @along: horizontal, from clamp to clamp
 * @normal: horizontal, orthogonal to the sheet
 * @size_m: longest side of the flat cloth
 *
 * What all motions of one cloth share.
 */
typedef struct {
  const ClothRecording *recording;
  guint frame;
  GArray *held;
  gdouble *clamps;
  gdouble centre[3];
  gdouble up[3];
  gdouble along[3];
  gdouble normal[3];
  gdouble size_m;
} ClothStage;

ClothStage *cloth_stage_new (const ClothRecording * recording);
void cloth_stage_free (ClothStage * stage);
gboolean cloth_stage_allows (const ClothStage * stage, ClothStageMotion motion);
ClothScene *cloth_stage_make_scene (const ClothStage * stage,
    ClothStageMotion motion, gdouble fps, gdouble seconds, const gdouble * start);
gchar *cloth_stage_describe (const ClothStage * stage, ClothStageMotion motion);

G_DEFINE_AUTOPTR_CLEANUP_FUNC (ClothStage, cloth_stage_free)
G_END_DECLS
