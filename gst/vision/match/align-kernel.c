/* Splines looked up, and products of a window's pixels summed.
 *
 * Sums are by columns, so that their order doesn't depend on how many columns are added at
 * once.
 *
 * SPDX-License-Identifier: LGPL-2.1-or-later */
#include <math.h>
#include <string.h>

#include "gst/vision/match/align-private.h"

#define PITCH CLOTH_ALIGN_PITCH

typedef gfloat Four __attribute__((vector_size (16)));

/* The weights of four samples in a row, as cubics of the way from the second to the third,
 * and their slopes. */
static inline Four
get_weights (gfloat s)
{
  const Four one = { 1 / 6.0f, 4 / 6.0f, 1 / 6.0f, 0 };
  const Four first = { -0.5f, 0, 0.5f, 0 }, second = { 0.5f, -1, 0.5f, 0 };
  const Four third = { -1 / 6.0f, 0.5f, -0.5f, 1 / 6.0f };

  return one + s * (first + s * (second + s * third));
}

static inline Four
get_slopes (gfloat s)
{
  const Four first = { -0.5f, 0, 0.5f, 0 }, second = { 1, -2, 1, 0 };
  const Four third = { -0.5f, 1.5f, -1.5f, 0.5f };

  return first + s * (second + s * third);
}

static inline Four
load (const gfloat * from)
{
  Four four;

  memcpy (&four, from, sizeof four);
  return four;
}

/* The sum of each. */
static inline Four
sum_four (Four a, Four b, Four c, Four d)
{
  const Four ab = __builtin_shufflevector (a, b, 0, 4, 2, 6)
      + __builtin_shufflevector (a, b, 1, 5, 3, 7);
  const Four cd = __builtin_shufflevector (c, d, 0, 4, 2, 6)
      + __builtin_shufflevector (c, d, 1, 5, 3, 7);

  return __builtin_shufflevector (ab, cd, 0, 1, 4, 5)
      + __builtin_shufflevector (ab, cd, 2, 3, 6, 7);
}

static void
sample (const gfloat * restrict plane, gint stride, guint n,
    const gfloat * restrict x, const gfloat * restrict y, gfloat weight,
    gfloat slope, gfloat * restrict value, gfloat * restrict across,
    gfloat * restrict down)
{
  gint at[PITCH];
  gfloat s[PITCH], t[PITCH];

  for (guint i = 0; i < n; i++) {
    const gint left = (gint) x[i], top = (gint) y[i];

    s[i] = x[i] - (gfloat) left;
    t[i] = y[i] - (gfloat) top;
    at[i] = (top - 1) * stride + left - 1;
  }
  for (guint i = 0; i < n; i += 4) {
    Four values[4], slopes[4], downs[4], all;

    for (guint k = 0; k < 4; k++) {
      const gfloat *from = plane + at[i + k];
      const Four a = get_weights (s[i + k]), b = get_weights (t[i + k]);
      const Four d = get_slopes (t[i + k]);
      const Four r0 = load (from), r1 = load (from + stride);
      const Four r2 = load (from + 2 * stride), r3 = load (from + 3 * stride);
      const Four column = (b[0] * r0 + b[1] * r1) + (b[2] * r2 + b[3] * r3);
      const Four steep = (d[0] * r0 + d[1] * r1) + (d[2] * r2 + d[3] * r3);

      values[k] = a * column;
      slopes[k] = get_slopes (s[i + k]) * column;
      downs[k] = a * steep;
    }
    all = load (value + i) + weight * sum_four (values[0], values[1],
        values[2], values[3]);
    memcpy (value + i, &all, sizeof all);
    all = load (across + i) + slope * sum_four (slopes[0], slopes[1],
        slopes[2], slopes[3]);
    memcpy (across + i, &all, sizeof all);
    all = load (down + i) + slope * sum_four (downs[0], downs[1], downs[2],
        downs[3]);
    memcpy (down + i, &all, sizeof all);
  }
}

static void
sum_light (const ClothAlignWindow * window, gfloat sums[6][PITCH])
{
  memset (sums, 0, 6 * sizeof sums[0]);
  for (guint row = 0; row < window->rows; row++) {
    const gfloat *w = window->weights + row * window->columns;
    const gfloat *f = window->film + row * window->columns;
    const gfloat *p = window->print + row * window->columns;

    for (guint i = 0; i < window->columns; i++) {
      const gfloat wp = w[i] * p[i], wf = w[i] * f[i];

      sums[0][i] += w[i];
      sums[1][i] += wp;
      sums[2][i] += wf;
      sums[3][i] += wp * p[i];
      sums[4][i] += wp * f[i];
      sums[5][i] += wf * f[i];
    }
  }
}

static void
weigh (const ClothAlignWindow * window, gfloat gain, gfloat offset,
    gfloat outlier, gfloat * differences, gfloat * weights)
{
  const guint n = window->rows * window->columns;

  for (guint i = 0; i < n; i++) {
    const gfloat e = window->film[i] - gain * window->print[i] - offset;

    differences[i] = e;
    weights[i] = window->weights[i] / (1 + e * e * outlier);
  }
}

static void
add (const ClothAlignWindow * window, const gfloat * differences,
    const gfloat * t, gfloat sums[CLOTH_ALIGN_SUMS][PITCH])
{
  memset (sums, 0, CLOTH_ALIGN_SUMS * sizeof sums[0]);
  for (guint row = 0; row < window->rows; row++) {
    const guint at = row * window->columns;
    const gfloat *w = window->weights + at, *p = window->print + at;
    const gfloat *e = differences + at;
    const gfloat *g = window->across + at, *h = window->down + at;
    const gfloat t1 = t[row], t2 = t1 * t1, t3 = t2 * t1, t4 = t3 * t1;

    for (guint i = 0; i < window->columns; i++) {
      const gfloat wg = w[i] * g[i], wh = w[i] * h[i];
      const gfloat gg = wg * g[i], gh = wg * h[i], hh = wh * h[i];
      const gfloat ge = wg * e[i], he = wh * e[i];
      const gfloat gp = wg * p[i], hp = wh * p[i];
      const gfloat wp = w[i] * p[i], we = w[i] * e[i];

      sums[0][i] += gg;
      sums[1][i] += gg * t1;
      sums[2][i] += gg * t2;
      sums[3][i] += gg * t3;
      sums[4][i] += gg * t4;
      sums[5][i] += gh;
      sums[6][i] += gh * t1;
      sums[7][i] += gh * t2;
      sums[8][i] += gh * t3;
      sums[9][i] += gh * t4;
      sums[10][i] += hh;
      sums[11][i] += hh * t1;
      sums[12][i] += hh * t2;
      sums[13][i] += hh * t3;
      sums[14][i] += hh * t4;
      sums[15][i] += ge;
      sums[16][i] += ge * t1;
      sums[17][i] += ge * t2;
      sums[18][i] += gp;
      sums[19][i] += gp * t1;
      sums[20][i] += gp * t2;
      sums[21][i] += wg;
      sums[22][i] += wg * t1;
      sums[23][i] += wg * t2;
      sums[24][i] += he;
      sums[25][i] += he * t1;
      sums[26][i] += he * t2;
      sums[27][i] += hp;
      sums[28][i] += hp * t1;
      sums[29][i] += hp * t2;
      sums[30][i] += wh;
      sums[31][i] += wh * t1;
      sums[32][i] += wh * t2;
      sums[33][i] += w[i];
      sums[34][i] += wp;
      sums[35][i] += wp * p[i];
      sums[36][i] += we;
      sums[37][i] += wp * e[i];
      sums[38][i] += we * e[i];
    }
  }
}

const ClothAlignKernel CLOTH_SIMD_NAME (cloth_align_kernel) = {
  sample, sum_light, weigh, add
};
