/* Blurred copies of a picture as cubic B-splines.
 *
 * A copy is as coarse as its blur allows. The coefficients are those of the spline that
 * goes through the samples (M. Unser, “Splines: A Perfect Fit for Signal and Image
 * Processing”, 1999), so that looking between samples neither blurs nor shifts.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/match/planes.h"

#include <math.h>

/* Smaller planes are of no use, px. */
#define LEAST 8
/* A blur ends so many standard deviations away. */
#define REACH 4.0
/* Of the greatest blur and step of the levels: 2 ⌈4 √512 + 16⌉ + 2. */
#define MOST_TAPS 216
/* Pole of the filter that makes coefficients, and after how many samples it has faded. */
#define POLE -0.26794919243112270647
#define FADES 24

static const struct
{
  gdouble variance;
  gint step;
} levels[CLOTH_PLANES] = {
  {0, 1}, {0.5, 1}, {1, 1}, {2, 2}, {4, 2}, {8, 4}, {16, 4}, {32, 8}, {64, 8},
  {128, 16}, {256, 16}, {512, 32}
};

/* Samples @n values that are @from_step apart, which go on at both ends, at the middles of
 * every @step of them, pad included; blurred. */
static void
blur_line (const gfloat * from, gint n, gint from_step, gint step,
    gdouble variance, gint n_to, gfloat * to, gint to_step)
{
  const gint reach = (gint) ceil (REACH * sqrt (variance) + 0.5 * step);
  gdouble weights[MOST_TAPS], sum_weights = 0;
  const gdouble first = (-CLOTH_PLANE_PAD + 0.5) * step - 0.5;
  /* middles are whole steps apart, so that each has the same weights */
  const gint begin = (gint) floor (first) - reach;
  const gint n_taps = (gint) ceil (first) + reach + 1 - begin;

  for (gint t = 0; variance > 0 && t < n_taps; t++) {
    const gdouble off = begin + t - first;

    weights[t] = exp (-0.5 * off * off / variance);
    sum_weights += weights[t];
  }
  for (gint i = 0; i < n_to; i++) {
    const gint at = begin + i * step;
    gdouble sum = 0;

    for (gint t = 0; variance > 0 && t < n_taps; t++)
      sum += weights[t] * from[(gssize) CLAMP (at + t, 0, n - 1) * from_step];
    to[(gssize) i * to_step] = (gfloat) (variance > 0 ? sum / sum_weights :
        from[(gssize) CLAMP (at + reach, 0, n - 1) * from_step]);
  }
}

/* Turns samples into coefficients, in place; outside they are mirrored. */
static void
filter_line (gfloat * line, gint n, gint step)
{
  gdouble value = 0, power = 1;

  for (gint k = 0; k < MIN (n, FADES); k++, power *= POLE)
    value += power * line[(gssize) k * step];
  line[0] = (gfloat) (6 * value);
  value *= 6;
  for (gint k = 1; k < n; k++) {
    value = 6 * line[(gssize) k * step] + POLE * value;
    line[(gssize) k * step] = (gfloat) value;
  }
  value = POLE / (POLE * POLE - 1) * (value
      + POLE * line[(gssize) (n - 2) * step]);
  line[(gssize) (n - 1) * step] = (gfloat) value;
  for (gint k = n - 2; k >= 0; k--) {
    value = POLE * (value - line[(gssize) k * step]);
    line[(gssize) k * step] = (gfloat) value;
  }
}

static void
fill_plane (ClothPlane * plane, const gfloat * picture, gint width, gint height)
{
  g_autofree gfloat *across = g_new (gfloat, (gsize) plane->width * height);

  for (gint y = 0; y < height; y++)
    blur_line (picture + (gsize) y * width, width, 1, plane->step,
        plane->variance, plane->width, across + (gsize) y * plane->width, 1);
  plane->coefficients = g_new (gfloat, (gsize) plane->stride * plane->height);
  for (gint x = 0; x < plane->width; x++)
    blur_line (across + x, height, plane->width, plane->step, plane->variance,
        plane->height, plane->coefficients + x, plane->stride);
  for (gint y = 0; y < plane->height; y++)
    filter_line (plane->coefficients + (gsize) y * plane->stride, plane->width,
        1);
  for (gint x = 0; x < plane->width; x++)
    filter_line (plane->coefficients + x, plane->height, plane->stride);
}

/* @picture: is copied
 *
 * Returns: (transfer full): its planes; four bytes a pixel and plane
 */
ClothPlanes *
cloth_planes_new (const ClothImage * picture)
{
  const gint width = picture->width, height = picture->height;
  ClothPlanes *self = g_new0 (ClothPlanes, 1);
  g_autofree gfloat *pixels = g_new (gfloat, (gsize) width * height);

  self->width = width;
  self->height = height;
  for (gint y = 0; y < height; y++)
    for (gint x = 0; x < width; x++)
      pixels[(gsize) y * width + x] =
          picture->data[(gssize) y * picture->stride + x];
  for (guint k = 0; k < CLOTH_PLANES; k++) {
    const gint step = levels[k].step;
    ClothPlane *plane = &self->planes[k];

    if (k && (width < LEAST * step || height < LEAST * step))
      break;
    plane->step = step;
    plane->variance = levels[k].variance;
    plane->width = plane->stride =
        (width + step - 1) / step + 2 * CLOTH_PLANE_PAD;
    plane->height = (height + step - 1) / step + 2 * CLOTH_PLANE_PAD;
    fill_plane (plane, pixels, width, height);
    self->n_planes++;
  }
  return self;
}

/* @planes: (nullable) (transfer full): what to free
 */
void
cloth_planes_free (ClothPlanes * planes)
{
  if (!planes)
    return;
  for (guint k = 0; k < planes->n_planes; k++)
    g_free (planes->planes[k].coefficients);
  g_free (planes);
}
