/* The stretch and compression constraints.
 *
 * D. Pritchard and W. Heidrich (2003), section 4.2. With the flat cloth's Δd_r and Δd_c along
 * the surface, Δd_r·(1 − k_s) < Δd_c < Δd_r·(1 + k_s) (equations 4, 5). Δd_c is the length
 * of the straight line of the picture laid on the surface (equation 6).
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/match/stretch.h"

#include <math.h>

/* Step of the walk, px. */
#define STEP 2.0

/* Returns: k_s of the paper; the rest as measured on rendered cloth, 1.1 mm a pixel
 */
ClothStretchParams
cloth_stretch_default_params (void)
{
  return (ClothStretchParams) {
  0.1, 1, 0.01, 0.03, 0, 2};
}

/* Returns: @params with all values in their ranges
 */
ClothStretchParams
cloth_stretch_clamp_params (const ClothStretchParams * params)
{
  return (ClothStretchParams) {
  CLAMP (params->stretch, 0, 0.9), MAX (params->slack, 0),
        MAX (params->depth_step, 0), MAX (params->hidden, 0),
        MAX (params->metres_per_pixel, 0), MAX (params->foreshortening, 1)};
}

/* @surface: what is looked at
 * @x: column
 * @y: row
 * @depth_step: depths that differ by more are of two surfaces, m
 * @point: (out): the surface between its four nearest points; where one isn't known or
 *   they belong to two surfaces, the nearest of those that are known
 *
 * Returns: %FALSE where the surface isn't known
 */
gboolean
cloth_surface_get_point (const ClothMatchSurface * surface, gdouble x,
    gdouble y, gdouble depth_step, gdouble point[3])
{
  const gfloat *corners[4], *nearest = NULL;
  gdouble weights[4], low = INFINITY, high = -INFINITY, best = -1;
  gboolean whole = TRUE;
  gint x0, y0;

  /* before they become whole numbers, which have no room for what is far outside */
  if (!(x > -1 && y > -1 && x < surface->width && y < surface->height))
    return FALSE;
  x0 = (gint) floor (x);
  y0 = (gint) floor (y);
  if (x >= 0 && y >= 0 && x0 < surface->width - 1 && y0 < surface->height - 1) {
    const gfloat *p = surface->points + 3 * ((gsize) y0 * surface->stride + x0);
    const gfloat *q = p + 3 * surface->stride;
    const gdouble s = x - x0, t = y - y0;

    /* as below, where all four are of one surface; NaN is not */
    if (MAX (MAX (p[2], p[5]), MAX (q[2], q[5])) - MIN (MIN (p[2], p[5]),
            MIN (q[2], q[5])) <= depth_step
        && isfinite (p[2] + p[5] + q[2] + q[5])) {
      for (gint c = 0; c < 3; c++)
        point[c] = (1 - t) * ((1 - s) * p[c] + s * p[c + 3])
            + t * ((1 - s) * q[c] + s * q[c + 3]);
      return TRUE;
    }
  }
  for (gint k = 0; k < 4; k++) {
    const gint cx = CLAMP (x0 + (k & 1), 0, surface->width - 1);
    const gint cy = CLAMP (y0 + (k >> 1), 0, surface->height - 1);

    corners[k] = surface->points + 3 * ((gsize) cy * surface->stride + cx);
    weights[k] = (k & 1 ? x - x0 : 1 - x + x0)
        * (k >> 1 ? y - y0 : 1 - y + y0);
    if (!isfinite (corners[k][0] + corners[k][1] + corners[k][2])) {
      whole = FALSE;
      continue;
    }
    low = MIN (low, corners[k][2]);
    high = MAX (high, corners[k][2]);
    if (weights[k] > best) {
      best = weights[k];
      nearest = corners[k];
    }
  }
  if (!nearest)
    return FALSE;
  for (gint c = 0; c < 3; c++)
    point[c] = whole && high - low <= depth_step
        ? weights[0] * corners[0][c] + weights[1] * corners[1][c]
        + weights[2] * corners[2][c] + weights[3] * corners[3][c]
        : nearest[c];
  return TRUE;
}

/* @surface: what the line is laid on
 * @from: column and row
 * @to: column and row
 * @depth_step: greatest step of depth of one surface
 * @length: (out): of the line, m
 * @broken: (out): whether a step is greater, or the surface isn't known somewhere between
 *
 * Returns: %FALSE where the surface isn't known at an end
 */
gboolean
cloth_surface_measure (const ClothMatchSurface * surface,
    const gfloat from[2], const gfloat to[2], gdouble depth_step,
    gdouble * length, gboolean * broken)
{
  const gdouble dx = to[0] - from[0], dy = to[1] - from[1];
  gdouble last[3], end[3];
  gint n;

  *length = 0;
  *broken = FALSE;
  if (!cloth_surface_get_point (surface, from[0], from[1], depth_step, last)
      || !cloth_surface_get_point (surface, to[0], to[1], depth_step, end))
    return FALSE;
  n = MAX ((gint) ceil (sqrt (dx * dx + dy * dy) / STEP), 1);
  for (gint k = 1; k <= n; k++) {
    gdouble now[3] = { end[0], end[1], end[2] };
    gdouble d[3];

    if (k < n && !cloth_surface_get_point (surface, from[0] + dx * k / n,
            from[1] + dy * k / n, depth_step, now)) {
      *broken = TRUE;
      continue;
    }
    for (gint c = 0; c < 3; c++) {
      d[c] = now[c] - last[c];
      last[c] = now[c];
    }
    *broken |= fabs (d[2]) > depth_step;
    *length += sqrt (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  }
  return TRUE;
}

/* @params: the bounds, in their ranges
 * @surface: (nullable): what the two places lie on; without it their distance in the picture
 *   bounds the one on the cloth
 * @from: column and row
 * @to: column and row
 * @by_scale: metres of a pixel by the scales of the features there, > 0
 * @range: (out): of their distance on the flat cloth
 *
 * The uncertainty of the picture's distance widens the range on both sides.
 *
 * Returns: %FALSE where the surface isn't known
 */
gboolean
cloth_stretch_get_range (const ClothStretchParams * params,
    const ClothMatchSurface * surface, const gfloat from[2],
    const gfloat to[2], gdouble by_scale, ClothStretchRange * range)
{
  const gdouble dx = to[0] - from[0], dy = to[1] - from[1];
  const gdouble pixels = sqrt (dx * dx + dy * dy);
  gdouble least, most, slack;

  range->broken = FALSE;
  if (surface) {
    if (!cloth_surface_measure (surface, from, to, params->depth_step, &least,
            &range->broken))
      return FALSE;
    most = least;
    slack = params->slack * (pixels > 1 ? least / pixels : by_scale);
  } else {
    const gdouble scale = params->metres_per_pixel > 0 ?
        params->metres_per_pixel : by_scale;

    least = most = scale * pixels;
    slack = scale * params->slack;
    most *= params->foreshortening;
    if (!(params->metres_per_pixel > 0))
      least /= params->foreshortening;
  }
  range->least = MAX (least - slack, 0) / (1 + params->stretch);
  range->most = range->broken ? most + slack + params->hidden
      : (most + slack) / (1 - params->stretch);
  return TRUE;
}

/* @params: the bounds, in their ranges
 * @surface: (nullable): what the two places lie on
 * @from: column and row
 * @to: column and row
 * @by_scale: metres of a pixel by the scales of the features there, > 0
 * @least: (out): of their distance on the flat cloth, m
 *
 * The cloth between them may be folded or hidden: it is no shorter than the straight line.
 *
 * Returns: %FALSE where the surface isn't known
 */
gboolean
cloth_stretch_get_least (const ClothStretchParams * params,
    const ClothMatchSurface * surface, const gfloat from[2],
    const gfloat to[2], gdouble by_scale, gdouble * least)
{
  gdouble a[3], b[3], pixels, length;
  ClothStretchRange range;

  if (!surface) {
    cloth_stretch_get_range (params, NULL, from, to, by_scale, &range);
    *least = range.least;
    return TRUE;
  }
  if (!cloth_surface_get_point (surface, from[0], from[1], params->depth_step,
          a) || !cloth_surface_get_point (surface, to[0], to[1],
          params->depth_step, b))
    return FALSE;
  pixels = hypot (to[0] - from[0], to[1] - from[1]);
  length = sqrt ((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1])
      + (a[2] - b[2]) * (a[2] - b[2]));
  *least = MAX (length - params->slack * (pixels > 1 ? length / pixels :
          by_scale), 0) / (1 + params->stretch);
  return TRUE;
}
