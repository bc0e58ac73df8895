/* Points that move: where each was at any time between the frames.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/rig/motion.h"

#include <math.h>

static const gdouble *
point_at (const ClothMotion * motion, guint frame, guint point)
{
  return motion->positions[frame] + 3 * (gsize) point;
}

/* Slope at a frame: of the parabola through it and its two neighbours; of the straight
 * line to the only one that there is. */
static void
slope_at (const ClothMotion * motion, guint frame, guint point,
    gdouble slope[3])
{
  const gdouble *now = point_at (motion, frame, point);
  const gdouble *sides[2] = { NULL, NULL };
  gdouble step[2] = { 0, 0 };

  if (frame > 0) {
    sides[0] = point_at (motion, frame - 1, point);
    step[0] = motion->times[frame] - motion->times[frame - 1];
  }
  if (frame + 1 < motion->n_frames) {
    sides[1] = point_at (motion, frame + 1, point);
    step[1] = motion->times[frame + 1] - motion->times[frame];
  }
  for (gint i = 0; i < 2; i++)
    if (sides[i] && isnan (sides[i][0] + sides[i][1] + sides[i][2]))
      sides[i] = NULL;
  for (gint k = 0; k < 3; k++) {
    gdouble before = sides[0] ? (now[k] - sides[0][k]) / step[0] : 0;
    gdouble after = sides[1] ? (sides[1][k] - now[k]) / step[1] : 0;

    if (sides[0] && sides[1])
      slope[k] = (step[1] * before + step[0] * after) / (step[0] + step[1]);
    else
      slope[k] = before + after;
  }
}

/* @motion: the frames
 * @point: which point
 * @time_s: when
 * @position: (out caller-allocates): metres; NaN when not known
 * @velocity: (nullable) (out caller-allocates): 3 numbers, m/s
 *
 * Between frames, cubic Hermite interpolation whose slopes are those of the parabola
 * through a frame and its neighbours (Catmull and Rom 1974, for any spacing): exact for
 * parabolas but in the first and last interval, exact to the bit at the frames. Before
 * the first and behind the last frame the point goes on straight.
 */
void
cloth_motion_at (const ClothMotion * motion, guint point, gdouble time_s,
    gdouble position[3], gdouble * velocity)
{
  const gdouble *times = motion->times;
  guint low = 0, high = motion->n_frames;
  const gdouble *a, *b;
  gdouble slope_a[3], slope_b[3], h, s;

  /* The last frame that is not later. */
  while (high - low > 1) {
    guint middle = (low + high) / 2;

    if (times[middle] <= time_s)
      low = middle;
    else
      high = middle;
  }
  a = point_at (motion, low, point);
  slope_at (motion, low, point, slope_a);
  if (low + 1 == motion->n_frames || time_s <= times[low]) {
    const gdouble off = time_s - times[low];

    for (gint k = 0; k < 3; k++) {
      position[k] = off == 0 ? a[k] : a[k] + off * slope_a[k];
      if (velocity)
        velocity[k] = slope_a[k];
    }
    return;
  }
  b = point_at (motion, low + 1, point);
  slope_at (motion, low + 1, point, slope_b);
  h = times[low + 1] - times[low];
  s = (time_s - times[low]) / h;
  for (gint k = 0; k < 3; k++) {
    const gdouble d = b[k] - a[k];
    const gdouble c2 = 3 * d - h * (2 * slope_a[k] + slope_b[k]);
    const gdouble c3 = h * (slope_a[k] + slope_b[k]) - 2 * d;

    position[k] = a[k] + s * (h * slope_a[k] + s * (c2 + s * c3));
    if (velocity)
      velocity[k] = slope_a[k] + s * (2 * c2 + s * 3 * c3) / h;
  }
}
