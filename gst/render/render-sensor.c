/* From light to the levels of a picture: what lens and sensor do.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/render/render-private.h"

#include <math.h>

/* The transfer curve as a table, straight between its places. */
#define CURVE 4096
/* Quantiles of the normal distribution; the noise is read from them. */
#define QUANTILES 4096
/* A Gaussian is cut off there, standard deviations. */
#define REACH 4

struct _ClothSensor
{
  gfloat curve[CURVE + 2];
  gfloat *quantiles;            /* QUANTILES + 1, when there is noise */
  gfloat *copy;                 /* of a plane, when there is defocus */
  gsize copy_size;
  gfloat *kernel;
  gint reach;

  /* of the picture that is made */
  const ClothCapture *capture;
  const ClothWork *work;
  ClothLight *light;
  gfloat *plane;
  guint64 key;
  guint n_planes;
  guint8 *planes[3];
  gint strides[3], pixel_stride;
};

ClothSensor *
cloth_sensor_new (void)
{
  ClothSensor *self = g_new0 (ClothSensor, 1);

  for (gint i = 0; i < CURVE + 2; i++) {
    const gdouble v = MIN ((gdouble) i / CURVE, 1);

    self->curve[i] = (gfloat) (255 * (v <= 0.0031308 ? 12.92 * v
            : 1.055 * pow (v, 1 / 2.4) - 0.055));
  }
  return self;
}

void
cloth_sensor_free (ClothSensor * sensor)
{
  if (!sensor)
    return;
  g_free (sensor->quantiles);
  g_free (sensor->copy);
  g_free (sensor->kernel);
  g_free (sensor);
}

/* By Newton's method from the middle outwards; the outermost two stand in for the tails
 * such that the variance is 1. */
static void
make_quantiles (ClothSensor * self)
{
  gdouble x = 0, sum = 0;

  self->quantiles = g_new (gfloat, QUANTILES + 1);
  for (gint i = QUANTILES / 2; i <= QUANTILES; i++) {
    const gdouble p = MIN ((gdouble) i / QUANTILES, 1 - 0.25 / QUANTILES);

    for (gint k = 0; k < 50; k++) {
      const gdouble step = (0.5 * erfc (-x / G_SQRT2) - p)
          * sqrt (2 * G_PI) * exp (x * x / 2);

      x -= CLAMP (step, -0.5, 0.5);
      if (fabs (step) < 1e-12)
        break;
    }
    self->quantiles[i] = (gfloat) x;
    self->quantiles[QUANTILES - i] = (gfloat) - x;
  }
  for (gint i = 0; i < QUANTILES; i++) {
    const gdouble a = self->quantiles[i], b = self->quantiles[i + 1];

    sum += (a * a + a * b + b * b) / 3;
  }
  for (gint i = 0; i <= QUANTILES; i++)
    self->quantiles[i] /= (gfloat) sqrt (sum / QUANTILES);
}

static inline guint64
scramble (guint64 z)
{
  z = (z ^ (z >> 30)) * G_GUINT64_CONSTANT (0xbf58476d1ce4e5b9);
  z = (z ^ (z >> 27)) * G_GUINT64_CONSTANT (0x94d049bb133111eb);
  return z ^ (z >> 31);
}

/* A normal deviate for each pixel and channel (splitmix64 of their number). */
static inline gfloat
deviate (const ClothSensor * self, guint64 number)
{
  const guint64 bits = scramble (self->key
      + number * G_GUINT64_CONSTANT (0x9e3779b97f4a7c15));
  const guint at = (guint) (bits >> 52);
  const gfloat part = (gfloat) (bits & 0xffffff) * 0x1p-24f;

  return self->quantiles[at] + part * (self->quantiles[at + 1]
      - self->quantiles[at]);
}

/* ---- light ---- */

static void
shade_rows (gpointer data, guint begin, guint end, guint worker)
{
  ClothSensor *self = data;
  const gdouble *g = self->capture->light_gradient;
  const gint width = self->light->width, height = self->light->height;
  const gfloat gx = (gfloat) g[0];

  for (guint y = begin; y < end && !cloth_work_is_stopped (self->work); y++) {
    const gfloat at_left = (gfloat) (1 + g[1] * (y - (height - 1) / 2.0)
        - g[0] * (width - 1) / 2.0);
    gfloat *row = self->plane + (gsize) y * (gsize) width;

    for (gint x = 0; x < width; x++)
      row[x] *= MAX (at_left + gx * (gfloat) x, 0);
  }
}

/* Means of the Gaussian over pixels, so that its width is true when it is narrow too:
 * the pixel's own square, of variance 1/12, is taken off. */
static void
make_kernel (ClothSensor * self, gdouble sigma)
{
  const gdouble narrow = sigma * sigma - 1 / 12.0;
  gdouble sum = 0;

  self->reach = (gint) ceil (REACH * sigma + 1);
  g_free (self->kernel);
  self->kernel = g_new (gfloat, 2 * self->reach + 1);
  for (gint i = -self->reach; i <= self->reach; i++) {
    gdouble value;

    if (narrow > 0.4) {
      const gdouble s = sqrt (2 * narrow);

      value = erf ((i + 0.5) / s) - erf ((i - 0.5) / s);
    } else {
      /* Too narrow for that: three weights of the right variance. */
      value = i == 0 ? 1 - sigma * sigma : ABS (i) == 1 ? sigma * sigma / 2 : 0;
    }
    self->kernel[i + self->reach] = (gfloat) value;
    sum += value;
  }
  for (gint i = 0; i <= 2 * self->reach; i++)
    self->kernel[i] /= (gfloat) sum;
}

/* Along rows: from the plane into the copy. Beyond its edges the picture goes on. */
static void
blur_rows (gpointer data, guint begin, guint end, guint worker)
{
  ClothSensor *self = data;
  const gint width = self->light->width, reach = self->reach;

  for (guint y = begin; y < end && !cloth_work_is_stopped (self->work); y++) {
    const gfloat *from = self->plane + (gsize) y * (gsize) width;
    gfloat *to = self->copy + (gsize) y * (gsize) width;

    for (gint x = 0; x < width; x++)
      to[x] = 0;
    for (gint k = -reach; k <= reach; k++) {
      const gfloat weight = self->kernel[k + reach];
      const gint first = CLAMP (-k, 0, width), last = CLAMP (width - k, 0,
          width);

      for (gint x = 0; x < first; x++)
        to[x] += weight * from[0];
      for (gint x = first; x < last; x++)
        to[x] += weight * from[x + k];
      for (gint x = last; x < width; x++)
        to[x] += weight * from[width - 1];
    }
  }
}

/* Down columns: from the copy into the plane. */
static void
blur_columns (gpointer data, guint begin, guint end, guint worker)
{
  ClothSensor *self = data;
  const gint width = self->light->width, height = self->light->height;

  for (guint y = begin; y < end && !cloth_work_is_stopped (self->work); y++) {
    gfloat *to = self->plane + (gsize) y * (gsize) width;

    for (gint x = 0; x < width; x++)
      to[x] = 0;
    for (gint k = -self->reach; k <= self->reach; k++) {
      const gint row = CLAMP ((gint) y + k, 0, height - 1);
      const gfloat weight = self->kernel[k + self->reach];
      const gfloat *from = self->copy + (gsize) row * (gsize) width;

      for (gint x = 0; x < width; x++)
        to[x] += weight * from[x];
    }
  }
}

static void
blur (ClothSensor * self, ClothPool * pool)
{
  const gsize size = (gsize) self->light->width * (gsize) self->light->height;

  if (self->copy_size < size) {
    self->copy_size = size;
    self->copy = g_renew (gfloat, self->copy, size);
  }
  cloth_pool_run (pool, blur_rows, self, (guint) self->light->height);
  cloth_pool_run (pool, blur_columns, self, (guint) self->light->height);
}

/* ---- levels ---- */

static inline gfloat
level_of (const ClothSensor * self, gfloat light)
{
  const gfloat at = CLAMP (light, 0, 1) * CURVE;
  const gint i = (gint) at;

  return self->curve[i] + (at - (gfloat) i)
      * (self->curve[i + 1] - self->curve[i]);
}

static inline guint8
whole_level (const ClothSensor * self, gfloat level, gfloat light,
    guint64 number)
{
  const gdouble read = self->capture->read_noise;
  const gdouble shot = self->capture->shot_noise;

  if (self->quantiles && (read > 0 || shot > 0))
    level += sqrtf ((gfloat) (read * read)
        + (gfloat) (shot * shot) * CLAMP (light, 0, 1))
        * deviate (self, number);
  level += 0.5f;
  return (guint8) CLAMP (level, 0, 255);
}

static void
develop_rows (gpointer data, guint begin, guint end, guint worker)
{
  ClothSensor *self = data;
  const ClothLight *light = self->light;
  const gsize size = (gsize) light->width * (gsize) light->height;
  const gfloat leak = (gfloat) (self->capture->crosstalk / 2);

  for (guint y = begin; y < end && !cloth_work_is_stopped (self->work); y++) {
    for (gint x = 0; x < light->width; x++) {
      const gsize at = (gsize) y * (gsize) light->width + (gsize) x;
      gfloat value[3], level[3];

      for (guint c = 0; c < light->n_channels; c++)
        value[c] = light->data[c * size + at];
      if (light->n_channels == 1) {
        value[1] = value[2] = value[0];
      } else if (leak > 0) {
        const gfloat sum = value[0] + value[1] + value[2];

        for (gint c = 0; c < 3; c++)
          value[c] += leak * (sum - 3 * value[c]);
      }
      for (guint c = 0; c < light->n_channels; c++)
        level[c] = level_of (self, value[c]);
      if (light->n_channels == 1) {
        level[1] = level[2] = level[0];
      } else if (self->n_planes == 1) {
        /* luma of ITU-R BT.601 */
        level[0] = 0.299f * level[0] + 0.587f * level[1] + 0.114f * level[2];
        value[0] = 0.299f * value[0] + 0.587f * value[1] + 0.114f * value[2];
      }
      for (guint c = 0; c < self->n_planes; c++)
        self->planes[c][(gssize) y * self->strides[c]
            + (gssize) x * self->pixel_stride] =
            whole_level (self, level[c], value[c], c * size + at);
    }
  }
}

void
cloth_sensor_develop (ClothSensor * sensor, ClothPool * pool,
    const ClothCapture * capture, ClothLight * light, guint64 frame,
    guint64 seed, guint n_planes, guint8 * const *planes, const gint * strides,
    gint pixel_stride, const ClothWork * work)
{
  ClothSensor *self = sensor;
  const gsize size = (gsize) light->width * (gsize) light->height;

  self->capture = capture;
  self->work = work;
  self->light = light;
  self->n_planes = n_planes;
  self->pixel_stride = pixel_stride;
  self->key = scramble (scramble (seed + 1) ^ frame);
  for (guint c = 0; c < n_planes; c++) {
    self->planes[c] = planes[c];
    self->strides[c] = strides[c];
  }
  if (!self->quantiles && (capture->read_noise > 0 || capture->shot_noise > 0))
    make_quantiles (self);
  if (capture->defocus_px > 0)
    make_kernel (self, capture->defocus_px);
  for (guint c = 0; c < light->n_channels; c++) {
    self->plane = light->data + c * size;
    if (capture->light_gradient[0] != 0 || capture->light_gradient[1] != 0)
      cloth_pool_run (pool, shade_rows, self, (guint) light->height);
    if (capture->defocus_px > 0)
      blur (self, pool);
  }
  cloth_pool_run (pool, develop_rows, self, (guint) light->height);
}
