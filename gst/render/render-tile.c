/* Draws one tile of the picture: what is seen at 16 points of every pixel, then its light.
 *
 * The points are a lattice whose projections on both axes are evenly spaced, and which is
 * its own mirror image through the pixel's centre, so that edges are smoothed and not
 * moved. A point is seen through one triangle only: its depth is compared there, and the
 * paint is looked up there, filtered to the spacing of the points.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/render/render-private.h"

#include <math.h>
#include <string.h>

#define TILE CLOTH_RENDER_TILE
#define SAMPLES CLOTH_RENDER_SAMPLES

#define INLINE static inline __attribute__((always_inline))

/* 16 at once, whatever the machine's width: every width gives the same bits. */
typedef gfloat F16 __attribute__((vector_size (64)));
typedef gint32 I16 __attribute__((vector_size (64)));
/* two lanes at once */
typedef gint64 __attribute__((may_alias)) Pair;

#define X(i) (((i) + 0.5f) / SAMPLES - 0.5f)
#define Y(i) (((5 * (i) + 2) % SAMPLES + 0.5f) / SAMPLES - 0.5f)
static const gfloat sample_x[SAMPLES] = { X (0), X (1), X (2), X (3), X (4),
  X (5), X (6), X (7), X (8), X (9), X (10), X (11), X (12), X (13), X (14),
  X (15)
};

static const gfloat sample_y[SAMPLES] = { Y (0), Y (1), Y (2), Y (3), Y (4),
  Y (5), Y (6), Y (7), Y (8), Y (9), Y (10), Y (11), Y (12), Y (13), Y (14),
  Y (15)
};

#undef X
#undef Y

/* 1/depth and triangle at every point of every pixel that a triangle has touched. */
typedef struct
{
  F16 depth[TILE * TILE];
  I16 seen[TILE * TILE];
  guint8 touched[TILE * TILE];
} Scratch;

/* Value of something linear in the picture. */
static inline gfloat
at (const ClothRenderTriangle * t, const gdouble plane[3], gint x, gint y)
{
  return (gfloat) (plane[0] + plane[1] * (x - t->x) + plane[2] * (y - t->y));
}

INLINE void
fill_pixel (Scratch * s, const ClothRenderTriangle * t,
    gint index, gint p, const gfloat e[3], const F16 off[3],
    const gfloat reach[3], F16 w)
{
  const gboolean all = e[0] > reach[0] && e[1] > reach[1] && e[2] > reach[2];
  I16 mask = { 0 };

  mask = ~mask;
  for (gint k = 0; k < 3 && !all; k++) {
    const F16 side = e[k] + off[k];

    mask &= (side > 0) | ((side == 0) & t->tie[k]);
  }
  if (s->touched[p]) {
    mask &= w > s->depth[p];
    s->depth[p] = (F16) ((mask & (I16) w) | (~mask & (I16) s->depth[p]));
    s->seen[p] = (mask & index) | (~mask & s->seen[p]);
  } else {
    s->touched[p] = 1;
    s->depth[p] = (F16) (mask & (I16) w);
    s->seen[p] = (mask & index) | ~mask;
  }
}

static void
fill_triangle (Scratch * s, const ClothRenderTriangle * t, gint index,
    gint left, gint top, F16 sx, F16 sy)
{
  const gint first = MAX (t->left - left, 0);
  const gint last = MIN (t->right - left, TILE - 1);
  const gint bottom = MIN (t->bottom, top + TILE - 1);
  const F16 step = (gfloat) t->w[1] * sx + (gfloat) t->w[2] * sy;
  const gfloat slope = (gfloat) t->w[1];
  F16 off[3];
  gfloat reach[3];

  for (gint k = 0; k < 3; k++) {
    off[k] = t->ea[k] * sx + t->eb[k] * sy;
    reach[k] = (fabsf (t->ea[k]) + fabsf (t->eb[k])) * 0.5f;
  }
  for (gint y = MAX (t->top, top); y <= bottom; y++) {
    const gfloat w = at (t, t->w, left, y);
    gdouble row[3];

    /* From the tile's border on for every triangle: those on both sides of an edge must
     * get the same numbers. */
    for (gint k = 0; k < 3; k++)
      row[k] = t->ea[k] * (left - t->ex[k]) + t->eb[k] * (y - t->ey[k]);
    for (gint x = first; x <= last; x++) {
      gfloat e[3];

      for (gint k = 0; k < 3; k++)
        e[k] = (gfloat) (row[k] + (gdouble) t->ea[k] * x);
      if (e[0] < -reach[0] || e[1] < -reach[1] || e[2] < -reach[2])
        continue;
      fill_pixel (s, t, index, (y - top) * TILE + x, e, off, reach,
          w + slope * (gfloat) x + step);
    }
  }
}

/* The value of the paint about (u, v), pixels of the finest level, when a pixel sees no
 * other. */
static inline const gfloat *
plain_paint (const ClothPaint * paint, guint n, gfloat u, gfloat v)
{
  const ClothPaintLevel *level = &paint->levels[n];
  const gfloat last_u = (gfloat) (paint->levels[0].width - 1);
  const gfloat last_v = (gfloat) (paint->levels[0].height - 1);
  gsize at;

  if (n >= paint->n_levels)
    return NULL;
  at = (gsize) ((gint) CLAMP (v, 0, last_v) >> n) * (gsize) level->width
      + (gsize) ((gint) CLAMP (u, 0, last_u) >> n);
  return level->flat[at] ? level->data + at * paint->n_channels : NULL;
}

/* Sum of the paint at those points of @mask, bilinear between the pixels of a level. */
static void
sum_paint (const ClothPaint * paint, guint n, F16 u, F16 v, I16 mask,
    gfloat * sum)
{
  const ClothPaintLevel *level = &paint->levels[n];
  const gfloat scale = ldexpf (1, -(gint) n);
  const F16 x = u * scale - 0.5f, y = v * scale - 0.5f;
  const guint channels = paint->n_channels;
  const gfloat last_x = (gfloat) (level->width - 1);
  const gfloat last_y = (gfloat) (level->height - 1);

  for (gint i = 0; i < SAMPLES; i++) {
    gfloat cx, cy, fx, fy;
    gsize at, right, below;
    gint ix, iy;

    if (!mask[i])
      continue;
    cx = CLAMP (x[i], 0, last_x);
    cy = CLAMP (y[i], 0, last_y);
    ix = (gint) cx;
    iy = (gint) cy;
    fx = cx - (gfloat) ix;
    fy = cy - (gfloat) iy;
    at = ((gsize) iy * (gsize) level->width + (gsize) ix) * channels;
    right = ix + 1 < level->width ? channels : 0;
    below = iy + 1 < level->height ? (gsize) level->width * channels : 0;
    for (guint c = 0; c < channels; c++) {
      const gfloat *d = level->data + at + c;
      const gfloat a = d[0] + fx * (d[right] - d[0]);
      const gfloat b = d[below] + fx * (d[below + right] - d[below]);

      sum[c] += a + fy * (b - a);
    }
  }
}

/* Adds the light of one triangle at @count points of a pixel, those of @mask. */
static void
add_light (const ClothRenderJob * job, const ClothRenderTriangle * t,
    gint x, gint y, I16 mask, gint count, F16 sx, F16 sy, gfloat * sum)
{
  const ClothPaint *paint = job->paint;
  const gfloat w = at (t, t->w, x, y), inverse = 1 / w;
  const gfloat u = at (t, t->u, x, y) * inverse;
  const gfloat v = at (t, t->v, x, y) * inverse;
  gfloat light = at (t, t->light, x, y);
  gfloat part[3] = { 0, 0, 0 };
  const gfloat *value;

  light = MAX (light, 0);
  if (!t->front && !job->two_sided) {
    for (guint c = 0; c < job->light->n_channels; c++)
      sum[c] += (gfloat) count *light * job->back;
    return;
  }
  value = plain_paint (paint, t->flat_level, u, v);
  if (value) {
    for (guint c = 0; c < job->light->n_channels; c++)
      sum[c] += (gfloat) count *light * value[paint->n_channels == 3 ? c : 0];
    return;
  }
  {
    const F16 over = 1 / (w + (gfloat) t->w[1] * sx + (gfloat) t->w[2] * sy);
    const F16 us = (at (t, t->u, x, y) + (gfloat) t->u[1] * sx
        + (gfloat) t->u[2] * sy) * over;
    const F16 vs = (at (t, t->v, x, y) + (gfloat) t->v[1] * sx
        + (gfloat) t->v[2] * sy) * over;

    sum_paint (paint, t->level, us, vs, mask, part);
  }
  for (guint c = 0; c < job->light->n_channels; c++)
    sum[c] += light * part[paint->n_channels == 3 ? c : 0];
}

static void
shade_pixel (const ClothRenderJob * job, const I16 * seen, gint x,
    gint y, F16 sx, F16 sy)
{
  const ClothLight *light = job->light;
  const gsize plane = (gsize) light->width * (gsize) light->height;
  gfloat *to = light->data + (gsize) y * (gsize) light->width + (gsize) x;
  const gfloat background = job->background[0]
      + job->background[1] * (gfloat) y;
  gfloat sum[3] = { 0, 0, 0 };
  guint left = 0xffff;
  const gint one = (*seen)[0];
  I16 others = *seen ^ one;
  gint64 any = 0;

  for (gint i = 0; i < SAMPLES / 2; i++)
    any |= ((const Pair *) &others)[i];
  if (any == 0 && one >= 0) {
    add_light (job, &job->triangles[one], x, y, ~others, SAMPLES, sx, sy, sum);
    left = 0;
  }
  while (left) {
    const gint first = __builtin_ctz (left);
    const gint index = (*seen)[first];
    const I16 mask = *seen == index;
    guint bits = 0;
    gint count;

    for (gint i = 0; i < SAMPLES; i++)
      bits |= (guint) (mask[i] & 1) << i;
    count = __builtin_popcount (bits);
    left &= ~bits;
    if (index < 0)
      for (guint c = 0; c < light->n_channels; c++)
        sum[c] += (gfloat) count *background;
    else
      add_light (job, &job->triangles[index], x, y, mask, count, sx, sy, sum);
  }
  for (guint c = 0; c < light->n_channels; c++)
    to[c * plane] += sum[c] / SAMPLES * job->weight;
}

static void
draw_tile (const ClothRenderJob * job, gint left, gint top,
    const guint * list, guint n_list, gpointer scratch)
{
  Scratch *s = scratch;
  const ClothLight *light = job->light;
  const gint right = MIN (left + TILE, light->width);
  const gint bottom = MIN (top + TILE, light->height);
  F16 sx, sy;

  memcpy (&sx, sample_x, sizeof sx);
  memcpy (&sy, sample_y, sizeof sy);
  if (n_list > 0) {
    memset (s->touched, 0, sizeof s->touched);
    for (guint i = 0; i < n_list && !cloth_work_is_stopped (job->work); i++)
      fill_triangle (s, &job->triangles[list[i]], (gint) list[i], left,
          top, sx, sy);
  }
  for (gint y = top; y < bottom; y++) {
    const gsize plane = (gsize) light->width * (gsize) light->height;
    const gfloat background = (job->background[0] + job->background[1]
        * (gfloat) y) * job->weight;
    gfloat *to = light->data + (gsize) y * (gsize) light->width;

    for (gint x = left; x < right; x++) {
      const gint p = (y - top) * TILE + x - left;

      if (n_list > 0 && s->touched[p])
        shade_pixel (job, &s->seen[p], x, y, sx, sy);
      else
        for (guint c = 0; c < light->n_channels; c++)
          to[c * plane + (gsize) x] += background;
    }
  }
}

const ClothRenderTile CLOTH_SIMD_NAME (cloth_render_tile) = { draw_tile,
  (sizeof (Scratch) + 63) & ~(gsize) 63
};
