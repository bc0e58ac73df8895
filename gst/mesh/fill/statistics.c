/* How sure a filled vertex is: what the surroundings of a hole say of its shape, of how
 * long it lasts, and what the past says of motion.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/mesh/fill/fill-private.h"

#include <math.h>
#include <string.h>

#include "gst/math/linalg.h"

/* Fewer second differences than this say nothing. */
#define LEAST_STENCILS 8
/* What is left of a variance when the noise alone explains it. */
#define LEAST_SIGNAL 0.05
/* Points that a frame's motion is taken from, about. */
#define MOTION_POINTS 500
/* The most lags that fit three times into the memory. */
#define LONGEST_MOTION (CLOTH_FILL_HISTORY / 3 - 1)

static void
add_product (gdouble sum[6], const gdouble v[3])
{
  sum[0] += v[0] * v[0];
  sum[1] += v[0] * v[1];
  sum[2] += v[0] * v[2];
  sum[3] += v[1] * v[1];
  sum[4] += v[1] * v[2];
  sum[5] += v[2] * v[2];
}

/* @from: places before, 3 a vertex of the mesh
 * @to: places after
 * @n: number of vertices to look at
 * @vertices: those
 * @rotation: (out): rotation that takes the ones to the others best
 * @shift: (out): what is added after it
 *
 * Returns: %FALSE when fewer than three were seen in both or they leave the rotation open;
 *   @rotation is 1 then and @shift the mean shift, 0 when none was seen in both
 */
gboolean
cloth_fill_align (const gfloat * from, const gfloat * to, guint n,
    const guint * vertices, gdouble rotation[9], gdouble shift[3])
{
  static const gdouble unit[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1 };
  gdouble mean[2][3] = { {0,}, }, a[9] = { 0, }, turned[3];
  guint seen = 0;
  gboolean found = FALSE;

  for (guint i = 0; i < n; i++) {
    const gfloat *p = from + 3 * (gsize) vertices[i];
    const gfloat *q = to + 3 * (gsize) vertices[i];

    if (isnan (p[0]) || isnan (q[0]))
      continue;
    seen++;
    for (guint c = 0; c < 3; c++) {
      mean[0][c] += p[c];
      mean[1][c] += q[c];
    }
  }
  for (guint c = 0; c < 3; c++) {
    mean[0][c] /= MAX (seen, 1);
    mean[1][c] /= MAX (seen, 1);
  }
  for (guint i = 0; i < n && seen >= 3; i++) {
    const gfloat *p = from + 3 * (gsize) vertices[i];
    const gfloat *q = to + 3 * (gsize) vertices[i];

    if (isnan (p[0]) || isnan (q[0]))
      continue;
    for (guint r = 0; r < 3; r++)
      for (guint c = 0; c < 3; c++)
        a[3 * r + c] += (q[r] - mean[1][r]) * (p[c] - mean[0][c]);
  }
  found = seen >= 3 && cloth_mat3_nearest_rotation (a, rotation);
  if (!found)
    memcpy (rotation, unit, sizeof unit);
  cloth_mat3_vec (rotation, mean[0], turned);
  for (guint c = 0; c < 3; c++)
    shift[c] = mean[1][c] - turned[c];
  return found;
}

/* @self: the frame
 * @hole: a hole
 * @shape: (out): how bent the cloth is around it; 0 stencils when that is not known
 */
void
cloth_fill_shape (const ClothFill * self, const ClothHole * hole,
    ClothFillShape * shape)
{
  gdouble noise = 0, weights = 0, raw, left;
  guint seen = 0;

  memset (shape, 0, sizeof *shape);
  for (guint i = 0; i < hole->n_region; i++) {
    guint v = hole->region[i];

    if (isnan (self->measured[3 * v]))
      continue;
    for (guint c = 0; c < 6; c++)
      shape->noise[c] += self->noise[6 * v + c];
    seen++;
  }
  for (guint c = 0; c < 6; c++)
    shape->noise[c] /= MAX (seen, 1);
  for (guint i = 0; i < hole->n_around; i++) {
    const ClothStencil *stencil = &self->stencils->stencils[hole->around[i]];
    gdouble value[3];

    cloth_stencil_apply (stencil, self->measured, value);
    if (isnan (value[0]))
      continue;
    add_product (shape->covariance, value);
    for (guint k = 0; k < CLOTH_STENCIL_SIZE; k++)
      weights += (gdouble) stencil->weight[k] * stencil->weight[k];
    shape->n++;
  }
  if (shape->n < LEAST_STENCILS) {
    shape->n = 0;
    return;
  }
  noise = weights * cloth_fill_trace (shape->noise);
  raw = cloth_fill_trace (shape->covariance);
  left = raw > 0 ? fmax (1 - noise / raw, LEAST_SIGNAL) : 0;
  for (guint c = 0; c < 6; c++)
    shape->covariance[c] *= left / shape->n;
}

/* The mean square of what second differences around @hole changed in @lag frames, but
 * for the turn of the cloth there; noise taken off. Negative when not known. */
static gdouble
change (const ClothFill * self, const ClothHole * hole,
    const ClothFillShape * shape, guint lag)
{
  const gfloat *past = cloth_fill_past (self, lag);
  gdouble rotation[9], shift[3], sum = 0, weights = 0;
  guint n = 0;

  if (!past || !cloth_fill_align (past, self->measured, hole->n_region,
          hole->region, rotation, shift))
    return -1;
  for (guint i = 0; i < hole->n_around; i++) {
    const ClothStencil *stencil = &self->stencils->stencils[hole->around[i]];
    gdouble now[3], before[3], turned[3];

    cloth_stencil_apply (stencil, self->measured, now);
    cloth_stencil_apply (stencil, past, before);
    if (isnan (now[0]) || isnan (before[0]))
      continue;
    cloth_mat3_vec (rotation, before, turned);
    for (guint c = 0; c < 3; c++)
      sum += (now[c] - turned[c]) * (now[c] - turned[c]);
    for (guint k = 0; k < CLOTH_STENCIL_SIZE; k++)
      weights += (gdouble) stencil->weight[k] * stencil->weight[k];
    n++;
  }
  if (n < LEAST_STENCILS)
    return -1;
  return fmax (sum - 2 * weights * cloth_fill_trace (shape->noise),
      LEAST_SIGNAL * sum) / n;
}

/* @self: the frame
 * @hole: a hole
 * @shape: how bent the cloth is around it
 * @age: frames
 *
 * Second differences ρ-correlated over @age frames change by 2 (1 − ρ) times their variance
 * in mean square. Solved for ρ: it tells which part of the shape that was seen @age
 * frames ago is still there.
 *
 * Returns: ρ, 0 to 1; 0 when the past says nothing
 */
gdouble
cloth_fill_persistence (const ClothFill * self, const ClothHole * hole,
    const ClothFillShape * shape, guint age)
{
  gdouble variance = cloth_fill_trace (shape->covariance);
  guint lag = 1;

  if (age == CLOTH_FILL_NEVER || shape->n == 0 || !(variance > 0))
    return 0;
  while (2 * lag <= age && 2 * lag < self->depth)
    lag *= 2;
  for (; lag > 0; lag /= 2) {
    gdouble moved = change (self, hole, shape, lag);

    if (moved < 0)
      continue;
    /* cloth in motion changes in proportion to the time */
    moved *= ((gdouble) age / lag) * ((gdouble) age / lag);
    return CLAMP (1 - moved / (2 * variance), 0, 1);
  }
  return 0;
}

/* @self: the frame
 * @age: frames since the cloth was seen, at least 1
 * @keeps: (out): which part of the motion over the @age frames before then the cloth made
 *   again in as many frames before; what it will make now
 * @covariance: (out): of the error when it is taken for granted, m²
 *
 * With d1 the motion over the last @age frames before the cloth went out of sight and d0
 * that before it, the best line through the origin is d1 = β d0, and it is wrong by
 * ⟨d1²⟩ (1 − β²).
 *
 * Returns: %FALSE when too little was seen
 */
gboolean
cloth_fill_motion (const ClothFill * self, guint age, gdouble * keeps,
    gdouble covariance[6])
{
  guint lag = MIN (age, LONGEST_MOTION), n = 0;
  const gfloat *a = cloth_fill_past (self, age);
  const gfloat *b = cloth_fill_past (self, age + lag);
  const gfloat *c = cloth_fill_past (self, age + 2 * lag);
  guint step = self->n / MOTION_POINTS + 1;
  gdouble cross = 0, before = 0, longer = (gdouble) age / lag;

  memset (covariance, 0, 6 * sizeof *covariance);
  if (!a || !b)
    return FALSE;
  for (guint i = 0; i < self->n; i += step) {
    gdouble d1[3], d0[3];

    if (isnan (a[3 * i]) || isnan (b[3 * i]))
      continue;
    for (guint k = 0; k < 3; k++)
      d1[k] = (gdouble) a[3 * i + k] - b[3 * i + k];
    add_product (covariance, d1);
    n++;
    if (!c || isnan (c[3 * i]))
      continue;
    for (guint k = 0; k < 3; k++) {
      d0[k] = (gdouble) b[3 * i + k] - c[3 * i + k];
      cross += d1[k] * d0[k];
      before += d0[k] * d0[k];
    }
  }
  if (n < LEAST_STENCILS)
    return FALSE;
  *keeps = before > 0 ? CLAMP (cross / before, 0, 1) : 0;
  for (guint k = 0; k < 6; k++)
    covariance[k] *= longer * longer * fmax (1 - *keeps * *keeps, LEAST_SIGNAL)
        / n;
  return TRUE;
}
