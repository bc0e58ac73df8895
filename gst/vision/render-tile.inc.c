/* The loops over a tile, included once an instruction set: NAME() names of it.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */

/* Value of something linear in the picture. */
static inline gfloat
NAME (at) (const ClothRenderTriangle * t, const gdouble plane[3], gint x,
    gint y)
{
  return (gfloat) (plane[0] + plane[1] * (x - t->x) + plane[2] * (y - t->y));
}

static void
NAME (fill_triangle) (Scratch * s, const ClothRenderTriangle * t, gint index,
    gint left, gint top, F16 sx, F16 sy)
{
  const gint right = MIN (t->right, left + TILE - 1);
  const gint bottom = MIN (t->bottom, top + TILE - 1);
  const F16 step = (gfloat) t->w[1] * sx + (gfloat) t->w[2] * sy;
  F16 off[3];
  gfloat reach[3];

  for (gint k = 0; k < 3; k++) {
    off[k] = t->ea[k] * sx + t->eb[k] * sy;
    reach[k] = (fabsf (t->ea[k]) + fabsf (t->eb[k])) * 0.5f;
  }
  for (gint y = MAX (t->top, top); y <= bottom; y++) {
    for (gint x = MAX (t->left, left); x <= right; x++) {
      const gint p = (y - top) * TILE + x - left;
      F16 w;
      I16 mask = { 0 };
      gfloat e[3];
      gboolean all;

      for (gint k = 0; k < 3; k++)
        e[k] = (gfloat) (t->ea[k] * (x - t->ex[k])
            + t->eb[k] * (y - t->ey[k]));
      if (e[0] < -reach[0] || e[1] < -reach[1] || e[2] < -reach[2])
        continue;
      all = e[0] > reach[0] && e[1] > reach[1] && e[2] > reach[2];
      mask = ~mask;
      for (gint k = 0; k < 3 && !all; k++) {
        const F16 side = e[k] + off[k];

        mask &= (side > 0) | ((side == 0) & t->tie[k]);
      }
      w = NAME (at) (t, t->w, x, y) + step;
      mask &= w > s->depth[p];
      s->depth[p] = (F16) ((mask & (I16) w) | (~mask & (I16) s->depth[p]));
      s->seen[p] = (mask & index) | (~mask & s->seen[p]);
    }
  }
}

/* Is everything of one value within @reach of (u, v), pixels of the finest level? */
static inline const gfloat *NAME (plain_paint) (const ClothPaint * paint,
    gfloat u, gfloat v, gfloat reach_u, gfloat reach_v)
{
  const gfloat span = MAX (reach_u, reach_v) * 2;
  const gint n = span > 1 ? ilogbf (span) + 1 : 0;
  const ClothPaintLevel *level;
  gint x[2], y[2];
  const gfloat *value;

  if (n >= (gint) paint->n_levels || !(span < 65536))
    return NULL;
  level = &paint->levels[n];
  /* Two pixels of that level hold the span. */
  x[0] = (gint) floorf (ldexpf (u - reach_u, -n));
  x[1] = (gint) floorf (ldexpf (u + reach_u, -n));
  y[0] = (gint) floorf (ldexpf (v - reach_v, -n));
  y[1] = (gint) floorf (ldexpf (v + reach_v, -n));
  for (gint i = 0; i < 2; i++) {
    x[i] = CLAMP (x[i], 0, level->width - 1);
    y[i] = CLAMP (y[i], 0, level->height - 1);
  }
  value = level->data + ((gsize) y[0] * (gsize) level->width + (gsize) x[0])
      * paint->n_channels;
  for (gint i = 0; i < 4; i++) {
    const gsize at = (gsize) y[i >> 1] * (gsize) level->width
        + (gsize) x[i & 1];
    const gfloat *other = level->data + at * paint->n_channels;

    if (!level->flat[at])
      return NULL;
    for (guint c = 0; c < paint->n_channels; c++)
      if (other[c] != value[c])
        return NULL;
  }
  return value;
}

/* Sum of the paint at those points of @mask, bilinear between the pixels of a level. */
static void
NAME (sum_paint) (const ClothPaint * paint, guint n, F16 u, F16 v, I16 mask,
    gfloat * sum)
{
  const ClothPaintLevel * level = &paint->levels[n];
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
NAME (add_light) (const ClothRenderJob * job, const ClothRenderTriangle * t,
    gint x, gint y, I16 mask, gint count, F16 sx, F16 sy, gfloat * sum)
{
  const ClothPaint * paint = job->paint;
  const gfloat w = NAME (at) (t, t->w, x, y), inverse = 1 / w;
  const gfloat u = NAME (at) (t, t->u, x, y) * inverse;
  const gfloat v = NAME (at) (t, t->v, x, y) * inverse;
  const gfloat wx = (gfloat) t->w[1], wy = (gfloat) t->w[2];
  /* slopes of u and v, in pixels of the finest level */
  const gfloat ux = ((gfloat) t->u[1] - u * wx) * inverse;
  const gfloat uy = ((gfloat) t->u[2] - u * wy) * inverse;
  const gfloat vx = ((gfloat) t->v[1] - v * wx) * inverse;
  const gfloat vy = ((gfloat) t->v[2] - v * wy) * inverse;
  gfloat light = NAME (at) (t, t->light, x, y);
  gfloat spacing, longest, reach;
  const gfloat *value;
  gfloat part[3] = { 0, 0, 0 };
  guint n = 0;

  light = MAX (light, 0);
  if (!t->front) {
    for (guint c = 0; c < job->light->n_channels; c++)
      sum[c] += (gfloat) count *light * job->back;
    return;
  }
  /* The points are a quarter of a pixel apart. */
  spacing = sqrtf (fabsf (ux * vy - uy * vx)) / 4;
  longest = MAX (hypotf (ux, vx), hypotf (uy, vy)) / 8;
  spacing = MAX (spacing, longest);
  if (spacing > 1 && spacing < 65536)
    n = MIN ((guint) ilogbf (spacing * (gfloat) G_SQRT2), paint->n_levels - 1);
  reach = ldexpf (1, (gint) n);
  value = NAME (plain_paint) (paint, u, v,
      0.55f * (fabsf (ux) + fabsf (uy)) + reach,
      0.55f * (fabsf (vx) + fabsf (vy)) + reach);
  if (value) {
    for (guint c = 0; c < job->light->n_channels; c++)
      sum[c] += (gfloat) count *light * value[paint->n_channels == 3 ? c : 0];
    return;
  }
  {
    const F16 over = 1 / (w + wx * sx + wy * sy);
    const F16 us = (NAME (at) (t, t->u, x, y) + (gfloat) t->u[1] * sx
        + (gfloat) t->u[2] * sy) * over;
    const F16 vs = (NAME (at) (t, t->v, x, y) + (gfloat) t->v[1] * sx
        + (gfloat) t->v[2] * sy) * over;

    NAME (sum_paint) (paint, n, us, vs, mask, part);
  }
  for (guint c = 0; c < job->light->n_channels; c++)
    sum[c] += light * part[paint->n_channels == 3 ? c : 0];
}

static void
NAME (shade_pixel) (const ClothRenderJob * job, const I16 * seen, gint x,
    gint y, F16 sx, F16 sy)
{
  const ClothLight * light = job->light;
  const gsize plane = (gsize) light->width * (gsize) light->height;
  gfloat *to = light->data + (gsize) y * (gsize) light->width + (gsize) x;
  const gfloat background = job->background[0]
      + job->background[1] * (gfloat) y;
  gfloat sum[3] = { 0, 0, 0 };
  guint left = 0xffff;

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
      NAME (add_light) (job, &job->triangles[index], x, y, mask, count, sx,
          sy, sum);
  }
  for (guint c = 0; c < light->n_channels; c++)
    to[c * plane] += sum[c] / SAMPLES * job->weight;
}

static void
NAME (draw_tile) (const ClothRenderJob * job, gint left, gint top,
    const guint * list, guint n_list, gpointer scratch)
{
  Scratch * s = scratch;
  const ClothLight *light = job->light;
  const gint right = MIN (left + TILE, light->width);
  const gint bottom = MIN (top + TILE, light->height);
  F16 sx, sy;

  memcpy (&sx, sample_x, sizeof sx);
  memcpy (&sy, sample_y, sizeof sy);
  if (n_list > 0) {
    memset (s->depth, 0, sizeof s->depth);
    memset (s->seen, 0xff, sizeof s->seen);
    for (guint i = 0; i < n_list; i++)
      NAME (fill_triangle) (s, &job->triangles[list[i]], (gint) list[i], left,
          top, sx, sy);
  }
  for (gint y = top; y < bottom; y++) {
    for (gint x = left; x < right; x++) {
      const I16 *seen = &s->seen[(y - top) * TILE + x - left];

      if (n_list > 0) {
        NAME (shade_pixel) (job, seen, x, y, sx, sy);
      } else {
        const gsize plane = (gsize) light->width * (gsize) light->height;
        gfloat *to = light->data + (gsize) y * (gsize) light->width + (gsize) x;

        for (guint c = 0; c < light->n_channels; c++)
          to[c * plane] += (job->background[0]
              + job->background[1] * (gfloat) y) * job->weight;
      }
    }
  }
}
