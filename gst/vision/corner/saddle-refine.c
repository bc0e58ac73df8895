/* The sub-pixel place of a saddle from the pixels around its strongest one.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include "gst/vision/corner/saddle-private.h"

#include <math.h>

#include "gst/vision/corner/saddle-derivatives.h"

#define PHASES 32
#define TAPS CLOTH_SADDLE_TAPS
#define RADIUS 7
/* The window holds 15 pixels; a wider Gaussian than this would be cut off by it. */
#define WIDEST 2.3

struct _ClothSaddleRefiner
{
  gfloat sigma;
  /* Standard deviation of F_x for unit white noise. */
  gfloat gradient_noise;
  /* Gaussian and its first two derivatives, centred at RADIUS + phase / PHASES - 1/2. */
  ClothSaddleTaps taps[PHASES + 1][3];
};

ClothSaddleRefiner *
cloth_saddle_refiner_new (void)
{
  ClothSaddleRefiner *self;

  /* g_new() promises no more than 16 bytes of alignment. */
  self = g_aligned_alloc0 (1, sizeof (ClothSaddleRefiner), 64);
  return self;
}

void
cloth_saddle_refiner_free (ClothSaddleRefiner * refiner)
{
  if (refiner)
    g_aligned_free (refiner);
}

/* @refiner: a refiner
 * @sigma: width of the Gaussian, px; no more than 2.3 is used
 */
void
cloth_saddle_refiner_set (ClothSaddleRefiner * refiner, gfloat sigma)
{
  gdouble s = CLAMP ((gdouble) sigma, 0.8, WIDEST), s2 = s * s;
  gdouble sum_g = 0, sum_d = 0;

  if (refiner->sigma == sigma)
    return;
  refiner->sigma = sigma;
  for (gint p = 0; p <= PHASES; p++) {
    gdouble centre = RADIUS + (gdouble) p / PHASES - 0.5;
    gdouble w[TAPS], sum = 0, sum2 = 0, g2 = 0, bias = 0, first = 0;

    for (gint k = 0; k < TAPS; k++) {
      gdouble d = k - centre;
      w[k] = k < TAPS - 1 ? exp (-0.5 * d * d / s2) : 0;
      sum += w[k];
    }
    for (gint k = 0; k < TAPS; k++) {
      gdouble d = k - centre;
      w[k] /= sum;
      bias += w[k] * (d * d / s2 - 1) / s2;
      first += w[k] * d / s2;
    }
    for (gint k = 0; k < TAPS; k++) {
      gdouble d = k - centre, second = w[k] * (d * d / s2 - 1) / s2;
      /* A plane must have no curvature, a level no slope, in spite of the cut. */
      gdouble slope = w[k] * d / s2 - w[k] * first;
      refiner->taps[p][0][k] = (gfloat) w[k];
      refiner->taps[p][1][k] = (gfloat) slope;
      refiner->taps[p][2][k] = (gfloat) (second - w[k] * bias);
      g2 += w[k] * w[k];
      sum2 += slope * slope;
    }
    if (p == PHASES / 2) {
      sum_g = g2;
      sum_d = sum2;
    }
  }
  refiner->gradient_noise = (gfloat) sqrt (sum_g * sum_d);
}

/* The window around (x, y); a copy with the border repeated where it leaves the
 * picture. One column more than the taps is read. */
static const guint8 *
window (const ClothImage * image, gint x, gint y, guint8 * copy, gsize * stride)
{
  gint x0 = x - RADIUS, y0 = y - RADIUS;

  if (x0 >= 0 && y0 >= 0 && x0 + TAPS <= image->width
      && y0 + TAPS <= image->height) {
    *stride = (gsize) image->stride;
    return image->data + (gsize) y0 *(gsize) image->stride + x0;
  }
  for (gint j = 0; j < TAPS; j++) {
    const guint8 *row = image->data +
        (gsize) CLAMP (y0 + j, 0, image->height - 1) * (gsize) image->stride;
    for (gint i = 0; i < TAPS; i++)
      copy[j * TAPS + i] = row[CLAMP (x0 + i, 0, image->width - 1)];
  }
  *stride = TAPS;
  return copy;
}

/* @refiner: a refiner
 * @image: the picture
 * @peak: where to start
 * @noise: standard deviation of the picture's noise, grey levels
 * @saddle: (out): the saddle
 * @theta: (out) (optional): directions of both edges, radians from +x towards +y
 * @level: the instruction set
 *
 * Newton's method on the intensity smoothed by a Gaussian that is centred at the place
 * sought itself, to 1/32 px; the last step is the exact saddle of the quadratic there.
 * Covariance: of the gradient for white noise, through the inverse Hessian.
 *
 * Returns: FALSE when there is no saddle within 2 px and a bit of @peak.
 */
gboolean
cloth_saddle_refiner_run (const ClothSaddleRefiner * refiner,
    const ClothImage * image, const ClothSaddleCandidate * peak, gfloat noise,
    ClothSaddle * saddle, gfloat theta[2], ClothSimd level)
{
  const ClothSaddleDerivatives *kernel =
      CLOTH_SIMD_TABLE (cloth_saddle_derivatives, level);
  gfloat x = peak->x, y = peak->y, f[5] = { 0 }, det = 0;
  gfloat reach = 1.0f + MAX (1.5f, refiner->sigma);

  for (gint i = 0; i < 8; i++) {
    guint8 copy[TAPS * TAPS];
    gint ix = (gint) floorf (x + 0.5f), iy = (gint) floorf (y + 0.5f);
    gint px = (gint) floorf ((x - (gfloat) ix + 0.5f) * PHASES + 0.5f);
    gint py = (gint) floorf ((y - (gfloat) iy + 0.5f) * PHASES + 0.5f);
    gfloat dx, dy;
    gsize stride;
    const guint8 *data = window (image, ix, iy, copy, &stride);

    kernel->derivatives (data, stride, refiner->taps[px], refiner->taps[py], f);
    det = f[2] * f[4] - f[3] * f[3];
    if (!(det < 0))
      return FALSE;
    dx = -(f[4] * f[0] - f[3] * f[1]) / det;
    dy = -(f[2] * f[1] - f[3] * f[0]) / det;
    x = (gfloat) ix + ((gfloat) px / PHASES - 0.5f);
    y = (gfloat) iy + ((gfloat) py / PHASES - 0.5f);
    /* From here the quadratic is exact to 0.0005 px. */
    if (dx * dx + dy * dy < 0.1f * 0.1f) {
      x += dx;
      y += dy;
      break;
    }
    if (dx * dx + dy * dy > 1.0f) {
      gfloat scale = 1.0f / sqrtf (dx * dx + dy * dy);
      dx *= scale;
      dy *= scale;
    }
    x += dx;
    y += dy;
    if (fabsf (x - peak->x) > reach || fabsf (y - peak->y) > reach)
      return FALSE;
  }
  if (x < 0 || y < 0 || x > (gfloat) (image->width - 1)
      || y > (gfloat) (image->height - 1))
    return FALSE;

  saddle->x = x;
  saddle->y = y;
  saddle->response = -det;
  saddle->axis = 0.5f * atan2f (2 * f[3], f[2] - f[4]);
  if (saddle->axis < 0)
    saddle->axis += 3.1415927f;
  {
    gfloat v = noise * refiner->gradient_noise / det;
    v *= v;
    saddle->cov[0] = v * (f[4] * f[4] + f[3] * f[3]);
    saddle->cov[1] = -v * f[3] * (f[2] + f[4]);
    saddle->cov[2] = v * (f[2] * f[2] + f[3] * f[3]);
  }
  /* The edges run where the quadratic form of the Hessian vanishes:
   * Fyy t² + 2 Fxy t + Fxx = 0 for t = dy / dx, written so that nothing cancels. */
  if (theta) {
    gfloat root = sqrtf (-det);
    gfloat sum = f[3] > 0 ? -f[3] - root : -f[3] + root;
    theta[0] = atan2f (sum, f[4]);
    theta[1] = atan2f (f[2], sum);
  }
  return TRUE;
}
