/* Points that move: where each was at any time between the frames.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <glib.h>

G_BEGIN_DECLS

/* @n_points: points of a frame
 * @n_frames: frames, >= 1
 * @times: (array length=n_frames): time of each frame, s, rising
 * @positions: (array length=n_frames): of each frame @n_points times x, y, z, metres;
 *   NaN where a point isn't known
 *
 * A stretch of a recording or simulation; owns nothing.
 */
typedef struct {
  guint n_points;
  guint n_frames;
  const gdouble *times;
  const gdouble *const *positions;
} ClothMotion;

void cloth_motion_at (const ClothMotion * motion, guint point, gdouble time_s,
    gdouble position[3], gdouble * velocity);

G_END_DECLS
