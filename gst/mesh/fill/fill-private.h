/* What the parts of hole filling share.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include "gst/mesh/fill/fill.h"
#include "gst/mesh/fill/hole.h"

G_BEGIN_DECLS

/* Frames that are remembered, a power of two; fewer when they would take more than
 * CLOTH_FILL_MEMORY bytes. */
#define CLOTH_FILL_HISTORY 64
#define CLOTH_FILL_MEMORY (64u << 20)
/* Age of what was never seen. */
#define CLOTH_FILL_NEVER G_MAXUINT

struct _ClothFill
{
  ClothFillParameters parameters;
  guint n;
  ClothStencils *stencils;
  /* this frame */
  gfloat *measured, *noise;
  gfloat *positions, *covariances;
  guint8 *states;
  /* the last frame: where each vertex would be by its own past and its surroundings, and
   * frames since it was measured */
  gfloat *carried;
  guint *age;
  /* measured positions of the last frames; frame k is in history[k % depth] */
  guint depth;
  gfloat **history;
  guint64 frames;
  gdouble last_s, period_s;
  /* holes by their lowest vertex */
  ClothHole **hole_at;
  GPtrArray *holes;
  gint *index;
  guint *queue;
  gboolean *queued;
  /* work */
  GArray *numbers;
  gfloat *work;
  gboolean *wrong;
};

/* The measured positions of @lag frames ago, NULL when not remembered. */
static inline const gfloat *
cloth_fill_past (const ClothFill * self, guint lag)
{
  if (lag >= self->depth || lag > self->frames)
    return NULL;
  return self->history[(self->frames - lag) % self->depth];
}

/* @covariance: of a second difference around the hole, xx, xy, xz, yy, yz, zz, m²
 * @noise: mean covariance of the vertices there, m²
 * @n: second differences that it was taken from
 */
typedef struct {
  gdouble covariance[6];
  gdouble noise[6];
  guint n;
} ClothFillShape;

static inline gdouble
cloth_fill_trace (const gdouble covariance[6])
{
  return covariance[0] + covariance[3] + covariance[5];
}

gboolean cloth_fill_align (const gfloat * from, const gfloat * to, guint n,
    const guint * vertices, gdouble rotation[9], gdouble shift[3]);
void cloth_fill_shape (const ClothFill * self, const ClothHole * hole,
    ClothFillShape * shape);
gdouble cloth_fill_persistence (const ClothFill * self,
    const ClothHole * hole, const ClothFillShape * shape, guint age);
gboolean cloth_fill_motion (const ClothFill * self, guint age,
    gdouble * keeps, gdouble covariance[6]);
guint cloth_fill_outliers (ClothFill * self);
void cloth_fill_bilaplacian (ClothFill * self, const ClothHole * hole);

G_END_DECLS
